//! Error against run time, both logarithmic, one line per method.

use super::Settings;
use super::axis::{Axis, Tick};
use super::canvas::Shape;
use super::error::PlotError;
use super::legend::{Key, Legend};
use super::palette::{CATEGORIES, Pen};
use super::quantity::Quantity;
use super::sheet::{Panel, Sheet, remark};

/// Points of one method: run time in seconds, error.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Series {
    /// Name of the method.
    pub name: String,
    /// (time, error), both positive, from coarse to fine.
    pub points: Vec<(f64, f64)>,
}

/// Shapes of the methods, in the order of use.
const SHAPES: [Shape; 4] = [Shape::Star, Shape::Disc, Shape::Square, Shape::Up];

/// Composes the picture as SVG.
///
/// # Errors
/// The backend's, if it fails.
pub fn compose(series: &[Series], settings: &Settings) -> Result<String, PlotError> {
    let all = || series.iter().flat_map(|one| one.points.iter());
    let x = logarithmic(all().map(|point| point.0), "run time in seconds");
    let y = logarithmic(all().map(|point| point.1), "largest error of the branch");
    let entries: Vec<(Key, String)> = series
        .iter()
        .enumerate()
        .map(|(index, one)| {
            let key = Key::Point(
                SHAPES[index % SHAPES.len()],
                6.0,
                CATEGORIES[index % CATEGORIES.len()],
            );
            (key, one.name.clone())
        })
        .collect();
    let mut legend = Legend::default();
    legend.add("", entries);
    let sheet = Sheet {
        title: settings.title.clone(),
        panels: vec![Panel::new(x, y)],
        legend,
        right: 0.0,
    };
    sheet.compose(|canvas, frames| {
        for frame in frames {
            if all().next().is_none() {
                remark(canvas, frame, "no method has an error to show");
            }
            for (index, one) in series.iter().enumerate() {
                let colour = CATEGORIES[index % CATEGORIES.len()];
                let places: Vec<(f64, f64)> = one
                    .points
                    .iter()
                    .map(|(time, error)| (time.log10(), error.log10()))
                    .collect();
                frame.curve(canvas, places.iter().copied(), Pen::solid(colour, 1.8));
                for (x, y) in places {
                    if let Some(place) = frame.place(x, y) {
                        canvas.point(place, SHAPES[index % SHAPES.len()], 6.0, colour);
                    }
                }
            }
        }
    })
}

/// An axis of decades: its positions are logarithms, its figures powers of ten.
fn logarithmic(values: impl Iterator<Item = f64>, word: &str) -> Axis {
    let quantity = Quantity::new(word, "");
    let logs = values
        .filter(|value| *value > 0.0 && value.is_finite())
        .map(f64::log10);
    let (low, high) = logs.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
        (low.min(value), high.max(value))
    });
    if low > high {
        return Axis::blank(&quantity);
    }
    let (low, high) = ((low - 0.2).floor(), (high + 0.2).ceil());
    let step = ((high - low) / 7.0).ceil().max(1.0);
    let count = ((high - low) / step).floor() as usize;
    Axis {
        low,
        high,
        ticks: (0..=count)
            .map(|index| {
                let value = low + index as f64 * step;
                Tick {
                    value,
                    text: power(value as i32),
                }
            })
            .collect(),
        caption: quantity.caption(),
    }
}

/// 10ⁿ in superscript figures.
fn power(exponent: i32) -> String {
    let mut text = String::from("10");
    for figure in exponent.to_string().chars() {
        text.push(match figure {
            '-' => '⁻',
            '1' => '¹',
            '2' => '²',
            '3' => '³',
            figure => char::from_u32('⁰' as u32 + figure.to_digit(10).unwrap_or(0)).unwrap_or('⁰'),
        });
    }
    text
}
