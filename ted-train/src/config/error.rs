//! What can be wrong with a configuration.

use std::path::PathBuf;

use ted_core::{MAX_LAYERS, MAX_WIDTH};

/// A configuration that cannot be used, and what to change.
#[derive(Debug, thiserror::Error)]
pub enum ConfigError {
    /// The file cannot be read.
    #[error("cannot read the configuration {path}: {source}")]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// TOML that does not parse, an unknown key, or a value of the wrong type; the message names the line.
    #[error("the configuration from {origin} is not valid: {message}")]
    Invalid {
        /// A file, or the command line.
        origin: String,
        /// What the parser said.
        message: String,
    },
    /// A `--set` argument without a key or a value.
    #[error(
        "cannot understand --set {argument:?}: write key=value, for example --set algorithm.steps=50000, or \
         preset:key=value for the runs of a preset"
    )]
    Override {
        /// The argument.
        argument: String,
    },
    /// A `--set` of what a run is called by.
    #[error(
        "cannot take the {field} from --set {argument:?}: `ted train` has --{field} for it, which also names the run's folder"
    )]
    Flag {
        /// The field.
        field: &'static str,
        /// The argument.
        argument: String,
    },
    /// A number outside its range.
    #[error("{field} is {value}, but must be {range}")]
    OutOfRange {
        /// Dotted path of the field.
        field: String,
        /// The number.
        value: f64,
        /// Where it must lie.
        range: String,
    },
    /// Two choices of which one does not give what the other needs.
    #[error("{choice} does not go with the rest of the configuration: {reason}")]
    Composition {
        /// The choice.
        choice: &'static str,
        /// Why, and the way out.
        reason: String,
    },
    /// A network that the controller could not run.
    #[error("{field} is {hidden:?}, but the controller runs at most {} hidden layers of 1 to {MAX_WIDTH} units", MAX_LAYERS - 1)]
    Widths {
        /// Dotted path of the field.
        field: String,
        /// The widths.
        hidden: Vec<usize>,
    },
}
