//! Values of a column, row by row; `None` where nothing stands there, or the column is of another kind.

use datafusion::arrow::array::{Array, ArrayRef, AsArray};
use datafusion::arrow::datatypes::{Float64Type, Int64Type};

/// A text.
pub fn text(column: &ArrayRef, row: usize) -> Option<&str> {
    let column = column.as_string_opt::<i32>()?;
    (!column.is_null(row)).then(|| column.value(row))
}

/// A number.
pub fn number(column: &ArrayRef, row: usize) -> Option<f64> {
    let column = column.as_primitive_opt::<Float64Type>()?;
    (!column.is_null(row)).then(|| column.value(row))
}

/// A count.
pub fn count(column: &ArrayRef, row: usize) -> Option<i64> {
    let column = column.as_primitive_opt::<Int64Type>()?;
    (!column.is_null(row)).then(|| column.value(row))
}

/// Bytes.
pub fn bytes(column: &ArrayRef, row: usize) -> Option<&[u8]> {
    let column = column.as_binary_opt::<i32>()?;
    (!column.is_null(row)).then(|| column.value(row))
}
