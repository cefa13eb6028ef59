//! The share of each attractor along a parameter.

use std::collections::BTreeMap;
use std::path::Path;

use super::colours::RARE;
use super::orbit_kind::orbit_name;
use super::orbits::constants;
use super::tables::read;
use crate::output::layout::SHARES;
use crate::output::render::{
    Axis, BLACK, CATEGORIES, Extent, Key, Layer, Legend, Mark, MarkShape, Panel, Pen, Picture,
    Point,
};
use crate::output::store::{StoreError, unfinished};
use crate::problem::SystemProblem;

/// Radius of a dot.
const DOT: f64 = 1.6;

/// Shares over the parameter, those of attractors of one period and signature together, a line for each.
///
/// # Errors
/// When the table cannot be read.
pub(crate) fn picture(folder: &Path, problem: &SystemProblem) -> Result<Picture, StoreError> {
    let shares = problem.map.as_ref().and_then(|map| map.shares.as_ref());
    let Some(shares) = shares else {
        return Err(unfinished(folder, "map", "there is no section `shares`"));
    };
    let path = folder.join(SHARES);
    if !path.exists() {
        return Err(unfinished(folder, "map", "its rows are not joined yet"));
    }
    let table = read(&path, &["value", "found", "regimes", "periods", "share"])?;
    // by kind and value, a share of 0 where a kind is not met
    let mut kinds: BTreeMap<String, Vec<f64>> = BTreeMap::new();
    let count = shares.values.count();
    let mut value = 0;
    for row in 0..table.len() {
        let at: f64 = table.field(row, "value").unwrap_or(f64::NAN);
        while value + 1 < count && shares.values.value(value) < at {
            value += 1;
        }
        let name = match table.text(row, "found") {
            "orbit" => {
                let [periods, regimes] = ["periods", "regimes"].map(|name| table.text(row, name));
                orbit_name(&format!("{periods} {regimes} "))
            }
            found => found.to_owned(),
        };
        let of_kind = kinds.entry(name).or_insert_with(|| vec![0.0; count]);
        of_kind[value] += table.field(row, "share").unwrap_or(0.0);
    }
    let mut ranked: Vec<(String, Vec<f64>)> = kinds.into_iter().collect();
    let total = |shares: &[f64]| shares.iter().sum::<f64>();
    ranked.sort_by(|one, other| total(&other.1).total_cmp(&total(&one.1)));
    let colours = CATEGORIES.iter().chain(&RARE).copied();
    let colours = colours.chain(std::iter::repeat(BLACK));
    let (mut layers, mut keys) = (Vec::new(), Vec::new());
    for ((name, of_kind), colour) in ranked.into_iter().zip(colours) {
        let at = |value: usize| shares.values.value(value);
        let points = of_kind.iter().enumerate();
        let points: Vec<Point> = points.map(|(value, share)| (at(value), *share)).collect();
        layers.push(Layer::Line(points.clone(), Pen::solid(colour, 0.9)));
        layers.push(Layer::Marks(
            points,
            Mark::new(MarkShape::Disc, DOT, colour),
        ));
        keys.push((Key::Mark(Mark::new(MarkShape::Disc, 2.5, colour)), name));
    }
    let x = Axis::new((shares.parameter.as_str(), ""), Extent::Data(0.02));
    let y = Axis::new(("share", ""), Extent::Fixed(0.0, 1.0));
    let legend = Legend::default().with("", keys);
    let picture = Picture::new(vec![Panel::new(x, y, layers)], legend);
    let constants = constants(&problem.system.source, &[&shares.parameter]);
    let picture = picture.titled(problem.title.as_deref());
    Ok(picture.subtitled(&format!("{} motions; {constants}", shares.draws)))
}
