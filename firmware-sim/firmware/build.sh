#!/usr/bin/env bash
# Builds the firmware images: firmware-sim/firmware/build.sh [board...], all boards if none is named. Each becomes
# target/firmware/BOARD.elf, with the compiler that made it in BOARD.txt: the code may differ from compiler to compiler.
#
# With --which it builds nothing and says which compiler it would take. The paths of the images go to standard output, one a line.
#
# Two toolchains do. rustup's, with the target of the board; or, on Debian, rustc-web, cargo-web and rust-web-src with the
# linker of binutils-arm-none-eabi, which compile Rust's core library along. TED_FIRMWARE_TOOLCHAIN=rustup or =debian
# insists on one of them.
set -euo pipefail
cd "$(dirname "$0")"

which=
if [ "${1:-}" = --which ]; then
    which=yes
    shift
fi
boards=("$@")
if [ ${#boards[@]} -eq 0 ]; then
    boards=(mps2-an386 mps2-an500 mps2-an505)
fi
# For check.sh: other features, and another folder for what they give.
features=${TED_FIRMWARE_FEATURES:-}
mkdir -p "${CARGO_TARGET_DIR:-../../target}/firmware/${TED_FIRMWARE_OUT:-}"
out=$(cd "${CARGO_TARGET_DIR:-../../target}/firmware" && pwd)
images=$out${TED_FIRMWARE_OUT:+/$TED_FIRMWARE_OUT}

fail() {
    printf 'firmware build: %s\n' "$1" >&2
    exit 1
}

target_of() {
    case $1 in
    mps2-an386 | mps2-an500) echo thumbv7em-none-eabihf ;;
    mps2-an505) echo thumbv8m.main-none-eabihf ;;
    *) fail "there is no board $1: take mps2-an386, mps2-an500 or mps2-an505" ;;
    esac
}

processor_of() {
    case $1 in
    mps2-an386) echo cortex-m4 ;;
    mps2-an500) echo cortex-m7 ;;
    mps2-an505) echo cortex-m33 ;;
    esac
}

has_rustup_target() {
    command -v rustup >/dev/null || return 1
    rustup target list --installed 2>/dev/null | grep -qx "$1" && return
    # Asking changes nothing.
    [ -z "$which" ] && rustup target add "$1" >/dev/null 2>&1
}

debian_lacks() {
    local lacks=()
    [ -x /usr/bin/rustc ] && /usr/bin/rustc --version | grep -qE ' 1\.(9[5-9]|[1-9][0-9]{2})\.' || lacks+=(rustc-web)
    [ -x /usr/bin/cargo ] || lacks+=(cargo-web)
    [ -e /usr/lib/rustlib/src/rust/library/core/src/lib.rs ] || lacks+=(rust-web-src)
    command -v arm-none-eabi-ld >/dev/null || lacks+=(binutils-arm-none-eabi)
    echo "${lacks[*]}"
}

# Which toolchain builds for this target: the first that can.
toolchain_for() {
    local wanted=${TED_FIRMWARE_TOOLCHAIN:-}
    if [ "$wanted" != debian ] && has_rustup_target "$1"; then
        echo rustup
    elif [ "$wanted" != rustup ] && [ -z "$(debian_lacks)" ]; then
        echo debian
    else
        fail "no compiler for $1 here. Either
  rustup target add $1        (needs rustup and the network), or, on Debian 12 with its security updates,
  apt-get install rustc-web cargo-web rust-web-src binutils-arm-none-eabi   (of these, missing here: $(debian_lacks))"
    fi
}

# A linker script is the same for both linkers; rustup brings its own.
build() {
    local board=$1 target processor toolchain
    target=$(target_of "$board")
    processor=$(processor_of "$board")
    toolchain=$(toolchain_for "$target")
    local cargo=(cargo) rustc=(rustc) extra=() flags="-C target-cpu=$processor"
    if [ "$toolchain" = debian ]; then
        cargo=(env RUSTC=/usr/bin/rustc RUSTC_BOOTSTRAP=1 /usr/bin/cargo)
        rustc=(/usr/bin/rustc)
        extra=(-Z build-std=core)
        flags+=" -C linker=arm-none-eabi-ld -C linker-flavor=ld"
    fi
    RUSTFLAGS=$flags "${cargo[@]}" build --quiet --locked --release --features "$board${features:+,$features}" \
        --target "$target" --target-dir "$out/$toolchain" "${extra[@]}"
    cp "$out/$toolchain/$target/release/ted-firmware" "$images/$board.elf.new"
    mv "$images/$board.elf.new" "$images/$board.elf"
    "${rustc[@]}" --version | sed "s/\$/, $toolchain, for $processor/" >"$images/$board.txt"
    printf 'firmware build: %s by %s\n' "$board" "$(cat "$images/$board.txt")" >&2
    echo "$images/$board.elf"
}

if [ -n "$which" ]; then
    for board in "${boards[@]}"; do
        target=$(target_of "$board")
        toolchain=$(toolchain_for "$target")
        printf '%s by %s\n' "$board" "$toolchain"
    done
    exit
fi

# Boards of one target share a folder in which each image has the same name, so two builds at once take turns.
exec 9>"$out/lock"
if command -v flock >/dev/null; then
    flock 9
fi
for board in "${boards[@]}"; do
    build "$board"
done
