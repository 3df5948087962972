//! What the tests share.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use datafusion::arrow::array::{Array, AsArray, RecordBatch};
use datafusion::arrow::datatypes::Float64Type;
use dynid_fleet::engine::{Engine, embedded};
use dynid_fleet::fleet_file::FleetFile;
use dynid_fleet::run::{Summary, run};
use dynid_fleet::simulated::{Plan, simulate};
use tempfile::TempDir;

/// The program.
pub const PROGRAM: &str = env!("CARGO_BIN_EXE_dynid-fleet");

/// A simulated fleet in a folder that is removed with it.
pub struct Fleet {
    pub folder: TempDir,
    pub file: PathBuf,
}

impl Fleet {
    /// So many robots and days with a short recording each, which are not diagnosed.
    pub fn new(robots: usize, days: usize) -> Self {
        Self::of(&Plan { robots, days, motions: 1, rate: 100.0, day_to_day: 0.002, seed: 3 })
    }

    /// The same with recordings that take some tenths of a second each, in which a process can be killed.
    pub fn long(robots: usize, days: usize) -> Self {
        Self::of(&Plan { robots, days, motions: 8, rate: 500.0, day_to_day: 0.002, seed: 3 })
    }

    fn of(plan: &Plan) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let file = simulate(folder.path(), plan).unwrap();
        let fleet = Self { folder, file };
        fleet.write(
            "recordings: logs/{robot}/{day}/recording.yaml\nout: results\ndiagnosis: {enabled: false}\n",
        );
        fleet
    }

    /// Replaces its file.
    pub fn write(&self, text: &str) {
        std::fs::write(&self.file, text).unwrap();
    }

    /// Reads its file.
    pub fn read(&self) -> FleetFile {
        FleetFile::read(&self.file).unwrap()
    }

    /// The folder of a recording; days from 1.
    pub fn recording(&self, robot: &str, day: usize) -> PathBuf {
        self.folder.path().join(format!("logs/{robot}/2026-03-{day:02}"))
    }

    /// A folder of results beside it.
    pub fn out(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Runs it in this process.
    pub fn run(&self, out: &Path) -> Summary {
        runtime().block_on(run(&self.read(), out, &Engine::Embedded, None)).unwrap()
    }
}

/// A runtime with two workers.
pub fn runtime() -> tokio::runtime::Runtime {
    tokio::runtime::Builder::new_multi_thread()
        .worker_threads(2)
        .thread_stack_size(16 << 20)
        .enable_all()
        .build()
        .unwrap()
}

/// Asks the results of a folder.
pub fn ask(out: &Path, query: &str) -> Vec<RecordBatch> {
    runtime().block_on(async {
        let context = embedded();
        for name in ["parameters", "findings", "screening", "factors"] {
            let path = format!("{}/", out.join(name).display());
            context.register_parquet(name, path, Default::default()).await.unwrap();
        }
        context.sql(query).await.unwrap().collect().await.unwrap()
    })
}

/// Rows of two texts.
pub fn pairs(out: &Path, query: &str) -> Vec<(String, String)> {
    let text = |batch: &RecordBatch, column: usize, row: usize| {
        let column = datafusion::arrow::compute::cast(
            batch.column(column),
            &datafusion::arrow::datatypes::DataType::Utf8,
        );
        let column = column.unwrap();
        let column = column.as_string::<i32>();
        if column.is_null(row) { String::new() } else { column.value(row).to_owned() }
    };
    ask(out, query)
        .iter()
        .flat_map(|b| (0..b.num_rows()).map(|k| (text(b, 0, k), text(b, 1, k))).collect::<Vec<_>>())
        .collect()
}

/// Numbers of one column.
pub fn numbers(out: &Path, query: &str) -> Vec<f64> {
    ask(out, query).iter().flat_map(|b| b.column(0).as_primitive::<Float64Type>().values().to_vec()).collect()
}

/// Every Parquet file of a folder of results, by its name within it.
pub fn parquet_files(out: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut files = BTreeMap::new();
    let mut folders = vec![out.to_path_buf()];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap().flatten() {
            let path = entry.path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == "parquet") {
                let name = path.strip_prefix(out).unwrap().display().to_string();
                files.insert(name, std::fs::read(&path).unwrap());
            }
        }
    }
    files
}
