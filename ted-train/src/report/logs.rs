//! What the logs are like: what is odd about them, and every channel for those who want to see it.

use maud::{Markup, html};

use crate::check::{Check, Decides, Grade, Moves, short};

/// The section of a report.
pub(super) fn logs(check: &Check) -> Markup {
    html! {
        section {
            h2 { "What the logs are like" }
            @if check.findings.is_empty() { p { "Nothing odd was found." } }
            @else {
                ul {
                    @for finding in &check.findings {
                        li { @if finding.grade < Grade::Note { strong { (finding.words) } } @else { (finding.words) } }
                    }
                }
            }
            details {
                summary { (check.observations.len()) " channels of an observation, " (check.actions.len()) " of an action" }
                div .wide { (channels(check)) }
                p .small {
                    "Resolution: the smallest change from one step to the next. Still: steps that change nothing. Saturated: values that stay at an \
                     end of the range. The networks see (value - shift) / divisor. A controller stops outside of its guard. Marked with *: a few \
                     values far from all others decide it; with °: the channel hardly moves, and a floor does."
                }
            }
        }
    }
}

fn channels(check: &Check) -> Markup {
    html! {
        table {
            thead {
                tr {
                    @for head in ["channel", "unit", "from", "to", "resolution", "still", "saturated", "glitches", "shift", "divisor", "guard from", "to"] {
                        th { (head) }
                    }
                }
            }
            tbody {
                @for it in &check.observations {
                    tr {
                        th scope="row" { (it.name) }
                        td { (it.unit) }
                        (moves(&it.moves))
                        td { (it.glitches) }
                        td { (short(it.shift)) }
                        td { (short(it.divisor)) (mark(it.divisor_by)) }
                        @match it.guard {
                            Some([low, high]) => { td { (short(low)) (mark(it.guard_by)) } td { (short(high)) (mark(it.guard_by)) } }
                            None => { td { "-" } td { "-" } }
                        }
                    }
                }
                @for it in &check.actions {
                    tr {
                        th scope="row" { (it.name) }
                        td { (it.unit) }
                        (moves(&it.moves))
                        @for _ in 0..5 { td {} }
                    }
                }
            }
        }
    }
}

fn moves(moves: &Moves) -> Markup {
    html! {
        td { (short(moves.low)) }
        td { (short(moves.high)) }
        td { (moves.resolution.map_or_else(|| "-".to_owned(), short)) }
        td { (format!("{:.0} %", 100.0 * moves.constant)) }
        td { (format!("{:.0} %", 100.0 * moves.saturated)) }
    }
}

fn mark(decides: Decides) -> &'static str {
    match decides {
        Decides::Deviation | Decides::Declared => "",
        Decides::Floor => "°",
        Decides::Outliers => "*",
    }
}
