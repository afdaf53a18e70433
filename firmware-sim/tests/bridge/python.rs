//! Runs the tests that are written in Python.

use std::path::Path;
use std::process::Command;

use crate::fake::{bridge, python};

/// Runs a test script and shows what it said if it fails.
pub fn passes(python: &Path, script: &str) {
    let output = Command::new(python)
        .arg("-Es")
        .arg(bridge().join(script))
        .output()
        .expect("python starts");
    assert!(
        output.status.success(),
        "{script}:\n{}",
        String::from_utf8_lossy(&output.stderr)
    );
}

#[test]
fn the_python_side_has_the_document_s_golden_frames() {
    passes(&python(), "test_wire.py");
}
