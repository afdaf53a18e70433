//! Which of the worker's two engines simulates: the same episodes, to the bit.

use std::fmt;

use clap::ValueEnum;
use serde::{Deserialize, Serialize};

/// How a worker simulates.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Engine {
    /// Meta-World's own physics and rewards with less around them
    #[default]
    Fast,
    /// Meta-World's environments as the package makes them, to check the other one against
    Reference,
}

impl Engine {
    /// The name it has on the worker's command line and in reports.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Fast => "fast",
            Self::Reference => "reference",
        }
    }
}

impl fmt::Display for Engine {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
