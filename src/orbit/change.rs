//! The branch beyond a change of regime.

use super::special::{BranchStop, OrbitRefusal, StepRefused, Tried};
use super::{AtZero, Candidate, Examined, Orbit, SignVerdict};
use crate::continuation::Node;
use crate::continuation::branching::Branching;
use crate::continuation::walk::{self, Refused};
use crate::continuation::{arclength, newton};
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

/// The result of looking for the branch beyond an event.
#[derive(Clone, Debug)]
pub struct Search<O: Orbit> {
    /// The continuation, if there is one.
    pub beyond: Option<Beyond<O>>,
    /// Signatures that were tried and refused.
    pub refused: Vec<Tried<O>>,
    /// Further signatures that are admissible too.
    pub others: Vec<O::Signature>,
}

/// A candidate solves its equations at the event to this scaled residual, or it is none: the
/// event itself is known to about 1e-13, and the reduced switching functions of nascent zones
/// amplify that by less than 1e4.
const RESIDUAL_AT_EVENT: f64 = 1e-8;

/// Lengths of the first step tried into a candidate.
const TRIES: usize = 14;

/// Looks for the admissible continuation beyond the zero of a margin.
pub fn beyond<O: Orbit>(
    orbit: &O,
    point: &Vector,
    margin: &O::Margin,
    ds: f64,
    tolerance: f64,
) -> Search<O> {
    let mut search = Search {
        beyond: None,
        refused: Vec::new(),
        others: Vec::new(),
    };
    let list = match orbit.candidates(point, margin) {
        Ok(list) => list,
        Err(error) => {
            search.refused.push(Tried {
                signature: None,
                reason: Refused::Curve(OrbitRefusal::Flow(error)),
            });
            return search;
        }
    };
    for candidate in list {
        match enter(&candidate, ds, tolerance) {
            Ok(beyond) => match &search.beyond {
                Some(known) if known.ds >= beyond.ds => {
                    search.others.push(beyond.orbit.signature().clone());
                }
                _ => {
                    if let Some(known) = search.beyond.replace(beyond) {
                        search.others.push(known.orbit.signature().clone());
                    }
                }
            },
            Err(reason) => {
                let reason = match reason {
                    NotEntered::Refused(reason) => reason,
                    NotEntered::NoSolution => Refused::Curve(OrbitRefusal::NoSolution),
                };
                search.add_refused([Tried {
                    signature: Some(candidate.orbit.signature().clone()),
                    reason,
                }]);
            }
        }
    }
    search
}

impl<O: Orbit> Search<O> {
    /// Adds signatures that were refused, each once: how near it came to an admissible one counts.
    pub(super) fn add_refused(&mut self, refused: impl IntoIterator<Item = Tried<O>>) {
        for one in refused {
            let mut known = self.refused.iter_mut();
            match known.find(|known| known.signature == one.signature) {
                Some(known) if known.is_no_solution() => *known = one,
                Some(_) => {}
                None => self.refused.push(one),
            }
        }
    }
}

impl<O: Orbit> Tried<O> {
    /// Whether the orbit of the event does not solve its equations.
    pub fn is_no_solution(&self) -> bool {
        matches!(self.reason, Refused::Curve(OrbitRefusal::NoSolution))
    }
}

/// Margins by the instant of the period at which each is looked at, in their order.
pub fn instants<O: Orbit>(orbit: &O, point: &Vector, margins: &[O::Margin]) -> Vec<Vec<O::Margin>> {
    /// Parts of a period closer than this are one instant: zones that vanish have no length, but for rounding.
    const SAME: f64 = 1e-6;
    let mut found: Vec<(f64, Vec<O::Margin>)> = Vec::new();
    for margin in margins {
        let instant = orbit.instant(point, margin);
        let same = |(other, _): &&mut (f64, _)| {
            let apart = (instant - *other).rem_euclid(1.0);
            apart.min(1.0 - apart) <= SAME
        };
        match found.iter_mut().find(same) {
            Some((_, group)) => {
                if !group.iter().any(|known| O::is_same(known, margin)) {
                    group.push(margin.clone());
                }
            }
            None => found.push((instant, vec![margin.clone()])),
        }
    }
    found.into_iter().map(|(_, group)| group).collect()
}

/// All changes of regime of one place at once.
#[derive(Clone, Debug)]
pub struct Together<O: Orbit> {
    /// The margin of the first of them.
    pub margin: O::Margin,
    /// Signature after the first of them alone.
    pub between: O::Signature,
    /// What lies beyond all.
    pub search: Search<O>,
}

/// Candidates kept of those that make some of several changes.
const MOST_TOGETHER: usize = 64;

/// Second changes tried of all pairs: beside an event of many zones there are hundreds, and none leads on.
const MOST_PAIRS: usize = 16;

/// Looks for the admissible continuation that makes a change at every instant at which margins vanish together, as
/// they do in both halves of a symmetric orbit. `instants` are the margins of each.
pub fn beyond_together<O: Orbit>(
    orbit: &O,
    point: &Vector,
    instants: &[Vec<O::Margin>],
    ds: f64,
    tolerance: f64,
) -> Option<Together<O>> {
    let (first, rest) = instants.split_first()?;
    let mut list = Vec::new();
    for margin in first {
        let candidates = orbit.candidates(point, margin).ok()?;
        list.extend(
            candidates
                .into_iter()
                .map(|one| (margin, one.orbit.signature().clone(), one)),
        );
    }
    for margins in rest {
        let mut longer: Vec<(&O::Margin, O::Signature, Candidate<O>)> = Vec::new();
        for (margin, between, candidate) in list {
            let solved = solved(&candidate.orbit, &candidate.point);
            let examination = solved.map(|node| candidate.orbit.examination(&node.point));
            let Some(Ok(examination)) = examination else {
                continue;
            };
            let zeros = examination.margins().iter().filter(|zero| {
                let alike = |other| orbit.is_alike(other, &candidate.orbit, zero);
                O::value(zero).abs() <= RESIDUAL_AT_EVENT && margins.iter().any(alike)
            });
            for zero in zeros {
                let next = candidate.orbit.candidates(&candidate.point, zero).ok()?;
                for one in next {
                    let known = |(_, _, known): &(_, _, Candidate<O>)| {
                        known.orbit == one.orbit && known.nascent == one.nascent
                    };
                    let back = orbit.is_rotation(one.orbit.signature());
                    if !back && longer.len() < MOST_TOGETHER && !longer.iter().any(known) {
                        longer.push((margin, between.clone(), one));
                    }
                }
            }
        }
        list = longer;
    }
    let entered = list.into_iter().filter_map(|(margin, between, candidate)| {
        let beyond = enter(&candidate, ds, tolerance).ok()?;
        Some((margin, between, beyond))
    });
    let mut entered: Vec<_> = entered.collect();
    // the longest first step, the first of several
    entered.sort_by(|(.., one), (.., other)| other.ds.total_cmp(&one.ds));
    let mut entered = entered.into_iter();
    let (margin, between, beyond) = entered.next()?;
    Some(Together {
        margin: margin.clone(),
        between,
        search: Search {
            beyond: Some(beyond),
            refused: Vec::new(),
            others: entered
                .map(|(.., other)| other.orbit.signature().clone())
                .collect(),
        },
    })
}

/// Two changes of regime at one place: within rounding neither of them comes first.
#[derive(Clone, Debug)]
pub struct Both<O: Orbit> {
    /// The margin that vanishes first.
    pub first: O::Margin,
    /// Boundary-value problem between the two.
    pub between: O,
    /// The event in its unknowns.
    pub node: Node,
    /// The other margin, as of the orbit in between.
    pub second: O::Margin,
    /// How far along the branch the second is from the first, by its slope.
    pub distance: f64,
    /// What lies beyond both.
    pub search: Search<O>,
}

/// Looks for the admissible continuation beyond the zeros of two margins where neither alone has one: the
/// orbit between them lasts no longer than rounding.
pub fn beyond_both<O: Orbit>(
    orbit: &O,
    at: &Node,
    margins: &[O::Margin],
    ds: f64,
    tolerance: f64,
) -> Option<Both<O>> {
    let point = &at.point;
    // margins of different zones may be alike, and different margins lead to the same orbit between
    let mut tried: Vec<(O, O::Margin)> = Vec::new();
    for first in margins {
        for candidate in orbit.candidates(point, first).ok()? {
            let between = candidate.orbit;
            let Some(node) = solved(&between, &candidate.point) else {
                continue;
            };
            let Ok(examination) = between.examination(&node.point) else {
                continue;
            };
            for other in margins.iter().filter(|other| !O::is_same(other, first)) {
                let mut zeros = examination.margins().iter().filter(|margin| {
                    orbit.is_alike(other, &between, margin)
                        && O::value(margin).abs() <= RESIDUAL_AT_EVENT
                });
                let entered = zeros.find_map(|second| {
                    let same = |(orbit, margin): &(O, O::Margin)| {
                        O::is_same(margin, second) && *orbit == between
                    };
                    if tried.len() >= MOST_PAIRS || tried.iter().any(same) {
                        return None;
                    }
                    tried.push((between.clone(), second.clone()));
                    let search = beyond(&between, &node.point, second, ds, tolerance);
                    // not back again by the same event
                    let after = search.beyond.as_ref()?.orbit.signature();
                    (!orbit.is_rotation(after)).then_some((second.clone(), search))
                });
                if let Some((second, search)) = entered {
                    let mut seen = AtZero {
                        margin: other.clone(),
                    };
                    let seen = seen.margin_at(orbit, point).ok()?;
                    return Some(Both {
                        distance: (O::value(seen) / orbit.slope(seen, &at.tangent)).abs(),
                        first: first.clone(),
                        between,
                        node,
                        second,
                        search,
                    });
                }
            }
        }
    }
    None
}

/// Where its own equations are singular, as where several zones vanish at once, an event is known to the root of rounding
/// only: the equations of a candidate that hold to this are corrected once, by no more than this.
const SINGULAR_EVENT: f64 = 1e-6;

/// The node of an event that is an orbit of these equations.
fn solved<O: Orbit>(orbit: &O, point: &Vector) -> Option<Node> {
    let known = Node::within(orbit, point.clone(), RESIDUAL_AT_EVENT);
    known.or_else(|| {
        let mut residual = Vector::zeros(orbit.unknowns() - 1);
        let mut matrix = Matrix::zeros(residual.len(), orbit.unknowns());
        let evaluated = orbit.evaluate(point, residual.as_mut_slice(), &mut matrix);
        evaluated.ok()?;
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
struct Entry<'a, O: Orbit> {
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
    fn all(candidate: &'a Candidate<O>) -> Vec<Entry<'a, O>> {
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
    fn along(&self, ds: f64, tries: usize, tolerance: f64) -> Result<Beyond<O>, NotEntered<O>> {
        let from = (&self.node, self.signs);
        enter_along(&self.candidate.orbit, from, ds, tries, tolerance)
    }

    /// The shortest step, where there seems to be none.
    fn shortest(&self, ds: f64, tolerance: f64) -> Result<(), NotEntered<O>> {
        if self.leads_nowhere {
            let shortest = ds * walk::SHORTER.powi(TRIES as i32 - 1);
            self.along(shortest, 1, tolerance)?;
        }
        Ok(())
    }
}

/// The branch beyond the zero of a margin as [`beyond`] has it, where nobody asks why candidates are refused: all are
/// tried with one first step before any is with a shorter one, since the longest step decides.
pub fn nearest_beyond<O: Orbit>(
    orbit: &O,
    point: &Vector,
    margin: &O::Margin,
    ds: f64,
    tolerance: f64,
) -> Option<Beyond<O>> {
    let candidates = orbit.candidates(point, margin).ok()?;
    if candidates.iter().any(|one| one.orbit.is_layered()) {
        return beyond(orbit, point, margin, ds, tolerance).beyond;
    }
    let entries: Vec<Entry<O>> = candidates.iter().flat_map(Entry::all).collect();
    let lengths = std::iter::successors(Some(ds), |ds| Some(ds * walk::SHORTER)).take(TRIES);
    let tries = lengths.flat_map(|length| entries.iter().map(move |entry| (length, entry)));
    let mut admitted = tries.filter_map(|(length, entry)| {
        let beyond = entry.along(length, 1, tolerance).ok()?;
        entry.shortest(ds, tolerance).is_ok().then_some(beyond)
    });
    admitted.next()
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
        let value = O::value(margin);
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
fn enter_along<O: Orbit>(
    orbit: &O,
    (node, signs): (&Node, &[f64]),
    ds: f64,
    tries: usize,
    tolerance: f64,
) -> Result<Beyond<O>, NotEntered<O>> {
    let mut refused = Err(NotEntered::NoSolution);
    let entered = walk::enter(orbit, (node, signs), ds, tries, tolerance, |from, step| {
        let forwards = from.tangent == node.tangent;
        let refusal = match step.map(|to| orbit.examination(&to.point)) {
            Ok(Ok(examination)) if examination.verdict() == SignVerdict::Positive => {
                return Some(());
            }
            // what fails on the way back says nothing
            Ok(Ok(_)) if !forwards => return None,
            Ok(Ok(examination)) => {
                Refused::Curve(OrbitRefusal::Inadmissible(orbit.inadmissible(&examination)))
            }
            Ok(Err(error)) => Refused::Curve(OrbitRefusal::Flow(error)),
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
    let branching = Branching::new(orbit, point, NULL)?;
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
        .filter(|margin| O::value(margin).abs() < 1e-6)
        .map(|margin| orbit.slope(margin, tangent))
        .sum()
}

/// Why a branch ends at an event where a margin vanishes and none of these continues it.
pub(super) fn ending<O: Orbit>(
    orbit: &O,
    point: &Vector,
    margin: &O::Margin,
    refused: Vec<Tried<O>>,
) -> BranchStop<O> {
    match orbit.ends_at(point, margin) {
        Some(stop) => BranchStop::Own(stop),
        None if refused.is_empty() => BranchStop::NoSignature,
        None => BranchStop::NoneAdmissible(refused),
    }
}
