//! Eigenvalues in the plane of λ.

use super::names::{RATE, occurring};
use super::profile::evenly;
use super::tables::{Tables, number as value_of};
use crate::output::render::{
    Axis, BLACK, CATEGORIES, ColourCell, Extent, Key, Layer, Legend, Mark, MarkShape, Panel, Pen,
    Picture, Point, VERMILLION, WHITE, mix, number,
};
use crate::output::store::StoreError;
use crate::table::Table;

/// Most labels shown in one picture.
const MOST: usize = 4;

/// What an empty picture says.
pub(super) const NONE: &str = "no spectrum was asked for";

const SIZE: f64 = 4.4;

const SHAPES: [MarkShape; 8] = [
    MarkShape::Circle,
    MarkShape::Plus,
    MarkShape::OpenSquare,
    MarkShape::Cross,
    MarkShape::OpenDiamond,
    MarkShape::OpenDown,
    MarkShape::Up,
    MarkShape::Star,
];

pub(super) struct DrawnEigenvalue {
    /// Place of its label among those chosen.
    pub label: usize,
    /// Place of its sector among those that occur.
    pub sector: usize,
    pub value: Point,
}

/// What is shown of `spectrum.csv`.
#[derive(Default)]
pub(super) struct Chosen<'a> {
    pub labels: Vec<&'a str>,
    /// The sectors that occur at these labels, in order.
    pub sectors: Vec<&'a str>,
    /// The eigenvalues at these labels.
    pub eigenvalues: Vec<DrawnEigenvalue>,
    count: usize,
}

pub(super) fn picture(tables: &Tables) -> Result<Picture, StoreError> {
    let table = tables.spectrum()?;
    let chosen = Chosen::of(table.as_ref(), MOST);
    // The imaginary axis with a little of the unstable side is always in the picture.
    let mut layers = vec![
        Layer::Cells(vec![unstable(0.0)]),
        Layer::Upright(0.0, Pen::solid(BLACK, 1.9)),
    ];
    layers.extend(chosen.eigenvalues.iter().map(|one| {
        let mark = chosen.mark(one.label, one.sector);
        Layer::Marks(vec![one.value], mark)
    }));
    let x = Axis::new(("", "Re λ", RATE), Extent::Data(0.08));
    let y = Axis::new(("", "Im λ", RATE), Extent::Data(0.05));
    let panel = Panel::new(x, y, layers);
    let panel = panel.unless(chosen.eigenvalues.is_empty(), NONE);
    Ok(Picture::new(vec![panel], chosen.legend(tables)))
}

/// The side on which disturbances grow: right of a value.
pub(super) fn unstable(from: f64) -> ColourCell {
    ColourCell::upright(from, f64::INFINITY, mix(WHITE, VERMILLION, 0.12))
}

impl<'a> Chosen<'a> {
    /// Chooses at most `most` labels, the first one always among them.
    pub(crate) fn of(table: Option<&'a Table>, most: usize) -> Self {
        let Some(table) = table else {
            return Chosen::default();
        };
        let rows = || (0..table.len()).map(|row| (table.text(row, "label"), row));
        let all = occurring(rows().map(|(label, _)| label));
        let labels: Vec<&str> = evenly(all.len(), most)
            .into_iter()
            .map(|i| all[i])
            .collect();
        let shown = rows().filter(|(label, _)| labels.contains(label));
        let mut sectors = occurring(shown.map(|(_, row)| table.text(row, "sector")));
        sectors.sort_by_key(|sector| sector.parse::<u64>().unwrap_or(u64::MAX));
        let eigenvalue = |(label, row)| {
            let sector = table.text(row, "sector");
            Some(DrawnEigenvalue {
                label: labels.iter().position(|known| *known == label)?,
                sector: sectors.iter().position(|known| *known == sector)?,
                value: (value_of(table, row, "re")?, value_of(table, row, "im")?),
            })
        };
        Chosen {
            eigenvalues: rows().filter_map(eigenvalue).collect(),
            labels,
            sectors,
            count: all.len(),
        }
    }

    /// Shapes tell sectors apart; colours the labels, or the sectors when there is one label.
    pub(crate) fn mark(&self, label: usize, sector: usize) -> Mark {
        let index = if self.labels.len() > 1 { label } else { sector };
        let colour = CATEGORIES[index % CATEGORIES.len()];
        Mark::new(SHAPES[sector % SHAPES.len()], SIZE, colour)
    }

    pub(crate) fn legend(&self, tables: &Tables) -> Legend {
        if self.sectors.is_empty() {
            return Legend::default();
        }
        let several = self.labels.len() > 1;
        let sectors = self.sectors.iter().enumerate().map(|(index, sector)| {
            let mark = self.mark(0, index);
            let colour = if several { BLACK } else { mark.colour };
            (Key::Mark(Mark { colour, ..mark }), *sector)
        });
        let values = self
            .labels
            .iter()
            .filter_map(|label| tables.parameter_at(label));
        let mut texts = number::distinct(&values.collect::<Vec<f64>>()).into_iter();
        let mut names = self.labels.iter().map(|label| {
            let known = tables.parameter_at(label);
            match known.and_then(|_| texts.next()) {
                Some(text) => format!("{text} [{label}]"),
                None => format!("[{label}]"),
            }
        });
        let parameter = tables.quantity(&tables.parameter);
        let symbol = parameter.short();
        let legend = Legend::default().with("sector", sectors);
        if !several {
            let name = names.next().unwrap_or_default();
            return legend.with::<&str>(&format!("at {symbol} = {name}"), []);
        }
        let heading = match self.count > self.labels.len() {
            true => format!("{} of {}: {symbol} =", self.labels.len(), self.count),
            false => format!("{symbol} ="),
        };
        let entries = names.enumerate().map(|(index, name)| {
            let colour = self.mark(index, 0).colour;
            (Key::Mark(Mark::new(MarkShape::Disc, SIZE, colour)), name)
        });
        legend.with(&heading, entries)
    }
}
