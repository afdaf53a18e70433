//! The scenarios of a drill.

use std::io::{Read, Write};

use embedded_storage::nor_flash::NorFlash;
use ted_policy::Artifact;

use super::artefacts::Artefacts;
use super::flight::{Flown, Remote, Struck, fly};
use super::{DrillError, Rig, Row};
use crate::bench::{Direction, Disturbance, Disturbed, MemoryFlash, Strike};
use crate::device::Counters;
use crate::device::frame::CHUNK_LENGTH;
use crate::device::message::{FlashBegin, Refusal, Request, Start};
use crate::device::slots::{Layout, SlotReport, Transfer, survey};
use crate::plants::fault::FaultPlan;
use crate::remote::{Connection, DeviceHello, LinkErrors, LinkOptions, RemoteError, flash};
use crate::safety::Action;
use crate::splitmix::mix;

/// How long a device waits for a tick in the scenario of the silent link. Other ticks have to be quicker.
const SILENCE_US: u32 = 500_000;

/// One fault, and how it is made.
#[derive(Clone, Debug)]
pub struct Scenario {
    /// What the table calls it.
    pub name: String,
    kind: Kind,
}

#[derive(Clone, Copy, Debug)]
enum Kind {
    /// In an observation.
    Observation(FaultPlan),
    /// To a frame.
    Frame(Direction, Disturbance),
    /// Bytes on the line that are no frame of the host.
    Bytes(Bytes),
    /// No tick comes.
    Silence,
    /// Something was done to the flash before the device was switched on.
    Flash(FlashDamage),
    /// An artefact is sent that must not fly.
    Artefact(Unfit),
    /// The host stops in the middle of sending an artefact.
    BrokenOff,
}

#[derive(Clone, Copy, Debug)]
enum Bytes {
    Noise,
    Endless,
}

#[derive(Clone, Copy, Debug)]
enum FlashDamage {
    NewerSlot,
    Rewired,
    BothSlots,
    CutInData,
    CutInRecord,
}

#[derive(Clone, Copy, Debug)]
enum Unfit {
    Damaged,
    OtherContract,
    OtherGolden,
    TooLarge,
}

const PLANS: [&str; 10] = [
    "nan@4",
    "infinite@4",
    "out-of-range@4",
    "wrong-length@4",
    "stale@4",
    "future@4",
    "dropped@4",
    "duplicated@4",
    "late@4",
    "late@4+3",
];

/// All of them, in the order of the table.
#[must_use]
pub fn scenarios() -> Vec<Scenario> {
    let named = |name: &str, kind| Scenario {
        name: name.to_owned(),
        kind,
    };
    let plans = PLANS.iter().filter_map(|plan| plan.parse().ok());
    let observations =
        plans.map(|plan: FaultPlan| named(&format!("observation {plan}"), Kind::Observation(plan)));
    let ways = [
        ("request", Direction::ToDevice),
        ("reply", Direction::ToHost),
    ];
    let frames = ways.into_iter().flat_map(|(what, direction)| {
        Disturbance::ALL.map(|disturbance| {
            let name = format!("{what} {}", disturbance.name());
            named(&name, Kind::Frame(direction, disturbance))
        })
    });
    let others = [
        named("line noise, 4 KiB", Kind::Bytes(Bytes::Noise)),
        named("line never at rest, 4 KiB", Kind::Bytes(Bytes::Endless)),
        named("link silent", Kind::Silence),
        named("newer slot corrupted", Kind::Flash(FlashDamage::NewerSlot)),
        named(
            "newer, rewired, corrupted",
            Kind::Flash(FlashDamage::Rewired),
        ),
        named("both slots corrupted", Kind::Flash(FlashDamage::BothSlots)),
        named(
            "power cut in the artefact",
            Kind::Flash(FlashDamage::CutInData),
        ),
        named(
            "power cut in the record",
            Kind::Flash(FlashDamage::CutInRecord),
        ),
        named("artefact broken off", Kind::BrokenOff),
        named("artefact damaged", Kind::Artefact(Unfit::Damaged)),
        named("artefact too large", Kind::Artefact(Unfit::TooLarge)),
        named("artefact rewired", Kind::Artefact(Unfit::OtherContract)),
        named(
            "artefact computed otherwise",
            Kind::Artefact(Unfit::OtherGolden),
        ),
    ];
    observations.chain(frames).chain(others).collect()
}

impl Scenario {
    /// Runs it on a device that is switched on for it.
    pub(super) fn run<R: Rig>(
        &self,
        rig: &mut R,
        artefacts: &Artefacts,
    ) -> Result<Row, DrillError> {
        let artifact = Artifact::parse(&artefacts.old).map_err(|error| {
            let code = error.code();
            Refusal::Defect { code }
        })?;
        let bytes = rig.flash_bytes();
        let flash = self.kind.flash(bytes, artefacts)?;
        let link = rig.power_on(&flash).map_err(DrillError::PowerOn)?;
        let line = Disturbed::planned(link, Vec::new());
        let mut connection = Connection::open(line, rig.link_options())?;
        let refused = self
            .kind
            .send(&mut connection, rig.link_options(), bytes, artefacts)?;
        let start = self.kind.start();
        let mut remote = Remote::new(connection, start);
        let plan = match self.kind {
            Kind::Observation(plan) => Some(plan),
            _ => None,
        };
        let mut strike = |remote: &mut Remote<R::Link>| self.kind.strike(remote);
        let flown = match fly(&mut remote, &artifact, plan, &mut strike) {
            // A device that flies nothing has nothing more to show.
            Err(DrillError::Remote(RemoteError::Refused { refusal, .. })) => {
                return Ok(self.row(None, Some(refusal), String::new()));
            }
            flown => flown?,
        };
        let counters = remote.health()?.counters;
        remote.connection().greet()?;
        let noticed = match self.kind {
            Kind::Flash(_) | Kind::BrokenOff | Kind::Artefact(_) => {
                flying(remote.hello(), &artifact).to_owned()
            }
            _ => self.kind.noticed(&counters, remote.connection().errors()),
        };
        Ok(self.row(Some(flown), refused, noticed))
    }

    fn row(&self, flown: Option<Flown>, refused: Option<Refusal>, noticed: String) -> Row {
        let dash = || "-".to_owned();
        let mut row = Row {
            fault: self.name.clone(),
            did: "flies nothing".to_owned(),
            before: dash(),
            answer: dash(),
            code: dash(),
            recovered: dash(),
            noticed: if noticed.is_empty() { dash() } else { noticed },
            reason: dash(),
            ..Row::default()
        };
        if let Some(refusal) = refused {
            row.code = format!("r{}", refusal.code());
            row.reason = brief(refusal).to_owned();
        }
        let Some(flown) = flown else {
            return row;
        };
        row.did = match (flown.latched, refused) {
            (Some((tick, _)), _) => format!("stopped at tick {tick}"),
            (None, Some(_)) => "refused it, flew on".to_owned(),
            (None, None) => "flew on".to_owned(),
        };
        if let Some((_, fault)) = flown.latched {
            row.code = fault.code().to_string();
            row.reason = fault.to_string();
        }
        row.before = shown(&flown.before);
        row.answer = shown(&flown.answer);
        row.recovered = flown.recovered.map_or_else(dash, |ticks| ticks.to_string());
        row.unsafe_actions = flown.unsafe_actions;
        row.other_than_host = flown.other_than_host;
        row
    }
}

/// A refusal without its numbers, which are of one board or another.
fn brief(refusal: Refusal) -> &'static str {
    match refusal {
        Refusal::NoPolicy => "no slot holds a policy that flies",
        Refusal::Checksum { .. } => "its checksum is another one",
        Refusal::TooLarge { .. } => "it is larger than a slot",
        Refusal::OtherContract => "its contract is another one",
        Refusal::Golden { .. } => "its golden vectors come out differently",
        _ => "not one of those that a drill expects",
    }
}

fn shown(action: &Action) -> String {
    let values: Vec<String> = action.iter().map(|value| format!("{value:+.3}")).collect();
    values.join(" ")
}

impl Kind {
    /// What the device finds in its flash.
    fn flash(self, bytes: usize, artefacts: &Artefacts) -> Result<Vec<u8>, Refusal> {
        let old: &[u8] = &artefacts.old;
        let newest: &[&[u8]] = match self {
            Self::Flash(FlashDamage::NewerSlot | FlashDamage::BothSlots) => &[old, &artefacts.new],
            Self::Flash(FlashDamage::Rewired) => &[old, &artefacts.rewired],
            _ => &[old],
        };
        let mut flash = MemoryFlash::with_artefacts(bytes, newest)?;
        let newer = Layout::of(&flash).start(1) as usize;
        match self {
            Self::Flash(FlashDamage::NewerSlot | FlashDamage::Rewired) => {
                flash.content()[newer + 200] ^= 1
            }
            Self::Flash(FlashDamage::BothSlots) => {
                flash.content()[200] ^= 1;
                flash.content()[newer + 200] ^= 1;
            }
            Self::Flash(FlashDamage::CutInData) => cut_short(&mut flash, &artefacts.new, 600)?,
            Self::Flash(FlashDamage::CutInRecord) => {
                let all = artefacts.new.len().next_multiple_of(4);
                cut_short(&mut flash, &artefacts.new, all as u64 + 10)?;
            }
            _ => {}
        }
        Ok(flash.content().to_vec())
    }

    /// What the host sends before it flies, and what the device says of it.
    fn send<S: Read + Write>(
        self,
        connection: &mut Connection<S>,
        options: LinkOptions,
        bytes: usize,
        artefacts: &Artefacts,
    ) -> Result<Option<Refusal>, RemoteError> {
        let mut artefact = match self {
            Self::BrokenOff => {
                let begin = announced(&artefacts.new);
                connection.ask("announce", &Request::FlashBegin(begin))?;
                let bytes = &artefacts.new[..CHUNK_LENGTH];
                connection.ask("send", &Request::FlashData { offset: 0, bytes })?;
                // The next host knows nothing of it.
                connection.greet_anew(options.session.wrapping_add(1))?;
                return Ok(None);
            }
            Self::Artefact(Unfit::Damaged) => artefacts.new.to_vec(),
            Self::Artefact(Unfit::OtherContract) => artefacts.rewired.to_vec(),
            Self::Artefact(Unfit::OtherGolden) => artefacts.other_golden.to_vec(),
            Self::Artefact(Unfit::TooLarge) => vec![0; bytes],
            _ => return Ok(None),
        };
        if let Self::Artefact(Unfit::Damaged) = self {
            artefact[300] ^= 1;
        }
        match flash(connection, &artefact, false, |_| {}) {
            Err(RemoteError::Refused { refusal, .. }) => Ok(Some(refusal)),
            flashed => flashed.map(|_| None),
        }
    }

    fn start(self) -> Start {
        Start {
            silence_us: match self {
                Self::Silence => SILENCE_US,
                _ => 0,
            },
            ..Start::default()
        }
    }

    /// What happens to the link in mid-flight.
    fn strike<L: Read + Write>(self, remote: &mut Remote<L>) -> Result<Struck, RemoteError> {
        let line = remote.connection().stream();
        match self {
            Self::Frame(direction, disturbance) => {
                let frame = line.frames(direction);
                line.plan(Strike {
                    direction,
                    frame,
                    disturbance,
                });
            }
            Self::Bytes(bytes) => {
                line.inner().write_all(&bytes.bytes())?;
                line.inner().flush()?;
            }
            Self::Silence => {
                if let Some(acted) = remote.connection().listen()? {
                    return Ok(Struck::Alone(acted.action, acted.status, SILENCE_US));
                }
            }
            _ => {}
        }
        Ok(Struck::TickFollows)
    }

    /// Which counter must have noticed it.
    fn noticed(self, device: &Counters, host: LinkErrors) -> String {
        let (who, count) = match self {
            Self::Frame(Direction::ToDevice, disturbance) => match disturbance {
                Disturbance::Drop => ("host asked again", host.retries),
                Disturbance::Duplicate | Disturbance::Reorder => {
                    ("device: duplicate", device.duplicates)
                }
                Disturbance::Truncate | Disturbance::FlipBit | Disturbance::Noise => {
                    ("device: damaged", device.crc_errors)
                }
                Disturbance::Echo => ("device: too late", device.reordered),
            },
            Self::Frame(Direction::ToHost, disturbance) => match disturbance {
                Disturbance::Drop => ("device: duplicate", device.duplicates),
                Disturbance::Duplicate | Disturbance::Reorder | Disturbance::Echo => {
                    ("host: stale", host.stale)
                }
                Disturbance::Truncate | Disturbance::FlipBit | Disturbance::Noise => {
                    ("host: damaged", host.received.crc_errors)
                }
            },
            Self::Bytes(Bytes::Noise) => ("device: damaged", device.crc_errors),
            Self::Bytes(Bytes::Endless) => ("device: too long", device.too_long),
            _ => return String::new(),
        };
        if count > 0 { who } else { "nobody" }.to_owned()
    }
}

impl Bytes {
    fn bytes(self) -> Vec<u8> {
        const LENGTH: u64 = 4096;
        match self {
            Self::Noise => (0..LENGTH).map(|index| mix(1, index) as u8).collect(),
            Self::Endless => (0..LENGTH).map(|index| mix(2, index) as u8 | 1).collect(),
        }
    }
}

fn flying(hello: &DeviceHello, old: &Artifact<'_>) -> &'static str {
    let active = SlotReport::Active {
        checksum: old.checksum(),
    };
    if hello.slots.contains(&active) {
        "old one flies"
    } else {
        "another one flies"
    }
}

fn announced(artefact: &[u8]) -> FlashBegin {
    let checksum = Artifact::parse(artefact).map_or(0, |artifact| artifact.checksum());
    FlashBegin {
        length: artefact.len() as u32,
        checksum,
        accept_other_contract: false,
    }
}

/// Puts an artefact into the slot that does not fly, and lets the power go `after` bytes of artefact and record.
fn cut_short(flash: &mut MemoryFlash, artefact: &[u8], after: u64) -> Result<(), Refusal> {
    let found = survey(flash);
    let mut transfer = Transfer::begin(flash, &found, announced(artefact))?;
    let erased = artefact.len().next_multiple_of(MemoryFlash::ERASE_SIZE) as u64;
    flash.cut_power_at(flash.changed() + erased + after);
    let cut = transfer
        .write(flash, 0, artefact)
        .and_then(|()| transfer.commit(flash, &found));
    flash.restore_power();
    // Without an error the power went too late, and nothing was tried.
    match cut {
        Err(Refusal::Flash) => Ok(()),
        Err(refusal) => Err(refusal),
        Ok(_) => Err(Refusal::Flash),
    }
}
