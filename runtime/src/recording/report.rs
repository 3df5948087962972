//! Which rows were left out, and why.

use std::fmt;

use serde::Serialize;

/// Percent of the rows of a trajectory that may be left out. A logger that garbles one row in five cannot be
/// trusted with the other four.
pub const MOST_LEFT_OUT: f64 = 20.0;

/// Why a row cannot be right.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Reason {
    /// Fewer fields than the columns that are needed.
    TooFewFields,
    /// Another number of fields than the header or the first row.
    WrongFieldCount,
    /// The last line of the file, cut in the middle.
    CutOff,
    /// A field that is no number.
    NotANumber,
    /// NaN or infinite.
    NotFinite,
    /// A position, velocity or torque that no joint can have.
    OutOfReach,
    /// A time stamp that is not after those before it.
    TimeOrder,
    /// A position that no joint can have reached since the row before it.
    Jump,
    /// Too few rows between two gaps to filter.
    Isolated,
}

impl fmt::Display for Reason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::TooFewFields => "too few fields",
            Self::WrongFieldCount => "another number of fields than the first row",
            Self::CutOff => "last line cut",
            Self::NotANumber => "not a number",
            Self::NotFinite => "not finite",
            Self::OutOfReach => "out of every joint's reach",
            Self::TimeOrder => "time does not go forward",
            Self::Jump => "an impossible jump of position",
            Self::Isolated => "too few rows between two gaps",
        })
    }
}

/// One row that was left out.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LeftOutRow {
    /// The file as the manifest names it.
    pub file: String,
    /// Line in the file, from 1.
    pub line: u64,
    /// Why.
    pub reason: Reason,
    /// What it was, for a person.
    pub what: String,
}

impl fmt::Display for LeftOutRow {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}: {}", self.file, self.line, self.what)
    }
}

/// A place where a motion was cut into two, because nothing is known between them.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Cut {
    /// The trajectory.
    pub trajectory: String,
    /// Time of the last row before it, s.
    pub after: f64,
    /// Time of the first row after it, s.
    pub until: f64,
    /// What was found: a gap in time, or a jump of a joint.
    pub what: String,
}

/// The rows of a recording: how many there were, which were left out, and why.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct RowReport {
    /// Rows inside of the windows.
    pub rows: u64,
    /// Rows left out.
    pub left_out: u64,
    /// Rows left out by reason, most frequent first.
    pub by_reason: Vec<(Reason, u64)>,
    /// The first few of each reason.
    pub examples: Vec<LeftOutRow>,
    /// Where motions were cut.
    pub cuts: Vec<Cut>,
    /// What else of the files was not used: parts that are damaged, messages that lack a signal.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub notes: Vec<String>,
}

/// Rows of one reason that are kept as examples.
const EXAMPLES: u64 = 5;
/// Cuts that are kept.
const MOST_CUTS: usize = 1000;

impl RowReport {
    pub(super) fn leave_out(&mut self, row: LeftOutRow) {
        self.left_out += 1;
        let seen = match self.by_reason.iter_mut().find(|(r, _)| *r == row.reason) {
            Some((_, seen)) => {
                *seen += 1;
                *seen
            }
            None => {
                self.by_reason.push((row.reason, 1));
                1
            }
        };
        if seen <= EXAMPLES {
            self.examples.push(row);
        }
        self.by_reason.sort_by_key(|&(reason, count)| (std::cmp::Reverse(count), reason));
    }

    pub(super) fn cut(&mut self, cut: Cut) {
        if self.cuts.len() < MOST_CUTS {
            self.cuts.push(cut);
        }
    }

    pub(super) fn merge(&mut self, other: Self) {
        self.rows += other.rows;
        self.left_out += other.left_out;
        for (reason, count) in other.by_reason {
            match self.by_reason.iter_mut().find(|(r, _)| *r == reason) {
                Some((_, total)) => *total += count,
                None => self.by_reason.push((reason, count)),
            }
        }
        self.by_reason.sort_by_key(|&(reason, count)| (std::cmp::Reverse(count), reason));
        for row in other.examples {
            if self.examples.iter().filter(|e| e.reason == row.reason).count() < EXAMPLES as usize {
                self.examples.push(row);
            }
        }
        other.cuts.into_iter().for_each(|c| self.cut(c));
        for note in other.notes {
            // Windows of one file tell the same.
            if !self.notes.contains(&note) {
                self.notes.push(note);
            }
        }
    }
}
