#!/bin/sh
# Measures an update of implicit Q-learning by ted-train and by its peers on this machine. Arguments: --rounds N, --updates N.
set -eu
cd "$(dirname "$0")"
target=${CARGO_TARGET_DIR:-../../../target}
python=${TED_PYTHON:-python3}

missing() {
    echo "train peers: missing: $1" >&2
    exit 1
}

command -v cargo >/dev/null || missing "cargo: install Rust 1.95 or newer from https://rustup.rs"

environment=$target/peers-train
if ! cmp -s requirements.txt "$environment/requirements.txt"; then
    "$python" -c 'import ensurepip, venv' >/dev/null 2>&1 || missing "Python with venv (on Debian and Ubuntu python3-venv), or name one with TED_PYTHON=/path/to/python3"
    rm -rf "$environment"
    "$python" -m venv "$environment"
    "$environment/bin/python" -m pip install --quiet --disable-pip-version-check --only-binary :all: -r requirements.txt ||
        missing "the Python packages of requirements.txt: pip could not install them (see above)"
    # Last: an environment that has it is whole.
    cp requirements.txt "$environment/requirements.txt"
fi

cargo build --quiet --locked --release -p ted-train --example turns
exec "$environment/bin/python" compare.py "$target/release/examples/turns" "$@"
