//! Recordings on a web server.

use std::hash::{DefaultHasher, Hash, Hasher};
use std::io::{BufRead, BufReader, Write};
use std::net::{TcpListener, TcpStream};
use std::path::{Path, PathBuf};

use crate::common::{Fleet, numbers, pairs};

/// Serves the files of a folder on loopback until the test ends; `host:port`.
fn serve(folder: &Path) -> String {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap().to_string();
    let folder = folder.to_path_buf();
    std::thread::spawn(move || {
        for stream in listener.incoming().flatten() {
            let folder = folder.clone();
            std::thread::spawn(move || answer(stream, &folder));
        }
    });
    address
}

fn answer(stream: TcpStream, folder: &Path) -> Option<()> {
    let mut requests = BufReader::new(stream.try_clone().ok()?);
    let mut stream = stream;
    loop {
        let mut first = String::new();
        requests.read_line(&mut first).ok().filter(|read| *read > 0)?;
        let mut header = String::new();
        while requests.read_line(&mut header).ok()? > 2 {
            header.clear();
        }
        let path: PathBuf = folder.join(first.split(' ').nth(1)?.trim_start_matches('/'));
        let (status, body) = match std::fs::read(&path) {
            _ if !first.starts_with("GET") && !first.starts_with("HEAD") => {
                ("405 Method Not Allowed", Vec::new())
            }
            Ok(body) => ("200 OK", body),
            Err(_) => ("404 Not Found", Vec::new()),
        };
        let mut tag = DefaultHasher::new();
        body.hash(&mut tag);
        let (length, tag) = (body.len(), tag.finish());
        write!(stream, "HTTP/1.1 {status}\r\nContent-Length: {length}\r\nETag: \"{tag:x}\"\r\n\r\n").ok()?;
        if first.starts_with("GET") {
            stream.write_all(&body).ok()?;
        }
    }
}

#[test]
fn recordings_on_a_web_server_give_the_same_parameters() {
    let fleet = Fleet::new(2, 1);
    let (local, remote) = (fleet.out("local"), fleet.out("remote"));
    fleet.run(&local);
    let address = serve(fleet.folder.path());
    let list = "robot,day,recording\nr001,2026-03-01,logs/r001/2026-03-01/recording.yaml\n\
                r002,2026-03-01,logs/r002/2026-03-01/recording.yaml\nr003,2026-03-01,logs/none/recording.yaml\n";
    std::fs::write(fleet.folder.path().join("list.csv"), list).unwrap();
    fleet.write(&format!("recordings: list.csv\nstore: http://{address}\ndiagnosis: {{enabled: false}}\n"));
    fleet.run(&remote);
    let values = "SELECT value FROM parameters WHERE value IS NOT NULL ORDER BY robot, parameter";
    assert_eq!(numbers(&local, values), numbers(&remote, values));
    let outcomes = pairs(&remote, "SELECT outcome, message FROM screening ORDER BY robot");
    assert_eq!(outcomes[0].0, "used");
    assert!(
        outcomes[2].0 == "unreadable" && outcomes[2].1.contains("there is no such object"),
        "{outcomes:?}"
    );
    // The server tells what was replaced, and what has come.
    assert_eq!(fleet.run(&remote).reduced, 0);
    for file in std::fs::read_dir(fleet.recording("r002", 1)).unwrap().flatten() {
        std::fs::copy(file.path(), fleet.recording("r001", 1).join(file.file_name())).unwrap();
    }
    std::fs::rename(fleet.recording("r002", 1), fleet.folder.path().join("logs/none")).unwrap();
    let again = fleet.run(&remote);
    assert_eq!((again.reduced, again.replaced), (2, 2));
    let of = |robot: &str| {
        numbers(
            &remote,
            &format!(
                "SELECT value FROM parameters WHERE robot = '{robot}' AND value IS NOT NULL ORDER BY parameter"
            ),
        )
    };
    assert!(of("r001") == of("r002") && of("r001") == of("r003") && of("r001").len() > 30);
}

#[test]
fn a_server_that_lists_nothing_says_that_a_table_is_needed() {
    let fleet = Fleet::new(1, 1);
    let address = serve(fleet.folder.path());
    fleet.write(&format!("recordings: logs/{{robot}}/{{day}}/recording.yaml\nstore: http://{address}\n"));
    let file = fleet.read();
    let said = crate::common::runtime().block_on(dynid_fleet::work::work(&file, None)).expect_err("no list");
    assert!(said.to_string().contains("`recordings:` to be a table"), "{said}");
}
