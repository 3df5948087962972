//! Recordings as a table, and `dynid_factors('fleet.yaml')`: what each of them is reduced to.

use std::path::PathBuf;
use std::sync::Arc;

use datafusion::arrow::array::{ArrayRef, Date32Array, Float64Array, RecordBatch, StringArray};
use datafusion::arrow::datatypes::{DataType, Field, Schema, SchemaRef};
use datafusion::catalog::{Session, TableFunctionArgs, TableFunctionImpl, TableProvider};
use datafusion::common::{Result, ScalarValue, exec_datafusion_err, plan_err};
use datafusion::datasource::memory::MemorySourceConfig;
use datafusion::datasource::{TableType, ViewTable, provider_as_source};
use datafusion::logical_expr::{Expr, LogicalPlanBuilder, ScalarUDF, col};
use datafusion::physical_plan::ExecutionPlan;
use datafusion::prelude::get_field;

use super::reduce::{Reduce, motion_fields};
use crate::fleet_file::FleetFile;
use crate::work::{Item, work};

/// Columns of [`WorkTable`].
pub fn work_schema() -> SchemaRef {
    let field = |name: &str, kind, null| Field::new(name, kind, null);
    Arc::new(Schema::new(vec![
        field("robot", DataType::Utf8, false),
        field("day", DataType::Date32, false),
        field("recording", DataType::Utf8, false),
        field("key", DataType::Utf8, false),
        field("robot_table", DataType::Utf8, true),
        field("asked_band", DataType::Float64, true),
        field("temperature", DataType::Float64, true),
        field("load", DataType::Float64, true),
    ]))
}

/// Recordings as rows.
///
/// # Errors
/// None that these columns can have.
pub fn work_batch(items: &[Item]) -> Result<RecordBatch> {
    let text =
        |of: fn(&Item) -> &str| -> ArrayRef { Arc::new(StringArray::from_iter_values(items.iter().map(of))) };
    let number = |of: fn(&Item) -> Option<f64>| -> ArrayRef {
        Arc::new(Float64Array::from_iter(items.iter().map(of)))
    };
    Ok(RecordBatch::try_new(
        work_schema(),
        vec![
            text(|i| &i.robot),
            Arc::new(Date32Array::from_iter_values(items.iter().map(|i| i.day))),
            text(|i| &i.recording),
            Arc::new(StringArray::from_iter_values(items.iter().map(Item::key))),
            Arc::new(StringArray::from_iter(items.iter().map(|i| i.table.as_deref()))),
            number(|i| i.band),
            number(|i| i.temperature),
            number(|i| i.load),
        ],
    )?)
}

/// Rows of which each is a partition of its own, so that each goes to the next processor, or executor, that is free.
///
/// Its plan is a memory scan, which Ballista cuts into partitions; a plan node of one's own would be run by every task from
/// its beginning.
#[derive(Debug)]
pub struct WorkTable(RecordBatch);

impl WorkTable {
    /// A table of rows.
    pub fn new(rows: RecordBatch) -> Self {
        Self(rows)
    }

    /// Its rows.
    pub fn rows(&self) -> &RecordBatch {
        &self.0
    }
}

#[async_trait::async_trait]
impl TableProvider for WorkTable {
    fn schema(&self) -> SchemaRef {
        self.0.schema()
    }

    fn table_type(&self) -> TableType {
        TableType::Base
    }

    async fn scan(
        &self,
        _: &dyn Session,
        projection: Option<&Vec<usize>>,
        _: &[Expr],
        _: Option<usize>,
    ) -> Result<Arc<dyn ExecutionPlan>> {
        let partitions: Vec<Vec<RecordBatch>> =
            (0..self.0.num_rows()).map(|k| vec![self.0.slice(k, 1)]).collect();
        Ok(MemorySourceConfig::try_new_exec(&partitions, self.0.schema(), projection.cloned())?)
    }
}

/// `dynid_factors('fleet.yaml')`
#[derive(Debug)]
pub struct FactorsFunction;

impl TableFunctionImpl for FactorsFunction {
    fn call_with_args(&self, args: TableFunctionArgs<'_, '_>) -> Result<Arc<dyn TableProvider>> {
        let [Expr::Literal(ScalarValue::Utf8(Some(path)), _)] = args.exprs() else {
            return plan_err!("dynid_factors('fleet.yaml') takes the path of a fleet");
        };
        let rows = work_batch(&listed(path)?)?;
        let scan =
            LogicalPlanBuilder::scan("recordings", provider_as_source(Arc::new(WorkTable::new(rows))), None)?;
        let reduce = ScalarUDF::from(Reduce::new());
        let own = ["robot", "day", "recording"];
        let motion = || col("motion_of_recording");
        let motions = reduce.call(vec![col("recording"), col("robot_table"), col("asked_band")]);
        let columns = own.map(col).into_iter().chain([motions.alias("motion_of_recording")]);
        let fields: Vec<Expr> = own
            .map(col)
            .into_iter()
            .chain(motion_fields().iter().map(|f| get_field(motion(), f.name().as_str()).alias(f.name())))
            .collect();
        let plan = scan.project(columns)?.unnest_column("motion_of_recording")?.project(fields)?.build()?;
        Ok(Arc::new(ViewTable::new(plan, None)))
    }
}

/// The recordings of a fleet. A table function is called where nothing can be waited for.
fn listed(path: &str) -> Result<Vec<Item>> {
    let path = PathBuf::from(path);
    std::thread::scope(|scope| {
        let listed = scope.spawn(|| {
            let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
            let runtime = runtime.map_err(|error| exec_datafusion_err!("{error}"))?;
            let fleet = FleetFile::read(&path).map_err(|error| exec_datafusion_err!("{error}"))?;
            runtime.block_on(work(&fleet, None)).map_err(|error| exec_datafusion_err!("{error}"))
        });
        listed.join().unwrap_or_else(|_| Err(exec_datafusion_err!("the fleet could not be listed")))
    })
}
