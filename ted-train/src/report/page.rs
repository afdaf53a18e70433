//! The page.

use maud::{DOCTYPE, Markup, PreEscaped, html};

use super::ReportError;
use super::clip::{clips, legend};
use super::facts::{Asked, Curve, Facts, Predicted};
use super::figures;
use super::logs;
use super::shot::{Flown, Shot};
use crate::evaluate::Evaluation;
use crate::preferences::Answer;
use crate::quantise::QuantisationReport;
use crate::reward::quality::RewardQuality;
use crate::ted::DiscountConfig;
use crate::train::RewardReport;

const STYLE: &str = include_str!("style.css");

/// All of it.
pub(super) fn page(facts: &Facts) -> Result<Markup, ReportError> {
    let run = &facts.run;
    let title = format!(
        "{} on {}, seed {}",
        run.config.preset.name(),
        run.dataset.id,
        run.config.seed
    );
    let body = html! {
        h1 { (title) }
        p .verdict { (facts.verdict.words) }
        @if let Some(confidence) = run.reward.as_ref().and_then(|reward| reward.confidence.as_ref()) {
            p { "What the answers say: " (confidence.in_words()) "." }
        }
        @if let Some(flown) = &run.evaluation { (flights(flown, facts)?) }
        @if !facts.asked.is_empty() { (asked(&facts.asked)) }
        @if let Some(predicted) = &facts.predicted { (predictions(facts, predicted)?) }
        @if !facts.curves.is_empty() { (curves(&facts.curves)?) }
        @if let Some(integers) = &facts.integers { (quantisation(integers, &facts.actions)) }
        (logs::logs(&facts.check))
        (provenance(facts))
    };
    Ok(sheet(&title, &body))
}

/// A page that needs nothing else.
pub(super) fn sheet(title: &str, body: &Markup) -> Markup {
    html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                title { (title) }
                style { (PreEscaped(STYLE)) }
            }
            body { main { (PreEscaped(&body.0)) } }
        }
    }
}

/// A picture, and what it shows for those who do not see it.
pub(super) fn plot(svg: String, label: &str) -> Markup {
    html! { figure .plot role="img" aria-label=(label) { (PreEscaped(svg)) } }
}

fn flights(flown: &Evaluation, facts: &Facts) -> Result<Markup, ReportError> {
    let (clone, rewarded) = (facts.clone.as_ref(), facts.verdict.logs.is_some());
    let of_logs = flown.score_of(flown.dataset_mean);
    let row = |name: &str, it: &Evaluation| {
        html! {
            tr {
                th scope="row" { (name) }
                td { (it.returns.len()) }
                td { (format!("{:.0} ± {:.0}", it.return_mean, it.return_sd)) }
                td { (it.score.map_or("-".to_owned(), |score| format!("{score:.2}"))) }
                td { (format!("{:.0} %", 100.0 * it.success)) }
                td { (it.faulted) }
            }
        }
    };
    Ok(html! {
        section {
            h2 { "The flights" }
            table {
                thead { tr { td {} th { "flights" } th { "return" } th { "score" } th { "success" } th { "faults" } } }
                tbody {
                    (row("this policy", flown))
                    @if let Some(clone) = clone { (row("a clone of the same logs", clone)) }
                    @if rewarded {
                        tr { th scope="row" { "an episode of the logs" } td {} td { (format!("{:.0}", flown.dataset_mean)) }
                            td { (of_logs.map_or("-".to_owned(), |score| format!("{score:.2}"))) } td {} td {} }
                    }
                }
            }
            p .small {
                "Return: mean and standard deviation."
                @if let Some(measure) = flown.measure() { " Score: " (measure) "." }
            }
            (plot(figures::flights(flown, clone, rewarded)?, "the return of every flight, beside mean and largest return of the logs"))
            @if let Some(flight) = &facts.flight { (one_flight(flight, flown.returns.len())) }
        }
    })
}

fn one_flight(flight: &Flown, of: usize) -> Markup {
    let success = match flight.success {
        true => "a success",
        false => "no success",
    };
    let caption = format!(
        "flight {} of {of}, return {:.0}, {success}",
        flight.place + 1,
        flight.return_true
    );
    html! {
        h3 { "A flight like most" }
        (legend(&flight.shot))
        (clips([(&flight.shot, caption)]))
        p .small { "The one whose return is nearest the mean." }
    }
}

fn asked(asked: &[Asked]) -> Markup {
    let said = |it: &Asked| match it.entry.said.answer {
        Some(Answer::First) => "the left one is better",
        Some(Answer::Second) => "the right one is better",
        Some(Answer::Equal) => "both are equally good",
        None if it.entry.said.later => "put off",
        None => "could not tell",
    };
    html! {
        section {
            h2 { "What was asked and answered" }
            @if let Some(first) = asked.first() { @if let Some([shot, _]) = &first.shots { (legend(shot)) } }
            @if asked.iter().any(|it| it.entry.question.why.as_ref().is_some_and(|why| why.contains("whereabouts"))) {
                p .small { "Whereabouts are the directions in which the mean observations of episodes differ most; " code { "ted inspect DATASET --look" } " says what each is made of." }
            }
            @for (number, it) in asked.iter().enumerate() {
                div .question {
                    h3 { (number + 1) ". " (it.entry.said.by) ": " (said(it)) }
                    @if let Some(why) = &it.entry.question.why { p .small { "Asked because " (why) "." } }
                    @if let Some(shots) = &it.shots { (clips(shots.iter().map(|shot| (shot, caption(shot))))) }
                    @else { p { "Episodes " (it.entry.question.query.segments[0].episode()) " and " (it.entry.question.query.segments[1].episode()) "." } }
                }
            }
        }
    }
}

fn caption(Shot { picture, .. }: &Shot) -> String {
    let (episode, first, last) = (picture.episode, picture.start, picture.last_step());
    format!("episode {episode}, steps {first} to {last}")
}

/// Episodes, each with what is predicted of it.
fn captioned<'a>(
    shots: &'a [Shot],
    predicted: &Predicted,
) -> impl Iterator<Item = (&'a Shot, String)> {
    shots.iter().map(|shot| {
        let episode = shot.picture.episode;
        let hat = predicted.returns_hat[episode as usize];
        let caption = format!("episode {episode}, predicted return {hat:.1}");
        (shot, caption)
    })
}

fn predictions(facts: &Facts, predicted: &Predicted) -> Result<Markup, ReportError> {
    let scatter = (predicted.returns_true.as_deref())
        .map(|truth| figures::predicted_against_true(predicted, truth))
        .transpose()?;
    Ok(html! {
        section {
            h2 { "What the learned reward thinks of the logs" }
            @if let Some(reward) = &facts.run.reward { (quality(reward)) }
            h3 { "The best by prediction" }
            @if let Some(first) = predicted.best.first() { (legend(first)) }
            (clips(captioned(&predicted.best, predicted)))
            h3 { "The worst by prediction" }
            (clips(captioned(&predicted.worst, predicted)))
            @if let Some(scatter) = scatter {
                h3 { "Predicted against true returns" }
                (plot(scatter, "predicted against true returns of all episodes, with the line on which they are equal"))
            }
            h3 { "Discounts" }
            p { (discounts(&facts.run.config.discount, facts.episodes)) }
            (plot(figures::histogram(predicted)?, "how many episodes have which predicted return"))
        }
    })
}

/// How well the reward orders the episodes, as far as anybody knows.
fn quality(reward: &RewardReport) -> Markup {
    let held_out = reward.held_out.as_ref();
    html! {
        @if let Some(RewardQuality { spearman, best_kept, top_decile_lift, .. }) = &reward.quality {
            p {
                "The order that it predicts for the episodes goes with the true one by " (format!("{spearman:.2}"))
                " (Spearman; 1 is the same order, 0 is chance, -1 the opposite). Of the best twentieth of the episodes, "
                (format!("{:.0} %", 100.0 * best_kept)) " are among the 70 % that it holds to be better."
                @if let Some(lift) = top_decile_lift {
                    " The tenth that it holds to be the best has " (format!("{lift:.1}")) " times the mean return."
                }
            }
        } @else { p { "The logs have no true rewards, so nobody knows how right it is." } }
        @if let Some(held_out) = held_out {
            p { "Of " (held_out.pairs) " pairs that were not asked it gets " (format!("{:.0} %", 100.0 * held_out.agreement)) " right." }
        }
    }
}

fn discounts(discount: &DiscountConfig, episodes: usize) -> String {
    match discount {
        DiscountConfig::Constant { gamma, shift } => match shift {
            0.0 => format!("Every step has the discount factor {gamma}."),
            shift => format!(
                "Every step has the discount factor {gamma}, and {shift} is added to its reward."
            ),
        },
        DiscountConfig::Ted { k, sigma, gamma } if *sigma < 1.0 => format!(
            "The best {k} % of {episodes} episodes by prediction (blue) have the discount factor {gamma}, the others {:.3}. The line is the \
             border.",
            gamma * sigma
        ),
        DiscountConfig::Ted { k, gamma, .. } => format!(
            "Every step has the discount factor {gamma}. The line is the border of the best {k} % of {episodes} episodes (blue), which \
             travels with the policy: a device can tell by it how good an episode of its own was."
        ),
        _ => "By the rule in config.toml.".to_owned(),
    }
}

fn curves(curves: &[Curve]) -> Result<Markup, ReportError> {
    let mut phases: Vec<&str> = curves.iter().map(|curve| curve.phase.as_str()).collect();
    phases.dedup();
    let mut sections = Vec::new();
    for phase in phases {
        let mut plots = Vec::new();
        for curve in curves.iter().filter(|curve| curve.phase == phase) {
            plots.push(plot(
                figures::curve(curve)?,
                &format!("{} over the updates", curve.name),
            ));
        }
        sections.push((phase, plots));
    }
    Ok(html! {
        section {
            h2 { "How it learned" }
            @for (phase, plots) in sections {
                h3 { (phase) }
                div .small-plots { @for plot in plots { (plot) } }
            }
        }
    })
}

fn quantisation(integers: &QuantisationReport, names: &[String]) -> Markup {
    html! {
        section {
            h2 { "What the integers cost" }
            p { "How far actions in integers are from those in floats, over the observations of the logs; the whole range of an action is 2." }
            table {
                thead { tr { th { "action" } th { "mean" } th { "99 % below" } th { "largest" } } }
                tbody {
                    @for (name, error) in names.iter().zip(&integers.actions) {
                        tr { th scope="row" { (name) } td { (format!("{:.4}", error.mean)) } td { (format!("{:.4}", error.p99)) } td { (format!("{:.4}", error.max)) } }
                    }
                }
            }
            @if let Some(coarsest) = &integers.coarsest {
                p { "The position that they see least finely is " (coarsest.channel) ": " (format!("{:.2}", coarsest.resolution_mm)) " mm." }
            }
            @if let Some(changes) = integers.rewards.as_ref().and_then(|rewards| rewards.class_changes) {
                p { (changes) " episodes of the logs are on the other side of the border in integers." }
            }
        }
    }
}

fn provenance(facts: &Facts) -> Markup {
    let run = &facts.run;
    html! {
        section {
            h2 { "Where it comes from" }
            table {
                tbody {
                    tr { th scope="row" { "dataset" } td { (run.dataset.id) ", " (facts.episodes) " episodes" } }
                    tr { th scope="row" { "its digest" } td .digest { (run.dataset.digest) } }
                    tr { th scope="row" { "preset, seed" } td { (run.config.preset.name()) ", " (run.config.seed) } }
                    tr { th scope="row" { "configuration" } td .digest { (run.config_digest) } }
                    @if let Some(digest) = run.reward.as_ref().and_then(|reward| reward.preferences_digest.as_ref()) {
                        tr { th scope="row" { "answers" } td .digest { (digest) } }
                    }
                    tr { th scope="row" { "updates" } td { (run.step) " of " (run.steps) } }
                    tr { th scope="row" { "made by" } td { "ted " (env!("CARGO_PKG_VERSION")) } }
                }
            }
        }
    }
}
