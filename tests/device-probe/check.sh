#!/bin/sh
# Proves on the linked device code that no panic is reachable and that nothing allocates.
#
# The probe is built twice: as it is, and with a panic put in on purpose, which this check must find.
set -eu
cd "$(dirname "$0")"
target=${CARGO_TARGET_DIR:-../../target}/device-probe

# Prints the symbols of the one object that holds the device code, link-time optimised. macOS puts an underscore before each.
symbols() {
    cargo build --quiet --locked --release --target-dir "$target" "$@"
    rm -rf "$target/objects" && mkdir -p "$target/objects"
    archive=$(cd "$target/release" && pwd)/libdevice_probe.a
    (cd "$target/objects" && ar x "$archive" && nm device_probe*.o | sed 's/ _\([A-Za-z]\)/ \1/')
}

fail() {
    echo "device probe: $1" >&2
    exit 1
}

control=$(symbols --features panic-on-purpose)
echo "$control" | grep -q ' U ted_probe_panic_is_reachable$' || fail "the check is blind: it missed a panic put in on purpose"

found=$(symbols)
for entry in ted_probe_fly ted_probe_serve; do
    echo "$found" | grep -q " T $entry\$" || fail "the entry point $entry was not linked, so nothing was checked"
done
# What a freestanding target gives: moving and comparing bytes. Anything else is a panic, an allocator, or a system call.
foreign=$(echo "$found" | grep ' U ' | grep -vE ' U (memcpy|memmove|memset|memcmp|bcmp|_GLOBAL_OFFSET_TABLE_)$' || true)
[ -z "$foreign" ] || fail "the device code needs symbols that no device has:
$foreign"
echo "device probe: no reachable panic, no allocation"
