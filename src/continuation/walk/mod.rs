//! Following a curve: the one driver behind every branch and every curve of events.
//!
//! A [`Curve`] is a zero curve of a system with functions that are watched along it. The [`Walker`] takes
//! a step of pseudo-arclength, has the functions evaluated at its end, and halves the step where that
//! fails. Where a function seems to vanish twice within the step it is halved, too, and where it does the
//! step ends at its least value. What happens within it is located, put in order and handed to the curve, which says of each
//! event whether it goes on as before, goes on as another curve, or ends. A curve also ends where
//! it comes back to its first point, where no step succeeds, and where its steps creep.

mod curve;
#[cfg(test)]
mod tests;

pub use curve::{Curve, CurveBeginning, End, Outcome, Refused, Segment, WatchedCurve, Within};
pub(crate) use curve::{EndOf, RefusalOf};

use super::arclength::{self, ArclengthStep, Node, Steps};
use super::locate::{Place, beyond_kink};
use super::newton::{self, Equations};

/// A curve being followed.
#[derive(Clone, Debug)]
pub struct Walker<C: Curve> {
    pub(crate) curve: C,
    pub(crate) node: Node,
    /// Those before it on the same curve, the last first.
    pub(crate) before: Vec<Node>,
    pub(crate) watched: C::Watched,
    /// Length of the next step.
    pub(crate) ds: f64,
    /// First point and name: a closed curve comes back.
    pub(crate) origin: (C::Name, Node),
    /// Arclength since the first point.
    pub(crate) travelled: f64,
    /// Steps in a row that creep.
    pub(crate) creeping: usize,
    pub(crate) steps: Steps,
}

/// What comes of all events of a step.
enum StepOutcome<C: Curve> {
    /// The curve passes them.
    Passed,
    /// It ends.
    Ended(EndOf<C>),
    /// Another curve goes on, from this far along the step.
    Entered(f64, CurveBeginning<C>),
}

/// How often a step is halved because a function seems to vanish twice in it, before its least value is
/// looked for.
const HALVINGS_FOR_PAIRS: u32 = 8;

/// How often a step is taken only as far as to the least value of a function within it before it is halved: most are so once, but where
/// a function is rounding there is always another.
const MOST_PAIRS: u32 = 16;

/// Steps shorter than this, in units of the first, are looked at for why.
const SHORT: f64 = 1e-2;

/// A curve has closed when it passes this close to its first point, in units of the last step.
const CLOSED: f64 = 1.0;

impl<C: Curve> Walker<C> {
    /// Begins at a node.
    ///
    /// # Errors
    /// When the watched functions cannot be evaluated there.
    pub fn begin(curve: C, node: Node, steps: Steps) -> Result<Walker<C>, C::Refusal> {
        Ok(Walker {
            watched: curve.watch(&node, None)?,
            origin: (curve.name().clone(), node.clone()),
            node,
            before: Vec::new(),
            ds: steps.ds,
            travelled: 0.0,
            creeping: 0,
            steps,
            curve,
        })
    }

    /// The curve as it is at the point reached.
    pub fn curve(&self) -> &C {
        &self.curve
    }

    /// The node from which the next step sets out.
    pub fn node(&self) -> &Node {
        &self.node
    }

    /// The point reached.
    pub fn here(&self) -> C::Found {
        self.curve.point(0.0, &self.node, &self.watched)
    }

    /// Takes one step, shorter if need be. Returns the points found, in order, and how the curve ended
    /// if it did.
    pub fn step(&mut self) -> (Vec<C::Found>, Option<EndOf<C>>) {
        let mut creeps = self.ds < SHORT * self.steps.ds;
        self.renew(creeps);
        let Steps { ds_min, ds_max, .. } = self.steps;
        let longest = ds_max * self.curve.stretch(&self.node);
        let mut ds = self.ds.clamp(ds_min, longest);
        let mut halvings = 0;
        loop {
            let refusal = match self.attempt(ds, halvings < HALVINGS_FOR_PAIRS, MOST_PAIRS) {
                Ok(taken) => return taken,
                Err(refusal) => refusal,
            };
            // a step that was long before may fail for unknowns that suit short ones
            if !creeps && ds < SHORT * self.steps.ds {
                creeps = true;
                if self.renew(creeps) {
                    ds = self.ds.clamp(ds_min, longest);
                    continue;
                }
            }
            if ds <= ds_min {
                if let Some(outcome) = self.curve.leads_on(&self.node, &self.watched) {
                    return self.taken(outcome);
                }
                let own = match &refusal {
                    Refused::Curve(reason) => self.curve.ends_with(reason),
                    _ => None,
                };
                let own = own.or_else(|| self.curve.ends_at(&self.node));
                let end = match own {
                    Some(own) => End::Own(own),
                    None => End::NoStep {
                        ds_min,
                        reason: refusal,
                    },
                };
                let last = self.curve.last(&end, self.here());
                return (last.into_iter().collect(), Some(end));
            }
            halvings += u32::from(matches!(refusal, Refused::Pair));
            ds = (0.5 * ds).max(ds_min);
        }
    }

    /// Takes the unknowns that suit the node, where they are others; `creeps` where steps are short.
    fn renew(&mut self, creeps: bool) -> bool {
        let renewed = self.curve.renewed(&self.node, &self.watched, creeps);
        let Some((curve, node, watched)) = renewed else {
            return false;
        };
        (self.curve, self.node, self.watched) = (curve, node, watched);
        self.before.clear();
        true
    }

    /// Goes on beyond an event at the node itself.
    fn taken(&mut self, outcome: Outcome<C>) -> (Vec<C::Found>, Option<EndOf<C>>) {
        match outcome {
            Outcome::Passed(point) => (vec![point], None),
            Outcome::Entered(points, entry) => {
                self.enter(0.0, entry);
                (points, None)
            }
            Outcome::Ended(points, end) => (points, Some(end)),
        }
    }

    /// The points of the curve in their order, to its end.
    pub fn points(mut self) -> impl Iterator<Item = C::Found> {
        let mut ended = false;
        let steps = std::iter::from_fn(move || {
            (!ended).then(|| {
                let (found, end) = self.step();
                ended = end.is_some();
                found
            })
        });
        steps.flatten()
    }

    /// One step of length `ds`, or as far as to the least value between two zeros, of which so many may be found. Refused where a
    /// function seems to vanish twice and the step may be `shorter`.
    #[allow(clippy::type_complexity)] // points and end, as of `step`
    fn attempt(
        &mut self,
        ds: f64,
        shorter: bool,
        pairs: u32,
    ) -> Result<(Vec<C::Found>, Option<EndOf<C>>), RefusalOf<C>> {
        let (system, tolerance) = (self.curve.system(), self.steps.tolerance);
        let taken = arclength::advance(system, &self.node, &self.before, ds, tolerance);
        let taken = taken.map(|step| (step, ds)).or_else(|refusal| {
            let reached = match &refusal {
                arclength::Refusal::Angle { .. } if system.has_kinks() => {
                    let beyond = beyond_kink(system, &self.node, ds, tolerance);
                    beyond.map(|node| (node, ds))
                }
                // what makes no sense beyond an edge does on it
                arclength::Refusal::Corrector(newton::Failure::System(_)) => {
                    self.curve.at_edge(&self.node, ds, tolerance)
                }
                _ => None,
            };
            let step = reached.map(|(node, s)| (ArclengthStep { node, next: ds }, s));
            step.ok_or(refusal)
        });
        let (taken, ds) = taken?;
        let refused = Refused::Curve;
        let watched = self
            .curve
            .watch(&taken.node, Some(&self.watched))
            .map_err(refused)?;
        let step = Segment {
            from: &self.node,
            before: &self.watched,
            to: &taken.node,
            after: &watched,
            ds,
            steps: &self.steps,
        };
        if shorter && self.curve.may_hide_a_pair(&step) {
            return Err(Refused::Pair);
        }
        let mut located = self.curve.locate(&step).map_err(refused)?;
        located.sort_by(|(one, _), (other, _)| one.s.total_cmp(&other.s));
        let passed = self.closes(&step);
        if let Some((s, _)) = &passed {
            // what lies beyond the first point has been met where the curve set out
            located.retain(|(place, _)| place.s <= s + step.at_once());
        }
        let mut close = match self.curve.within(&step, &located) {
            Within::Nothing => None,
            Within::Pair(least) if least >= self.steps.ds_min && least < ds && pairs > 0 => {
                return self.attempt(least, shorter, pairs - 1);
            }
            Within::Pair(_) => return Err(Refused::Pair),
            Within::Close(s, close) => Some((s, close)),
        };
        let mut found = Vec::new();
        match self.meet_all(&step, &located, &mut close, &mut found)? {
            StepOutcome::Passed => {}
            StepOutcome::Ended(end) => return Ok((found, Some(end))),
            StepOutcome::Entered(s, entry) => {
                self.enter(s, entry);
                return Ok((found, None));
            }
        }
        let from = std::mem::replace(&mut self.node, taken.node);
        self.travelled += ds;
        self.watched = watched;
        self.ds = taken.next;
        self.curve.arrive(&mut self.node, &self.watched, &located);
        arclength::passed(&mut self.before, from);
        let here = |walker: &Walker<C>| walker.curve.point(ds, &walker.node, &walker.watched);
        if let Some((s, passed)) = passed {
            let (name, first) = &self.origin;
            let is_own = name == self.curve.name();
            let first = if is_own { first } else { &passed };
            found.push(self.curve.closing(s, first, here(self)));
            return Ok((found, Some(End::Closed)));
        }
        found.push(self.doubted(&mut close, ds, here(self)));
        let creeps = self.creeps(ds);
        let creeps = creeps.map(|end| self.curve.ends_at(&self.node).map_or(end, End::Own));
        let end = self.curve.exhausted(&self.node).map(End::Own).or(creeps);
        if let Some(end) = &end {
            found.extend(self.curve.last(end, here(self)));
        }
        Ok((found, end))
    }

    /// Hands the events of a step to the curve, in order, as far as that goes on.
    fn meet_all(
        &self,
        step: &Segment<C::Watched>,
        located: &[(Place, C::Event)],
        close: &mut Option<(f64, C::Close)>,
        found: &mut Vec<C::Found>,
    ) -> Result<StepOutcome<C>, RefusalOf<C>> {
        for (index, (place, _)) in located.iter().enumerate() {
            let together: Vec<C::Event> = located[index..]
                .iter()
                .filter(|(other, _)| other.s - place.s <= step.at_once())
                .map(|(_, event)| event.clone())
                .collect();
            let outcome = self.curve.meet(step, place, &together);
            match outcome.map_err(Refused::Curve)? {
                Outcome::Passed(point) => found.push(self.doubted(close, place.s, point)),
                Outcome::Ended(points, end) => {
                    found.extend(points);
                    return Ok(StepOutcome::Ended(end));
                }
                Outcome::Entered(points, entry) => {
                    // what vanishes along with the event is the event
                    let before = place.s - step.at_once();
                    let points = points.into_iter();
                    found.extend(points.map(|point| self.doubted(close, before, point)));
                    return Ok(StepOutcome::Entered(place.s, entry));
                }
            }
        }
        Ok(StepOutcome::Passed)
    }

    /// A point this far along a step, in doubt where something has come close to zero by then.
    fn doubted(&self, close: &mut Option<(f64, C::Close)>, s: f64, point: C::Found) -> C::Found {
        match close.take_if(|(at, _)| *at <= s) {
            Some((_, close)) => self.curve.doubted(point, close),
            None => point,
        }
    }

    /// Goes on with another curve, which begins this far along a step.
    fn enter(&mut self, s: f64, entry: CurveBeginning<C>) {
        self.travelled += s.max(0.0);
        self.creeping = 0;
        self.curve = entry.curve;
        self.node = entry.node;
        self.before.clear();
        self.watched = entry.watched;
        self.ds = entry.ds;
    }

    /// Counts steps that creep; the end of a curve that has taken too many in a row.
    fn creeps(&mut self, ds: f64) -> Option<EndOf<C>> {
        let (steps, part) = C::CREEP;
        let longest = part * self.steps.ds;
        self.creeping = if ds < longest { self.creeping + 1 } else { 0 };
        (self.creeping >= steps).then_some(End::Creeps { steps, longest })
    }

    /// Where a step passes the first point again, and that point as one of its aliases.
    fn closes(&self, step: &Segment<C::Watched>) -> Option<(f64, Node)> {
        let (name, first) = &self.origin;
        if self.travelled < 4.0 * step.ds {
            return None;
        }
        let passes = |first: &Node| {
            let side = |node: &Node| first.tangent.dot(&(&node.point - &first.point));
            side(step.from) < 0.0
                && side(step.to) >= 0.0
                && (&step.to.point - &first.point).norm() <= CLOSED * step.ds
                && step.to.tangent.dot(&first.tangent) > 0.9
        };
        let aliases = self.curve.aliases(name, first, step.to);
        let first = aliases.into_iter().find(passes)?;
        let s = step.from.tangent.dot(&(&first.point - &step.from.point));
        Some((s, first))
    }
}

/// Signs of a tangent along which a curve may go either way.
pub(crate) const EITHER_WAY: [f64; 2] = [1.0, -1.0];

/// Lengths of the first step into another curve: each a quarter of the one before.
pub(crate) const SHORTER: f64 = 0.25;

/// The first step from a point along its tangent, times one of these signs, that `admit` admits, and its length. Tried from
/// `ds` down, `tries` times. `admit` sees the node that sets out and the step or why there is none.
pub fn enter<S: Equations, T>(
    system: &S,
    (node, signs): (&Node, &[f64]),
    mut ds: f64,
    tries: usize,
    tolerance: f64,
    mut admit: impl FnMut(&Node, Result<Node, arclength::Refusal<S::Failure>>) -> Option<T>,
) -> Option<(Node, f64, T)> {
    for _ in 0..tries {
        for sign in signs {
            let from = Node {
                tangent: &node.tangent * *sign,
                ..node.clone()
            };
            let step = arclength::advance(system, &from, &[], ds, tolerance).map(|step| step.node);
            if let Some(admitted) = admit(&from, step) {
                return Some((from, ds, admitted));
            }
        }
        ds *= SHORTER;
    }
    None
}
