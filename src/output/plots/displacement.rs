//! Radial displacement over the wavelength, one profile above the other.
//!
//! In contact U is the mismatch itself, and where the surfaces part U − δ is small beside the
//! differences of δ. Each profile therefore stands on a base line of its own, and the regimes
//! show in its colours.

use super::Settings;
use super::axis::{Axis, TICK_SIZE, Tick, drawable};
use super::canvas::{Align, Canvas, Shape};
use super::error::PlotError;
use super::frame::Frame;
use super::legend::{Key, Legend};
use super::number;
use super::palette::{self, BLACK, GREY, Pen};
use super::pressure::along;
use super::profile::{NONE, Profiles, Shown};
use super::quantity::Quantity;
use super::sheet::{HEIGHT, Panel, Sheet, remark};

/// Height of the largest gap in distances between base lines.
const PEAK: f64 = 1.25;

/// Place where the regime changes on a base line.
struct Change<'a> {
    from: &'a str,
    to: &'a str,
    /// Number of the change among those between the same regimes.
    rank: usize,
    theta: f64,
    height: f64,
}

/// Composes the picture.
pub fn compose(profiles: &Profiles, settings: &Settings) -> Result<String, PlotError> {
    let shown = along_branch(profiles.shown());
    let largest = largest_gap(&shown);
    let scale = largest.map_or(0.0, |gap| PEAK / gap);
    let mut legend = Legend::default();
    let mut regimes: Vec<&str> = Vec::new();
    for name in shown.iter().flat_map(|one| one.profile.regimes.iter()) {
        if !regimes.contains(&name.as_str()) {
            regimes.push(name);
        }
    }
    legend.add(
        "",
        regimes.iter().map(|name| {
            let pen = Pen::solid(palette::regime(name), 2.6);
            (Key::Line(pen), (*name).to_owned())
        }),
    );
    if !shown.is_empty() {
        let key = Key::Point(Shape::Circle, 2.6, BLACK);
        legend.add("", [(key, "switching points".to_owned())]);
        if largest.is_none() {
            legend.add("U = δ throughout: no separation", []);
        }
    }

    let panel = Panel {
        height: if shown.len() > 5 {
            1.15 * HEIGHT
        } else {
            HEIGHT
        },
        ..Panel::new(along(&shown), base_lines(&shown, settings, scale))
    };
    let bar = largest.map(scale_bar);
    let sheet = Sheet {
        title: settings.title.clone(),
        panels: vec![panel],
        legend,
        right: if bar.is_some() { 74.0 } else { 0.0 },
    };
    sheet.compose(|canvas, frames| {
        for frame in frames {
            if shown.is_empty() {
                remark(canvas, frame, NONE);
                continue;
            }
            for index in 0..shown.len() {
                let ends = [(frame.x.low, index as f64), (frame.x.high, index as f64)];
                frame.curve(
                    canvas,
                    ends,
                    Pen::solid(palette::mix(palette::WHITE, GREY, 0.45), 1.2),
                );
            }
            loci(canvas, frame, &shown, scale);
            // From the top down: a high gap stands before the profile above it.
            for (index, one) in shown.iter().enumerate().rev() {
                let gap = one.profile.gap();
                for zone in one.profile.zones() {
                    let points = zone.samples.clone().map(|sample| {
                        (
                            one.profile.theta[sample],
                            index as f64 + scale * gap[sample],
                        )
                    });
                    let pen = Pen::solid(palette::regime(zone.regime), 2.6);
                    frame.curve(canvas, points, pen);
                }
                for change in changes(one, scale) {
                    if let Some(place) = frame.place(change.theta, index as f64 + change.height) {
                        canvas.point(place, Shape::Circle, 2.6, BLACK);
                    }
                }
            }
            if let Some((length, text)) = &bar {
                paint_bar(canvas, frame, scale * length, text);
            }
        }
    })
}

/// The profiles in the order of the branch where it turns back between them: only neighbours on
/// the branch have switching points that belong together.
fn along_branch(mut shown: Vec<Shown<'_>>) -> Vec<Shown<'_>> {
    let rising = shown.is_sorted_by_key(|one| one.profile.position);
    let falling = shown.is_sorted_by_key(|one| std::cmp::Reverse(one.profile.position));
    if !(rising || falling) {
        shown.sort_by_key(|one| one.profile.position);
    }
    shown
}

/// The vertical axis: a tick per profile.
fn base_lines(shown: &[Shown<'_>], settings: &Settings, scale: f64) -> Axis {
    let quantity = Quantity::of_column(&settings.parameter);
    if shown.is_empty() {
        return Axis::blank(&Quantity::new("radial displacement", "U"));
    }
    let highest = shown
        .iter()
        .enumerate()
        .flat_map(|(index, one)| {
            let heights = one.profile.gap().into_iter();
            heights.map(move |gap| index as f64 + scale * gap)
        })
        .filter(|height| drawable(*height))
        .fold(shown.len() as f64 - 1.0, f64::max);
    Axis {
        low: -0.6,
        high: highest + 0.6,
        ticks: shown
            .iter()
            .enumerate()
            .map(|(index, one)| Tick {
                value: index as f64,
                text: one.text.clone(),
            })
            .collect(),
        caption: format!("U − δ at {}", quantity.caption()),
    }
}

/// The largest |U − δ|; none when the surfaces never part but for rounding.
fn largest_gap(shown: &[Shown<'_>]) -> Option<f64> {
    let extreme = |values: Vec<f64>| {
        values
            .into_iter()
            .filter(|value| drawable(*value))
            .fold(0.0, |largest, value| f64::max(largest, value.abs()))
    };
    let largest = shown
        .iter()
        .map(|one| extreme(one.profile.gap()))
        .fold(0.0, f64::max);
    let whole = shown
        .iter()
        .map(|one| extreme(one.profile.radial.clone()))
        .fold(0.0, f64::max);
    (largest > 1e-9 * whole && largest > 1e-200).then_some(largest)
}

/// A round length for the scale bar, at most the largest gap, and its text.
fn scale_bar(largest: f64) -> (f64, String) {
    let power = 10f64.powi(number::decade(largest));
    let factor = [5.0, 2.0, 1.0]
        .into_iter()
        .find(|factor| factor * power <= largest)
        .unwrap_or(1.0);
    let length = factor * power;
    (length, number::significant(length, 1))
}

/// Draws the scale bar right of the frame, standing on the uppermost base line.
fn paint_bar(canvas: &mut Canvas<'_>, frame: &Frame, height: f64, text: &str) {
    let base = frame.y.ticks.last().map_or(0.0, |tick| tick.value);
    let right = frame.x.high;
    let (Some(foot), Some(head)) = (frame.place(right, base), frame.place(right, base + height))
    else {
        return;
    };
    let x = foot.0 + 12.0;
    let pen = Pen::solid(BLACK, 1.6);
    canvas.line(&[(x, foot.1), (x, head.1)], pen);
    for y in [foot.1, head.1] {
        canvas.line(&[(x - 4.0, y), (x + 4.0, y)], pen);
    }
    let size = 0.88 * TICK_SIZE;
    let middle = 0.5 * (foot.1 + head.1);
    canvas.text((x + 8.0, middle - 1.0), "U − δ:", size, Align::Left);
    canvas.text((x + 8.0, middle + 1.1 * size), text, size, Align::Left);
}

/// Places where the regime changes along a profile, heights in distances of base lines.
fn changes<'a>(one: &Shown<'a>, scale: f64) -> Vec<Change<'a>> {
    let gap = one.profile.gap();
    let zones = one.profile.zones();
    let mut changes: Vec<Change<'a>> = Vec::new();
    for pair in zones.windows(2) {
        let (from, to) = (pair[0].regime, pair[1].regime);
        let same = changes
            .iter()
            .filter(|other| other.from == from && other.to == to);
        changes.push(Change {
            from,
            to,
            rank: same.count(),
            theta: pair[1].from,
            height: scale * gap[pair[1].samples.start],
        });
    }
    changes
}

/// Joins the same change on neighbouring profiles.
fn loci(canvas: &mut Canvas<'_>, frame: &Frame, shown: &[Shown<'_>], scale: f64) {
    for (index, pair) in shown.windows(2).enumerate() {
        let above = changes(&pair[1], scale);
        for change in changes(&pair[0], scale) {
            let partner = above.iter().find(|other| {
                (other.from, other.to, other.rank) == (change.from, change.to, change.rank)
            });
            if let Some(partner) = partner {
                let points = [
                    (change.theta, index as f64 + change.height),
                    (partner.theta, index as f64 + 1.0 + partner.height),
                ];
                frame.curve(canvas, points, Pen::dashed(GREY, 1.3));
            }
        }
    }
}
