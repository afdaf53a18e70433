//! What a device does about every fault there is, as a table that people read and this test holds.
//!
//! After an intended change: `UPDATE_SNAPSHOTS=1 cargo test -p firmware-sim --test device drill`, and read the difference.

use std::path::Path;
use std::time::Duration;
use std::{env, fs, io};

use firmware_sim::bench::drill::{Rig, drill, table};
use firmware_sim::bench::{HostDevice, MemoryFlash};
use firmware_sim::remote::LinkOptions;

use super::artefacts::FLASH_BYTES;

/// Devices that are threads.
struct Threads;

impl Rig for Threads {
    type Link = HostDevice;

    fn flash_bytes(&self) -> usize {
        FLASH_BYTES
    }

    fn power_on(&mut self, flash: &[u8]) -> io::Result<HostDevice> {
        Ok(HostDevice::power_on(MemoryFlash::holding(flash)))
    }

    fn link_options(&self) -> LinkOptions {
        LinkOptions {
            timeout: Duration::from_millis(800),
            tries: 10,
            session: 1,
        }
    }
}

#[test]
fn every_fault_has_the_answer_in_the_table() {
    let rows = drill(&mut Threads).unwrap();
    for row in &rows {
        assert_eq!(row.unsafe_actions, 0, "{row:?}");
        assert_eq!(row.other_than_host, 0, "{row:?}");
    }
    let table = format!(
        "The toy flies on a device, at the end of a link, from one seed. The fault comes at tick 4 or before the flight; from\n\
         tick 8 on the host re-arms a latched controller before every tick. `before` is the last action before tick 4, `answer`\n\
         the one of tick 4 or of the tick that latched: moves in x and y, and the gripper. `code` is a fault's, or the device's\n\
         refusal's behind an r. `recovered` counts the ticks from the first re-arming to the first one flown by the policy.\n\
         `noticed` is the counter of the link that saw it, or the artefact that flies afterwards. A thread of the host and the\n\
         emulated cores M4F, M7 and M33 all answer with this table (`tests/qemu/drill.rs`).\n\n{}",
        table(&rows)
    );
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/device_fault_table.txt");
    if env::var_os("UPDATE_SNAPSHOTS").is_some() {
        fs::write(&path, &table).unwrap();
    }
    assert_eq!(fs::read_to_string(&path).unwrap(), table);
}
