//! Is there what emulated boards need? Nothing is built by asking.

use std::path::Path;
use std::process::{Command, Stdio};

use super::firmware::SCRIPT;
use super::{Board, Emulator};

/// One thing that was looked at.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BoardCheck {
    /// What was looked at.
    pub name: &'static str,
    /// What was found, or what is wrong and what to do about it.
    pub outcome: Result<String, String>,
}

/// Looks for QEMU and for a compiler of the firmware.
#[must_use]
pub fn diagnose() -> Vec<BoardCheck> {
    let emulator = Emulator::find();
    vec![
        BoardCheck {
            name: "qemu, for boards",
            outcome: emulator
                .map(|it| {
                    let unguarded = match it.is_guarded() {
                        true => "",
                        false => {
                            "; without setpriv of util-linux it is left running when this program is killed"
                        }
                    };
                    format!("{} {}{unguarded}", it.path().display(), it.version())
                })
                .map_err(|error| error.to_string()),
        },
        BoardCheck {
            name: "compiler, for boards",
            outcome: toolchain(),
        },
    ]
}

/// What the script that builds images says it would take.
fn toolchain() -> Result<String, String> {
    let script = Path::new(SCRIPT);
    if !script.is_file() {
        return Err("the sources of this program are not on this machine".to_owned());
    }
    let output = Command::new(script)
        .arg("--which")
        .args(Board::ALL.map(Board::name))
        .stdin(Stdio::null())
        .output()
        .map_err(|error| format!("run {SCRIPT}: {error}"))?;
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).trim().to_owned();
    if output.status.success() {
        Ok(text(&output.stdout).lines().collect::<Vec<_>>().join("; "))
    } else {
        Err(text(&output.stderr))
    }
}
