//! All switching positions against the parameter, with the zones between them.

use super::colours;
use super::diagram::{NONE, joined, one_way, same_leg, signature_between};
use super::names::{ANGLE, occurring, regime_name, sequence, zone_keys};
use super::tables::{Tables, list, number};
use super::view::parameter_axis;
use crate::output::render::number::significant;
use crate::output::render::{
    Axis, BLACK, Extent, Key, Layer, Legend, Mark, MarkShape, Panel, Pen, Picture, Point,
};
use crate::output::store::StoreError;
use crate::table::Table;
use crate::tube::model::signature::Regime;

/// Most zones of a wave; more are no wave but a spoiled file.
const MOST: usize = 64;

/// A stretch of the branch with the same zones.
struct ZoneBand {
    regimes: Vec<Option<Regime>>,
    /// Values of the parameter with the end of each zone.
    columns: Vec<(f64, Vec<f64>)>,
}

pub(super) fn picture(tables: &Tables) -> Result<Picture, StoreError> {
    tables.check_column("switches")?;
    let branch = &tables.branch;
    let row = |row| {
        let x = number(branch, row, &tables.parameter)?;
        Some((x, list(branch, row, "switches")))
    };
    let rows: Vec<(f64, Vec<f64>)> = (0..branch.len()).filter_map(row).collect();
    let bands = bands(branch, &tables.parameter);
    let ends = rows.iter().flat_map(|row| row.1.iter().copied());
    let top = ends.fold(0.0, f64::max);

    // Where the branch turns back, zones would lie on top of each other.
    let places = |band: &ZoneBand| band.columns.iter().map(|column| column.0).collect();
    let shaded = one_way(&bands.iter().map(places).collect::<Vec<_>>());
    let regimes = occurring(bands.iter().flat_map(|band| band.regimes.iter().copied()));
    let legend = if shaded {
        Legend::default().with("", zone_keys(&regimes))
    } else {
        // the last zone ends where the wave does, at the same place all along
        let own = bands.iter().filter_map(|band| band.regimes.split_last());
        let regimes = occurring(own.flat_map(|(_, rest)| rest.iter().copied()));
        let key = |one: &Option<Regime>| Key::Line(Pen::solid(colours::of_regime(*one), 2.0));
        let entries = regimes.iter().map(|one| (key(one), regime_name(*one)));
        let whole = format!("the wave ends at θ = {}", significant(top, 4));
        Legend::default()
            .with("end of", entries)
            .with::<&str>(&whole, [])
    };

    let mut layers = Vec::new();
    let mut lines = Vec::new();
    for band in &bands {
        let last = band.regimes.len() - 1;
        for (zone, regime) in band.regimes.iter().enumerate() {
            if zone == last && !shaded {
                continue;
            }
            let colour = if shaded {
                BLACK
            } else {
                colours::of_regime(*regime)
            };
            let end: Vec<Point> = band.line(Some(zone)).collect();
            if shaded {
                let back = end.iter().rev().copied();
                let corners = band.line(zone.checked_sub(1)).chain(back);
                layers.push(Layer::Area(corners.collect(), colours::of_zone(*regime)));
            }
            lines.push(Layer::Line(end, Pen::solid(colour, 1.8)));
        }
    }
    layers.extend(lines);
    if bands.is_empty() {
        let points = rows
            .iter()
            .flat_map(|(x, ends)| ends.iter().map(|end| (*x, *end)));
        let mark = Mark::new(MarkShape::Disc, 3.4, BLACK);
        layers.push(Layer::Marks(points.collect(), mark));
    }
    let x = parameter_axis(tables);
    let height = match shaded {
        true => Extent::Fixed(0.0, top),
        false => Extent::Data(0.05),
    };
    let y = Axis::new(ANGLE, height);
    let panel = Panel::new(x, y, layers)
        .unless(top <= 0.0, "no switching positions")
        .unless(branch.is_empty(), NONE);
    Ok(Picture::new(vec![panel], legend))
}

impl ZoneBand {
    /// The end of a zone, or release, over the parameter.
    fn line(&self, zone: Option<usize>) -> impl Iterator<Item = Point> {
        self.columns.iter().map(move |(x, ends)| {
            let end = zone.map_or(Some(&0.0), |zone| ends.get(zone));
            (*x, end.copied().unwrap_or(f64::NAN))
        })
    }
}

/// The zones along the branch.
fn bands(branch: &Table, parameter: &str) -> Vec<ZoneBand> {
    let ends = |row| {
        let ends = list(branch, row, "switches");
        let whole = !ends.is_empty() && ends.len() <= MOST;
        Some((number(branch, row, parameter)?, ends)).filter(|_| whole)
    };
    let step = |row| {
        let mut first = ends(row)?;
        let mut second = ends(row + 1).filter(|_| same_leg(branch, row))?;
        let signature = signature_between(branch, row);
        if first.1.len() != second.1.len() {
            // One side shows the zones beyond an event.
            if branch.text(row, "regimes") == signature {
                second.1 = partners(&first.1, &second.1);
            } else {
                first.1 = partners(&second.1, &first.1);
            }
        }
        Some((signature, first, Some(second)))
    };
    let joined = joined(branch.len(), step).into_iter();
    joined
        .map(|(signature, columns)| ZoneBand {
            regimes: sequence(signature),
            columns,
        })
        .collect()
}

/// For each zone's end where it goes on the other side of an event, where there are fewer or more
/// zones: in order and as near as possible. Zones missing on the other side have length zero there.
fn partners(ends: &[f64], others: &[f64]) -> Vec<f64> {
    if ends.len() <= others.len() {
        let places = matching(ends, others);
        return places.into_iter().map(|place| others[place]).collect();
    }
    let mut partners: Vec<Option<f64>> = vec![None; ends.len()];
    for (other, place) in others.iter().zip(matching(others, ends)) {
        partners[place] = Some(*other);
    }
    let known = partners
        .iter()
        .zip(ends)
        .filter_map(|(other, end)| Some((*end, (*other)?)));
    let known: Vec<(f64, f64)> = known.chain([(0.0, 0.0)]).collect();
    let mut found = Vec::with_capacity(ends.len());
    for group in partners.chunk_by(|one, other| one.is_none() && other.is_none()) {
        let from = found.len();
        let own = &ends[from..from + group.len()];
        let partner = match group {
            [Some(partner)] => *partner,
            // One end more: it parted from the neighbour that is nearer.
            [None] => {
                let distance = |known: &(f64, f64)| (known.0 - own[0]).abs();
                let nearest = known
                    .iter()
                    .min_by(|a, b| distance(a).total_cmp(&distance(b)));
                nearest.map_or(own[0], |nearest| nearest.1)
            }
            // Both ends of a new zone: it opened somewhere between them.
            _ => own.iter().sum::<f64>() / own.len() as f64,
        };
        found.extend(group.iter().map(|_| partner));
    }
    found
}

/// Places in the longer list of the entries of the shorter, in order, with the least sum of
/// distances.
fn matching(short: &[f64], long: &[f64]) -> Vec<usize> {
    let columns = long.len() + 1;
    let mut cost = vec![f64::INFINITY; (short.len() + 1) * columns];
    cost[..columns].fill(0.0);
    for i in 1..=short.len() {
        for j in i..=long.len() {
            let skipped = cost[i * columns + j - 1];
            let taken = cost[(i - 1) * columns + j - 1] + (short[i - 1] - long[j - 1]).abs();
            cost[i * columns + j] = skipped.min(taken);
        }
    }
    let mut places = vec![0; short.len()];
    let mut j = long.len();
    for i in (1..=short.len()).rev() {
        while j > i && cost[i * columns + j - 1] <= cost[i * columns + j] {
            j -= 1;
        }
        places[i - 1] = j - 1;
        j -= 1;
    }
    places
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_zone_in_the_middle_opens_between_its_ends() {
        let after = partners(&[0.20, 0.22, 0.4, 0.8], &[0.41, 0.8]);
        for (found, wanted) in after.iter().zip([0.21, 0.21, 0.41, 0.8]) {
            assert!((found - wanted).abs() < 1e-12, "{after:?}");
        }
    }

    #[test]
    fn a_zone_at_a_switch_opens_there() {
        assert_eq!(partners(&[0.39, 0.4, 0.8], &[0.395, 0.8])[..2], [0.395; 2]);
        assert_eq!(partners(&[0.4, 0.8], &[0.4, 0.41, 0.8]), [0.4, 0.8]);
        assert!(partners(&[], &[0.8]).is_empty());
    }
}
