//! The hot paths allocate nothing: the step of a simulated robot, and the regressors, generated and recursive.
#![allow(clippy::unwrap_used)]

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

use dynid::models;
use dynid_runtime::model::{Model, RecursiveModel, States};
use dynid_runtime::simulation::{Plant, Residue, Scheme};

thread_local! {
    /// Allocations of this thread; other tests run on others.
    static ALLOCATIONS: Cell<usize> = const { Cell::new(0) };
}

/// The system's allocator, counting.
struct Counting;

// SAFETY: every call is handed on unchanged to the system's allocator.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.with(|count| count.set(count.get() + 1));
        // SAFETY: as of the caller.
        unsafe { System.alloc(layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        ALLOCATIONS.with(|count| count.set(count.get() + 1));
        // SAFETY: as of the caller.
        unsafe { System.realloc(pointer, layout, size) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: as of the caller.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// How often `work` allocates.
fn allocations(work: impl FnOnce()) -> usize {
    let before = ALLOCATIONS.with(Cell::get);
    work();
    ALLOCATIONS.with(Cell::get) - before
}

#[test]
fn what_allocates_is_counted() {
    assert_eq!(allocations(|| drop(std::hint::black_box(vec![1.0; 8]))), 1);
}

/// Every robot, reversing and resting under friction, with every scheme of integration.
#[test]
fn a_step_of_a_simulated_robot_allocates_nothing() {
    for &model in models::all() {
        let robot = model.robot();
        let Some(nominal) = &robot.nominal else { continue };
        let n = robot.joints();
        for residue in [0.0, 1.0] {
            for scheme in Scheme::ALL {
                let effects = match residue {
                    0.0 => Vec::new(),
                    size => vec![Residue::typical(robot, &nominal.standard, size).boxed()],
                };
                let mut plant = Plant::with_effects(model, &nominal.standard, &[], effects).unwrap();
                plant.set_scheme(scheme);
                let mut state = plant.state(&vec![0.2; n], &vec![0.4; n]);
                let (push, mut torque) = (vec![1.0; n], vec![0.0; n]);
                let moved = state.q.clone();
                let count = allocations(|| {
                    for k in 0..400 {
                        let sign = if k / 100 % 2 == 0 { 1.0 } else { -1.0 };
                        torque.iter_mut().zip(&push).for_each(|(t, p)| *t = sign * p);
                        plant.advance(&mut state, &torque, 2e-4).unwrap();
                    }
                });
                assert_ne!(state.q, moved);
                assert_eq!(count, 0, "{} with {}", robot.name, scheme.name());
            }
        }
    }
}

fn regressors_allocate_nothing(model: &dyn Model, engine: &str) {
    let (n, columns) = (model.robot().joints(), model.pattern().columns.len());
    let size = model.robot().base.len();
    let [q, dq, ddq] = [0.3, 0.7, 1.1].map(|x| vec![x; n]);
    let (mut row, mut entries) = (vec![0.0; size], vec![0.0; columns]);
    let (mut mass, mut bias, chi) = (vec![0.0; n * n], vec![0.0; n], vec![0.1; size]);
    let samples = 37;
    let signals = [vec![0.3; samples], vec![0.7; samples], vec![1.1; samples]];
    let slices: Vec<Vec<&[f64]>> = signals.iter().map(|s| vec![s.as_slice(); n]).collect();
    let states = States { q: &slices[0], dq: &slices[1], ddq: &slices[2] };
    let mut block = vec![0.0; columns.max(size) * samples];
    let count = allocations(|| {
        model.energy(&q, &dq, &mut row);
        model.power(&q, &dq, &ddq, &mut row);
        model.idm(&q, &dq, &ddq, &mut entries);
        model.mass_and_bias(&chi, &q, &dq, &mut mass, &mut bias);
        model.torque(&chi, &q, &dq, &ddq, &mut bias);
        model.torque_block(&chi, states, samples, &mut block);
        model.idm_block(states, samples, &mut block);
        model.power_block(states, samples, &mut block);
        model.energy_block(states, samples, &mut block);
    });
    assert_eq!(count, 0, "{engine} model of {}", model.robot().name);
}

#[test]
fn generated_regressors_allocate_nothing() {
    models::all().iter().for_each(|&model| regressors_allocate_nothing(model, "the generated"));
}

#[test]
fn recursive_regressors_allocate_nothing() {
    for &model in models::all() {
        let recursive = RecursiveModel::new(model.robot().clone()).unwrap();
        regressors_allocate_nothing(&recursive, "the recursive");
    }
}
