//! What a robot's page tells beside its parameters.

/// What is known of a robot from its recordings.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RobotFacts {
    /// Its recordings, the earliest first.
    pub recordings: Vec<RecordingFact>,
    /// What was found in them, the earliest first.
    pub findings: Vec<FindingFact>,
}

/// What became of a recording.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RecordingFact {
    /// Days since 1970-01-01.
    pub day: i64,
    /// Its path or address.
    pub recording: String,
    /// `used`, or why it is not in one word.
    pub outcome: String,
    /// What to know about it, or why it is not used.
    pub message: String,
    /// Error of the torques that its own parameters leave, of all torques; 1 is everything.
    pub relative_error: Option<f64>,
    /// Error with the parameters of the robot's reference over that with its own.
    pub rise: Option<f64>,
}

impl RecordingFact {
    pub(super) fn is_used(&self) -> bool {
        self.outcome == "used"
    }
}

/// What a diagnosis found in a recording.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FindingFact {
    /// Days since 1970-01-01.
    pub day: i64,
    /// Path or address of the recording.
    pub recording: String,
    /// What the effect is called; empty where nothing was named.
    pub effect: String,
    /// In plain words.
    pub sentence: String,
    /// One minus the probability that it is chance.
    pub confidence: Option<f64>,
}
