//! Is this machine fit for the whole pipeline? Nothing is installed or changed by asking.

mod backends;
mod machine;

pub use machine::processor;

use std::path::Path;

use firmware_sim::bridge::environment;
use firmware_sim::qemu;
use serde::Serialize;

use crate::nn::Backend;

/// One thing that was looked at.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Check {
    /// What was looked at.
    pub name: String,
    /// Whether nothing is wrong with it.
    pub good: bool,
    /// What was found, or what is wrong and what to do about it.
    pub found: String,
}

/// Everything that was looked at.
#[derive(Clone, Debug, Serialize)]
pub struct Diagnosis {
    /// In the order in which a person would ask.
    pub checks: Vec<Check>,
}

impl Check {
    fn new(name: &str, outcome: Result<String, String>) -> Self {
        let good = outcome.is_ok();
        let (Ok(found) | Err(found)) = outcome;
        Self {
            name: name.to_owned(),
            good,
            found,
        }
    }
}

impl Diagnosis {
    /// How many things are wrong.
    #[must_use]
    pub fn problems(&self) -> usize {
        self.checks.iter().filter(|check| !check.good).count()
    }
}

/// Looks at the processor, memory, disk, the trainer's backends, the Python side, and what emulated boards need.
#[must_use]
pub fn diagnose(datasets_root: &Path) -> Diagnosis {
    let mut checks = vec![
        Check::new("processor", Ok(machine::processor())),
        Check::new("memory", machine::memory()),
        Check::new("datasets", machine::writable(datasets_root)),
        Check::new("free disk", machine::free_disk(datasets_root)),
        Check::new("fused engine", backends::check(Backend::Fused)),
        Check::new("burn flex", backends::check(Backend::Flex)),
        Check::new("burn ndarray", backends::check(Backend::Ndarray)),
    ];
    if cfg!(feature = "cuda") {
        checks.push(Check::new("burn cuda", backends::check(Backend::Cuda)));
    }
    let bridge = environment::diagnose().into_iter();
    checks.extend(bridge.map(|check| Check::new(check.name, check.outcome)));
    let boards = qemu::diagnose().into_iter();
    checks.extend(boards.map(|check| Check::new(check.name, check.outcome)));
    Diagnosis { checks }
}
