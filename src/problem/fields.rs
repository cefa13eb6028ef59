//! What every number and every text of a problem must hold to by itself: one table.
//!
//! Every number and text of the data is held against the table by its path; the outline of the text tells
//! where it stands. What values must hold to among each other is in [`super::validation`].

use super::error::{Flaw, excerpt};
use super::leaf::{self, Leaf};
use super::map::{MAX_DRAWS, MAX_GRID, MAX_MAP_POINTS};
use super::outline::Outline;
use super::scan::MAX_KEPT;
use super::system::MAX_PERIODS;
use super::{MAX_MODE, MAX_PROFILES, MAX_TOLERANCE, MAX_WORDS, is_text};
use crate::simulation::task::{
    MAX_COURANT, MAX_SAMPLES, MAX_SIMULATION_POINTS, MAX_SNAPSHOTS, MIN_SIMULATION_POINTS,
};
use crate::tube::flow::method::{MAX_DEGREE, MAX_INTERVALS};
use crate::tube::model::Parameter;
use crate::tube::model::range::AdmittedRange;

const POSITIVE: AdmittedRange = AdmittedRange::above(0.0);
const COUNT: AdmittedRange = AdmittedRange::from(1.0);
const TWO: AdmittedRange = AdmittedRange::from(2.0);
const AROUND: AdmittedRange =
    AdmittedRange::from(MIN_SIMULATION_POINTS as f64).to(MAX_SIMULATION_POINTS as f64);

/// Path, admitted values, and the rule in words, with `{}` for the values.
#[rustfmt::skip] // one field a line
const FIELDS: [(&str, AdmittedRange, &str); 60] = [
    ("tube.young", POSITIVE, "Young's modulus, in Pa, must be {}"),
    ("tube.density", POSITIVE, "the density, in kg/m³, must be {}"),
    ("tube.poisson", AdmittedRange::above(-1.0).below(0.5), "Poisson's ratio must lie {}"),
    ("tube.inner", POSITIVE, "the inner radius, in m, must be {}"),
    ("tube.outer", POSITIVE, "the outer radius, in m, must be {}"),
    ("tube.oversize", POSITIVE, "the radius of the shaft less that of the tube, in m, must be {}"),
    ("tube.rotation", POSITIVE, "the shaft must turn: the rotation must be {}"),
    ("model.coefficients.b", POSITIVE, "b must be {}"),
    ("model.coefficients.g", POSITIVE, "g must be {}"),
    ("model.coefficients.h", POSITIVE, "h must be {}"),
    ("model.friction_law.ratio", COUNT, "static by kinetic friction is {}"),
    ("model.friction_law.velocity", POSITIVE, "the velocity over which friction falls must be {}"),
    ("wave.mode", COUNT.to(MAX_MODE as f64), "waves around the circumference: {}"),
    ("system.flow_tolerance", AdmittedRange::from(1e-16).to(MAX_TOLERANCE), "the tolerance is {}"),
    ("orbit.periods", COUNT.to(MAX_PERIODS as f64), "an orbit takes {} periods of the forcing"),
    ("orbit.start.settle", AdmittedRange::from(0.0), SETTLE),
    ("orbit.start.period", POSITIVE, "the period must be {}"),
    ("orbit.start.label", COUNT, "labels run from 1"),
    ("equilibrium.start.label", COUNT, "labels run from 1"),
    ("equilibrium.start.index", COUNT, "equilibria of a mode are counted from 1"),
    ("method.tolerance", AdmittedRange::from(1e-14).to(MAX_TOLERANCE), "the tolerance is {}"),
    ("method.intervals", TWO.to(MAX_INTERVALS as f64), "a zone has {} mesh intervals"),
    ("method.degree", TWO.to(MAX_DEGREE as f64), "an interval has {} collocation points"),
    ("continuation.ds", POSITIVE, STEP),
    ("continuation.ds_min", POSITIVE, STEP),
    ("continuation.ds_max", POSITIVE, STEP),
    ("continuation.max_points", COUNT, "a branch has {} point"),
    ("continuation.tolerance", POSITIVE.to(MAX_TOLERANCE), "the tolerance must be {}"),
    ("continuation.stop_after.count", COUNT, "`count: 1` ends the branch at the first event"),
    ("stability.eigenvalues", COUNT, "keep {}, or leave out the section `stability`"),
    ("stability.max_frequency", POSITIVE, "the highest frequency must be {}"),
    ("map.points.rows", TWO.to(MAX_GRID as f64), "a grid has {} of them"),
    ("map.points.columns", TWO.to(MAX_GRID as f64), "a grid has {} of them"),
    ("map.points.count", COUNT.to(MAX_MAP_POINTS as f64), "a map has {} points"),
    ("map.shares.draws", COUNT.to(MAX_DRAWS as f64), "a value has {} motions"),
    ("simulation.body.points", AROUND, "a simulation has {} points around"),
    ("simulation.body.around", AROUND, "a simulation has {} points around"),
    ("simulation.body.across", TWO, "an annulus has {} elements across"),
    ("simulation.body.friction.epsilon", POSITIVE, "the width of the transition must be {}"),
    ("simulation.duration", POSITIVE, "the time simulated must be {}"),
    ("simulation.courant", POSITIVE.to(MAX_COURANT), "the Courant number must be {}"),
    ("simulation.every", POSITIVE, "the time between samples must be {}"),
    ("simulation.snapshots", AdmittedRange::upto(MAX_SNAPSHOTS as f64), "ask for {} snapshots"),
    ("simulation.samples", COUNT.to(MAX_SAMPLES as f64), "a motion has {} samples"),
    ("scan.settle", AdmittedRange::from(0.0), SETTLE),
    ("scan.lyapunov", COUNT, "a motion has {} Lyapunov exponent"),
    ("scan.keep", COUNT.to(MAX_KEPT as f64), "a value has {} samples"),
    ("simulation.growth.pairs", TWO.to(1000.0), "Arnoldi's method takes {} pairs of runs"),
    ("simulation.growth.amplitude", POSITIVE.to(0.1), "the difference of runs must be {}"),
    ("curve.index", COUNT, "`index: 1` is the first event of this type along the branch"),
    ("curve.ds", POSITIVE, STEP),
    ("curve.ds_min", POSITIVE, STEP),
    ("curve.ds_max", POSITIVE, STEP),
    ("curve.max_points", COUNT, "a curve has {} point"),
    ("curve.tolerance", POSITIVE.to(MAX_TOLERANCE), "the tolerance must be {}"),
    ("output.labels", COUNT, "labels run from 1"),
    ("output.rotation", POSITIVE, "the angular velocity of the shaft, in rad/s, must be {}"),
    ("output.profiles", AdmittedRange::upto(MAX_PROFILES as f64), "ask for {} profiles"),
    ("expect.label", COUNT, "labels run from 1"),
    ("expect.tolerance", POSITIVE.to(0.1), EXPECTED),
];

const STEP: &str = "step sizes must be {}";
const SETTLE: &str = "the time in which the motion settles, in periods of the forcing, or in units of time where there is none, must be {}";
const EXPECTED: &str =
    "the tolerance must be {}; it is relative, or absolute where the expected value is 0";

/// Refuses the first value that is not admitted whatever the others are.
pub(super) fn check(
    written: &dyn erased_serde::Serialize,
    outline: &Outline<'_>,
) -> Result<(), Flaw> {
    let flaw = leaf::find(written, |path, leaf| {
        let told = |name: &str| match leaf {
            Leaf::Number(value) => number(name, value),
            Leaf::Text(text) => word(name, text),
        };
        let (name, place) = (path.name(), path.address());
        let (message, help) = told(&name)?;
        // an expectation may have its numbers beside its other fields
        let beside = |path: &str| path.replace(".numbers.", ".");
        if !outline.has(&place) && place.contains(".numbers.") {
            let (message, help) = told(&beside(&name))?;
            return Some(Flaw::new(outline.locate(&beside(&place)), message, help));
        }
        Some(Flaw::new(outline.locate(&place), message, help))
    });
    flaw.map_or(Ok(()), Err)
}

/// What is wrong with a number, and its cure.
fn number(name: &str, value: f64) -> Option<(String, String)> {
    // a tube has what has no unit under the name that a model has for it
    let of_tube = name.strip_prefix("tube.");
    let in_model = of_tube.map(|field| format!("model.{field}"));
    let is_of = |path: &str| path == name || in_model.as_deref() == Some(path);
    let field = FIELDS.iter().find(|(path, ..)| is_of(path));
    let parameter = Parameter::ALL.into_iter().find(|one| is_of(one.path()));
    let (admitted, rule) = match (field, parameter) {
        (Some((_, range, rule)), _) => (range.admits(value), Some(range.rule(rule))),
        (None, Some(parameter)) => (parameter.admits(value), Some(parameter.rule())),
        (None, None) => (true, None),
    };
    let help = match (rule, value.is_finite()) {
        (None, false) => "write a finite number".to_owned(),
        (Some(rule), false) => format!("{rule}, and finite"),
        (Some(rule), true) if !admitted => rule,
        _ => return None,
    };
    Some((not_admitted(name, &format!("{value:?}")), help))
}

/// The message about a value that is not admitted.
pub(super) fn not_admitted(name: &str, value: &str) -> String {
    format!("`{name}` is {}, which is not admitted", excerpt(value))
}

/// What is wrong with a text: it is shown, or names a file. Escapes bring control characters past
/// the reader.
fn word(name: &str, text: &str) -> Option<(String, String)> {
    let refused = |c: &char| matches!(c, '\n' | '\r') || !is_text(*c);
    if let Some(found) = text.chars().find(refused) {
        let code = u32::from(found);
        return Some((
            format!("`{name}` holds the control character U+{code:04X}"),
            "write one line of text without it".to_owned(),
        ));
    }
    let rule = if text.is_empty() && name.ends_with(".dir") {
        "name the directory with the results of an earlier run".to_owned()
    } else if text.chars().count() > MAX_WORDS {
        format!("write at most {MAX_WORDS} characters")
    } else {
        return None;
    };
    Some((not_admitted(name, &format!("{text:?}")), rule))
}
