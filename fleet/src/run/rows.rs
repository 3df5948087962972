//! Columns of the results, and rows from and to them.

use std::sync::Arc;

use datafusion::arrow::array::{
    Array, ArrayRef, AsArray, BooleanArray, Date32Array, Float64Array, Int64Array, RecordBatch, StringArray,
};
use datafusion::arrow::datatypes::{DataType, Date32Type, Field, Schema, SchemaRef};

use crate::cells;
use crate::day::Day;
use crate::error::{FleetError, Result};
use crate::functions::{finding_fields, motion_fields, work_schema};

fn schema(fields: Vec<Field>) -> SchemaRef {
    Arc::new(Schema::new(fields))
}

fn of_recording() -> Vec<Field> {
    let field = |name: &str, kind| Field::new(name, kind, false);
    vec![field("robot", DataType::Utf8), field("day", DataType::Date32), field("recording", DataType::Utf8)]
}

/// `factors`: a row for each motion: the recording's columns, then those of [`motion_fields`].
pub fn factors_schema() -> SchemaRef {
    let own = work_schema();
    let fields =
        own.fields().iter().chain(motion_fields().iter()).map(|field| field.as_ref().clone()).collect();
    schema(fields)
}

/// `parameters`: robot, day, parameter, value, sigma, reference, unit, robot_table (the fingerprint of the robot's table, which
/// siblings share), the means of the day's temperatures and loads, and the name that the robot's table has.
pub fn parameters_schema() -> SchemaRef {
    let mut fields = of_recording();
    fields[2] = Field::new("parameter", DataType::Utf8, false);
    fields.extend(["value", "sigma", "reference"].map(|name| Field::new(name, DataType::Float64, true)));
    fields.extend(["unit", "robot_table"].map(|name| Field::new(name, DataType::Utf8, false)));
    fields.extend(["temperature", "load"].map(|name| Field::new(name, DataType::Float64, true)));
    fields.push(Field::new("table_name", DataType::Utf8, true));
    schema(fields)
}

/// `screening`: a row for each recording.
pub fn screening_schema() -> SchemaRef {
    let mut fields = of_recording();
    let field = |name: &str, kind| Field::new(name, kind, true);
    fields.extend([
        field("key", DataType::Utf8),
        field("outcome", DataType::Utf8),
        field("message", DataType::Utf8),
    ]);
    fields.extend(["motions", "rows", "samples", "left_out"].map(|name| field(name, DataType::Int64)));
    fields.extend(["band", "relative_error", "rise"].map(|name| field(name, DataType::Float64)));
    fields.push(field("rose", DataType::Boolean));
    fields.push(field("files", DataType::Utf8));
    schema(fields)
}

/// `findings`: the recording, then [`finding_fields`].
pub fn findings_schema() -> SchemaRef {
    let mut fields = of_recording();
    fields.extend(finding_fields().iter().map(|field| field.as_ref().clone()));
    schema(fields)
}

/// Rows of a table from columns.
///
/// # Errors
/// Columns that are not those of the schema: a mistake of this program.
pub fn batch(schema: &SchemaRef, columns: Vec<ArrayRef>) -> Result<RecordBatch> {
    RecordBatch::try_new(schema.clone(), columns).map_err(|error| FleetError::Engine(error.to_string()))
}

/// A column of texts.
pub fn texts<'a>(values: impl IntoIterator<Item = Option<&'a str>>) -> ArrayRef {
    Arc::new(StringArray::from_iter(values))
}

/// A column of numbers.
pub fn numbers(values: impl IntoIterator<Item = Option<f64>>) -> ArrayRef {
    Arc::new(Float64Array::from_iter(values))
}

/// A column of counts.
pub fn counts(values: impl IntoIterator<Item = i64>) -> ArrayRef {
    Arc::new(Int64Array::from_iter_values(values))
}

/// A column of yes and no.
pub fn flags(values: impl IntoIterator<Item = Option<bool>>) -> ArrayRef {
    Arc::new(values.into_iter().collect::<BooleanArray>())
}

/// A column of days.
pub fn days(values: impl IntoIterator<Item = Day>) -> ArrayRef {
    Arc::new(Date32Array::from_iter_values(values))
}

/// A text of a table.
pub fn text<'a>(batch: &'a RecordBatch, column: &str, row: usize) -> Option<&'a str> {
    cells::text(batch.column_by_name(column)?, row)
}

/// A number of a table.
pub fn number(batch: &RecordBatch, column: &str, row: usize) -> Option<f64> {
    cells::number(batch.column_by_name(column)?, row)
}

/// A count of a table.
pub fn count(batch: &RecordBatch, column: &str, row: usize) -> Option<i64> {
    cells::count(batch.column_by_name(column)?, row)
}

/// Bytes of a table.
pub fn bytes<'a>(batch: &'a RecordBatch, column: &str, row: usize) -> Option<&'a [u8]> {
    cells::bytes(batch.column_by_name(column)?, row)
}

/// The day of a row.
pub fn day_of(batch: &RecordBatch, row: usize) -> Option<Day> {
    date(batch, "day", row)
}

/// A day of a table.
pub fn date(batch: &RecordBatch, column: &str, row: usize) -> Option<Day> {
    let column = batch.column_by_name(column)?.as_primitive_opt::<Date32Type>()?;
    (!column.is_null(row)).then(|| column.value(row))
}
