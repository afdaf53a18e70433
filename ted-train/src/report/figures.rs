//! The plots of a report, as vector graphics.

use std::fmt::Display;
use std::ops::Range;

use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;

use super::ReportError;
use super::facts::{Curve, Predicted};
use crate::evaluate::Evaluation;
use crate::statistics::Estimate;

/// Width and height of a plot.
const SIZE: (u32, u32) = (560, 360);
/// Of one among many.
const SMALL: (u32, u32) = (280, 190);

const ABOVE: RGBColor = RGBColor(0, 92, 175);
const BELOW: RGBColor = RGBColor(150, 150, 150);
const LINE: RGBColor = RGBColor(180, 60, 0);

/// The paper's Figure 1: predicted against true returns of the episodes, both from 0 to 1, and the line on which they are equal.
pub(super) fn predicted_against_true(
    predicted: &Predicted,
    truth: &[f64],
) -> Result<String, ReportError> {
    let hat: Vec<f64> = predicted
        .returns_hat
        .iter()
        .map(|&hat| hat.into())
        .collect();
    let points: Vec<_> = unit(&hat)
        .into_iter()
        .zip(unit(truth))
        .zip(&predicted.returns_hat)
        .collect();
    drawn(SIZE, |root| {
        let mut chart = axes(
            root,
            -0.02..1.02,
            -0.02..1.02,
            ["predicted return, lowest 0, highest 1", "true return"],
        )?;
        chart.draw_series(LineSeries::new([(0.0, 0.0), (1.0, 1.0)], LINE))?;
        chart.draw_series(points.iter().map(|&((x, y), &hat)| {
            let above = predicted.border.is_none_or(|border| hat >= border);
            Circle::new(
                (x, y),
                3,
                if above { ABOVE } else { BELOW }.mix(0.6).filled(),
            )
        }))?;
        Ok(())
    })
}

/// How many episodes have which predicted return, and the border.
pub(super) fn histogram(predicted: &Predicted) -> Result<String, ReportError> {
    const BINS: usize = 40;
    let hat: Vec<f64> = predicted
        .returns_hat
        .iter()
        .map(|&hat| hat.into())
        .collect();
    let range = around(&hat);
    let width = (range.end - range.start) / BINS as f64;
    let mut counts = [0_u32; BINS];
    for hat in &hat {
        counts[(((hat - range.start) / width) as usize).min(BINS - 1)] += 1;
    }
    let most = counts.iter().copied().max().unwrap_or_default().max(1);
    drawn(SIZE, |root| {
        let mut chart = axes(
            root,
            range.clone(),
            0.0..f64::from(most) * 1.05,
            ["predicted return", "episodes"],
        )?;
        chart.draw_series(counts.iter().enumerate().map(|(bin, &count)| {
            let left = range.start + width * bin as f64;
            let above = predicted
                .border
                .is_none_or(|border| left + width > border.into());
            let colour = if above { ABOVE } else { BELOW };
            Rectangle::new(
                [(left, 0.0), (left + width * 0.92, count.into())],
                colour.filled(),
            )
        }))?;
        if let Some(border) = predicted.border {
            let border = f64::from(border);
            chart.draw_series(LineSeries::new(
                [(border, 0.0), (border, f64::from(most))],
                LINE.stroke_width(2),
            ))?;
        }
        Ok(())
    })
}

/// The return of every flight, of the policy and of a clone, beside the mean and the largest return of the logs if they have any.
pub(super) fn flights(
    flown: &Evaluation,
    clone: Option<&Evaluation>,
    rewarded: bool,
) -> Result<String, ReportError> {
    let rows: Vec<(&str, &[f64])> = [("policy", Some(flown)), ("clone", clone)]
        .into_iter()
        .filter_map(|(name, it)| Some((name, it?.returns.as_slice())))
        .collect();
    let marks = match rewarded {
        true => vec![flown.dataset_mean, flown.dataset_max],
        false => Vec::new(),
    };
    let all: Vec<f64> = rows
        .iter()
        .flat_map(|(_, returns)| *returns)
        .copied()
        .chain(marks.iter().copied())
        .collect();
    let height = 90 + 60 * u32::try_from(rows.len()).unwrap_or(1);
    drawn((SIZE.0, height), |root| {
        let words = match rewarded {
            true => "return of a flight; lines: mean and largest return of the logs",
            false => "return of a flight",
        };
        let names: Vec<&str> = rows.iter().map(|(name, _)| *name).collect();
        let mut chart = named_rows(root, &names, 60, around(&all), words)?;
        for &mark in &marks {
            chart.draw_series(LineSeries::new(
                [(mark, 0.0), (mark, rows.len() as f64)],
                LINE,
            ))?;
        }
        for (row, (_, returns)) in rows.iter().enumerate() {
            let middle = middle(row, rows.len());
            let colour = if row == 0 { ABOVE } else { BELOW };
            chart.draw_series(returns.iter().enumerate().map(|(flight, &x)| {
                // Equal returns would hide each other.
                let aside = 0.25 * ((flight % 5) as f64 / 2.0 - 1.0);
                Circle::new((x, middle + aside), 4, colour.mix(0.7).filled())
            }))?;
        }
        Ok(())
    })
}

/// Numbers with their intervals, a line each.
pub(super) fn estimates(rows: &[(String, Estimate)]) -> Result<String, ReportError> {
    const NAMES: u32 = 240;
    const LINE_HEIGHT: u32 = 22;
    let count = u32::try_from(rows.len()).unwrap_or(u32::MAX);
    let ends = |it: &Estimate| it.interval.unwrap_or([it.value; 2]);
    let all = rows.iter().flat_map(|(_, it)| ends(it));
    let range = around(&all.chain([0.0, 1.0]).collect::<Vec<_>>());
    drawn((SIZE.0 + NAMES, 60 + LINE_HEIGHT * count), |root| {
        let names: Vec<&str> = rows.iter().map(|(name, _)| name.as_str()).collect();
        let words = "mean score, and its 95 % interval";
        let mut chart = named_rows(root, &names, NAMES, range, words)?;
        for (row, (_, it)) in rows.iter().enumerate() {
            let middle = middle(row, rows.len());
            let [low, high] = ends(it);
            chart.draw_series(LineSeries::new(
                [(low, middle), (high, middle)],
                ABOVE.stroke_width(3),
            ))?;
            chart.draw_series([Circle::new((it.value, middle), 5, ABOVE.filled())])?;
        }
        Ok(())
    })
}

/// A number over the updates.
pub(super) fn curve(curve: &Curve) -> Result<String, ReportError> {
    let values: Vec<f64> = curve.points.iter().map(|point| point.1).collect();
    let last = curve.points.last().map_or(1.0, |point| point.0);
    drawn(SMALL, |root| {
        let mut chart = ChartBuilder::on(root)
            .margin(8)
            .margin_right(24)
            .caption(&curve.name, ("sans-serif", 14))
            .x_label_area_size(24)
            .y_label_area_size(52)
            .build_cartesian_2d(0.0..last.max(1.0), around(&values))?;
        chart
            .configure_mesh()
            .light_line_style(TRANSPARENT)
            .x_label_formatter(&tick)
            .y_label_formatter(&tick)
            .x_labels(4)
            .y_labels(4)
            .draw()?;
        chart.draw_series(LineSeries::new(curve.points.iter().copied(), ABOVE))?;
        Ok(())
    })
}

/// A chart of rows, the first one on top, with a name of each in so many pixels on the left, and words under it.
fn named_rows<'a, 's>(
    root: &'a Area<'s>,
    names: &[&str],
    width: u32,
    range: Range<f64>,
    words: &str,
) -> Result<Chart<'a, 's>, Box<dyn std::error::Error>> {
    let left = range.start;
    let mut chart = ChartBuilder::on(root)
        .margin(12)
        .margin_right(28)
        .x_label_area_size(36)
        .y_label_area_size(width)
        .build_cartesian_2d(range, 0.0..names.len() as f64)?;
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .x_label_formatter(&tick)
        .y_label_formatter(&tick)
        .disable_y_mesh()
        .y_labels(0)
        // Sizes that follow the height would be too small to read where there are few rows.
        .label_style(("sans-serif", 12))
        .axis_desc_style(("sans-serif", 13))
        .x_desc(words)
        .draw()?;
    for (row, name) in names.iter().enumerate() {
        let at = chart.backend_coord(&(left, middle(row, names.len())));
        let style = ("sans-serif", 13).into_text_style(root);
        root.draw_text(name, &style, (12, at.1 - 8))?;
    }
    Ok(chart)
}

/// How high a row lies among so many.
fn middle(row: usize, rows: usize) -> f64 {
    rows as f64 - 0.5 - row as f64
}

type Chart<'a, 's> = ChartContext<'a, SVGBackend<'s>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;

/// A chart with these ranges and names of its axes, to the right and up.
fn axes<'a, 's>(
    root: &'a Area<'s>,
    right: Range<f64>,
    up: Range<f64>,
    [to_the_right, upwards]: [&str; 2],
) -> Result<Chart<'a, 's>, Box<dyn std::error::Error>> {
    let mut chart = ChartBuilder::on(root)
        .margin(12)
        .margin_right(28)
        .x_label_area_size(36)
        .y_label_area_size(44)
        .build_cartesian_2d(right, up)?;
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .disable_x_mesh()
        .x_label_formatter(&tick)
        .y_label_formatter(&tick)
        .x_desc(to_the_right)
        .y_desc(upwards)
        .draw()?;
    Ok(chart)
}

type Area<'a> = DrawingArea<SVGBackend<'a>, plotters::coord::Shift>;

/// An SVG of this size.
fn drawn(
    size: (u32, u32),
    draw: impl FnOnce(&Area<'_>) -> Result<(), Box<dyn std::error::Error>>,
) -> Result<String, ReportError> {
    let failed = |error: &dyn Display| ReportError::Figure(error.to_string());
    let mut svg = String::new();
    {
        let root = SVGBackend::with_string(&mut svg, size).into_drawing_area();
        draw(&root).map_err(|error| failed(&error))?;
        root.present().map_err(|error| failed(&error))?;
    }
    Ok(svg)
}

/// A number at an axis, without digits that say nothing.
#[expect(
    clippy::trivially_copy_pass_by_ref,
    reason = "the plots' library calls it so"
)]
fn tick(value: &f64) -> String {
    let digits = match value.abs() {
        0.0 | 10.0.. => 0,
        1.0.. => 1,
        0.01.. => 2,
        _ => return format!("{value:.0e}"),
    };
    format!("{value:.digits$}")
}

/// From 0 for the lowest to 1 for the highest.
fn unit(values: &[f64]) -> Vec<f64> {
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let width = if high > low { high - low } else { 1.0 };
    values.iter().map(|value| (value - low) / width).collect()
}

/// A range that holds all values and a little more.
fn around(values: &[f64]) -> Range<f64> {
    let finite = || values.iter().copied().filter(|value| value.is_finite());
    let low = finite().fold(f64::INFINITY, f64::min);
    let high = finite().fold(f64::NEG_INFINITY, f64::max);
    if low > high {
        return 0.0..1.0;
    }
    let room = match high - low {
        0.0 => high.abs().max(1.0) * 0.1,
        width => width * 0.04,
    };
    low - room..high + room
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_range_holds_all_values_also_when_they_are_equal_or_none() {
        assert_eq!(around(&[]), 0.0..1.0);
        assert_eq!(around(&[f64::NAN]), 0.0..1.0);
        let of_one = around(&[5.0]);
        assert!(of_one.contains(&5.0) && of_one.end > of_one.start);
        let wide = around(&[-1.0, 3.0]);
        assert!(wide.contains(&-1.0) && wide.contains(&3.0));
    }

    #[test]
    fn plots_have_a_mark_for_every_episode_and_every_update() {
        let predicted = Predicted {
            returns_hat: vec![1.0, 2.0, 3.0, 3.0],
            returns_true: None,
            border: Some(3.0),
            best: Vec::new(),
            worst: Vec::new(),
        };
        let svg = predicted_against_true(&predicted, &[0.0, 1.0, 2.0, 5.0]).unwrap();
        assert_eq!(svg.matches("<circle").count(), 4);
        assert_eq!(svg.matches("#005CAF").count(), 2, "{svg}");
        assert!(histogram(&predicted).unwrap().contains("episodes"));
        let loss = Curve {
            phase: "iql".to_owned(),
            name: "value_loss".to_owned(),
            points: vec![(500.0, 1.0), (1000.0, 0.5)],
        };
        assert!(curve(&loss).unwrap().contains("value_loss"));
    }
}
