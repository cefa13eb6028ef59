//! Waves over their wavelength, as lines in the colours of the parameter, and friction along one of them.

use super::colours;
use super::names::{
    ANGLE, DISPLACEMENT, LENGTH, STRESS, VELOCITY, occurring, regime_name, short_regime, zone_keys,
};
use super::profile::{DrawnProfile, DrawnSample, NONE, Profiles, Shown};
use crate::output::render::{
    Axis, BLACK, BLUE, ColourCell, Extent, GREY, Heading, Key, Layer, Legend, Panel, Pattern, Pen,
    Picture, Point, Quantity, number,
};

const DASHED: Pen = Pen {
    colour: GREY,
    width: 1.5,
    pattern: Pattern::Dashed,
};

/// Stick: V̇ is the tangential velocity of the rotating body.
pub(super) const STICK: Layer = Layer::Across(1.0, DASHED);

/// A panel over the wavelength.
fn along(quantity: impl Into<Quantity>, room: f64, layers: Vec<Layer>) -> Panel {
    let x = Axis::new(ANGLE, Extent::Data(0.0));
    Panel::new(x, Axis::new(quantity, Extent::Data(room)), layers)
}

/// A line for each wave.
fn lines(
    shown: &[Shown],
    points: impl Fn(&DrawnProfile) -> Vec<Point>,
) -> impl Iterator<Item = Layer> {
    let line = move |one: &Shown| Layer::Line(points(one.profile), Pen::solid(one.colour, 1.9));
    shown.iter().map(line)
}

pub(super) fn pressure(profiles: &Profiles) -> Picture {
    let shown = profiles.shown();
    // Zero is where contact is lost and belongs into the picture.
    let mut layers = vec![Layer::Across(0.0, Pen::solid(GREY, 1.2))];
    layers.extend(lines(&shown, |wave| wave.over(|sample| sample.pressure)));
    let panel = along(("pressure", "P", STRESS), 0.05, layers).unless(shown.is_empty(), NONE);
    Picture::new(vec![panel], profiles.legend(&shown))
}

pub(super) fn wave(profiles: &Profiles) -> Picture {
    let shown = profiles.shown();
    let panel = |quantity, value: fn(&DrawnSample) -> f64| {
        let layers = lines(&shown, |wave| wave.over(value)).collect();
        let panel = along(quantity, 0.06, layers).high(180.0);
        panel.unless(shown.is_empty(), NONE)
    };
    let panels = vec![
        panel(("tangential", "V", LENGTH), |sample| sample.tangential),
        panel(("radial", "U", LENGTH), |sample| sample.radial),
    ];
    Picture::new(panels, profiles.legend(&shown))
}

/// V̇ against V: closed curves, cut off by stick.
pub(super) fn phase_plane(profiles: &Profiles) -> Picture {
    let shown = profiles.shown();
    if shown.is_empty() {
        let nothing = vec![Layer::Remark(NONE.to_owned())];
        return plane(nothing, Legend::default());
    }
    let layers = lines(&shown, orbit).chain([STICK]).collect();
    plane(layers, profiles.legend(&shown))
}

/// A picture in the plane of V and V̇.
pub(super) fn plane(layers: Vec<Layer>, mut legend: Legend) -> Picture {
    if layers.contains(&STICK) {
        legend = legend.with("", [(Key::Line(DASHED), "stick, V\u{307} = 1")]);
    }
    let x = Axis::new(DISPLACEMENT, Extent::Data(0.04));
    let panel = Panel::new(x, Axis::new(VELOCITY, Extent::Data(0.05)), layers);
    Picture::new(vec![panel], legend)
}

/// The curve of a profile; its ends are joined when they meet but for a sample.
fn orbit(profile: &DrawnProfile) -> Vec<Point> {
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

/// Friction force with its bounds and relative velocity of one wave.
pub(super) fn friction(profiles: &Profiles) -> Picture {
    // A wave that was asked for, if there is one; of several the richest; of several of these the one
    // with the least parameter, where zones are widest apart.
    let waves = profiles.all.iter().rev();
    let chosen = waves.max_by_key(|profile| (profile.asked_for, profile.zones().len()));
    let (force, velocity, legend) = match chosen {
        Some(profile) => friction_along(profile, profiles.parameter.short()),
        None => Default::default(),
    };
    let force = along(("friction force", "Q", STRESS), 0.05, force).high(180.0);
    let velocity = along(("velocity", "1 − V\u{307}", VELOCITY.2), 0.05, velocity).high(140.0);
    Picture::new(vec![force.unless(chosen.is_none(), NONE), velocity], legend)
}

/// What is drawn of the friction force, what of the velocity, and the legend.
fn friction_along(profile: &DrawnProfile, parameter: &str) -> (Vec<Layer>, Vec<Layer>, Legend) {
    let zones = profile.zones();
    let shades = zones
        .iter()
        .map(|zone| ColourCell::upright(zone.from, zone.to, colours::of_zone(zone.regime)));
    let headings = zones.iter().map(|zone| Heading {
        ends: [zone.from, zone.to],
        names: vec![
            regime_name(zone.regime).to_owned(),
            short_regime(zone.regime).to_owned(),
        ],
    });
    let (curve, bound) = (Pen::solid(BLACK, 2.2), Pen::dashed(BLUE, 1.8));
    let mut velocity = vec![
        Layer::Cells(shades.collect()),
        Layer::Across(0.0, Pen::solid(GREY, 1.2)),
    ];
    let mut force = velocity.clone();
    force.push(Layer::Headings(headings.collect()));
    force.push(Layer::Line(profile.over(|sample| sample.shear), curve));
    velocity.push(Layer::Line(profile.over(|sample| 1.0 - sample.rate), curve));
    let mut explained = vec![(Key::Line(curve), "Q")];
    if let Some(friction) = profile.friction {
        for coefficient in [friction, -friction] {
            let limit = profile.over(|sample| coefficient * sample.pressure);
            force.push(Layer::Line(limit, bound));
        }
        explained.push((Key::Line(bound), "±f P"));
    }
    let heading = match profile.parameter {
        Some(value) => format!("at {parameter} = {}:", number::significant(value, 4)),
        None => format!("at label {}:", profile.label),
    };
    let regimes = occurring(zones.iter().map(|zone| zone.regime));
    let legend = Legend::default()
        .with(&heading, explained)
        .with("", zone_keys(&regimes));
    (force, velocity, legend)
}
