#!/usr/bin/env bash
# Everything that must pass before a merge, cheapest first. Needs Rust, Python, for the firmware QEMU and a C compiler, Slurm, Chromium with its driver, OSMesa, and a C++ compiler; on a
# Debian machine of CI's own what is missing is installed. The simulator's packages are installed by the tests that need them.
# One profile throughout: burn is built once, and tests of numbers want it optimised.
set -euo pipefail
cd "$(dirname "$0")"
if [ -n "${CI:-}" ]; then
    export CARGO_TERM_COLOR=never CARGO_INCREMENTAL=0
fi

began=$SECONDS
current="what is installed"

clock() { printf '%d:%02d' $((($SECONDS - began) / 60)) $((($SECONDS - began) % 60)); }

step() {
    current=$1
    printf '\n== %s  [%s]\n' "$1" "$(clock)"
    "${@:2}"
}

finish() {
    local status=$?
    if [ "$status" -eq 0 ]; then
        printf '\nall passed in %s\n' "$(clock)"
    else
        printf '\nfailed at: %s (after %s)\n' "$current" "$(clock)" >&2
    fi
}
trap finish EXIT

missing() {
    printf 'missing: %s\n' "$1" >&2
    exit 1
}

installed() {
    command -v cargo >/dev/null || missing "cargo: install Rust 1.95 or newer from https://rustup.rs"
    for component in fmt clippy; do
        cargo "$component" --version >/dev/null 2>&1 && continue
        local package=${component/fmt/rustfmt}
        rustup component add "$package" 2>/dev/null || missing "cargo $component: rustup component add $package"
    done
    find_python
    for_the_firmware
    for_the_cluster
    for_the_page
    for_the_pictures
    for_the_exports
    cargo --version
    "$python" --version
    qemu-system-arm --version | head -1
}

# QEMU, a C compiler for its plugin, and a Rust compiler for the three cores.
for_the_firmware() {
    command -v qemu-system-arm >/dev/null || debian qemu-system-arm
    command -v cc >/dev/null || debian gcc libc6-dev
    command -v nm >/dev/null || debian binutils
    for target in thumbv7em-none-eabihf thumbv8m.main-none-eabihf; do
        rustup target list --installed 2>/dev/null | grep -qx "$target" && continue
        rustup target add "$target" 2>/dev/null && continue
        [ -e /usr/lib/rustlib/src/rust/library/core/src/lib.rs ] && command -v arm-none-eabi-ld >/dev/null && continue
        debian rustc-web cargo-web rust-web-src binutils-arm-none-eabi
    done
}

# A cluster of one machine; its daemons are where only an administrator looks for commands.
for_the_cluster() {
    for command in sbatch slurmctld slurmd munged; do
        PATH="$PATH:/usr/sbin" command -v "$command" >/dev/null && continue
        debian slurmctld slurmd slurm-client munge
        break
    done
}

# A browser, for the page of `ted ask`.
for_the_page() {
    command -v chromedriver >/dev/null || debian chromium chromium-driver
}

# A library that draws without a screen, for the pictures of `ted ask`. Which one is there is the simulator's business.
for_the_pictures() {
    [ "$(uname)" = Linux ] || return 0
    "$python" -Es -c 'from ctypes import CDLL; CDLL("libOSMesa.so.8")' 2>/dev/null || debian libosmesa6
}

# A compiler for C++, for the headers of `ted export`; the one for C is there for the firmware.
for_the_exports() {
    command -v c++ >/dev/null || debian g++
}

# Installs packages where that is nobody's own machine, and names them elsewhere.
debian() {
    if [ -n "${CI:-}" ] && [ "$(id -u)" -eq 0 ] && command -v apt-get >/dev/null; then
        apt-get update -qq && DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "$@" >/dev/null && return
    fi
    missing "$*: on Debian, apt-get install $*"
}

# The interpreter that the bridge chooses, and the same conditions: firmware-sim/src/bridge/environment/python.rs.
find_python() {
    local candidates=(python3 python3.13 python3.12 python3.11 python3.10)
    if [ -n "${TED_PYTHON:-}" ]; then
        candidates=("$TED_PYTHON")
    fi
    for python in "${candidates[@]}"; do
        "$python" -Es -c 'import sys, venv, ensurepip; sys.exit(not (3, 10) <= sys.version_info[:2] <= (3, 13))' 2>/dev/null && return
    done
    missing "Python 3.10 to 3.13 with its venv module: install one (on Debian and Ubuntu python3-venv as well), or name it with
TED_PYTHON=/path/to/python3"
}

documented() {
    RUSTDOCFLAGS="-D warnings" cargo doc --locked --release --workspace --no-deps
}

# No GPU and no toolkit are needed for that; what burn's kernel compiler is linked with is not downloaded when it believes that only
# documentation is built.
with_cuda() {
    DOCS_RS=1 cargo check --locked --release --workspace --features ted-train/cuda
}

without_std() {
    cargo check --locked --release --package firmware-sim --lib --no-default-features
    # On the device's own target too, where it is installed: the host would forgive a hidden use of std.
    if rustup target list --installed 2>/dev/null | grep -qx thumbv7em-none-eabihf; then
        cargo check --locked --release --package firmware-sim --lib --no-default-features --target thumbv7em-none-eabihf
    fi
}

step "what is installed" installed
step "format" cargo fmt --all -- --check
step "the bridge's Python, as far as it needs no simulator" "$python" -Es firmware-sim/metaworld-bridge/test_wire.py
step "the controller without std" without_std
step "no panic and no allocation in the device crates" tests/device-probe/check.sh
step "lints" cargo clippy --locked --release --workspace --all-targets -- -D warnings
step "types with CUDA" with_cuda
step "documentation" documented
step "the firmware images: no panic, no allocation, sizes" firmware-sim/firmware/check.sh
step "tests" cargo test --locked --release --workspace
step "a study on a cluster" tests/slurm/check.sh
