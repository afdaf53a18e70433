//! Hands the board's memory map to the linker script of cortex-m-rt.

use std::env;
use std::fs;
use std::path::Path;

/// The boards that have a memory map.
const BOARDS: [&str; 3] = ["mps2-an386", "mps2-an500", "mps2-an505"];

fn main() {
    let chosen = |board: &&str| {
        let feature = board.to_uppercase().replace('-', "_");
        env::var_os(format!("CARGO_FEATURE_{feature}")).is_some()
    };
    let boards: Vec<&str> = BOARDS.into_iter().filter(chosen).collect();
    let [board] = boards[..] else {
        panic!("choose one board with --features: {}", BOARDS.join(", "));
    };
    let out = env::var_os("OUT_DIR").expect("cargo sets it");
    let out = Path::new(&out);
    fs::copy(format!("memory/{board}.x"), out.join("memory.x")).expect("the memory map is copied");
    // Where interrupts get handlers by name; here they have one handler, and the table is in `vectors.rs`.
    fs::write(out.join("device.x"), "").expect("the list of interrupts is written");
    println!("cargo:rustc-link-search={}", out.display());
    println!("cargo:rustc-link-arg-bins=-Tlink.x");
    println!("cargo:rerun-if-changed=memory");
}
