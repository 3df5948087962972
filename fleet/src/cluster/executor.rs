//! `dynid-fleet serve-executor`

use std::path::PathBuf;
use std::sync::Arc;

use ballista_core::registry::BallistaFunctionRegistry;
use ballista_executor::executor_process::{ExecutorProcessConfig, start_executor_process};
use clap::Args;

use super::{config, state};
use crate::error::{FleetError, Result};

/// Where an executor works.
#[derive(Debug, Clone, Args)]
pub struct ExecutorOptions {
    /// The scheduler that gives it work
    #[arg(long, default_value = "127.0.0.1:50050", value_name = "HOST:PORT")]
    pub scheduler: String,
    /// Name or address that others reach it by
    #[arg(long, default_value = "127.0.0.1")]
    pub host: String,
    /// Port for results; the next one is for orders
    #[arg(long, default_value_t = 50051)]
    pub port: u16,
    /// Recordings at a time [default: one for each processor]
    #[arg(long)]
    pub slots: Option<usize>,
    /// Folder for what is between two steps of a job [default: a temporary one]
    #[arg(long)]
    pub work_dir: Option<PathBuf>,
}

/// Serves until it is stopped.
///
/// # Errors
/// A scheduler that does not answer, ports that are taken.
pub async fn serve_executor(options: &ExecutorOptions) -> Result<()> {
    let failed = |error: String| {
        FleetError::Cluster(format!("cannot work for the scheduler at {}: {error}", options.scheduler))
    };
    let (host, port) =
        options.scheduler.rsplit_once(':').ok_or_else(|| failed("expected HOST:PORT".into()))?;
    let port = port.parse().map_err(|_| failed(format!("`{port}` is no port")))?;
    let processors = std::thread::available_parallelism().map_or(1, usize::from);
    let state = state(config())?;
    let config = ExecutorProcessConfig {
        scheduler_host: host.to_owned(),
        scheduler_port: port,
        external_host: Some(options.host.clone()),
        port: options.port,
        grpc_port: options
            .port
            .checked_add(1)
            .ok_or_else(|| failed("--port must be less than 65535".into()))?,
        vcores: options.slots.unwrap_or(processors),
        work_dir: options.work_dir.as_ref().map(|path| path.display().to_string()),
        executor_heartbeat_interval_seconds: 2,
        override_function_registry: Some(Arc::new(BallistaFunctionRegistry::from(&state))),
        ..ExecutorProcessConfig::default()
    };
    start_executor_process(Arc::new(config)).await.map_err(|error| failed(error.to_string()))
}
