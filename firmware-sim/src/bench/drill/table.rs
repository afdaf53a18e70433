//! What a drill found, for people to read and for tests to hold.

use std::fmt::Write;

/// What a device did about one fault.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Row {
    /// The fault.
    pub fault: String,
    /// What the controller did.
    pub did: String,
    /// The last action before it.
    pub before: String,
    /// The action sent at it, or at the tick that latched.
    pub answer: String,
    /// The code of the latched fault, or `r` and the code of the device's refusal.
    pub code: String,
    /// Ticks from the first re-arming to the first one flown by the policy.
    pub recovered: String,
    /// Who noticed that something was wrong with the link, or which artefact flies.
    pub noticed: String,
    /// The reason in words.
    pub reason: String,
    /// Actions that must not have gone out.
    pub unsafe_actions: u32,
    /// Ticks that a controller on the host, given the same observations, would have flown otherwise.
    pub other_than_host: u32,
}

const HEADER: [&str; 8] = [
    "fault",
    "did",
    "before",
    "answer",
    "code",
    "recovered",
    "noticed",
    "reason",
];
const WIDTHS: [usize; 8] = [27, 19, 20, 20, 4, 9, 18, 0];

/// The rows as text, one line each.
#[must_use]
pub fn table(rows: &[Row]) -> String {
    let mut text = String::new();
    line(&mut text, HEADER);
    for row in rows {
        let cells = [
            &row.fault,
            &row.did,
            &row.before,
            &row.answer,
            &row.code,
            &row.recovered,
            &row.noticed,
            &row.reason,
        ];
        line(&mut text, cells.map(String::as_str));
    }
    let sum = |count: fn(&Row) -> u32| rows.iter().map(count).sum::<u32>();
    writeln!(
        text,
        "\n{} unsafe actions, {} ticks flown otherwise than on the host",
        sum(|row| row.unsafe_actions),
        sum(|row| row.other_than_host)
    )
    .unwrap_or_default();
    text
}

fn line(text: &mut String, cells: [&str; 8]) {
    let padded = cells.iter().zip(WIDTHS);
    let padded: Vec<String> = padded
        .map(|(cell, width)| format!("{cell:<width$}"))
        .collect();
    writeln!(text, "{}", padded.join("  ").trim_end()).unwrap_or_default();
}
