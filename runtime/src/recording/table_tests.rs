use std::io::Read;

use proptest::prelude::*;

use super::TableReader;
use crate::recording::{Column, Layout, Reason, RecordingError, Rows};

fn names(names: &[&str]) -> Vec<Column> {
    names.iter().map(|n| Column::Name((*n).into())).collect()
}

fn indices(indices: &[usize]) -> Vec<Column> {
    indices.iter().map(|i| Column::Index(*i)).collect()
}

fn headless() -> Layout {
    Layout { header: false, ..Layout::default() }
}

fn read(text: &[u8], layout: &Layout, wanted: &[Column]) -> Result<Rows, RecordingError> {
    let mut reader = TableReader::new(text, "x.csv", layout, wanted)?;
    let mut rows = Rows::new(wanted.len());
    while reader.read(&mut rows, 3)? > 0 {}
    Ok(rows)
}

#[test]
fn the_wanted_columns_come_in_the_order_asked_for() {
    let rows =
        read(b"t,a,b,c\n0,1,2,3\n1,4,5,6\n", &Layout::default(), &names(&["c", "t"])).expect("a table");
    assert_eq!(rows.columns, [[3.0, 6.0], [0.0, 1.0]]);
    assert_eq!(rows.lines, [2, 3]);
    assert!(rows.faults.is_empty());
}

#[test]
fn tables_as_people_and_loggers_write_them_are_read() {
    let layout = |delimiter, decimal, header, skip| Layout { header, delimiter, decimal, skip };
    let comma = Layout::default();
    let cases: &[(&[u8], Layout, &[usize])] = &[
        (b"a,b\n1,2\n3,4\n", comma.clone(), &[0, 1]),
        (b"a,b\r\n1,2\r\n3,4\r\n", comma.clone(), &[0, 1]),
        (b"a,b\n1,2\n3,4", comma.clone(), &[0, 1]),
        (b"\xef\xbb\xbfa,b\n1,2\n3,4\n", comma.clone(), &[0, 1]),
        (b"a,b\n\n1,2\n  \n3,4\n\n", comma.clone(), &[0, 1]),
        (b"# made by a logger\na,b\n1,2\n# pause 9,9\n3,4\n", comma.clone(), &[0, 1]),
        (b"a,b,\n1,2,\n3,4,\n", comma.clone(), &[0, 1]),
        (b"\"a\",\"b\"\n\"1\",\"2\"\n\"3\", 4\n", comma.clone(), &[0, 1]),
        (b"x,\"y, of it\",b\n1,\"no, no\",2\n3,ok,4\n", comma.clone(), &[0, 2]),
        (b" 1 , 2\n3 ,4 \n", layout(b',', b'.', false, 0), &[0, 1]),
        (b"1;2\n3;4\n", layout(b';', b'.', false, 0), &[0, 1]),
        (b"1,0;2,0\n3,0;4,0e0\n", layout(b';', b',', false, 0), &[0, 1]),
        (b"1\t2\n3\t4\n", layout(b'\t', b'.', false, 0), &[0, 1]),
        (b"   1   2\n3 4   \n", layout(b' ', b'.', false, 0), &[0, 1]),
        (b"1 \t 2\n3\t4\n", layout(b' ', b'.', false, 0), &[0, 1]),
        (b"logger 3\nunits: rad\na,b\n1,2\n3,4\n", layout(b',', b'.', true, 2), &[0, 1]),
        (b"a,b\n1e0,+2\n0.3e1,4E+0\n", comma.clone(), &[0, 1]),
        (b"a,s,b\n1,on,2\n3,off,4\n", comma.clone(), &[0, 2]),
        (b"a,b\n1.00000000000000000000000,2\n3,4.0000000000000000000000001\n", comma, &[0, 1]),
    ];
    for (text, layout, wanted) in cases {
        let shown = String::from_utf8_lossy(text);
        let rows = read(text, layout, &indices(wanted)).unwrap_or_else(|e| panic!("{shown}: {e}"));
        assert_eq!(rows.columns, [[1.0, 3.0], [2.0, 4.0]], "{shown}");
        assert!(rows.faults.is_empty(), "{shown}");
    }
}

#[test]
fn rows_at_fault_are_named_by_line_and_the_others_stay() {
    let text = b"0,1,2\n1,x,2\n2,nan,2\n3,1\n4,1,2,3\n5,,2\n6,1e999,2\n7,1,2\n8,1";
    let rows = read(text, &headless(), &indices(&[0, 1, 2])).expect("a table");
    assert_eq!(rows.lines, [1, 2, 3, 4, 5, 6, 7, 8, 9]);
    let faults: Vec<(u64, Reason)> = rows.faults.iter().map(|f| (rows.lines[f.0], f.1)).collect();
    assert_eq!(
        faults,
        [
            (2, Reason::NotANumber),
            (3, Reason::NotFinite),
            (4, Reason::TooFewFields),
            (5, Reason::WrongFieldCount),
            (6, Reason::NotANumber),
            (7, Reason::NotFinite),
            (9, Reason::CutOff),
        ]
    );
    assert_eq!(rows.faults[0].2, Some(1));
    assert_eq!(rows.columns[2][7], 2.0);
}

#[test]
fn what_is_not_needed_may_be_garbage() {
    let rows = read(b"t,junk,q\n0,\xff\xfe,1\n1,nan,2\n2,,3\n", &Layout::default(), &names(&["q"]))
        .expect("a table");
    assert_eq!(rows.columns, [[1.0, 2.0, 3.0]]);
    assert!(rows.faults.is_empty());
}

#[test]
fn a_table_that_does_not_have_what_is_asked_for_is_told() {
    let error = |text: &[u8], layout: &Layout, wanted: &[Column]| {
        read(text, layout, wanted).expect_err("wrong").to_string()
    };
    let header = Layout::default();
    assert!(error(b"", &header, &names(&["a"])).contains("no rows"));
    assert!(error(b"\n\n# nothing\n", &header, &names(&["a"])).contains("no rows"));
    let message = error(b"t,q1,q2\n", &header, &names(&["q3"]));
    assert!(
        message.contains("x.csv:1") && message.contains("`q3`") && message.contains("t, q1, q2"),
        "{message}"
    );
    assert!(error(b"1,2\n", &headless(), &names(&["q3"])).contains("no header"));
    assert!(error(b"1;2;3\n", &headless(), &indices(&[2])).contains("delimiter"));
    assert!(error(b"a,a\n1,2\n", &header, &names(&["a"])).contains("two columns"));
    assert!(error(b"a,b\r1,2\r3,4\r", &header, &[Column::Index(0)]).contains("CR alone"));
    assert!(error(b"a\0,\0b\0\n\0", &header, &[Column::Index(0)]).contains("UTF-16"));
    assert!(error(b"a,b\n1,2\n", &header, &[Column::Index(0), Column::Name("a".into())]).contains("twice"));
    let missing = TableReader::open(std::path::Path::new("no/such.csv"), "such.csv", &header, &names(&["a"]));
    assert!(missing.err().is_some_and(|e| e.to_string().contains("no such file")));
}

#[test]
fn a_line_without_end_does_not_fill_the_memory() {
    /// A header, and then digits for ever (here: 40 MB).
    struct Endless(usize);
    impl Read for Endless {
        fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
            if self.0 == 0 {
                return Ok(0);
            }
            let n = buffer.len().min(self.0);
            buffer[..n].fill(b'7');
            if self.0 == 40 << 20 {
                buffer[..4].copy_from_slice(b"a,b\n");
            }
            self.0 -= n;
            Ok(n)
        }
    }
    let mut reader =
        TableReader::new(Endless(40 << 20), "x.csv", &Layout::default(), &names(&["a"])).expect("a header");
    let mut rows = Rows::new(1);
    while reader.read(&mut rows, 100).expect("readable") > 0 {}
    assert!(!rows.is_empty() && rows.len() < 100);
    assert_eq!(rows.faults.len(), rows.len());
    assert!(reader.buffer.len() < 4 << 20);
}

/// Hands out a few bytes at a time, so that lines are cut at every place.
struct Trickle<'a>(&'a [u8], usize);

impl Read for Trickle<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        let n = self.1.min(self.0.len()).min(buffer.len());
        buffer[..n].copy_from_slice(&self.0[..n]);
        self.0 = &self.0[n..];
        Ok(n)
    }
}

proptest! {
    #[test]
    fn no_bytes_panic(
        bytes in proptest::collection::vec(any::<u8>(), 0..400),
        delimiter in prop::sample::select(b",; \t|".to_vec()),
        header in any::<bool>(),
        skip in 0u64..3,
    ) {
        let layout = Layout { header, delimiter, decimal: b'.', skip };
        if let Ok(rows) = read(&bytes, &layout, &indices(&[0])) {
            prop_assert_eq!(rows.columns[0].len(), rows.lines.len());
        }
    }

    #[test]
    fn no_damaged_table_panics_and_its_rows_keep_step(
        text in "([0-9.,;\"\\-\\+eEnaif# \\r\\n]{0,8}\\n?){0,30}",
        chunk in 1usize..9,
    ) {
        let wanted = indices(&[0, 1]);
        let whole = read(text.as_bytes(), &headless(), &wanted);
        let Ok(mut reader) = TableReader::new(Trickle(text.as_bytes(), chunk), "x.csv", &headless(), &wanted) else {
            prop_assert!(whole.is_err());
            return Ok(());
        };
        let whole = whole.expect("both or neither");
        let mut rows = Rows::new(2);
        while reader.read(&mut rows, 7).expect("readable") > 0 {}
        prop_assert_eq!(&rows.lines, &whole.lines);
        prop_assert_eq!(&rows.faults, &whole.faults);
        for (a, b) in rows.columns.iter().zip(&whole.columns) {
            prop_assert_eq!(a.len(), rows.lines.len());
            prop_assert!(a.iter().zip(b).all(|(x, y)| x.to_bits() == y.to_bits()));
        }
    }

    #[test]
    fn numbers_come_back_as_they_were_written(values in proptest::collection::vec(-1e12f64..1e12, 1..40)) {
        let mut text = String::from("a\n");
        for v in &values {
            text.push_str(&format!("{v:?}\n"));
        }
        let rows = read(text.as_bytes(), &Layout::default(), &names(&["a"])).expect("a table");
        prop_assert_eq!(&rows.columns[0], &values);
    }
}
