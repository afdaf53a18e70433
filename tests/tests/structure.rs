//! What ARCHITECTURE.md and CONTRIBUTING.md promise about the source itself.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

/// Each crate depends on the one before it and on nothing after it.
const LINE: [&str; 5] = [
    "ted-core",
    "ted-policy",
    "firmware-sim",
    "ted-train",
    "ted-tests",
];

/// The longest that a file may be.
const LINES: usize = 500;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap()
}

#[test]
fn the_crates_depend_on_each_other_in_one_line() {
    let output = Command::new(env!("CARGO"))
        .args([
            "metadata",
            "--no-deps",
            "--format-version",
            "1",
            "--offline",
        ])
        .current_dir(root())
        .output()
        .unwrap();
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let metadata: Value = serde_json::from_slice(&output.stdout).unwrap();
    let packages = metadata["packages"].as_array().unwrap();
    let mut names: Vec<&str> = packages
        .iter()
        .map(|p| p["name"].as_str().unwrap())
        .collect();
    names.sort_by_key(|name| LINE.iter().position(|member| member == name));
    assert_eq!(names, LINE, "the members of the workspace");
    for package in packages {
        let place = |name: &Value| LINE.iter().position(|member| name == member);
        let own = place(&package["name"]).unwrap();
        // Of every kind: a test or a build script must not turn the line around either.
        let dependencies = package["dependencies"].as_array().unwrap();
        let on: Vec<usize> = dependencies
            .iter()
            .filter_map(|d| place(&d["name"]))
            .collect();
        assert!(
            on.iter().all(|&other| other < own),
            "{} depends on a later crate",
            LINE[own]
        );
        assert!(
            own == 0 || on.contains(&(own - 1)),
            "{} skips the crate before it",
            LINE[own]
        );
    }
}

#[test]
fn no_module_of_the_trainer_needs_one_that_needs_it() {
    let source = root().join("ted-train/src");
    let lib = fs::read_to_string(source.join("lib.rs")).unwrap();
    let modules: Vec<&str> = lib
        .lines()
        .filter_map(|line| line.split_once("mod ")?.1.strip_suffix(';'))
        .collect();
    let mut needs: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
    for path in files(&["rs"]) {
        let Some(own) = path.strip_prefix(&source).ok().and_then(|path| {
            let top = path.iter().next()?.to_str()?;
            modules
                .iter()
                .find(|&&it| it == top.trim_end_matches(".rs"))
        }) else {
            continue;
        };
        needs
            .entry(own)
            .or_default()
            .extend(used(&path, &modules).filter(|other| other != own));
    }
    assert_eq!(needs.len(), modules.len(), "every module was found");
    // Whoever needs nobody that is left is in no circle, and neither is whom nobody needs that is left.
    while let Some(free) = needs.keys().copied().find(|name| {
        let needs_nobody = needs[name].iter().all(|it| !needs.contains_key(it));
        needs_nobody || !needs.values().any(|on| on.contains(name))
    }) {
        needs.remove(free);
    }
    let left: Vec<&str> = needs.keys().copied().collect();
    for on in needs.values_mut() {
        on.retain(|it| left.contains(it));
    }
    assert!(needs.is_empty(), "modules in circles: {needs:?}");
}

/// The modules that the code of a file names by `crate::`, its tests and comments left out.
fn used<'m>(path: &Path, modules: &[&'m str]) -> impl Iterator<Item = &'m str> {
    let is_test = path.iter().any(|part| part == "tests")
        || ["tests.rs", "fixtures.rs"]
            .iter()
            .any(|end| path.to_string_lossy().ends_with(end));
    let text = if is_test {
        String::new()
    } else {
        fs::read_to_string(path).unwrap()
    };
    let code = text
        .split("#[cfg(test)]\nmod tests {")
        .next()
        .unwrap_or_default();
    let code: Vec<&str> = code
        .lines()
        .filter(|line| !line.trim_start().starts_with("//"))
        .collect();
    let code = code.join("\n");
    let names: BTreeSet<String> = code
        .split("crate::")
        .skip(1)
        .map(|rest| {
            rest.chars()
                .take_while(|c| c.is_alphanumeric() || *c == '_')
                .collect()
        })
        .collect();
    let modules: Vec<&str> = modules
        .iter()
        .copied()
        .filter(|it| names.contains(*it))
        .collect();
    modules.into_iter()
}

#[test]
fn the_core_has_three_dependencies() {
    let manifest = fs::read_to_string(root().join("ted-core/Cargo.toml")).unwrap();
    let (_, dependencies) = manifest.split_once("\n[dependencies]\n").unwrap();
    let mut names: Vec<&str> = dependencies
        .lines()
        .take_while(|line| !line.starts_with('['))
        .filter_map(|line| line.split(['.', ' ', '=']).next())
        .filter(|name| !name.is_empty())
        .collect();
    names.sort_unstable();
    assert_eq!(names, ["heapless", "libm", "nalgebra"]);
    assert!(!manifest.contains("[build-dependencies]"));
}

#[test]
fn integer_inference_names_no_float_type() {
    let folder = root().join("ted-core/src/integer");
    for path in files(&["rs"]) {
        if path.starts_with(&folder) {
            let text = fs::read_to_string(&path).unwrap();
            let float = text.lines().find(|line| {
                let code = line.split("//").next().unwrap_or_default();
                code.contains("f32") || code.contains("f64")
            });
            assert_eq!(float, None, "{}", path.display());
        }
    }
}

#[test]
fn the_core_is_unsafe_in_named_files_only() {
    let root = root().join("ted-core/src");
    let lib = fs::read_to_string(root.join("lib.rs")).unwrap();
    assert!(lib.contains("#![deny(unsafe_code)]"));
    let mut allowed: Vec<PathBuf> = files(&["rs"])
        .into_iter()
        .filter(|path| path.starts_with(&root))
        .filter(|path| {
            let text = fs::read_to_string(path).unwrap();
            ["allow(unsafe_code)", "expect(unsafe_code)"]
                .iter()
                .any(|level| text.contains(level))
        })
        .collect();
    allowed.sort();
    // `x86/mod.rs` speaks for its folder.
    let named = ["cortex_m/assembly.rs", "x86/mod.rs"].map(|path| root.join(path));
    assert_eq!(allowed, named);
}

#[test]
fn the_document_on_devices_shows_the_table_of_faults() {
    let read = |path: &str| fs::read_to_string(root().join(path)).unwrap();
    let table = read("firmware-sim/tests/device_fault_table.txt");
    assert!(read("docs/device.md").contains(table.trim_end()));
}

#[test]
fn every_source_file_says_first_what_it_is() {
    for path in files(&["rs"]) {
        let text = fs::read_to_string(&path).unwrap();
        assert!(
            text.starts_with("//! "),
            "{} does not begin with //!",
            path.display()
        );
    }
    for path in files(&["py"]) {
        let text = fs::read_to_string(&path).unwrap();
        let after_shebang = text
            .strip_prefix("#!/usr/bin/env python3\n")
            .unwrap_or(&text);
        assert!(
            after_shebang.starts_with("\"\"\""),
            "{} has no docstring",
            path.display()
        );
    }
}

#[test]
fn no_file_is_longer_than_one_idea() {
    for path in files(&["rs", "py", "sh", "md", "toml"]) {
        let lines = fs::read_to_string(&path).unwrap().lines().count();
        assert!(lines <= LINES, "{} has {lines} lines", path.display());
    }
}

#[test]
fn no_test_is_switched_off_or_content_with_any_panic() {
    for path in files(&["rs"]) {
        let text = fs::read_to_string(&path).unwrap();
        for attribute in ["ignore", "should_panic"] {
            let written = format!("#[{attribute}");
            assert!(!text.contains(&written), "{} has {written}", path.display());
        }
    }
}

/// The project's own files with one of these extensions.
fn files(extensions: &[&str]) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut folders = vec![root().to_path_buf()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(&folder).unwrap() {
            let path = entry.unwrap().path();
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            let extension = path.extension().map(|e| e.to_string_lossy().into_owned());
            if path.is_dir() {
                // What .gitignore names, and what is hidden.
                let foreign = ["target", "runs", "data", "__pycache__"].contains(&name.as_str());
                if !foreign && !name.starts_with('.') {
                    folders.push(path);
                }
            } else if extension.is_some_and(|e| extensions.contains(&e.as_str())) {
                found.push(path);
            }
        }
    }
    assert!(
        found
            .iter()
            .any(|path| path.starts_with(root().join("ted-core")) || extensions != ["rs"])
    );
    found
}

/// What stands for Meta-World's robot: its numbers, its period, and names of its channels.
const META_WORLD: [&str; 6] = [
    "39",
    "12_500",
    "hand_dx",
    "gripper_opening",
    "observation_dim() ==",
    "action_dim() ==",
];

/// A fact about a robot is declared in its file. Tests, timings and golden frames may be of any robot.
#[test]
fn nothing_is_told_from_a_shape_and_no_fact_of_meta_world_is_outside_its_folder() {
    let mut found = Vec::new();
    for file in files(&["rs"]) {
        let name = file.strip_prefix(root()).unwrap().display().to_string();
        let free = [
            "ted-core/",
            "tests",
            "/bench/",
            "golden.rs",
            "firmware-sim/firmware/",
        ];
        if free.iter().any(|free| name.contains(free)) {
            continue;
        }
        let text = fs::read_to_string(&file).unwrap();
        let code = text.split("#[cfg(test)]").next().unwrap();
        for line in code
            .lines()
            .filter(|line| !line.trim_start().starts_with("//"))
        {
            let whole = |word: &str| {
                let other = |c: char| !(c.is_alphanumeric() || c == '_' || c == '.');
                line.split(other).any(|part| part == word)
            };
            let hit = |word: &&&str| whole(word) || word.contains('(') && line.contains(**word);
            if let Some(word) = META_WORLD.iter().find(hit) {
                found.push(format!("{name}: {word}: {}", line.trim()));
            }
        }
    }
    assert!(found.is_empty(), "{}", found.join("\n"));
}
