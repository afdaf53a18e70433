//! `docs/artifact-format.md` describes what the code writes, byte by byte.
//!
//! The document carries a fingerprint of the wire types, of their declarations and of their bytes, and a dump of a whole
//! artefact. Whoever changes the wire types changes these, and has read the document by then.
#![cfg(feature = "std")]

mod support;

use support::{full, minimal};
use ted_core::{Dense, Mlp, Normaliser, Output, RewardEnsemble, RewardInput, RewardRange};
use ted_policy::{
    Artifact, ArtifactBytes, ArtifactSpec, FORMAT_VERSION, HEADER_LENGTH, MAGIC, SafeAction, write,
};

const DOCUMENT: &str = include_str!("../../docs/artifact-format.md");

/// FNV-1a, 64 bits.
fn fnv(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
        (hash ^ u64::from(*byte)).wrapping_mul(0x100_0000_01b3)
    })
}

/// The artefact of the document with a reward ensemble that sees the observation alone.
fn with_state_reward() -> Vec<u8> {
    let member = Mlp::new(&[Dense::new(1, 1, &[1.0], &[0.5]).unwrap()], Output::Linear).unwrap();
    let normaliser = Normaliser::new(&[0.25], &[4.0]).unwrap();
    let range = RewardRange {
        low: 0.0,
        high: 1.0,
    };
    let reward =
        RewardEnsemble::new(RewardInput::Observation, normaliser, &[member], range).unwrap();
    let mut contract = minimal().contract.undeclared();
    contract.action[0].on_fault = SafeAction::Value(0.25);
    write(&ArtifactSpec {
        contract,
        reward: Some(reward),
        ..minimal()
    })
    .unwrap()
}

#[test]
fn the_document_carries_the_fingerprint_of_the_wire_types() {
    // Together these artefacts hold every field and every variant there is.
    let all = [
        write(&full()).unwrap(),
        write(&minimal()).unwrap(),
        with_state_reward(),
    ]
    .concat();
    // A number that becomes wider or a variant that is added changes no byte of these, but a declaration.
    let all = [all, declarations().into_bytes()].concat();
    let line = format!(
        "Fingerprint of version {FORMAT_VERSION}: `{:016x}`",
        fnv(&all)
    );
    assert!(
        DOCUMENT.contains(&line),
        "the wire types changed: raise FORMAT_VERSION, bring docs/artifact-format.md up to date, and give it\n{line}"
    );
}

/// Every type that is serialised, as it is declared: its lines without comments and attributes.
fn declarations() -> String {
    let sources = [
        include_str!("../src/wire.rs"),
        include_str!("../src/contract.rs"),
        include_str!("../src/provenance.rs"),
        include_str!("../src/digest.rs"),
    ];
    let mut found = String::new();
    for source in sources {
        let mut serialised = false;
        let mut inside = false;
        for line in source.lines() {
            let code = line.trim();
            if code.starts_with("#[derive(") {
                serialised = code.contains("Serialize");
            }
            let declared = code.contains("struct ") || code.contains("enum ");
            inside |= serialised && declared && !code.starts_with("//");
            if inside && !code.starts_with("//") && !code.starts_with("#[") {
                found.extend([code, "\n"]);
            }
            if line == "}" || code.ends_with(';') && declared {
                (serialised, inside) = (false, false);
            }
        }
    }
    found
}

#[test]
fn every_wire_type_is_part_of_the_fingerprint() {
    let declarations = declarations();
    for name in [
        "Metadata",
        "Network",
        "Activation",
        "Reward",
        "Sees",
        "Ted",
        "Integers",
        "FixedPoint",
        "IntegerReward",
        "IntegerTed",
        "Contract",
        "ObservationChannel",
        "ActionChannel",
        "SafeAction",
        "Provenance",
        "Digest",
    ] {
        let declared = [format!("struct {name}"), format!("enum {name}")];
        assert!(
            declared.iter().any(|d| declarations.contains(d.as_str())),
            "{name} is missing in:\n{declarations}"
        );
    }
    assert!(!declarations.contains("fn "), "{declarations}");
}

#[test]
fn the_document_shows_a_whole_artefact_as_it_is_written() {
    let bytes = write(&minimal()).unwrap();
    let dump: String = bytes
        .chunks(16)
        .enumerate()
        .map(|(row, bytes)| {
            let bytes: Vec<_> = bytes.iter().map(|byte| format!("{byte:02x}")).collect();
            format!("{:04x}  {}\n", 16 * row, bytes.join(" "))
        })
        .collect();
    assert!(
        DOCUMENT.contains(&dump),
        "docs/artifact-format.md does not show this artefact:\n{dump}"
    );
}

#[test]
fn the_dump_in_the_document_is_an_artefact() {
    let dump = DOCUMENT
        .split("```hex\n")
        .nth(1)
        .and_then(|rest| rest.split("```").next())
        .unwrap();
    let bytes = dump
        .lines()
        .flat_map(|line| line.split_whitespace().skip(1));
    let bytes: Vec<u8> = bytes
        .map(|byte| u8::from_str_radix(byte, 16).unwrap())
        .collect();
    let bytes = ArtifactBytes::from_vec(bytes);
    let artifact = Artifact::parse(&bytes).unwrap();
    assert_eq!(artifact.contract(), minimal().contract);
    artifact
        .verify_golden(&mut ted_core::Scratch::new())
        .unwrap();
}

#[test]
fn the_document_names_the_constants_of_the_code() {
    let magic: Vec<_> = MAGIC.iter().map(|byte| format!("{byte:02x}")).collect();
    for wanted in [
        format!("`{}`", magic.join(" ")),
        format!("\n{HEADER_LENGTH} bytes.\n"),
        format!("| inputs or outputs of a layer | {} |", ted_core::MAX_WIDTH),
        format!("| layers of a network | {} |", ted_core::MAX_LAYERS),
        format!(
            "| members of the reward ensemble | {} |",
            ted_core::MAX_MEMBERS
        ),
        format!("| observation channels | {} |", ted_core::MAX_OBSERVATION),
        format!("| action channels | {} |", ted_core::MAX_ACTION),
    ] {
        assert!(
            DOCUMENT.contains(&wanted),
            "docs/artifact-format.md does not say {wanted}"
        );
    }
}
