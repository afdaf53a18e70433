//! Whether a policy is better than the logs and better than imitating them, and how sure that is.

use serde::Serialize;

use crate::evaluate::Evaluation;
use crate::reward::episodes::Confidence;
use crate::statistics::{Estimate, mean};

/// What the flights say of a policy.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Verdict {
    /// Beside an average episode of the logs; none if it was not flown, or the logs have no rewards.
    pub logs: Option<Comparison>,
    /// Beside a clone of the logs that flew; none if either was not flown.
    pub imitation: Option<Comparison>,
    /// The same in words.
    pub words: String,
}

/// How far its mean return is above another one, by chance alone.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Comparison {
    /// Mean return of the other one.
    pub other: f64,
    /// How far it is above that.
    pub above: f64,
    /// Both ends of the 95 % interval of that; none of a single flight.
    pub interval: Option<[f64; 2]>,
}

impl Verdict {
    /// From the flights of the policy, those of a clone of the same logs, what the answers say, and whether the logs have rewards.
    #[must_use]
    pub fn new(
        flown: Option<&Evaluation>,
        clone: Option<&Evaluation>,
        confidence: Option<&Confidence>,
        rewarded: bool,
    ) -> Self {
        let Some(flown) = flown else {
            return Self {
                logs: None,
                imitation: None,
                words: unflown(confidence),
            };
        };
        let logs = rewarded.then(|| Comparison::with_logs(flown));
        let imitation = clone.map(|clone| Comparison::with_flights(flown, clone));
        Self {
            words: words(flown, logs, imitation),
            logs,
            imitation,
        }
    }
}

impl Comparison {
    fn with_logs(flown: &Evaluation) -> Self {
        let other = flown.dataset_mean;
        let flights = Estimate::of(std::slice::from_ref(&flown.returns), mean);
        Self {
            other,
            above: flown.return_mean - other,
            interval: (flights.and_then(|it| it.interval)).map(|ends| ends.map(|end| end - other)),
        }
    }

    fn with_flights(flown: &Evaluation, clone: &Evaluation) -> Self {
        let both = [flown.returns.clone(), clone.returns.clone()];
        let above = Estimate::of(&both, difference);
        Self {
            other: clone.return_mean,
            above: flown.return_mean - clone.return_mean,
            interval: above.and_then(|it| it.interval),
        }
    }

    /// How it stands to the other one, which is called so.
    fn in_words(&self, other: &str) -> String {
        let below = -self.above;
        match self.interval {
            None => format!("one flight does not tell whether it is better than {other}"),
            Some([low, high]) if low > 0.0 => format!(
                "better than {other}, by {:.0} (95 % interval {low:.0} to {high:.0})",
                self.above
            ),
            Some([low, high]) if high < 0.0 => format!(
                "WORSE than {other}, by {below:.0} (95 % interval {:.0} to {:.0})",
                -high, -low
            ),
            Some([low, high]) => format!(
                "not to be told apart from {other}: {:+.0} (95 % interval {low:+.0} to {high:+.0}), and more flights would say more",
                self.above
            ),
        }
    }
}

/// Mean of the first less mean of the second.
fn difference(groups: &[Vec<f64>]) -> f64 {
    let [first, second] = groups else {
        return 0.0;
    };
    mean(std::slice::from_ref(first)) - mean(std::slice::from_ref(second))
}

fn words(flown: &Evaluation, logs: Option<Comparison>, imitation: Option<Comparison>) -> String {
    let flights = format!(
        "{} flights return {:.0} on average",
        flown.returns.len(),
        flown.return_mean
    );
    let beside_logs = match logs {
        Some(logs) => format!(
            "This policy is {}: {flights}, an episode of the logs {:.0}.",
            logs.in_words("the logs"),
            logs.other
        ),
        None => {
            format!("The logs have no rewards that this policy could be compared with: {flights}.")
        }
    };
    let beside_clone = match imitation {
        Some(imitation) => format!("It is {}.", imitation.in_words("imitating them")),
        None => "Whether it is better than imitating them is not known: no clone of these logs was flown beside it (`ted train` \
                 with --preset bc makes one)."
            .to_owned(),
    };
    format!("{beside_logs} {beside_clone}")
}

fn unflown(confidence: Option<&Confidence>) -> String {
    let known = match confidence {
        Some(confidence) => format!("What the answers say: {}.", confidence.in_words()),
        None => "Nothing is known about how good it is.".to_owned(),
    };
    format!("Nobody has flown this policy. {known}")
}

#[cfg(test)]
mod tests {
    use firmware_sim::bridge::Engine;
    use firmware_sim::controller::Numeric;

    use super::*;

    fn flown(returns: &[f64]) -> Evaluation {
        Evaluation {
            task: "drawer-open-v3".to_owned(),
            world: None,
            numeric: Numeric::F32,
            engine: Engine::Fast,
            seed: 0,
            returns: returns.to_vec(),
            return_mean: returns.iter().sum::<f64>() / returns.len() as f64,
            return_sd: 1.0,
            score: None,
            success: 1.0,
            faulted: 0,
            faults: Vec::new(),
            dataset_mean: 100.0,
            dataset_max: 1000.0,
        }
    }

    #[test]
    fn a_policy_is_better_worse_or_not_to_be_told_apart() {
        let good = flown(&[500.0, 510.0, 490.0, 505.0]);
        let bad = flown(&[50.0, 40.0, 60.0, 45.0]);
        let wavering = flown(&[0.0, 250.0, 10.0, 200.0]);
        let of = |flown, clone| Verdict::new(Some(flown), clone, None, true).words;
        let words = of(&good, Some(&bad));
        assert!(
            words.starts_with("This policy is better than the logs, by 401 (95 % interval"),
            "{words}"
        );
        assert!(
            words.contains("It is better than imitating them, by 452"),
            "{words}"
        );
        let words = of(&bad, Some(&good));
        assert!(
            words.starts_with("This policy is WORSE than the logs, by 51"),
            "{words}"
        );
        assert!(
            words.contains("It is WORSE than imitating them, by 452"),
            "{words}"
        );
        let words = of(&wavering, None);
        assert!(
            words.contains("not to be told apart from the logs: +15"),
            "{words}"
        );
        assert!(words.contains("--preset bc"), "{words}");
    }

    #[test]
    fn one_flight_tells_nothing_and_none_leaves_what_the_answers_say() {
        let verdict = Verdict::new(Some(&flown(&[500.0])), None, None, true);
        assert_eq!(verdict.logs.unwrap().interval, None);
        assert!(
            verdict.words.contains("one flight does not tell"),
            "{}",
            verdict.words
        );
        let confidence = Confidence {
            answers: 10,
            agreeing: 9,
            gain: 2.0,
            range: [1.0, 3.0],
            better: 0.99,
            leaves_the_logs: true,
        };
        let verdict = Verdict::new(None, None, Some(&confidence), true);
        assert!(verdict.words.contains("by 10 answers"), "{}", verdict.words);
        let unrewarded = Verdict::new(Some(&flown(&[500.0, 400.0])), None, None, false);
        assert_eq!(unrewarded.logs, None);
        assert!(
            unrewarded.words.contains("no rewards"),
            "{}",
            unrewarded.words
        );
        assert!(
            Verdict::new(None, None, None, true)
                .words
                .contains("Nothing is known")
        );
    }
}
