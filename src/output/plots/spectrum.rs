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
use super::tables::{Table, Tables};

/// Most labels shown in one picture.
const MOST: usize = 4;

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
struct Eigenvalue {
    label: usize,
    sector: usize,
    re: f64,
    im: f64,
}

/// Composes the picture.
pub fn compose(tables: &Tables, settings: &Settings) -> Result<String, PlotError> {
    let empty = Table::default();
    let table = match &tables.spectrum {
        Some(table) => {
            table.require(&["label", "sector", "re", "im"])?;
            table
        }
        None => &empty,
    };
    let rows = || (0..table.len()).map(|row| (table.text(row, "label"), row));
    let mut labels: Vec<&str> = Vec::new();
    for (label, _) in rows() {
        if !labels.contains(&label) {
            labels.push(label);
        }
    }
    let count = labels.len();
    let labels: Vec<&str> = evenly(count, MOST).into_iter().map(|i| labels[i]).collect();
    let mut sectors: Vec<&str> = Vec::new();
    for (label, row) in rows() {
        let sector = table.text(row, "sector");
        if labels.contains(&label) && !sectors.contains(&sector) {
            sectors.push(sector);
        }
    }
    sectors.sort_by_key(|sector| sector.parse::<u64>().unwrap_or(u64::MAX));
    let eigenvalues: Vec<Eigenvalue> = rows()
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
    let legend = legend(tables, settings, &labels, &sectors, count);
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
            for one in &eigenvalues {
                if let Some(place) = frame.place(one.re, one.im) {
                    let colour = colour(one.label, one.sector, labels.len());
                    canvas.point(place, shape(one.sector), 4.4, colour);
                }
            }
        }
    })
}

/// Explains sectors and labels.
fn legend(
    tables: &Tables,
    settings: &Settings,
    labels: &[&str],
    sectors: &[&str],
    count: usize,
) -> Legend {
    let mut legend = Legend::default();
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
            let key = Key::Point(shape(index), 4.4, colour);
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
                let key = Key::Point(Shape::Disc, 4.4, colour(index, 0, labels.len()));
                (key, name)
            }),
        );
    } else if let Some(name) = names.next() {
        legend.add(&format!("at {symbol} = {name}"), []);
    }
    legend
}

fn shape(sector: usize) -> Shape {
    SHAPES[sector % SHAPES.len()]
}

/// Colours tell the labels apart, or the sectors when there is one label.
fn colour(label: usize, sector: usize, labels: usize) -> plotters::style::RGBColor {
    let index = if labels > 1 { label } else { sector };
    CATEGORIES[index % CATEGORIES.len()]
}
