//! Dataset ids, `namespace/name-vN`, by the rules of the Minari package.

use crate::dataset::DatasetError;
use std::fmt;
use std::path::{Path, PathBuf};
use std::str::FromStr;

/// A dataset id: where under a root the dataset lies, and what it is called.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct DatasetId {
    namespace: String,
    name: String,
    version: u32,
}

impl DatasetId {
    /// `namespace/name-vVERSION`.
    pub fn new(namespace: &str, name: &str, version: u32) -> Result<Self, DatasetError> {
        format!("{namespace}/{name}-v{version}").parse()
    }

    /// The namespace.
    #[must_use]
    pub fn namespace(&self) -> &str {
        &self.namespace
    }

    /// The name, without namespace and version.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The dataset's folder under `root`.
    #[must_use]
    pub fn folder(&self, root: &Path) -> PathBuf {
        root.join(&self.namespace)
            .join(format!("{}-v{}", self.name, self.version))
    }
}

impl FromStr for DatasetId {
    type Err = DatasetError;

    fn from_str(id: &str) -> Result<Self, DatasetError> {
        let refuse = |reason| DatasetError::Id {
            id: id.into(),
            reason,
        };
        let word =
            |character: char| character.is_alphanumeric() || character == '_' || character == '-';
        let (namespace, rest) = id
            .rsplit_once('/')
            .ok_or_else(|| refuse("it has no namespace"))?;
        let (name, version) = rest
            .rsplit_once("-v")
            .ok_or_else(|| refuse("it has no version"))?;
        let version = version
            .parse()
            .map_err(|_| refuse("its version is not a number"))?;
        let parts_are_words = namespace
            .split('/')
            .all(|part| !part.is_empty() && part.chars().all(word));
        if namespace.len() < 2 || !parts_are_words {
            return Err(refuse(
                "its namespace may hold letters, digits, - and _, at least two",
            ));
        }
        if name.is_empty() || !name.chars().all(word) {
            return Err(refuse("its name may hold letters, digits, - and _"));
        }
        Ok(Self {
            namespace: namespace.into(),
            name: name.into(),
            version,
        })
    }
}

impl fmt::Display for DatasetId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}-v{}", self.namespace, self.name, self.version)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_survive_a_round_trip() {
        let id = DatasetId::new("ted", "drawer-open-v3-paper-s0", 0).unwrap();
        assert_eq!(id.to_string(), "ted/drawer-open-v3-paper-s0-v0");
        assert_eq!(id.to_string().parse::<DatasetId>().unwrap(), id);
        assert_eq!(
            id.folder(Path::new("data")),
            Path::new("data/ted/drawer-open-v3-paper-s0-v0")
        );
    }

    #[test]
    fn ids_that_minari_or_the_file_system_would_misread_are_refused() {
        for id in [
            "x-v0",
            "ted/x",
            "ted/x-vy",
            "ted/../x-v0",
            "ted/x y-v0",
            "t/x-v0",
            "/x-v0",
            "ted//a/x-v0",
            "ted/-v",
        ] {
            assert!(id.parse::<DatasetId>().is_err(), "{id}");
        }
    }
}
