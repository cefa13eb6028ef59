//! V̇ against V: closed curves, cut off by stick.

use super::Settings;
use super::axis::Axis;
use super::diagram::horizontal;
use super::error::PlotError;
use super::legend::{Key, Legend};
use super::palette::{GREY, Pen};
use super::pressure::values_legend;
use super::profile::{NONE, Profile, Profiles};
use super::quantity::Quantity;
use super::sheet::{Panel, Sheet, remark};

/// Tangential velocity of the rotating body: V̇ during stick.
const STICK: f64 = 1.0;

/// Composes the picture.
pub fn compose(profiles: &Profiles, settings: &Settings) -> Result<String, PlotError> {
    let shown = profiles.shown();
    let displacement = Quantity::new("tangential displacement", "V");
    let velocity = Quantity::new("velocity", "V\u{307}");
    let x = horizontal(
        shown
            .iter()
            .flat_map(|one| one.profile.tangential.iter().copied()),
        &displacement,
    );
    let y = if shown.is_empty() {
        Axis::blank(&velocity)
    } else {
        let values = shown
            .iter()
            .flat_map(|one| one.profile.tangential_rate.iter().copied());
        Axis::around(values.chain([STICK]), &velocity, 5)
    };
    let stick = Pen::dashed(GREY, 1.5);
    let mut legend = Legend::default();
    if !shown.is_empty() {
        legend = values_legend(&shown, settings);
        legend.add("", [(Key::Line(stick), "stick, V\u{307} = 1".to_owned())]);
    }
    let sheet = Sheet {
        title: settings.title.clone(),
        panels: vec![Panel::new(x, y)],
        legend,
        right: 0.0,
    };
    sheet.compose(|canvas, frames| {
        for frame in frames {
            if shown.is_empty() {
                remark(canvas, frame, NONE);
                continue;
            }
            for one in &shown {
                let points = orbit(one.profile);
                frame.curve(canvas, points, Pen::solid(one.colour, 1.9));
            }
            let ends = [(frame.x.low, STICK), (frame.x.high, STICK)];
            frame.curve(canvas, ends, stick);
        }
    })
}

/// The curve of a profile; its ends are joined when they meet but for a sample.
fn orbit(profile: &Profile) -> Vec<(f64, f64)> {
    let mut points: Vec<(f64, f64)> = profile
        .tangential
        .iter()
        .copied()
        .zip(profile.tangential_rate.iter().copied())
        .collect();
    let extent = |of: fn(&(f64, f64)) -> f64| {
        let low = points.iter().map(of).fold(f64::INFINITY, f64::min);
        let high = points.iter().map(of).fold(f64::NEG_INFINITY, f64::max);
        high - low
    };
    let (width, height) = (extent(|point| point.0), extent(|point| point.1));
    if let (Some(first), Some(last)) = (points.first().copied(), points.last().copied())
        && (first.0 - last.0).abs() <= 0.1 * width
        && (first.1 - last.1).abs() <= 0.1 * height
    {
        points.push(first);
    }
    points
}
