//! Radial displacement over the wavelength, one profile above the other.
//!
//! In contact U is the mismatch itself, and where the surfaces part U − δ is small beside the
//! differences of δ. Each profile therefore stands on a base line of its own, and the regimes
//! show in its colours.

use super::colours;
use super::names::{ANGLE, LENGTH, occurring, regime_name};
use super::profile::{DrawnProfile, DrawnSample, NONE, Profiles, Shown};
use crate::output::render::{
    Axis, BLACK, Extent, GREY, HEIGHT, Key, Layer, Legend, Mark, MarkShape, Panel, Pen, Picture,
    Point, Tick, WHITE, drawable, mix, number,
};
use crate::tube::model::signature::Regime;

/// Height of the largest gap in distances between base lines.
const PEAK: f64 = 1.25;

/// Room below the first and above the last profile, in the same distances.
const EDGE: f64 = 0.6;

/// A profile on its base line.
struct Raised<'a> {
    profile: &'a DrawnProfile,
    points: Vec<Point>,
}

/// Place where the regime changes on a base line.
struct RegimeChange {
    /// The regimes, and the number of the change among those between the same.
    between: (Option<Regime>, Option<Regime>, usize),
    at: Point,
}

pub(super) fn picture(profiles: &Profiles) -> Picture {
    let shown = along_branch(profiles.shown());
    let x = Axis::new(ANGLE, Extent::Data(0.0));
    if shown.is_empty() {
        let y = Axis::new(("radial displacement", "U", LENGTH), Extent::Data(0.0));
        let panel = Panel::new(x, y, Vec::new()).unless(true, NONE);
        return Picture::new(vec![panel], Legend::default());
    }
    let largest = largest_gap(&shown);
    let scale = largest.map_or(0.0, |gap| PEAK / gap);
    let raised: Vec<Raised<'_>> = shown
        .iter()
        .enumerate()
        .map(|(index, one)| {
            let (profile, contact) = (one.profile, one.profile.contact());
            let height = |sample: &DrawnSample| index as f64 + scale * (sample.radial - contact);
            let points = profile.over(height);
            Raised { profile, points }
        })
        .collect();
    let changes: Vec<Vec<RegimeChange>> = raised.iter().map(Raised::changes).collect();
    let point = Mark::new(MarkShape::Circle, 2.6, BLACK);

    let mut layers = raised_layers(&raised, &changes, point);
    layers.extend(largest.map(|gap| bar(gap, 0.0, scale)));

    let heights = raised
        .iter()
        .flat_map(|one| one.points.iter().map(|point| point.1));
    let highest = heights
        .filter(|height| drawable(*height))
        .fold(shown.len() as f64 - 1.0, f64::max);
    let mut y = Axis::new(
        profiles.parameter.clone(),
        Extent::Fixed(-EDGE, highest + EDGE),
    );
    y.quantity.word = format!("U − δ at {}", y.quantity.word)
        .trim_end()
        .to_owned();
    let ticks = shown.iter().enumerate().map(|(index, one)| Tick {
        value: index as f64,
        text: one.text.clone(),
    });
    y.ticks = ticks.collect();
    let height = if shown.len() > 5 {
        1.15 * HEIGHT
    } else {
        HEIGHT
    };

    let legend = legend(&shown, largest.is_some(), point);
    Picture::new(vec![Panel::new(x, y, layers).high(height)], legend)
}

/// The regimes that occur, and what marks a switching point and a gap.
fn legend(shown: &[Shown<'_>], has_gap: bool, point: Mark) -> Legend {
    let samples = shown.iter().flat_map(|one| &one.profile.samples);
    let regimes = occurring(samples.map(|sample| sample.regime)).into_iter();
    let apart = (
        Key::Area(colours::of_zone(Some(Regime::Separation))),
        "apart",
    );
    let apart = has_gap.then_some(apart);
    let mut legend = Legend::default()
        .with(
            "",
            regimes.map(|regime| {
                let pen = Pen::solid(colours::of_regime(regime), 2.6);
                (Key::Line(pen), regime_name(regime))
            }),
        )
        .with(
            "",
            [(Key::Mark(point), "switching points")]
                .into_iter()
                .chain(apart),
        );
    if !has_gap {
        legend = legend.with::<&str>("U = δ throughout: no separation", []);
    }
    legend
}

/// The profiles on their base lines, with the loci and places of switches.
fn raised_layers(raised: &[Raised<'_>], changes: &[Vec<RegimeChange>], point: Mark) -> Vec<Layer> {
    let base = Pen::solid(mix(WHITE, GREY, 0.45), 1.2);
    let bases = (0..raised.len()).map(|index| Layer::Across(index as f64, base));
    let mut layers: Vec<Layer> = bases.chain(loci(changes)).collect();
    // From the top down: a high gap stands before the profile above it.
    for (one, changes) in raised.iter().zip(changes).rev() {
        for zone in one.profile.zones() {
            if zone.regime == Some(Regime::Separation) {
                let gap = one.points[zone.samples.clone()].to_vec();
                layers.push(Layer::Area(gap, colours::of_zone(zone.regime)));
            }
            let pen = Pen::solid(colours::of_regime(zone.regime), 2.6);
            layers.push(Layer::Line(one.points[zone.samples].to_vec(), pen));
        }
        let places = changes.iter().map(|change| change.at).collect();
        layers.push(Layer::Marks(places, point));
    }
    layers
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

/// The largest |U − δ|; none when the surfaces never part but for rounding.
fn largest_gap(shown: &[Shown<'_>]) -> Option<f64> {
    let (mut largest, mut whole) = (0.0_f64, 0.0_f64);
    for Shown { profile, .. } in shown {
        let contact = profile.contact();
        for sample in profile
            .samples
            .iter()
            .filter(|sample| drawable(sample.radial))
        {
            largest = largest.max((sample.radial - contact).abs());
            whole = whole.max(sample.radial.abs());
        }
    }
    (largest > 1e-9 * whole && largest > 1e-200).then_some(largest)
}

/// A bar of a round length, at most the largest gap, on the lowest base line.
fn bar(largest: f64, foot: f64, scale: f64) -> Layer {
    let power = 10f64.powi(number::decade(largest));
    let lengths = [5.0, 2.0, 1.0].map(|factor| factor * power);
    let fitting = lengths.into_iter().find(|length| *length <= largest);
    let length = fitting.unwrap_or(power);
    Layer::Bar {
        foot,
        head: foot + scale * length,
        text: ["U − δ:".to_owned(), number::significant(length, 1)],
    }
}

impl Raised<'_> {
    /// Places where the regime changes along the profile.
    fn changes(&self) -> Vec<RegimeChange> {
        let mut changes: Vec<RegimeChange> = Vec::new();
        for pair in self.profile.zones().windows(2) {
            let (from, to) = (pair[0].regime, pair[1].regime);
            let same = |other: &&RegimeChange| (other.between.0, other.between.1) == (from, to);
            let rank = changes.iter().filter(same).count();
            changes.push(RegimeChange {
                between: (from, to, rank),
                at: (pair[1].from, self.points[pair[1].samples.start].1),
            });
        }
        changes
    }
}

/// Joins the same change on neighbouring profiles.
fn loci(changes: &[Vec<RegimeChange>]) -> Vec<Layer> {
    let mut lines = Vec::new();
    for pair in changes.windows(2) {
        for change in &pair[0] {
            let partner = pair[1].iter().find(|other| other.between == change.between);
            let joined = partner.map(|partner| vec![change.at, partner.at]);
            lines.extend(joined.map(|points| Layer::Line(points, Pen::dashed(GREY, 1.3))));
        }
    }
    lines
}
