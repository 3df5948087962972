//! From recorded columns to joint-side SI.

use std::ops::Range;

use nalgebra::DMatrix;

use super::RecordingError;
use super::files::Source;
use super::manifest::{Channel, Manifest, Side};
use super::unit::{Quantity, Unit};
use crate::model::{JointIndex, JointKind, JointNumber, Robot};

/// What is the same for all windows.
pub(super) struct Conversions {
    pub position: Conversion,
    pub velocity: Option<Conversion>,
    pub torque: Conversion,
    /// gear^-1 and gearT; `None` on the joint side.
    pub motor: Option<(DMatrix<f64>, DMatrix<f64>)>,
}

/// (x + offset) * gain per joint.
pub(super) struct Conversion {
    offset: Vec<f64>,
    gain: Vec<f64>,
}

impl Conversions {
    /// Checks the channels of a manifest against the robot.
    pub(super) fn new(manifest: &Manifest, robot: &Robot) -> Result<Self, RecordingError> {
        let joints = robot.joints();
        if !manifest.joints.is_empty() && manifest.joints.len() != joints {
            let message = format!("{} named, but {} has {joints} joints", manifest.joints.len(), robot.name);
            return Err(manifest.error(&["joints"], &message));
        }
        let motor = match manifest.side {
            Side::Joint => None,
            Side::Motor => {
                let gear = DMatrix::from_row_slice(joints, joints, &robot.drive.gear);
                let Some(inverse) = gear.clone().try_inverse() else {
                    let message =
                        format!("the gear matrix of {} is singular: motor angles say nothing", robot.name);
                    return Err(manifest.error(&["side"], &message));
                };
                Some((inverse, gear.transpose()))
            }
        };
        Ok(Self {
            position: conversion(manifest, robot, "position", &manifest.position)?,
            velocity: manifest
                .velocity
                .as_ref()
                .map(|v| conversion(manifest, robot, "velocity", v))
                .transpose()?,
            torque: conversion(manifest, robot, "torque", &manifest.torque)?,
            motor,
        })
    }
}

fn conversion(
    manifest: &Manifest,
    robot: &Robot,
    quantity: &str,
    channel: &Channel,
) -> Result<Conversion, RecordingError> {
    let joints = robot.joints();
    let per_joint = |key: &str, found: usize, one_for_all: bool| {
        if found == joints || found == 0 || (one_for_all && found == 1) {
            return Ok(());
        }
        let message = format!("{found} given, but {} has {joints} joints", robot.name);
        Err(manifest.error(&[quantity, key], &message))
    };
    if channel.columns.is_empty() && manifest.joints.is_empty() {
        return Err(manifest.error(&[quantity, "columns"], "no column is named"));
    }
    per_joint("columns", channel.columns.len(), false)?;
    per_joint("unit", channel.unit.len(), true)?;
    per_joint("offset", channel.offset.len(), false)?;
    per_joint("gain", channel.gain.len(), false)?;
    let mut gain = channel.gain.clone();
    for (j, kind) in robot.joint_kinds().into_iter().enumerate() {
        let Some(unit) = channel.unit.get(j).or(channel.unit.first()) else { continue };
        check_unit(unit, quantity, kind, manifest.side, robot.joint_number(JointIndex(j)))
            .map_err(|message| manifest.error(&[quantity, "unit"], &message))?;
        if unit.quantity == Quantity::Raw && channel.gain.is_empty() {
            let message =
                format!("`{}` needs a `gain`, the SI value of one {} for each joint", unit.name, unit.name);
            return Err(manifest.error(&[quantity, "unit"], &message));
        }
        gain.resize(joints, 1.0);
        gain[j] *= unit.factor;
    }
    gain.resize(joints, 1.0);
    if let Some(j) = gain.iter().position(|g| *g == 0.0) {
        let message =
            format!("0 for joint {}: nothing would be left of the signal", robot.joint_number(JointIndex(j)));
        return Err(manifest.error(&[quantity, "gain"], &message));
    }
    let mut offset = channel.offset.clone();
    offset.resize(joints, 0.0);
    Ok(Conversion { offset, gain })
}

/// Whether a unit of a channel is one of the joint's, or of its motor's.
fn check_unit(
    unit: &Unit,
    quantity: &str,
    kind: JointKind,
    side: Side,
    number: JointNumber,
) -> Result<(), String> {
    let [angular_unit, linear_unit] = match quantity {
        "position" => [Quantity::Angle, Quantity::Length],
        "velocity" => [Quantity::AngularVelocity, Quantity::LinearVelocity],
        _ => [Quantity::Torque, Quantity::Force],
    };
    let linear = kind == JointKind::Prismatic;
    // A motor may drive a prismatic joint by an angle; on the joint side the unit must be the joint's.
    let fits = match unit.quantity {
        Quantity::Raw => true,
        q if side == Side::Motor => q == angular_unit || q == linear_unit,
        q => q == if linear { linear_unit } else { angular_unit },
    };
    if fits {
        return Ok(());
    }
    let kind = if linear { "prismatic" } else { "revolute" };
    let wanted = Unit::names_of(&[if linear { linear_unit } else { angular_unit }]);
    Err(format!(
        "`{}` does not fit joint {number}, which is {kind}: expected one of {wanted} (a list gives every joint its own)",
        unit.name
    ))
}

/// Appends rows `run` of a channel, in SI and on the joint side.
pub(super) fn convert(
    sources: &[Source],
    places: &[(usize, usize)],
    conversion: &Conversion,
    matrix: Option<&DMatrix<f64>>,
    run: Range<usize>,
    out: &mut [Vec<f64>],
) {
    let column = |k: usize| {
        let (source, slot) = places[k];
        let (offset, gain) = (conversion.offset[k], conversion.gain[k]);
        sources[source].1.columns[slot][run.clone()].iter().map(move |x| (x + offset) * gain)
    };
    for (j, out) in out.iter_mut().enumerate() {
        let Some(matrix) = matrix else {
            out.extend(column(j));
            continue;
        };
        let start = out.len();
        out.resize(start + run.len(), 0.0);
        for k in (0..places.len()).filter(|&k| matrix[(j, k)] != 0.0) {
            let factor = matrix[(j, k)];
            out[start..].iter_mut().zip(column(k)).for_each(|(o, x)| *o += factor * x);
        }
    }
}
