//! Columns as a Parquet file.

use std::io::{self, Write};
use std::sync::Arc;

use parquet::basic::{Repetition, Type as Physical};
use parquet::data_type::DoubleType;
use parquet::errors::Result;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::Type;

use crate::recording::Columns;

/// Rows of a group.
const GROUP: usize = 100_000;

/// Writes columns as doubles that are not packed.
pub(in crate::recording) fn write(columns: &Columns<'_>, out: &mut dyn Write) -> io::Result<()> {
    // The writer wants something that it owns and can send.
    let mut bytes = Vec::new();
    rows(columns, &mut bytes).map_err(io::Error::other)?;
    out.write_all(&bytes)
}

fn rows(columns: &Columns<'_>, out: &mut Vec<u8>) -> Result<()> {
    let field = |(name, _): &(String, &[f64])| {
        let double = Type::primitive_type_builder(name, Physical::DOUBLE);
        double.with_repetition(Repetition::REQUIRED).build().map(Arc::new)
    };
    let fields = columns.iter().map(field).collect::<Result<Vec<_>>>()?;
    let schema = Arc::new(Type::group_type_builder("motion").with_fields(fields).build()?);
    let properties =
        WriterProperties::builder().set_dictionary_enabled(false).set_created_by("dynid".into()).build();
    let mut writer = SerializedFileWriter::new(out, schema, Arc::new(properties))?;
    for first in (0..columns.first().map_or(0, |(_, values)| values.len())).step_by(GROUP) {
        let mut group = writer.next_row_group()?;
        let mut values = columns.iter().map(|(_, values)| &values[first..(first + GROUP).min(values.len())]);
        while let (Some(mut column), Some(values)) = (group.next_column()?, values.next()) {
            column.typed::<DoubleType>().write_batch(values, None, None)?;
            column.close()?;
        }
        group.close()?;
    }
    writer.close()?;
    Ok(())
}
