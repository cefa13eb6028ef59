//! The first step of a branch into a candidate for what lies beyond a change of regime.

use super::special::{OrbitRefusal, StepRefused};
use super::{Candidate, Examined, MarginFunction, Orbit, SignVerdict, dip};
use crate::continuation::branching::Branching;
use crate::continuation::newton::{self, Rounding};
use crate::continuation::walk::{self, Refused};
use crate::continuation::{Node, arclength};
use crate::linalg::{self, Matrix, Vector};

/// The branch beyond a change of regime.
#[derive(Clone, Debug)]
pub struct Beyond<O> {
    /// Boundary-value problem of the new signature.
    pub orbit: O,
    /// The event in its unknowns, with the tangent into the admissible side.
    pub node: Node,
    /// Length of the first admissible step.
    pub ds: f64,
}

/// A candidate solves its equations at the event to this scaled residual, or it is none: the
/// event itself is known to about 1e-13, and the reduced switching functions of nascent zones
/// amplify that by less than 1e4.
pub(super) const RESIDUAL_AT_EVENT: f64 = 1e-8;

/// Lengths of the first step tried into a candidate.
pub(super) const TRIES: usize = 14;

/// Where its own equations are singular, as where several zones vanish at once, an event is known to the root of rounding
/// only: the equations of a candidate that hold to this are corrected once, by no more than this.
const SINGULAR_EVENT: f64 = 1e-6;

/// The node of an event that is an orbit of these equations.
pub(super) fn solved<O: Orbit>(orbit: &O, point: &Vector) -> Option<Node> {
    let known = Node::within(orbit, point.clone(), RESIDUAL_AT_EVENT);
    known.or_else(|| {
        let (matrix, residual) = newton::evaluated(orbit, point).ok()?;
        if residual.amax() > SINGULAR_EVENT {
            return None;
        }
        let correction = linalg::pseudo_inverse(&matrix, NULL)? * residual;
        let is_near = correction.amax() <= SINGULAR_EVENT;
        is_near.then(|| Node::within(orbit, point - correction, RESIDUAL_AT_EVENT))?
    })
}

/// Why a candidate is not entered.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NotEntered<O: Orbit> {
    /// The event does not solve its equations.
    #[error("the equations do not hold at the event")]
    NoSolution,
    /// No step into it is admissible: the last refusal.
    #[error("{0}")]
    Refused(StepRefused<O>),
}

/// A candidate whose equations hold at the event, ready for the first step.
pub(super) struct Entry<'a, O: Orbit> {
    candidate: &'a Candidate<O>,
    /// The event with the tangent into the side on which nascent zones grow.
    node: Node,
    /// Signs of that along which an admissible branch may set out: where a zone opens its duration is negative on the way back.
    signs: &'static [f64],
    /// Whether margins or durations tell that no branch sets out; the shortest step decides.
    leads_nowhere: bool,
}

impl<'a, O: Orbit> Entry<'a, O> {
    /// The entries into a candidate, one for each tangent that a branch may have there; none where the event does not
    /// solve its equations.
    pub fn all(candidate: &'a Candidate<O>) -> Vec<Entry<'a, O>> {
        let orbit = &candidate.orbit;
        let Some(node) = solved(orbit, &candidate.point) else {
            return Vec::new();
        };
        let examination = orbit.examination(&candidate.point).ok();
        let watched = examination.as_ref().map_or(&[][..], Examined::margins);
        let tangents = tangents(candidate).unwrap_or_else(|| vec![node.tangent.clone()]);
        let entries = tangents.into_iter().map(|mut tangent| {
            if growth(candidate, watched, &tangent) < 0.0 {
                tangent.neg_mut();
            }
            let growths = candidate.nascent.iter();
            let growths = growths.map(|zone| tangent[orbit.duration_index(*zone)]);
            let opens = growths.clone().any(|growth| growth >= TOLD);
            let closes = opens && growths.clone().any(|growth| growth <= -TOLD);
            let falls = !orbit.is_layered() && leads_nowhere(orbit, watched, &tangent);
            Entry {
                signs: &walk::EITHER_WAY[..if opens { 1 } else { 2 }],
                leads_nowhere: closes || falls,
                candidate,
                node: Node {
                    tangent,
                    ..node.clone()
                },
            }
        });
        entries.collect()
    }

    /// The first admissible step, tried from `ds` down.
    pub fn along(&self, ds: f64, tries: usize, tolerance: f64) -> Result<Beyond<O>, NotEntered<O>> {
        let from = (&self.node, self.signs);
        enter_along(&self.candidate.orbit, from, ds, tries, tolerance)
    }

    /// The shortest step, where there seems to be none.
    pub fn shortest(&self, ds: f64, tolerance: f64) -> Result<(), NotEntered<O>> {
        if self.leads_nowhere {
            let shortest = ds * walk::SHORTER.powi(TRIES as i32 - 1);
            self.along(shortest, 1, tolerance)?;
        }
        Ok(())
    }
}

/// The first admissible step into a candidate.
///
/// # Errors
/// The event is no orbit of the candidate, or no step is admissible.
pub fn enter<O: Orbit>(
    candidate: &Candidate<O>,
    ds: f64,
    tolerance: f64,
) -> Result<Beyond<O>, NotEntered<O>> {
    let mut entered = Err(NotEntered::NoSolution);
    for entry in Entry::all(candidate) {
        let along = enter_by(&entry, ds, tolerance);
        let length = |one: &Result<Beyond<O>, _>| one.as_ref().map_or(0.0, |beyond| beyond.ds);
        if entered.is_err() || length(&along) > length(&entered) {
            entered = along;
        }
    }
    entered
}

/// The first admissible step by one of the entries into a candidate.
fn enter_by<O: Orbit>(
    entry: &Entry<O>,
    ds: f64,
    tolerance: f64,
) -> Result<Beyond<O>, NotEntered<O>> {
    let candidate = entry.candidate;
    let orbit = &candidate.orbit;
    // the shortest of the steps says why
    entry.shortest(ds, tolerance)?;
    let direct = entry.along(ds, TRIES, tolerance);
    let length = direct.as_ref().map_or(0.0, |beyond| beyond.ds);
    if !orbit.is_layered() || length >= IN_LAYER * ds {
        return direct;
    }
    // a layer thinner than any step turns the tangent within the first one, or hides it in rounding
    let settled = INSIDE
        .iter()
        .filter_map(|part| settled(candidate, &entry.node, part * ds, tolerance));
    settled
        .filter_map(|node| {
            enter_along(orbit, (&node, &walk::EITHER_WAY), ds, TRIES, tolerance).ok()
        })
        .find(|beyond| beyond.ds > length)
        .map_or(direct, Ok)
}

/// A first step shorter than this part of the one asked for may end within a layer, where rounding
/// alone says what is admissible.
const IN_LAYER: f64 = 1e-6;

/// Parts of a step, as durations of a nascent zone, where the tangent beyond a layer is looked for.
const INSIDE: [f64; 3] = [1e-2, 1e-1, 1e-3];

/// An event with the tangent that the branch has where its nascent zone lasts this long.
fn settled<O: Orbit>(
    candidate: &Candidate<O>,
    node: &Node,
    duration: f64,
    tolerance: f64,
) -> Option<Node> {
    let orbit = &candidate.orbit;
    let index = orbit.duration_index(*candidate.nascent.first()?);
    let mut guess = node.point.clone();
    guess[index] = duration;
    let mut fixed = newton::Fixed {
        index,
        value: duration,
    };
    let settings = newton::Settings {
        tolerance,
        ..newton::Settings::default()
    };
    let corrected = arclength::correct(orbit, &mut fixed, &guess, &node.tangent, &settings);
    let (mut inside, _) = corrected.ok()?;
    if inside.tangent[index] < 0.0 {
        inside.tangent.neg_mut();
    }
    Some(Node {
        tangent: inside.tangent,
        ..node.clone()
    })
}

/// A margin, of order one, is negative at an event, or falls or rises along the branch, where its value or slope there
/// is at least this: both are known to rounding, and the event to 1e-13.
const TOLD: f64 = 1e-3;

/// Whether no branch sets out from the event: a margin is negative there, or of those that vanish one falls along the
/// tangent and another one against it.
fn leads_nowhere<O: Orbit>(orbit: &O, margins: &[O::Margin], tangent: &Vector) -> bool {
    let (mut falls, mut rises) = (false, false);
    for margin in margins {
        let value = margin.value();
        if value.abs() <= RESIDUAL_AT_EVENT {
            let slope = orbit.slope(margin, tangent);
            falls |= slope <= -TOLD;
            rises |= slope >= TOLD;
        } else if value <= -TOLD {
            return true;
        }
    }
    falls && rises
}

/// The first admissible step from an event along its tangent, times one of these signs.
pub(super) fn enter_along<O: Orbit>(
    orbit: &O,
    (node, signs): (&Node, &[f64]),
    ds: f64,
    tries: usize,
    tolerance: f64,
) -> Result<Beyond<O>, NotEntered<O>> {
    let mut refused = Err(NotEntered::NoSolution);
    let entered = walk::enter(orbit, (node, signs), ds, tries, tolerance, |from, step| {
        let forwards = from.tangent == node.tangent;
        let examined = step.map(|to| (orbit.examination(&to.point), to));
        let refusal = match examined {
            Ok((Ok(examination), to)) => {
                if is_admissible(orbit, &from.tangent, &to, &examination) {
                    return Some(());
                }
                // what fails on the way back says nothing
                if !forwards {
                    return None;
                }
                Refused::Curve(OrbitRefusal::Inadmissible(orbit.inadmissible(&examination)))
            }
            Ok((Err(error), _)) => Refused::Curve(OrbitRefusal::Flow(error)),
            Err(refusal) => Refused::Step(refusal),
        };
        refused = Err(NotEntered::Refused(refusal));
        None
    });
    match entered {
        Some((node, ds, ())) => Ok(Beyond {
            orbit: orbit.clone(),
            node,
            ds,
        }),
        None => refused,
    }
}

/// Whether every margin at a point is positive by more than rounding leaves in it: where zones of both halves of an orbit have
/// closed, beside the event the equations of a sequence without some of them hold to rounding, and no orbit solves them.
fn is_admissible<O: Orbit>(
    orbit: &O,
    tangent: &Vector,
    to: &Node,
    examination: &O::Examination,
) -> bool {
    /// A duration that is all rounding is the root of it, of order m where its equation is a zero of this order, and a linear bound
    /// the m-th part of that. Orders are three or four.
    const ORDERS: f64 = 10.0;
    let holds = |rounding: Rounding| {
        let mut margins = examination.margins().iter();
        margins.all(|margin| {
            margin.value() > ORDERS * dip::of_margin(orbit, margin, &rounding, &to.point)
        })
    };
    examination.verdict() == SignVerdict::Positive
        && dip::rounding_across(orbit, tangent, &to.point).is_some_and(holds)
}

/// A direction that a matrix shrinks below this part of its norm is one of its null space, at an event that is known
/// to 1e-13.
const NULL: f64 = 1e-9;

/// The tangents that a branch may have where several zones open at once: those zeros of the algebraic branching equation
/// that are found from where all of them grow alike and from where each grows alone. `None` where there is one tangent.
fn tangents<O: Orbit>(candidate: &Candidate<O>) -> Option<Vec<Vector>> {
    /// Two unit vectors are one where they agree, but for the sign, to this.
    const SAME: f64 = 1e-6;
    let Candidate {
        orbit,
        point,
        nascent,
    } = candidate;
    if nascent.len() < 2 {
        return None;
    }
    let branching = Branching::at(orbit, point, NULL)?;
    let space = &branching.null_space;
    let growths = Matrix::from_fn(nascent.len(), space.ncols(), |row, column| {
        space[(orbit.duration_index(nascent[row]), column)]
    });
    let from_growth = linalg::pseudo_inverse(&growths, NULL)?;
    let alike = &from_growth * Vector::repeat(nascent.len(), 1.0);
    let alone = from_growth.column_iter().map(|column| column.clone_owned());
    let mut found: Vec<Vector> = Vec::new();
    for start in std::iter::once(alike).chain(alone) {
        let Some(tangent) = branching.tangent_from(&start) else {
            continue;
        };
        if found
            .iter()
            .all(|known| known.dot(&tangent).abs() < 1.0 - SAME * SAME)
        {
            found.push(tangent);
        }
    }
    Some(found)
}

/// How much nascent zones grow along a direction, or else margins that are zero.
fn growth<O: Orbit>(candidate: &Candidate<O>, margins: &[O::Margin], tangent: &Vector) -> f64 {
    let Candidate { orbit, nascent, .. } = candidate;
    if !nascent.is_empty() {
        let grows = |zone: &usize| tangent[orbit.duration_index(*zone)];
        return nascent.iter().map(grows).sum();
    }
    margins
        .iter()
        .filter(|margin| margin.value().abs() < 1e-6)
        .map(|margin| orbit.slope(margin, tangent))
        .sum()
}
