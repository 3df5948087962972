//! `dynid_solve(factor)`: parameters with their standard deviations.

use std::sync::Arc;

use datafusion::arrow::array::{Float64Array, StringArray};
use datafusion::arrow::datatypes::{DataType, Fields};
use datafusion::common::Result;
use datafusion::logical_expr::{ColumnarValue, ScalarFunctionArgs, ScalarUDFImpl, Signature, Volatility};

use super::columns::{arrays, bytes, factor, fields, list_of, lists};

/// The scalar function.
#[derive(Debug, PartialEq, Eq, Hash)]
pub(super) struct Solve {
    signature: Signature,
}

impl Solve {
    pub(super) fn new() -> Self {
        Self { signature: Signature::exact(vec![DataType::Binary], Volatility::Immutable) }
    }
}

fn solved_fields() -> Fields {
    fields(&[
        ("parameter", DataType::Utf8),
        ("value", DataType::Float64),
        ("sigma", DataType::Float64),
        ("unit", DataType::Utf8),
    ])
}

impl ScalarUDFImpl for Solve {
    fn name(&self) -> &str {
        "dynid_solve"
    }

    fn signature(&self) -> &Signature {
        &self.signature
    }

    fn return_type(&self, _: &[DataType]) -> Result<DataType> {
        Ok(list_of(solved_fields()))
    }

    fn invoke_with_args(&self, args: ScalarFunctionArgs) -> Result<ColumnarValue> {
        let columns = arrays(&args)?;
        let (mut names, mut values, mut sigmas, mut units) = (vec![], vec![], vec![], vec![]);
        let mut lengths = Vec::new();
        for row in 0..args.number_rows {
            let Some(bytes) = bytes(&columns, 0, row) else {
                lengths.push(0);
                continue;
            };
            let factor = factor("dynid_solve", bytes)?;
            let found = factor.solve();
            lengths.push(found.parameters.len());
            for (parameter, (_, unit)) in found.parameters.iter().zip(factor.parameters()) {
                names.push(parameter.name.clone());
                // What is not determined is no value.
                values.push(parameter.sigma.map(|_| parameter.value));
                sigmas.push(parameter.sigma);
                units.push(unit.clone());
            }
        }
        let columns = vec![
            Arc::new(StringArray::from(names)) as _,
            Arc::new(Float64Array::from(values)) as _,
            Arc::new(Float64Array::from(sigmas)) as _,
            Arc::new(StringArray::from(units)) as _,
        ];
        lists(solved_fields(), columns, lengths)
    }
}
