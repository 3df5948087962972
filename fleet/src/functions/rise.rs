//! `dynid_rise(factor, reference)`: how much larger errors are with a reference's parameters.

use std::sync::Arc;

use datafusion::arrow::array::Float64Array;
use datafusion::arrow::datatypes::DataType;
use datafusion::common::Result;
use datafusion::logical_expr::{ColumnarValue, ScalarFunctionArgs, ScalarUDFImpl, Signature, Volatility};

use super::columns::{arrays, bytes, factor};
use crate::rise::rise;

/// The scalar function. Both are factors; 1 where the reference's parameters do as well as its own.
#[derive(Debug, PartialEq, Eq, Hash)]
pub(super) struct Rise {
    signature: Signature,
}

impl Rise {
    pub(super) fn new() -> Self {
        Self { signature: Signature::exact(vec![DataType::Binary, DataType::Binary], Volatility::Immutable) }
    }
}

impl ScalarUDFImpl for Rise {
    fn name(&self) -> &str {
        "dynid_rise"
    }

    fn signature(&self) -> &Signature {
        &self.signature
    }

    fn return_type(&self, _: &[DataType]) -> Result<DataType> {
        Ok(DataType::Float64)
    }

    fn invoke_with_args(&self, args: ScalarFunctionArgs) -> Result<ColumnarValue> {
        let columns = arrays(&args)?;
        let read = |column: usize, row: usize| {
            bytes(&columns, column, row).map(|bytes| factor("dynid_rise", bytes)).transpose()
        };
        let mut rises = Vec::with_capacity(args.number_rows);
        for row in 0..args.number_rows {
            rises.push(match (read(0, row)?, read(1, row)?) {
                (Some(factor), Some(reference)) => {
                    rise(&factor, &reference.solve().chi()).map(|rise| rise.ratio)
                }
                _ => None,
            });
        }
        Ok(ColumnarValue::Array(Arc::new(Float64Array::from(rises))))
    }
}
