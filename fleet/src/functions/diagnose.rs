//! `dynid_diagnose(recording, table, reference, model, rows)`

use std::sync::Arc;

use datafusion::arrow::array::{ArrayRef, Float64Array, StringArray};
use datafusion::arrow::datatypes::{DataType, Fields};
use datafusion::common::Result;
use datafusion::logical_expr::{ColumnarValue, ScalarFunctionArgs, ScalarUDFImpl, Signature, Volatility};

use super::columns::{arrays, bytes, count, fields, list_of, lists, text};
use crate::diagnose::{Against, FindingRow, diagnose};

/// Rows that are diagnosed where the query says none.
const ROWS: i64 = 60_000;

/// Columns of a finding.
pub fn finding_fields() -> Fields {
    fields(&[
        ("effect", DataType::Utf8),
        ("joints", DataType::Utf8),
        ("confidence", DataType::Float64),
        ("held_out_before", DataType::Float64),
        ("held_out_after", DataType::Float64),
        ("sentence", DataType::Utf8),
    ])
}

/// What [`Diagnose`] gives for a recording.
pub fn finding_type() -> DataType {
    list_of(finding_fields())
}

/// The scalar function. The reference is a factor, or the text of a model where there is one.
#[derive(Debug, PartialEq, Eq, Hash)]
pub(super) struct Diagnose {
    signature: Signature,
}

impl Diagnose {
    pub(super) fn new() -> Self {
        let types = vec![DataType::Utf8, DataType::Utf8, DataType::Binary, DataType::Utf8, DataType::Int64];
        Self { signature: Signature::exact(types, Volatility::Volatile) }
    }
}

impl ScalarUDFImpl for Diagnose {
    fn name(&self) -> &str {
        "dynid_diagnose"
    }

    fn signature(&self) -> &Signature {
        &self.signature
    }

    fn return_type(&self, _: &[DataType]) -> Result<DataType> {
        Ok(finding_type())
    }

    fn invoke_with_args(&self, args: ScalarFunctionArgs) -> Result<ColumnarValue> {
        let columns = arrays(&args)?;
        let mut findings = Vec::new();
        let mut lengths = Vec::new();
        for row in 0..args.number_rows {
            let against = text(&columns, 3, row)
                .map(Against::Model)
                .or_else(|| bytes(&columns, 2, row).map(Against::Factor));
            let own = match (text(&columns, 0, row), against) {
                (Some(recording), Some(against)) => {
                    let rows = count(&columns, 4, row).unwrap_or(ROWS);
                    let rows = usize::try_from(rows).unwrap_or_default();
                    diagnose(recording, text(&columns, 1, row), against, rows)
                }
                _ => Vec::new(),
            };
            lengths.push(own.len());
            findings.extend(own);
        }
        lists(finding_fields(), arrays_of(&findings), lengths)
    }
}

fn arrays_of(findings: &[FindingRow]) -> Vec<ArrayRef> {
    let held_out = |place: usize| -> ArrayRef {
        Arc::new(Float64Array::from_iter(findings.iter().map(|f| f.held_out.map(|errors| errors[place]))))
    };
    vec![
        Arc::new(StringArray::from_iter(findings.iter().map(|f| f.effect.as_deref()))),
        Arc::new(StringArray::from_iter(findings.iter().map(|f| f.joints.as_deref()))),
        Arc::new(Float64Array::from_iter(findings.iter().map(|f| f.confidence))),
        held_out(0),
        held_out(1),
        Arc::new(StringArray::from_iter_values(findings.iter().map(|f| f.sentence.as_str()))),
    ]
}
