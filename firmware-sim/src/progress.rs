//! How far long work has come: a bar for a person, plain lines for a log, nothing for a machine.

use std::io::{self, IsTerminal, Write};
use std::sync::Mutex;
use std::time::{Duration, Instant};

use indicatif::{HumanDuration, ProgressBar, ProgressDrawTarget, ProgressStyle};

/// Between two plain lines when standard error is not a terminal.
const LINE_PERIOD: Duration = Duration::from_secs(10);

/// Says a line on standard error. When nobody reads it any more the work still goes on.
pub fn tell(line: &str) {
    let _ = writeln!(io::stderr(), "{line}");
}

/// Who is looking, which decides what progress looks like. Everything goes to standard error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Audience {
    /// A person at a terminal: a bar with rate and time left.
    Terminal,
    /// A log file: one plain line every ten seconds or so.
    Log,
    /// A machine, or someone who asked for silence.
    Nobody,
}

impl Audience {
    /// Finds out who is looking; `silent` is for `--json` and `--quiet`.
    #[must_use]
    pub fn detect(silent: bool) -> Self {
        if silent {
            Self::Nobody
        } else if io::stderr().is_terminal() {
            Self::Terminal
        } else {
            Self::Log
        }
    }

    /// Says one line, whatever work is going on.
    pub fn note(self, line: &str) {
        if self != Self::Nobody {
            tell(line);
        }
    }

    /// Begins a piece of work of `total` units.
    #[must_use]
    pub fn start(self, what: &str, total: u64, unit: &str) -> Progress {
        Progress::new(self, what, total, unit)
    }
}

/// One piece of long work. Threads may share it.
#[derive(Debug)]
pub struct Progress {
    audience: Audience,
    what: String,
    unit: String,
    bar: ProgressBar,
    last_line: Mutex<Instant>,
}

impl Progress {
    fn new(audience: Audience, what: &str, total: u64, unit: &str) -> Self {
        let target = match audience {
            Audience::Terminal => ProgressDrawTarget::stderr(),
            Audience::Log | Audience::Nobody => ProgressDrawTarget::hidden(),
        };
        let bar = ProgressBar::with_draw_target(Some(total), target);
        let template = format!(
            "{what} {{wide_bar}} {{human_pos}}/{{human_len}} {unit} {{per_sec}}, {{eta}} left {{msg}}"
        );
        if let Ok(style) = ProgressStyle::with_template(&template) {
            bar.set_style(style);
        }
        if audience == Audience::Terminal {
            bar.enable_steady_tick(Duration::from_millis(250));
        }
        if audience == Audience::Log {
            tell(&format!("{what}: {total} {unit} to do"));
        }
        Self {
            audience,
            what: what.to_owned(),
            unit: unit.to_owned(),
            bar,
            last_line: Mutex::new(Instant::now()),
        }
    }

    /// Counts `units` more as done.
    pub fn advance(&self, units: u64) {
        self.bar.inc(units);
        self.line_when_due();
    }

    /// Counts units that were done before, or will never be: they do not count for the rate.
    pub fn skip(&self, units: u64) {
        if units > 0 {
            self.bar.inc(units);
            self.bar.reset_eta();
        }
    }

    /// Says something short beside the bar: the latest loss, the file at hand.
    pub fn message(&self, message: &str) {
        self.bar.set_message(message.to_owned());
        self.line_when_due();
    }

    /// Who is shown other work that goes on meanwhile: a log takes lines of both, and a terminal has room for one bar.
    #[must_use]
    pub fn beside(&self) -> Audience {
        match self.audience {
            Audience::Log => Audience::Log,
            Audience::Terminal | Audience::Nobody => Audience::Nobody,
        }
    }

    /// Says one line above the bar, without tearing it.
    pub fn note(&self, line: &str) {
        if self.audience != Audience::Nobody {
            self.bar.suspend(|| tell(line));
        }
    }

    /// Ends the work, done or not, and takes the bar away.
    pub fn finish(self) {
        // Read before the bar is cleared, which sets it to its end.
        let done = self.bar.position();
        self.bar.finish_and_clear();
        if self.audience == Audience::Log {
            let took = HumanDuration(self.bar.elapsed());
            tell(&format!("{}: {done} {} in {took}", self.what, self.unit));
        }
    }

    fn line_when_due(&self) {
        if self.audience != Audience::Log {
            return;
        }
        // A thread that finds another one at the clock leaves the line to it.
        let Ok(mut last) = self.last_line.try_lock() else {
            return;
        };
        if last.elapsed() >= LINE_PERIOD {
            *last = Instant::now();
            tell(&self.line());
        }
    }

    fn line(&self) -> String {
        let (done, total) = (self.bar.position(), self.bar.length().unwrap_or(0));
        let message = self.bar.message();
        format!(
            "{}: {done}/{total} {}, {:.1}/s, {} left {message}",
            self.what,
            self.unit,
            self.bar.per_sec(),
            HumanDuration(self.bar.eta()),
        )
        .trim_end()
        .to_owned()
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        if !self.bar.is_finished() {
            self.bar.finish_and_clear();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_says_what_how_far_and_how_much_is_left() {
        let progress = Audience::Nobody.start("collect", 10, "episodes");
        progress.advance(4);
        progress.message("seed 3");
        let line = progress.line();
        assert!(line.starts_with("collect: 4/10 episodes"), "{line}");
        assert!(line.ends_with("left seed 3"), "{line}");
    }

    #[test]
    fn machines_are_told_nothing() {
        assert_eq!(Audience::detect(true), Audience::Nobody);
    }
}
