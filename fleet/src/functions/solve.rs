//! `dynid_solve(factor)`: parameters with their standard deviations.

use std::sync::Arc;

use datafusion::arrow::array::{Float64Array, StringArray};
use datafusion::arrow::datatypes::{DataType, Field, Fields};
use datafusion::common::{Result, exec_datafusion_err};
use datafusion::logical_expr::{ColumnarValue, ScalarFunctionArgs, ScalarUDFImpl, Signature, Volatility};
use dynid_runtime::estimation::Reduced;

use super::columns::{arrays, bytes, list_of, lists};

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

fn fields() -> Fields {
    let field = |name: &str, kind| Field::new(name, kind, true);
    Fields::from(vec![
        field("parameter", DataType::Utf8),
        field("value", DataType::Float64),
        field("sigma", DataType::Float64),
        field("unit", DataType::Utf8),
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
        Ok(list_of(fields()))
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
            let factor =
                Reduced::from_bytes(bytes).map_err(|error| exec_datafusion_err!("dynid_solve: {error}"))?;
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
        lists(fields(), columns, lengths)
    }
}
