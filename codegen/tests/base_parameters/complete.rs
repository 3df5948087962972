//! The base has the numeric rank and gives the same torques: shipped robots under any gravity, and random tables.

use crate::random_robot::{add_couplings, make_dependent, random_robot, table};
use crate::rank::{check, observations, rank};
use crate::shipped::robots;
use dynid_codegen::base::base_set;
use dynid_codegen::robot::RobotTable;
use dynid_description::ParameterKind;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

#[test]
fn the_base_of_every_robot_has_the_numeric_rank_and_the_same_torques_under_any_gravity() {
    let mut random = Pcg64::seed_from_u64(7);
    for mut robot in robots() {
        let name = robot.name.clone();
        for gravity in
            [robot.gravity, [0.0; 3], [9.81, 0.0, 0.0], [0.0, 9.81, 0.0], [0.0, 0.0, 9.81], [1.0, 2.0, 3.0]]
        {
            robot.gravity = gravity;
            check(&robot, &mut random).unwrap_or_else(|e| panic!("{name} in {gravity:?}: {e}"));
        }
    }
}

/// That random tables, so many of them, are right.
fn all_right(
    tables: usize,
    seed: u64,
    mut make: impl FnMut(usize, &mut Pcg64) -> RobotTable,
    mut check: impl FnMut(&RobotTable, &mut Pcg64) -> Result<(), String>,
) {
    let mut random = Pcg64::seed_from_u64(seed);
    let mut wrong = Vec::new();
    for trial in 0..tables {
        let robot = make(trial, &mut random);
        if let Err(e) = check(&robot, &mut random) {
            wrong.push(format!("table {trial}: {e}\n{}", table(&robot)));
        }
    }
    let first = wrong[..wrong.len().min(3)].join("\n");
    assert!(wrong.is_empty(), "{} of {tables} wrong\n{first}", wrong.len());
}

#[test]
fn the_base_of_random_tables_has_the_numeric_rank_and_the_same_torques() {
    all_right(300, 20, |_, random| random_robot(random), check);
}

#[test]
fn the_base_of_random_tables_with_dependent_frames_has_the_numeric_rank_and_the_same_torques() {
    let mut dependent = 0;
    let make = |_, random: &mut Pcg64| {
        let mut robot = random_robot(random);
        make_dependent(&mut robot, random);
        dependent += usize::from(!robot.dependent.is_empty());
        robot
    };
    all_right(300, 21, make, check);
    assert!(dependent > 150, "{dependent}");
}

#[test]
fn the_base_of_random_tables_in_which_parameters_are_known_to_be_0_has_the_numeric_rank_and_the_same_torques()
{
    let make = |trial, random: &mut Pcg64| {
        let mut robot = random_robot(random);
        if trial % 2 == 1 {
            make_dependent(&mut robot, random);
        }
        let standard = robot.standard_parameters();
        let massless = random.random_range(0..robot.frames.len());
        robot.known = (0..standard.len())
            .filter(|&k| {
                let p = &standard[k];
                let body = p.kind <= ParameterKind::Ia && random.random_bool(0.2);
                body || p.frame == massless && p.kind <= ParameterKind::M
            })
            .collect();
        robot
    };
    all_right(200, 22, make, check);
}

#[test]
fn the_base_of_random_tables_with_friction_between_links_and_springs_has_the_numeric_rank_and_the_same_torques()
 {
    let mut springs = 0;
    let make = |trial, random: &mut Pcg64| {
        let mut robot = random_robot(random);
        if trial % 3 == 1 {
            make_dependent(&mut robot, random);
        }
        add_couplings(&mut robot, random);
        let standard = robot.standard_parameters();
        springs += standard.iter().filter(|p| p.kind == ParameterKind::K).count();
        if trial % 2 == 1 {
            // Friction and offsets of joints too, on which those of combinations lean.
            robot.known = (0..standard.len()).filter(|_| random.random_bool(0.2)).collect();
        }
        robot
    };
    all_right(300, 23, make, check);
    assert!(springs > 200, "{springs}");
}

#[test]
fn of_what_is_known_as_much_is_kept_as_torques_can_tell_from_the_rest() {
    let make = |trial, random: &mut Pcg64| {
        let mut robot = random_robot(random);
        if trial % 3 == 1 {
            make_dependent(&mut robot, random);
        }
        add_couplings(&mut robot, random);
        for k in 0..robot.standard_parameters().len() {
            match random.random_range(0..8) {
                0 => robot.known.push(k),
                1 => robot.fixed.push((k, random.random_range(0.1..2.0))),
                _ => {}
            }
        }
        robot
    };
    let mut kept = 0;
    let check_fixed = |robot: &RobotTable, random: &mut Pcg64| {
        check(robot, random)?;
        let set = base_set(robot);
        let is_fixed = |k: usize| robot.fixed.iter().any(|&(fixed, _)| fixed == k);
        let mut rows = observations(robot, &set, random);
        robot.known.iter().for_each(|&k| rows.column_mut(k).fill(0.0));
        let all = rank(&rows).0;
        robot.fixed.iter().for_each(|&(k, _)| rows.column_mut(k).fill(0.0));
        let free = if rows.amax() > 0.0 { rank(&rows).0 } else { 0 };
        let known = dynid_codegen::numeric_robot(robot, &set).fixed_base().len();
        kept += known;
        let found = set.base.iter().filter(|p| p.combination.iter().all(|&(k, _)| is_fixed(k))).count();
        if known == all - free && found == known {
            return Ok(());
        }
        Err(format!("{known} and {found} are known, rank {all} and {free}"))
    };
    all_right(200, 24, make, check_fixed);
    assert!(kept > 200, "{kept}");
}
