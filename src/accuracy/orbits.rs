//! Orbits of a system by the exact flow and by Taylor series, and single ones by a Runge–Kutta method.

use std::time::Instant;

use differential_equations::traits::State;
use nalgebra::Complex;

use super::measure::{
    MeasuredBranch, MeasuredFamily, Missed, Repeats, eigenvalue_error, in_time, timed, with_stops,
    worst,
};
use super::rung::{Rung, RungRow, ladder_of_system};
use crate::affine::mode::AffineSystem;
use crate::affine::orbit::row::SavedOrbit;
use crate::affine::orbit::start;
use crate::hybrid::{EarlierPoint, NoFirstPoint, OrbitRunner};
use crate::linalg::Vector;
use crate::problem::{Continuation, SystemProblem};
use crate::tube::flow::Unsolved;
use crate::tube::flow::numeric::shooting::{ShootingSteps, integrate};

/// A branch of orbits.
pub(crate) struct OrbitBranch {
    problem: SystemProblem,
    continuation: Continuation<String>,
    /// The orbit of an earlier run that it begins with.
    named: Option<EarlierPoint>,
    /// Index of its parameter.
    parameter: usize,
    /// Whether every mode has an exact flow.
    exact: bool,
}

/// An orbit at a value of the parameter that every method meets exactly.
pub(crate) struct ComparedOrbit {
    orbit: SavedOrbit,
    /// The largest absolute value of every state over the orbit, or 1 where that is 0.
    units: Vec<f64>,
    multipliers: Vec<Complex<f64>>,
}

/// The tolerance of the reference: each step leaves out less than rounding.
const FINEST: f64 = 1e-16;

impl OrbitBranch {
    /// The problem as every method follows it; `None` where its parameter or values make no sense.
    pub(crate) fn new(
        problem: &SystemProblem,
        continuation: &Continuation<String>,
        named: Option<&EarlierPoint>,
    ) -> Option<OrbitBranch> {
        let mut problem = problem.clone();
        problem.output = Default::default();
        problem.expect.clear();
        let system = problem.system.at(&problem.values(), &[]).ok()?;
        Some(OrbitBranch {
            parameter: problem.parameter()?,
            exact: system.modes.are_exact(),
            continuation: with_stops(continuation),
            named: named.cloned(),
            problem,
        })
    }
}

impl MeasuredFamily for OrbitBranch {
    type Compared = ComparedOrbit;

    fn ladder(&self) -> Vec<Rung> {
        ladder_of_system(self.exact)
    }

    fn reference(&self) -> Rung {
        Rung::Taylor { tolerance: FINEST }
    }

    fn remark(&self) -> &'static str {
        "Errors are against integration by Taylor series with a tolerance below rounding, those of the Runge–Kutta \
         method of single orbits, whose time is given. Switches: states there, in their largest values, and durations, \
         in periods. Eigenvalues: multipliers."
    }

    fn follow(
        &self,
        rung: Rung,
        until: Option<Instant>,
    ) -> Result<MeasuredBranch<ComparedOrbit>, Missed> {
        let mut problem = self.problem.clone();
        if let Rung::Taylor { tolerance } = rung {
            problem.system = problem.system.integrated(tolerance);
        }
        let branch = OrbitRunner::begin(&problem, &self.continuation, self.named.as_ref())?;
        MeasuredBranch::collect(
            branch,
            until,
            |item| {
                let value = item.point.parameters.get(self.parameter).copied();
                item.point.kind.zip(value)
            },
            |item| {
                let unit = |(low, high): &(f64, f64)| match low.abs().max(high.abs()) {
                    0.0 => 1.0,
                    size => size,
                };
                let multipliers = item.point.multipliers.iter();
                Some(ComparedOrbit {
                    orbit: item.saved.as_ref()?.orbit.clone(),
                    units: item.point.extremes.iter().map(unit).collect(),
                    multipliers: multipliers.map(|one| one.value).collect(),
                })
            },
        )
    }

    fn row(
        &self,
        rung: Rung,
        reference: &MeasuredBranch<ComparedOrbit>,
        repeats: Repeats,
    ) -> Result<RungRow, Missed> {
        if let Rung::RungeKutta { tolerance } = rung {
            return self.integrated(rung, tolerance, reference, repeats);
        }
        let (seconds, found) = timed(repeats, || self.follow(rung, repeats.until))?;
        let mut row = found.row(rung, reference, seconds);
        let pairs = || {
            let pairs = reference.compared.iter().zip(&found.compared);
            pairs.filter(|(one, other)| one.orbit.sequence == other.orbit.sequence)
        };
        row.switch_error = worst(pairs().flat_map(|(one, other)| {
            let period: f64 = one.orbit.zones.iter().map(|zone| zone.duration).sum();
            let zones = one.orbit.zones.iter().zip(&other.orbit.zones);
            zones.map(move |(here, there)| {
                let late = (here.duration - there.duration).abs() / period;
                one.off(&here.state, &there.state).max(late)
            })
        }));
        row.eigenvalue_error = worst(pairs().filter_map(|(one, other)| {
            let list = |one: &ComparedOrbit| [one.multipliers.clone()];
            eigenvalue_error(&list(one), &list(other))
        }));
        Ok(row)
    }
}

impl OrbitBranch {
    /// Single orbits of the reference, each zone by a Runge–Kutta method from its entry: where the next one begins.
    fn integrated(
        &self,
        rung: Rung,
        tolerance: f64,
        reference: &MeasuredBranch<ComparedOrbit>,
        repeats: Repeats,
    ) -> Result<RungRow, Missed> {
        let systems = reference.compared.iter().map(|compared| {
            let system = self.problem.system.at(&compared.orbit.values, &[]);
            system.map_err(|error| NoFirstPoint::from(start::NoStart::System(error)))
        });
        let systems = systems.collect::<Result<Vec<_>, NoFirstPoint>>()?;
        let work = || {
            let mut errors = Vec::new();
            for (compared, system) in reference.compared.iter().zip(&systems) {
                in_time(repeats.until)?;
                errors.push(compared.closure(system, tolerance)?);
            }
            Ok(worst(errors.into_iter()))
        };
        let (seconds, error) = timed(repeats, work)?;
        Ok(RungRow {
            points: reference.compared.len(),
            switch_error: error,
            ..RungRow::failed(rung, 0, None)
        }
        .took(seconds))
    }
}

impl ComparedOrbit {
    /// The largest difference of two states, each in its unit.
    fn off(&self, one: &[f64], other: &[f64]) -> f64 {
        let pairs = one.iter().zip(other).zip(&self.units);
        let off = pairs.map(|((one, other), unit)| (one - other).abs() / unit);
        off.fold(0.0, f64::max)
    }

    /// How far the end of each zone, integrated from its beginning and reset, is from the beginning of the next.
    fn closure(&self, system: &AffineSystem, tolerance: f64) -> Result<f64, Unsolved> {
        /// As a part of the zone.
        const LONGEST: f64 = 0.1;
        let steps = ShootingSteps {
            tolerance,
            longest: LONGEST,
        };
        let zones = &self.orbit.zones;
        let omega = system.omega.value;
        let mut most = 0.0_f64;
        for (index, (zone, begin)) in self.orbit.sequence.0.iter().zip(zones).enumerate() {
            let mode = &system.modes[zone.mode];
            let lifted = |state: &[f64], part: f64| {
                let phase = begin.phase + omega * begin.duration * part;
                system.lift(zone.mode, state, phase)
            };
            let physical = |scaled: &States| -> Vec<f64> {
                let pairs = scaled.0.iter().zip(&self.units);
                pairs.map(|(x, unit)| x * unit).collect()
            };
            let scaled = begin
                .state
                .iter()
                .zip(&self.units)
                .map(|(x, unit)| x / unit);
            let rate = |part: f64, x: &States, by: &mut States| {
                let rates = &mode.matrix.at * lifted(&physical(x), part);
                for ((by, rate), unit) in by.0.iter_mut().zip(&rates).zip(&self.units) {
                    *by = rate * begin.duration / unit;
                }
            };
            let end = physical(&integrate(rate, States(scaled.collect()), steps)?);
            let exit = zone.way.map(|way| &mode.guards[way.guard].exits[way.exit]);
            let after: Vector = match exit {
                Some(exit) => &exit.reset.at * lifted(&end, 1.0),
                None => Vector::from_vec(end),
            };
            let next = &zones[(index + 1) % zones.len()];
            most = most.max(self.off(after.as_slice(), &next.state));
        }
        Ok(most)
    }
}

/// States of a system, as many as it has.
#[derive(Clone, Debug)]
struct States(Vec<f64>);

impl State<f64> for States {
    fn len(&self) -> usize {
        self.0.len()
    }

    fn get_component(&self, index: usize) -> f64 {
        self.0[index]
    }

    fn set_component(&mut self, index: usize, value: f64) {
        self.0[index] = value;
    }

    fn map_components_mut<F: FnMut(usize, &mut f64)>(&mut self, mut f: F) {
        let all = self.0.iter_mut().enumerate();
        all.for_each(|(index, x)| f(index, x));
    }

    fn zeros_like(&self) -> States {
        States(vec![0.0; self.0.len()])
    }

    fn zeros() -> States {
        States(Vec::new())
    }

    fn mul_add_assign(&mut self, alpha: f64, other: &States) {
        self.add_scaled(alpha, other);
    }

    fn scale_mut(&mut self, alpha: f64) {
        self.scale_by(alpha);
    }
}
