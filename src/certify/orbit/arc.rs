//! Arcs of orbits, between two special points of a branch.

use super::beyond::{self, Seen};
use super::open::{NotBeyond, Unproven};
use super::system::{Condition, Near, OrbitSystem, Posed};
use super::{Proof, Sequence};
use crate::certify::arc::{self, Broken, Curve, Joint, Moving, Way};
use crate::certify::equations::Evaluated;
use crate::certify::krawczyk;
use crate::interval::{Decimal, Interval};

/// Why an arc of orbits is not proven.
pub type Undecided = Broken<Unproven, NotBeyond>;

struct Arc<'a> {
    system: OrbitSystem<'a>,
    units: Vec<f64>,
    /// Stretches that have no duration at an end.
    closed: [Vec<usize>; 2],
    /// The equations of a fold at an end, and their zero in doubles.
    folds: [Option<(OrbitSystem<'a>, Vec<f64>)>; 2],
}

/// A point in the sequence of an arc.
#[derive(Clone, Copy)]
struct Place<'a> {
    proof: &'a Proof,
    near: &'a Near,
    condition: &'a Condition,
    /// The point in this sequence, where it is proven in another.
    seen: Option<&'a Seen>,
}

impl<'a> Place<'a> {
    /// A point, at a change of the sequence in that before or in that beyond; `None` where it is not known.
    fn new(proof: &'a Proof, beyond: bool) -> Option<Place<'a>> {
        let changed = proof.changed.as_ref();
        let sequence = changed.map_or(Some(&proof.near.sequence), |changed| match beyond {
            true => changed.after.as_ref(),
            false => Some(&changed.before),
        });
        let sequence: &Sequence = sequence?;
        let mut others = proof.seen.iter();
        let seen = match proof.near.sequence == *sequence {
            true => None,
            false => Some(others.find(|seen| seen.near.sequence == *sequence)?),
        };
        let (near, condition) = match seen {
            Some(Seen { near, condition }) => (near, condition),
            None => (&proof.near, &proof.condition),
        };
        Some(Place {
            proof,
            near,
            condition,
            seen,
        })
    }

    /// The point in the unknowns of an arc, and its stretches of no duration.
    fn joint(&self, arc: &OrbitSystem) -> Result<(Joint, Vec<usize>), Undecided> {
        let closed = match self.seen {
            Some(seen) => beyond::prove(self.proof, seen).map_err(Broken::Beyond)?,
            None => Vec::new(),
        };
        let found = || {
            let (system, middle) =
                OrbitSystem::new(&self.proof.posed, self.near, self.condition).ok()?;
            let equations = |x: &[Interval]| system.evaluate(x);
            let zero = krawczyk::enclosed(&equations, &middle, &system.units(&middle))?;
            system.carried(&zero.at, arc).map(Joint::new)
        };
        Ok((found().ok_or(Broken::End)?, closed))
    }
}

/// Whether two points are of one system and one sequence.
fn are_alike([one, other]: [&Place; 2]) -> bool {
    let but = |posed: &Posed| {
        let values = posed.values.iter().cloned().enumerate();
        let values = values.filter(|(index, _)| *index != posed.parameter);
        values.collect::<Vec<(usize, Decimal)>>()
    };
    let [a, b] = [&one.proof.posed, &other.proof.posed];
    a.system == b.system
        && a.parameter == b.parameter
        && a.periods == b.periods
        && but(a) == but(b)
        && one.near.sequence == other.near.sequence
}

/// Proves that between two points of a branch the orbits are one curve of one sequence without a fold.
///
/// # Errors
/// It is not proven.
pub fn prove(from: &Proof, to: &Proof) -> Result<(), Undecided> {
    let places = Place::new(from, true).zip(Place::new(to, false));
    let (from, to) = places.ok_or(Broken::Apart)?;
    if !are_alike([&from, &to]) {
        return Err(Broken::Apart);
    }
    let posed = &from.proof.posed;
    let value = Condition::Value(Decimal::of(from.near.parameter));
    let steps = |near| OrbitSystem::new(posed, near, &value).map(|(system, _)| system.steps);
    let both = [from.near, to.near].map(|near| steps(near).map_err(|_| Broken::End));
    let [one, other] = both;
    let least: Vec<usize> = one?
        .into_iter()
        .zip(other?)
        .map(|(a, b)| a.max(b))
        .collect();
    let cut = |near, condition| OrbitSystem::cut(posed, near, condition, &least);
    let (system, guess) = cut(from.near, &value).map_err(|_| Broken::End)?;
    let (first, opens) = from.joint(&system)?;
    let (last, closes) = to.joint(&system)?;
    let folds = [from, to].map(|place| {
        let is_fold = *place.condition == Condition::Fold;
        is_fold.then(|| cut(place.near, place.condition).ok())?
    });
    let way = match (opens.first(), from.condition) {
        (Some(stretch), _) => Way::Grows(system.duration(*stretch)),
        (None, Condition::Fold) => Way::Fold(None),
        // a margin may grow either way
        (None, Condition::Margin { .. }) => Way::Fold(Some(system.parameter())),
        _ => Way::Parameter,
    };
    let arc = Arc {
        units: system.units(&guess),
        closed: [opens, closes],
        system,
        folds,
    };
    arc::prove(&arc, [&first, &last], way)
}

impl Curve for Arc<'_> {
    type Unproven = Unproven;
    type Beyond = NotBeyond;

    fn units(&self) -> &[f64] {
        &self.units
    }

    fn parameter(&self) -> usize {
        self.system.parameter()
    }

    fn coordinates(&self) -> Vec<usize> {
        let width = self.system.width();
        let of = |stretch: usize| {
            let entry = self.system.node(stretch, 0);
            (entry..entry + width).chain([self.system.duration(stretch)])
        };
        let stretches = 0..self.system.stretches.len();
        stretches.flat_map(of).chain([self.parameter()]).collect()
    }

    fn equations(&self, x: &[Interval]) -> Option<Evaluated> {
        self.system.evaluate(x)
    }

    fn hold(&self, x: &[Moving], next_to: Option<usize>) -> Result<(), Unproven> {
        let hull: Vec<Interval> = x.iter().map(|x| x.value).collect();
        // that the numbers of the system are not finite over so much of the parameter is seen at its first zone
        let unknown = |_| Unproven::Duration(0);
        let modes = self
            .system
            .enclosed(hull[self.parameter()])
            .map_err(unknown)?;
        let passings = self.system.passings(&modes, &hull);
        let closed = next_to.map_or(&[][..], |end| &self.closed[end]);
        let held = self.system.inequalities(&modes, &passings, x, closed);
        held.map(|_| ())
    }

    fn is_only_fold(&self, end: usize, x: &[Interval], tangent: &[Interval]) -> bool {
        let Some((system, guess)) = &self.folds[end] else {
            return false;
        };
        let Some(critical) = &system.critical else {
            return false;
        };
        if system.steps != self.system.steps {
            return false;
        }
        let mut x = x.to_vec();
        let v = &tangent[..self.parameter()];
        x.extend(arc::direction(&critical.normals[0], v));
        let equations = |x: &[Interval]| system.evaluate(x);
        krawczyk::is_only_zero(&equations, guess, &x)
    }
}
