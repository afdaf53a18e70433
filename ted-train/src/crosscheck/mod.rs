//! Proof that what flies is what was trained: the same numbers, computed in every way there is, compared.

mod actions;
mod distance;
mod flight;
mod scored;
mod state;

pub use distance::{Distance, ulp};

use firmware_sim::controller::Numeric;
use firmware_sim::progress::Audience;
use serde::Serialize;
use ted_core::integer::IntegerScratch;
use ted_core::{Scratch, ShapeError};
use ted_policy::{Artifact, ArtifactBytes, ArtifactError, LoadError};

use crate::dataset::Dataset;
use crate::evaluate::EvaluateError;
use crate::export::ExportError;
use crate::rng::Seed;
use crate::run::{RunError, RunFolder};
use crate::ted::{DiscountConfig, classes};
use crate::tolerance::{self, Allowed, Tolerance};
use crate::train::{FinishedRun, TrainError};

use flight::{Again, fly_again};

/// How much is compared.
#[derive(Clone, Copy, Debug)]
pub struct CrosscheckConfig {
    /// Observations whose actions are compared; all of the dataset's if not given.
    pub sample: Option<usize>,
    /// Episodes of the evaluation that are flown again.
    pub episodes: u32,
    /// Simulator processes.
    pub workers: usize,
}

/// What was compared, and how it came out.
#[derive(Clone, Debug, Serialize)]
pub struct Crosscheck {
    /// The run.
    pub run: std::path::PathBuf,
    /// The dataset.
    pub dataset: String,
    /// Which observations.
    pub observations: String,
    /// One line a comparison.
    pub checks: Vec<Check>,
    /// What could not be compared, and why.
    pub left_out: Vec<String>,
}

/// One comparison.
#[derive(Clone, Debug, Serialize)]
pub struct Check {
    /// What was compared.
    pub what: &'static str,
    /// What is allowed.
    pub allowed: Allowed,
    /// Things compared.
    pub compared: u64,
    /// Things that are not the same to the bit.
    pub unequal: u64,
    /// How far numbers are apart; none for things that are equal or not.
    pub distance: Option<Distance>,
    /// Whether it is as it must be.
    pub passed: bool,
}

/// Why a comparison could not be made.
#[derive(Debug, thiserror::Error)]
pub enum CrosscheckError {
    /// The run's folder.
    #[error(transparent)]
    Run(#[from] RunError),
    /// The run's state.
    #[error(transparent)]
    Train(#[from] TrainError),
    /// The artefact cannot be read.
    #[error(transparent)]
    Load(#[from] LoadError),
    /// The artefact is broken.
    #[error("the artefact is not valid: {0}; `ted export` makes it again")]
    Artifact(ArtifactError),
    /// The artefact cannot be made again.
    #[error(transparent)]
    Export(#[from] ExportError),
    /// The artefact is for other observations or actions than the dataset holds.
    #[error("the artefact does not fit the dataset: {0}")]
    Shape(#[from] ShapeError),
    /// The flight.
    #[error(transparent)]
    Evaluate(#[from] EvaluateError),
    /// Somebody asked to stop.
    #[error("stopped on request; nothing was changed")]
    Interrupted,
}

impl Crosscheck {
    /// Whether everything is as it must be.
    #[must_use]
    pub fn passed(&self) -> bool {
        self.checks.iter().all(|check| check.passed)
    }
}

impl Check {
    fn exact(tolerance: Tolerance, (compared, unequal): (u64, u64)) -> Self {
        Self {
            what: tolerance.what,
            allowed: tolerance.allowed,
            compared,
            unequal,
            distance: None,
            passed: tolerance.allowed.holds(f64::INFINITY, unequal),
        }
    }

    fn of(tolerance: Tolerance, distance: Distance) -> Self {
        Self {
            what: tolerance.what,
            allowed: tolerance.allowed,
            compared: distance.compared,
            unequal: distance.unequal,
            distance: Some(distance),
            passed: tolerance
                .allowed
                .holds(distance.max_absolute, distance.unequal),
        }
    }
}

/// Compares everything that a finished run and its artefact have in common.
///
/// # Errors
/// When the run is not finished, or something of it cannot be read or flown. A difference is no error but a [`Check`] that
/// has not passed.
pub fn crosscheck(
    folder: &RunFolder,
    dataset: &Dataset,
    config: &CrosscheckConfig,
    audience: Audience,
) -> Result<Crosscheck, CrosscheckError> {
    let run = FinishedRun::read(folder, dataset, audience)?;
    let bytes = ArtifactBytes::read(folder.artefact_path())?;
    let artifact = Artifact::parse(&bytes).map_err(CrosscheckError::Artifact)?;
    let (mut checks, mut left_out) = (Vec::new(), Vec::new());

    let cases = artifact.golden().cases().count() as u64;
    let golden = artifact.verify_golden(&mut Scratch::new());
    checks.push(Check::exact(
        tolerance::GOLDEN,
        (cases, u64::from(golden.is_err())),
    ));
    left_out.extend(
        golden
            .err()
            .map(|error| format!("golden vectors after the first difference: {error}")),
    );
    match artifact.integers() {
        Some(_) => {
            let golden = artifact.verify_integer_golden(&mut IntegerScratch::new());
            let unequal = u64::from(golden.is_err());
            checks.push(Check::exact(tolerance::INTEGER_GOLDEN, (cases, unequal)));
        }
        None => {
            left_out.push("integers: the artefact holds none; `ted export` adds them".to_owned())
        }
    }
    let weights = state::weights(&artifact, &run)?;
    checks.push(Check::of(tolerance::WEIGHTS, weights));
    let exported = run.artefact(dataset)?;
    checks.push(Check::exact(
        tolerance::EXPORT,
        unequal_bytes(&bytes, &exported.bytes),
    ));

    match artifact.reward() {
        Some(ensemble) => {
            let labels = state::labels(&ensemble, &run, dataset)?;
            checks.push(Check::of(tolerance::LABELS, labels));
        }
        None => left_out.push("rewards: the artefact holds no ensemble".to_owned()),
    }
    match (artifact.ted(), &run.config().discount) {
        (Some(ted), DiscountConfig::Ted { k, .. }) => {
            checks.push(Check::exact(
                tolerance::CLASSES,
                state::classes(&ted, &run.labels().returns_hat, *k),
            ));
        }
        _ => left_out.push("TED classes: the artefact holds no lookup".to_owned()),
    }
    match (run.ted(), &exported.integer_classes) {
        (Some(ted), Some(integer_classes)) => {
            let float_classes = classes(&ted, &run.labels().returns_hat);
            for (tolerance, numeric, trained) in [
                (tolerance::SCORED_F32, Numeric::F32, &float_classes),
                (tolerance::SCORED_INTEGER, Numeric::Integer, integer_classes),
            ] {
                let scored = scored::classes(&artifact, numeric, dataset)?;
                checks.push(Check::exact(tolerance, scored::unequal(&scored, trained)));
            }
        }
        _ => {
            left_out.push("episodes scored: the artefact holds no ensemble or no lookup".to_owned())
        }
    }
    match fly_again(folder, config.episodes, config.workers, audience)? {
        Again::Compared(counts) => checks.push(Check::exact(tolerance::RETURNS, counts)),
        Again::Nothing(why) => left_out.push(format!("returns: {why}")),
    }

    let (rows, observations) = rows(dataset, config.sample, run.config().seed);
    let policy = artifact.policy();
    let distances = actions::compare(&policy, run.actor(), dataset, &rows, audience)?;
    checks.extend([
        Check::of(tolerance::ACTIONS_FUSED, distances.fused_core),
        Check::of(tolerance::ACTIONS_FLEX, distances.flex_core),
        Check::of(tolerance::ACTIONS_NDARRAY, distances.ndarray_core),
        Check::of(tolerance::ACTIONS_BURN, distances.flex_ndarray),
    ]);
    Ok(Crosscheck {
        run: folder.path().to_path_buf(),
        dataset: dataset.id().to_owned(),
        observations,
        checks,
        left_out,
    })
}

/// The rows of the dataset's observations that are compared, and how a person calls them.
fn rows(dataset: &Dataset, sample: Option<usize>, seed: u64) -> (Vec<usize>, String) {
    let all = dataset.observations().len() / dataset.observation_dim();
    match sample {
        Some(sample) if sample < all => {
            let mut rng = Seed::root(seed).child("crosscheck").rng();
            let mut rows = rand::seq::index::sample(&mut rng, all, sample).into_vec();
            rows.sort_unstable();
            let text = format!("{sample} of {all}, drawn without replacement, seed {seed}");
            (rows, text)
        }
        _ => ((0..all).collect(), format!("all {all}")),
    }
}

fn unequal_bytes(left: &[u8], right: &[u8]) -> (u64, u64) {
    let unequal = left.iter().zip(right).filter(|(l, r)| l != r).count();
    let total = left.len().max(right.len());
    (
        total as u64,
        (unequal + left.len().abs_diff(right.len())) as u64,
    )
}
