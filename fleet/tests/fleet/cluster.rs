//! A scheduler and executors as processes of their own.

use std::net::TcpListener;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use crate::common::{Fleet, PROGRAM, parquet_files};

/// A process that ends with the test.
struct Server(Child);

impl Drop for Server {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

fn served(arguments: &[String]) -> Server {
    let child = Command::new(PROGRAM).args(arguments).stdout(Stdio::null()).stderr(Stdio::null()).spawn();
    Server(child.unwrap())
}

/// So many ports in a row that nobody listens at.
fn free_ports(count: u16) -> u16 {
    for _ in 0..100 {
        let first = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
        let free = |port: u16| TcpListener::bind(("127.0.0.1", port)).is_ok();
        if (1..count).all(|k| first.checked_add(k).is_some_and(free)) {
            return first;
        }
    }
    panic!("no free ports");
}

fn wait_for(port: u16) {
    let start = Instant::now();
    while std::net::TcpStream::connect(("127.0.0.1", port)).is_err() {
        assert!(start.elapsed() < Duration::from_secs(60), "nothing listens at {port}");
        std::thread::sleep(Duration::from_millis(50));
    }
}

struct Cluster {
    address: String,
    executors: Vec<Server>,
    _scheduler: Server,
}

fn cluster() -> Cluster {
    let port = free_ports(5);
    let address = format!("127.0.0.1:{port}");
    let words = |text: String| text.split(' ').map(str::to_owned).collect::<Vec<_>>();
    let scheduler = served(&words(format!("serve-scheduler --bind {address} --executor-timeout 6")));
    wait_for(port);
    let executor = |first: u16| {
        let one = served(&words(format!("serve-executor --scheduler {address} --port {first} --slots 1")));
        wait_for(first);
        one
    };
    let executors = vec![executor(port + 1), executor(port + 3)];
    // Until the scheduler knows of both.
    std::thread::sleep(Duration::from_secs(1));
    Cluster { address, executors, _scheduler: scheduler }
}

fn started(fleet: &Fleet, out: &Path, address: &str) -> Child {
    let arguments = [
        "run",
        &fleet.file.display().to_string(),
        "--out",
        &out.display().to_string(),
        "--cluster",
        address,
        "--timeout",
        "60",
    ];
    Command::new(PROGRAM).args(arguments).stderr(Stdio::piped()).stdout(Stdio::null()).spawn().unwrap()
}

/// CPU time of a process, s; `None` where the system does not say.
fn cpu_seconds(server: &Server) -> Option<f64> {
    let stat = std::fs::read_to_string(format!("/proc/{}/stat", server.0.id())).ok()?;
    let behind: Vec<&str> = stat.rsplit_once(')')?.1.split_whitespace().collect();
    Some(behind.get(11..13)?.iter().filter_map(|ticks| ticks.parse::<f64>().ok()).sum::<f64>() / 100.0)
}

#[test]
fn a_cluster_gives_the_same_files_and_both_executors_work() {
    let fleet = Fleet::long(3, 2);
    let (here, there) = (fleet.out("here"), fleet.out("there"));
    fleet.run(&here);
    let cluster = cluster();
    let before: Vec<_> = cluster.executors.iter().map(cpu_seconds).collect();
    let run = started(&fleet, &there, &cluster.address).wait_with_output().unwrap();
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    assert_eq!(parquet_files(&here), parquet_files(&there));
    for (executor, before) in cluster.executors.iter().zip(before) {
        if let (Some(now), Some(before)) = (cpu_seconds(executor), before) {
            assert!(now > before + 0.1, "an executor did nothing");
        }
    }
}

#[test]
fn a_job_whose_executor_is_killed_ends_with_the_same_files() {
    let fleet = Fleet::long(4, 4);
    let (here, there) = (fleet.out("here"), fleet.out("there"));
    fleet.run(&here);
    let mut cluster = cluster();
    let idle = cpu_seconds(&cluster.executors[0]);
    let mut run = started(&fleet, &there, &cluster.address);
    let start = Instant::now();
    // In the middle: it has worked, and the run goes on.
    while cpu_seconds(&cluster.executors[0]).zip(idle).is_some_and(|(now, idle)| now < idle + 0.4) {
        assert!(run.try_wait().unwrap().is_none(), "the run was over before the executor could be killed");
        assert!(start.elapsed() < Duration::from_secs(60), "the executor does nothing");
        std::thread::sleep(Duration::from_millis(10));
    }
    assert!(run.try_wait().unwrap().is_none());
    cluster.executors[0].0.kill().unwrap();
    let run = run.wait_with_output().unwrap();
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    assert_eq!(parquet_files(&here), parquet_files(&there));
}

#[test]
fn a_scheduler_that_is_not_there_is_told() {
    let fleet = Fleet::new(1, 1);
    let address = format!("127.0.0.1:{}", free_ports(1));
    let run = started(&fleet, &fleet.out("o"), &address).wait_with_output().unwrap();
    let said = String::from_utf8_lossy(&run.stderr).into_owned();
    assert!(
        !run.status.success() && said.contains("no scheduler answers at") && said.contains("serve-scheduler"),
        "{said}"
    );
}
