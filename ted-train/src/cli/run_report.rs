//! How a run ended that somebody waited for alone.

use std::path::Path;

use serde::Serialize;

use super::eval::text;
use crate::evaluate::Evaluation;
use crate::fleet::Trained;
use crate::reward::episodes::Confidence;

/// What came of it.
#[derive(Debug, Serialize)]
pub(super) struct RunReport<'t> {
    #[serde(flatten)]
    end: End<'t>,
    #[serde(flatten)]
    sure: Option<Sure<'t>>,
    /// The page that says what became of it.
    report: Option<&'t Path>,
}

/// How it flew, or what it left if it did not.
#[derive(Debug, Serialize)]
#[serde(untagged)]
enum End<'t> {
    Flown(&'t Evaluation),
    Left {
        run: &'t Path,
        artefact: Option<&'t Path>,
    },
}

/// How sure it is that its policy is better than the logs, in numbers and in words.
#[derive(Debug, Serialize)]
pub(super) struct Sure<'t> {
    confidence: &'t Confidence,
    statement: String,
}

impl<'t> Sure<'t> {
    /// What a run says of that; none of one that cannot tell.
    pub(super) fn of(trained: &'t Trained) -> Option<Self> {
        let confidence = trained.confidence.as_ref()?;
        Some(Self {
            confidence,
            statement: confidence.in_words(),
        })
    }

    /// In words.
    pub(super) fn statement(&self) -> &str {
        &self.statement
    }
}

impl<'t> RunReport<'t> {
    pub(super) fn of(folder: &'t Path, trained: &'t Trained, report: Option<&'t Path>) -> Self {
        let left = End::Left {
            run: folder,
            artefact: trained.artefact.as_deref(),
        };
        Self {
            end: trained.evaluation.as_ref().map_or(left, End::Flown),
            sure: Sure::of(trained),
            report,
        }
    }

    pub(super) fn text(&self) -> String {
        let end = match self.end {
            End::Flown(evaluation) => text(evaluation),
            End::Left { run, artefact } => artefact.unwrap_or(run).display().to_string(),
        };
        let sure = self.sure.as_ref().map(|sure| sure.statement().to_owned());
        let report = self
            .report
            .map(|path| format!("report: {}", path.display()));
        let lines = [Some(end), report, sure];
        lines.into_iter().flatten().collect::<Vec<_>>().join("\n")
    }
}
