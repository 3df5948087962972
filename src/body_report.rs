//! What is said of bodies: how near they are to what was identified, what holds them, and which of them cannot be.

use dynid_runtime::estimation::Constraint;
use dynid_runtime::estimation::observe::Observation;
use dynid_runtime::model::{JointIndex, Robot};
use dynid_runtime::model_file::{Bodies, Impossible, LinkEllipsoid};
use dynid_runtime::prediction::observed_errors;
use dynid_runtime::report::{percent, significant};

use crate::near_bodies::NearBodies;
use crate::output::table;

/// By how much a constraint must raise the least distance to be told: 95 % of a square of a normal number.
const TOLD: f64 = 3.84;

/// All of it. `torques` are those that the parameters were identified from, where they are at hand, and `free` the identified
/// parameters' relative error of them.
pub fn report(
    bodies: &NearBodies,
    robot: &Robot,
    torques: Option<&Observation>,
    free: Option<f64>,
) -> Bodies {
    let near = &bodies.near;
    let error = |chi: &[f64]| torques.and_then(|rows| observed_errors(rows, chi).relative_error);
    let name = |what: Constraint| match what {
        Constraint::Body(frame) => format!("link {}", frame + 1),
        Constraint::Rotor(motor) => format!("rotor {}", robot.joint_number(JointIndex(motor))),
    };
    let ellipsoid = |link: &dynid_urdf::LinkBound| {
        let held = near.bounds[link.frame];
        LinkEllipsoid {
            frame: link.frame + 1,
            link: link.link.clone(),
            margin: held.map(|held| held.margin),
            margin_of_prior: held.map(|held| held.of_prior),
            active: held.is_some_and(|held| held.is_active),
            none_because: link.ellipsoid.as_ref().err().cloned(),
        }
    };
    let costs = bodies.released.iter().filter(|released| near.least - released.least > TOLD);
    Bodies {
        determined: near.determined,
        distance: near.distance,
        least: near.least,
        prior_weight: Some(near.gamma),
        from_data: Some(near.freedom),
        dispersion: Some(near.dispersion),
        relative_errors: torques.map(|_| [free, error(&near.least_chi)]),
        ellipsoids: bodies.links.iter().map(ellipsoid).collect(),
        without_ellipsoids: bodies.unbounded.as_ref().map(|free| [free.distance, free.least]),
        impossible: costs
            .map(|one| Impossible { what: name(one.what), least: one.least, relative_error: error(&one.chi) })
            .collect(),
    }
}

/// In words; empty where nothing holds the bodies.
pub fn words(bodies: &Bodies) -> String {
    let mut text = String::new();
    if !bodies.ellipsoids.is_empty() {
        text.push_str(
            "kept within the ellipsoids of their geometry; margin 1: at the centre, 0.4: evenly filled, 0: at the surface\n",
        );
        text.push_str(&table(&ELLIPSOIDS, ellipsoid_rows(bodies)));
        if let Some([distance, least]) = bodies.without_ellipsoids {
            text.push_str(&format!(
                "\nsquared distance of the base parameters {} with them, {} without; least possible {} and {}",
                significant(bodies.distance, 3),
                significant(distance, 3),
                significant(bodies.least, 3),
                significant(least, 3)
            ));
        }
    }
    if !bodies.impossible.is_empty() {
        if !text.is_empty() {
            text.push('\n');
        }
        text.push_str(&format!(
            "what cannot be as it was identified: if it alone need not be a body, or a rotor with an inertia above 0, the least \
             squared distance of {} would be\n",
            significant(bodies.least, 3)
        ));
        text.push_str(&table(&IMPOSSIBLE, impossible_rows(bodies)));
    }
    text
}

/// Headers of [`ellipsoid_rows`].
pub const ELLIPSOIDS: [&str; 4] = ["<link", "margin of the prior", "margin", "<"];

/// A row for each link.
pub fn ellipsoid_rows(bodies: &Bodies) -> Vec<Vec<String>> {
    let number = |value: Option<f64>| value.map_or_else(|| "-".to_owned(), |v| significant(v, 2));
    let row = |link: &LinkEllipsoid| {
        // What rounding leaves of 0.
        let margin = link.margin.map(|margin| if link.active { 0.0 } else { margin });
        let says = match &link.none_because {
            Some(why) => format!("not bounded: {why}"),
            None if link.active => "held back by it".to_owned(),
            None => String::new(),
        };
        let name = format!("{} '{}'", link.frame, link.link);
        vec![name, number(link.margin_of_prior), number(margin), says]
    };
    bodies.ellipsoids.iter().map(row).collect()
}

/// Headers of [`impossible_rows`].
pub const IMPOSSIBLE: [&str; 3] = ["<without", "least distance", "error of the torques there"];

/// A row for each link or rotor that cannot be as it was identified.
pub fn impossible_rows(bodies: &Bodies) -> Vec<Vec<String>> {
    let error = |error: Option<f64>| error.map_or_else(|| "-".to_owned(), percent);
    bodies
        .impossible
        .iter()
        .map(|one| vec![one.what.clone(), significant(one.least, 3), error(one.relative_error)])
        .collect()
}
