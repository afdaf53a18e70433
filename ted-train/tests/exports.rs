//! Exported policies by the readers that everybody uses: a C and a C++ compiler, onnxruntime, and safetensors with numpy. What runs is
//! the code of `docs/export.md`, and what comes out is compared with the artefact's golden vectors and with `ted-core`.
//!
//! The Python packages are installed at locked versions into a virtual environment of its own, once, under the target folder;
//! `TED_EXPORTS_VENV` names another place for it. In `exports/`, `requirements.lock` is made from `requirements.in` by
//!
//! ```sh
//! uv pip compile --universal --python-version 3.11 --generate-hashes --no-emit-index-url \
//!     --only-binary :all: --no-header -o requirements.lock requirements.in
//! ```

#[path = "exports/robots.rs"]
mod robots;
mod venv;

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use rand::RngExt;
use serde_json::Value;
use ted_core::{Output, Scratch};
use ted_policy::{Artifact, ArtifactBytes, SafeAction};
use ted_train::export::Portable;
use ted_train::inspect::inspect;
use ted_train::rng::Seed;
use ted_train::tolerance::{EXPORTED, EXPORTED_C, EXPORTED_SUMS, Tolerance};

const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/exports");
const DOCUMENT: &str = include_str!("../../docs/export.md");

/// Observations beside the golden ones.
const RANDOM: usize = 500;

/// How the header is compiled, as C and as C++: every warning is an error. Fused products would be other sums.
const STRICT: [&str; 6] = [
    "-Wall",
    "-Wextra",
    "-Wpedantic",
    "-Werror",
    "-O2",
    "-ffp-contract=off",
];
const COMPILERS: [&[&str]; 2] = [&["cc", "-std=c99"], &["c++", "-x", "c++", "-std=c++11"]];

#[test]
fn a_compiled_header_gives_the_golden_actions_in_c_and_in_cpp() {
    for (name, bytes) in robots::all() {
        let artifact = Artifact::parse(&bytes).unwrap();
        let folder = exported(&artifact, Portable::CHeader);
        let cases = Cases::of(&artifact);
        for compiler in COMPILERS {
            let program = compiled(compiler, folder.path(), &Path::new(FOLDER).join("run.c"));
            let input: Vec<u8> = bytemuck::cast_slice(cases.observations.as_slice()).to_vec();
            let output = said(Command::new(&program), &input);
            let actions: Vec<f32> = output
                .chunks_exact(4)
                .map(|number| f32::from_le_bytes(number.try_into().unwrap()))
                .collect();
            cases.assert_near(&actions, EXPORTED_C, name);
            if artifact.policy().mlp().output() == Output::Linear {
                cases.assert_near(&actions, EXPORTED_SUMS, name);
                cases.assert_some_are_limited_and_some_are_not();
            }
        }
    }
}

#[test]
fn a_compiled_header_has_the_contract_whatever_its_texts_are() {
    for (name, bytes) in robots::all() {
        let artifact = Artifact::parse(&bytes).unwrap();
        let folder = exported(&artifact, Portable::CHeader);
        for compiler in COMPILERS {
            let program = compiled(compiler, folder.path(), &Path::new(FOLDER).join("run.c"));
            let mut command = Command::new(&program);
            command.arg("contract");
            let text = String::from_utf8(said(command, &[])).unwrap();
            let said: Vec<&str> = text.split_terminator('\0').collect();
            assert_eq!(said, contract_parts(&artifact), "{name}");
        }
    }
}

#[test]
fn onnxruntime_gives_the_golden_actions_and_the_contract() {
    python_agrees(Portable::Onnx, 0);
}

#[test]
fn safetensors_and_numpy_give_the_golden_actions_and_the_contract() {
    python_agrees(Portable::Safetensors, 1);
}

#[test]
fn the_c_program_of_the_document_names_every_action() {
    let bytes = robots::all().into_iter().next().unwrap().1;
    let artifact = Artifact::parse(&bytes).unwrap();
    let folder = exported(&artifact, Portable::CHeader);
    let source = folder.path().join("fly.c");
    fs::write(&source, code("c", 0)).unwrap();
    for compiler in COMPILERS {
        let program = compiled(compiler, folder.path(), &source);
        let text = String::from_utf8(said(Command::new(program), &[])).unwrap();
        let named: Vec<&str> = text
            .lines()
            .map(|line| line.split_once(" = ").unwrap().0)
            .collect();
        assert_eq!(named, ["move_x", "move_y", "gripper"], "{text}");
    }
}

#[test]
fn the_same_artefact_gives_the_same_bytes() {
    for (name, bytes) in robots::all() {
        let artifact = Artifact::parse(&bytes).unwrap();
        let copy = ArtifactBytes::from_vec(bytes.to_vec());
        let copy = Artifact::parse(&copy).unwrap();
        for format in Portable::ALL {
            assert!(format.bytes(&artifact) == format.bytes(&copy), "{name}");
        }
    }
}

/// Observations, and the actions in the robot's units that belong to them.
struct Cases {
    channels: usize,
    observations: Vec<f32>,
    actions: Vec<f32>,
    /// The range of each action channel.
    ranges: Vec<(f32, f32)>,
}

impl Cases {
    /// The golden vectors of an artefact, and random observations inside the contract's ranges.
    fn of(artifact: &Artifact<'_>) -> Self {
        let contract = artifact.contract();
        let policy = artifact.policy();
        let (mut observations, mut units) = (Vec::new(), Vec::new());
        for case in artifact.golden().cases() {
            observations.extend_from_slice(case.obs_raw);
            units.extend_from_slice(case.action_unit);
        }
        let mut rng = Seed::root(3).child("observations").rng();
        let mut scratch = Scratch::new();
        for _ in 0..RANDOM {
            let channels = contract.observation.iter();
            let obs_raw: Vec<f32> = channels
                .map(|it| it.low + (it.high - it.low) * rng.random::<f32>())
                .collect();
            let mut unit = vec![0.0; contract.action.len()];
            policy.act(&obs_raw, &mut scratch, &mut unit).unwrap();
            observations.extend(obs_raw);
            units.extend(unit);
        }
        let native = |(unit, range): (&f32, (f32, f32))| {
            let (middle, half) = ((range.0 + range.1) / 2.0, (range.1 - range.0) / 2.0);
            (middle + half * unit).clamp(range.0, range.1)
        };
        let ranges: Vec<_> = contract.action.iter().map(|it| (it.low, it.high)).collect();
        Self {
            channels: contract.observation.len(),
            observations,
            actions: units
                .iter()
                .zip(ranges.iter().copied().cycle())
                .map(native)
                .collect(),
            ranges,
        }
    }

    /// Otherwise a limit that is left out would not show, or nothing else would.
    fn assert_some_are_limited_and_some_are_not(&self) {
        let ends = self.actions.iter().zip(self.ranges.iter().cycle());
        let limited = ends
            .filter(|(action, (low, high))| *action == low || *action == high)
            .count();
        let all = self.actions.len();
        assert!(
            (all / 10..all * 9 / 10).contains(&limited),
            "{limited} of {all}"
        );
    }

    #[track_caller]
    fn assert_near(&self, actions: &[f32], tolerance: Tolerance, name: &str) {
        assert_eq!(actions.len(), self.actions.len(), "{name}");
        let pairs = || actions.iter().zip(&self.actions);
        let unequal = pairs().filter(|(a, b)| a.to_bits() != b.to_bits()).count() as u64;
        let distances = pairs()
            .zip(self.ranges.iter().cycle())
            .map(|((a, b), range)| (a - b).abs() / range.0.abs().max(range.1.abs()));
        // A NaN is as far as can be.
        let far = distances.fold(0.0, |far, it| if far >= it { far } else { it });
        let far = f64::from(far);
        assert!(
            tolerance.allowed.holds(far, unequal),
            "{name}: {}: {far:e} apart, {unequal} unequal",
            tolerance.what
        );
    }
}

/// A folder with the policy in this format, under the name that the document has for it.
fn exported(artifact: &Artifact<'_>, format: Portable) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let name = format!("policy.{}", format.extension());
    fs::write(folder.path().join(name), format.bytes(artifact)).unwrap();
    folder
}

/// A block of code of the document.
fn code(language: &str, index: usize) -> &'static str {
    let blocks = DOCUMENT.split("```").skip(1).step_by(2);
    blocks
        .filter_map(|block| block.strip_prefix(language)?.strip_prefix('\n'))
        .nth(index)
        .unwrap()
}

fn compiled(compiler: &[&str], folder: &Path, source: &Path) -> PathBuf {
    let program = folder.join("program");
    let built = Command::new(compiler[0])
        .args(&compiler[1..])
        .args(STRICT)
        .arg("-I")
        .arg(folder)
        .arg(source)
        .arg("-o")
        .arg(&program)
        .arg("-lm")
        .output()
        .unwrap();
    let told = String::from_utf8_lossy(&built.stderr);
    assert!(built.status.success(), "{compiler:?}: {told}");
    program
}

/// What a program says when it is given this.
fn said(mut command: Command, input: &[u8]) -> Vec<u8> {
    let mut child = command
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut stdin = child.stdin.take().unwrap();
    std::thread::scope(|scope| {
        // Whoever ends early says why on standard error.
        scope.spawn(move || stdin.write_all(input).ok());
        let output = child.wait_with_output().unwrap();
        let told = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{command:?}: {told}");
        output.stdout
    })
}

/// Runs a block of Python of the document on every robot.
fn python_agrees(format: Portable, block: usize) {
    let folder = Path::new(FOLDER);
    let python = venv::python("exports", &folder.join("requirements.lock"));
    for (name, bytes) in robots::all() {
        let artifact = Artifact::parse(&bytes).unwrap();
        let place = exported(&artifact, format);
        fs::write(place.path().join("code.py"), code("python", block)).unwrap();
        let artefact = place.path().join("policy.ted");
        fs::write(&artefact, &*bytes).unwrap();
        let cases = Cases::of(&artifact);
        let rows: Vec<&[f32]> = cases.observations.chunks(cases.channels).collect();
        let mut command = Command::new(python);
        command
            .current_dir(place.path())
            .arg("-Es")
            .arg(folder.join("actions.py"))
            .arg("code.py");
        let output = said(command, &serde_json::to_vec(&rows).unwrap());
        let output: Value = serde_json::from_slice(&output).unwrap();
        let actions: Vec<Vec<f32>> = serde_json::from_value(output["actions"].clone()).unwrap();
        cases.assert_near(&actions.concat(), EXPORTED, name);
        assert_eq!(output["contract"], contract(&artefact), "{name}");
    }
}

/// The contract of an artefact as `ted inspect --json` has it, without the normaliser.
fn contract(artefact: &Path) -> Value {
    let text = serde_json::to_string(&inspect(artefact).unwrap()).unwrap();
    let mut contract = serde_json::from_str::<Value>(&text).unwrap()["contract"].take();
    for channel in contract["observation"].as_array_mut().unwrap() {
        let channel = channel.as_object_mut().unwrap();
        assert!(channel.remove("shift").is_some() && channel.remove("scale").is_some());
    }
    contract
}

/// The contract as `run.c` prints it.
fn contract_parts(artifact: &Artifact<'_>) -> Vec<String> {
    let contract = artifact.contract();
    let number = |value: f32| format!("{:08x}", value.to_bits());
    let mut parts = vec![
        contract.task.to_owned(),
        contract.control_period_us.to_string(),
        contract.max_observation_age_us.to_string(),
        u8::from(contract.declared).to_string(),
    ];
    for it in &contract.observation {
        parts.extend([it.name.to_string(), it.unit.to_string()]);
        parts.extend([it.low, it.high].map(number));
    }
    for it in &contract.action {
        parts.extend([it.name.to_string(), it.unit.to_string()]);
        parts.extend([it.low, it.high, it.slew_per_tick].map(number));
        let on_fault = match it.on_fault {
            SafeAction::Zero => "zero".to_owned(),
            SafeAction::HoldLast => "hold-last".to_owned(),
            SafeAction::Value(value) => number(value),
        };
        parts.push(on_fault);
    }
    parts
}
