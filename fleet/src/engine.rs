//! Where plans run: in this process, or on a cluster.

use std::sync::Arc;
use std::time::Duration;

use datafusion::arrow::array::RecordBatch;
use datafusion::execution::SessionStateBuilder;
use datafusion::prelude::{SessionConfig, SessionContext};
use futures::TryStreamExt;

use crate::cluster;
use crate::columns::plain_columns;
use crate::error::{FleetError, Result};
use crate::functions::{WorkTable, register};

/// Where plans run.
#[derive(Debug, Clone)]
pub enum Engine {
    /// In this process.
    Embedded,
    /// On the cluster whose scheduler listens at `host:port`.
    Cluster {
        /// `host:port`.
        scheduler: String,
        /// After how long without a result a job is submitted again.
        timeout: Duration,
    },
}

/// How often a job is submitted before the cluster is given up.
const SUBMISSIONS: usize = 3;

/// A context of this process with dynid's functions. Rows come in one order, whatever the number of processors.
pub fn embedded() -> SessionContext {
    let config = plain_columns(SessionConfig::new().with_target_partitions(1));
    let context = SessionContext::new_with_state(
        SessionStateBuilder::new().with_config(config).with_default_features().build(),
    );
    register(&context);
    context
}

impl Engine {
    /// That of a command: on the cluster of a scheduler where one is given.
    pub fn at(scheduler: Option<&str>, timeout: Duration) -> Self {
        scheduler.map_or(Engine::Embedded, |scheduler| Engine::Cluster {
            scheduler: scheduler.to_owned(),
            timeout,
        })
    }

    /// A context with dynid's functions.
    ///
    /// # Errors
    /// A scheduler that does not answer.
    pub async fn context(&self) -> Result<SessionContext> {
        match self {
            Engine::Embedded => Ok(embedded()),
            Engine::Cluster { scheduler, .. } => cluster::client(scheduler).await,
        }
    }

    /// Runs a query over rows, which are the table `work`, each row a task of its own. `keep` is given each part of the answer
    /// as it comes; parts of a job that is submitted again come again.
    ///
    /// A cluster that loses executors may fail a job, or stay silent: it is submitted again. `complete` says whether
    /// all is there that was asked for, each once.
    ///
    /// # Errors
    /// What the engine or `keep` says; a cluster that failed as often as it may.
    pub async fn over(
        &self,
        rows: &RecordBatch,
        query: &str,
        keep: Keep<'_>,
        complete: Complete<'_>,
    ) -> Result<()> {
        let Engine::Cluster { scheduler, timeout } = self else {
            let parts = submitted(&embedded(), rows, query, keep).await?;
            let wrong = |what| FleetError::Engine(format!("the engine returned another result: {what}"));
            return complete(&parts).map_err(wrong);
        };
        let mut why = String::new();
        for submission in 0..SUBMISSIONS {
            if submission > 0 {
                eprintln!("dynid-fleet: the cluster at {scheduler}: {why}; submitting again");
            }
            let context = cluster::client(scheduler).await?;
            // Nothing is kept before it is known to be complete.
            let collected = submitted(&context, rows, query, &|_| Ok(()));
            why = match tokio::time::timeout(*timeout, collected).await {
                Err(_) => format!("no result within {} s", timeout.as_secs()),
                Ok(Err(error)) => error.to_string(),
                Ok(Ok(parts)) => match complete(&parts) {
                    Ok(()) => return parts.iter().try_for_each(keep),
                    Err(what) => what,
                },
            };
        }
        Err(FleetError::Cluster(format!(
            "the cluster at {scheduler} gave no result {SUBMISSIONS} times, at last: {why}. What it did before is kept; are there \
             executors (dynid-fleet serve-executor)?"
        )))
    }
}

/// Takes a part of an answer.
pub type Keep<'a> = &'a (dyn Fn(&RecordBatch) -> Result<()> + Sync);

/// Says whether an answer is complete, or what is wrong with it.
pub type Complete<'a> = &'a (dyn Fn(&[RecordBatch]) -> std::result::Result<(), String> + Sync);

async fn submitted(
    context: &SessionContext,
    rows: &RecordBatch,
    query: &str,
    keep: Keep<'_>,
) -> Result<Vec<RecordBatch>> {
    context.register_table("work", Arc::new(WorkTable::new(rows.clone())))?;
    let mut answer = context.sql(query).await?.execute_stream().await?;
    let mut parts = Vec::new();
    while let Some(part) = answer.try_next().await? {
        keep(&part)?;
        parts.push(part);
    }
    Ok(parts)
}
