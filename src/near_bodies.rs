//! Standard parameters that bodies can have: nearest to a prior among those that have the identified base parameters.

use std::path::Path;

use dynid_runtime::estimation::{
    NearPrior, NearPriorError, Prior, Released, ellipsoid_margin, near_prior, released, uniform_body,
};
use dynid_runtime::model::{Ellipsoid, JointKind, ParameterKind, Robot};
use dynid_runtime::model_file::Identified;
use dynid_runtime::report::significant;
use dynid_urdf::{Body, LinkBound, Pose, Template, value};
use nalgebra::{Matrix3, SymmetricEigen};

use crate::meshes;
use crate::output::{table, warn};

/// What is taken where nothing is known of a body: a ball at the frame's origin with this radius of gyration, m, its mass
/// that of the others in the mean.
const BALL_GYRATION: f64 = 0.1;
/// Least spread of a prior body in any direction, m, and as a part of its largest: thinner ones have no density.
const THINNEST: f64 = 1e-3;
const FLATTEST: f64 = 1e-2;

/// Chance of a least distance below which no bodies are said to have the identified values.
const IMPROBABLE: f64 = 0.01;

/// What a table knows of bodies.
#[derive(Debug, Clone, Copy, Default)]
pub struct Table<'a> {
    /// Nominal standard parameters.
    pub nominal: Option<&'a [f64]>,
    /// Ellipsoids that hold the mass of links, by index of the frame.
    pub ellipsoids: &'a [(usize, Ellipsoid)],
}

impl<'a> Table<'a> {
    /// What the table of a robot knows.
    pub fn of(robot: &'a Robot) -> Self {
        let nominal = robot.nominal.as_ref().map(|nominal| nominal.standard.as_ref());
        Self { nominal, ellipsoids: &robot.ellipsoids }
    }
}

/// Bodies of a model, and what was known before.
pub struct NearBodies {
    /// The bodies' standard parameters, and how they were found.
    pub near: NearPrior,
    /// Standard parameters of the prior.
    pub prior: Vec<f64>,
    /// Each moving body's ellipsoid, or why it has none; empty where the prior has no geometry.
    pub links: Vec<LinkBound>,
    /// The same bodies without ellipsoids, where there are some.
    pub unbounded: Option<NearPrior>,
    /// How near the parameters would be without what holds one body or rotor; empty where hardly anything holds them.
    pub released: Vec<Released>,
}

impl NearBodies {
    /// Bodies with the base parameters `chi` of a model within their uncertainty, nearest to a template's, and within its
    /// geometry, or nearest to those of a `table` with nominal parameters, and within its ellipsoids, where there is none. Meshes
    /// are looked for from the template's path on.
    ///
    /// # Errors
    /// As of [`near_prior`].
    pub fn new(
        identified: &Identified,
        robot: &Robot,
        table: Table<'_>,
        template: Option<(&Template<'_>, &Path)>,
    ) -> Result<Self, NearPriorError> {
        let chi = identified.chi(robot).map_err(|_| NearPriorError::Shape)?;
        let links = template.map_or_else(
            || table_bounds(robot, table.ellipsoids),
            |(template, path)| template.bounds(&|mesh| meshes::vertices(path, mesh)),
        );
        let has_some = links.iter().any(|link| link.ellipsoid.is_ok());
        let mut ellipsoids = vec![None; robot.frames.len()];
        links.iter().for_each(|link| ellipsoids[link.frame] = link.ellipsoid.as_ref().ok().copied());
        let (prior, values) = prior(robot, table.nominal, template.map(|(template, _)| template), ellipsoids);
        let covariance = identified.base_covariance(robot);
        let near = near_prior(robot, &chi, &covariance, &prior)?;
        let unbounded = has_some.then(|| {
            let free = Prior { ellipsoids: vec![None; robot.frames.len()], ..prior.clone() };
            near_prior(robot, &chi, &covariance, &free).ok()
        });
        // As many as this are within the uncertainty of one parameter.
        let released = match near.least > 1.0 {
            true => released(robot, &chi, &covariance, &prior)?,
            false => Vec::new(),
        };
        // Where no link has geometry there is nothing to say of it.
        let is_bounded = template.is_none_or(|(template, _)| template.has_geometry());
        let links = if is_bounded { links } else { Vec::new() };
        Ok(Self { near, prior: values, links, unbounded: unbounded.flatten(), released })
    }

    /// What the data and what the prior decided, and how near the base parameters are.
    pub fn words(&self, identified: &Identified, robot: &Robot) -> String {
        let near = &self.near;
        let shown = |k: &usize| {
            let kind = robot.standard[*k].kind;
            let inertial = ParameterKind::INERTIAL.contains(&kind) || kind == ParameterKind::Ia;
            inertial && (near.standard[*k] != 0.0 || self.prior[*k] != 0.0)
        };
        let row = |k: usize| {
            let p = &robot.standard[k];
            let unit = p.unit(robot.frames[p.frame].kind, &robot.couplings).to_owned();
            let percent = format!("{:.0}", 100.0 * near.from_data[k]);
            vec![
                p.name.to_string(),
                significant(self.prior[k], 4),
                significant(near.standard[k], 4),
                unit,
                percent,
            ]
        };
        let rows = (0..near.standard.len()).filter(shown).map(row).collect();
        let mut text = table(&["<parameter", "prior", "value", "<unit", "from the data, %"], rows);
        text.push_str(&format!(
            "\n\n{} of {} base parameters are determined; with these bodies they differ by {} standard deviations in the mean",
            near.determined,
            robot.base.len(),
            significant((near.distance / near.determined.max(1) as f64).sqrt(), 2)
        ));
        text.push_str(&format!(
            "\nthe prior has weight {}, the largest with about the least expected error of the torques (Mallows' Cp): of the {} it leaves {} to the data",
            significant(near.gamma, 3),
            near.determined,
            significant(near.freedom, 3)
        ));
        if near.dispersion > 1.0 {
            let times = significant(near.dispersion.sqrt(), 2);
            text.push_str(&format!("; uncertainties count {times} times, because no bodies are nearer"));
        }
        if near.p_value < IMPROBABLE {
            text.push_str(&format!(
                "\nwarning: no bodies have the identified base parameters within their uncertainty. Farthest off: {}",
                self.farthest(identified, robot).join(", ")
            ));
        }
        text
    }

    /// The base parameters that bodies cannot have as they were identified, farthest first.
    fn farthest(&self, identified: &Identified, robot: &Robot) -> Vec<String> {
        let mut off: Vec<(f64, String)> = Vec::new();
        for (k, b) in robot.base.iter().enumerate() {
            let Some(p) = identified.base_parameters.iter().find(|p| p.name == b.name) else { continue };
            let Some(sigma) = p.sigma.filter(|s| *s > 0.0) else { continue };
            let own = self.near.chi[k];
            let words = format!("{} {} to {}", b.name, significant(p.value, 3), significant(own, 3));
            off.push(((own - p.value).abs() / sigma, words));
        }
        off.sort_by(|a, b| b.0.total_cmp(&a.0));
        off.into_iter().take(3).map(|(far, words)| format!("{words} ({far:.1} sigma)")).collect()
    }
}

/// What a table says of where each moving body is; empty where it says nothing.
fn table_bounds(robot: &Robot, ellipsoids: &[(usize, Ellipsoid)]) -> Vec<LinkBound> {
    let motions = robot.motions();
    let own = |frame: usize| ellipsoids.iter().find(|(k, _)| *k == frame).map(|(_, ellipsoid)| *ellipsoid);
    let has_mass = |frame: usize| {
        !robot
            .known
            .iter()
            .any(|&k| robot.standard[k].frame == frame && robot.standard[k].kind == ParameterKind::M)
    };
    let bound = |frame: usize| LinkBound {
        frame,
        link: format!("link{}", frame + 1),
        ellipsoid: own(frame).ok_or_else(|| "the table has none".to_owned()),
    };
    let told =
        |frame: &usize| own(*frame).is_some() || motions[*frame].kind != JointKind::Fixed && has_mass(*frame);
    if ellipsoids.is_empty() { Vec::new() } else { (0..motions.len()).filter(told).map(bound).collect() }
}

/// The prior of a robot's bodies, and its standard parameters: the template's, else the nominal ones.
fn prior(
    robot: &Robot,
    nominal: Option<&[f64]>,
    template: Option<&Template<'_>>,
    mut ellipsoids: Vec<Option<Ellipsoid>>,
) -> (Prior, Vec<f64>) {
    let frames = robot.frames.len();
    let nominal = nominal.map_or_else(|| vec![0.0; robot.standard.len()], <[f64]>::to_vec);
    let frame_body = |frame: usize| {
        Body::from_parameters(&ParameterKind::INERTIAL.map(|kind| value(robot, &nominal, frame, kind)))
    };
    let mut own: Vec<(Body, String)> =
        (0..frames).map(|f| (frame_body(f), format!("link {}", f + 1))).collect();
    let mut attached = vec![[0.0; 10]; frames];
    if let Some(template) = template {
        own.iter_mut().for_each(|(body, _)| *body = Body::none());
        for body in template.bodies() {
            attached[body.frame] = body.attached.parameters();
            own[body.frame] = (body.own, format!("link '{}' of the template", body.link));
        }
    }
    let masses: Vec<f64> = own.iter().map(|(body, _)| body.mass).filter(|m| *m > 0.0).collect();
    let mean = if masses.is_empty() { 1.0 } else { masses.iter().sum::<f64>() / masses.len() as f64 };
    let moves = robot.joint_of_frame();
    let bodies: Vec<Option<[f64; 10]>> = own
        .iter()
        .enumerate()
        .map(|(f, (body, name))| {
            // A fixed frame that carries nothing is only a frame, and so is one whose link is known to have no mass.
            let massless = robot
                .known
                .iter()
                .any(|&k| robot.standard[k].frame == f && robot.standard[k].kind == ParameterKind::M);
            (!massless && (moves[f].is_some() || body.mass > 0.0))
                .then(|| possible(body, mean, name, ellipsoids[f].as_ref()).parameters())
        })
        .collect();
    let ia = |f: usize| value(robot, &nominal, f, ParameterKind::Ia);
    let rotors =
        (0..frames).filter(|&f| moves[f].is_some()).map(|f| Some(ia(f)).filter(|x| *x > 0.0)).collect();
    let mut standard = nominal;
    for (k, p) in robot.standard.iter().enumerate() {
        if let Some(place) = ParameterKind::INERTIAL.iter().position(|kind| *kind == p.kind) {
            standard[k] = bodies[p.frame].map_or(0.0, |body| body[place]) + attached[p.frame][place];
        }
    }
    ellipsoids.iter_mut().zip(&bodies).filter(|(_, body)| body.is_none()).for_each(|(e, _)| *e = None);
    (Prior { bodies, attached, rotors, ellipsoids }, standard)
}

/// A body as a prior: with a density, where the numbers have none; a ball, or what fills its geometry, where there are no
/// numbers.
fn possible(body: &Body, mean_mass: f64, name: &str, within: Option<&Ellipsoid>) -> Body {
    let Some((mass, centre, moments)) = body.centred() else {
        if let Some(full) = within.and_then(|within| uniform_body(within, mean_mass)) {
            let mass = significant(mean_mass, 3);
            warn(&format!("{name} has no inertial: {mass} kg that fill its geometry evenly stand for it"));
            return Body::from_parameters(&full);
        }
        warn(&format!("{name} has no inertial: a ball of {} kg stands for it", significant(mean_mass, 3)));
        let moment = 0.4 * mean_mass * BALL_GYRATION * BALL_GYRATION;
        return Body::at_centre(mean_mass, [moment, 0.0, 0.0, moment, 0.0, moment]);
    };
    if within.is_some_and(|within| ellipsoid_margin(within, &body.parameters()).is_some_and(|m| m <= 0.0)) {
        warn(&format!(
            "{name}: its inertial is not that of a body within its geometry; the result is within all the same"
        ));
    }
    let spread = (Matrix3::from_diagonal_element(0.5 * moments.trace()) - moments) / mass;
    let mut eigen = SymmetricEigen::new((spread + spread.transpose()) * 0.5);
    let least = (THINNEST * THINNEST).max(FLATTEST * FLATTEST * eigen.eigenvalues.max());
    if eigen.eigenvalues.min() >= least {
        return *body;
    }
    if !body.is_possible() {
        warn(&format!(
            "{name}: no body has its inertia; the nearest with a density stands for it in the prior"
        ));
    }
    eigen.eigenvalues.apply(|x| *x = x.max(least));
    let spread = eigen.recompose() * mass;
    let moments = Matrix3::from_diagonal_element(spread.trace()) - spread;
    let m = |i: usize, j: usize| moments[(i, j)];
    Body::at_centre(mass, [m(0, 0), m(0, 1), m(0, 2), m(1, 1), m(1, 2), m(2, 2)])
        .seen_from(&Pose { translation: centre, ..Pose::identity() })
}
