//! Columns of arguments, and lists of structs.

use std::sync::Arc;

use datafusion::arrow::array::{Array, ArrayRef, AsArray, ListArray, StructArray};
use datafusion::arrow::buffer::OffsetBuffer;
use datafusion::arrow::datatypes::{DataType, Field, Fields, Float64Type, Int64Type};
use datafusion::common::Result;
use datafusion::logical_expr::{ColumnarValue, ScalarFunctionArgs};

/// The arguments as columns of one length.
pub(super) fn arrays(args: &ScalarFunctionArgs) -> Result<Vec<ArrayRef>> {
    args.args.iter().map(|value| value.to_array(args.number_rows)).collect()
}

/// A text of a column of an argument that may not be there.
pub(super) fn text(columns: &[ArrayRef], column: usize, row: usize) -> Option<&str> {
    let column = columns.get(column)?.as_string_opt::<i32>()?;
    (!column.is_null(row)).then(|| column.value(row))
}

/// A number of a column of an argument that may not be there.
pub(super) fn number(columns: &[ArrayRef], column: usize, row: usize) -> Option<f64> {
    let column = columns.get(column)?.as_primitive_opt::<Float64Type>()?;
    (!column.is_null(row)).then(|| column.value(row))
}

/// A count of a column of an argument that may not be there.
pub(super) fn count(columns: &[ArrayRef], column: usize, row: usize) -> Option<i64> {
    let column = columns.get(column)?.as_primitive_opt::<Int64Type>()?;
    (!column.is_null(row)).then(|| column.value(row))
}

/// Bytes of a column of an argument that may not be there.
pub(super) fn bytes(columns: &[ArrayRef], column: usize, row: usize) -> Option<&[u8]> {
    let column = columns.get(column)?.as_binary_opt::<i32>()?;
    (!column.is_null(row)).then(|| column.value(row))
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
