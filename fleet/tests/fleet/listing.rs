//! Where recordings are said to be.

use dynid_fleet::fleet_file::FleetFile;
use dynid_fleet::work::{Item, work};

use crate::common::{Fleet, runtime};

fn listed(fleet: &Fleet) -> Result<Vec<Item>, String> {
    let file: FleetFile = fleet.read();
    runtime().block_on(work(&file, None)).map_err(|error| error.to_string())
}

#[test]
fn a_table_says_the_same_as_a_pattern_and_what_else_it_knows() {
    let fleet = Fleet::new(2, 2);
    let by_pattern = listed(&fleet).unwrap();
    let mut table = "robot,time,recording,temperature\n".to_owned();
    for item in by_pattern.iter().rev() {
        let day = dynid_fleet::day::written(item.day);
        table.push_str(&format!(
            "{},{day}T08:00:00+01:00,logs/{}/{day}/recording.yaml,31.5\n",
            item.robot, item.robot
        ));
    }
    std::fs::write(fleet.folder.path().join("list.csv"), table).unwrap();
    fleet.write("recordings: list.csv\nrobots: {r002: ./own.yaml, '*': tx40}\nband: 8\n");
    let by_table = listed(&fleet).unwrap();
    let same = |items: &[Item]| {
        items.iter().map(|i| (i.robot.clone(), i.day, i.recording.clone())).collect::<Vec<_>>()
    };
    assert_eq!(same(&by_pattern), same(&by_table));
    assert!(by_table.iter().all(|item| item.temperature == Some(31.5) && item.band == Some(8.0)));
    assert_eq!(by_table[0].table.as_deref(), Some("tx40"));
    assert!(by_table[1].table.as_deref().is_some_and(|table| table.ends_with("./own.yaml")));
    assert_ne!(by_table[0].key(), by_pattern[0].key());
}

#[test]
fn mistakes_in_a_table_are_told_with_their_line_and_column() {
    let fleet = Fleet::new(1, 1);
    fleet.write("recordings: list.csv\n");
    let told = |table: &str| {
        std::fs::write(fleet.folder.path().join("list.csv"), table).unwrap();
        listed(&fleet).expect_err("a mistake")
    };
    assert!(told("robot,recording\n").contains("list.csv:1:1: no column time or day"));
    assert!(
        told("robot,time,recording\nr1,2026-01-01,a\nr1,soon,a\n")
            .contains("list.csv:3:2: `soon` is no time")
    );
    assert!(told("robot,time,recording\nr1,2026-01-01\n").contains("list.csv:2"));
    assert!(told("robot,time,recording\n,2026-01-01,a\n").contains("list.csv:2:1: field 1 (robot) is empty"));
    assert!(told("robot,time,recording,load\nr1,2026-01-01,a,much\n").contains("list.csv:2:4: load: `much`"));
    std::fs::remove_file(fleet.folder.path().join("list.csv")).unwrap();
    assert!(listed(&fleet).expect_err("no table").contains("list.csv: cannot read the recordings"));
}

#[test]
fn a_parquet_table_is_read_too() {
    let fleet = Fleet::new(1, 1);
    let path = fleet.folder.path().join("list.parquet");
    runtime().block_on(async {
        let query = format!(
            "COPY (SELECT 'r001' AS robot, TIMESTAMP '2026-03-01T08:00:00' AS time, 'logs/r001/2026-03-01/recording.yaml' AS \
             recording, 7 AS load) TO '{}' STORED AS PARQUET",
            path.display()
        );
        dynid_fleet::engine::embedded().sql(&query).await.unwrap().collect().await.unwrap();
    });
    let by_pattern = listed(&fleet).unwrap();
    fleet.write("recordings: list.parquet\n");
    let by_table = listed(&fleet).unwrap();
    assert_eq!((by_table[0].day, &by_table[0].recording), (by_pattern[0].day, &by_pattern[0].recording));
    assert_eq!((by_table[0].load, by_table[0].temperature), (Some(7.0), None));
}
