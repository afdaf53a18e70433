//! The commands as a user meets them: boards in the table, and what is said when something is missing.

use std::fs;
use std::path::Path;
use std::process::Command;

use serde_json::Value;

fn firmware_sim(folder: &Path, variables: &[(&str, &Path)], args: &[&str]) -> (i32, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_firmware-sim"))
        .current_dir(folder)
        .envs(variables.iter().copied())
        .args(args)
        .output()
        .unwrap();
    let text = [output.stdout, output.stderr].concat();
    let code = output.status.code().unwrap();
    (code, String::from_utf8(text).unwrap())
}

fn folder_with_toy() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let (code, words) = firmware_sim(folder.path(), &[], &["toy", "toy.ted"]);
    assert_eq!(code, 0, "{words}");
    folder
}

const FLY: [&str; 8] = [
    "fly",
    "toy.ted",
    "--plant",
    "toy",
    "--episodes",
    "2",
    "--on",
    "mps2-an386",
];

#[test]
fn a_flight_on_a_board_says_what_the_host_s_says_and_what_it_took() {
    let folder = folder_with_toy();
    let (code, table) = firmware_sim(folder.path(), &[], &FLY);
    assert_eq!(code, 0, "{table}");
    for part in [
        "2 episodes of toy-reach on toy",
        "board       mps2-an386 in QEMU",
        "instructions a tick",
        "stack",
        "0 asked again",
        "in the top k %",
    ] {
        assert!(table.contains(part), "{part}: {table}");
    }
    let json = |args: &[&str]| -> Value {
        let args = [args, &["--json"]].concat();
        let (code, text) = firmware_sim(folder.path(), &[], &args);
        assert_eq!(code, 0, "{text}");
        serde_json::from_str(&text).unwrap()
    };
    let (board, host) = (json(&FLY), json(&FLY[..6]));
    assert_eq!(board["episodes"], host["episodes"]);
    assert!(board["device"]["tick"]["mean"].as_f64().unwrap() > 100.0);
    assert!(host.get("device").is_none());
}

#[test]
fn logged_episodes_are_scored_on_every_board_as_on_the_host() {
    let folder = folder_with_toy();
    let record = [&FLY[..6], &["--record", "flight.json"]].concat();
    let (code, words) = firmware_sim(folder.path(), &[], &record);
    assert_eq!(code, 0, "{words}");
    let score = |on: &str, numeric: &str| -> Value {
        let args = ["score", "toy.ted", "--recording", "flight.json", "--json"];
        let seat = ["--on", on, "--numeric", numeric];
        let (code, text) = firmware_sim(folder.path(), &[], &[&args[..], &seat].concat());
        assert_eq!(code, 0, "{text}");
        serde_json::from_str(&text).unwrap()
    };
    for numeric in ["f32", "integer"] {
        let host = score("host", numeric);
        assert_eq!(host["episodes"].as_array().unwrap().len(), 2);
        for board in ["mps2-an386", "mps2-an500", "mps2-an505"] {
            let scored = score(board, numeric);
            // JSON holds the shortest decimal of each number, so these are the bits.
            assert_eq!(scored["episodes"], host["episodes"], "{board}");
            assert_eq!(
                (&scored["upload"], &scored["on"]),
                (&host["upload"], &board.into())
            );
        }
    }
}

#[test]
fn a_board_keeps_its_flash_in_a_file_and_takes_another_contract_only_when_told_to() {
    let folder = folder_with_toy();
    let flash = |policy: &str, more: &[&str]| {
        let args = ["flash", policy, "--on", "mps2-an386", "--flash-image", "f"];
        firmware_sim(folder.path(), &[], &[&args, more].concat())
    };
    let (code, words) = flash("toy.ted", &[]);
    assert_eq!(code, 0, "{words}");
    assert!(
        words.contains("mps2-an386 flies toy-reach from slot 0"),
        "{words}"
    );
    fs::write(folder.path().join("large.ted"), super::artefacts::large()).unwrap();
    let (code, words) = flash("large.ted", &[]);
    assert_eq!(code, 3, "{words}");
    assert!(words.contains("refused"), "{words}");
    let (code, words) = flash("large.ted", &["--accept-other-contract"]);
    assert_eq!(code, 0, "{words}");
    assert!(
        words.contains("flies drawer-open-v3 from slot 1"),
        "{words}"
    );
}

#[test]
fn an_emulator_that_is_not_there_is_named_with_the_way_to_get_it() {
    let folder = folder_with_toy();
    let nowhere = Path::new("/nowhere/qemu");
    let (code, words) = firmware_sim(folder.path(), &[("TED_QEMU", nowhere)], &FLY);
    assert_eq!(code, 4, "{words}");
    for part in ["/nowhere/qemu", "apt install qemu-system-arm", "TED_QEMU"] {
        assert!(words.contains(part), "{part}: {words}");
    }
}

#[test]
fn an_image_that_is_not_there_is_named() {
    let folder = folder_with_toy();
    let (code, words) = firmware_sim(folder.path(), &[("TED_FIRMWARE", folder.path())], &FLY);
    assert_eq!(code, 4, "{words}");
    assert!(
        words.contains("mps2-an386.elf: there is no such file"),
        "{words}"
    );
}

#[test]
fn an_emulator_that_ends_is_quoted() {
    let folder = folder_with_toy();
    fs::write(folder.path().join("mps2-an386.elf"), "no image").unwrap();
    let (code, words) = firmware_sim(folder.path(), &[("TED_FIRMWARE", folder.path())], &FLY);
    assert_eq!(code, 4, "{words}");
    assert!(words.contains("its last words"), "{words}");
}

#[test]
fn options_of_a_board_without_a_board_are_refused() {
    let folder = folder_with_toy();
    let args = [&FLY[..6], &["--link", "uart"]].concat();
    let (code, words) = firmware_sim(folder.path(), &[], &args);
    assert_eq!(code, 2, "{words}");
}
