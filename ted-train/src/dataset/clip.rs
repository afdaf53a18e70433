//! How much of an episode somebody is shown: a number of steps, or all of it.

use std::fmt;

use serde::de::{Error, Unexpected, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// What a segment is to be; in a configuration a number of steps, or `"episode"`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Clip {
    /// So many consecutive steps, anywhere in an episode.
    Steps(u32),
    /// A whole episode, however long it is.
    Episode,
}

/// How a configuration writes a whole episode.
const EPISODE: &str = "episode";

impl Serialize for Clip {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Steps(steps) => steps.serialize(serializer),
            Self::Episode => EPISODE.serialize(serializer),
        }
    }
}

impl<'de> Deserialize<'de> for Clip {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(Written)
    }
}

/// Reads what a configuration says.
struct Written;

impl Visitor<'_> for Written {
    type Value = Clip;

    fn expecting(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "a number of steps or {EPISODE:?}")
    }

    fn visit_u64<E: Error>(self, steps: u64) -> Result<Clip, E> {
        let fits = u32::try_from(steps).map(Clip::Steps);
        fits.map_err(|_| E::invalid_value(Unexpected::Unsigned(steps), &self))
    }

    fn visit_i64<E: Error>(self, steps: i64) -> Result<Clip, E> {
        let fits = u32::try_from(steps).map(Clip::Steps);
        fits.map_err(|_| E::invalid_value(Unexpected::Signed(steps), &self))
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<Clip, E> {
        match text {
            EPISODE => Ok(Clip::Episode),
            _ => Err(E::invalid_value(Unexpected::Str(text), &self)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Debug, PartialEq, Serialize, Deserialize)]
    struct Config {
        segment: Clip,
    }

    #[test]
    fn a_clip_is_written_as_a_number_or_as_a_word_and_read_back() {
        for (segment, toml, json) in [
            (Clip::Steps(50), "segment = 50\n", "{\"segment\":50}"),
            (
                Clip::Episode,
                "segment = \"episode\"\n",
                "{\"segment\":\"episode\"}",
            ),
        ] {
            let config = Config { segment };
            assert_eq!(toml::to_string(&config).unwrap(), toml);
            assert_eq!(toml::from_str::<Config>(toml).unwrap(), config);
            assert_eq!(serde_json::to_string(&config).unwrap(), json);
            assert_eq!(serde_json::from_str::<Config>(json).unwrap(), config);
        }
    }

    #[test]
    fn what_is_no_clip_is_refused_with_what_is_one() {
        for (text, part) in [
            ("segment = -1", "integer `-1`"),
            ("segment = 5000000000", "integer `5000000000`"),
            ("segment = \"film\"", "string \"film\""),
            ("segment = 1.5", "floating point `1.5`"),
        ] {
            let error = toml::from_str::<Config>(text).unwrap_err().to_string();
            assert!(error.contains(part), "{error}");
            assert!(
                error.contains("a number of steps or \"episode\""),
                "{error}"
            );
        }
    }
}
