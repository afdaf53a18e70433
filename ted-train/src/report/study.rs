//! The page of a study: its tables, and what each method comes to as a picture.

use std::path::Path;

use firmware_sim::disk;
use maud::{Markup, PreEscaped, html};

use super::page::{plot, sheet};
use super::{ReportError, figures};
use crate::statistics::Estimate;
use crate::study::answers::{Aggregate, Section};
use crate::study::grid::Grid;

/// Writes the page of the benchmark of answers.
///
/// # Errors
/// When a plot cannot be drawn, or the page not be written.
pub fn answers(sections: &[Section], out: &Path) -> Result<(), ReportError> {
    let parts: Result<Vec<Markup>, ReportError> = sections.iter().map(section).collect();
    let body = html! {
        p {
            "A score is a mean return over the largest return of the logs. Intervals are of 95 %, 2,000 resamples of the seeds within each task; IQM is the \
             mean of the middle half of the runs. In the tables by task a cell is mean score / mean success."
        }
        @for part in parts? { (part) }
    };
    write("What answers are worth", &body, out)
}

/// Writes the page of a study of policies.
///
/// # Errors
/// When the page cannot be written.
pub fn policies(table: &Grid, out: &Path) -> Result<(), ReportError> {
    write("Tasks and presets", &grid(table, "Scores"), out)
}

fn section(of: &Section) -> Result<Markup, ReportError> {
    let rows: Vec<(String, _)> = of.aggregates.iter().filter_map(marked).collect();
    let title = of.family.title();
    Ok(html! {
        section {
            h2 { (title) }
            p .small { (of.heading()) }
            (plot(figures::estimates(&rows)?, &format!("{title}: mean score of each method, as in the table")))
            (grid(&of.together(), &format!("{title}, together")))
            (grid(&of.rows, &format!("{title}, by task")))
        }
    })
}

/// A line of the picture.
fn marked(it: &Aggregate) -> Option<(String, Estimate)> {
    Some((format!("{}, {}", it.variant, it.method.name()), it.score?))
}

/// A table that a person can move with the keyboard, too, where it is wider than the page.
fn grid(it: &Grid, label: &str) -> Markup {
    html! {
        div .wide tabindex="0" role="group" aria-label=(label) {
            table {
                thead { tr { @for name in &it.head { th { (name) } } } }
                tbody { @for row in &it.rows { tr { @for cell in row { td { (cell) } } } } }
            }
        }
    }
}

fn write(title: &str, body: &Markup, out: &Path) -> Result<(), ReportError> {
    let body = html! { h1 { (title) } (PreEscaped(&body.0)) };
    disk::replace(out, sheet(title, &body).into_string().as_bytes())?;
    Ok(())
}
