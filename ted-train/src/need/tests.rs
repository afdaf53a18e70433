//! Which numbers are refused, and with what words.

use super::*;
use crate::config::Preset;

const LOGS: Logs<'_> = Logs {
    id: "ted/x-v0",
    observation: 39.0,
    action: 4.0,
    steps: 500_000.0,
    episodes: 1000.0,
    longest: 500.0,
};
const GIB: f64 = (1_u64 << 30) as f64;

/// What is said of a preset with one number changed, where there are 16 GiB.
fn said(preset: Preset, path: &str, value: u64) -> String {
    let path: Vec<_> = path.split('.').map(str::to_owned).collect();
    let config = with(&preset.config(), &path, value).unwrap();
    match check_within(16.0 * GIB, &LOGS, &config, 1) {
        Ok(()) => "fits".to_owned(),
        Err(error) => error.to_string(),
    }
}

#[test]
fn every_preset_fits_beside_the_paper_s_dataset_into_two_gigabytes() {
    for row in crate::config::TABLE {
        let config = row.preset.config();
        let checked = check_within(2.0 * GIB, &LOGS, &config, 1);
        assert!(checked.is_ok(), "{}: {checked:?}", config.preset.name());
    }
}

#[test]
fn the_number_that_is_too_large_is_named_with_what_it_needs_and_the_largest_that_would_do() {
    let cases = [
        (Preset::True, "algorithm.batch", 4_000_000_000),
        (Preset::Steer, "reward.clone.batch", 4_000_000_000),
        (Preset::Steer, "reward.network.batch", 4_000_000_000),
        (Preset::Steer, "reward.pool", 4_000_000_000),
        (Preset::Steer, "reward.held_out", 4_000_000_000),
        (Preset::OprlI, "reward.pool", u64::MAX / 4),
        (Preset::OprlI, "reward.held_out", u64::MAX / 4),
        (Preset::Pt, "reward.width", 4_000_000),
        (Preset::Pt, "reward.layers", 4_000_000),
        (Preset::Oppo, "algorithm.batch", 4_000_000),
        (Preset::Oppo, "algorithm.width", 4_000_000),
        (Preset::Oppo, "algorithm.layers", 4_000_000),
        (Preset::Oppo, "algorithm.latent", 4_000_000_000),
    ];
    for (preset, field, value) in cases {
        let text = said(preset, field, value);
        let begins = format!("{field} is {value}, which needs about ");
        assert!(text.starts_with(&begins), "{field}: {text}");
        assert!(
            text.contains("B of memory, and 17.2 GB are free: at most "),
            "{text}"
        );
        let most = text.rsplit_once("at most ").unwrap().1;
        let most: u64 = most.strip_suffix(" would do").unwrap().parse().unwrap();
        assert!(most < value, "{text}");
        assert_eq!(said(preset, field, most), "fits");
        assert_ne!(said(preset, field, most + 1), "fits", "{text}");
    }
}

#[test]
fn runs_side_by_side_need_as_much_as_all_of_them() {
    let path = ["algorithm".to_owned(), "batch".to_owned()];
    let config = with(&Preset::True.config(), &path, 50_000).unwrap();
    assert!(check_within(16.0 * GIB, &LOGS, &config, 1).is_ok());
    assert!(check_within(16.0 * GIB, &LOGS, &config, 64).is_err());
}

#[test]
fn where_no_number_is_larger_than_usual_the_logs_are() {
    let logs = Logs { steps: 4e9, ..LOGS };
    let refused = check_within(16.0 * GIB, &logs, &Preset::True.config(), 1).unwrap_err();
    assert_eq!(
        refused.to_string(),
        "a run on ted/x-v0 needs about 752 GB of memory, and 17.2 GB are free: end other programs, or learn from fewer episodes"
    );
}

#[test]
fn more_things_than_there_is_memory_for_are_refused_with_the_flag() {
    assert!(check_count("--episodes", 1000, 1e3).is_ok());
    let refused = check_count("--episodes", 4_000_000_000, 1e9).unwrap_err();
    let text = refused.to_string();
    assert!(
        text.starts_with("--episodes is 4000000000, which needs about 4000 PB of memory"),
        "{text}"
    );
}
