//! Springs between two points: which points, and which joints change their distance.

use super::coupled_robot::Known;
use super::document::Node;
use super::magnitudes::within;
use super::reader::Reader;
use dynid_description::bounds::LONGEST;
use dynid_description::{Between, Frame, JointKind, Motion, motions};

const POINT_KEYS: [&str; 2] = ["frame", "point"];
/// States at which distances are compared. What is the same at all of them, drawn without regard to the table, is the same.
const STATES: usize = 12;
/// Of a length, below which a difference is rounding.
const ROUNDING: f64 = 1e-9;

/// The two points of an entry, `rest` left out.
pub(super) fn read_points(reader: &mut Reader, node: &Node, known: &Known<'_>) -> Option<Between> {
    let what = "two points ([{frame: 0, point: [0, 0, 1]}, {frame: 2, point: [0.3, 0, 0]}])";
    let [first, second] = reader.list(node, what)? else {
        reader.report(node.place, format!("expected {what}"));
        return None;
    };
    let first = read_point(reader, first, known);
    let ((a, p), (b, q)) = (first?, read_point(reader, second, known)?);
    Some(Between { frames: [a, b], points: [p, q], rest: None })
}

fn read_point(reader: &mut Reader, node: &Node, known: &Known<'_>) -> Option<(Option<usize>, [f64; 3])> {
    let fields = reader.fields(node, "a point", &POINT_KEYS)?;
    let at = reader.required(&fields, "frame")?;
    let j = reader.integer(at, "the number j of a frame, 0 for the base")?;
    if j > known.frames.len() {
        reader.report(
            at.place,
            format!("there is no frame {j}: the table has frames 1 to {}", known.frames.len()),
        );
        return None;
    }
    let at = reader.required(&fields, "point")?;
    let point = reader.numbers(at, "point", 3, known.constants)?;
    point.iter().for_each(|&x| within(reader, at, "point", x, [0.0, LONGEST]));
    Some((j.checked_sub(1), [point[0], point[1], point[2]]))
}

/// The joints that the length of a spring changes with, each with 1.
///
/// # Errors
/// Why torques would not show its constants: a length that stays, that is linear in joint positions, or that is that of
/// another spring but for a factor.
pub(super) fn joints_of(
    between: &Between,
    others: &[Between],
    known: &Known<'_>,
) -> Result<Vec<(usize, f64)>, String> {
    let frames: Vec<Frame> = known.frames.iter().map(|row| row.evaluated()).collect();
    let moves = motions(frames.iter().map(|f| f.kind), known.dependent);
    let table = (frames.as_slice(), moves.as_slice());
    let n = known.joints.len();
    // Multiples of the golden ratio, modulo 1: generic, and the same on every run.
    let mut counter = 0.0;
    let mut next = || {
        counter += 1.0;
        4.0 * ((counter * 0.618_033_988_749_894_9_f64).fract() - 0.5)
    };
    let states: Vec<Vec<f64>> = (0..STATES).map(|_| (0..n).map(|_| next()).collect()).collect();
    let lengths: Vec<f64> = states.iter().map(|q| distance(table, between, q)).collect();
    let largest = lengths.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
    let changes = |joint: usize| {
        states.iter().zip(&lengths).any(|(q, length)| {
            let mut moved = q.clone();
            moved[joint] += 0.7;
            (distance(table, between, &moved) - length).abs() > ROUNDING * largest
        })
    };
    let terms: Vec<(usize, f64)> = (0..n).filter(|&joint| changes(joint)).map(|joint| (joint, 1.0)).collect();
    if terms.is_empty() {
        return Err("no joint changes the distance of these points, so that a spring between them does nothing: take \
                    points that are not on the axis of the joints between them"
            .to_owned());
    }
    if is_linear(table, between, &states, largest) {
        return Err(
            "this distance is linear in the position of a joint: write the spring as one on that joint \
                    (joint: 2), whose constants are the same"
                .to_owned(),
        );
    }
    let same = |other: &&Between| {
        let ratios: Vec<f64> =
            states.iter().zip(&lengths).map(|(q, l)| distance(table, other, q) / l).collect();
        ratios.iter().all(|r| (r - ratios[0]).abs() < ROUNDING * ratios[0].abs())
    };
    if others.iter().any(|other| same(&other)) {
        return Err(
            "this is the distance of another spring, or a multiple of it: torques know their sum only"
                .to_owned(),
        );
    }
    Ok(terms)
}

/// Whether a distance is linear in joint positions near every state.
fn is_linear(table: (&[Frame], &[Motion]), between: &Between, states: &[Vec<f64>], largest: f64) -> bool {
    states.windows(2).all(|pair| {
        let at = |t: f64| {
            let q: Vec<f64> = pair[0].iter().zip(&pair[1]).map(|(a, b)| a + t * (b - a)).collect();
            distance(table, between, &q)
        };
        (at(0.0) - 2.0 * at(1e-2) + at(2e-2)).abs() < ROUNDING * largest
    })
}

/// Distance of the points where the joints are at q, m.
fn distance((frames, moves): (&[Frame], &[Motion]), between: &Between, q: &[f64]) -> f64 {
    let place = |end: usize| {
        let mut p = between.points[end];
        let mut at = between.frames[end];
        while let Some(k) = at {
            let f = &frames[k];
            let moved: f64 = moves[k].terms.iter().map(|&(joint, c)| c * q[joint]).sum();
            let (mut theta, mut r) = (f.theta, f.r);
            match moves[k].kind {
                JointKind::Revolute => theta += moved,
                JointKind::Prismatic => r += moved,
                JointKind::Fixed => {}
            }
            p = turned(theta, p, 2);
            p = turned(f.alpha, [p[0] + f.d, p[1], p[2] + r], 0);
            p = turned(f.gamma, [p[0], p[1], p[2] + f.b], 2);
            at = f.parent;
        }
        p
    };
    let (a, b) = (place(0), place(1));
    (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt()
}

/// A vector turned about an axis.
fn turned(angle: f64, v: [f64; 3], axis: usize) -> [f64; 3] {
    let (s, c) = angle.sin_cos();
    let (i, k) = ((axis + 1) % 3, (axis + 2) % 3);
    let mut out = v;
    (out[i], out[k]) = (c * v[i] - s * v[k], s * v[i] + c * v[k]);
    out
}
