//! Ballista: the same functions on a scheduler, on executors, and in the client.
//!
//! Settings and guards are those with which jobs survive executors that are killed: without adaptive planning, one partition
//! a task, short times until an executor counts as lost.

mod codec;
mod executor;
mod scheduler;

use std::sync::Arc;
use std::time::Duration;

use ballista::prelude::{SessionConfigExt, SessionContextExt};
use datafusion::execution::{SessionState, SessionStateBuilder};
use datafusion::prelude::{SessionConfig, SessionContext};

use crate::columns::plain_columns;
use crate::error::{FleetError, Result};
use crate::functions::register;

pub use executor::{ExecutorOptions, serve_executor};
pub use scheduler::{SchedulerOptions, serve_scheduler};

/// How long a scheduler may take to answer.
const PATIENCE: Duration = Duration::from_secs(10);

/// Settings of a session, the same for all roles.
///
/// With adaptive planning a job hangs whose reducing executor is killed; with several partitions a task groups were
/// returned twice.
pub(crate) fn config() -> SessionConfig {
    plain_columns(SessionConfig::new_with_ballista())
        .set_str("ballista.planner.adaptive.enabled", "false")
        .set_str("ballista.scheduler.max_partitions_per_task", "1")
        .with_target_partitions(1)
        .with_ballista_logical_extension_codec(Arc::new(codec::LogicalCodec::default()))
}

/// A session with dynid's functions.
pub(crate) fn state(config: SessionConfig) -> datafusion::error::Result<SessionState> {
    let state = SessionStateBuilder::new().with_config(config).with_default_features().build();
    let context = SessionContext::new_with_state(state);
    register(&context);
    Ok(context.state())
}

/// A context whose plans run on the cluster of the scheduler at `host:port`.
///
/// # Errors
/// A scheduler that does not answer.
pub async fn client(scheduler: &str) -> Result<SessionContext> {
    let silent = |why: String| {
        FleetError::Cluster(format!(
            "no scheduler answers at {scheduler}: {why}. Is `dynid-fleet serve-scheduler` running there?"
        ))
    };
    // The session itself connects with its first query only.
    match tokio::time::timeout(PATIENCE, tokio::net::TcpStream::connect(scheduler)).await {
        Err(_) => return Err(silent(format!("nothing within {} s", PATIENCE.as_secs()))),
        Ok(Err(error)) => return Err(silent(error.to_string())),
        Ok(Ok(_)) => {}
    }
    let context = SessionContext::remote_with_state(&format!("df://{scheduler}"), state(config())?).await;
    let context = context.map_err(|error| silent(error.strip_backtrace()))?;
    // A context that becomes one of Ballista has its functions replaced.
    register(&context);
    Ok(context)
}
