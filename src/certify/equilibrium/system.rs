//! The equations of an equilibrium at an event: as many as unknowns, so that a regular zero is isolated.
//!
//! In a mode of the file E(y, p) are its rates, y = x. In a sliding mode on h = 0 y = (x, λ), and E has the n rates
//! (1 − λ)F₋ + λF₊ and h: Filippov's combination rests. With contacts y = (x, q), and E has the n rates and an equation for every
//! force ([`super::field`]). λ and q are not differentiated in time: with M = diag(1, …, 1, 0, …, 0) the linearisation is Mẏ = E_y y,
//! whose eigenvalues are those within the surfaces, where these unknowns are functions of the states.
//!
//! | point | unknowns | equations |
//! |---|---|---|
//! | value | y, p | E = 0, p as it is written |
//! | boundary equilibrium | y, p | E = 0, a guard is zero |
//! | fold | y, p, v | E = 0, E_y v = 0, ℓ·v = 1 |
//! | Hopf point | y, p, a, b, ω | E = 0, E_y a + ωMb = 0, E_y b − ωMa = 0, ℓ·a = 1, ℓ·b = 0 |
//!
//! ℓ is made of what v or a is near the point. A zero of the third system is regular exactly where the null vector is the only one,
//! the parameter enters, and the fold is quadratic (G. Moore, A. Spence, SIAM J. Numer. Anal. 17, 1980); one of the last
//! where iω is a simple eigenvalue and its real part changes along the branch with a speed that is not zero
//! (A. Griewank, G. Reddien, IMA J. Numer. Anal. 3, 1983).

use nalgebra::{Complex, DMatrix};
use serde::{Deserialize, Serialize};

use super::guard::{ProvenGuard, guards};
use super::place::NameValues;
use super::resting::{ForceEquation, Resting};
use super::{OpenEquilibrium, Rows};
use crate::affine::system::System;
use crate::certify::analytic::Analytic;
use crate::certify::equations::Evaluated;
use crate::interval::{Decimal, Gradient, Interval, Number, PI};
use crate::linalg::{self, Matrix};

/// What is asked.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PosedEquilibrium {
    /// The system as it is written; of the values of its parameters those below count. In a certificate it stands once, for all
    /// points.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub system: Option<System>,
    /// Values of the parameters in order, as they are written.
    pub values: Vec<Decimal>,
    /// Index of the continuation parameter.
    pub parameter: usize,
    /// Units in which uniqueness is measured: of the states, of the forces of contacts, and of the parameter.
    pub units: Vec<f64>,
}

impl PosedEquilibrium {
    /// The system.
    ///
    /// # Errors
    /// There is none.
    pub fn system(&self) -> Result<&System, OpenEquilibrium> {
        self.system.as_ref().ok_or(OpenEquilibrium::System)
    }

    /// Name of the continuation parameter.
    pub fn name(&self) -> Option<&str> {
        let names = self.system.as_ref()?.source.parameters.names();
        names.into_iter().nth(self.parameter)
    }
}

/// An equilibrium in doubles.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NearEquilibrium {
    /// Name of its mode.
    pub mode: String,
    /// The states.
    pub state: Vec<f64>,
    /// The continuation parameter.
    pub parameter: f64,
}

/// What singles out a point.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum EquilibriumCondition {
    /// The parameter has this value.
    Value(Decimal),
    /// The parameter is stationary.
    Fold,
    /// A pair of eigenvalues is imaginary.
    Hopf {
        /// Its imaginary part in doubles.
        omega: f64,
    },
    /// A guard is zero.
    Boundary {
        /// Which of the mode.
        guard: usize,
    },
}

/// Derivatives in so many unknowns are computed at a time.
const SEEDS: usize = 4;

/// Intervals with derivatives in unknowns.
pub type Seeded = Gradient<Interval, SEEDS>;

/// The equations of a point.
pub struct EquilibriumSystem<'a> {
    pub posed: &'a PosedEquilibrium,
    pub system: &'a System,
    pub near: &'a NearEquilibrium,
    pub condition: &'a EquilibriumCondition,
    pub resting: Resting,
    /// What is positive at an equilibrium of the mode.
    pub guards: Vec<ProvenGuard>,
    /// What the unknowns beside the states follow from.
    pub constraints: Vec<ForceEquation>,
    /// Length of y.
    pub size: usize,
    /// ℓ.
    normal: Vec<f64>,
}

impl<'a> EquilibriumSystem<'a> {
    /// The equations, and their unknowns in doubles.
    pub fn new(
        posed: &'a PosedEquilibrium,
        near: &'a NearEquilibrium,
        condition: &'a EquilibriumCondition,
    ) -> Result<(EquilibriumSystem<'a>, Vec<f64>), OpenEquilibrium> {
        let system = posed.system()?;
        let states = system.source.states.len();
        let usable = |unit: &f64| unit.is_finite() && *unit > 0.0;
        let fits = system.forcing.is_none()
            && near.state.len() == states
            && near.state.iter().all(|x| x.is_finite())
            && near.parameter.is_finite()
            && posed.values.len() == system.source.parameters.0.len()
            && posed.parameter < posed.values.len()
            && posed.units.len() == states + system.contacts.len() + 1
            && posed.units.iter().all(usable);
        if !fits {
            return Err(OpenEquilibrium::System);
        }
        let resting = Resting::new(system, &near.mode)?;
        let constraints = resting.constraints(system);
        let mut equations = EquilibriumSystem {
            guards: guards(system, &resting),
            size: states + constraints.len(),
            constraints,
            posed,
            system,
            near,
            condition,
            resting,
            normal: Vec::new(),
        };
        match condition {
            EquilibriumCondition::Boundary { guard } if *guard >= equations.guards.len() => {
                return Err(OpenEquilibrium::System);
            }
            EquilibriumCondition::Hopf { omega } if !(omega.is_finite() && *omega > 0.0) => {
                return Err(OpenEquilibrium::Frequency);
            }
            _ => {}
        }
        let mut guess = near.state.clone();
        guess.extend(equations.forces().ok_or(OpenEquilibrium::NotEnclosed)?);
        guess.push(near.parameter);
        let critical = equations
            .critical(&guess)
            .ok_or(OpenEquilibrium::NotEnclosed)?;
        guess.extend(critical);
        Ok((equations, guess))
    }

    /// Where the parameter stands among the unknowns.
    pub fn parameter(&self) -> usize {
        self.size
    }

    /// Number of states.
    pub fn states(&self) -> usize {
        self.near.state.len()
    }

    /// Names, where y and the parameter are these.
    pub fn place<N: Analytic, const D: usize>(
        &self,
        y: &[Gradient<N, D>],
        parameter: Gradient<N, D>,
    ) -> NameValues<'a, Gradient<N, D>> {
        let values = self.posed.values.iter().enumerate();
        let values = values.map(|(index, value)| match index == self.posed.parameter {
            true => parameter,
            false => Gradient::constant(value.interval()),
        });
        let pi = Gradient::constant(PI);
        let (states, forces) = y.split_at(self.states());
        let names = [states.to_vec(), forces.to_vec(), values.collect()];
        NameValues::new(self.system, names, pi)
    }

    /// Values of functions and their derivatives in the unknowns, over intervals of these.
    pub fn differentiated(
        &self,
        x: &[Interval],
        functions: impl Fn(&[Gradient<Interval, SEEDS>]) -> Option<Vec<Seeded>>,
    ) -> Option<Evaluated> {
        let mut found: Option<Evaluated> = None;
        for first in (0..x.len()).step_by(SEEDS) {
            let seeded = |(index, value): (usize, &Interval)| match index.checked_sub(first) {
                Some(seed) if seed < SEEDS => Seeded::variable(*value, seed),
                _ => Seeded::constant(*value),
            };
            let unknowns: Vec<Seeded> = x.iter().enumerate().map(seeded).collect();
            let values = functions(&unknowns)?;
            let evaluated = found.get_or_insert_with(|| Evaluated {
                residual: values.iter().map(|value| value.value).collect(),
                jacobian: vec![vec![Interval::ZERO; x.len()]; values.len()],
            });
            for (row, value) in evaluated.jacobian.iter_mut().zip(&values) {
                let entries = row.iter_mut().skip(first);
                entries.zip(value.by).for_each(|(entry, by)| *entry = by);
            }
        }
        found
    }

    /// The derivatives of E in y and p.
    pub fn slopes(&self, x: &[Interval]) -> Option<Rows> {
        let base = &x[..=self.size];
        let rest = |x: &[Seeded]| self.rest(&plain(&x[..self.size]), plain_one(x[self.size]));
        let values = |x: &[Seeded]| Some(rest(x)?.into_iter().map(|value| value.value).collect());
        Some(self.differentiated(base, values)?.jacobian)
    }

    /// The derivatives of E in y.
    pub fn matrix(&self, x: &[Interval]) -> Option<Rows> {
        let mut slopes = self.slopes(x)?;
        slopes.iter_mut().for_each(|row| row.truncate(self.size));
        Some(slopes)
    }

    /// Units of y.
    fn units_of_y(&self) -> Vec<f64> {
        let (_, units) = self.posed.units.split_last().unwrap_or((&1.0, &[]));
        // λ is a share
        let shares = std::iter::repeat(1.0);
        units
            .iter()
            .copied()
            .chain(shares)
            .take(self.size)
            .collect()
    }

    /// Whether an equation has the rate of a state: M.
    pub fn is_rate(&self, row: usize) -> bool {
        row < self.states()
    }

    /// What follows the parameter among the unknowns, in doubles, with ℓ.
    fn critical(&mut self, guess: &[f64]) -> Option<Vec<f64>> {
        let omega = match self.condition {
            EquilibriumCondition::Value(_) | EquilibriumCondition::Boundary { .. } => {
                return Some(Vec::new());
            }
            EquilibriumCondition::Fold => 0.0,
            EquilibriumCondition::Hopf { omega } => *omega,
        };
        let points: Vec<Interval> = guess.iter().map(|x| Interval::point(*x)).collect();
        let matrix = self.matrix(&points)?;
        let units = self.units_of_y();
        let size = |row: usize| {
            let entries = matrix[row].iter().zip(&units);
            let largest = entries.fold(0.0, |most: f64, (x, unit)| most.max(x.magnitude() * unit));
            if largest.is_normal() { largest } else { 1.0 }
        };
        let sizes: Vec<f64> = (0..self.size).map(size).collect();
        let entry = |i: usize, j: usize| matrix[i][j].middle() * units[j] / sizes[i];
        let scaled = Matrix::from_fn(self.size, self.size, entry);
        let turns = |i: usize, j: usize| match i == j && self.is_rate(i) {
            true => omega * units[j] / sizes[i],
            false => 0.0,
        };
        let vector: Vec<Complex<f64>> = match self.condition {
            EquilibriumCondition::Fold => {
                let right = linalg::least(&scaled)?.right;
                right.iter().map(|x| Complex::from(*x)).collect()
            }
            _ => {
                let shifted = DMatrix::from_fn(self.size, self.size, |i, j| {
                    Complex::new(scaled[(i, j)], -turns(i, j))
                });
                let found = linalg::least_vector(&shifted)?;
                // q·q becomes real and positive: its parts are orthogonal, the first is the longer one
                let square: Complex<f64> = found.iter().map(|q| q * q).sum();
                let turn = Complex::from_polar(1.0, -0.5 * square.arg());
                found.iter().map(|q| q * turn).collect()
            }
        };
        let length = vector.iter().map(|q| q.re * q.re).sum::<f64>().sqrt();
        let part = |of: fn(&Complex<f64>) -> f64| {
            let scaled = vector.iter().map(of).zip(&units);
            scaled
                .map(|(x, unit)| x * unit / length)
                .collect::<Vec<f64>>()
        };
        let longer = vector.iter().zip(&units);
        self.normal = longer.map(|(q, unit)| q.re / (length * unit)).collect();
        let mut found = part(|q| q.re);
        if let EquilibriumCondition::Hopf { .. } = self.condition {
            found.extend(part(|q| q.im));
            found.push(omega);
        }
        found.iter().all(|x| x.is_finite()).then_some(found)
    }

    /// Units of the unknowns in which uniqueness is measured.
    pub fn units(&self, guess: &[f64]) -> Vec<f64> {
        let own = self.units_of_y();
        let mut units = own.clone();
        units.extend(self.posed.units.last());
        let vectors = match self.condition {
            EquilibriumCondition::Value(_) | EquilibriumCondition::Boundary { .. } => 0,
            EquilibriumCondition::Fold => 1,
            EquilibriumCondition::Hopf { .. } => 2,
        };
        (0..vectors).for_each(|_| units.extend(&own));
        if let EquilibriumCondition::Hopf { .. } = self.condition {
            units.extend(guess.last().map(|omega| omega.abs()));
        }
        units
    }

    /// A critical vector among the unknowns: the first, or the second.
    pub fn vector<'b, N>(&self, x: &'b [N], which: usize) -> &'b [N] {
        let from = self.size + 1 + which * self.size;
        &x[from..from + self.size]
    }

    /// The residual of all equations.
    fn residual(&self, x: &[Seeded]) -> Option<Vec<Seeded>> {
        let (size, p) = (self.size, x[self.size]);
        let still = |y: &[Seeded]| plain(y);
        let sum = |v: &[Seeded]| {
            let terms = self.normal.iter().zip(v);
            terms.fold(Seeded::double(0.0), |sum, (l, v)| {
                sum + v.scaled(Interval::point(*l))
            })
        };
        let parts = match self.condition {
            EquilibriumCondition::Value(_) | EquilibriumCondition::Boundary { .. } => {
                let y = still(&x[..size]);
                let mut rows: Vec<Seeded> = self
                    .rest(&y, plain_one(p))?
                    .into_iter()
                    .map(|value| value.value)
                    .collect();
                rows.push(match self.condition {
                    EquilibriumCondition::Boundary { guard } => {
                        self.guard(&self.guards[*guard], &y, plain_one(p))?.value
                    }
                    EquilibriumCondition::Value(value) => p - Seeded::constant(value.interval()),
                    _ => return None,
                });
                return Some(rows);
            }
            EquilibriumCondition::Fold => 1,
            EquilibriumCondition::Hopf { .. } => 2,
        };
        // one evaluation has E, E_y a and E_y b
        let zero = Seeded::double(0.0);
        let moved: Vec<Gradient<Seeded, 2>> = (0..size)
            .map(|index| Gradient {
                value: x[index],
                by: std::array::from_fn(|which| match which < parts {
                    true => self.vector(x, which)[index],
                    false => zero,
                }),
            })
            .collect();
        let values = self.rest(
            &moved,
            Gradient {
                value: p,
                by: [zero; 2],
            },
        )?;
        let mut rows: Vec<Seeded> = values.iter().map(|value| value.value).collect();
        match self.condition {
            EquilibriumCondition::Hopf { .. } => {
                let omega = *x.last()?;
                let [a, b] = [0, 1].map(|which| self.vector(x, which));
                let turned = |row: usize, v: &[Seeded]| match self.is_rate(row) {
                    true => omega * v[row],
                    false => zero,
                };
                let each = || values.iter().enumerate();
                rows.extend(each().map(|(row, value)| value.by[0] + turned(row, b)));
                rows.extend(each().map(|(row, value)| value.by[1] - turned(row, a)));
                rows.extend([sum(a) - Seeded::double(1.0), sum(b)]);
            }
            _ => {
                rows.extend(values.iter().map(|value| value.by[0]));
                rows.push(sum(self.vector(x, 0)) - Seeded::double(1.0));
            }
        }
        Some(rows)
    }

    /// Residual and derivatives over intervals of the unknowns.
    pub fn evaluate(&self, x: &[Interval]) -> Option<Evaluated> {
        self.differentiated(x, |x| self.residual(x))
    }

    /// The equilibrium and what singles it out, in doubles.
    pub fn refined(&self, x: &[f64]) -> (NearEquilibrium, EquilibriumCondition) {
        let near = NearEquilibrium {
            mode: self.near.mode.clone(),
            state: x[..self.states()].to_vec(),
            parameter: x[self.parameter()],
        };
        let condition = match (self.condition, x.last()) {
            (EquilibriumCondition::Hopf { .. }, Some(omega)) => {
                EquilibriumCondition::Hopf { omega: *omega }
            }
            (condition, _) => condition.clone(),
        };
        (near, condition)
    }
}

/// Numbers without a direction of their own.
pub fn plain<N: Analytic>(numbers: &[N]) -> Vec<Gradient<N, 1>> {
    numbers.iter().map(|value| plain_one(*value)).collect()
}

pub fn plain_one<N: Analytic>(value: N) -> Gradient<N, 1> {
    Gradient {
        value,
        by: [N::double(0.0)],
    }
}
