#!/usr/bin/env bash
# Proves on the release images what they cannot do, and that they keep their limits: no panic is linked, so none can be
# reached; nothing allocates; flash and memory are within the budgets of docs/device.md. Stack depth is measured by the
# tests, which run the images.
#
# The check first builds an image with a panic put in on purpose, and must find it there.
set -euo pipefail
cd "$(dirname "$0")"

# Vectors, code and constants, without artefacts.
flash_limit=32768
# What is not on the stack: mostly the ring that the serial port receives into, 1 KiB.
static_limit=1280

fail() {
    printf 'firmware check: %s\n' "$1" >&2
    exit 1
}

nm=$(command -v arm-none-eabi-nm || command -v llvm-nm || command -v nm) || fail "there is no nm: install binutils-arm-none-eabi"
size=$(command -v arm-none-eabi-size || command -v llvm-size || command -v size) || fail "there is no size: install binutils-arm-none-eabi"

panics() { "$nm" -C "$1" | grep -E 'core::panicking|slice_index_fail|rust_begin_unwind|unwrap_failed|expect_failed' || true; }

section() { "$size" -A -d "$1" | awk -v name="$2" '$1 == name { bytes = $2 } END { print bytes + 0 }'; }

control=$(TED_FIRMWARE_FEATURES=panic-on-purpose TED_FIRMWARE_OUT=panic-on-purpose ./build.sh mps2-an386)
[ -n "$(panics "$control")" ] || fail "the check is blind: it missed a panic put in on purpose"

for board in mps2-an386 mps2-an500 mps2-an505; do
    image=$(./build.sh "$board")
    "$nm" "$image" | grep -q ' T main$' || fail "$board: nothing was linked, so nothing was checked"
    found=$(panics "$image")
    [ -z "$found" ] || fail "$board: a panic is linked:
$found"
    found=$("$nm" -C "$image" | grep -E '__rust_alloc|__rg_alloc|alloc::' || true)
    [ -z "$found" ] || fail "$board: something allocates:
$found"
    vectors=$(section "$image" .vector_table) text=$(section "$image" .text) rodata=$(section "$image" .rodata)
    data=$(section "$image" .data) bss=$(section "$image" .bss)
    printf '%s: vectors %d, text %d, rodata %d, data %d, bss %d bytes\n' "$board" "$vectors" "$text" "$rodata" "$data" "$bss"
    flash=$((vectors + text + rodata + data))
    [ "$flash" -le "$flash_limit" ] || fail "$board: code and constants take $flash bytes of flash, $flash_limit are allowed"
    [ $((data + bss)) -le "$static_limit" ] || fail "$board: static memory takes $((data + bss)) bytes, $static_limit are allowed"
done
echo "firmware check: no panic, no allocator, within limits"
