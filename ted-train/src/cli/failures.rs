//! Which exit code each library error ends with.

use firmware_sim::bridge::environment::SetupError;
use firmware_sim::exit::ExitCode;
use firmware_sim::failure::Failure;

use crate::answers::import::ImportError as AnswersImportError;
use crate::ask::AskError;
use crate::bench::BenchError;
use crate::collect::CollectError;
use crate::config::ConfigError;
use crate::crosscheck::CrosscheckError;
use crate::dataset::DatasetError;
use crate::evaluate::EvaluateError;
use crate::export::ExportError;
use crate::fleet::{FleetError, LaneError};
use crate::import::ImportError;
use crate::inspect::InspectError;
use crate::need::TooMuch;
use crate::preferences::PreferenceError;
use crate::quickstart::QuickstartError;
use crate::replay::ReplayDatasetError;
use crate::report::ReportError;
use crate::reward::LearnError;
use crate::reward::transport::TransportError;
use crate::robot::DeclareError;
use crate::run::RunError;
use crate::study::answers::MergeError;
use crate::study::cells::CellsError;
use crate::study::fill::StudyError;
use crate::study::slurm::SlurmError;
use crate::train::TrainError;
use firmware_sim::disk::WriteError;
use firmware_sim::robot::RobotError;

/// An error that knows how a command ends because of it.
pub(super) trait Ends: std::fmt::Display {
    fn exit_code(&self) -> ExitCode;
}

/// Turns any such error into the end of a command.
pub(super) fn end(error: impl Ends) -> Failure {
    Failure::new(error.exit_code(), &error)
}

impl Ends for CollectError {
    fn exit_code(&self) -> ExitCode {
        Self::exit_code(self)
    }
}

impl Ends for SetupError {
    fn exit_code(&self) -> ExitCode {
        Self::exit_code(self)
    }
}

impl Ends for ConfigError {
    fn exit_code(&self) -> ExitCode {
        ExitCode::BadInput
    }
}

impl Ends for TooMuch {
    fn exit_code(&self) -> ExitCode {
        ExitCode::Usage
    }
}

impl Ends for DatasetError {
    fn exit_code(&self) -> ExitCode {
        ExitCode::BadInput
    }
}

impl Ends for ImportError {
    fn exit_code(&self) -> ExitCode {
        Self::exit_code(self)
    }
}

impl Ends for RobotError {
    fn exit_code(&self) -> ExitCode {
        ExitCode::BadInput
    }
}

impl Ends for DeclareError {
    fn exit_code(&self) -> ExitCode {
        match self {
            Self::Dataset(_) | Self::Guesses { .. } => ExitCode::BadInput,
            Self::Write(error) => error.exit_code(),
        }
    }
}

impl Ends for WriteError {
    fn exit_code(&self) -> ExitCode {
        Self::exit_code(self)
    }
}

impl Ends for PreferenceError {
    fn exit_code(&self) -> ExitCode {
        Self::exit_code(self)
    }
}

impl Ends for AnswersImportError {
    fn exit_code(&self) -> ExitCode {
        Self::exit_code(self)
    }
}

impl Ends for RunError {
    fn exit_code(&self) -> ExitCode {
        match self {
            Self::Write(error) => error.exit_code(),
            Self::OtherRun { .. } => ExitCode::Usage,
            _ => ExitCode::BadInput,
        }
    }
}

impl Ends for ExportError {
    fn exit_code(&self) -> ExitCode {
        ExitCode::BadInput
    }
}

impl Ends for TrainError {
    fn exit_code(&self) -> ExitCode {
        match self {
            Self::Learn(LearnError::Interrupted)
            | Self::Transport(TransportError::Interrupted)
            | Self::Interrupted { .. } => ExitCode::Interrupted,
            Self::TooMuch(_) => ExitCode::Usage,
            Self::Run(error) => error.exit_code(),
            Self::Write(error) => error.exit_code(),
            Self::Learn(LearnError::Preference(error)) => error.exit_code(),
            Self::Learn(LearnError::Save(error)) => error.exit_code(),
            Self::Learn(
                LearnError::Segment(_) | LearnError::TooFewEpisodes | LearnError::Foreign(_),
            )
            | Self::SameRewards { .. }
            | Self::Transport(_)
            | Self::Filter(_)
            | Self::Discount(_)
            | Self::NotFinished { .. }
            | Self::NotForControllers { .. } => ExitCode::BadInput,
            Self::Export(error) => error.exit_code(),
            Self::Backend(_)
            | Self::Learn(LearnError::Diverged { .. })
            | Self::RewardsOverflow
            | Self::Diverged { .. } => ExitCode::Failure,
        }
    }
}

impl Ends for EvaluateError {
    fn exit_code(&self) -> ExitCode {
        match self {
            Self::Load(_) | Self::Artifact(_) | Self::Contract(_) | Self::Undeclared => {
                ExitCode::BadInput
            }
            Self::Task(_) | Self::NoWorld { .. } => ExitCode::Usage,
            Self::Setup(error) => error.exit_code(),
            Self::Fly(error) => error.exit_code(),
            Self::Write(error) => error.exit_code(),
        }
    }
}

impl Ends for ReplayDatasetError {
    fn exit_code(&self) -> ExitCode {
        match self {
            Self::Replay(_) => ExitCode::BadInput,
            Self::Fly(error) => error.exit_code(),
            Self::Score(error) => error.exit_code(),
        }
    }
}

impl Ends for LaneError {
    fn exit_code(&self) -> ExitCode {
        match self {
            Self::Dataset(error) => error.exit_code(),
            Self::Collect(error) => error.exit_code(),
            Self::Preference(error) => error.exit_code(),
            Self::Run(error) => error.exit_code(),
            Self::Train(error) => error.exit_code(),
            Self::Evaluate(error) => error.exit_code(),
            Self::Threads(_) | Self::Panicked => ExitCode::Failure,
            Self::NotBegun => ExitCode::Interrupted,
        }
    }
}

impl Ends for FleetError {
    fn exit_code(&self) -> ExitCode {
        self.first.exit_code()
    }
}

impl Ends for CellsError {
    fn exit_code(&self) -> ExitCode {
        match self {
            Self::Disk(error) => error.exit_code(),
            Self::Io { .. } | Self::Line { .. } => ExitCode::BadInput,
        }
    }
}

impl Ends for StudyError {
    fn exit_code(&self) -> ExitCode {
        match self {
            Self::Config(error) => error.exit_code(),
            Self::Collect(error) => error.exit_code(),
            Self::Run(error) => error.exit_code(),
            Self::OtherDataset { .. } => ExitCode::BadInput,
            Self::Scores(error) => error.exit_code(),
            Self::Fleet(error) => error.exit_code(),
        }
    }
}

impl Ends for MergeError {
    fn exit_code(&self) -> ExitCode {
        match self {
            Self::Study(error) => error.exit_code(),
            Self::Contradiction { .. } => ExitCode::BadInput,
        }
    }
}

impl Ends for SlurmError {
    fn exit_code(&self) -> ExitCode {
        match self {
            Self::Write(error) => error.exit_code(),
            Self::NoCommand(_) | Self::Refused(_) => ExitCode::Failure,
        }
    }
}

impl Ends for CrosscheckError {
    fn exit_code(&self) -> ExitCode {
        match self {
            Self::Run(error) => error.exit_code(),
            Self::Train(error) => error.exit_code(),
            Self::Evaluate(error) => error.exit_code(),
            Self::Load(_) | Self::Artifact(_) | Self::Export(_) | Self::Shape(_) => {
                ExitCode::BadInput
            }
            Self::Interrupted => ExitCode::Interrupted,
        }
    }
}

impl Ends for ReportError {
    fn exit_code(&self) -> ExitCode {
        match self {
            Self::Run(error) => error.exit_code(),
            Self::Train(error) => error.exit_code(),
            Self::Preferences(error) => error.exit_code(),
            Self::Write(error) => error.exit_code(),
            Self::Discount(_) | Self::Figure(_) => ExitCode::Failure,
        }
    }
}

impl Ends for InspectError {
    fn exit_code(&self) -> ExitCode {
        match self {
            Self::Run(error) => error.exit_code(),
            Self::Nothing { .. } | Self::Load(_) | Self::Artifact { .. } | Self::Dataset(_) => {
                ExitCode::BadInput
            }
        }
    }
}

impl Ends for QuickstartError {
    fn exit_code(&self) -> ExitCode {
        match self {
            Self::Setup(error) => error.exit_code(),
            Self::Collect(error) => error.exit_code(),
            Self::Dataset(error) => error.exit_code(),
            Self::Config(error) => error.exit_code(),
            Self::Run(error) => error.exit_code(),
            Self::Write(error) => error.exit_code(),
            Self::Train(error) => error.exit_code(),
            Self::Evaluate(error) => error.exit_code(),
            Self::Crosscheck(error) => error.exit_code(),
        }
    }
}

impl Ends for AskError {
    fn exit_code(&self) -> ExitCode {
        Self::exit_code(self)
    }
}

impl Ends for BenchError {
    fn exit_code(&self) -> ExitCode {
        match self {
            Self::Dataset(_) | Self::Shape(_) | Self::Integer(_) => ExitCode::BadInput,
            Self::Setup(error) => error.exit_code(),
            Self::Bridge(error) => error.exit_code(),
            Self::Threads(_) => ExitCode::Failure,
            Self::Interrupted => ExitCode::Interrupted,
        }
    }
}
