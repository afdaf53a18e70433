//! The load gate of every controller: this machine computes the golden vectors of an artefact, bit for bit.

use ted_core::Scratch;
use ted_core::integer::IntegerScratch;
use ted_policy::{Artifact, ArtifactError};

use crate::controller::Numeric;

/// The proof that this machine computes the golden vectors of an artefact, and in which numbers it did.
#[derive(Clone, Copy, Debug)]
pub struct Proven(Numeric);

impl Proven {
    /// Computes every golden vector of the artefact and compares the bits.
    ///
    /// # Errors
    /// The golden vector that came out differently, or that the artefact has no networks in these numbers.
    pub fn of(artifact: &Artifact<'_>, numeric: Numeric) -> Result<Self, ArtifactError> {
        match numeric {
            Numeric::F32 => in_floats(artifact)?,
            Numeric::Integer => in_integers(artifact)?,
        }
        Ok(Self(numeric))
    }

    /// The numbers.
    #[must_use]
    pub const fn numeric(self) -> Numeric {
        self.0
    }
}

// Each apart, so that its working memory is on the stack while it is used and no longer.

#[inline(never)]
fn in_floats(artifact: &Artifact<'_>) -> Result<(), ArtifactError> {
    artifact.verify_golden(&mut Scratch::new())
}

#[inline(never)]
fn in_integers(artifact: &Artifact<'_>) -> Result<(), ArtifactError> {
    artifact.verify_integer_golden(&mut IntegerScratch::new())
}
