//! Logs that are no dataset of ours, but could be made one: whoever names them is told how.

use std::path::Path;

use crate::dataset::DatasetError;

/// Files by the end of their names: what they are, and what their import needs besides.
const FILES: [(&str, &str, &str); 7] = [
    ("hdf5", "an HDF5 file", ""),
    ("h5", "an HDF5 file", ""),
    ("npz", "a file of numpy's arrays", ""),
    ("csv", "a table", " --map map.toml"),
    ("jsonl", "a table", " --map map.toml"),
    ("mcap", "a recording of messages", " --map map.toml"),
    ("db3", "a recording of messages", " --map map.toml"),
];

/// Folders by a file in them.
const FOLDERS: [(&str, &str, &str); 2] = [
    ("meta/info.json", "a LeRobot dataset", ""),
    ("metadata.yaml", "a rosbag2 recording", " --map map.toml"),
];

/// The error that says how to import this file or folder; none if it is nothing that `ted import` reads.
pub(crate) fn foreign(path: &Path) -> Option<DatasetError> {
    let of_folder = FOLDERS.iter().find(|(file, ..)| path.join(file).is_file());
    let end = path.extension().unwrap_or_default().to_ascii_lowercase();
    let of_file = FILES.iter().find(|(known, ..)| end == *known);
    let of_file = of_file.filter(|_| path.is_file());
    let &(_, what, options) = of_folder.or(of_file)?;
    Some(DatasetError::NotImported {
        path: path.to_path_buf(),
        what,
        options,
    })
}

#[cfg(test)]
mod tests {
    use std::fs;

    use crate::dataset::Dataset;

    #[test]
    fn whoever_names_logs_that_can_be_imported_is_told_the_command() {
        let place = tempfile::tempdir().unwrap();
        fs::create_dir_all(place.path().join("lerobot/meta")).unwrap();
        fs::create_dir_all(place.path().join("bag")).unwrap();
        let cases = [
            ("logs.hdf5", "logs.hdf5", "an HDF5 file", ""),
            ("LOGS.H5", "LOGS.H5", "an HDF5 file", ""),
            ("logs.npz", "logs.npz", "a file of numpy's arrays", ""),
            ("logs.csv", "logs.csv", "a table", " --map map.toml"),
            ("logs.jsonl", "logs.jsonl", "a table", " --map map.toml"),
            (
                "a.mcap",
                "a.mcap",
                "a recording of messages",
                " --map map.toml",
            ),
            (
                "bag/b.db3",
                "bag/b.db3",
                "a recording of messages",
                " --map map.toml",
            ),
            (
                "bag/metadata.yaml",
                "bag",
                "a rosbag2 recording",
                " --map map.toml",
            ),
            ("lerobot/meta/info.json", "lerobot", "a LeRobot dataset", ""),
        ];
        for (file, named, what, options) in cases {
            fs::write(place.path().join(file), "").unwrap();
            let named = place.path().join(named);
            let said = Dataset::open(&named).unwrap_err().to_string();
            let named = named.display();
            assert_eq!(
                said,
                format!(
                    "{named} is {what}, and no dataset yet: `ted import {named}{options}` makes one of it"
                )
            );
        }
        fs::write(place.path().join("logs.txt"), "").unwrap();
        for other in ["logs.txt", "not-there.csv"] {
            let said = Dataset::open(place.path().join(other)).unwrap_err();
            assert!(said.to_string().starts_with("no dataset at"), "{said}");
        }
    }
}
