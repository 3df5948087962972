//! `dynid-fleet serve-scheduler`

use std::net::SocketAddr;
use std::sync::Arc;

use ballista_scheduler::cluster::BallistaCluster;
use ballista_scheduler::config::SchedulerConfig;
use ballista_scheduler::scheduler_process::start_server;
use clap::Args;

use super::{codec, state};
use crate::error::{FleetError, Result};

/// Where a scheduler listens.
#[derive(Debug, Clone, Args)]
pub struct SchedulerOptions {
    /// Address and port to listen at
    #[arg(long, default_value = "127.0.0.1:50050", value_name = "HOST:PORT")]
    pub bind: SocketAddr,
    /// After how many seconds without a sign of life an executor is lost and its recordings go to others
    #[arg(long, default_value_t = 10)]
    pub executor_timeout: u64,
}

/// Serves until it is stopped.
///
/// # Errors
/// An address that cannot be listened at.
pub async fn serve_scheduler(options: &SchedulerOptions) -> Result<()> {
    let failed = |error: String| FleetError::Cluster(format!("cannot serve at {}: {error}", options.bind));
    let config = SchedulerConfig {
        bind_host: options.bind.ip().to_string(),
        bind_port: options.bind.port(),
        executor_timeout_seconds: options.executor_timeout,
        expire_dead_executor_interval_seconds: 2,
        no_executors_grace_period_seconds: options.executor_timeout,
        override_session_builder: Some(Arc::new(state)),
        override_logical_codec: Some(Arc::new(codec::LogicalCodec::default())),
        ..SchedulerConfig::default()
    };
    let cluster =
        BallistaCluster::new_from_config(&config).await.map_err(|error| failed(error.to_string()))?;
    eprintln!("dynid-fleet: scheduler at {}", options.bind);
    start_server(cluster, options.bind, Arc::new(config)).await.map_err(|error| failed(error.to_string()))
}
