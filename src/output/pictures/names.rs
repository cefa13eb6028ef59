//! What the columns, events and regimes of the tables are called in pictures, and their colours.

use crate::output::render::{
    BLACK, BLUE, CATEGORIES, GREEN, GREY, Key, Mark, ORANGE, PURPLE, Quantity, SKY, Shape,
    VERMILLION, WHITE, mix,
};
use plotters::style::RGBColor;

use crate::model::EventType;
use crate::model::Parameter;

/// The quantity in a column of `branch.csv`.
pub(super) fn quantity(column: &str) -> Quantity {
    if let Some(parameter) = Parameter::from_column(column) {
        return (parameter.words(), parameter.symbol()).into();
    }
    let (word, symbol) = match column {
        "speed" => ("speed", "c"),
        "switches" => ("switching positions", "θ"),
        "min_pressure" => ("least pressure", "min P"),
        "max_gap" => ("largest gap", "max(U − δ)"),
        "amplitude" => ("amplitude of", "V"),
        "unstable" => ("unstable eigenvalues", ""),
        "lead_re" => ("leading", "Re λ"),
        "lead_im" => ("leading", "Im λ"),
        "lead_sector" => ("sector of the leading eigenvalue", ""),
        "newton" => ("Newton iterations", ""),
        "hertz" => ("frequency in hertz", ""),
        other => return (&*other.replace('_', " "), "").into(),
    };
    (word, symbol).into()
}

/// Place along a travelling wave.
pub(super) const ANGLE: (&str, &str) = ("position", "θ");

/// Tangential displacement.
pub(super) const DISPLACEMENT: (&str, &str) = ("tangential displacement", "V");

/// Its rate.
pub(super) const VELOCITY: (&str, &str) = ("velocity", "V\u{307}");

/// What an event type stands for, as short as a legend needs it.
pub(super) fn event(kind: EventType) -> &'static str {
    match kind {
        EventType::EP => "end",
        EventType::MX => "failure",
        EventType::UZ => "user point",
        EventType::LP => "fold",
        EventType::HB => "Hopf",
        EventType::BP => "real crossing",
        EventType::GR => "take-off",
        EventType::RV => "reverse slip",
        EventType::CO => "coalescence",
        EventType::ST => "stick vanishes",
    }
}

/// Mark of an event. The shape alone tells the types apart.
pub(super) fn event_mark(kind: EventType) -> Mark {
    let (shape, size) = match kind {
        EventType::EP => (Shape::Circle, 3.0),
        EventType::MX => (Shape::Cross, 6.5),
        EventType::UZ => return Mark::new(Shape::Tick, 4.5, GREY),
        EventType::LP => (Shape::OpenSquare, 5.2),
        EventType::HB => (Shape::Star, 6.5),
        EventType::BP => (Shape::OpenDown, 6.0),
        EventType::GR => (Shape::Up, 6.0),
        EventType::RV => (Shape::Diamond, 6.0),
        EventType::CO => (Shape::Disc, 5.6),
        EventType::ST => (Shape::Square, 6.0),
    };
    Mark::new(shape, size, BLACK)
}

/// Colour of a regime sequence, the same in every picture of every run. Beyond the commonest ones it follows
/// from the letters of the sequence, and two may share one.
pub(super) fn signature_colour(regimes: &str) -> RGBColor {
    let regimes = canonical(regimes);
    match regimes.as_str() {
        "slip-stick" => BLUE,
        "slip-reverse-stick" => VERMILLION,
        "slip-separation-slip-reverse-stick" => GREEN,
        "slip-separation-reverse-stick" => PURPLE,
        "slip-separation-slip-stick" => ORANGE,
        "slip-separation-stick" => SKY,
        "slip-separation-reverse" => BLACK,
        _ => {
            let sum = regimes.bytes().fold(0_usize, |sum, byte| {
                sum.wrapping_mul(31).wrapping_add(usize::from(byte))
            });
            let base = CATEGORIES[sum % (CATEGORIES.len() - 1)];
            // darker or paler than the commonest
            match sum / 7 % 2 {
                0 => mix(base, BLACK, 0.45),
                _ => mix(base, WHITE, 0.35),
            }
        }
    }
}

/// A signature in one of its cyclic forms: where there is no stick zone, waves begin anywhere.
pub(super) fn canonical(regimes: &str) -> String {
    let zones: Vec<&str> = regimes.split('-').collect();
    if zones.contains(&"stick") {
        return regimes.to_owned();
    }
    let turned = (0..zones.len()).map(|from| [&zones[from..], &zones[..from]].concat().join("-"));
    turned.max().unwrap_or_default()
}

/// A signature of regimes shortened: `slip-reverse-stick` becomes `sl-rev-st`.
pub(super) fn short_signature(regimes: &str) -> String {
    let short: Vec<String> = regimes.split('-').map(short_regime).collect();
    short.join("-")
}

/// The name of a regime shortened.
pub(super) fn short_regime(name: &str) -> String {
    let length = if matches!(name, "slip" | "stick") {
        2
    } else {
        3
    };
    name.chars().take(length).collect()
}

/// Colour of a regime's lines.
pub(super) fn regime_colour(name: &str) -> RGBColor {
    match name {
        "slip" => BLUE,
        "stick" => BLACK,
        "separation" => GREEN,
        "reverse" => VERMILLION,
        _ => PURPLE,
    }
}

/// Pale colour of a regime's zone, behind curves; their luminances 0.88, 0.78, 0.59 and 0.45 tell them apart
/// in grey too.
pub(super) fn zone_colour(name: &str) -> RGBColor {
    match name {
        "slip" => mix(WHITE, SKY, 0.15),
        "stick" => mix(WHITE, BLACK, 0.30),
        "separation" => mix(WHITE, GREEN, 0.20),
        "reverse" => mix(WHITE, VERMILLION, 0.38),
        _ => mix(WHITE, PURPLE, 0.3),
    }
}

/// Explanations of zones by their colour.
pub(super) fn zone_keys<'a>(regimes: &[&'a str]) -> Vec<(Key, &'a str)> {
    let key = |name: &&'a str| (Key::Area(zone_colour(name)), *name);
    regimes.iter().map(key).collect()
}

/// The names that occur, in the order of their appearance.
pub(super) fn occurring<'a>(names: impl Iterator<Item = &'a str>) -> Vec<&'a str> {
    let mut known: Vec<&str> = Vec::new();
    for name in names {
        if !known.contains(&name) {
            known.push(name);
        }
    }
    known
}
