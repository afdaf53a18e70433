//! A run on disk: one folder that is enough to go on after a kill and to know what was done.
//!
//! ```text
//! config.toml          the resolved configuration
//! dataset.json         which dataset: id, digest, path
//! preferences.jsonl    every query asked and its answer
//! preferences.aside.jsonl  what a person said after an answer that they took back, in case the same is asked again
//! answers.json         what became of every line of a file of answers, where one was given
//! reward.state         the learned reward: an ensemble, or the labels of a transformer
//! reward.training      a transformer on its way there
//! answers.state        which answers a policy without a reward is learned from
//! reward.json          how well it orders the dataset
//! checkpoints/         the offline learner, the last two
//! metrics.jsonl        one row every `schedule.log_every` updates
//! events.out.tfevents… the same for TensorBoard
//! policy.ted           the artefact
//! evaluation.json      how it flew
//! time.json            how long it took; never compared between runs
//! ```

mod clock;
mod events;
mod folder;
mod metrics;
mod saver;
mod sealed;

pub use clock::{Clock, Phase, Spent};
pub use events::EventWriter;
pub use folder::{
    ANSWERS, DATASET, DatasetReference, EVALUATION, PREFERENCES, QUANTISATION, REPORT, RunError,
    RunFolder,
};
pub use metrics::MetricsLog;
pub use saver::Saver;
pub use sealed::SealedError;
