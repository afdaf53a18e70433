//! Networks of many shapes: every core computes their golden vectors to the bit, in both numbers.

use firmware_sim::qemu::{Board, Link};
use firmware_sim::remote::flash;

use super::artefacts::{self, Shape};
use super::boards;

/// Every number of inputs up to 64 meets the kernels: whole blocks of four columns, each remainder, too few for one. So does
/// every number of rows up to 16, and rows that begin at any byte of a word.
fn shapes() -> impl Iterator<Item = Shape> {
    (1..=64).map(|inputs| Shape {
        observation: inputs,
        hidden: [4 * inputs - inputs % 5, 1 + inputs % 16],
        action: 1 + inputs * 7 % 16,
        members: 1 + inputs % 3,
    })
}

/// A board judges what it is sent by the golden vectors, of actions and of rewards, floats and integers; that it tells when
/// one comes out differently is a row of the drill.
fn computes_every_shape(board: Board) {
    let fleet = boards::fleet(board, Link::Fifo, None);
    let mut connection = fleet.connect().expect("the board answers");
    for (seed, shape) in (0..).zip(shapes()) {
        let artefact = artefacts::random(shape, seed);
        if let Err(error) = flash(&mut connection, &artefact, true, |_| ()) {
            panic!("{shape:?} on {board}: {error}");
        }
    }
}

#[test]
fn a_cortex_m4f_computes_networks_of_every_shape() {
    computes_every_shape(Board::An386);
}

#[test]
fn a_cortex_m7_computes_networks_of_every_shape() {
    computes_every_shape(Board::An500);
}

#[test]
fn a_cortex_m33_computes_networks_of_every_shape() {
    computes_every_shape(Board::An505);
}
