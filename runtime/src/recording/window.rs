//! One window of a recording: its files, row by row, and the motions they hold.

use std::ops::Range;

use super::channel::{Conversions, convert};
use super::files::{Clock, Files, Slot, Source};
use super::manifest::{Manifest, Window};
use super::reach::Reach;
use super::screen::{Fault, Piece, screen};
use super::{Cut, LeftOutRow, MOST_LEFT_OUT, Reason, RecordingError, RowReport, Trajectory};
use crate::model::{JointNumber, Robot};

/// Rows taken from every file at a time.
pub(super) const BLOCK: usize = 4096;

/// The files of one window.
pub(super) struct Open {
    name: String,
    sources: Vec<Source>,
    clock: Clock,
    position: Vec<Slot>,
    velocity: Vec<Slot>,
    torque: Vec<Slot>,
    fixed: Vec<usize>,
    from: f64,
    to: f64,
    rows_read: u64,
    last_time: f64,
    inside: bool,
    /// Rows of this window, and motions made of them so far.
    report: RowReport,
    motions: usize,
}

impl Open {
    pub(super) fn new(manifest: &Manifest, robot: &Robot, window: &Window) -> Result<Self, RecordingError> {
        let mut files = Files::new(manifest, window);
        let position = files.channel(&manifest.position, "position", "position")?;
        let velocity = match &manifest.velocity {
            Some(channel) => files.channel(channel, "velocity", "velocity")?,
            None => Vec::new(),
        };
        let torque = files.channel(&manifest.torque, "torque", "effort")?;
        let clock = files.clock()?;
        let sources = files.open()?;
        let mut report = RowReport::default();
        let clock = clock.of_types(manifest, &sources, &mut report.notes)?;
        Ok(Self {
            name: name_of(manifest, window),
            sources,
            clock,
            position,
            velocity,
            torque,
            fixed: fixed_joints(manifest, robot, window)?,
            from: window.from.unwrap_or(f64::NEG_INFINITY),
            to: window.to.unwrap_or(f64::INFINITY),
            rows_read: 0,
            last_time: f64::NEG_INFINITY,
            inside: window.from.is_none(),
            report,
            motions: 0,
        })
    }

    /// Reads up to `most` rows of the window. True at the end of the files.
    pub(super) fn read_piece(
        &mut self,
        conversions: &Conversions,
        joints: usize,
        most: usize,
    ) -> Result<(Piece, bool), RecordingError> {
        let velocities = if self.velocity.is_empty() { 0 } else { joints };
        let mut piece = Piece {
            position: vec![Vec::new(); joints],
            velocity: vec![Vec::new(); velocities],
            torque: vec![Vec::new(); joints],
            ..Piece::default()
        };
        while piece.time.len() + BLOCK <= most {
            for (source, rows) in &mut self.sources {
                rows.clear();
                source.read(rows, BLOCK)?;
            }
            let count = self.sources[0].1.len();
            if self.sources.iter().any(|(_, rows)| rows.len() != count) {
                return Err(self.unequal());
            }
            if count == 0 {
                return Ok((piece, true));
            }
            self.take_block(conversions, &mut piece, count);
            self.rows_read += count as u64;
        }
        Ok((piece, false))
    }

    /// The files end at different rows; the longer ones are read to their end to say by how much.
    fn unequal(&mut self) -> RecordingError {
        let mut totals = Vec::new();
        for (source, rows) in &mut self.sources {
            let mut total = self.rows_read + rows.len() as u64;
            loop {
                rows.clear();
                match source.read(rows, BLOCK) {
                    Ok(0) => break,
                    Ok(more) => total += more as u64,
                    Err(e) => return e,
                }
            }
            totals.push((source.file().to_string(), total));
        }
        let (first, first_rows) = totals[0].clone();
        let other = totals.into_iter().find(|(_, rows)| *rows != first_rows);
        let (second, second_rows) = other.unwrap_or((first.clone(), first_rows));
        RecordingError::UnequalRows { first, first_rows, second, second_rows }
    }

    fn take_block(&mut self, conversions: &Conversions, piece: &mut Piece, count: usize) {
        self.clock.settle(&self.sources, &mut self.report.notes);
        let time = self.clock.times(&self.sources, self.rows_read, count);
        let runs = self.runs_inside(&time);
        let lines = &self.sources[self.position[0].0].1.lines;
        for run in runs {
            let base = piece.time.len();
            piece.time.extend_from_slice(&time[run.clone()]);
            piece.lines.extend_from_slice(&lines[run.clone()]);
            let channels = [
                (
                    &self.position,
                    Some(&conversions.position),
                    conversions.motor.as_ref().map(|m| &m.0),
                    &mut piece.position,
                ),
                (
                    &self.velocity,
                    conversions.velocity.as_ref(),
                    conversions.motor.as_ref().map(|m| &m.0),
                    &mut piece.velocity,
                ),
                (
                    &self.torque,
                    Some(&conversions.torque),
                    conversions.motor.as_ref().map(|m| &m.1),
                    &mut piece.torque,
                ),
            ];
            for (places, conversion, matrix, out) in channels {
                if let Some(conversion) = conversion {
                    convert(&self.sources, places, conversion, matrix, run.clone(), out);
                }
            }
            self.note_faults(run, base, piece);
        }
    }

    /// Rows of the window, in runs; a row without a readable time belongs where the one before it does.
    fn runs_inside(&mut self, time: &[f64]) -> Vec<Range<usize>> {
        let mut runs: Vec<Range<usize>> = Vec::new();
        for (row, t) in time.iter().enumerate() {
            if t.is_finite() {
                self.inside = *t >= self.from && *t <= self.to;
            }
            match runs.last_mut() {
                _ if !self.inside => {}
                Some(run) if run.end == row => run.end = row + 1,
                _ => runs.push(row..row + 1),
            }
        }
        runs
    }

    /// Notes the faults of a run of rows, the first of which is row `base` of the piece.
    fn note_faults(&self, run: Range<usize>, base: usize, piece: &mut Piece) {
        for (source, rows) in &self.sources {
            for &(row, reason, column) in rows.faults.iter().filter(|fault| run.contains(&fault.0)) {
                let what = match column {
                    Some(column) => format!("{reason} in column {column}"),
                    None => reason.to_string(),
                };
                let elsewhere = Some((source.file().to_string(), rows.lines[row]));
                piece.faults.push(Fault { row: base + row - run.start, reason, what, elsewhere });
            }
        }
    }

    /// Leaves out what cannot be right and makes a trajectory of every unbroken rest.
    pub(super) fn motions_of(
        &mut self,
        mut piece: Piece,
        reach: &Reach,
        speed_limits: bool,
    ) -> Vec<Trajectory> {
        let rows = piece.time.len();
        if rows == 0 {
            return Vec::new();
        }
        for row in 0..rows {
            if piece.time[row] <= self.last_time && !piece.faults.iter().any(|f| f.row == row) {
                let what = format!("time {} s does not go forward", piece.time[row]);
                let reason = Reason::TimeOrder;
                piece.faults.push(Fault { row, reason, what, elsewhere: None });
            }
        }
        let verdict = screen(&piece, reach, speed_limits);
        self.report.rows += rows as u64;
        let file = self.sources[self.position[0].0].0.file().to_string();
        for fault in verdict.faults {
            let (file, line) = fault.elsewhere.unwrap_or_else(|| (file.clone(), piece.lines[fault.row]));
            self.report.leave_out(LeftOutRow { file, line, reason: fault.reason, what: fault.what });
        }
        if let Some(&last) = verdict.kept.last() {
            self.last_time = piece.time[last];
        }
        for (k, what) in verdict.cuts.into_iter().enumerate() {
            let at = verdict.motions[k].end;
            let (after, until) = (piece.time[verdict.kept[at - 1]], piece.time[verdict.kept[at]]);
            self.report.cut(Cut { trajectory: self.name.clone(), after, until, what });
        }
        let all = verdict.kept.len() == rows && verdict.motions.len() == 1;
        let mut out = Vec::new();
        for motion in verdict.motions.into_iter().filter(|m| !m.is_empty()) {
            self.motions += 1;
            let part = if self.motions > 1 { format!(" part {}", self.motions) } else { String::new() };
            let kept = &verdict.kept[motion];
            let mut take = |values: &mut Vec<f64>| match all {
                true => std::mem::take(values),
                false => kept.iter().map(|&row| values[row]).collect(),
            };
            let time = take(&mut piece.time);
            let mut channel =
                |values: &mut Vec<Vec<f64>>| values.iter_mut().map(&mut take).collect::<Vec<_>>();
            let position = channel(&mut piece.position);
            let torque = channel(&mut piece.torque);
            let velocity = (!piece.velocity.is_empty()).then(|| channel(&mut piece.velocity));
            let (name, fixed) = (format!("{}{part}", self.name), self.fixed.clone());
            out.push(Trajectory { name, time, position, velocity, torque, fixed });
        }
        out
    }

    pub(super) fn finish(self, report: &mut RowReport) -> Result<(), RecordingError> {
        let Self { name, report: mut own, .. } = self;
        own.notes.extend(self.sources.iter().flat_map(|(source, _)| source.notes()));
        if own.rows == 0 {
            let why = match (self.from.is_finite(), self.to.is_finite()) {
                (false, false) => "in the file".to_string(),
                _ => {
                    format!("between {} s and {} s; the file has {} rows", self.from, self.to, self.rows_read)
                }
            };
            return Err(RecordingError::Empty { name, why });
        }
        if own.left_out as f64 > MOST_LEFT_OUT / 100.0 * own.rows as f64 {
            let (reason, _) = own.by_reason[0];
            let example = own.examples.iter().find(|e| e.reason == reason);
            let advice = match reason {
                Reason::OutOfReach | Reason::Jump => "Are the columns, the units and the robot right?",
                Reason::TimeOrder => "Is the time column right, and is it one recording?",
                _ => "Are the delimiter, the header and the columns right?",
            };
            let remedy = match reason {
                Reason::NotANumber | Reason::WrongFieldCount | Reason::TooFewFields => {
                    self.sources.iter().find_map(|(source, _)| source.remedy())
                }
                _ => None,
            };
            let advice =
                remedy.map_or_else(|| advice.to_owned(), |remedy| format!("{advice} In the file, {remedy}"));
            return Err(RecordingError::TooManyLeftOut {
                name,
                left_out: own.left_out,
                rows: own.rows,
                limit: MOST_LEFT_OUT,
                reason: reason.to_string(),
                example: example.map(ToString::to_string).unwrap_or_default(),
                advice,
            });
        }
        report.merge(own);
        Ok(())
    }
}

/// What the motions of a window are called.
fn name_of(manifest: &Manifest, window: &Window) -> String {
    let mut name = Files::main(manifest, window).cloned().unwrap_or_default();
    match (window.from, window.to) {
        (Some(from), Some(to)) => name.push_str(&format!(" {from} s to {to} s")),
        (Some(from), None) => name.push_str(&format!(" from {from} s")),
        (None, Some(to)) => name.push_str(&format!(" to {to} s")),
        (None, None) => {}
    }
    name
}

/// The joints (0-based) that are fixed in a window, ascending.
fn fixed_joints(manifest: &Manifest, robot: &Robot, window: &Window) -> Result<Vec<usize>, RecordingError> {
    let mut fixed = Vec::new();
    for &number in &window.fixed {
        let Some(joint) = robot.joint_index(JointNumber(number)) else {
            let message = format!("`fixed` names joint {number}, which {} does not have", robot.name);
            return Err(manifest.error(&["trajectories", "fixed"], &message));
        };
        fixed.push(joint.0);
    }
    fixed.sort_unstable();
    fixed.dedup();
    Ok(fixed)
}
