//! What the columns, events and regimes of the tables are called in pictures, and their marks.

use plotters::style::RGBColor;

use super::colours;
use crate::orbit::EventType;
use crate::output::render::{BLACK, GREY, Key, Mark, MarkShape, Quantity, number};
use crate::problem::Problem;
use crate::tube::model::Parameter;
use crate::tube::model::signature::Regime;

/// The quantity in a column of `branch.csv`.
pub(super) fn quantity(column: &str) -> Quantity {
    if let Some(parameter) = Parameter::from_column(column) {
        let unit = match parameter {
            Parameter::Mismatch => LENGTH,
            Parameter::MassDamping => RATE,
            Parameter::StiffnessDamping => TIME,
            _ => "",
        };
        return (parameter.words(), parameter.symbol(), unit).into();
    }
    let (word, symbol, unit) = match column {
        "speed" => ("speed", "c", RATE),
        "switches" => ("switching positions", "θ", ANGLE.2),
        "min_pressure" => ("least pressure", "min P", STRESS),
        "max_gap" => ("largest gap", "max(U − δ)", LENGTH),
        "amplitude" => ("amplitude of", "V", LENGTH),
        "unstable" => ("unstable eigenvalues", "", ""),
        "lead_re" => ("leading", "Re λ", RATE),
        "lead_im" => ("leading", "Im λ", RATE),
        "lead_sector" => ("sector of the leading eigenvalue", "", ""),
        "newton" => ("Newton iterations", "", ""),
        "hertz" => ("frequency", "", "Hz"),
        other => return (&*other.replace('_', " "), "").into(),
    };
    (word, symbol, unit).into()
}

/// The quantity in a column of the branch of a system: states and parameters have the names of the file.
pub(super) fn own_quantity(column: &str) -> Quantity {
    let words = match column {
        "multiplier_re" => ("leading", "Re μ"),
        "multiplier_im" => ("leading", "Im μ"),
        other => {
            let extreme = |ending| other.strip_prefix(ending);
            return match (extreme("max_"), extreme("min_")) {
                (Some(state), _) => (&*format!("max {state}"), "").into(),
                (_, Some(state)) => (&*format!("min {state}"), "").into(),
                _ => (other, "").into(),
            };
        }
    };
    words.into()
}

// Units of the tables; docs/waves.md has them.

/// Of lengths: the inner radius.
pub(super) const LENGTH: &str = "R";
/// Of angular velocities and eigenvalues: that of the shaft.
pub(super) const RATE: &str = "Ω";
pub(super) const TIME: &str = "1/Ω";
/// Of pressure and friction on waves and rings.
pub(super) const STRESS: &str = "γI₀E";

/// A quantity by its word, its symbol and its unit.
pub(super) type Named = (&'static str, &'static str, &'static str);

/// Place along a travelling wave.
pub(super) const ANGLE: Named = ("position", "θ", "rad");

pub(super) const DISPLACEMENT: Named = ("tangential displacement", "V", LENGTH);

pub(super) const VELOCITY: Named = ("velocity", "V\u{307}", "RΩ");

/// The mode and the parameters that differ from zero, but for those on the axes.
pub(super) fn constant_parameters(problem: &Problem, axes: &[Parameter]) -> String {
    let mode = format!("k = {}", problem.wave.mode);
    format!("{mode}, {}", parameters(problem, axes))
}

/// The parameters that differ from zero, but for some, and the unit of rates where it is known.
pub(super) fn parameters(problem: &Problem, except: &[Parameter]) -> String {
    let word = |symbol, value| format!("{symbol} = {}", number::significant(value, 4));
    let others = Parameter::ALL
        .into_iter()
        .filter(|one| !except.contains(one));
    let values = others.filter_map(|one| Some((one, problem.model.value(one)?)));
    let values = values.filter(|(_, value)| *value != 0.0);
    let mut words: Vec<String> = values
        .map(|(one, value)| word(one.symbol(), value))
        .collect();
    let rotation = problem.output.rotation;
    words.extend(rotation.map(|rotation| format!("{} rad/s", word(RATE, rotation))));
    words.join(", ")
}

/// What an event type stands for, as short as a legend needs it.
pub(super) fn event(kind: EventType) -> &'static str {
    match kind {
        EventType::EP => "end",
        EventType::MX => "failure",
        EventType::UZ => "user point",
        EventType::LP => "fold",
        EventType::PD => "period doubling",
        EventType::NS => "torus",
        EventType::HB => "Hopf",
        EventType::BP => "real crossing",
        EventType::GR => "graze",
        EventType::RV => "reverse slip",
        EventType::CO => "coalescence",
        EventType::ST => "stick vanishes",
        EventType::SL => "switch condition",
        EventType::BE => "boundary equilibrium",
        EventType::HC => "homoclinic",
    }
}

/// Mark of an event. The shape alone tells the types apart.
pub(super) fn event_mark(kind: EventType) -> Mark {
    let (shape, size) = match kind {
        EventType::EP => (MarkShape::Circle, 3.0),
        EventType::MX => (MarkShape::Cross, 6.5),
        EventType::UZ => return Mark::new(MarkShape::Disc, 3.4, GREY),
        EventType::LP => (MarkShape::OpenSquare, 5.2),
        // many may lie close together, and must not hide the line
        EventType::HB => (MarkShape::Tick, 6.0),
        EventType::BP => (MarkShape::OpenDown, 6.0),
        EventType::PD => (MarkShape::OpenDiamond, 6.0),
        EventType::NS => (MarkShape::Plus, 6.0),
        EventType::GR => (MarkShape::Up, 6.0),
        EventType::RV => (MarkShape::Diamond, 6.0),
        EventType::CO => (MarkShape::Disc, 5.6),
        EventType::ST => (MarkShape::Square, 6.0),
        EventType::SL => (MarkShape::Star, 6.0),
        EventType::BE => (MarkShape::Up, 6.0),
        EventType::HC => (MarkShape::Square, 5.6),
    };
    Mark::new(shape, size, BLACK)
}

/// The regimes of a sequence as tables have it; a word that is no regime is unknown.
pub(super) fn sequence(regimes: &str) -> Vec<Option<Regime>> {
    regimes.split('-').map(Regime::named).collect()
}

/// Colour of a sequence of regimes, in whichever of its cyclic forms it is written.
pub(super) fn signature_colour(regimes: &str) -> RGBColor {
    colours::of_sequence(&turned(sequence(regimes)))
}

/// A sequence in one of its cyclic forms: where there is no stick zone, waves begin anywhere.
fn turned(mut regimes: Vec<Option<Regime>>) -> Vec<Option<Regime>> {
    if regimes.contains(&Some(Regime::Stick)) {
        return regimes;
    }
    let name = |regime: &Option<Regime>| regime.map_or("", Regime::name);
    let from = |start: usize| -> Vec<&str> {
        let cyclic = regimes.iter().cycle().skip(start);
        cyclic.take(regimes.len()).map(name).collect()
    };
    let best = (0..regimes.len()).max_by_key(|start| from(*start));
    regimes.rotate_left(best.unwrap_or(0));
    regimes
}

/// A signature of regimes shortened: `slip-reverse-stick` becomes `sl-rev-st`.
pub(super) fn short_signature(regimes: &str) -> String {
    let sequence = sequence(regimes);
    // modes of a user's own have their names
    if sequence.contains(&None) {
        return regimes.to_owned();
    }
    let short = sequence.into_iter().map(short_regime);
    short.collect::<Vec<_>>().join("-")
}

/// The name of a regime shortened.
pub(super) fn short_regime(regime: Option<Regime>) -> &'static str {
    match regime {
        Some(Regime::Slip) => "sl",
        Some(Regime::Stick) => "st",
        Some(Regime::Separation) => "sep",
        Some(Regime::Reverse) => "rev",
        Some(Regime::Contact) => "con",
        None => "?",
    }
}

/// The name of a regime, as far as it is known.
pub(super) fn regime_name(regime: Option<Regime>) -> &'static str {
    regime.map_or("unknown", Regime::name)
}

/// Explanations of zones by their colour.
pub(super) fn zone_keys(regimes: &[Option<Regime>]) -> Vec<(Key, &'static str)> {
    let key = |one: &Option<Regime>| (Key::Area(colours::of_zone(*one)), regime_name(*one));
    regimes.iter().map(key).collect()
}

/// What occurs, in the order of its appearance.
pub(super) fn occurring<T: PartialEq>(all: impl Iterator<Item = T>) -> Vec<T> {
    let mut known: Vec<T> = Vec::new();
    for one in all {
        if !known.contains(&one) {
            known.push(one);
        }
    }
    known
}
