//! Factors as bytes: JSON, its numbers read back bit for bit.

use dynid_runtime::estimation::Factor;
use dynid_runtime::estimation::observe::{EquationFactor, Equations, LeftOut, Observation, TimeBlock};
use dynid_runtime::model::{JointIndex, ParameterKind, Robot};
use dynid_runtime::model_file::fingerprint;
use nalgebra::DMatrix;
use serde::{Deserialize, Serialize};

/// Version of the bytes.
const VERSION: u32 = 1;

/// Torque equations of motions.
#[derive(Serialize, Deserialize)]
struct Written {
    dynid_factors: u32,
    fingerprint: String,
    trajectories: Vec<Motion>,
    groups: Vec<Rows>,
    blocks: Vec<Block>,
    /// What noise added to the columns, column by column, for each group.
    noise: Option<Vec<Vec<f64>>>,
    samples: usize,
}

#[derive(Serialize, Deserialize)]
struct Motion {
    name: String,
    rate: f64,
    band: f64,
}

/// Rows of a joint in a motion, or in a block of its time.
#[derive(Serialize, Deserialize)]
struct Rows {
    trajectory: usize,
    equation: usize,
    columns: Vec<usize>,
    rows: usize,
    upper: Vec<f64>,
    /// Rows of [W Y] that the moments of reversals take; of a group only.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    reversals: Vec<Vec<f64>>,
    /// Used, at a standstill, fixed, outside of windows, at the edges; of a group only.
    counts: Option<[usize; 5]>,
}

#[derive(Serialize, Deserialize)]
struct Block {
    time: [f64; 2],
    equations: Vec<Rows>,
}

/// The bytes of an observation of torques.
///
/// # Errors
/// What JSON cannot hold.
pub(crate) fn write(observation: &Observation, robot: &Robot) -> Result<Vec<u8>, String> {
    let rows = |e: &EquationFactor, counts| Rows {
        trajectory: e.trajectory,
        equation: e.equation,
        columns: e.columns.clone(),
        rows: e.factor.rows(),
        upper: e.factor.upper(),
        reversals: e.reversals.clone(),
        counts,
    };
    let counts = |l: &LeftOut| Some([l.used, l.standstill, l.fixed, l.windows, l.edges]);
    let motions = observation.trajectories.iter().zip(observation.rates.iter().zip(&observation.bands));
    let written = Written {
        dynid_factors: VERSION,
        fingerprint: fingerprint(robot),
        trajectories: motions
            .map(|(name, (&rate, &band))| Motion { name: name.clone(), rate, band })
            .collect(),
        groups: observation
            .groups
            .iter()
            .zip(&observation.left_out)
            .map(|(e, l)| rows(e, counts(l)))
            .collect(),
        blocks: observation
            .blocks
            .iter()
            .map(|b| Block { time: b.time, equations: b.equations.iter().map(|e| rows(e, None)).collect() })
            .collect(),
        noise: observation
            .noise_of_columns
            .as_ref()
            .map(|all| all.iter().map(|m| m.as_slice().to_vec()).collect()),
        samples: observation.samples,
    };
    serde_json::to_vec(&written).map_err(|why| why.to_string())
}

/// The observation that was written, for the robot that it is of.
///
/// # Errors
/// What is wrong with the bytes, or that they are of another robot.
pub(crate) fn read(bytes: &[u8], robot: &Robot) -> Result<Observation, String> {
    let written: Written =
        serde_json::from_slice(bytes).map_err(|why| format!("these are no factors: {why}"))?;
    if written.dynid_factors != VERSION {
        return Err(format!("factors of version {}, this dynid reads {VERSION}", written.dynid_factors));
    }
    if written.fingerprint != fingerprint(robot) {
        return Err(format!("factors of another robot than {}", robot.name));
    }
    let (motions, joints, base) = (written.trajectories.len(), robot.joints(), robot.base.len());
    let positive = |m: &Motion| m.rate.is_finite() && m.rate > 0.0 && m.band.is_finite() && m.band > 0.0;
    if joints == 0 || motions == 0 || !written.trajectories.iter().all(positive) {
        return Err("factors without motions, or with rates that cannot be".to_owned());
    }
    let complete = |equations: &[Rows]| {
        let places = equations.iter().enumerate();
        equations.len().is_multiple_of(joints) && places.into_iter().all(|(k, e)| e.equation == k % joints)
    };
    let blocks_complete = written.blocks.iter().all(|b| {
        let first = b.equations.first().map(|e| e.trajectory);
        b.equations.len() == joints
            && complete(&b.equations)
            && b.equations.iter().all(|e| Some(e.trajectory) == first)
    });
    let in_order = written.groups.iter().enumerate().all(|(k, e)| e.trajectory == k / joints);
    if written.groups.len() != motions * joints || !complete(&written.groups) || !in_order || !blocks_complete
    {
        return Err("factors whose equations are not those of their motions".to_owned());
    }
    let equation = |e: &Rows| read_equation(e, motions, base);
    let groups: Vec<EquationFactor> = written.groups.iter().map(equation).collect::<Result<_, _>>()?;
    let block = |b: &Block| -> Result<TimeBlock, String> {
        let equations: Vec<EquationFactor> = b.equations.iter().map(equation).collect::<Result<_, _>>()?;
        Ok(TimeBlock { trajectory: equations.first().map_or(0, |e| e.trajectory), time: b.time, equations })
    };
    let blocks = written.blocks.iter().map(block).collect::<Result<_, _>>()?;
    let noise_of_columns = written.noise.as_ref().map(|all| read_noise(all, &groups)).transpose()?;
    Ok(Observation {
        equations: Equations::Torque,
        unknowns: robot.base.iter().map(|b| b.name.to_string()).collect(),
        base,
        fixed: robot.fixed_base(),
        exact: exact(robot),
        trajectories: written.trajectories.iter().map(|m| m.name.clone()).collect(),
        rates: written.trajectories.iter().map(|m| m.rate).collect(),
        bands: written.trajectories.iter().map(|m| m.band).collect(),
        left_out: written.groups.iter().map(|e| left_out(e, robot)).collect(),
        samples: written.samples,
        groups,
        blocks,
        noise_of_columns,
        rows: None,
    })
}

fn read_equation(e: &Rows, motions: usize, base: usize) -> Result<EquationFactor, String> {
    let ascending = e.columns.windows(2).all(|w| w[0] < w[1]);
    if e.trajectory >= motions || !ascending || e.columns.last().is_some_and(|&c| c >= base) {
        return Err("factors with columns that the robot has no parameters for".to_owned());
    }
    let factor = Factor::from_upper(e.columns.len(), e.rows, &e.upper);
    let factor = factor.ok_or("factors whose triangles are not complete")?;
    let fits = |row: &Vec<f64>| row.len() == e.columns.len() + 1 && row.iter().all(|x| x.is_finite());
    if !e.reversals.iter().all(fits) {
        return Err("factors whose rows of reversals are not complete".to_owned());
    }
    Ok(EquationFactor {
        trajectory: e.trajectory,
        equation: e.equation,
        columns: e.columns.clone(),
        factor,
        reversals: e.reversals.clone(),
    })
}

fn read_noise(all: &[Vec<f64>], groups: &[EquationFactor]) -> Result<Vec<DMatrix<f64>>, String> {
    let fits = |(noise, group): (&Vec<f64>, &EquationFactor)| {
        noise.len() == group.columns.len().pow(2) && noise.iter().all(|x| x.is_finite())
    };
    if all.len() != groups.len() || !all.iter().zip(groups).all(fits) {
        return Err("factors whose noise is not that of their columns".to_owned());
    }
    let matrix = |(noise, group): (&Vec<f64>, &EquationFactor)| {
        DMatrix::from_column_slice(group.columns.len(), group.columns.len(), noise)
    };
    Ok(all.iter().zip(groups).map(matrix).collect())
}

fn left_out(e: &Rows, robot: &Robot) -> LeftOut {
    let [used, standstill, fixed, windows, edges] = e.counts.unwrap_or([e.rows, 0, 0, 0, 0]);
    let joint = Some(robot.joint_number(JointIndex(e.equation)));
    LeftOut { trajectory: e.trajectory, equation: e.equation, joint, used, standstill, fixed, windows, edges }
}

/// Unknowns whose columns have no measuring errors in the torque equations: constants, and the sign of the speed.
fn exact(robot: &Robot) -> Vec<bool> {
    let constant =
        |kind: ParameterKind| matches!(kind, ParameterKind::Off | ParameterKind::KR) || kind.is_coulomb();
    robot.base.iter().map(|b| constant(robot.standard[b.standard].kind)).collect()
}
