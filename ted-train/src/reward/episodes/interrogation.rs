//! Asking: one question after the other, each chosen by what is believed after the answers before it.

use firmware_sim::interrupt;
use nalgebra::DMatrix;

use crate::dataset::{Clip, Dataset, Segment, SegmentError, SegmentSampler};
use crate::preferences::{Context, Interview, LabelledPair, LogEntry};
use crate::ranking::ranking;
use crate::reward::quality::spearman;
use crate::reward::{LearnError, Material, Questions, Ranked, Standing};

use super::belief::Belief;
use super::posterior::{Evidence, Prior, posterior};
use super::questions::MostInformative;
use super::{EpisodesConfig, Look, words};

/// One look at the logs, and what is asked because of it, as often as somebody wants.
pub(super) struct Interrogation<'a> {
    config: &'a EpisodesConfig,
    on: Material<'a>,
    pub look: Look<'a>,
    pub prior: Prior,
    sampler: SegmentSampler,
    /// Every episode as a whole.
    whole: Vec<Segment>,
}

impl<'a> Interrogation<'a> {
    /// Looks at the logs, says what they say, and what is believed because of it.
    ///
    /// # Errors
    /// When the look cannot be taken, or there is no episode.
    pub fn begin(config: &'a EpisodesConfig, on: Material<'a>) -> Result<Self, LearnError> {
        let look = Look::at(config, on)?;
        let reliability = &look.descriptors().reliability;
        on.audience.note(&words::look(reliability));
        Ok(Self {
            prior: Prior::new(config, reliability),
            sampler: SegmentSampler::new(on.dataset, Clip::Episode)?,
            whole: whole_episodes(on.dataset)?,
            look,
            config,
            on,
        })
    }

    /// Asks until there are so many answers. Returns them with samples of the weights after the last one.
    ///
    /// # Errors
    /// When an answer cannot be had or kept, or somebody asks to stop.
    pub fn hold(
        &self,
        interview: &mut Interview<'_>,
        answers: usize,
    ) -> Result<(Evidence, DMatrix<f64>), LearnError> {
        let mut evidence = Evidence::default();
        let mut samples = self.believed(&evidence);
        for query in 0..answers {
            let mut rng = self.on.seed.child(&format!("query/{query}")).rng();
            let values = &self.look.descriptors().values;
            let strategy = MostInformative::new(self.config, values, &samples, &self.whole);
            let context = Context {
                round: u32::try_from(query).unwrap_or(u32::MAX),
                member: None,
            };
            let pair = interview.ask(context, &strategy, &self.sampler, &mut rng)?;
            self.hear(&mut evidence, pair);
            samples = self.believed(&evidence);
            if interrupt::requested() {
                return Err(LearnError::Interrupted);
            }
        }
        Ok((evidence, samples))
    }

    /// Samples of the weights after these answers: the same ones whenever they are drawn.
    fn believed(&self, evidence: &Evidence) -> DMatrix<f64> {
        let answers = evidence.labels.len();
        let seed = self.on.seed.child(&format!("posterior/{answers}"));
        posterior(self.config, &self.prior, evidence, seed)
    }

    fn hear(&self, evidence: &mut Evidence, LabelledPair { segments, label }: LabelledPair) {
        let values = &self.look.descriptors().values;
        let [first, second] = segments.map(|segment| values.row(segment.episode() as usize));
        evidence.push((second - first).transpose(), label);
    }
}

impl Questions for Interrogation<'_> {
    fn ask(&self, interview: &mut Interview<'_>, answers: usize) -> Result<(), LearnError> {
        self.hold(interview, answers).map(drop)
    }

    fn standing(&self, said: &[LogEntry]) -> Option<Standing> {
        let (mut evidence, mut places) = (Evidence::default(), Vec::new());
        for (place, entry) in said.iter().enumerate() {
            if let Some(answer) = entry.said.answer {
                let pair = LabelledPair::new(entry.question.query, answer);
                self.hear(&mut evidence, pair);
                places.push(place);
            }
        }
        let samples = self.believed(&evidence);
        let Belief {
            weights,
            quality,
            confidence,
        } = Belief::new(self.config, &self.look, &evidence, &samples);
        let before = &self.look.descriptors().values * &self.prior.mean;
        let ordered = before.iter().any(|quality| *quality != before[0]);
        let (mean, spread) = (quality.mean(), quality.variance().sqrt().max(1e-12));
        let ranked = |episode: usize| Ranked {
            segment: self.whole[episode],
            above: (quality[episode] - mean) / spread,
        };
        Some(Standing {
            ranking: ranking(quality.as_slice())
                .into_iter()
                .map(ranked)
                .collect(),
            confidence,
            like_before: ordered.then(|| spearman(before.as_slice(), quality.as_slice())),
            slips: evidence
                .slips(&weights)
                .into_iter()
                .map(|it| places[it])
                .collect(),
        })
    }
}

/// Every episode as a segment.
pub(super) fn whole_episodes(dataset: &Dataset) -> Result<Vec<Segment>, SegmentError> {
    let episodes = (0..).zip(dataset.episodes());
    let whole = episodes.map(|(index, episode)| {
        let steps = u32::try_from(episode.len).unwrap_or(u32::MAX);
        Segment::new(dataset, index, 0, steps)
    });
    whole.collect()
}
