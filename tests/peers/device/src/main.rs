//! The policy network in every kernel worth comparing, on an emulated Cortex-M4F. `run.sh` builds it, counts, and prints.
#![no_std]
#![no_main]

extern crate alloc;

mod bits;
mod burn_peer;
mod microflow_peer;
mod nalgebra_peer;
mod network;
mod ours;
mod plain;
mod section;

use core::panic::PanicInfo;

use cortex_m_rt::entry;
use cortex_m_semihosting::debug::{EXIT_FAILURE, EXIT_SUCCESS, exit};
use cortex_m_semihosting::hprintln;
use embedded_alloc::LlffHeap as Heap;

/// The board's 16 MiB of further RAM.
const HEAP: (usize, usize) = (0x2100_0000, 16 << 20);

#[global_allocator]
static ALLOCATOR: Heap = Heap::empty();

#[entry]
fn main() -> ! {
    // SAFETY: nothing else is there, and this runs once.
    unsafe { ALLOCATOR.init(HEAP.0, HEAP.1) }
    bits::compare();
    let layers = network::layers();
    let x = network::observation();
    let x_fixed = network::fixed(&x);

    let action = ours::f32(&layers, &x);
    agree("a plain f32 loop", &plain::f32(&layers, &x), &action, 1e-5);
    agree("nalgebra", &nalgebra_peer::f32(&layers, &x), &action, 1e-5);

    agree("burn", &burn_peer::f32(&layers, &x), &action, 1e-5);

    let integer = ours::integer(&layers, &x);
    let plain: alloc::vec::Vec<f32> = (plain::integer(&layers, &x_fixed).iter())
        .map(|y| f32::from(*y) / 32768.0)
        .collect();
    assert_eq!(plain, integer, "a plain integer loop");
    // Eight bits of weights: a per cent of a pre-activation that is at most about 3.
    agree("ours in integers", &integer, &action, 0.03);
    let mut int8 = microflow_peer::int8(&layers, &x);
    int8.iter_mut().for_each(|y| *y = libm::tanhf(*y));
    agree("microflow", &int8, &action, 0.2);

    let members = network::members();
    let seen = network::fixed(&[&x[..], &integer[..]].concat());
    let sum: i32 = members
        .iter()
        .map(|member| plain::reward(member, &seen))
        .sum();
    let reward = ours::period(&layers, &members, &x);
    assert_eq!(reward, ours::REWARD_OF_ZERO + sum, "the reward ensemble");

    exit(EXIT_SUCCESS);
    loop {}
}

/// Who computes something else is not compared.
fn agree(name: &str, action: &[f32], expected: &[f32], tolerance: f32) {
    let close = |(a, b): (&f32, &f32)| libm::fabsf(a - b) <= tolerance;
    assert!(
        action.iter().zip(expected).all(close),
        "{name}: {action:?}, not {expected:?}"
    );
}

#[panic_handler]
fn panic(info: &PanicInfo<'_>) -> ! {
    hprintln!("{}", info);
    loop {
        exit(EXIT_FAILURE);
    }
}
