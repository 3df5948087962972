//! Frames that move with other variables than their own joint's.

use crate::JointKind;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// Most joint variables that one frame moves with.
pub const MAX_TERMS: usize = 4;

/// A frame whose angle or length is a linear combination of joint variables: the bar of a parallelogram turned by
/// q3 - q2, a counter-carriage shifted by -q3.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DependentFrame {
    /// Index in [`Robot::frames`](crate::Robot::frames).
    pub frame: usize,
    /// Revolute where theta moves, prismatic where r does; never fixed.
    pub kind: JointKind,
    /// Joint index and coefficient, ascending joints, no coefficient 0, at most [`MAX_TERMS`]. Of an angle the coefficients
    /// are whole numbers; of a length they are numbers, m/rad or 1.
    pub terms: Cow<'static, [(usize, f64)]>,
}

/// How a frame moves on its parent.
#[derive(Debug, Clone, PartialEq)]
pub struct Motion {
    /// Revolute where theta moves, prismatic where r does, fixed where nothing does.
    pub kind: JointKind,
    /// Joint index and coefficient; the frame's own joint alone where the table says nothing else.
    pub terms: Vec<(usize, f64)>,
}

impl Motion {
    /// What stands in the table at the entry that moves: the variables by the numbers of their joints, and the constant.
    ///
    /// ```
    /// use dynid_description::{JointKind, Motion};
    ///
    /// let bar = Motion { kind: JointKind::Revolute, terms: vec![(1, -1.0), (2, 1.0)] };
    /// assert_eq!(bar.entry(|joint| joint + 1, "pi/2"), "-q2 + q3 + pi/2");
    /// ```
    pub fn entry(&self, number: impl Fn(usize) -> usize, constant: &str) -> String {
        let mut text = String::new();
        for (k, &(joint, c)) in self.terms.iter().enumerate() {
            let sign = match (k, c < 0.0) {
                (0, true) => "-",
                (0, false) => "",
                (_, true) => " - ",
                (_, false) => " + ",
            };
            let factor = if c.abs() == 1.0 { String::new() } else { format!("{}*", c.abs()) };
            text.push_str(&format!("{sign}{factor}q{}", number(joint)));
        }
        match (constant, constant.strip_prefix('-')) {
            ("0" | "-0", _) => {}
            (_, Some(rest)) => {
                let inner = rest.strip_prefix('(').and_then(|r| r.strip_suffix(')')).unwrap_or(rest);
                let inside = if inner.contains(['+', '-', '(']) { rest } else { inner };
                text.push_str(&format!(" - {inside}"));
            }
            (_, None) => text.push_str(&format!(" + {constant}")),
        }
        text
    }
}

/// The motion of each frame, from what each frame's own joint is and the frames that move otherwise.
pub fn motions(frames: impl Iterator<Item = JointKind>, dependent: &[DependentFrame]) -> Vec<Motion> {
    let mut joint = 0;
    frames
        .enumerate()
        .map(|(k, kind)| {
            let own = (kind != JointKind::Fixed).then_some((joint, 1.0));
            joint += usize::from(own.is_some());
            match dependent.iter().find(|d| d.frame == k) {
                Some(d) => Motion { kind: d.kind, terms: d.terms.to_vec() },
                None => Motion { kind, terms: own.into_iter().collect() },
            }
        })
        .collect()
}
