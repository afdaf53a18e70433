//! Pictures of recorded states of the simulator: what to draw, and what came of it.

/// A state of the simulator, as far as it can be seen. Its lengths are those of the task's [`super::Shape`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct State {
    /// Joint positions.
    pub qpos: Vec<f64>,
    /// A position (3) for each mocap body.
    pub mocap_pos: Vec<f64>,
    /// A quaternion (4) for each mocap body.
    pub mocap_quat: Vec<f64>,
}

/// How pictures look.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Look {
    /// Pixels from left to right, at most 1920.
    pub width: u16,
    /// Pixels from top to bottom, at most 1920.
    pub height: u16,
    /// Quality of the JPEG, 1 to 100.
    pub quality: u8,
}

/// States of one episode to draw. No states ask only whether pictures can be made.
#[derive(Clone, Debug, PartialEq)]
pub struct PictureJob {
    /// The task, one of [`crate::worlds::metaworld::tasks::ALL`] or [`crate::worlds::metaworld::tasks::TWO_INTENTIONS`].
    pub task: String,
    /// The seed of the episode: it decides where the things stand that no state says.
    pub seed: u64,
    /// How the pictures look.
    pub look: Look,
    /// What is drawn.
    pub states: Vec<State>,
}

/// What came of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Pictures {
    /// The way by which the simulator draws without a screen: `egl` or `osmesa`, on macOS `cgl`.
    pub way: String,
    /// A JPEG for each state.
    pub jpegs: Vec<Vec<u8>>,
}
