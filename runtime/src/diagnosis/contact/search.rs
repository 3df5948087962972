//! Contact: windows of time in which several joints are pushed together.

use crate::diagnosis::rows::context::Context;
use crate::diagnosis::rows::design::Design;
use crate::diagnosis::rows::signals::Signals;
use crate::effects::{Wrench, unit_force_torques};
use nalgebra::{DMatrix, DVector, Matrix3, Vector3};
use std::collections::BTreeMap;

/// Windows with an outside force.
#[derive(Clone)]
pub(in crate::diagnosis) struct Contacts {
    /// Times per signal that no other row may use.
    pub windows: Vec<Vec<[f64; 2]>>,
    pub wrenches: Vec<Wrench>,
    /// Residual squares in the windows in units of the noise, without a force and with the force of the neighbouring
    /// instants.
    pub before: f64,
    pub after: f64,
    /// Squares of the torque itself in the windows, same units.
    pub torque: f64,
    /// Probability that the clearest of them is an accident.
    pub doubt: f64,
}

impl Contacts {
    /// Both together, where there are both.
    pub fn joined(one: Option<Self>, other: Option<Self>) -> Option<Self> {
        let (mut all, other) = match (one, other) {
            (Some(one), Some(other)) => (one, other),
            (one, other) => return one.or(other),
        };
        for (windows, more) in all.windows.iter_mut().zip(other.windows) {
            windows.extend(more);
        }
        all.wrenches.extend(other.wrenches);
        all.before += other.before;
        all.after += other.after;
        all.torque += other.torque;
        all.doubt = all.doubt.min(other.doubt);
        Some(all)
    }
}

/// An instant counts as pushed when its mean squared residual passes this many noise variances.
const PUSHED: f64 = 14.0;
/// A single joint counts as pushed beyond this many standard deviations.
const JOINT_PUSHED: f64 = 3.5;
/// Shortest push, s: shorter bursts are impacts inside of the robot.
const SHORTEST: f64 = 0.15;
/// A push is an exception: together at most this share of the motion.
const MOST: f64 = 0.35;
/// One force on one link must explain this share of the squares of a window.
const EXPLAINED: f64 = 0.7;
/// The force of the neighbouring instants must predict this share of them: a push is smooth.
const PREDICTED: f64 = 0.75;

/// Residuals of a fit that single instants cannot pull (iterated weights of Cauchy's kind, shared by all joints at an
/// instant), with a robust standard deviation per joint.
fn robust(design: &Design) -> (Vec<f64>, Vec<f64>) {
    let p = design.columns.len();
    let m = design.rows.len();
    let mut weight = vec![1.0; m];
    let mut sigma = vec![1.0; design.joints];
    let mut residual = design.y.clone();
    let scales: Vec<f64> = design
        .columns
        .iter()
        .map(|c| 1.0 / c.iter().map(|x| x * x).sum::<f64>().sqrt().max(1e-300))
        .collect();
    for round in 0..20 {
        let mut rows: Vec<f64> = weight.clone();
        for j in 0..design.joints {
            for r in design.of_joint(j) {
                rows[r] /= sigma[j] * sigma[j];
            }
        }
        let weighted: Vec<Vec<f64>> = design
            .columns
            .iter()
            .zip(&scales)
            .map(|(c, s)| c.iter().zip(&rows).map(|(x, w)| x * s * w).collect())
            .collect();
        let mut g = DMatrix::<f64>::zeros(p, p);
        let mut b = DVector::<f64>::zeros(p);
        for j in 0..design.joints {
            let range = design.of_joint(j);
            let live: Vec<usize> =
                (0..p).filter(|&k| design.columns[k][range.clone()].iter().any(|&x| x != 0.0)).collect();
            for &i in &live {
                b[i] += crate::diagnosis::rows::design::dot(
                    &weighted[i][range.clone()],
                    &design.y[range.clone()],
                );
                for &k in live.iter().take_while(|&&k| k <= i) {
                    let v = scales[k]
                        * crate::diagnosis::rows::design::dot(
                            &weighted[i][range.clone()],
                            &design.columns[k][range.clone()],
                        );
                    g[(i, k)] += v;
                    if i != k {
                        g[(k, i)] += v;
                    }
                }
            }
        }
        let trace = g.trace().max(1e-300) / p.max(1) as f64;
        for k in 0..p {
            g[(k, k)] += 1e-11 * trace + if g[(k, k)] == 0.0 { 1.0 } else { 0.0 };
        }
        let Some(factor) = g.cholesky() else { break };
        let chi = factor.solve(&b);
        residual.copy_from_slice(&design.y);
        for (k, column) in design.columns.iter().enumerate() {
            let x = chi[k] * scales[k];
            for (r, c) in residual.iter_mut().zip(column) {
                *r -= c * x;
            }
        }
        for j in 0..design.joints {
            let mut absolute: Vec<f64> = residual[design.of_joint(j)].iter().map(|x| x.abs()).collect();
            absolute.sort_by(f64::total_cmp);
            let largest = design.y[design.of_joint(j)].iter().fold(0.0_f64, |a, b| a.max(b.abs()));
            let mad = 1.4826 * absolute.get(absolute.len() / 2).copied().unwrap_or(1.0);
            sigma[j] = mad.max(1e-6 * largest).max(1e-12);
        }
        if round < 19 {
            let energy = energies(design, &residual, &sigma);
            for (r, at) in design.rows.iter().enumerate() {
                let (sum, count, _) = energy[&(at.signal, at.centre)];
                weight[r] = 1.0 / (1.0 + sum / count as f64 / 3.0);
            }
        }
    }
    (residual, sigma)
}

/// Per instant: squares in units of the noise, rows, joints pushed.
fn energies(
    design: &Design,
    residual: &[f64],
    sigma: &[f64],
) -> BTreeMap<(usize, usize), (f64, usize, usize)> {
    let mut energy = BTreeMap::new();
    for (j, s) in sigma.iter().enumerate() {
        for r in design.of_joint(j) {
            let e = (residual[r] / s).powi(2);
            let at = energy.entry((design.rows[r].signal, design.rows[r].centre)).or_insert((0.0, 0, 0));
            at.0 += e;
            at.1 += 1;
            at.2 += usize::from(e > JOINT_PUSHED * JOINT_PUSHED);
        }
    }
    energy
}

/// Looks for contacts on rows that leave nothing out.
pub(in crate::diagnosis) fn find(
    context: &Context<'_>,
    design: &Design,
    signals: &[Signals],
) -> Option<Contacts> {
    let (residual, sigma) = robust(design);
    let energy = energies(design, &residual, &sigma);
    let mut windows: Vec<Vec<[f64; 2]>> = vec![Vec::new(); signals.len()];
    let mut pushed_time = 0.0;
    let mut all_time = 0.0;
    for (k, s) in signals.iter().enumerate() {
        all_time += s.len() as f64 / s.rate;
        let instants: Vec<(f64, bool)> = energy
            .range((k, 0)..(k + 1, 0))
            .map(|(&(_, t), &(sum, count, joints))| {
                (s.time(t), sum / count as f64 > PUSHED && joints >= 2.min(design.joints))
            })
            .collect();
        let mut open: Option<[f64; 2]> = None;
        let mut close = |w: [f64; 2]| {
            if w[1] - w[0] >= SHORTEST {
                pushed_time += w[1] - w[0];
                windows[k].push(w);
            }
        };
        for &(time, pushed) in &instants {
            open = match (open, pushed) {
                (None, true) => Some([time, time]),
                (Some(w), true) if time - w[1] < SHORTEST => Some([w[0], time]),
                (Some(w), true) => {
                    close(w);
                    Some([time, time])
                }
                (Some(w), false) if time - w[1] >= SHORTEST => {
                    close(w);
                    None
                }
                (open, false) => open,
            };
        }
        if let Some(w) = open {
            close(w);
        }
    }
    if pushed_time == 0.0 || pushed_time > MOST * all_time {
        return None;
    }
    let mut contacts = Contacts {
        windows: vec![Vec::new(); signals.len()],
        wrenches: vec![],
        before: 0.0,
        after: 0.0,
        torque: 0.0,
        doubt: 1e-4,
    };
    for (k, windows) in windows.iter().enumerate() {
        for &w in windows {
            if let Some((wrench, squares)) = explain(context, design, &residual, &sigma, k, w) {
                contacts.wrenches.push(wrench);
                contacts.windows[k].push([w[0] - 0.05, w[1] + 0.05]);
                contacts.before += squares[0];
                contacts.after += squares[1];
                contacts.torque += squares[2];
            }
        }
    }
    (!contacts.wrenches.is_empty()).then_some(contacts)
}

/// Whether the instants of the contacts still stand out of the noise (`sigma` per joint) in a residual.
pub(in crate::diagnosis) fn remain(
    contacts: &Contacts,
    design: &Design,
    residual: &[f64],
    sigma: &[f64],
    signals: &[Signals],
) -> bool {
    let (mut sum, mut count) = (0.0, 0);
    for (&(k, t), &(squares, rows, _)) in &energies(design, residual, sigma) {
        let time = signals[k].time(t);
        if contacts
            .wrenches
            .iter()
            .any(|w| w.motion == signals[k].name && (w.window[0]..=w.window[1]).contains(&time))
        {
            sum += squares;
            count += rows;
        }
    }
    sum > 0.5 * PUSHED * count as f64
}

/// The link and the force that explain a window, if one force on one link does.
fn explain(
    context: &Context<'_>,
    design: &Design,
    residual: &[f64],
    sigma: &[f64],
    signal: usize,
    window: [f64; 2],
) -> Option<(Wrench, [f64; 3])> {
    let s = &context.signals[signal];
    // Rows of all joints per instant.
    let mut instants: BTreeMap<usize, Vec<(usize, f64, f64)>> = BTreeMap::new();
    for j in 0..design.joints {
        for r in design.of_joint(j) {
            let at = design.rows[r];
            let time = s.time(at.centre);
            if at.signal == signal && time >= window[0] && time <= window[1] {
                instants.entry(at.centre).or_default().push((j, residual[r], design.y[r]));
            }
        }
    }
    let robot = context.model.robot();
    let frames: Vec<usize> =
        (0..robot.frames.len()).filter(|&f| robot.joint_of_frame()[f].is_some()).collect();
    let mut best: Option<(f64, usize, Vec<Vector3<f64>>)> = None;
    let mut whole = 0.0;
    for rows in instants.values() {
        whole += rows.iter().map(|(j, r, _)| (r / sigma[*j]).powi(2)).sum::<f64>();
    }
    for &frame in frames.iter().rev() {
        let mut left = 0.0;
        let mut forces = Vec::new();
        for (&t, rows) in &instants {
            let unit = units(context, frame, s, t);
            let f = force(&unit, rows, sigma);
            left += after(&unit, rows, sigma, &f);
            forces.push(f);
        }
        // A link further in must be clearly better: the same force seen from the next link is nearly as good.
        if best.as_ref().is_none_or(|b| left < 0.6 * b.0) {
            best = Some((left, frame, forces));
        }
    }
    let (left, frame, forces) = best?;
    if 1.0 - left / whole < EXPLAINED || forces.len() < 3 {
        return None;
    }
    // Held out: each instant is predicted with the mean force of its neighbours.
    let mut predicted = 0.0;
    for (i, (&t, rows)) in instants.iter().enumerate() {
        let neighbours: Vec<&Vector3<f64>> =
            [i.checked_sub(1), Some(i + 1)].into_iter().flatten().filter_map(|k| forces.get(k)).collect();
        let mean = neighbours.iter().copied().sum::<Vector3<f64>>() / neighbours.len().max(1) as f64;
        predicted += after(&units(context, frame, s, t), rows, sigma, &mean);
    }
    if 1.0 - predicted / whole < PREDICTED {
        return None;
    }
    let torque = instants.values().flatten().map(|(j, _, y)| (y / sigma[*j]).powi(2)).sum::<f64>();
    let mean = forces.iter().sum::<Vector3<f64>>() / forces.len() as f64;
    let largest = forces.iter().max_by(|a, b| a.norm().total_cmp(&b.norm())).copied().unwrap_or(mean);
    let wrench = Wrench {
        motion: s.name.clone(),
        window,
        link: frame + 1,
        force: [largest[0], largest[1], largest[2]],
        mean_force: [mean[0], mean[1], mean[2]],
        edges: None,
        joint_torques: Vec::new(),
    };
    Some((wrench, [whole, predicted, torque]))
}

pub(in crate::diagnosis) fn units(
    context: &Context<'_>,
    frame: usize,
    s: &Signals,
    t: usize,
) -> [Vec<f64>; 3] {
    let q: Vec<f64> = s.q.iter().map(|x| x[t]).collect();
    let mut out = [Vec::new(), Vec::new(), Vec::new()];
    unit_force_torques(context.model.robot(), context.tables(), frame, &q, &mut out);
    out
}

/// Weighted least-squares force at one instant.
pub(in crate::diagnosis) fn force(
    unit: &[Vec<f64>; 3],
    rows: &[(usize, f64, f64)],
    sigma: &[f64],
) -> Vector3<f64> {
    let mut g = Matrix3::zeros();
    let mut b = Vector3::zeros();
    for &(j, r, _) in rows {
        let w = 1.0 / (sigma[j] * sigma[j]);
        let c = Vector3::new(unit[0][j], unit[1][j], unit[2][j]);
        g += w * c * c.transpose();
        b += w * c * r;
    }
    g += Matrix3::identity() * (1e-6 * g.trace() + 1e-12);
    g.try_inverse().map_or_else(Vector3::zeros, |inverse| inverse * b)
}

pub(in crate::diagnosis) fn after(
    unit: &[Vec<f64>; 3],
    rows: &[(usize, f64, f64)],
    sigma: &[f64],
    f: &Vector3<f64>,
) -> f64 {
    rows.iter()
        .map(|&(j, r, _)| {
            let left = r - unit[0][j] * f[0] - unit[1][j] * f[1] - unit[2][j] * f[2];
            (left / sigma[j]).powi(2)
        })
        .sum()
}
