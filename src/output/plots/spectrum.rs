//! Eigenvalues in the plane of λ.

use super::Settings;
use super::axis::{self, Axis};
use super::canvas::Shape;
use super::error::PlotError;
use super::legend::{Key, Legend};
use super::number;
use super::palette::{BLACK, CATEGORIES, Pen, VERMILLION, WHITE, mix};
use super::profile::evenly;
use super::quantity::Quantity;
use super::sheet::{Panel, Sheet, remark, usual_length};
use super::tables::Tables;

/// Most labels shown in one picture.
const MOST: usize = 4;

/// Size of the points.
pub const SIZE: f64 = 4.4;

/// Shapes of the sectors.
const SHAPES: [Shape; 8] = [
    Shape::Circle,
    Shape::Plus,
    Shape::OpenSquare,
    Shape::Cross,
    Shape::OpenDiamond,
    Shape::OpenDown,
    Shape::Up,
    Shape::Star,
];

/// An eigenvalue.
pub struct Eigenvalue {
    /// Place of its label among those chosen.
    pub label: usize,
    /// Place of its sector among those that occur.
    pub sector: usize,
    /// Growth rate.
    pub re: f64,
    /// Frequency.
    pub im: f64,
}

/// What is shown of `spectrum.csv`.
#[derive(Default)]
pub struct Chosen<'a> {
    /// The labels shown.
    pub labels: Vec<&'a str>,
    /// The sectors that occur at these labels, in order.
    pub sectors: Vec<&'a str>,
    /// The eigenvalues at these labels.
    pub eigenvalues: Vec<Eigenvalue>,
    /// Number of all labels.
    pub count: usize,
}

/// Chooses at most `most` labels, the first one always among them.
pub fn choose(tables: &Tables, most: usize) -> Result<Chosen<'_>, PlotError> {
    let Some(table) = &tables.spectrum else {
        return Ok(Chosen::default());
    };
    table.require(&["label", "sector", "re", "im"])?;
    let rows = || (0..table.len()).map(|row| (table.text(row, "label"), row));
    let mut labels: Vec<&str> = Vec::new();
    for (label, _) in rows() {
        if !labels.contains(&label) {
            labels.push(label);
        }
    }
    let count = labels.len();
    let labels: Vec<&str> = evenly(count, most).into_iter().map(|i| labels[i]).collect();
    let mut sectors: Vec<&str> = Vec::new();
    for (label, row) in rows() {
        let sector = table.text(row, "sector");
        if labels.contains(&label) && !sectors.contains(&sector) {
            sectors.push(sector);
        }
    }
    sectors.sort_by_key(|sector| sector.parse::<u64>().unwrap_or(u64::MAX));
    let eigenvalues = rows()
        .filter_map(|(label, row)| {
            Some(Eigenvalue {
                label: labels.iter().position(|known| *known == label)?,
                sector: sectors
                    .iter()
                    .position(|known| *known == table.text(row, "sector"))?,
                re: table.number(row, "re")?,
                im: table.number(row, "im")?,
            })
        })
        .collect();
    Ok(Chosen {
        labels,
        sectors,
        eigenvalues,
        count,
    })
}

/// Composes the picture.
pub fn compose(tables: &Tables, settings: &Settings) -> Result<String, PlotError> {
    let chosen = choose(tables, MOST)?;
    let (labels, eigenvalues) = (&chosen.labels, &chosen.eigenvalues);
    let (real, imaginary) = (Quantity::new("", "Re λ"), Quantity::new("", "Im λ"));
    // The imaginary axis with a little of the unstable side is always in the picture.
    let x = match axis::range(eigenvalues.iter().map(|one| one.re).chain([0.0])) {
        Some((low, high)) if !eigenvalues.is_empty() => {
            let room = 0.08 * (high - low);
            Axis::fitted(low - room, high + room, &real, usual_length())
        }
        _ => Axis::blank(&real),
    };
    let y = Axis::around(eigenvalues.iter().map(|one| one.im), &imaginary, 5);
    let legend = legend(tables, settings, &chosen);
    let sheet = Sheet {
        title: settings.title.clone(),
        panels: vec![Panel::new(x, y)],
        legend,
        right: 0.0,
    };
    sheet.compose(|canvas, frames| {
        for frame in frames {
            if eigenvalues.is_empty() {
                remark(canvas, frame, "no spectrum was asked for");
                continue;
            }
            let corners = (
                frame.place(0.0, frame.y.low),
                frame.place(frame.x.high, frame.y.high),
            );
            if let (Some(from), Some(to)) = corners {
                canvas.area(from, to, mix(WHITE, VERMILLION, 0.12));
            }
            let ends = [(0.0, frame.y.low), (0.0, frame.y.high)];
            frame.curve(canvas, ends, Pen::solid(BLACK, 1.9));
            for one in eigenvalues {
                if let Some(place) = frame.place(one.re, one.im) {
                    let colour = colour(one.label, one.sector, labels.len());
                    canvas.point(place, shape(one.sector), SIZE, colour);
                }
            }
        }
    })
}

/// Explains sectors and labels.
pub fn legend(tables: &Tables, settings: &Settings, chosen: &Chosen<'_>) -> Legend {
    let mut legend = Legend::default();
    let (labels, sectors, count) = (&chosen.labels, &chosen.sectors, chosen.count);
    if sectors.is_empty() {
        return legend;
    }
    legend.add(
        "sector",
        sectors.iter().enumerate().map(|(index, sector)| {
            let colour = match labels.len() {
                1 => colour(0, index, 1),
                _ => BLACK,
            };
            let key = Key::Point(shape(index), SIZE, colour);
            (key, (*sector).to_owned())
        }),
    );
    let values: Vec<f64> = labels
        .iter()
        .filter_map(|label| tables.at_label(label, &settings.parameter))
        .collect();
    let mut texts = number::distinct(&values).into_iter();
    let mut names = labels.iter().map(|label| {
        let known = tables.at_label(label, &settings.parameter);
        match known.and_then(|_| texts.next()) {
            Some(text) => format!("{text} [{label}]"),
            None => format!("[{label}]"),
        }
    });
    let symbol = Quantity::of_column(&settings.parameter).short().to_owned();
    if labels.len() > 1 {
        let heading = if count > labels.len() {
            format!("{} of {count}: {symbol} =", labels.len())
        } else {
            format!("{symbol} =")
        };
        legend.add(
            &heading,
            names.enumerate().map(|(index, name)| {
                let key = Key::Point(Shape::Disc, SIZE, colour(index, 0, labels.len()));
                (key, name)
            }),
        );
    } else if let Some(name) = names.next() {
        legend.add(&format!("at {symbol} = {name}"), []);
    }
    legend
}

/// Shape of a sector's points.
pub fn shape(sector: usize) -> Shape {
    SHAPES[sector % SHAPES.len()]
}

/// Colours tell the labels apart, or the sectors when there is one label.
pub fn colour(label: usize, sector: usize, labels: usize) -> plotters::style::RGBColor {
    let index = if labels > 1 { label } else { sector };
    CATEGORIES[index % CATEGORIES.len()]
}
