//! All switching positions against the parameter, with the zones between them.

use super::Settings;
use super::axis::Axis;
use super::canvas::{Place, Shape};
use super::diagram::{NONE, horizontal, same_leg, signature_between};
use super::error::PlotError;
use super::legend::{Key, Legend};
use super::palette::{self, BLACK, Pen};
use super::profile::angle;
use super::quantity::Quantity;
use super::sheet::{Panel, Sheet, remark};
use super::tables::{Table, Tables};

/// Most zones of a wave; more are no wave but a spoiled file.
const MOST: usize = 64;

/// A stretch of the branch with the same zones.
struct Band<'a> {
    regimes: Vec<&'a str>,
    /// Values of the parameter with the end of each zone.
    columns: Vec<(f64, Vec<f64>)>,
}

/// Composes the picture.
pub fn compose(tables: &Tables, settings: &Settings) -> Result<String, PlotError> {
    tables.check_column("switches")?;
    let branch = &tables.branch;
    let rows: Vec<(f64, Vec<f64>)> = (0..branch.len())
        .filter_map(|row| {
            let x = branch.number(row, &settings.parameter)?;
            Some((x, branch.list(row, "switches")))
        })
        .collect();
    let bands = bands(branch, &settings.parameter);
    let top = rows
        .iter()
        .flat_map(|row| row.1.iter().copied())
        .fold(0.0, f64::max);

    let x = horizontal(
        rows.iter().map(|row| row.0),
        &Quantity::of_column(&settings.parameter),
    );
    let y = if top > 0.0 {
        Axis::over(0.0, top, &angle(), 5)
    } else {
        Axis::blank(&angle())
    };

    // Where the branch turns back, zones would lie on top of each other.
    let shaded = one_way(&bands);
    let mut regimes: Vec<&str> = Vec::new();
    for name in bands.iter().flat_map(|band| band.regimes.iter()) {
        if !regimes.contains(name) {
            regimes.push(name);
        }
    }
    let mut legend = Legend::default();
    if shaded {
        legend.add(
            "",
            regimes
                .iter()
                .map(|name| (Key::Area(palette::zone(name)), (*name).to_owned())),
        );
    } else {
        legend.add(
            "end of",
            regimes.iter().map(|name| {
                let pen = Pen::solid(palette::regime(name), 2.0);
                (Key::Line(pen), (*name).to_owned())
            }),
        );
    }

    let sheet = Sheet {
        title: settings.title.clone(),
        panels: vec![Panel::new(x, y)],
        legend,
        right: 0.0,
    };
    sheet.compose(|canvas, frames| {
        for frame in frames {
            if branch.len() == 0 {
                remark(canvas, frame, NONE);
            } else if top <= 0.0 {
                remark(canvas, frame, "no switching positions");
            }
            for band in bands.iter().filter(|_| shaded) {
                for (zone, name) in band.regimes.iter().enumerate() {
                    let lower = band.line(zone.checked_sub(1));
                    let upper = band.line(Some(zone));
                    let corners: Vec<Place> = lower
                        .chain(upper.rev())
                        .filter_map(|(x, y)| frame.place(x, y))
                        .collect();
                    canvas.polygon(&corners, palette::zone(name));
                    // Without a rim, paper shows between neighbouring areas.
                    canvas.line(&corners, Pen::solid(palette::zone(name), 0.8));
                }
            }
            for band in &bands {
                for (zone, name) in band.regimes.iter().enumerate() {
                    let colour = if shaded { BLACK } else { palette::regime(name) };
                    frame.curve(canvas, band.line(Some(zone)), Pen::solid(colour, 1.8));
                }
            }
            if bands.is_empty() {
                for (x, switches) in &rows {
                    for theta in switches {
                        if let Some(place) = frame.place(*x, *theta) {
                            canvas.point(place, Shape::Disc, 3.4, BLACK);
                        }
                    }
                }
            }
        }
    })
}

impl Band<'_> {
    /// The end of a zone, or release, over the parameter.
    fn line(&self, zone: Option<usize>) -> impl DoubleEndedIterator<Item = (f64, f64)> {
        self.columns.iter().map(move |(x, ends)| {
            let end = zone.map_or(Some(&0.0), |zone| ends.get(zone));
            (*x, end.copied().unwrap_or(f64::NAN))
        })
    }
}

/// The zones along the branch.
fn bands<'a>(branch: &'a Table, parameter: &str) -> Vec<Band<'a>> {
    let mut bands: Vec<Band<'a>> = Vec::new();
    let mut continues = false;
    for row in 1..branch.len() {
        let before = branch.number(row - 1, parameter);
        let here = branch.number(row, parameter);
        let (Some(before), Some(here), true) = (before, here, same_leg(branch, row - 1)) else {
            continues = false;
            continue;
        };
        let signature = signature_between(branch, row - 1);
        let regimes: Vec<&str> = signature.split('-').collect();
        let mut first = branch.list(row - 1, "switches");
        let mut second = branch.list(row, "switches");
        if first.is_empty() || second.is_empty() || first.len().max(second.len()) > MOST {
            continues = false;
            continue;
        }
        if first.len() != second.len() {
            // One side shows the zones beyond an event.
            if branch.text(row - 1, "regimes") == signature {
                second = partners(&first, &second);
            } else {
                first = partners(&second, &first);
            }
        }
        match bands.last_mut() {
            Some(band)
                if continues
                    && band.regimes == regimes
                    && band.columns.last().is_some_and(|last| last.1 == first) =>
            {
                band.columns.push((here, second));
            }
            _ => bands.push(Band {
                regimes,
                columns: vec![(before, first), (here, second)],
            }),
        }
        continues = true;
    }
    bands
}

/// For each zone's end where it goes on the other side of an event, where there are fewer or more
/// zones: in order and as near as possible. Zones missing on the other side have length zero there.
fn partners(ends: &[f64], others: &[f64]) -> Vec<f64> {
    if ends.len() <= others.len() {
        let places = matching(ends, others);
        return places.into_iter().map(|place| others[place]).collect();
    }
    let mut found: Vec<Option<f64>> = vec![None; ends.len()];
    for (other, place) in others.iter().zip(matching(others, ends)) {
        found[place] = Some(*other);
    }
    (0..ends.len())
        .map(|index| {
            if let Some(partner) = found[index] {
                return partner;
            }
            let free = |index: &usize| found.get(*index).is_some_and(Option::is_none);
            let before = (0..index).rev().take_while(free).count();
            let after = (index + 1..ends.len()).take_while(free).count();
            if before + after > 0 {
                // Both ends of a new zone: it opened somewhere between them.
                let group = &ends[index - before..=index + after];
                return group.iter().sum::<f64>() / group.len() as f64;
            }
            // One end more: it parted from the neighbour that is nearer.
            let below = index.checked_sub(1).map_or(0.0, |place| ends[place]);
            let lower = index.checked_sub(1).map_or(Some(0.0), |place| found[place]);
            let upper = found.get(index + 1).copied().flatten();
            match (lower, upper) {
                (Some(lower), Some(upper)) => {
                    if ends[index] - below < ends[index + 1] - ends[index] {
                        lower
                    } else {
                        upper
                    }
                }
                (lower, upper) => lower.or(upper).unwrap_or(ends[index]),
            }
        })
        .collect()
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

/// Whether the branch passes every value of the parameter once.
fn one_way(bands: &[Band<'_>]) -> bool {
    let values = || {
        bands
            .iter()
            .flat_map(|band| &band.columns)
            .map(|column| column.0)
    };
    let low = values().fold(f64::INFINITY, f64::min);
    let high = values().fold(f64::NEG_INFINITY, f64::max);
    let travelled: f64 = bands
        .iter()
        .flat_map(|band| band.columns.windows(2))
        .map(|pair| (pair[1].0 - pair[0].0).abs())
        .sum();
    travelled <= (high - low) * (1.0 + 1e-9)
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
