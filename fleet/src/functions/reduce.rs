//! `dynid_reduce(recording [, table [, band]])`

use std::sync::Arc;

use datafusion::arrow::array::{ArrayRef, BinaryArray, Float64Array, Int64Array, StringArray};
use datafusion::arrow::datatypes::{DataType, Fields};
use datafusion::common::Result;
use datafusion::logical_expr::{
    ColumnarValue, ScalarFunctionArgs, ScalarUDFImpl, Signature, TypeSignature, Volatility,
};

use super::columns::{arrays, fields, list_of, lists, number, text};
use crate::reduce::{Motion, reduce};

/// Columns of a motion.
pub fn motion_fields() -> Fields {
    fields(&[
        ("motion", DataType::Utf8),
        ("factor", DataType::Binary),
        ("rows", DataType::Int64),
        ("samples", DataType::Int64),
        ("left_out", DataType::Int64),
        ("band", DataType::Float64),
        ("relative_error", DataType::Float64),
        ("outcome", DataType::Utf8),
        ("message", DataType::Utf8),
        ("table_name", DataType::Utf8),
        ("own_temperature", DataType::Float64),
        ("own_load", DataType::Float64),
        ("files", DataType::Utf8),
    ])
}

/// What [`Reduce`] gives for a recording.
pub fn motion_type() -> DataType {
    list_of(motion_fields())
}

/// The scalar function.
#[derive(Debug, PartialEq, Eq, Hash)]
pub(super) struct Reduce {
    signature: Signature,
}

impl Reduce {
    pub(super) fn new() -> Self {
        let exact = |types: &[DataType]| TypeSignature::Exact(types.to_vec());
        let all = [DataType::Utf8, DataType::Utf8, DataType::Float64];
        // Volatile: what stands in files may change, and a planner that worked it out beforehand would do it in one process.
        let signature =
            Signature::one_of(vec![exact(&all[..1]), exact(&all[..2]), exact(&all)], Volatility::Volatile);
        Self { signature }
    }
}

impl ScalarUDFImpl for Reduce {
    fn name(&self) -> &str {
        "dynid_reduce"
    }

    fn signature(&self) -> &Signature {
        &self.signature
    }

    fn return_type(&self, _: &[DataType]) -> Result<DataType> {
        Ok(motion_type())
    }

    fn invoke_with_args(&self, args: ScalarFunctionArgs) -> Result<ColumnarValue> {
        let columns = arrays(&args)?;
        let mut motions = Vec::new();
        let mut lengths = Vec::new();
        for row in 0..args.number_rows {
            let own = text(&columns, 0, row)
                .map(|recording| reduce(recording, text(&columns, 1, row), number(&columns, 2, row)));
            let own = own.unwrap_or_default();
            lengths.push(own.len());
            motions.extend(own);
        }
        lists(motion_fields(), arrays_of(&motions), lengths)
    }
}

fn arrays_of(motions: &[Motion]) -> Vec<ArrayRef> {
    let counts = |of: fn(&Motion) -> u64| -> ArrayRef {
        Arc::new(Int64Array::from_iter_values(
            motions.iter().map(|m| i64::try_from(of(m)).unwrap_or(i64::MAX)),
        ))
    };
    let number = |of: fn(&Motion) -> Option<f64>| -> ArrayRef {
        Arc::new(Float64Array::from_iter(motions.iter().map(of)))
    };
    vec![
        Arc::new(StringArray::from_iter(motions.iter().map(|m| m.name.as_deref()))),
        Arc::new(BinaryArray::from_iter(motions.iter().map(|m| m.factor.as_deref()))),
        counts(|m| m.rows),
        counts(|m| m.samples),
        counts(|m| m.left_out),
        number(|m| m.band),
        number(|m| m.relative_error),
        Arc::new(StringArray::from_iter_values(motions.iter().map(|m| m.outcome.name()))),
        Arc::new(StringArray::from_iter(motions.iter().map(|m| m.message.as_deref()))),
        Arc::new(StringArray::from_iter(motions.iter().map(|m| m.table_name.as_deref()))),
        number(|m| m.conditions.temperature),
        number(|m| m.conditions.load),
        Arc::new(StringArray::from_iter(motions.iter().map(|m| m.files.as_deref()))),
    ]
}
