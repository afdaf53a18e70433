//! A clip as a small moving picture: stills of the robot, or else places in space from above and from the front, or else curves.

use std::fmt::Write as _;

use axum::body::Bytes;
use data_encoding::BASE64;
use maud::{Markup, html};

use super::shot::Shot;
use crate::ask::{Mark, Picture, Place};

/// Width and height of each view.
const SIDE: f64 = 130.0;
/// Height of the line above it that says what it is.
const TITLE: f64 = 14.0;
/// Space around what moves.
const MARGIN: f64 = 8.0;
/// Points of a path: more would make the file long, and show nobody more.
const POINTS: usize = 48;
/// Curves that are drawn where there are no places.
const CURVES: usize = 8;

/// Two coordinates of a place that a view shows: to the right, and up.
const VIEWS: [(&str, [usize; 2]); 2] = [("from above", [0, 1]), ("from the front", [0, 2])];

/// Clips side by side, in one scale, each with its caption.
pub(super) fn clips<'a>(shots: impl IntoIterator<Item = (&'a Shot, String)>) -> Markup {
    let shots: Vec<(&Shot, String)> = shots.into_iter().collect();
    let frame = Frame::around(shots.iter().map(|(shot, _)| &shot.picture));
    html! {
        div .clips {
            @for (Shot { picture, stills }, caption) in &shots {
                figure {
                    figcaption { (caption) }
                    @if !stills.is_empty() { (film(picture, stills, caption)) }
                    @else if picture.places.is_empty() { (curves(picture)) }
                    @else { @for (name, axes) in VIEWS { (view(picture, name, axes, &frame, caption)) } }
                }
            }
        }
    }
}

/// The names of the places, each with its mark, where they are what is drawn.
pub(super) fn legend(shot: &Shot) -> Markup {
    let places = shot.picture.places.iter().zip(colours());
    html! {
        @if shot.stills.is_empty() {
            p .legend {
                @for (place, colour) in places {
                    svg width="14" height="14" viewBox="-7 -7 14 14" aria-hidden="true" { path d=(shape(place.mark)) style=(paint(place.mark, colour)) {} }
                    " " (place.name) " "
                }
            }
        }
    }
}

/// How long a clip takes to show.
fn seconds(picture: &Picture) -> f64 {
    (picture.frames as f64 * picture.period_s).clamp(2.0, 6.0)
}

/// Stills one after the other. The last one lies below: it is what is seen where nothing moves.
fn film(picture: &Picture, stills: &[Bytes], caption: &str) -> Markup {
    let (count, seconds) = (stills.len() as f64, seconds(picture));
    let data = |jpeg: &Bytes| format!("data:image/jpeg;base64,{}", BASE64.encode(jpeg));
    let Some((last, before)) = stills.split_last() else {
        return html! {};
    };
    html! {
        svg .film width="240" height="180" role="img" aria-label=(caption) {
            image href=(data(last)) width="240" height="180" {}
            @for (number, still) in before.iter().enumerate() {
                image .moves href=(data(still)) width="240" height="180" opacity="0" {
                    animate attributeName="opacity" calcMode="discrete" repeatCount="indefinite" dur=(format!("{seconds:.1}s"))
                        values="0;1;0" keyTimes=(format!("0;{:.4};{:.4}", number as f64 / count, (number + 1) as f64 / count)) {}
                }
            }
        }
    }
}

/// What all clips beside each other lie in.
struct Frame {
    low: [f64; 3],
    scale: f64,
}

impl Frame {
    fn around<'a>(pictures: impl Iterator<Item = &'a Picture>) -> Self {
        let places = pictures.flat_map(|picture| &picture.places);
        let mut low = [f64::INFINITY; 3];
        let mut high = [f64::NEG_INFINITY; 3];
        for point in places.flat_map(|place| &place.path) {
            for (axis, &value) in point.iter().enumerate() {
                low[axis] = low[axis].min(value.into());
                high[axis] = high[axis].max(value.into());
            }
        }
        // One scale for all axes: else a short way would look like a long one.
        let width = (0..3)
            .map(|axis| high[axis] - low[axis])
            .fold(0.0, f64::max);
        let scale = if width > 0.0 {
            (SIDE - 2.0 * MARGIN) / width
        } else {
            1.0
        };
        Self { low, scale }
    }

    fn at(&self, point: [f32; 3], axes: [usize; 2]) -> (f64, f64) {
        let [right, up] = axes.map(|axis| (f64::from(point[axis]) - self.low[axis]) * self.scale);
        (MARGIN + right, TITLE + SIDE - MARGIN - up)
    }
}

fn view(picture: &Picture, name: &str, axes: [usize; 2], frame: &Frame, caption: &str) -> Markup {
    let seconds = seconds(picture);
    let label = format!("{caption}, {name}");
    html! {
        svg .view width=(SIDE) height=(SIDE + TITLE) viewBox={ "0 0 " (SIDE) " " (SIDE + TITLE) } role="img" aria-label=(label) {
            @for (place, colour) in picture.places.iter().zip(colours()) {
                (moving(place, colour, axes, frame, seconds))
            }
            text x="4" y="11" { (name) }
        }
    }
}

/// A place: the way it goes, where it ends, and a mark that goes the way.
fn moving(place: &Place, colour: &str, axes: [usize; 2], frame: &Frame, seconds: f64) -> Markup {
    let path: Vec<(f64, f64)> = thinned(&place.path)
        .map(|&point| frame.at(point, axes))
        .collect();
    let (mut way, mut values) = (String::new(), String::new());
    for (number, (x, y)) in path.iter().enumerate() {
        let _ = write!(way, "{x:.1},{y:.1} ");
        let _ = write!(
            values,
            "{}{x:.1},{y:.1}",
            if number == 0 { "" } else { ";" }
        );
    }
    let (x, y) = path.last().copied().unwrap_or_default();
    html! {
        polyline points=(way.trim_end()) fill="none" stroke=(colour) stroke-opacity="0.4" {}
        path d=(shape(place.mark)) style=(paint(place.mark, colour)) opacity="0.35" transform=(format!("translate({x:.1},{y:.1})")) {}
        g .moves {
            animateTransform attributeName="transform" type="translate" values=(values) dur=(format!("{seconds:.1}s")) repeatCount="indefinite" {}
            path d=(shape(place.mark)) style=(paint(place.mark, colour)) {}
        }
    }
}

/// The first curves of what was observed, and of what was done.
fn curves(picture: &Picture) -> Markup {
    let tracks: Vec<_> = picture.plots.iter().chain(&picture.actions).collect();
    let left = tracks.len().saturating_sub(CURVES);
    html! {
        table .curves {
            @for track in tracks.iter().take(CURVES) {
                tr { td { (track.name) } td { (sparkline(&track.values)) } }
            }
        }
        @if left > 0 { p .small { "and " (left) " more numbers" } }
    }
}

fn sparkline(values: &[f32]) -> Markup {
    const HEIGHT: f32 = 22.0;
    let low = values.iter().copied().fold(f32::INFINITY, f32::min);
    let high = values.iter().copied().fold(f32::NEG_INFINITY, f32::max);
    let width = if high > low { high - low } else { 1.0 };
    let few: Vec<f32> = thinned(values).copied().collect();
    let step = SIDE as f32 / few.len().max(2) as f32;
    let mut way = String::new();
    for (number, value) in few.iter().enumerate() {
        let y = 2.0 + (HEIGHT - 4.0) * (1.0 - (value - low) / width);
        let _ = write!(way, "{:.1},{y:.1} ", step * number as f32);
    }
    html! {
        svg width=(SIDE) height=(HEIGHT) aria-hidden="true" {
            polyline points=(way.trim_end()) fill="none" stroke="#005caf" {}
        }
    }
}

/// At most [`POINTS`] of them, the last one among them.
fn thinned<T>(all: &[T]) -> impl Iterator<Item = &T> {
    let stride = all.len().div_ceil(POINTS).max(1);
    let last = all.len().saturating_sub(1);
    (all.iter().enumerate()).filter_map(move |(i, it)| (i % stride == 0 || i == last).then_some(it))
}

/// Colours that people tell apart who see few (Okabe and Ito).
fn colours() -> impl Iterator<Item = &'static str> {
    ["#d55e00", "#0072b2", "#009e73", "#cc79a7"]
        .into_iter()
        .cycle()
}

fn shape(mark: Mark) -> &'static str {
    match mark {
        Mark::Circle => "M-4 0a4 4 0 1 0 8 0a4 4 0 1 0-8 0",
        Mark::Square => "M-4-4h8v8h-8z",
        Mark::Triangle => "M0-5l5 9h-10z",
        Mark::Cross => "M-4-4l8 8M-4 4l8-8",
    }
}

fn paint(mark: Mark, colour: &str) -> String {
    match mark {
        Mark::Cross => format!("fill:none;stroke:{colour};stroke-width:2"),
        _ => format!("fill:{colour}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_is_thinned_and_keeps_its_end() {
        let all: Vec<usize> = (0..500).collect();
        let few: Vec<usize> = thinned(&all).copied().collect();
        assert!(few.len() <= POINTS + 1, "{}", few.len());
        assert_eq!((few[0], few[few.len() - 1]), (0, 499));
        assert_eq!(thinned::<u8>(&[]).count(), 0);
    }
}
