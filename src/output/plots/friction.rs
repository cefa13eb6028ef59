//! Friction force with its bounds and relative velocity of one wave.

use super::Settings;
use super::axis::{Axis, TICK_SIZE};
use super::canvas::{Align, Canvas, text_width};
use super::error::PlotError;
use super::frame::Frame;
use super::legend::{Key, Legend};
use super::palette::{self, BLACK, BLUE, GREY, Pen};
use super::pressure::along;
use super::profile::{NONE, Profile, Profiles, Shown};
use super::quantity::{Quantity, short_regime};
use super::sheet::{Panel, Sheet, remark};

/// Composes the picture.
pub fn compose(profiles: &Profiles, settings: &Settings) -> Result<String, PlotError> {
    // A wave that was asked for, if there is one; of several the richest; of several of these the one
    // with the least parameter, where zones are widest apart.
    let chosen = profiles
        .all
        .iter()
        .rev()
        .max_by_key(|profile| (profile.asked_for, profile.zones().len()));
    let force = Quantity::new("friction force", "Q");
    let velocity = Quantity::new("velocity", "1 − V\u{307}");
    let Some(profile) = chosen else {
        let x = along(&[]);
        return panels(
            settings,
            x,
            Axis::blank(&force),
            Axis::blank(&velocity),
            None,
        );
    };
    let bound = bound(profile);
    let forces = profile
        .shear
        .iter()
        .copied()
        .chain(bound.iter().flat_map(|value| [*value, -*value]));
    let relative: Vec<f64> = profile
        .tangential_rate
        .iter()
        .map(|rate| 1.0 - rate)
        .collect();
    let shown = Shown {
        profile,
        colour: BLACK,
        text: String::new(),
    };
    panels(
        settings,
        along(&[shown]),
        Axis::around(forces.chain([0.0]), &force, 4),
        Axis::around(relative.iter().copied().chain([0.0]), &velocity, 3),
        Some((profile, bound, relative)),
    )
}

/// Bound f P of the friction force; empty when f is not known.
fn bound(profile: &Profile) -> Vec<f64> {
    match profile.friction {
        Some(friction) => profile.pressure.iter().map(|p| friction * p).collect(),
        None => Vec::new(),
    }
}

/// Composes the two panels with what is known of the wave: profile, bound, relative velocity.
fn panels(
    settings: &Settings,
    x: Axis,
    force: Axis,
    velocity: Axis,
    wave: Option<(&Profile, Vec<f64>, Vec<f64>)>,
) -> Result<String, PlotError> {
    let mut legend = Legend::default();
    let force_pen = Pen::solid(BLACK, 2.2);
    let bound_pen = Pen::dashed(BLUE, 1.8);
    if let Some((profile, bound, _)) = &wave {
        let mut lines = vec![(Key::Line(force_pen), "Q".to_owned())];
        if !bound.is_empty() {
            lines.push((Key::Line(bound_pen), "±f P".to_owned()));
        }
        let heading = match profile.parameter {
            Some(value) => {
                let quantity = Quantity::of_column(&settings.parameter);
                let value = super::number::significant(value, 4);
                format!("at {} = {value}:", quantity.short())
            }
            None => format!("at label {}:", profile.label),
        };
        legend.add(&heading, lines);
        let mut regimes: Vec<&str> = Vec::new();
        for zone in profile.zones() {
            if !regimes.contains(&zone.regime) {
                regimes.push(zone.regime);
            }
        }
        legend.add(
            "",
            regimes
                .iter()
                .map(|name| (Key::Area(palette::zone(name)), (*name).to_owned())),
        );
    }
    let sheet = Sheet {
        title: settings.title.clone(),
        panels: vec![
            Panel {
                height: 180.0,
                above: if wave.is_some() { 12.0 } else { 0.0 },
                labelled_below: false,
                ..Panel::new(x.clone(), force)
            },
            Panel {
                height: 140.0,
                above: 14.0,
                ..Panel::new(x, velocity)
            },
        ],
        legend,
        right: 0.0,
    };
    sheet.compose(|canvas, frames| {
        let [upper, lower] = frames else {
            return;
        };
        let Some((profile, bound, relative)) = &wave else {
            remark(canvas, upper, NONE);
            return;
        };
        let over = |values: &[f64], sign: f64| -> Vec<(f64, f64)> {
            let theta = profile.theta.iter().copied();
            theta.zip(values.iter().map(|value| sign * value)).collect()
        };
        for frame in [upper, lower] {
            zones(canvas, frame, profile);
            let ends = [(frame.x.low, 0.0), (frame.x.high, 0.0)];
            frame.curve(canvas, ends, Pen::solid(GREY, 1.2));
        }
        names(canvas, upper, profile);
        upper.curve(canvas, over(&profile.shear, 1.0), force_pen);
        upper.curve(canvas, over(bound, 1.0), bound_pen);
        upper.curve(canvas, over(bound, -1.0), bound_pen);
        lower.curve(canvas, over(relative, 1.0), force_pen);
    })
}

/// Shades the zones behind the curves.
fn zones(canvas: &mut Canvas<'_>, frame: &Frame, profile: &Profile) {
    for zone in profile.zones() {
        let from = frame.place(zone.from, frame.y.low);
        let to = frame.place(zone.to, frame.y.high);
        if let (Some(from), Some(to)) = (from, to) {
            canvas.area(from, to, palette::zone(zone.regime));
        }
    }
}

/// Writes the names of the zones above the frame, shortened or not at all where they are narrow.
fn names(canvas: &mut Canvas<'_>, frame: &Frame, profile: &Profile) {
    let size = 0.88 * TICK_SIZE;
    for zone in profile.zones() {
        let from = frame.place(zone.from, frame.y.high);
        let to = frame.place(zone.to, frame.y.high);
        let (Some(from), Some(to)) = (from, to) else {
            continue;
        };
        let candidates = [zone.regime.to_owned(), short_regime(zone.regime)];
        let fitting = candidates
            .iter()
            .find(|text| text_width(text, size) <= to.0 - from.0);
        if let Some(text) = fitting {
            let place = (0.5 * (from.0 + to.0), from.1 - 5.0);
            canvas.text(place, text, size, Align::Middle);
        }
    }
}
