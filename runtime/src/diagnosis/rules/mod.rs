//! Every threshold of the diagnosis: what it decides, why it has this value, and which committed figure moves with it.
//!
//! Three kinds of reasons: *statistics* (a level of a test, a degree of freedom), *mechanics* (what filters, gears and
//! motions do), and *judgement* (a value between two that were seen to fail; the figures named show what it does).
//! What a user may set is in [`Settings`](super::Settings), whose defaults are here too.
//!
//! The figures: `docs/concealment.md` (long motions), `docs/concealment_short.md` (one short motion),
//! `docs/evidence.md` (real recordings).

mod contact;
mod defaults;
mod explanation;
mod judging;
mod lines;
mod preparation;
mod search;

pub(super) use contact::*;
pub(super) use defaults::*;
pub(super) use explanation::*;
pub(super) use judging::*;
pub(super) use lines::*;
pub(super) use preparation::*;
pub(super) use search::*;
