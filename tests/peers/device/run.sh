#!/bin/sh
# Counts what the policy network costs in every kernel, on an emulated Cortex-M4F, and prints one table.
#
# Instructions are exact. The cost is an estimate from the Cortex-M4's documented instruction timings without wait states
# (cost.c), not hardware cycles. The image also compares ted-core's bits on the core with plain code, over many shapes.
set -eu
cd "$(dirname "$0")"
chip=thumbv7em-none-eabihf
target=${CARGO_TARGET_DIR:-../../../target}/peers-device
mkdir -p "$target"
macs=76544
period_macs=614144

missing() {
    echo "device peers: missing $1" >&2
    exit 1
}

command -v qemu-system-arm >/dev/null || missing "qemu-system-arm: install qemu-system-arm (Debian), version 7.2 or newer"
command -v cc >/dev/null || missing "a C compiler for the counting plugin: install gcc"
rustc --print target-libdir --target "$chip" 2>/dev/null | xargs test -d ||
    missing "the Rust target $chip: rustup target add $chip"

cc -O2 -shared -fPIC -o "$target/libcost.so" cost.c

# Builds the image with the features given and prints a line for each section: name, instructions, cost.
sections() {
    RUSTFLAGS="-C target-cpu=cortex-m4" cargo build --quiet --locked --release --target "$chip" --target-dir "$target" "$@"
    timeout 300 qemu-system-arm -machine mps2-an386 -nographic -semihosting-config enable=on,target=native \
        -plugin "$target/libcost.so" -d plugin -kernel "$target/$chip/release/peers-device" \
        >"$target/counts.txt" 2>&1 </dev/null || {
        grep -v '	' "$target/counts.txt" >&2
        echo "device peers: the image failed" >&2
        exit 1
    }
    awk -F '\t' 'sub(/^section /, "", $1) && $1 != "rest" { print $1, $2, $3 }' "$target/counts.txt"
}

assembly=$(sections --features assembly)
portable=$(sections)
{
    echo "$assembly"
    echo "$portable" | sed -n 's/^ours_\([a-z0-9]*\)/ours_\1_portable/p'
} | awk -v macs="$macs" -v period_macs="$period_macs" '
    BEGIN {
        title["ours_f32"] = "ted-core f32"
        title["ours_f32_portable"] = "ted-core f32, portable code"
        title["plain_f32"] = "plain loop f32"
        title["nalgebra_f32"] = "nalgebra SMatrix * SVector f32"
        title["burn_f32"] = "burn flex, no_std, f32"
        title["ours_integer"] = "ted-core integer, DSP"
        title["ours_integer_portable"] = "ted-core integer, portable code"
        title["plain_integer"] = "plain loop, i8 weights, i16 activations"
        title["microflow_int8"] = "microflow fully_connected, int8"
        count = split("ours_f32 ours_f32_portable plain_f32 nalgebra_f32 burn_f32 " \
            "ours_integer ours_integer_portable plain_integer microflow_int8", order, " ")
    }
    { instructions[$1] = $2; cost[$1] = $3 }
    # A control period of 12.5 ms at 168 MHz.
    function share(cost) { return 100 * cost / (0.0125 * 168e6) }
    END {
        printf "| kernel | instructions | weighted cost | cost per MAC | to ours |\n|---|---:|---:|---:|---:|\n"
        for (k = 1; k <= count; k++) {
            name = order[k]
            if (!(name in cost)) { print "device peers: no count of " name > "/dev/stderr"; exit 1 }
            ours = k <= 5 ? cost["ours_f32"] : cost["ours_integer"]
            printf "| %s | %d | %d | %.2f | %.2f |\n", title[name], instructions[name], cost[name], cost[name] / macs, cost[name] / ours
        }
        period = cost["ours_period"]
        printf "\n| a control period of 12.5 ms at 168 MHz | weighted cost | cost per MAC | share |\n|---|---:|---:|---:|\n"
        printf "| the policy in integers | %d | %.2f | %.1f %% |\n", cost["ours_integer"], cost["ours_integer"] / macs, share(cost["ours_integer"])
        printf "| the policy and 7 reward models 43-256-256-1, in integers | %d | %.2f | %.1f %% |\n", period, period / period_macs, share(period)
    }'
