//! A scorer at the other end of a link.

use std::io::{Read, Write};

use ted_core::DiscountClass;

use super::{Connection, RemoteError};
use crate::device::message::{Floats, Reply, Request, Start};
use crate::scoring::{Judge, ScoreError, Verdict};

/// Scores logged episodes with what is in the device's flash.
#[derive(Debug)]
pub struct RemoteScorer<S> {
    connection: Connection<S>,
    start: Start,
}

impl<S: Read + Write> RemoteScorer<S> {
    /// A scorer on the device at the other end of this link; no episode is started yet.
    #[must_use]
    pub fn new(connection: Connection<S>, start: Start) -> Self {
        Self { connection, start }
    }

    /// Gives the connection back.
    pub fn into_connection(self) -> Connection<S> {
        self.connection
    }
}

impl<S: Read + Write> Judge for RemoteScorer<S> {
    fn reset(&mut self) -> Result<(), ScoreError> {
        let asked = "start a logged episode on the device";
        match self.connection.ask(asked, &Request::Start(self.start))? {
            Reply::Done => Ok(()),
            _ => Err(RemoteError::Unexpected { asked }.into()),
        }
    }

    fn push(
        &mut self,
        observation: &[f32],
        action: &[f32],
        episode: u32,
    ) -> Result<Verdict, ScoreError> {
        let asked = "score a logged step on the device";
        let [observation, action] = [observation, action].map(le_bytes);
        let floats = |bytes| Floats::from_le_bytes(bytes).ok_or(RemoteError::TooLong { asked });
        let log = Request::Log {
            episode,
            observation: floats(&observation)?,
            action: floats(&action)?,
        };
        match self.connection.ask(asked, &log)? {
            Reply::Scored(score) => Ok(Verdict {
                return_hat: score.return_hat,
                class: match score.top_k {
                    true => DiscountClass::TopK,
                    false => DiscountClass::BelowTopK,
                },
            }),
            _ => Err(RemoteError::Unexpected { asked }.into()),
        }
    }
}

fn le_bytes(values: &[f32]) -> Vec<u8> {
    values
        .iter()
        .flat_map(|value| value.to_le_bytes())
        .collect()
}
