//! A damaged artefact is a named error, never a panic and never a policy.
#![cfg(feature = "std")]

mod support;

use proptest::prelude::*;
use support::{array_at, field, full_bytes, metadata, minimal, resealed};
use ted_core::Scratch;
use ted_core::integer::IntegerScratch;
use ted_policy::{
    Artifact, ArtifactBytes, ArtifactError, FORMAT_VERSION, HEADER_LENGTH, MAGIC, Place, write,
};

fn refusal(bytes: &[u8]) -> ArtifactError {
    Artifact::parse(bytes)
        .map(|_| ())
        .expect_err("a damaged artefact was taken")
}

/// Parses and verifies bytes that may be anything.
fn parse_and_verify(bytes: &[u8]) -> Result<(), ArtifactError> {
    let artifact = Artifact::parse(bytes)?;
    artifact.verify_golden(&mut Scratch::new())?;
    match artifact.integers() {
        Some(_) => artifact.verify_integer_golden(&mut IntegerScratch::new()),
        None => Ok(()),
    }
}

#[test]
fn an_artefact_cut_short_at_any_length_is_refused() {
    let bytes = full_bytes();
    for length in 0..bytes.len() {
        match refusal(&bytes[..length]) {
            ArtifactError::TooShort { expected, actual } => {
                assert!(length < HEADER_LENGTH);
                assert_eq!((expected, actual), (HEADER_LENGTH, length));
            }
            ArtifactError::Truncated { expected, actual } => {
                assert!(length >= HEADER_LENGTH);
                assert_eq!((expected, actual), (bytes.len(), length));
            }
            other => panic!("cut to {length} bytes: {other}"),
        }
    }
}

#[test]
fn an_artefact_with_any_one_bit_flipped_is_refused() {
    let bytes = full_bytes();
    let mut damaged = ArtifactBytes::from_vec(bytes.to_vec()).to_vec();
    for bit in 0..8 * bytes.len() {
        damaged[bit / 8] ^= 1 << (bit % 8);
        let error = refusal(&ArtifactBytes::from_vec(damaged.clone()));
        let expected = match bit / 8 {
            0..8 => matches!(error, ArtifactError::WrongMagic { .. }),
            8..12 => matches!(error, ArtifactError::UnsupportedVersion { .. }),
            16..20 => {
                matches!(
                    error,
                    ArtifactError::Truncated { .. } | ArtifactError::TrailingBytes { .. }
                )
            }
            _ => matches!(error, ArtifactError::Checksum { .. }),
        };
        assert!(expected, "bit {bit}: {error}");
        damaged[bit / 8] ^= 1 << (bit % 8);
    }
}

#[test]
fn bytes_after_the_end_are_refused() {
    let mut bytes = full_bytes().to_vec();
    let expected = bytes.len();
    bytes.push(0);
    let error = refusal(&ArtifactBytes::from_vec(bytes));
    assert_eq!(
        error,
        ArtifactError::TrailingBytes {
            expected,
            actual: expected + 1
        }
    );
}

#[test]
fn another_file_is_refused_by_its_first_bytes() {
    let bytes = resealed(&full_bytes(), |bytes| {
        bytes[..8].copy_from_slice(b"\x89PNG\r\n\x1a\n")
    });
    let expected = ArtifactError::WrongMagic {
        expected: MAGIC,
        actual: *b"\x89PNG\r\n\x1a\n",
    };
    assert_eq!(refusal(&bytes), expected);
}

#[test]
fn another_version_is_refused_before_its_header_is_believed() {
    for version in [0_u32, FORMAT_VERSION + 1, u32::MAX] {
        let mut bytes = MAGIC.to_vec();
        bytes.extend(version.to_le_bytes());
        let error = refusal(&ArtifactBytes::from_vec(bytes));
        assert_eq!(
            error,
            ArtifactError::UnsupportedVersion {
                expected: FORMAT_VERSION,
                actual: version
            }
        );
    }
}

#[test]
fn a_header_that_moves_a_section_is_refused() {
    let bytes = full_bytes();
    for at in [20, 24, 28, 32, 36, 40, 44] {
        for value in [0, 1, 16, 64, field(&bytes, at).wrapping_add(16), u32::MAX] {
            if value == field(&bytes, at) {
                continue;
            }
            let moved = resealed(&bytes, |bytes| {
                bytes[at..at + 4].copy_from_slice(&value.to_le_bytes())
            });
            match refusal(&moved) {
                ArtifactError::HeaderField {
                    expected, actual, ..
                } => assert_ne!(expected, actual),
                // A metadata length that still ends before the same multiple of 16 is found by what it cuts off.
                ArtifactError::Metadata | ArtifactError::MetadataLength { .. } if at == 24 => {}
                other => panic!("field {at} = {value}: {other}"),
            }
        }
    }
}

#[test]
fn metadata_that_goes_on_after_its_last_field_is_refused() {
    let bytes = full_bytes();
    let length = metadata(&bytes).len();
    // The padding becomes metadata, so the blob does not move.
    let grown = resealed(&bytes, |bytes| {
        let padded = (HEADER_LENGTH + length).next_multiple_of(16) - HEADER_LENGTH;
        bytes[24..28].copy_from_slice(&(padded as u32).to_le_bytes());
    });
    match refusal(&grown) {
        ArtifactError::MetadataLength { expected, actual } => {
            assert!(expected == length && actual > length)
        }
        other => panic!("{other}"),
    }
}

#[test]
fn a_network_with_more_layers_than_there_is_room_for_is_refused_with_that_reason() {
    let bytes = write(&minimal()).unwrap();
    let widths = [2, 1, 1, 0, 0, 0, 1];
    let at = metadata(&bytes).start
        + bytes[metadata(&bytes)]
            .windows(widths.len())
            .rposition(|seven| seven == widths)
            .unwrap();
    // Five layers of width 1. The metadata grows by four bytes into its padding.
    let bytes = resealed(&bytes, |bytes| {
        let length = field(bytes, 24) + 4;
        bytes[24..28].copy_from_slice(&length.to_le_bytes());
        bytes.splice(at..at + 3, [6, 1, 1, 1, 1, 1, 1]);
        bytes.drain(0x30 + length as usize..0x30 + length as usize + 4);
    });
    let refused = refusal(&bytes);
    assert_eq!(refused, ArtifactError::Metadata);
    assert!(refused.to_string().contains("room"), "{refused}");
}

#[test]
fn padding_that_is_not_zero_is_refused() {
    let bytes = full_bytes();
    let behind_metadata = metadata(&bytes).end;
    let behind_shift = array_at(&bytes, &support::SHIFT) + 3 * 4;
    for offset in [behind_metadata, behind_shift, bytes.len() - 1] {
        let dirty = resealed(&bytes, |bytes| bytes[offset] = 1);
        assert_eq!(refusal(&dirty), ArtifactError::Padding { offset });
    }
}

#[test]
fn a_number_that_is_not_finite_is_found_wherever_it_is() {
    let bytes = full_bytes();
    let arrays = [
        (&support::SHIFT[..], Place::Normaliser),
        (&support::SCALE, Place::Normaliser),
        (&support::HIDDEN, Place::Policy),
        (&support::LAST_BIAS, Place::Policy),
        (&support::REWARD_SCALE, Place::RewardNormaliser),
        (&support::HIDDEN[5..10], Place::RewardMember(1)),
        (&support::GOLDEN, Place::Golden),
    ];
    for (numbers, place) in arrays {
        for index in [0, numbers.len() - 1] {
            for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
                let offset = array_at(&bytes, numbers) + 4 * index;
                let poisoned = resealed(&bytes, |bytes| {
                    bytes[offset..offset + 4].copy_from_slice(&bad.to_le_bytes())
                });
                assert_eq!(
                    refusal(&poisoned),
                    ArtifactError::NotFinite { place, offset }
                );
            }
        }
    }
}

#[test]
fn a_scale_that_is_not_positive_is_refused() {
    let bytes = full_bytes();
    let normalisers = [
        (&support::SCALE[..], Place::Normaliser),
        (&support::REWARD_SCALE[..], Place::RewardNormaliser),
    ];
    for (numbers, place) in normalisers {
        for bad in [0.0_f32, -0.0, -1.0] {
            let offset = array_at(&bytes, numbers) + 4;
            let changed = resealed(&bytes, |bytes| {
                bytes[offset..offset + 4].copy_from_slice(&bad.to_le_bytes())
            });
            assert_eq!(
                refusal(&changed),
                ArtifactError::ScaleNotPositive { place, channel: 1 }
            );
        }
    }
}

#[test]
fn a_buffer_at_an_odd_address_is_refused() {
    let bytes = full_bytes();
    for shift in 1..4 {
        let mut shifted = vec![0; shift];
        shifted.extend_from_slice(&bytes);
        let shifted = ArtifactBytes::from_vec(shifted);
        assert_eq!(
            refusal(&shifted[shift..]),
            ArtifactError::Misaligned {
                expected: 4,
                actual: shift
            }
        );
    }
    let mut shifted = vec![0; 4];
    shifted.extend_from_slice(&bytes);
    parse_and_verify(&ArtifactBytes::from_vec(shifted)[4..]).unwrap();
}

#[test]
fn a_weight_changed_by_one_bit_is_found_by_the_golden_vectors() {
    let bytes = full_bytes();
    let weights = [
        (&support::LAST[..], Place::Policy),
        (&support::HIDDEN[5..10], Place::Reward),
    ];
    for (numbers, wanted) in weights {
        let offset = array_at(&bytes, numbers);
        let changed = resealed(&bytes, |bytes| bytes[offset + 1] ^= 1);
        match parse_and_verify(&changed).unwrap_err() {
            ArtifactError::GoldenMismatch {
                place,
                case: 0,
                output: 0,
                expected,
                actual,
            } => {
                assert_eq!(place, wanted);
                assert_ne!(expected, actual);
            }
            other => panic!("{other}"),
        }
    }
}

#[test]
fn an_integer_weight_that_changed_is_found_by_the_golden_vectors() {
    let bytes = full_bytes();
    let weights = [
        (support::INTEGER_LAST, Place::IntegerPolicy),
        // Each member is its first five weights, padded to 16 bytes.
        (&support::INTEGER_HIDDEN[..5], Place::IntegerReward),
    ];
    for (numbers, wanted) in weights {
        let mut padded: Vec<u8> = numbers.iter().map(|weight| *weight as u8).collect();
        padded.resize(numbers.len().next_multiple_of(16), 0);
        let offset = (field(&bytes, 28) as usize..bytes.len())
            .step_by(16)
            .find(|at| bytes[*at..].starts_with(&padded))
            .expect("the blob holds these weights");
        let changed = resealed(&bytes, |bytes| bytes[offset] ^= 0x40);
        match parse_and_verify(&changed).unwrap_err() {
            ArtifactError::GoldenMismatch { place, .. } => assert_eq!(place, wanted),
            other => panic!("{other}"),
        }
    }
}

#[test]
fn an_artefact_without_golden_vectors_is_refused() {
    let bytes = full_bytes();
    // The number of golden vectors is the last byte of the metadata.
    let last = metadata(&bytes).end - 1;
    assert_eq!(bytes[last], 2);
    assert_eq!(
        refusal(&resealed(&bytes, |bytes| bytes[last] = 0)),
        ArtifactError::NoGolden
    );
    match refusal(&resealed(&bytes, |bytes| bytes[last] = 100)) {
        ArtifactError::BlobLength { expected, actual } => assert!(expected > actual),
        other => panic!("{other}"),
    }
}

#[test]
fn a_blob_that_goes_on_after_its_last_array_is_refused() {
    let bytes = full_bytes();
    let length = field(&bytes, 32) as usize;
    let grown = resealed(&bytes, |bytes| {
        bytes.extend([0; 16]);
        for at in [16, 32] {
            let value = field(bytes, at) + 16;
            bytes[at..at + 4].copy_from_slice(&value.to_le_bytes());
        }
    });
    let error = ArtifactError::BlobLength {
        expected: length,
        actual: length + 16,
    };
    assert_eq!(refusal(&grown), error);
}

#[test]
fn any_metadata_byte_may_change_behind_a_right_checksum_without_a_panic() {
    let bytes = full_bytes();
    for at in metadata(&bytes) {
        for value in [
            0x00,
            0x01,
            0x02,
            0x03,
            0x7f,
            0x80,
            0xff,
            bytes[at] ^ 0x01,
            bytes[at] ^ 0x80,
        ] {
            let _ = parse_and_verify(&resealed(&bytes, |bytes| bytes[at] = value));
        }
    }
}

proptest! {
    #[test]
    fn any_metadata_behind_a_right_header_is_an_error_and_no_panic(
        metadata in prop::collection::vec(any::<u8>(), 0..400),
        blob in 0_usize..40,
    ) {
        let blob_offset = (HEADER_LENGTH + metadata.len()).next_multiple_of(16);
        let total = blob_offset + 16 * blob;
        let mut bytes = vec![0; total];
        bytes[..8].copy_from_slice(&MAGIC);
        let fields = [
            (8, 1),
            (16, total),
            (20, HEADER_LENGTH),
            (24, metadata.len()),
            (28, blob_offset),
            (32, 16 * blob),
        ];
        for (at, value) in fields {
            bytes[at..at + 4].copy_from_slice(&(value as u32).to_le_bytes());
        }
        bytes[HEADER_LENGTH..HEADER_LENGTH + metadata.len()].copy_from_slice(&metadata);
        let bytes = resealed(&bytes, |_| ());
        prop_assert!(parse_and_verify(&bytes).is_err());
    }

    #[test]
    fn several_changes_behind_a_right_checksum_never_panic(
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..8),
    ) {
        let bytes = full_bytes();
        let changed = resealed(&bytes, |bytes| {
            for (at, value) in &changes {
                let at = HEADER_LENGTH + at.index(bytes.len() - HEADER_LENGTH);
                bytes[at] = *value;
            }
        });
        let _ = parse_and_verify(&changed);
    }

    #[test]
    fn any_bytes_at_all_are_an_error_and_no_panic(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        prop_assert!(Artifact::parse(&ArtifactBytes::from_vec(bytes)).is_err());
    }
}
