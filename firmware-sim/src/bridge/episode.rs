//! One episode of a task: what to play, and what was recorded.

use super::message::Shape;

/// How the scripted policy is made worse, so that a dataset has something to learn from.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Behaviour {
    /// Standard deviation of the Gaussian noise added to every dimension of the action.
    pub noise_std: f64,
    /// Probability of a uniformly random action in the place of the policy's.
    pub epsilon: f64,
    /// Added to every action.
    pub push: [f64; 4],
    /// Standard deviation of what is added to every action's three directions of the hand and changes slowly.
    pub drift_std: f64,
    /// Correlation of that from one step to the next.
    pub drift_correlation: f64,
    /// Which of the task's purposes the scripted policy pursues, from 0; most tasks have one.
    pub purpose: u8,
}

impl Behaviour {
    /// The scripted policy as it is.
    pub const EXPERT: Self = Self {
        noise_std: 0.0,
        epsilon: 0.0,
        push: [0.0; 4],
        drift_std: 0.0,
        drift_correlation: 0.0,
        purpose: 0,
    };
    /// The better episodes of the paper's datasets.
    pub const PAPER_NOISY: Self = Self {
        noise_std: 0.8,
        ..Self::EXPERT
    };
    /// The other episodes of the paper's datasets: random actions in the place of four in five of the *noisy* policy's.
    /// Without the noise the returns come out far higher than the paper's.
    pub const PAPER_EPSILON: Self = Self {
        noise_std: 0.8,
        epsilon: 0.8,
        ..Self::EXPERT
    };
}

/// An episode to play. The same job gives the same bits, on any worker and after any other job.
#[derive(Clone, Debug, PartialEq)]
pub struct EpisodeJob {
    /// The task, one of [`crate::worlds::metaworld::tasks::ALL`].
    pub task: String,
    /// How the scripted policy behaves.
    pub behaviour: Behaviour,
    /// Decides the goal and every random draw.
    pub seed: u64,
    /// Steps to play; a shorter episode is the beginning of a longer one.
    pub steps: u32,
}

/// A recorded episode of `T` steps. All arrays are row-major; "rows" are `T + 1`: before the first action, and after each.
#[derive(Clone, Debug, PartialEq)]
pub struct Episode {
    /// Sizes of the rows.
    pub shape: Shape,
    /// Rows of observations, as float32: what a policy sees.
    pub observations: Vec<f32>,
    /// `T` actions, exactly as executed: clipped to [-1, 1], float32.
    pub actions: Vec<f32>,
    /// `T` rewards of the task itself.
    pub rewards: Vec<f64>,
    /// Whether the task counted as solved after each step.
    pub success: Vec<bool>,
    /// Whether each step ended in a terminal state.
    pub terminations: Vec<bool>,
    /// Whether each step was the last one for lack of time.
    pub truncations: Vec<bool>,
    /// Rows of the simulator's joint positions.
    pub qpos: Vec<f64>,
    /// Rows of the simulator's joint velocities.
    pub qvel: Vec<f64>,
    /// Rows of mocap positions.
    pub mocap_pos: Vec<f64>,
    /// Rows of mocap quaternions.
    pub mocap_quat: Vec<f64>,
    /// The vector that Meta-World drew for the episode: where things stand and where they should go.
    pub goal: Vec<f64>,
}

impl Episode {
    /// Steps that were made.
    #[must_use]
    pub fn steps(&self) -> usize {
        self.rewards.len()
    }

    /// The sum of the task's own rewards, in step order.
    #[must_use]
    pub fn return_true(&self) -> f64 {
        self.rewards.iter().sum()
    }

    /// Whether the task counted as solved after any step.
    #[must_use]
    pub fn solved(&self) -> bool {
        self.success.contains(&true)
    }
}
