//! `ted export`: the policy of a run for other programs, and what is refused.

use std::fs;

use firmware_sim::plants::toy;
use serde_json::Value;

use crate::command::{Desk, finish, limited, ted};

const FORMATS: [(&str, &str); 3] = [
    ("onnx", "policy.onnx"),
    ("safetensors", "policy.safetensors"),
    ("c-header", "policy.h"),
];

#[test]
fn a_run_is_exported_beside_its_artefact_which_stays_as_it_is() {
    let desk = Desk::with_dataset();
    finish(&mut desk.train("run", "true", &[])).with(0);
    let run = desk.run("run");
    let artefact = fs::read(run.join("policy.ted")).unwrap();
    for (format, name) in FORMATS {
        let export = || {
            let mut command = ted();
            command.arg("export").arg(&run).args(["--to", format]);
            command
        };
        let text = finish(&mut export()).with(0).said;
        assert!(text.starts_with("wrote ") && text.contains(name), "{text}");
        let file = run.join(name);
        let bytes = fs::read(&file).unwrap();

        let again: Value =
            serde_json::from_str(&finish(export().arg("--json")).with(0).said).unwrap();
        assert_eq!(again["to"], format);
        assert_eq!(again["unchanged"], true);
        assert_eq!(again["bytes"], bytes.len());
        assert_eq!(again["file"], file.to_str().unwrap());

        // What is there is replaced.
        fs::write(&file, "something else").unwrap();
        finish(&mut export()).with(0);
        assert!(fs::read(&file).unwrap() == bytes);

        let elsewhere = desk.run("elsewhere");
        finish(export().arg("--out").arg(&elsewhere)).with(0);
        assert!(fs::read(&elsewhere).unwrap() == bytes);
    }
    assert!(fs::read(run.join("policy.ted")).unwrap() == artefact);

    // The artefact alone will do, as long as it is not what is written.
    finish(
        ted()
            .arg("export")
            .arg(run.join("policy.ted"))
            .args(["--to", "onnx", "--out"])
            .arg(desk.run("alone.onnx")),
    )
    .with(0);
    assert!(
        fs::read(desk.run("alone.onnx")).unwrap() == fs::read(run.join("policy.onnx")).unwrap()
    );
    finish(
        ted()
            .arg("export")
            .arg(&run)
            .args(["--to", "onnx", "--out"])
            .arg(run.join("policy.ted")),
    )
    .with(2)
    .telling("would be lost");
    assert!(fs::read(run.join("policy.ted")).unwrap() == artefact);

    fs::remove_file(run.join("policy.ted")).unwrap();
    finish(ted().arg("export").arg(&run).args(["--to", "onnx"]))
        .with(3)
        .telling("`ted export` makes the artefact of a finished run again");
}

#[test]
fn what_cannot_be_exported_is_refused_with_the_reason() {
    let desk = Desk::new();
    let at = |name: &str| desk.run(name);
    let export = |arguments: &[&str]| {
        let mut command = ted();
        command.arg("export").current_dir(desk.folder.path());
        finish(command.args(arguments))
    };
    fs::write(at("toy.ted"), toy::artifact_bytes().unwrap()).unwrap();
    export(&["toy.ted", "--to", "tflite"])
        .with(2)
        .telling("[possible values: ted, onnx, safetensors, c-header]");
    export(&["toy.ted"])
        .with(2)
        .telling("policy.ted is made from the folder of a run");
    export(&["toy.ted", "--to", "onnx", "--dataset", "reach-v3"])
        .with(2)
        .telling("leave it out");
    export(&["nowhere", "--to", "onnx"])
        .with(3)
        .telling("is this the folder of a run?");
    export(&["toy.ted", "--to", "onnx", "--out", "no/toy.onnx"])
        .with(6)
        .telling("cannot write no/toy.onnx");

    let mut damaged = toy::artifact_bytes().unwrap();
    let middle = damaged.len() / 2;
    damaged[middle] ^= 1;
    fs::write(at("damaged.ted"), damaged).unwrap();
    export(&["damaged.ted", "--to", "c-header"])
        .with(3)
        .telling("damaged.ted is not a valid artefact");
    assert!(!at("damaged.h").exists());
}

#[test]
fn an_export_that_does_not_fit_leaves_the_file_that_was_there() {
    let desk = Desk::new();
    fs::write(desk.run("toy.ted"), toy::artifact_bytes().unwrap()).unwrap();
    fs::write(desk.run("toy.h"), "an older one").unwrap();
    let mut command = ted();
    command
        .current_dir(desk.folder.path())
        .args(["export", "toy.ted", "--to", "c-header"]);
    // The header has five kilobytes.
    finish(&mut limited(&command, 4))
        .with(6)
        .telling("no space left while writing toy.h");
    assert_eq!(fs::read(desk.run("toy.h")).unwrap(), b"an older one");
    let left = fs::read_dir(desk.folder.path()).unwrap().count();
    assert_eq!(left, 2, "nothing half written is left");
}
