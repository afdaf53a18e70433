//! What was measured, as a table and as JSON.

use serde_json::json;

use crate::engines::Engine;

/// One engine's line.
pub struct Row {
    name: String,
    settings: &'static str,
    error: f64,
    median_ns: f64,
    fastest_ns: f64,
    slowest_ns: f64,
    /// Median over rounds of this engine's time over that of the first one, ted-core in f32.
    ratio: f64,
}

/// Summarises timings `[engine][round]`; the first engine is the one that the others are compared with.
pub fn rows(engines: &[Box<dyn Engine + '_>], errors: &[f64], timings: &[Vec<f64>]) -> Vec<Row> {
    let mut rows = Vec::new();
    for ((engine, &error), times) in engines.iter().zip(errors).zip(timings) {
        let ratios = times
            .iter()
            .zip(&timings[0])
            .map(|(own, first)| own / first);
        let [fastest_ns, median_ns, slowest_ns] = quantiles(times.clone());
        rows.push(Row {
            name: engine.name(),
            settings: engine.settings(),
            error,
            median_ns,
            fastest_ns,
            slowest_ns,
            ratio: quantiles(ratios.collect())[1],
        });
    }
    rows
}

/// First decile, median and ninth decile.
fn quantiles(mut values: Vec<f64>) -> [f64; 3] {
    values.sort_by(f64::total_cmp);
    [0.1, 0.5, 0.9].map(|part| values[((values.len() - 1) as f64 * part).round() as usize])
}

/// The fastest engine that is not ted-core: the one with the smallest ratio.
fn fastest_peer(rows: &[Row]) -> Option<&Row> {
    let peers = rows.iter().skip(2);
    peers.min_by(|a, b| a.ratio.total_cmp(&b.ratio))
}

pub fn print_table(rows: &[Row], rounds: usize) {
    println!(
        "One action of the 39-256-256-4 policy, {}, one thread, {rounds} rounds:\n",
        features()
    );
    println!("| engine | median | 10 % | 90 % | of ted-core f32 | error |");
    println!("|---|---:|---:|---:|---:|---:|");
    for row in rows {
        let us =
            [row.median_ns, row.fastest_ns, row.slowest_ns].map(|ns| format!("{:.2} us", ns / 1e3));
        println!(
            "| {} | {} | {} | {} | {:.2} | {:.1e} |",
            row.name, us[0], us[1], us[2], row.ratio, row.error
        );
    }
    println!();
    for row in rows {
        println!("{}: {}", row.name, row.settings);
    }
    if let (Some(peer), [_, integer, ..]) = (fastest_peer(rows), rows) {
        println!(
            "\nted-core f32 over the fastest peer, {}: {:.2} (goal: at most 0.50)",
            peer.name,
            1.0 / peer.ratio
        );
        println!(
            "ted-core integer over f32: {:.2} (goal: at most 1.00)",
            integer.ratio
        );
    }
}

pub fn print_json(rows: &[Row], rounds: usize) -> serde_json::Result<()> {
    let engines: Vec<_> = rows
        .iter()
        .map(|row| {
            json!({
                "engine": row.name,
                "settings": row.settings,
                "median_ns": row.median_ns,
                "decile_1_ns": row.fastest_ns,
                "decile_9_ns": row.slowest_ns,
                "over_ted_core_f32": row.ratio,
                "largest_error": row.error,
            })
        })
        .collect();
    let report = json!({ "network": "39-256-256-4", "cpu": features(), "rounds": rounds, "engines": engines });
    println!("{}", serde_json::to_string_pretty(&report)?);
    Ok(())
}

/// What of the processor decides which kernels the engines choose.
fn features() -> String {
    let mut found = std::env::consts::ARCH.to_owned();
    #[cfg(target_arch = "x86_64")]
    for (name, there) in [
        ("avx", std::is_x86_feature_detected!("avx")),
        ("avx2", std::is_x86_feature_detected!("avx2")),
        ("fma", std::is_x86_feature_detected!("fma")),
        ("avx512f", std::is_x86_feature_detected!("avx512f")),
    ] {
        if there {
            found.push(' ');
            found.push_str(name);
        }
    }
    found
}
