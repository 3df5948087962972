//! `dynid_merge(factor)`: factors of one robot as one.

use std::sync::Arc;

use datafusion::arrow::array::{ArrayRef, AsArray};
use datafusion::arrow::datatypes::{DataType, Field, FieldRef};
use datafusion::common::{Result, ScalarValue, exec_datafusion_err};
use datafusion::logical_expr::function::{AccumulatorArgs, StateFieldsArgs};
use datafusion::logical_expr::{Accumulator, AggregateUDFImpl, Signature, Volatility};
use dynid_runtime::estimation::Reduced;

use super::columns::factor;

/// The aggregate function. Its state is a factor, however many go in.
#[derive(Debug, PartialEq, Eq, Hash)]
pub(super) struct Merge {
    signature: Signature,
}

impl Merge {
    pub(super) fn new() -> Self {
        Self { signature: Signature::exact(vec![DataType::Binary], Volatility::Immutable) }
    }
}

impl AggregateUDFImpl for Merge {
    fn name(&self) -> &str {
        "dynid_merge"
    }

    fn signature(&self) -> &Signature {
        &self.signature
    }

    fn return_type(&self, _: &[DataType]) -> Result<DataType> {
        Ok(DataType::Binary)
    }

    fn accumulator(&self, _: AccumulatorArgs<'_>) -> Result<Box<dyn Accumulator>> {
        Ok(Box::new(Merged(None)))
    }

    fn state_fields(&self, args: StateFieldsArgs<'_>) -> Result<Vec<FieldRef>> {
        Ok(vec![Arc::new(Field::new(format!("{}[factor]", args.name), DataType::Binary, true))])
    }
}

#[derive(Debug)]
struct Merged(Option<Reduced>);

impl Merged {
    fn take(&mut self, values: &[ArrayRef]) -> Result<()> {
        let factors = values.first().and_then(|column| column.as_binary_opt::<i32>());
        let factors = factors.ok_or_else(|| exec_datafusion_err!("dynid_merge takes factors"))?;
        for bytes in factors.iter().flatten() {
            let factor = factor("dynid_merge", bytes)?;
            match &mut self.0 {
                None => self.0 = Some(factor),
                Some(all) => {
                    all.merge(&factor).map_err(|error| exec_datafusion_err!("dynid_merge: {error}"))?
                }
            }
        }
        Ok(())
    }

    fn value(&self) -> ScalarValue {
        ScalarValue::Binary(self.0.as_ref().map(Reduced::to_bytes))
    }
}

impl Accumulator for Merged {
    fn update_batch(&mut self, values: &[ArrayRef]) -> Result<()> {
        self.take(values)
    }

    fn merge_batch(&mut self, states: &[ArrayRef]) -> Result<()> {
        self.take(states)
    }

    fn state(&mut self) -> Result<Vec<ScalarValue>> {
        Ok(vec![self.value()])
    }

    fn evaluate(&mut self) -> Result<ScalarValue> {
        Ok(self.value())
    }

    fn size(&self) -> usize {
        // Triangle, noise, counts and names.
        let unknowns = self.0.as_ref().map_or(0, |factor| factor.parameters().len() + 1);
        size_of_val(self) + 8 * (2 * unknowns * unknowns + 2 * unknowns) + 32 * unknowns
    }
}
