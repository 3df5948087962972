//! Results as Parquet: a file is the old one or the new one at every instant.

use std::fs::File;
use std::path::Path;

use datafusion::arrow::array::{RecordBatch, new_null_array};
use datafusion::arrow::compute::concat_batches;
use datafusion::arrow::datatypes::{FieldRef, SchemaRef};
use datafusion::parquet::arrow::ArrowWriter;
use datafusion::parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;
use dynid::output::fill;

use crate::error::{FleetError, Result};

/// Replaces a table, or makes it.
///
/// # Errors
/// What the file system says; the table from before is still there then.
pub fn write(path: &Path, batch: &RecordBatch) -> Result<()> {
    let failed =
        |error: &dyn std::error::Error| FleetError::file(path, format!("it cannot be written: {error}"));
    let mut writer =
        ArrowWriter::try_new(Vec::new(), batch.schema(), None).map_err(|error| failed(&error))?;
    writer.write(batch).map_err(|error| failed(&error))?;
    let bytes = writer.into_inner().map_err(|error| failed(&error))?;
    fill(path, &mut |out: &mut dyn std::io::Write| out.write_all(&bytes)).map_err(|error| failed(&error))
}

/// Reads a table; `None` where there is none. A column that may be empty and that an older dynid-fleet did not write is empty.
///
/// # Errors
/// A file that is no Parquet, or has other columns.
pub fn read(path: &Path, schema: &SchemaRef) -> Result<Option<RecordBatch>> {
    let file = match File::open(path) {
        Ok(file) => file,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(None),
        Err(error) => return Err(FleetError::io(path, "read the table", &error)),
    };
    let failed = |what: &dyn std::fmt::Display| {
        FleetError::file(
            path,
            format!("this is no table of dynid-fleet ({what}); remove it, and it is made again"),
        )
    };
    let reader = ParquetRecordBatchReaderBuilder::try_new(file).and_then(|builder| builder.build());
    let batches: Vec<RecordBatch> = reader
        .map_err(|error| failed(&error))?
        .collect::<std::result::Result<_, _>>()
        .map_err(|error| failed(&error))?;
    let renamed = batches.iter().map(|batch| {
        let column = |field: &FieldRef| match batch.column_by_name(field.name()) {
            None if field.is_nullable() => Some(new_null_array(field.data_type(), batch.num_rows())),
            found => found.cloned(),
        };
        let columns: Option<Vec<_>> = schema.fields().iter().map(column).collect();
        columns.and_then(|columns| RecordBatch::try_new(schema.clone(), columns).ok())
    });
    let batches: Option<Vec<RecordBatch>> = renamed.collect();
    let batches = batches.ok_or_else(|| failed(&"it has other columns"))?;
    concat_batches(schema, &batches).map(Some).map_err(|error| failed(&error))
}
