//! Columns of arguments, and lists of structs.

use std::sync::Arc;

use datafusion::arrow::array::{ArrayRef, ListArray, StructArray};
use datafusion::arrow::buffer::OffsetBuffer;
use datafusion::arrow::datatypes::{DataType, Field, Fields};
use datafusion::common::{Result, exec_datafusion_err};
use datafusion::logical_expr::{ColumnarValue, ScalarFunctionArgs};
use dynid_runtime::estimation::Reduced;

use crate::cells;

/// The arguments as columns of one length.
pub(super) fn arrays(args: &ScalarFunctionArgs) -> Result<Vec<ArrayRef>> {
    args.args.iter().map(|value| value.to_array(args.number_rows)).collect()
}

/// A text of a column of an argument that may not be there.
pub(super) fn text(columns: &[ArrayRef], column: usize, row: usize) -> Option<&str> {
    cells::text(columns.get(column)?, row)
}

/// A number of a column of an argument that may not be there.
pub(super) fn number(columns: &[ArrayRef], column: usize, row: usize) -> Option<f64> {
    cells::number(columns.get(column)?, row)
}

/// A count of a column of an argument that may not be there.
pub(super) fn count(columns: &[ArrayRef], column: usize, row: usize) -> Option<i64> {
    cells::count(columns.get(column)?, row)
}

/// Bytes of a column of an argument that may not be there.
pub(super) fn bytes(columns: &[ArrayRef], column: usize, row: usize) -> Option<&[u8]> {
    cells::bytes(columns.get(column)?, row)
}

/// The factor that bytes are, for the function of this name.
pub(super) fn factor(function: &str, bytes: &[u8]) -> Result<Reduced> {
    Reduced::from_bytes(bytes).map_err(|error| exec_datafusion_err!("{function}: {error}"))
}

/// Fields of a struct, each of which may be missing.
pub(super) fn fields(of: &[(&str, DataType)]) -> Fields {
    of.iter().map(|(name, kind)| Field::new(*name, kind.clone(), true)).collect()
}

/// A list of structs.
pub(super) fn list_of(fields: Fields) -> DataType {
    DataType::List(Arc::new(Field::new("item", DataType::Struct(fields), true)))
}

/// Structs in lists of these lengths, one for each row.
pub(super) fn lists(fields: Fields, columns: Vec<ArrayRef>, lengths: Vec<usize>) -> Result<ColumnarValue> {
    let values = StructArray::try_new(fields.clone(), columns, None)?;
    let item = Arc::new(Field::new("item", DataType::Struct(fields), true));
    let list = ListArray::try_new(item, OffsetBuffer::from_lengths(lengths), Arc::new(values), None)?;
    Ok(ColumnarValue::Array(Arc::new(list)))
}
