//! Arcs of orbits, between two special points of a branch.

use super::beyond::{self, SequenceOrbit};
use super::open::{OrbitNotBeyond, UnprovenOrbit};
use super::system::{NearOrbit, OrbitCondition, OrbitSystem, PosedOrbit};
use super::{OrbitProof, Sequence};
use crate::certify::arc::{self, ArcDirection, ArcEquations, Broken, Joint, Moving};
use crate::certify::equations::Evaluated;
use crate::certify::krawczyk::{self, LinearEquations};
use crate::interval::{Decimal, Interval};

/// Why an arc of orbits is not proven.
pub type Undecided = Broken<UnprovenOrbit, OrbitNotBeyond>;

/// An end of an arc.
struct OrbitArcEnd {
    joint: Joint,
    /// Stretches that have no duration there.
    closed: Vec<usize>,
    /// Whether the parameter is stationary along the arc.
    is_fold: bool,
}

struct OrbitArc<'a> {
    system: OrbitSystem<'a>,
    units: Vec<f64>,
    ends: [OrbitArcEnd; 2],
}

/// A point in the sequence of an arc.
#[derive(Clone, Copy)]
struct OrbitArcPoint<'a> {
    proof: &'a OrbitProof,
    near: &'a NearOrbit,
    condition: &'a OrbitCondition,
    /// The point in this sequence, where it is proven in another.
    seen: Option<&'a SequenceOrbit>,
}

impl<'a> OrbitArcPoint<'a> {
    /// A point, at a change of the sequence in that before or in that beyond; `None` where it is not known.
    fn new(proof: &'a OrbitProof, beyond: bool) -> Option<OrbitArcPoint<'a>> {
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
            Some(SequenceOrbit { near, condition }) => (near, condition),
            None => (&proof.near, &proof.condition),
        };
        Some(OrbitArcPoint {
            proof,
            near,
            condition,
            seen,
        })
    }

    /// The point in the unknowns of an arc.
    fn ending(&self, arc: &OrbitSystem) -> Result<OrbitArcEnd, Undecided> {
        let closed = match self.seen {
            Some(seen) => beyond::prove(self.proof, seen).map_err(Broken::Beyond)?,
            None => beyond::closed(self.proof).ok_or(Broken::End)?,
        };
        let found = || {
            let (system, middle) =
                OrbitSystem::new(&self.proof.posed, self.near, self.condition).ok()?;
            let equations = |x: &[Interval]| system.evaluate(x);
            let zero = krawczyk::enclosed(&equations, &middle, &system.units(&middle))?;
            let mut opens = system.closed.iter();
            Some(OrbitArcEnd {
                joint: system.carried(&zero.at, arc).map(Joint::new)?,
                is_fold: *self.condition == OrbitCondition::Fold
                    || opens.any(|index| system.is_stationary(*index)),
                closed: closed.clone(),
            })
        };
        found().ok_or(Broken::End)
    }
}

/// Whether two points are of one system and one sequence.
fn are_alike([one, other]: [&OrbitArcPoint; 2]) -> bool {
    let but = |posed: &PosedOrbit| {
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
pub fn prove(from: &OrbitProof, to: &OrbitProof) -> Result<(), Undecided> {
    let places = OrbitArcPoint::new(from, true).zip(OrbitArcPoint::new(to, false));
    let (from, to) = places.ok_or(Broken::Apart)?;
    if !are_alike([&from, &to]) {
        return Err(Broken::Apart);
    }
    let posed = &from.proof.posed;
    let value = OrbitCondition::Value(Decimal::of(from.near.parameter));
    let layout = |near| OrbitSystem::new(posed, near, &value).map(|(system, _)| system.layout());
    let both = [from.near, to.near].map(|near| layout(near).map_err(|_| Broken::End));
    let [one, other] = both;
    let layout = one?.joined(other?);
    let laid_out = OrbitSystem::laid_out(posed, from.near, &value, &layout);
    let (system, guess) = laid_out.map_err(|_| Broken::End)?;
    let (first, last) = (from.ending(&system)?, to.ending(&system)?);
    let way = match (first.closed.first(), from.condition) {
        (Some(stretch), _) => ArcDirection::Grows(system.duration(*stretch)),
        (None, OrbitCondition::Fold) => ArcDirection::Fold(None),
        // a margin may grow either way
        (None, OrbitCondition::Margin { .. }) => ArcDirection::Fold(Some(system.parameter())),
        _ => ArcDirection::Parameter,
    };
    let arc = OrbitArc {
        units: system.units(&guess),
        ends: [first, last],
        system,
    };
    arc::prove(&arc, arc.ends.each_ref().map(|end| &end.joint), way)
}

impl OrbitArc<'_> {
    /// Whether the parameter is stationary at one point of a piece at most. With v from Fₓv + bβ = 0, v_κ = 1 and a constant b, it is
    /// so where β = 0; and β′, from Fₓv′ + bβ′ = −∂(Fₓ)v, v′_κ = 0, is not zero.
    fn turns_once(&self, coordinate: usize, x: &[Interval], tangent: &[Interval]) -> Option<bool> {
        let parameter = self.system.parameter();
        let mut matrix = self.system.evaluate(x)?.jacobian;
        for row in &mut matrix {
            row[parameter] = Interval::point(row[parameter].middle());
        }
        matrix[parameter].fill(Interval::ZERO);
        matrix[parameter][coordinate] = Interval::ONE;
        let linear = LinearEquations::new(&matrix)?;
        let mut side = vec![Interval::ZERO; x.len()];
        side[parameter] = Interval::ONE;
        let mut v = linear.solve(&side)?;
        v[parameter] = Interval::ZERO;
        let numbers = x.iter().zip(&v);
        let numbers: Vec<Moving> = numbers
            .map(|(value, by)| Moving {
                value: *value,
                by: [*by],
            })
            .collect();
        side.fill(Interval::ZERO);
        for (row, column, entry) in self.system.terms(&numbers).ok()?.entries {
            if row < parameter {
                side[row] = side[row] - entry.by[0] * tangent[column];
            }
        }
        Some(!linear.solve(&side)?[parameter].contains(0.0))
    }
}

impl ArcEquations for OrbitArc<'_> {
    type Unproven = UnprovenOrbit;
    type Beyond = OrbitNotBeyond;

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

    fn hold(&self, x: &[Moving], next_to: Option<usize>) -> Result<(), UnprovenOrbit> {
        let hull: Vec<Interval> = x.iter().map(|x| x.value).collect();
        // that the numbers of the system are not finite over so much of the parameter is seen at its first zone
        let unknown = |_| UnprovenOrbit::Duration(0);
        let modes = self
            .system
            .enclosed(hull[self.parameter()])
            .map_err(unknown)?;
        let passings = self.system.passings(&modes, &hull);
        let closed = next_to.map_or(&[][..], |end| &self.ends[end].closed);
        let held = self.system.inequalities(&modes, &passings, x, closed);
        held.map(|_| ())
    }

    fn is_only_fold(
        &self,
        end: usize,
        coordinate: usize,
        x: &[Interval],
        tangent: &[Interval],
    ) -> bool {
        let once = || self.turns_once(coordinate, x, tangent);
        self.ends[end].is_fold && coordinate != self.parameter() && once().unwrap_or(false)
    }
}
