//! The built commands, which cargo gives only to tests of their own packages.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// The command of this name that was built together with this test.
pub fn command(name: &str) -> Command {
    Command::new(binary(name))
}

/// Runs a command that must end with one of these codes; gives its standard output.
#[track_caller]
pub fn said(command: &mut Command, codes: &[i32]) -> String {
    let Output {
        status,
        stdout,
        stderr,
    } = command.output().unwrap();
    let stdout = String::from_utf8(stdout).unwrap();
    let code = status.code().unwrap_or(-1);
    assert!(
        codes.contains(&code),
        "{code}: {stdout}{}",
        String::from_utf8_lossy(&stderr)
    );
    stdout
}

/// Tests lie in `target/<profile>/deps`, commands beside that folder.
fn binary(name: &str) -> PathBuf {
    let test = std::env::current_exe().unwrap();
    let profile = test.parent().and_then(Path::parent).unwrap();
    let binary = profile
        .join(name)
        .with_extension(std::env::consts::EXE_EXTENSION);
    let way_out = "run `cargo test --release --workspace`, or build the commands first";
    let built = fs::metadata(&binary).and_then(|m| m.modified());
    let built = built.unwrap_or_else(|_| panic!("no {}: {way_out}", binary.display()));
    // Cargo lists there what the command was made from; a build that shares its outputs may leave the list out.
    let Ok(sources) = fs::read_to_string(profile.join(name).with_extension("d")) else {
        return binary;
    };
    let (_, sources) = sources.split_once(": ").unwrap();
    // A space inside a path is escaped, as in a makefile.
    let sources = sources.trim_end().replace("\\ ", "\0");
    for source in sources.split(' ').map(|path| path.replace('\0', " ")) {
        let changed = fs::metadata(&source).and_then(|m| m.modified());
        assert!(
            changed.is_ok_and(|changed| changed <= built),
            "{name} is older than {source}: {way_out}"
        );
    }
    binary
}
