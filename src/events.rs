//! Location of events within one continuation step, and the branch beyond a change of regime.
//!
//! A step goes from u₀ with tangent t₀ to u₁; s = t₀·(u − u₀) orders what lies between them.

use crate::bracket::Bracket;
use crate::branch::EventType;
use crate::continuation::{self, Node};
use crate::flow::FlowError;
use crate::flow::sign::Verdict;
use crate::linalg::{self, Factors, Matrix, Vector};
use crate::model::signature::{Entry, Regime, Signature};
use crate::newton::{self, Constraint, Fixed, Plane, System};
use crate::wave::Wave;
use crate::wave::admissibility::{AtZero, Examination, Margin, Watch, examine};
use crate::wave::successor::{Candidate, candidates};

/// A point of the step at which something happens.
#[derive(Clone, Debug)]
pub struct Located {
    /// Arclength from the beginning of the step.
    pub s: f64,
    /// The point, its tangent along the branch.
    pub node: Node,
    /// Estimated error of the parameter there (physical units).
    pub uncertainty: f64,
    /// Largest component of the last Newton correction: the scaled unknowns are known no better.
    pub blur: f64,
}

impl Located {
    /// Whether no margin has failed at the point, but for rounding.
    pub fn holds(&self, examination: &Examination) -> bool {
        let mut margins = examination.margins.iter();
        margins.all(|margin| margin.jet.value >= -self.rounding(margin))
    }

    /// A margin below this at the point is zero but for rounding.
    pub fn rounding(&self, margin: &Margin) -> f64 {
        let slopes: f64 = margin.jet.by.iter().map(|by| by.abs()).sum();
        AT_ZERO + 8.0 * self.blur * slopes
    }
}

/// Settings of the Newton iterations that locate events: one iteration more than needed.
fn settings(tolerance: f64) -> newton::Settings {
    newton::Settings {
        tolerance,
        most_iterations: 12,
        halvings: 0,
        polish: 1,
    }
}

/// Solves the wave together with a constraint, from a guess, within a step.
pub fn locate(
    wave: &Wave,
    from: &Node,
    guess: &Vector,
    constraint: &mut impl Constraint<Wave>,
    tolerance: f64,
) -> Option<Located> {
    let solution = newton::solve(wave, constraint, guess, &settings(tolerance)).ok()?;
    let uncertainty = bordered(wave, constraint, &solution.point)
        .and_then(|matrix| newton::rounding(&matrix, &solution.point.abs(), None))
        .map_or(f64::NAN, |rounding| {
            (rounding[rounding.len() - 1] + solution.correction) * wave.scales.parameter
        });
    // the tangent by the arclength border: the event's own border may be singular there
    let node = retangent(wave, &solution.point, &from.tangent, solution.iterations)?;
    Some(Located {
        s: from.tangent.dot(&(&node.point - &from.point)),
        node,
        uncertainty,
        blur: solution.correction,
    })
}

/// A solved point as a node: tangent from a Jacobian evaluated there.
pub fn retangent(wave: &Wave, point: &Vector, along: &Vector, newton: usize) -> Option<Node> {
    let n = wave.unknowns();
    let mut matrix = Matrix::zeros(n, n);
    let mut residual = Vector::zeros(n - 1);
    wave.evaluate(point, residual.as_mut_slice(), &mut matrix)
        .ok()?;
    let relative = newton::relative_residual(&matrix, residual.as_slice());
    for column in 0..n {
        matrix[(n - 1, column)] = along[column];
    }
    let mut tangent = Vector::zeros(n);
    tangent[n - 1] = 1.0;
    if !Factors::new(matrix).solve(&mut tangent) {
        return None;
    }
    let length = tangent.norm();
    tangent /= length;
    Some(Node {
        point: point.clone(),
        tangent,
        newton,
        residual: relative,
    })
}

/// Jacobian of a wave together with a constraint.
fn bordered(wave: &Wave, constraint: &mut impl Constraint<Wave>, point: &Vector) -> Option<Matrix> {
    let n = wave.unknowns();
    let mut matrix = Matrix::zeros(n, n);
    let mut residual = Vector::zeros(n);
    wave.evaluate(point, &mut residual.as_mut_slice()[..n - 1], &mut matrix)
        .ok()?;
    let mut gradient = vec![0.0; n];
    constraint.evaluate(wave, point, &mut gradient).ok()?;
    for (column, value) in gradient.into_iter().enumerate() {
        matrix[(n - 1, column)] = value;
    }
    Some(matrix)
}

/// The point at which the parameter takes a value, between two nodes of one branch.
pub fn at_parameter(
    wave: &Wave,
    from: &Node,
    guess: &Vector,
    value: f64,
    tolerance: f64,
) -> Option<Located> {
    let index = wave.unknowns() - 1;
    let mut fixed = Fixed {
        index,
        value: value / wave.scales.parameter,
    };
    let mut located = locate(wave, from, guess, &mut fixed, tolerance)?;
    located.uncertainty = f64::EPSILON * value.abs();
    Some(located)
}

/// The node at arclength s along the step that sets out from `from`.
pub fn node_at(wave: &Wave, from: &Node, s: f64, tolerance: f64) -> Option<Node> {
    let predicted = &from.point + &from.tangent * s;
    let mut plane = Plane {
        normal: &from.tangent,
        through: &predicted,
    };
    let solution = newton::solve(wave, &mut plane, &predicted, &settings(tolerance)).ok()?;
    retangent(wave, &solution.point, &from.tangent, solution.iterations)
}

/// The fold inside a step at whose ends the parameter moves in opposite directions: zero of the
/// last component of the tangent, by the Illinois variant of the secant rule in s. `beginning` is
/// the arclength at which the search begins and the last component of the tangent there.
pub fn fold(
    wave: &Wave,
    from: &Node,
    beginning: (f64, f64),
    to: &Node,
    ds: f64,
    tolerance: f64,
) -> Option<Located> {
    let last = wave.unknowns() - 1;
    let mut bracket = Bracket::new(beginning, (ds, to.tangent[last]));
    let mut node = None;
    for _ in 0..60 {
        let s = bracket.secant();
        let next = node_at(wave, from, s, tolerance)?;
        let slope = next.tangent[last];
        node = Some((s, next));
        // |slope| is the error of s times the curvature: the parameter is then exact to rounding
        if slope.abs() < FOLD_SLOPE || bracket.width() < 4.0 * f64::EPSILON * ds {
            break;
        }
        bracket.shrink(s, slope);
    }
    let (s, node) = node?;
    let slope = node.tangent[last].abs();
    let mut plane = Plane {
        normal: &from.tangent,
        through: &node.point,
    };
    // ln(e/e₀) may be zero, but e has the rounding of a number of its own size
    let mut sizes = node.point.abs();
    sizes[last - 1] = sizes[last - 1].max(1.0);
    let matrix = bordered(wave, &mut plane, &node.point)?;
    let noise = newton::noise(wave, &matrix, &node.point);
    let rounding = newton::rounding(&matrix, &sizes, noise.as_ref())?[last];
    // the parameter is off by ½·slope²/curvature, the curvature being the mean one of the step
    let curvature = (to.tangent[last] - beginning.1).abs() / (ds - beginning.0);
    let uncertainty = rounding + 0.5 * slope * slope / curvature;
    Some(Located {
        s,
        node,
        uncertainty: uncertainty * wave.scales.parameter,
        blur: 0.0,
    })
}

/// Slope of the parameter along the arc at which a fold counts as found. The parameter is
/// quadratic there, so its error is of order 1e-26; speed and zone lengths are linear, with an
/// error near 1e-13.
const FOLD_SLOPE: f64 = 1e-13;

/// The zero of a margin that is positive at `from` and negative at `to`.
pub fn at_margin(
    wave: &Wave,
    from: (&Node, &Examination),
    to: (&Node, &Margin),
    ds: f64,
    tolerance: f64,
) -> Option<(Located, Margin)> {
    let (start, examination) = from;
    let (end, margin) = to;
    let mut guesses = Vec::with_capacity(2);
    if let Some(before) = examination.find(margin.watch, margin.zone) {
        let (m0, m1) = (before.jet.value, margin.jet.value);
        if m0 > 0.0 {
            let share = m0 / (m0 - m1);
            guesses.push(&start.point + (&end.point - &start.point) * share);
        }
    }
    guesses.push(end.point.clone());
    for guess in guesses {
        let mut constraint = AtZero { margin: *margin };
        let Some(located) = locate(wave, start, &guess, &mut constraint, tolerance) else {
            continue;
        };
        // a little outside is rounding of an event at the very end of the step
        if located.s < -1e-9 * ds || located.s > ds * (1.0 + 1e-9) {
            continue;
        }
        let Ok(found) = constraint.margin_at(wave, &located.node.point) else {
            continue;
        };
        return Some((located, found));
    }
    None
}

/// Whether a margin that is positive at both ends of a step may have been negative between them:
/// the cubic that shares values and slopes at the ends dips below zero.
pub fn may_hide_a_pair(
    wave: &Wave,
    from: (&Node, &Examination),
    to: (&Node, &Examination),
    ds: f64,
) -> bool {
    from.1.margins.iter().any(|before| {
        let Some(after) = to.1.find(before.watch, before.zone) else {
            return false;
        };
        let (m0, m1) = (before.jet.value, after.jet.value);
        // margins at zero belong to the event the step starts from
        if m0 <= AT_ZERO || m1 <= 0.0 {
            return false;
        }
        let d0 = ds * before.slope(wave, &from.0.tangent);
        let d1 = ds * after.slope(wave, &to.0.tangent);
        // a dip needs a fall at the beginning and a rise at the end
        if d0 >= 0.0 || d1 <= 0.0 {
            return false;
        }
        (1..16).any(|index| {
            let x = f64::from(index) / 16.0;
            let y = 1.0 - x;
            y * y * ((1.0 + 2.0 * x) * m0 + x * d0) + x * x * ((1.0 + 2.0 * y) * m1 - y * d1) < 0.0
        })
    })
}

/// A scaled margin below this is zero but for rounding.
pub const AT_ZERO: f64 = 1e-9;

/// The branch beyond a change of regime.
#[derive(Clone, Debug)]
pub struct Beyond {
    /// Boundary-value problem of the new signature.
    pub wave: Wave,
    /// The event in its unknowns, with the tangent into the admissible side.
    pub node: Node,
    /// Longest step found admissible.
    pub ds: f64,
}

/// The result of looking for the branch beyond an event.
#[derive(Clone, Debug)]
pub struct Search {
    /// The continuation, if there is one.
    pub beyond: Option<Beyond>,
    /// Signatures that were tried, with the reason why each was refused.
    pub refused: Vec<String>,
    /// Further signatures that are admissible too.
    pub others: Vec<Signature>,
}

/// A candidate solves its equations at the event to this scaled residual, or it is none: the
/// event itself is known to about 1e-13, and the reduced switching functions of nascent zones
/// amplify that by less than 1e4.
const RESIDUAL_AT_EVENT: f64 = 1e-8;

/// Steps tried into a candidate: from the given one down by factors of 4.
const TRIES: i32 = 14;

/// Looks for the admissible continuation beyond the zero of a margin.
pub fn beyond(wave: &Wave, point: &Vector, margin: &Margin, ds: f64, tolerance: f64) -> Search {
    let mut search = Search {
        beyond: None,
        refused: Vec::new(),
        others: Vec::new(),
    };
    let list = match candidates(wave, point, margin) {
        Ok(list) => list,
        Err(error) => {
            search.refused.push(error.to_string());
            return search;
        }
    };
    for candidate in list {
        let name = candidate.wave.signature.to_string();
        match enter(&candidate, ds, tolerance) {
            Ok(beyond) => match &search.beyond {
                Some(known) if known.ds >= beyond.ds => {
                    search.others.push(beyond.wave.signature);
                }
                _ => {
                    if let Some(known) = search.beyond.replace(beyond) {
                        search.others.push(known.wave.signature);
                    }
                }
            },
            Err(Some(reason)) => search.refused.push(format!("{name}: {reason}")),
            // it does not even solve its equations at the event: not worth a word
            Err(None) => {}
        }
    }
    search
}

/// The first admissible step into a candidate. `Err(None)` where the event does not solve its
/// equations.
pub fn enter(candidate: &Candidate, ds: f64, tolerance: f64) -> Result<Beyond, Option<String>> {
    let wave = &candidate.wave;
    let (matrix, residual) =
        newton::jacobian(wave, &candidate.point).map_err(|_: FlowError| None)?;
    if residual.is_nan() || residual > RESIDUAL_AT_EVENT {
        return Err(None);
    }
    let kernel = linalg::kernel(&matrix).ok_or(None)?;
    let mut tangent = kernel.null_vector;
    // towards growing nascent zones, or else towards growing margins
    let growth: f64 = if candidate.nascent.is_empty() {
        match examine(wave, &candidate.point) {
            Ok(examination) => examination
                .margins
                .iter()
                .filter(|margin| margin.jet.value.abs() < 1e-6)
                .map(|margin| margin.slope(wave, &tangent))
                .sum(),
            Err(_) => 0.0,
        }
    } else {
        candidate
            .nascent
            .iter()
            .map(|zone| tangent[wave.width() * zone + 2])
            .sum()
    };
    if growth < 0.0 {
        tangent.neg_mut();
    }
    let mut reason = String::new();
    let mut step = ds;
    for _ in 0..TRIES {
        for sign in [1.0, -1.0] {
            let node = Node {
                point: candidate.point.clone(),
                tangent: &tangent * sign,
                newton: 0,
                residual,
            };
            match continuation::advance(wave, &node, step, tolerance) {
                Ok(taken) => match examine(wave, &taken.node.point) {
                    Ok(examination) if examination.verdict == Verdict::Positive => {
                        return Ok(Beyond {
                            wave: wave.clone(),
                            node,
                            ds: step,
                        });
                    }
                    Ok(examination) => {
                        if sign > 0.0 {
                            reason = refusal(wave, &examination);
                        }
                    }
                    Err(error) => reason = error.to_string(),
                },
                Err(error) => reason = error.to_string(),
            }
        }
        step *= 0.25;
    }
    Err(Some(reason))
}

/// Why a point is not admissible, in words.
pub fn refusal(wave: &Wave, examination: &Examination) -> String {
    let worst = examination
        .margins
        .iter()
        .filter(|margin| margin.jet.value <= 0.0)
        .min_by(|one, other| one.jet.value.total_cmp(&other.jet.value));
    match worst {
        Some(margin) => {
            let regime = wave.signature.zone(margin.zone).regime.name();
            let what = match margin.watch {
                Watch::Duration => "would have a negative length",
                Watch::Pressure | Watch::LandingPressure => "would have a negative pressure",
                Watch::Rate | Watch::LandingRate => "would pass through V̇ = 1",
                Watch::Gap => "would penetrate the shaft",
                Watch::LandingSpeed => "would land from below",
                Watch::Tension => "would stay in contact",
                Watch::LowerForce | Watch::UpperForce => "would violate the friction law",
                Watch::Impulse => "would land with too small an impulse",
                Watch::Release => "would be released into reverse slip",
                Watch::Coupling => {
                    return "D = 0 is passed: waves run in the direction of D".into();
                }
            };
            format!("the {regime} zone {what} ({:.1e})", margin.jet.value)
        }
        None => match examination.verdict {
            Verdict::Undecided => "an inequality is closer to zero than rounding can tell".into(),
            _ => "a switching condition is crossed the wrong way".into(),
        },
    }
}

/// Type of a change of regime, from the margin that vanished and the signatures on both sides.
pub fn classify(before: &Signature, after: Option<&Signature>, margin: &Margin) -> EventType {
    let vanished = (margin.watch == Watch::Duration).then(|| before.zone(margin.zone).regime);
    let born =
        |regime: Regime| after.is_some_and(|after| after.count(regime) > before.count(regime));
    let reverse_at_stick = |signature: &Signature| {
        (0..signature.len()).any(|index| {
            signature.zone(index).regime == Regime::Slip
                && signature.zone(index + 1).regime == Regime::Reverse
                && signature.zone(index + 1).entry == Entry::Reversal
                && signature.zone(index + 2).regime == Regime::Stick
        })
    };
    match (vanished, margin.watch) {
        // a zone that begins with a touch closes on the impact, not at zero pressure
        (Some(Regime::Separation), _) if before.zone(margin.zone).entry == Entry::Touch => {
            EventType::CO
        }
        (Some(Regime::Separation), _) | (_, Watch::Pressure) => EventType::GR,
        (Some(Regime::Stick), _) => EventType::ST,
        (None, Watch::LowerForce) => EventType::RV,
        (Some(Regime::Reverse), _)
            if reverse_at_stick(before) && !born(Regime::Slip) && !born(Regime::Separation) =>
        {
            EventType::RV
        }
        (None, Watch::Rate) if born(Regime::Stick) && !before.has(Regime::Stick) => EventType::ST,
        _ => EventType::CO,
    }
}
