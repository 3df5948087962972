//! The robot as numbers, as statics of the generated module.

use crate::mechanics::Equations;
use dynid_description::{CouplingLaw, JointKind, Limits, Nominal, Robot};
use proc_macro2::{Literal, TokenStream};
use quote::{format_ident, quote};

/// `static ROBOT` and `static PATTERN`.
pub fn statics(robot: &Robot, equations: &Equations) -> TokenStream {
    let (name, description) = (&robot.name, super::header::one_line(&robot.description));
    let gravity = robot.gravity.map(float);
    let frames = frames(robot);
    let dependent = dependent(robot);
    let gear = floats(&robot.drive.gear);
    let coupled = borrowed(robot.drive.coupled_friction.iter().map(|&m| index(m)));
    let couplings = couplings(robot);
    let known = borrowed(robot.known.iter().map(|&k| index(k)));
    let fixed = borrowed(robot.fixed.iter().map(|&(k, value)| {
        let (k, value) = (index(k), float(value));
        quote!((#k, #value))
    }));
    let limits = limits(&robot.limits);
    let standard = borrowed(robot.standard.iter().map(|p| {
        let (name, kind, frame) = (&p.name, format_ident!("{}", format!("{:?}", p.kind)), index(p.frame));
        let coupling = p.coupling.map_or(quote!(None), |k| {
            let k = index(k);
            quote!(Some(#k))
        });
        quote! {
            StandardParameter { name: Cow::Borrowed(#name), kind: ParameterKind::#kind, frame: #frame, coupling: #coupling }
        }
    }));
    let base = borrowed(robot.base.iter().map(|p| {
        let (name, relation, unit, standard) = (&p.name, &p.relation, &p.unit, index(p.standard));
        let combination = borrowed(p.combination.iter().map(|&(k, c)| {
            let (k, c) = (index(k), float(c));
            quote!((#k, #c))
        }));
        quote! {
            BaseParameter {
                name: Cow::Borrowed(#name),
                standard: #standard,
                combination: #combination,
                relation: Cow::Borrowed(#relation),
                unit: Cow::Borrowed(#unit),
            }
        }
    }));
    let nominal = nominal(robot.nominal.as_ref());
    let pattern = pattern(equations);
    quote! {
        /// The robot.
        pub static ROBOT: Robot = Robot {
            name: Cow::Borrowed(#name),
            description: Cow::Borrowed(#description),
            gravity: [#(#gravity),*],
            frames: #frames,
            dependent: #dependent,
            drive: Drive { gear: #gear, coupled_friction: #coupled },
            couplings: #couplings,
            known: #known,
            fixed: #fixed,
            limits: #limits,
            standard: #standard,
            base: #base,
            nominal: #nominal,
        };
        #pattern
    }
}

fn frames(robot: &Robot) -> TokenStream {
    borrowed(robot.frames.iter().map(|frame| {
        let parent = match frame.parent {
            Some(k) => {
                let k = index(k);
                quote!(Some(#k))
            }
            None => quote!(None),
        };
        let kind = match frame.kind {
            JointKind::Revolute => quote!(Revolute),
            JointKind::Prismatic => quote!(Prismatic),
            JointKind::Fixed => quote!(Fixed),
        };
        let [gamma, b, alpha, d, theta, r] =
            [frame.gamma, frame.b, frame.alpha, frame.d, frame.theta, frame.r].map(float);
        quote! {
            Frame {
                parent: #parent, kind: JointKind::#kind,
                gamma: #gamma, b: #b, alpha: #alpha, d: #d, theta: #theta, r: #r,
            }
        }
    }))
}

fn dependent(robot: &Robot) -> TokenStream {
    borrowed(robot.dependent.iter().map(|d| {
        let (frame, kind) = (index(d.frame), format_ident!("{}", format!("{:?}", d.kind)));
        let terms = borrowed(d.terms.iter().map(|&(joint, c)| {
            let (joint, c) = (index(joint), float(c));
            quote!((#joint, #c))
        }));
        quote!(DependentFrame { frame: #frame, kind: JointKind::#kind, terms: #terms })
    }))
}

fn couplings(robot: &Robot) -> TokenStream {
    borrowed(robot.couplings.iter().map(|c| {
        let name = &c.name;
        let terms = borrowed(c.terms.iter().map(|&(joint, c)| {
            let (joint, c) = (index(joint), float(c));
            quote!((#joint, #c))
        }));
        let law = match c.law {
            CouplingLaw::Friction => quote!(CouplingLaw::Friction),
            CouplingLaw::Spring => quote!(CouplingLaw::Spring),
            CouplingLaw::SpringAt(rest) => {
                let rest = float(rest);
                quote!(CouplingLaw::SpringAt(#rest))
            }
        };
        quote!(Coupling { name: Cow::Borrowed(#name), terms: #terms, law: #law })
    }))
}

fn limits(limits: &Limits) -> TokenStream {
    let pairs = |values: &[[f64; 2]]| {
        borrowed(values.iter().map(|&[low, high]| {
            let (low, high) = (float(low), float(high));
            quote!([#low, #high])
        }))
    };
    let [position, velocity, acceleration, torque] =
        [&limits.position, &limits.velocity, &limits.acceleration, &limits.torque].map(|v| pairs(v));
    quote! {
        Limits { position: #position, velocity: #velocity, acceleration: #acceleration, torque: #torque }
    }
}

fn nominal(nominal: Option<&Nominal>) -> TokenStream {
    let Some(nominal) = nominal else { return quote!(None) };
    let lists = [
        &nominal.standard,
        &nominal.kp,
        &nominal.kd,
        &nominal.ki,
        &nominal.position_noise,
        &nominal.torque_noise,
    ];
    let [standard, kp, kd, ki, position_noise, torque_noise] = lists.map(|values| floats(values));
    quote! {
        Some(Nominal {
            standard: #standard,
            kp: #kp,
            kd: #kd,
            ki: #ki,
            position_noise: #position_noise,
            torque_noise: #torque_noise,
        })
    }
}

fn pattern(equations: &Equations) -> TokenStream {
    let entries = equations.pattern();
    let rows = (0..=equations.idm.len()).map(|i| index(entries.iter().filter(|e| e.0 < i).count()));
    let rows = borrowed(rows);
    let columns = borrowed(entries.iter().map(|e| index(e.1)));
    let values: Vec<_> = entries.iter().map(|&(i, k)| equations.idm[i][k]).collect();
    // The value itself is among the values, so that a position is always found.
    let same_as = borrowed(values.iter().filter_map(|v| values.iter().position(|x| x == v)).map(index));
    quote! {
        /// The entries of IDM that are not identically zero.
        pub static PATTERN: Pattern = Pattern { rows: #rows, columns: #columns, same_as: #same_as };
    }
}

fn borrowed(items: impl Iterator<Item = TokenStream>) -> TokenStream {
    quote!(Cow::Borrowed(&[#(#items),*]))
}

fn floats(values: &[f64]) -> TokenStream {
    borrowed(values.iter().map(|&x| float(x)))
}

/// A number with its sign.
pub fn float(value: f64) -> TokenStream {
    let literal = Literal::f64_unsuffixed(value.abs());
    if value < 0.0 { quote!(-#literal) } else { quote!(#literal) }
}

fn index(value: usize) -> TokenStream {
    let literal = Literal::usize_unsuffixed(value);
    quote!(#literal)
}
