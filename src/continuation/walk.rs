//! Following a curve: the one driver behind every branch and every curve of events.
//!
//! A [`Curve`] is a zero curve of a system with functions that are watched along it. The [`Walker`] takes
//! a step of pseudo-arclength, has the functions evaluated at its end, and halves the step where that
//! fails. Where a function seems to vanish twice within the step it is halved, too, and where it does the
//! step ends at its least value. What happens within it is located, put in order and handed to the curve, which says of each
//! event whether it goes on as before, goes on as another curve, or ends. A curve also ends where
//! it comes back to its first point, where no step succeeds, and where its steps creep.

use std::error::Error;

use serde::{Deserialize, Serialize};

use super::arclength::{self, Node, Steps};
use super::locate::Place;
use super::newton::System;

/// A zero curve of a system, what is watched along it, and what happens where that vanishes.
pub trait Curve: Sized {
    /// Its equations.
    type System: System;
    /// Tells curves apart that have different equations.
    type Name: Clone + PartialEq;
    /// Values of the watched functions at a node.
    type Watched: Clone;
    /// What is located within a step.
    type Event: Clone;
    /// What is handed out.
    type Found;
    /// Why the curve refuses a step.
    type Refusal: Error;
    /// Why the curve ends for reasons of its own.
    type End;
    /// What comes so close to zero that rounding decides whether it vanishes.
    type Close;

    /// Creeping steps after which the curve ends, and the length below which a step creeps, in units of the
    /// first one. Steps that short come from rejections: they grow by half from one to the next.
    const CREEP: (usize, f64);

    /// Its equations.
    fn system(&self) -> &Self::System;

    /// Its name.
    fn name(&self) -> &Self::Name;

    /// The watched functions at a node; `near` are those of a node nearby.
    fn watch(
        &self,
        node: &Node,
        near: Option<&Self::Watched>,
    ) -> Result<Self::Watched, Self::Refusal>;

    /// Whether a watched function seems to vanish twice within the step, by its values and slopes at both
    /// ends.
    fn may_hide_a_pair(&self, _step: &Segment<Self::Watched>) -> bool {
        false
    }

    /// Whether a watched function that is positive at both ends of the step vanishes in between, and
    /// before the curve ends at one of the events located there.
    fn within(
        &self,
        step: &Segment<Self::Watched>,
        located: &[(Place, Self::Event)],
    ) -> Within<Self::Close>;

    /// A point before which something comes so close to zero that rounding decides.
    fn doubted(&self, found: Self::Found, close: Self::Close) -> Self::Found;

    /// All that happens within a step, in any order.
    fn locate(
        &self,
        step: &Segment<Self::Watched>,
    ) -> Result<Vec<(Place, Self::Event)>, Self::Refusal>;

    /// What comes of an event; `together` are the events at its place, itself the first.
    fn meet(
        &self,
        step: &Segment<Self::Watched>,
        place: &Place,
        together: &[Self::Event],
    ) -> Result<Outcome<Self>, Self::Refusal>;

    /// Takes note of a node that was reached, with what is watched there and what was passed on the way, and may take
    /// other unknowns of the same point.
    fn arrive(&mut self, node: &mut Node, watched: &Self::Watched, passed: &[(Place, Self::Event)]);

    /// How many times longer than elsewhere the longest step from a node may be: more than 1 where unknowns are
    /// much larger than their units.
    fn stretch(&self, _node: &Node) -> f64 {
        1.0
    }

    /// A point without an event.
    fn point(&self, s: f64, node: &Node, watched: &Self::Watched) -> Self::Found;

    /// The point of a step that closes the curve: its first point is at arclength `s` of it, and it
    /// comes to `reached`.
    fn closing(&self, s: f64, first: &Node, reached: Self::Found) -> Self::Found;

    /// The first node of the curve by every set of unknowns next to a node that gives the same point: an angle has many,
    /// and a cycle that repeats itself may begin at several places.
    fn aliases(&self, first: &Node, _near: &Node) -> Vec<Node> {
        vec![first.clone()]
    }

    /// Why the curve does not go on from a node that was reached.
    fn exhausted(&self, _node: &Node) -> Option<Self::End> {
        None
    }

    /// Whether a step refused at its shortest ends the curve itself, and not only the search for it.
    fn ends_with(&self, _refusal: &Self::Refusal) -> Option<Self::End> {
        None
    }

    /// Whether a curve that finds no step from a node ends there for a reason of its own.
    fn ends_at(&self, _node: &Node) -> Option<Self::End> {
        None
    }

    /// The point that tells of an end other than an event.
    fn last(&self, _end: &EndOf<Self>, _here: Self::Found) -> Option<Self::Found> {
        None
    }
}

/// What happens between the ends of a step to functions that are positive at both.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Within<K> {
    /// None of them vanishes.
    Nothing,
    /// One of them is least, and negative, this far along the step: it vanishes before and after.
    Pair(f64),
    /// One of them is zero but for rounding, this far along the step.
    Close(f64, K),
}

/// Why a step was refused.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, thiserror::Error)]
pub enum Refused<F: Error, R: Error> {
    /// There is no such step.
    #[error("{0}")]
    Step(#[from] arclength::Refusal<F>),
    /// A watched function vanishes twice within it.
    #[error("two events lie closer together than a step")]
    Pair,
    /// The curve refuses it.
    #[error("{0}")]
    Curve(R),
}

/// Why a step of a curve was refused.
pub(crate) type RefusalOf<C> =
    Refused<<<C as Curve>::System as System>::Failure, <C as Curve>::Refusal>;

/// How a curve ended.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum End<R, E> {
    /// At an edge of a range.
    Edge,
    /// On its first point.
    Closed,
    /// After as many points as it may have.
    MaxPoints {
        /// How many.
        most: usize,
    },
    /// With steps in a row so short that they do not lead on.
    Creeps {
        /// How many.
        steps: usize,
        /// All are shorter than this.
        longest: f64,
    },
    /// Where no step succeeds.
    NoStep {
        /// The shortest one.
        ds_min: f64,
        /// Why it was refused.
        reason: R,
    },
    /// For a reason of its own.
    Own(E),
}

/// How a curve of a kind ended.
pub(crate) type EndOf<C> = End<RefusalOf<C>, <C as Curve>::End>;

/// What comes of an event.
pub enum Outcome<C: Curve> {
    /// The curve passes it.
    Passed(C::Found),
    /// Another curve goes on, also where two events at one place lead there.
    Entered(Vec<C::Found>, Beginning<C>),
    /// The curve ends there.
    Ended(Vec<C::Found>, EndOf<C>),
}

/// The beginning of another curve.
pub struct Beginning<C: Curve> {
    /// The curve.
    pub curve: C,
    /// Its first node.
    pub node: Node,
    /// The watched functions there.
    pub watched: C::Watched,
    /// Length of its first step.
    pub ds: f64,
}

/// A step along a curve, from one node to the next, with the values `W` of the watched functions at both.
pub struct Segment<'a, W> {
    /// Where it sets out.
    pub from: &'a Node,
    /// The watched functions there.
    pub before: &'a W,
    /// Where it comes to.
    pub to: &'a Node,
    /// The watched functions there.
    pub after: &'a W,
    /// Its length.
    pub ds: f64,
    /// Step lengths and tolerance of the walk.
    pub steps: &'a Steps,
}

impl<W> Segment<'_, W> {
    /// Zeros closer together than this are one event that several watched functions see.
    pub(crate) fn at_once(&self) -> f64 {
        /// As a part of the step.
        const AT_ONCE: f64 = 1e-6;
        AT_ONCE * self.ds.max(1e-3)
    }
}

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

/// How often a step is halved because a function seems to vanish twice in it, before its least value is
/// looked for.
const HALVINGS_FOR_PAIRS: u32 = 8;

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
        let Steps { ds_min, ds_max, .. } = self.steps;
        let longest = ds_max * self.curve.stretch(&self.node);
        let mut ds = self.ds.clamp(ds_min, longest);
        let mut halvings = 0;
        loop {
            let refusal = match self.attempt(ds, halvings < HALVINGS_FOR_PAIRS) {
                Ok(taken) => return taken,
                Err(refusal) => refusal,
            };
            if ds <= ds_min {
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

    /// One step of length `ds`, or as far as to the least value between two zeros. Refused where a function
    /// seems to vanish twice and the step may be `shorter`.
    #[allow(clippy::type_complexity)] // points and end, as of `step`
    fn attempt(
        &mut self,
        ds: f64,
        shorter: bool,
    ) -> Result<(Vec<C::Found>, Option<EndOf<C>>), RefusalOf<C>> {
        let (system, tolerance) = (self.curve.system(), self.steps.tolerance);
        let taken = arclength::advance(system, &self.node, &self.before, ds, tolerance)?;
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
        let mut close = match self.curve.within(&step, &located) {
            Within::Nothing => None,
            Within::Pair(least) if least >= self.steps.ds_min && least < ds => {
                return self.attempt(least, shorter);
            }
            Within::Pair(_) => return Err(Refused::Pair),
            Within::Close(s, close) => Some((s, close)),
        };
        let mut found = Vec::new();
        let mut doubt = |curve: &C, s: f64, point: C::Found| match close.take_if(|(at, _)| *at <= s)
        {
            Some((_, close)) => curve.doubted(point, close),
            None => point,
        };
        for (index, (place, _)) in located.iter().enumerate() {
            let together: Vec<C::Event> = located[index..]
                .iter()
                .filter(|(other, _)| other.s - place.s <= step.at_once())
                .map(|(_, event)| event.clone())
                .collect();
            match self.curve.meet(&step, place, &together).map_err(refused)? {
                Outcome::Passed(point) => found.push(doubt(&self.curve, place.s, point)),
                Outcome::Ended(points, end) => {
                    found.extend(points);
                    return Ok((found, Some(end)));
                }
                Outcome::Entered(points, entry) => {
                    // what vanishes along with the event is the event
                    let before = place.s - step.at_once();
                    found.extend(
                        points
                            .into_iter()
                            .map(|point| doubt(&self.curve, before, point)),
                    );
                    self.travelled += place.s.max(0.0);
                    self.creeping = 0;
                    self.curve = entry.curve;
                    self.node = entry.node;
                    self.before.clear();
                    self.watched = entry.watched;
                    self.ds = entry.ds;
                    return Ok((found, None));
                }
            }
        }
        let passed = self.closes(&step);
        let from = std::mem::replace(&mut self.node, taken.node);
        self.travelled += ds;
        self.watched = watched;
        self.ds = taken.next;
        self.curve.arrive(&mut self.node, &self.watched, &located);
        arclength::passed(&mut self.before, from.clone());
        let here = |walker: &Walker<C>| walker.curve.point(ds, &walker.node, &walker.watched);
        if let Some(passed) = passed {
            let (_, first) = &self.origin;
            let s = from.tangent.dot(&(&passed.point - &from.point));
            found.push(self.curve.closing(s, first, here(self)));
            return Ok((found, Some(End::Closed)));
        }
        found.push(doubt(&self.curve, ds, here(self)));
        let creeps = self.creeps(ds);
        let creeps = creeps.map(|end| self.curve.ends_at(&self.node).map_or(end, End::Own));
        let end = self.curve.exhausted(&self.node).map(End::Own).or(creeps);
        if let Some(end) = &end {
            found.extend(self.curve.last(end, here(self)));
        }
        Ok((found, end))
    }

    /// Counts steps that creep; the end of a curve that has taken too many in a row.
    fn creeps(&mut self, ds: f64) -> Option<EndOf<C>> {
        let (steps, part) = C::CREEP;
        let longest = part * self.steps.ds;
        self.creeping = if ds < longest { self.creeping + 1 } else { 0 };
        (self.creeping >= steps).then_some(End::Creeps { steps, longest })
    }

    /// The first point, as one of its aliases, where a step passes it again.
    fn closes(&self, step: &Segment<C::Watched>) -> Option<Node> {
        let (name, first) = &self.origin;
        if self.travelled < 4.0 * step.ds || name != self.curve.name() {
            return None;
        }
        let passes = |first: &Node| {
            let side = |node: &Node| first.tangent.dot(&(&node.point - &first.point));
            side(step.from) < 0.0
                && side(step.to) >= 0.0
                && (&step.to.point - &first.point).norm() <= CLOSED * step.ds
                && step.to.tangent.dot(&first.tangent) > 0.9
        };
        self.curve.aliases(first, step.to).into_iter().find(passes)
    }
}

/// Signs of a tangent along which a curve may go either way.
pub(crate) const EITHER_WAY: [f64; 2] = [1.0, -1.0];

/// Lengths of the first step into another curve: each a quarter of the one before.
pub(crate) const SHORTER: f64 = 0.25;

/// The first step from a point along its tangent, times one of these signs, that `admit` admits, and its length. Tried from
/// `ds` down, `tries` times. `admit` sees the node that sets out and the step or why there is none.
pub fn enter<S: System, T>(
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::continuation::circle::Circle;
    use crate::continuation::locate::{Target, zero_along};
    use crate::linalg::Vector;

    /// The circle beyond x = 1/2 is not there.
    #[derive(Clone, Debug, PartialEq, thiserror::Error)]
    #[error("x = {0} is too small")]
    struct TooSmall(f64);

    /// The circle on which y = x is watched, up to an edge, and x ≥ `least` is asked for.
    struct Watched {
        edge: f64,
        least: f64,
    }

    #[derive(Clone, Copy)]
    enum Event {
        Diagonal,
        Edge,
    }

    impl Curve for Watched {
        type System = Circle;
        type Name = ();
        type Watched = f64;
        type Event = Event;
        type Found = (bool, Vector);
        type Refusal = TooSmall;
        type End = ();
        type Close = ();

        const CREEP: (usize, f64) = (20, 1e-3);

        fn system(&self) -> &Circle {
            &Circle
        }

        fn name(&self) -> &() {
            &()
        }

        fn watch(&self, node: &Node, _: Option<&f64>) -> Result<f64, TooSmall> {
            let (x, y) = (node.point[0], node.point[1]);
            if x < self.least {
                Err(TooSmall(x))
            } else {
                Ok(y - x)
            }
        }

        fn within(&self, _: &Segment<f64>, _: &[(Place, Event)]) -> Within<()> {
            Within::Nothing
        }

        fn doubted(&self, found: (bool, Vector), (): ()) -> (bool, Vector) {
            found
        }

        fn locate(&self, step: &Segment<f64>) -> Result<Vec<(Place, Event)>, TooSmall> {
            let target = Target {
                index: 1,
                value: self.edge,
                outside: 1.0,
            };
            let way = [&step.from.point, &step.to.point];
            let met = target.meetings(&Circle, step.from, &way, 1e-10).unwrap();
            let mut located: Vec<_> = met.into_iter().map(|place| (place, Event::Edge)).collect();
            if step.before * step.after < 0.0 {
                let ends = ((0.0, *step.before), (step.ds, *step.after));
                let value = |node: &Node| Some(node.point[1] - node.point[0]);
                let zero = zero_along(&Circle, step.from, ends, (1e-15, 1e-16), 1e-10, value);
                located.push((zero.unwrap().0, Event::Diagonal));
            }
            Ok(located)
        }

        fn meet(
            &self,
            step: &Segment<f64>,
            place: &Place,
            together: &[Event],
        ) -> Result<Outcome<Watched>, TooSmall> {
            let (_, point) = self.point(place.s, &place.node, step.after);
            Ok(match together[0] {
                Event::Diagonal => Outcome::Passed((true, point)),
                Event::Edge => Outcome::Ended(vec![(true, point)], End::Edge),
            })
        }

        fn arrive(&mut self, _: &mut Node, _: &f64, _: &[(Place, Event)]) {}

        fn point(&self, _: f64, node: &Node, _: &f64) -> (bool, Vector) {
            (false, node.point.clone())
        }

        fn closing(&self, _: f64, first: &Node, _: (bool, Vector)) -> (bool, Vector) {
            (true, first.point.clone())
        }
    }

    /// Follows the circle from (1, 0) upwards: the special points and the end.
    fn walked(edge: f64, least: f64) -> (Vec<Vector>, EndOf<Watched>) {
        let node = Node {
            point: Vector::from_vec(vec![1.0, 0.0]),
            tangent: Vector::from_vec(vec![0.0, 1.0]),
            newton: 0,
            residual: 0.0,
        };
        let steps = Steps {
            ds: 0.05,
            ds_min: 1e-9,
            ds_max: 0.1,
            tolerance: 1e-10,
        };
        let mut walker = Walker::begin(Watched { edge, least }, node, steps).unwrap();
        let mut special = Vec::new();
        for _ in 0..10_000 {
            let (found, end) = walker.step();
            for (is_special, point) in found {
                assert!((point.norm() - 1.0).abs() < 4.0 * f64::EPSILON);
                special.extend(is_special.then_some(point));
            }
            if let Some(end) = end {
                return (special, end);
            }
        }
        panic!("the walk does not end");
    }

    #[test]
    fn a_closed_curve_ends_on_its_first_point() {
        let (special, end) = walked(2.0, -2.0);
        assert_eq!(end, End::Closed);
        let half = 0.5_f64.sqrt();
        let expected = [[half, half], [-half, -half], [1.0, 0.0]];
        assert_eq!(special.len(), expected.len());
        for (point, [x, y]) in special.iter().zip(expected) {
            assert!((point[0] - x).abs() < 1e-14 && (point[1] - y).abs() < 1e-14);
        }
    }

    #[test]
    fn an_edge_is_met_exactly_and_ends_the_curve() {
        let (special, end) = walked(0.9, -2.0);
        assert_eq!(end, End::Edge);
        assert_eq!(special.len(), 2);
        assert_eq!(special[1][1], 0.9);
    }

    /// A step is halved down to the shortest one before the curve is given up. Steps that short creep.
    #[test]
    fn a_curve_without_a_step_says_why() {
        let (special, end) = walked(2.0, 0.5);
        assert_eq!(special.len(), 1);
        match end {
            End::NoStep {
                reason: Refused::Curve(TooSmall(x)),
                ..
            } => assert!((x - 0.5).abs() < 1e-8, "{x}"),
            End::Creeps { steps, .. } => assert_eq!(steps, 20),
            other => panic!("{other:?}"),
        }
    }
}
