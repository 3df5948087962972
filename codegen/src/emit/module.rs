//! The module of one robot.

use super::functions::{MOST_STATEMENTS, functions};
use super::{comments, data, header, rust};
use crate::base::BaseSet;
use crate::mechanics::Equations;
use crate::numeric::numeric_robot;
use crate::robot::RobotTable;
use proc_macro2::{Literal, TokenStream};
use quote::quote;

/// The source of a robot's module, formatted.
pub fn module(robot: &RobotTable, set: &BaseSet, equations: &Equations) -> Result<String, syn::Error> {
    let formatted = |tokens| Ok::<_, syn::Error>(prettyplease::unparse(&syn::parse2(tokens)?));
    let opening = formatted(opening(robot, set, equations))?;
    let statics = data::statics(&numeric_robot(robot, set), equations);
    let code = comments::restore(&formatted(code(robot, set, equations))?);
    Ok(format!("{}\n{opening}{statics}{code}", header::header(robot, set, equations)))
}

/// What the module uses, and its sizes.
fn opening(robot: &RobotTable, set: &BaseSet, equations: &Equations) -> TokenStream {
    let n = Literal::usize_unsuffixed(equations.idm.len());
    let nb = Literal::usize_unsuffixed(set.base.len());
    let entries = Literal::usize_unsuffixed(equations.pattern().len());
    // A robot without values for simulation does not name their type.
    let nominal = robot.nominal.as_ref().map(|_| quote!(Nominal,));
    let dependent = (!robot.dependent.is_empty()).then(|| quote!(DependentFrame,));
    let coupling = (!robot.couplings.is_empty()).then(|| quote!(Coupling, CouplingLaw,));
    let between = robot.couplings.iter().any(|c| c.law.between().is_some()).then(|| quote!(Between,));
    let ellipsoid = (!robot.ellipsoids.is_empty()).then(|| quote!(Ellipsoid,));
    quote! {
        #![allow(non_snake_case, unused_variables, clippy::all)]

        use dynid_runtime::model::{
            BaseParameter, #between #coupling #dependent Drive, #ellipsoid Frame, JointKind, Lanes, Limits, Line, LineStates, Model, #nominal Number, Operations,
            ParameterKind, Pattern, Robot, StandardParameter, States, array, array_mut, evaluate_block, evaluate_line,
            evaluate_lines,
        };
        use std::borrow::Cow;
        use std::ops::IndexMut;

        /// Number of joints.
        pub const N: usize = #n;
        /// Number of base parameters.
        pub const NB: usize = #nb;
        /// Number of entries of IDM that are not identically zero.
        pub const ENTRIES: usize = #entries;
    }
}

/// The functions, and the `Model` that calls them.
fn code(robot: &RobotTable, set: &BaseSet, equations: &Equations) -> TokenStream {
    let functions = rust_functions(robot, set, equations);
    let (operations, lines, model) = (operations(equations), lines(), model());
    quote! {
        #operations
        #functions
        #lines
        #model
    }
}

fn operations(equations: &Equations) -> TokenStream {
    let counts = equations.counts();
    let rows = [
        ("h", counts.energy),
        ("dh", counts.power),
        ("IDM", counts.idm),
        ("M, N", counts.forward),
        ("tau", counts.torque),
    ];
    let rows = rows.map(|(function, c)| {
        let [multiplications, additions, pairs] =
            [c.multiplications, c.additions, c.sincos].map(Literal::usize_unsuffixed);
        quote! {
            Operations {
                function: #function,
                multiplications: #multiplications,
                additions: #additions,
                sine_cosine_pairs: #pairs,
            }
        }
    });
    quote! {
        /// What one evaluation costs.
        pub static OPERATIONS: [Operations; 5] = [#(#rows),*];
    }
}

/// The functions as Rust.
pub fn rust_functions(robot: &RobotTable, set: &BaseSet, equations: &Equations) -> TokenStream {
    let functions = functions(robot, set, equations, MOST_STATEMENTS);
    functions.iter().map(|f| rust::function(&f.signature, &f.parts)).collect()
}

/// The functions for one line of samples side by side.
fn lines() -> TokenStream {
    quote! {
        fn energy_line(states: &LineStates<N>, h: &mut [Line; NB]) {
            evaluate_line(states, h, |[q, dq, _], h| energy(q, dq, h));
        }

        fn power_line(states: &LineStates<N>, dh: &mut [Line; NB]) {
            evaluate_line(states, dh, |[q, dq, ddq], dh| power(q, dq, ddq, dh));
        }

        fn idm_line(states: &LineStates<N>, entries: &mut [Line; ENTRIES]) {
            evaluate_line(states, entries, |[q, dq, ddq], entries| idm(q, dq, ddq, entries));
        }

        fn tau_line(chi: &[Lanes; NB], states: &LineStates<N>, torques: &mut [Line; N]) {
            evaluate_line(states, torques, |[q, dq, ddq], torques| tau(chi, q, dq, ddq, torques));
        }
    }
}

/// The `Model` that calls them.
fn model() -> TokenStream {
    quote! {
        /// The dynamics as a [`Model`].
        #[derive(Debug, Clone, Copy)]
        pub struct Dynamics;

        impl Model for Dynamics {
            fn robot(&self) -> &Robot {
                &ROBOT
            }

            fn pattern(&self) -> &Pattern {
                &PATTERN
            }

            fn energy(&self, q: &[f64], dq: &[f64], h: &mut [f64]) {
                energy(array(q), array(dq), array_mut::<NB>(h));
            }

            fn power(&self, q: &[f64], dq: &[f64], ddq: &[f64], dh: &mut [f64]) {
                power(array(q), array(dq), array(ddq), array_mut::<NB>(dh));
            }

            fn idm(&self, q: &[f64], dq: &[f64], ddq: &[f64], entries: &mut [f64]) {
                idm(array(q), array(dq), array(ddq), array_mut::<ENTRIES>(entries));
            }

            fn idm_block(&self, states: States<'_>, stride: usize, out: &mut [f64]) {
                evaluate_block([states.q, states.dq, states.ddq], stride, out, idm_line);
            }

            fn idm_lines(&self, states: States<'_>, width: usize, out: &mut [Line]) {
                evaluate_lines([states.q, states.dq, states.ddq], width, out, idm_line);
            }

            fn power_block(&self, states: States<'_>, stride: usize, out: &mut [f64]) {
                evaluate_block([states.q, states.dq, states.ddq], stride, out, power_line);
            }

            fn energy_block(&self, states: States<'_>, stride: usize, out: &mut [f64]) {
                evaluate_block([states.q, states.dq, states.dq], stride, out, energy_line);
            }

            fn mass_and_bias(&self, chi: &[f64], q: &[f64], dq: &[f64], mass: &mut [f64], bias: &mut [f64]) {
                mass_and_bias(array(chi), array(q), array(dq), array_mut(mass), array_mut(bias));
            }

            fn torque(&self, chi: &[f64], q: &[f64], dq: &[f64], ddq: &[f64], torques: &mut [f64]) {
                tau(array(chi), array(q), array(dq), array(ddq), array_mut::<N>(torques));
            }

            fn torque_block(&self, chi: &[f64], states: States<'_>, stride: usize, out: &mut [f64]) {
                let chi = array::<NB>(chi).map(Lanes::splat);
                evaluate_block([states.q, states.dq, states.ddq], stride, out, |states, torques| {
                    tau_line(&chi, states, torques);
                });
            }
        }
    }
}
