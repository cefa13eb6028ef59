//! Arcs of orbits, between two special points of a branch.

use super::open::Unproven;
use super::system::{Condition, OrbitSystem, Posed};
use super::{Open, Proof};
use crate::certify::arc::{self, Broken, Curve, Joint, Moving, Way};
use crate::certify::equations::Evaluated;
use crate::certify::krawczyk;
use crate::interval::{Decimal, Interval};

/// Why an arc of orbits is not proven.
pub type Undecided = Broken<Unproven, Open>;

struct Arc<'a> {
    system: OrbitSystem<'a>,
    units: Vec<f64>,
    /// The equations of a fold at an end, and their zero in doubles.
    folds: [Option<(OrbitSystem<'a>, Vec<f64>)>; 2],
}

/// Whether two points are of one system and one sequence.
fn are_alike(one: &Proof, other: &Proof) -> bool {
    let but = |posed: &Posed| {
        let values = posed.values.iter().cloned().enumerate();
        let values = values.filter(|(index, _)| *index != posed.parameter);
        values.collect::<Vec<(usize, Decimal)>>()
    };
    let [a, b] = [&one.posed, &other.posed];
    a.system == b.system
        && a.parameter == b.parameter
        && a.periods == b.periods
        && but(a) == but(b)
        && one.near.sequence == other.near.sequence
}

/// Proves that between two points of a branch the orbits are one curve of one sequence without a fold; returns the number
/// of pieces.
///
/// # Errors
/// It is not proven.
pub fn prove(from: &Proof, to: &Proof) -> Result<usize, Undecided> {
    if !are_alike(from, to) {
        return Err(Broken::Apart);
    }
    let value = Condition::Value(Decimal::of(from.near.parameter));
    let steps = |near| OrbitSystem::new(&from.posed, near, &value).map(|(system, _)| system.steps);
    let both = [&from.near, &to.near].map(|near| steps(near).map_err(|_| Broken::End));
    let [one, other] = both;
    let least: Vec<usize> = one?
        .into_iter()
        .zip(other?)
        .map(|(a, b)| a.max(b))
        .collect();
    let cut = |condition| OrbitSystem::cut(&from.posed, &from.near, condition, &least);
    let (system, guess) = cut(&value).map_err(|_| Broken::End)?;
    let ends = [from, to].map(|proof| end(proof, &system).ok_or(Broken::End));
    let [first, last] = ends;
    let folds = [from, to].map(|proof| {
        let cut = || OrbitSystem::cut(&proof.posed, &proof.near, &proof.condition, &least);
        (proof.condition == Condition::Fold).then(cut)?.ok()
    });
    let way = match from.condition {
        Condition::Fold => Way::Fold(None),
        _ => Way::Parameter,
    };
    let arc = Arc {
        units: system.units(&guess),
        system,
        folds,
    };
    arc::prove(&arc, [&first?, &last?], way)
}

/// A point in the unknowns of an arc.
fn end(proof: &Proof, arc: &OrbitSystem) -> Option<Joint> {
    let Proof {
        posed,
        near,
        condition,
        ..
    } = proof;
    let (system, middle) = OrbitSystem::new(posed, near, condition).ok()?;
    let equations = |x: &[Interval]| system.evaluate(x);
    let zero = krawczyk::enclosed(&equations, &middle, &system.units(&middle))?;
    system.carried(&zero.at, arc).map(Joint::new)
}

impl Curve for Arc<'_> {
    type Unproven = Unproven;
    type Beyond = Open;

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

    fn hold(&self, x: &[Moving], _: Option<usize>) -> Result<(), Unproven> {
        let hull: Vec<Interval> = x.iter().map(|x| x.value).collect();
        // that the numbers of the system are not finite over so much of the parameter is seen at its first zone
        let unknown = |_| Unproven::Duration(0);
        let modes = self
            .system
            .enclosed(hull[self.parameter()])
            .map_err(unknown)?;
        let passings = self.system.passings(&modes, &hull);
        self.system.inequalities(&modes, &passings, x).map(|_| ())
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
