//! Keeps the last lines that a process wrote to its standard error, for the message about its end.

use std::collections::VecDeque;
use std::fmt;
use std::io::{BufRead, BufReader, Read};
use std::sync::mpsc::{Receiver, channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::Duration;

const LINES: usize = 20;
/// A process that is dead has no more to say; but a child of its own may hold the stream open.
const WAIT_FOR_END: Duration = Duration::from_secs(1);

/// Listens to a stream on a thread of its own until the stream ends.
#[derive(Debug)]
pub struct Listener {
    lines: Arc<Mutex<VecDeque<String>>>,
    ended: Receiver<()>,
}

impl Listener {
    /// Listens to this one.
    pub fn new(stream: impl Read + Send + 'static) -> Self {
        let lines = Arc::new(Mutex::new(VecDeque::new()));
        let (end, ended) = channel();
        let kept = Arc::clone(&lines);
        thread::spawn(move || {
            let mut stream = BufReader::new(stream);
            let mut line = Vec::new();
            while matches!(stream.read_until(b'\n', &mut line), Ok(count) if count > 0) {
                let mut kept = lock(&kept);
                if kept.len() == LINES {
                    kept.pop_front();
                }
                kept.push_back(String::from_utf8_lossy(&line).trim_end().to_owned());
                line.clear();
            }
            // Nobody may be listening any more, and that is fine.
            end.send(()).ok();
        });
        Self { lines, ended }
    }

    /// What the process said last, complete if it is dead.
    #[must_use]
    pub fn words(&self) -> LastWords {
        self.ended.recv_timeout(WAIT_FOR_END).ok();
        LastWords(lock(&self.lines).iter().cloned().collect())
    }
}

fn lock(lines: &Mutex<VecDeque<String>>) -> MutexGuard<'_, VecDeque<String>> {
    lines.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The last lines of a process, shown after a message about it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct LastWords(Vec<String>);

impl fmt::Display for LastWords {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.0.is_empty() {
            return f.write_str("; it left no words");
        }
        f.write_str("; its last words:")?;
        self.0.iter().try_for_each(|line| write!(f, "\n  | {line}"))
    }
}
