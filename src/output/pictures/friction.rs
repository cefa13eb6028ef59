//! Friction force with its bounds and relative velocity of one wave.

use super::names::{angle, occurring, short_regime, zone_colour, zone_keys};
use super::profile::{NONE, Profile, Profiles};
use crate::output::render::axis::{Axis, Extent, Quantity};
use crate::output::render::legend::{Key, Legend};
use crate::output::render::palette::{BLACK, BLUE, GREY, Pen};
use crate::output::render::{Cell, Heading, Layer, Panel, Picture, number};

/// The picture.
pub(super) fn picture(profiles: &Profiles) -> Picture {
    // A wave that was asked for, if there is one; of several the richest; of several of these the one
    // with the least parameter, where zones are widest apart.
    let chosen = profiles
        .all
        .iter()
        .rev()
        .max_by_key(|profile| (profile.asked_for, profile.zones().len()));
    let panel = |quantity, layers, height| {
        let x = Axis::new(angle(), Extent::Data(0.0));
        Panel::new(x, Axis::new(quantity, Extent::Data(0.05)), layers).high(height)
    };
    let (force, velocity, legend) = match chosen {
        Some(profile) => of(profile, profiles.parameter.short()),
        None => (Layer::remark(NONE), Vec::new(), Legend::default()),
    };
    let panels = vec![
        panel(Quantity::new("friction force", "Q"), force, 180.0),
        panel(Quantity::new("velocity", "1 − V\u{307}"), velocity, 140.0),
    ];
    Picture::new(panels, legend)
}

/// What is drawn of the friction force, what of the velocity, and the legend.
fn of(profile: &Profile, parameter: &str) -> (Vec<Layer>, Vec<Layer>, Legend) {
    let zones = profile.zones();
    let shades = zones.iter().map(|zone| Cell {
        from: (zone.from, f64::NEG_INFINITY),
        to: (zone.to, f64::INFINITY),
        colour: zone_colour(zone.regime),
    });
    let headings = zones.iter().map(|zone| Heading {
        ends: [zone.from, zone.to],
        names: vec![zone.regime.to_owned(), short_regime(zone.regime)],
    });
    let (curve, bound) = (Pen::solid(BLACK, 2.2), Pen::dashed(BLUE, 1.8));
    let below = vec![
        Layer::Cells(shades.collect()),
        Layer::Across(0.0, Pen::solid(GREY, 1.2)),
    ];
    let mut above = below.clone();
    above.push(Layer::Headings(headings.collect()));
    above.push(Layer::Line(profile.over(|sample| sample.shear), curve));
    let mut lines = vec![(Key::Line(curve), "Q")];
    if let Some(friction) = profile.friction {
        for coefficient in [friction, -friction] {
            let limit = profile.over(|sample| coefficient * sample.pressure);
            above.push(Layer::Line(limit, bound));
        }
        lines.push((Key::Line(bound), "±f P"));
    }
    let heading = match profile.parameter {
        Some(value) => format!("at {parameter} = {}:", number::significant(value, 4)),
        None => format!("at label {}:", profile.label),
    };
    let regimes = occurring(zones.iter().map(|zone| zone.regime));
    let legend = Legend::default()
        .with(&heading, lines)
        .with("", zone_keys(&regimes));
    let mut velocity = below;
    velocity.push(Layer::Line(profile.over(|sample| 1.0 - sample.rate), curve));
    (above, velocity, legend)
}
