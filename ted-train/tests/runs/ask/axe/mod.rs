//! What makes a page hard to use without eyes or a mouse, as axe-core finds it.

use std::fs;
use std::path::Path;
use std::process::Command;
use std::sync::OnceLock;

use firmware_sim::bridge::environment::interpreter;

/// The name says the version, so that another one is fetched when it changes.
const NAME: &str = "axe-4.14.1.min.js";
/// Fetches it. The version stands in there as well.
const FETCH: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/runs/ask/axe/fetch.py");

/// The script, fetched on first use and kept among what is built.
pub fn script() -> &'static str {
    static SCRIPT: OnceLock<String> = OnceLock::new();
    SCRIPT.get_or_init(|| {
        let file = Path::new(env!("CARGO_TARGET_TMPDIR")).join(NAME);
        if !file.exists() {
            let python = interpreter().unwrap_or_else(|error| panic!("failed to {error}"));
            let mut fetch = Command::new(python.path);
            let status = fetch.args(["-Es", FETCH]).arg(&file).status().unwrap();
            assert!(status.success(), "axe-core is not to be had");
        }
        fs::read_to_string(file).unwrap()
    })
}

/// Looks at the whole page and gives each complaint in a line, to be called with axe there.
pub const EXAMINE: &str = "const [done] = [...arguments].slice(-1); \
    axe.run(document).then(found => done(found.violations.flatMap(rule => \
        rule.nodes.map(node => `${rule.id}: ${rule.help}: ${node.target} ${node.failureSummary}`))), \
    error => done([String(error)]));";
