//! The latency of one action of the 39-256-256-4 policy on this machine: ted-core beside the engines one could use instead.
//!
//! All engines hold the same weights and must agree before any is timed. They are timed in turn, in one process and on one
//! thread, so that a machine that slows down slows all of them; ratios are taken within a round. Every engine has its
//! observation standardised by the same plain loop, which costs the peers less than two more nodes in their graphs would.

mod blob;
mod engines;
mod measure;
mod network;
mod onnx;
mod quantise;
mod report;

use std::error::Error;
use std::process::ExitCode;

use blob::Blob;
use network::Network;
use quantise::Quantised;

const USAGE: &str = "usage: host-peers [--json] [--rounds N]
run.sh builds it, fetches ONNX Runtime and sets ORT_DYLIB_PATH and RAYON_NUM_THREADS=1";

/// Rounds without `--rounds`.
const ROUNDS: usize = 2000;

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("host-peers: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run() -> Result<(), Box<dyn Error>> {
    let (mut json, mut rounds) = (false, ROUNDS);
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            "--json" => json = true,
            "--rounds" => {
                let given = arguments.next().and_then(|n| n.parse().ok());
                rounds = given.filter(|&n| n > 0).ok_or(USAGE)?;
            }
            _ => return Err(USAGE.into()),
        }
    }
    // candle and burn read it when they first compute, so it has to be there before the program is.
    if std::env::var("RAYON_NUM_THREADS").as_deref() != Ok("1") {
        return Err(format!("RAYON_NUM_THREADS is not 1\n{USAGE}").into());
    }
    let library = std::env::var("ORT_DYLIB_PATH")
        .map_err(|_| format!("ORT_DYLIB_PATH does not name libonnxruntime\n{USAGE}"))?;

    let network = Network::new();
    let blob = Blob::new(&network);
    let quantised = Quantised::new(&network);
    let mut engines = engines::all(&network, &blob, &quantised, &library)?;
    let errors = measure::check(&network, &mut engines)?;
    let timings = measure::time(&network, &mut engines, rounds)?;
    let rows = report::rows(&engines, &errors, &timings);
    if json {
        report::print_json(&rows, rounds)?;
    } else {
        report::print_table(&rows, rounds);
    }
    Ok(())
}
