//! Kinds of columns.

use datafusion::prelude::SessionConfig;

/// Tables read from Parquet have the kinds of columns that dynid's functions take and give: no views.
pub(crate) fn plain_columns(config: SessionConfig) -> SessionConfig {
    config.set_bool("datafusion.execution.parquet.schema_force_view_types", false)
}
