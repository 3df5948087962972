//! The recordings that are told of, and how each is divided.

/// A recording and how it is divided.
pub struct Story {
    /// Folder, and robot.
    pub robot: &'static str,
    /// What a person calls it.
    pub title: &'static str,
    /// What is diagnosed.
    pub recording: &'static str,
    /// A recording that takes no part; `None`: the recording is divided in time.
    pub test: Option<&'static str>,
    /// Where it is divided, s; `None`: after 60 %.
    pub cut: Option<f64>,
    /// Other parts of the recording that are diagnosed as well, each for itself, s.
    pub parts: &'static [(f64, f64)],
    /// What was recorded.
    pub recorded: &'static str,
    /// How it is divided.
    pub divided: &'static str,
    /// The commands that print the figures.
    pub commands: &'static [&'static str],
    /// What is aimed at.
    pub goal: Option<Goal>,
}

/// What is aimed at on the part that takes no part.
#[derive(Debug, Clone, Copy)]
pub enum Goal {
    /// Error with the findings over that of the standard model.
    Ratio(f64),
    /// Error with the findings.
    Error(f64),
}

/// The recordings.
pub const STORIES: [Story; 3] = [
    Story {
        robot: "tx40",
        title: "Staubli TX-40",
        recording: "recording.yaml",
        test: None,
        cut: Some(4.5),
        parts: &[(0.0, 5.0), (2.5, 7.4), (0.0, 7.4)],
        recorded: "A single exciting motion of 7.4 s at 5 kHz, motor angles and motor torques (public repository \
                   figaroh-examples).",
        divided: "Diagnosed on 0.05 to 4.5 s, judged on 4.5 to 7.4 s.",
        commands: &[
            "dynid identify tx40/recording.yaml --to 4.5 --out standard.json",
            "dynid diagnose tx40/recording.yaml --to 4.5 --out found.json",
            "dynid validate standard.json tx40/recording.yaml --from 4.5",
            "dynid validate found.json tx40/recording.yaml --from 4.5",
        ],
        goal: Some(Goal::Ratio(0.68)),
    },
    Story {
        robot: "ur10e",
        title: "Universal Robots UR10e",
        recording: "train.yaml",
        test: Some("test.yaml"),
        cut: None,
        parts: &[],
        recorded: "Exciting motions at about 95 Hz with jittery stamps; the torque is the motor current times the \
                   published drive gains (public repository dynamic_calibration).",
        divided: "Diagnosed on three motions of 21 to 42 s, judged on two other motions, one of them recorded a week later.",
        commands: &[
            "dynid identify ur10e/train.yaml --out standard.json",
            "dynid diagnose ur10e/train.yaml --test ur10e/test.yaml --out found.json",
            "dynid validate standard.json ur10e/test.yaml",
            "dynid validate found.json ur10e/test.yaml",
        ],
        goal: Some(Goal::Error(0.026)),
    },
    Story {
        robot: "panda",
        title: "Franka Emika Panda",
        recording: "recording.yaml",
        test: None,
        cut: Some(12.54),
        parts: &[],
        recorded: "A single exciting motion of 20 s at 1 kHz. Its torque sensors sit behind the gears, so that there is \
                   next to no drive physics to be missed: a check for false alarms.",
        divided: "Diagnosed on the first 60 % of the motion (up to 12.54 s), judged on the rest.",
        commands: &[
            "dynid identify panda/recording.yaml --to 12.54 --out standard.json",
            "dynid diagnose panda/recording.yaml --to 12.54 --out found.json",
            "dynid validate standard.json panda/recording.yaml --from 12.54",
            "dynid validate found.json panda/recording.yaml --from 12.54",
        ],
        goal: None,
    },
];
