//! V̇ against V: closed curves, cut off by stick.

use super::names::{displacement, velocity};
use super::profile::{NONE, Profile, Profiles};
use crate::output::render::axis::{Axis, Extent};
use crate::output::render::legend::{Key, Legend};
use crate::output::render::palette::{GREY, Pattern, Pen};
use crate::output::render::{Layer, Panel, Picture, Point};

/// Stick: V̇ is the tangential velocity of the rotating body.
const STICK: Pen = Pen {
    colour: GREY,
    width: 1.5,
    pattern: Pattern::Dashed,
};

/// The picture.
pub(super) fn picture(profiles: &Profiles) -> Picture {
    let shown = profiles.shown();
    let orbits = shown.iter().map(|one| {
        let points = orbit(one.profile);
        Layer::Line(points, Pen::solid(one.colour, 1.9))
    });
    let layers: Vec<Layer> = orbits.chain([stick()]).collect();
    if shown.is_empty() {
        return plane(Layer::remark(NONE), Legend::default());
    }
    plane(layers, explained(profiles.legend(&shown)))
}

/// A picture in the plane of V and V̇.
pub(super) fn plane(layers: Vec<Layer>, legend: Legend) -> Picture {
    let x = Axis::new(displacement(), Extent::Data(0.04));
    let y = Axis::new(velocity(), Extent::Data(0.05));
    Picture::new(vec![Panel::new(x, y, layers)], legend)
}

/// The line of stick.
pub(super) fn stick() -> Layer {
    Layer::Across(1.0, STICK)
}

/// The legend with the line of stick.
pub(super) fn explained(legend: Legend) -> Legend {
    legend.with("", [(Key::Line(STICK), "stick, V\u{307} = 1")])
}

/// The curve of a profile; its ends are joined when they meet but for a sample.
fn orbit(profile: &Profile) -> Vec<Point> {
    let samples = profile.samples.iter();
    let mut points: Vec<Point> = samples
        .map(|sample| (sample.tangential, sample.rate))
        .collect();
    let extent = |of: fn(&Point) -> f64| {
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
