//! A column of the branch against the parameter.

use plotters::style::RGBColor;

use super::Settings;
use super::axis::{self, Axis};
use super::canvas::{Canvas, Shape};
use super::error::PlotError;
use super::frame::Frame;
use super::legend::{Key, Legend};
use super::palette::{BLACK, CATEGORIES, GREY, Pattern, Pen};
use super::quantity::{Quantity, event_name, short_signature};
use super::sheet::{Panel, Sheet, remark, usual_length};
use super::tables::{Mark, Table, Tables};
use crate::branch::EventType;

/// Width of the curve.
const CURVE: f64 = 2.2;

/// What an empty picture says.
pub const NONE: &str = "the branch has no points";

/// Stability of a stretch of the curve, as far as it was examined.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Standing {
    Stable,
    Unstable,
    Undecided,
    Unknown,
}

impl Standing {
    const ALL: [Standing; 4] = [
        Standing::Stable,
        Standing::Unstable,
        Standing::Undecided,
        Standing::Unknown,
    ];

    fn of(text: &str) -> Self {
        match text {
            "yes" => Standing::Stable,
            "no" => Standing::Unstable,
            "undecided" => Standing::Undecided,
            _ => Standing::Unknown,
        }
    }

    fn name(self) -> &'static str {
        match self {
            Standing::Stable => "stable",
            Standing::Unstable => "unstable",
            Standing::Undecided => "undecided",
            Standing::Unknown => "not examined",
        }
    }

    /// The line of this standing; `mixed` when other stretches were examined.
    fn pen(self, colour: RGBColor, mixed: bool) -> Pen {
        let pattern = match self {
            Standing::Stable | Standing::Unknown => Pattern::Solid,
            Standing::Unstable => Pattern::Dashed,
            Standing::Undecided => Pattern::Dotted,
        };
        let width = if mixed && self == Standing::Unknown {
            0.6 * CURVE
        } else {
            CURVE
        };
        Pen {
            colour,
            width,
            pattern,
        }
    }
}

/// A stretch of the curve drawn the same way.
struct Stretch {
    signature: String,
    standing: Standing,
    points: Vec<(f64, f64)>,
}

/// Composes the picture of a column of `branch.csv`.
pub fn compose(tables: &Tables, column: &str, settings: &Settings) -> Result<String, PlotError> {
    tables.check_column(column)?;
    let branch = &tables.branch;
    let stretches = stretches(branch, &settings.parameter, column);
    let marks = tables.marks(&settings.parameter, column);
    let points: Vec<(f64, f64)> = stretches
        .iter()
        .flat_map(|stretch| stretch.points.iter().copied())
        .chain(marks.iter().map(|mark| (mark.x, mark.y)))
        .collect();

    let quantities = (
        Quantity::of_column(&settings.parameter),
        Quantity::of_column(column),
    );
    let x = horizontal(points.iter().map(|point| point.0), &quantities.0);
    let y = Axis::around(points.iter().map(|point| point.1), &quantities.1, 5);

    let signatures = signatures(&stretches);
    let colour = |signature: &str| {
        if signatures.len() < 2 {
            return BLACK;
        }
        let rank = signatures.iter().position(|known| known == signature);
        rank.and_then(|rank| CATEGORIES.get(rank))
            .copied()
            .unwrap_or(GREY)
    };
    let mixed = stretches
        .iter()
        .any(|stretch| stretch.standing != Standing::Unknown);

    let mut legend = Legend::default();
    if mixed {
        let present = Standing::ALL.into_iter().filter(|standing| {
            stretches
                .iter()
                .any(|stretch| stretch.standing == *standing && stretch.points.len() > 1)
        });
        legend.add(
            "",
            present.map(|standing| {
                let pen = standing.pen(BLACK, mixed);
                (Key::Line(pen), standing.name().to_owned())
            }),
        );
    }
    add_marks(&mut legend, &marks);
    if signatures.len() > 1 {
        let named = signatures
            .iter()
            .zip(CATEGORIES)
            .map(|(signature, colour)| {
                let pen = Pen::solid(colour, CURVE + 0.6);
                (Key::Line(pen), short_signature(signature))
            });
        let others = (signatures.len() > CATEGORIES.len())
            .then(|| (Key::Line(Pen::solid(GREY, CURVE)), "others".to_owned()));
        legend.add("", named.chain(others));
    }

    let sheet = Sheet {
        title: settings.title.clone(),
        panels: vec![Panel::new(x, y)],
        legend,
        right: 0.0,
    };
    sheet.compose(|canvas, frames| {
        for frame in frames {
            if points.is_empty() {
                remark(
                    canvas,
                    frame,
                    if branch.len() == 0 { NONE } else { "no values" },
                );
            }
            for stretch in &stretches {
                let pen = stretch.standing.pen(colour(&stretch.signature), mixed);
                match stretch.points.as_slice() {
                    [] => {}
                    // A branch of one point is a dot, unless an event marks it anyway.
                    [(x, y)] => {
                        if let Some(place) = frame.place(*x, *y) {
                            canvas.point(place, Shape::Disc, 3.4, pen.colour);
                        }
                    }
                    line => frame.curve(canvas, line.iter().copied(), pen),
                }
            }
            paint_marks(canvas, frame, &marks);
        }
    })
}

/// The axis of the parameter.
pub fn horizontal(values: impl IntoIterator<Item = f64>, quantity: &Quantity) -> Axis {
    match axis::range(values) {
        Some((low, high)) => {
            let room = 0.04 * (high - low);
            Axis::fitted(low - room, high + room, quantity, usual_length())
        }
        None => Axis::blank(quantity),
    }
}

/// Explains the marks that occur.
pub fn add_marks(legend: &mut Legend, marks: &[Mark]) {
    let present = EventType::ALL
        .into_iter()
        .filter(|kind| marks.iter().any(|mark| mark.kind == *kind));
    legend.add(
        "",
        present.map(|kind| {
            let (shape, size, colour) = style(kind);
            let text = format!("{kind} {}", event_name(kind));
            (Key::Point(shape, size, colour), text)
        }),
    );
}

/// Draws the marks, the less important ones first.
pub fn paint_marks(canvas: &mut Canvas<'_>, frame: &Frame, marks: &[Mark]) {
    let minor = |mark: &&Mark| matches!(mark.kind, EventType::EP | EventType::UZ);
    let major = |mark: &&Mark| !minor(mark);
    for mark in marks.iter().filter(minor).chain(marks.iter().filter(major)) {
        if let Some(place) = frame.place(mark.x, mark.y) {
            let (shape, size, colour) = style(mark.kind);
            canvas.point(place, shape, size, colour);
        }
    }
}

/// Shape, size and colour of a mark. The shape alone tells the types apart.
fn style(kind: EventType) -> (Shape, f64, RGBColor) {
    match kind {
        EventType::EP => (Shape::Circle, 3.0, BLACK),
        EventType::MX => (Shape::Cross, 6.5, BLACK),
        EventType::UZ => (Shape::Tick, 4.5, GREY),
        EventType::LP => (Shape::OpenSquare, 5.2, BLACK),
        EventType::HB => (Shape::Star, 6.5, BLACK),
        EventType::BP => (Shape::OpenDown, 6.0, BLACK),
        EventType::GR => (Shape::Up, 6.0, BLACK),
        EventType::RV => (Shape::Diamond, 6.0, BLACK),
        EventType::CO => (Shape::Disc, 5.6, BLACK),
        EventType::ST => (Shape::Square, 6.0, BLACK),
    }
}

/// Signatures in the order of their length along the branch, which decides on the colours when
/// there are more than colours; otherwise in the order of appearance.
fn signatures(stretches: &[Stretch]) -> Vec<String> {
    let mut found: Vec<(String, usize)> = Vec::new();
    for stretch in stretches
        .iter()
        .filter(|stretch| !stretch.signature.is_empty())
    {
        let count = stretch.points.len();
        match found.iter_mut().find(|known| known.0 == stretch.signature) {
            Some(known) => known.1 += count,
            None => found.push((stretch.signature.clone(), count)),
        }
    }
    if found.len() > CATEGORIES.len() {
        found.sort_by_key(|known| std::cmp::Reverse(known.1));
    }
    found.into_iter().map(|known| known.0).collect()
}

/// Signature of the waves between two neighbouring rows.
///
/// At an event the row shows one side only; the neighbour knows on which side the step lies.
pub fn signature_between(branch: &Table, row: usize) -> &str {
    if switches_regimes(branch.kind(row)) || branch.text(row, "regimes").is_empty() {
        branch.text(row + 1, "regimes")
    } else {
        branch.text(row, "regimes")
    }
}

/// Whether two neighbouring rows belong to the same leg of the branch.
pub fn same_leg(branch: &Table, row: usize) -> bool {
    branch.text(row, "leg") == branch.text(row + 1, "leg")
}

fn switches_regimes(kind: Option<EventType>) -> bool {
    matches!(
        kind,
        Some(EventType::GR | EventType::RV | EventType::CO | EventType::ST)
    )
}

/// Stability of the waves between two neighbouring rows.
fn standing_between(branch: &Table, row: usize) -> Standing {
    let first = Standing::of(branch.text(row, "stable"));
    let second = Standing::of(branch.text(row + 1, "stable"));
    let critical = |kind| {
        matches!(kind, Some(EventType::LP | EventType::HB | EventType::BP))
            || switches_regimes(kind)
    };
    if first == second {
        first
    } else if critical(branch.kind(row)) {
        // On the boundary itself the sign is chance.
        second
    } else if critical(branch.kind(row + 1)) {
        first
    } else if first == Standing::Unknown || second == Standing::Unknown {
        Standing::Unknown
    } else {
        second
    }
}

/// Cuts the branch where its look changes, where a value is missing and between legs.
fn stretches(branch: &Table, parameter: &str, column: &str) -> Vec<Stretch> {
    let point = |row| Some((branch.number(row, parameter)?, branch.number(row, column)?));
    let mut stretches: Vec<Stretch> = Vec::new();
    let mut continues = false;
    for row in 0..branch.len() {
        let Some(here) = point(row) else {
            continues = false;
            continue;
        };
        let next = (row + 1 < branch.len() && same_leg(branch, row))
            .then(|| point(row + 1))
            .flatten();
        let Some(next) = next else {
            if !continues {
                stretches.push(Stretch {
                    signature: branch.text(row, "regimes").to_owned(),
                    standing: Standing::of(branch.text(row, "stable")),
                    points: vec![here],
                });
            }
            continues = false;
            continue;
        };
        let signature = signature_between(branch, row);
        let standing = standing_between(branch, row);
        match stretches.last_mut() {
            Some(last) if continues && last.signature == signature && last.standing == standing => {
                last.points.push(next);
            }
            _ => stretches.push(Stretch {
                signature: signature.to_owned(),
                standing,
                points: vec![here, next],
            }),
        }
        continues = true;
    }
    stretches
}
