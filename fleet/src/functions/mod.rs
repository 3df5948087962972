//! dynid's functions in SQL, by name.
//!
//! | function | of | gives |
//! |---|---|---|
//! | `dynid_reduce(recording [, table [, band]])` | path or address of a recording | a list with a struct for each motion: its factor, counts, band, and what became of it |
//! | `dynid_merge(factor)`, aggregate | factors of one robot | one factor |
//! | `dynid_solve(factor)` | a factor | a list of structs: parameter, value, sigma, unit |
//! | `dynid_rise(factor, reference)` | two factors of a robot | how much larger the first one's errors are with the second one's parameters |
//! | `dynid_diagnose(recording, table, reference, model, rows)` | a recording, and what it is compared with | a list of structs, one for each finding |
//!
//! `dynid_factors('fleet.yaml')` is a table: what `dynid_reduce` gives of every recording of a fleet.

mod columns;
mod diagnose;
mod merge;
mod reduce;
mod rise;
mod solve;
mod table;

use std::sync::Arc;

use datafusion::logical_expr::{AggregateUDF, ScalarUDF};
use datafusion::prelude::SessionContext;

pub use diagnose::{finding_fields, finding_type};
pub use reduce::{motion_fields, motion_type};
pub use table::{FactorsFunction, WorkTable, work_batch, work_schema};

/// Registers all of them.
pub fn register(context: &SessionContext) {
    context.register_udaf(AggregateUDF::from(merge::Merge::new()));
    context.register_udf(ScalarUDF::from(reduce::Reduce::new()));
    context.register_udf(ScalarUDF::from(solve::Solve::new()));
    context.register_udf(ScalarUDF::from(rise::Rise::new()));
    context.register_udf(ScalarUDF::from(diagnose::Diagnose::new()));
    context.register_udtf("dynid_factors", Arc::new(FactorsFunction));
}
