//! What the controller does about every fault a plant can have, as a table that people read and this test holds.
//!
//! After an intended change: `UPDATE_SNAPSHOTS=1 cargo test -p firmware-sim --test fault_table`, and read the difference.

use std::fmt::Write;
use std::path::Path;
use std::{env, fs};

use firmware_sim::controller::{Controller, Numeric};
use firmware_sim::plant::Plant;
use firmware_sim::plants::fault::{FaultInjector, FaultPlan};
use firmware_sim::plants::toy::{ToyPlant, artifact_bytes};
use firmware_sim::safety::ObservationFrame;
use ted_policy::{Artifact, ArtifactBytes};

const SEEDS: [u64; 2] = [1, 2];
const STRIKE: u32 = 4;
const REARM: u32 = 8;
const END: u32 = 20;

type Row = [String; 9];
const WIDTHS: [usize; 9] = [14, 4, 7, 4, 20, 20, 9, 4, 0];

const PLANS: [&str; 14] = [
    "nan@4",
    "infinite@4",
    "out-of-range@4",
    "wrong-length@4",
    "stale@4",
    "future@4",
    "dropped@4",
    "duplicated@4",
    "late@4",
    "late@4+2",
    "late@4+3",
    "nan@4+6",
    "stale@0",
    "duplicated@0",
];

#[test]
fn every_fault_has_the_answer_in_the_table() {
    let artifact = ArtifactBytes::from_vec(artifact_bytes().unwrap());
    let artifact = Artifact::parse(&artifact).unwrap();
    let controller = Controller::load(&artifact, Numeric::F32).unwrap();
    let mut table = String::from(
        "The toy flies its policy from two seeds. A fault is injected as KIND@TICK+COUNT; from tick 8 on someone re-arms a\n\
         latched controller before every tick. `before` is the last action before the fault is due, `answer` the one sent\n\
         at its last unlatched or first latched tick: moves in x and y, and the gripper. `recovered` counts the ticks from\n\
         the first re-arming to the first one flown by the policy.\n\n",
    );
    let header = [
        "injected",
        "seed",
        "latched",
        "code",
        "before",
        "answer",
        "recovered",
        "late",
        "reason",
    ];
    row(&mut table, header.map(str::to_owned));
    for plan in PLANS {
        for seed in SEEDS {
            row(&mut table, fly(controller.clone(), plan, seed));
        }
    }

    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fault_table.txt");
    if env::var_os("UPDATE_SNAPSHOTS").is_some() {
        fs::write(&path, &table).unwrap();
    }
    assert_eq!(fs::read_to_string(&path).unwrap(), table);
}

fn fly(mut controller: Controller<'_>, plan: &str, seed: u64) -> Row {
    let plan: FaultPlan = plan.parse().unwrap();
    let mut plant = FaultInjector::new(ToyPlant::new(), vec![plan], 0);
    plant.reset(seed).unwrap();
    controller.reset();
    let (mut before, mut answer, mut late) = (String::new(), String::new(), 0);
    let (mut latched, mut recovered) = (None, None);
    for tick in 0..END {
        if tick >= REARM && latched.is_some() && recovered.is_none() {
            controller.rearm();
        }
        let observed = plant.observe().unwrap();
        let (sequence, stamp_us) = (observed.sequence, observed.stamp_us);
        let frame = ObservationFrame {
            sequence,
            stamp_us,
            values: &observed.values,
        };
        let (action, status) = controller.tick(plant.now_us(), &frame);
        let shown = action
            .iter()
            .map(|value| format!("{value:+.3}"))
            .collect::<Vec<_>>()
            .join(" ");
        if tick + 1 == STRIKE {
            before.clone_from(&shown);
        }
        if tick == STRIKE || (latched.is_none() && status.fault.is_some()) {
            answer = shown;
        }
        latched = latched.or(status.fault.map(|fault| (tick, fault)));
        if tick >= REARM && latched.is_some() && status.fault.is_none() {
            recovered = recovered.or(Some(tick - REARM));
        }
        late = status.deadlines_missed;
        plant.apply(&action).unwrap();
    }
    let (at, code, reason) = match latched {
        Some((tick, fault)) => (
            format!("tick {tick}"),
            fault.code().to_string(),
            fault.to_string(),
        ),
        None => ("no".to_owned(), "-".to_owned(), "-".to_owned()),
    };
    let recovered = recovered.map_or("-".to_owned(), |ticks| ticks.to_string());
    let seed = seed.to_string();
    let late = late.to_string();
    [
        plan.to_string(),
        seed,
        at,
        code,
        before,
        answer,
        recovered,
        late,
        reason,
    ]
}

fn row(table: &mut String, row: Row) {
    let cells = row
        .iter()
        .zip(WIDTHS)
        .map(|(cell, width)| format!("{cell:<width$}"));
    let line = cells.collect::<Vec<_>>().join("  ");
    writeln!(table, "{}", line.trim_end()).unwrap();
}
