//! The person at the terminal: the same questions as numbers and small curves.

use std::io::{BufRead, Write};
use std::sync::mpsc::{Receiver, RecvTimeoutError, sync_channel};
use std::thread;
use std::time::Duration;

use firmware_sim::interrupt;

use super::clip::{ClipSource, Picture, Track};
use super::person::{Person, Reply, Review, Turn, Verdict};
use super::words::{filled, said_line, why, word};
use super::{Did, Odd};
use crate::preferences::{Answer, LogEntry};
use crate::reward::Ranked;

/// Characters of a curve.
const WIDTH: usize = 28;
/// Characters of a name.
const NAME: usize = 22;
const LEVELS: [char; 8] = ['▁', '▂', '▃', '▄', '▅', '▆', '▇', '█'];

/// Somebody who reads lines and types.
pub struct Terminal<'a, W> {
    lines: Receiver<String>,
    out: W,
    clips: &'a dyn ClipSource,
}

impl<'a, W: Write> Terminal<'a, W> {
    /// Reads what is typed on a thread of its own, so that somebody who stops is heard at once.
    pub fn new(typed: impl BufRead + Send + 'static, out: W, clips: &'a dyn ClipSource) -> Self {
        let (sender, lines) = sync_channel(0);
        thread::spawn(move || {
            for line in typed.lines().map_while(Result::ok) {
                if sender.send(line).is_err() {
                    break;
                }
            }
        });
        Self { lines, out, clips }
    }

    /// A line that somebody typed; none when there will be no more, or they stop.
    fn line(&mut self, prompt: &str) -> Option<String> {
        self.say(prompt);
        loop {
            match self.lines.recv_timeout(Duration::from_millis(100)) {
                Ok(line) => return Some(line.trim().to_lowercase()),
                Err(RecvTimeoutError::Timeout) if !interrupt::requested() => {}
                Err(_) => return None,
            }
        }
    }

    /// Says something. When nobody reads it any more, nobody types either.
    fn say(&mut self, text: &str) {
        let _ = write!(self.out, "{text}").and_then(|()| self.out.flush());
    }
}

impl<W: Write> Person for Terminal<'_, W> {
    fn answer(&mut self, turn: Turn<'_>) -> Reply {
        let (number, of) = (turn.number.to_string(), turn.of.to_string());
        let mut text = format!(
            "\n{}\n",
            filled("text-question", &[("number", &number), ("of", &of)])
        );
        if let Some(logged) = &turn.question.why {
            text.push_str(&format!("{}\n", filled("why", &[("why", &why(logged))])));
        }
        let pictures = turn
            .question
            .query
            .segments
            .map(|it| self.clips.picture(it));
        text.push_str(&compared(&pictures));
        self.say(&text);
        let enough = if turn.is_extra() {
            word("text-enough")
        } else {
            ""
        };
        let prompt = filled("text-prompt", &[("enough", enough)]);
        loop {
            let Some(line) = self.line(&prompt) else {
                return Reply::Stop;
            };
            match line.as_str() {
                "1" => return Reply::Answer(Answer::First),
                "2" => return Reply::Answer(Answer::Second),
                "3" => return Reply::Answer(Answer::Equal),
                "4" => return Reply::CannotTell,
                "5" => return Reply::Later,
                "w" => self.say(&told(&turn.did())),
                "m" => return Reply::More,
                "e" if turn.is_extra() => return Reply::Enough,
                "q" => return Reply::Stop,
                line => match reopened(line, turn.before) {
                    Some(place) => return Reply::Reopen(place),
                    None => self.say(&format!("{}\n", word("text-unknown"))),
                },
            }
        }
    }

    fn review(&mut self, review: Review<'_>) -> Verdict {
        let (text, prompt) = match review.stuck {
            Some(stuck) => (stuck, "text-stuck-prompt"),
            None => (word("text-review"), "text-review-prompt"),
        };
        self.say(&format!("\n{}{text}\n", listed(review.said)));
        loop {
            let Some(line) = self.line(word(prompt)) else {
                return Verdict::Stop;
            };
            match line.as_str() {
                "" if review.stuck.is_none() => return Verdict::Done,
                "w" => self.say(&told(&review.did())),
                "m" if review.stuck.is_none() => return Verdict::More,
                "q" => return Verdict::Stop,
                line => match reopened(line, review.said) {
                    Some(place) => return Verdict::Reopen(place),
                    None => self.say(&format!("{}\n", word("text-unknown"))),
                },
            }
        }
    }
}

/// The place in the log that `u` or `u N` means.
fn reopened(line: &str, before: &[LogEntry]) -> Option<usize> {
    let number = match line.strip_prefix('u')?.trim() {
        "" => before.len(),
        number => number.parse().ok()?,
    };
    let place = number.checked_sub(1)?;
    (place < before.len()).then_some(place)
}

/// Everything that was said, one line each.
fn listed(said: &[LogEntry]) -> String {
    let lines = (1..).zip(said);
    let lines = lines.map(|(number, entry)| format!("{number:>3}  {}\n", said_line(entry)));
    lines.collect()
}

/// What the answers did.
fn told(did: &Did) -> String {
    let mut text = format!("\n{}\n", word("did-title"));
    for sentence in &did.says {
        text.push_str(&format!("{sentence}\n"));
    }
    for (side, heading) in ["text-best", "text-worst"].into_iter().enumerate() {
        let episode = |pair: &[Ranked; 2]| {
            let Ranked { segment, above } = pair[side];
            format!("{} ({above:+.1})", segment.episode())
        };
        let episodes: Vec<String> = did.pairs.iter().map(episode).collect();
        if !episodes.is_empty() {
            let line = filled(heading, &[("episodes", &episodes.join(", "))]);
            text.push_str(&format!("{line}\n"));
        }
    }
    let heading = if did.odd.is_empty() {
        "odd-none"
    } else {
        "odd-heading"
    };
    text.push_str(&format!("{}\n", word(heading)));
    for Odd { place, says } in &did.odd {
        text.push_str(&format!("{:>3}  {says}\n", place + 1));
    }
    text
}

/// Two clips side by side.
fn compared(pictures: &[Picture; 2]) -> String {
    let heading = |side: &str, picture: &Picture| {
        let to = picture.last_step();
        let clip = [
            ("episode", picture.episode.to_string()),
            ("from", picture.start.to_string()),
            ("to", to.to_string()),
        ];
        let clip = clip.each_ref().map(|(key, value)| (*key, value.as_str()));
        format!("{}: {}", word(side), filled("clip", &clip))
    };
    let [left, right] = pictures;
    let headings = [
        heading("left-heading", left),
        heading("right-heading", right),
    ];
    let mut text = format!(
        "{:NAME$}  {:<column$}{}\n",
        "",
        headings[0],
        headings[1],
        column = WIDTH + 20
    );
    let mut still = Vec::new();
    for (left, right) in tracks(left).into_iter().zip(tracks(right)) {
        let both = left.values.iter().chain(&right.values);
        let (low, high) = both.fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), &value| {
            (low.min(value), high.max(value))
        });
        if low == high {
            still.push(left.name);
            continue;
        }
        let name = format!("{} {}", left.name, left.unit);
        let [left, right] = [&left, &right].map(|track| {
            let end = track.values.last().copied().unwrap_or_default();
            let curve = curve(&track.values, low, high);
            format!("{curve:<WIDTH$}  ends {:<11}", short(end))
        });
        text.push_str(&format!("{:<NAME$}  {left}  {right}\n", name.trim_end()));
    }
    if !still.is_empty() {
        text.push_str(&filled("still", &[("names", &still.join(", "))]));
        text.push('\n');
    }
    text
}

/// Every number of a clip.
fn tracks(picture: &Picture) -> Vec<Track> {
    let axes = picture.places.iter().flat_map(|place| {
        ["x", "y", "z"]
            .into_iter()
            .enumerate()
            .filter(|(axis, _)| place.declared[*axis])
            .map(|(axis, name)| Track {
                name: format!("{} {name}", place.name),
                unit: String::new(),
                values: place.path.iter().map(|at| at[axis]).collect(),
            })
    });
    let others = picture.plots.iter().chain(&picture.actions).cloned();
    axes.chain(others).collect()
}

/// Numbers as a row of blocks, each the mean of its part of the clip.
fn curve(values: &[f32], low: f32, high: f32) -> String {
    let width = WIDTH.min(values.len());
    let block = |column: usize| {
        let part = &values[column * values.len() / width..(column + 1) * values.len() / width];
        let mean = part.iter().sum::<f32>() / part.len() as f32;
        let level = (mean - low) / (high - low) * (LEVELS.len() - 1) as f32;
        LEVELS[(level.round() as usize).min(LEVELS.len() - 1)]
    };
    (0..width).map(block).collect()
}

/// A number in few characters.
fn short(number: f32) -> String {
    match number.abs() {
        0.0 => "0".to_owned(),
        size if (1e-3..1e5).contains(&size) => format!("{number:.3}"),
        _ => format!("{number:.1e}"),
    }
}

#[cfg(test)]
mod drawing {
    use super::*;

    #[test]
    fn a_curve_rises_with_its_numbers_and_is_no_longer_than_they_are() {
        let rising: Vec<f32> = (0..56).map(|i| i as f32).collect();
        let drawn = curve(&rising, 0.0, 55.0);
        assert_eq!(drawn.chars().count(), WIDTH);
        assert!(drawn.starts_with('▁') && drawn.ends_with('█'), "{drawn}");
        assert_eq!(curve(&[0.0, 1.0], 0.0, 1.0), "▁█");
        assert_eq!(
            (short(0.0), short(0.25), short(2e7)),
            ("0".into(), "0.250".into(), "2.0e7".into())
        );
    }
}
