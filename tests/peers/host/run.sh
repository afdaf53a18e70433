#!/bin/sh
# Measures the latency of one action by ted-core and by its peers on this machine. Arguments go to the program: --json, --rounds N.
#
# ONNX Runtime is the library inside its Python wheel; the other engines are crates.
set -eu
cd "$(dirname "$0")"
target=${CARGO_TARGET_DIR:-../../../target}/peers-host
python=${TED_PYTHON:-python3}
onnxruntime=1.32.0

missing() {
    echo "host peers: missing: $1" >&2
    exit 1
}

command -v cargo >/dev/null || missing "cargo: install Rust 1.95 or newer from https://rustup.rs"

wheel=$target/onnxruntime-$onnxruntime
if [ ! -d "$wheel" ]; then
    "$python" -m pip --version >/dev/null 2>&1 || missing "Python with pip, to fetch ONNX Runtime (on Debian and Ubuntu python3-pip), or name one with TED_PYTHON=/path/to/python3"
    mkdir -p "$target"
    # Into another folder first: one that is there is whole.
    rm -rf "$wheel.part"
    "$python" -m pip install --quiet --disable-pip-version-check --root-user-action ignore --no-deps --only-binary :all: --target "$wheel.part" \
        "onnxruntime==$onnxruntime" || missing "the Python package onnxruntime $onnxruntime: pip could not install it (see above)"
    mv "$wheel.part" "$wheel"
fi
library=$(find "$(cd "$wheel" && pwd)" -name 'libonnxruntime.so*' -o -name 'libonnxruntime.*.dylib' | head -n 1)
[ -n "$library" ] || missing "libonnxruntime inside the package onnxruntime $onnxruntime"

cargo build --quiet --locked --release --target-dir "$target"
ORT_DYLIB_PATH=$library RAYON_NUM_THREADS=1 exec "$target/release/host-peers" "$@"
