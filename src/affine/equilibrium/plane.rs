//! Equilibria over a plane of two parameters: special ones are the curves of extended systems there.

use std::sync::Arc;

use nalgebra::Complex;

use super::curve::{
    EquilibriumCurve, EquilibriumFailure, EquilibriumScales, EquilibriumSetting, RestMode,
};
use super::extended::{Condition, Extended, turned};
use super::field::lifted;
use super::spectrum::eigenvalues;
use crate::affine::mode::AffineSystem;
use crate::affine::system::System;
use crate::continuation::Node;
use crate::continuation::newton::Equations as _;
use crate::linalg::{Matrix, Vector, balance};

/// What makes an equilibrium special beside its own equations, with the vector that normalises the critical one.
#[derive(Clone, Copy, Debug)]
pub enum SpecialCondition<'a> {
    /// A fold: v follows the states, and v·v = 1.
    Fold,
    /// A pair of eigenvalues with the sum zero: a, r and κ in the unit of rates follow the states.
    Pair(&'a [f64]),
    /// Another branch passes in the first parameter: ψ and β follow the states.
    Crossing(&'a [f64]),
}

/// The system with parameters that are further states.
#[derive(Clone, Debug)]
struct ExtendedSystem {
    setting: Arc<EquilibriumSetting>,
    lifted: Arc<AffineSystem>,
}

/// The equilibria over a plane of two parameters.
#[derive(Clone, Debug)]
pub struct EquilibriumPlane {
    parameters: [usize; 2],
    /// In each parameter, the other one beside it.
    single: [ExtendedSystem; 2],
    both: ExtendedSystem,
}

impl EquilibriumPlane {
    /// Those of a system at values of its parameters. `scales` are those of an equilibrium, `widths` the units of the
    /// parameters. `None` where they make no sense.
    pub fn new(
        (system, values): (&System, &[f64]),
        parameters: [usize; 2],
        scales: &EquilibriumScales,
        widths: [f64; 2],
    ) -> Option<EquilibriumPlane> {
        let states = system.source.states.len();
        let usable = |number: &f64| number.is_finite() && *number > 0.0;
        let of_states = (scales.units.get(..states)?, scales.first.get(..states)?);
        let fits = values.len() == system.source.parameters.0.len()
            && parameters.iter().all(|index| *index < values.len())
            && parameters[0] != parameters[1]
            && of_states.0.iter().chain(&widths).all(usable)
            && usable(&scales.rate)
            && of_states.1.iter().chain(values).all(|x| x.is_finite());
        if !fits {
            return None;
        }
        let setting = |indices: &[usize]| {
            let followed = |all: [f64; 2]| {
                let own = indices.iter().map(move |index| all[*index]);
                own.collect::<Vec<f64>>()
            };
            let first = parameters.map(|index| values[index]);
            Arc::new(EquilibriumSetting {
                system: system.clone(),
                values: values.to_vec(),
                parameter: parameters[indices[0]],
                scales: EquilibriumScales {
                    units: [of_states.0, &followed(widths)].concat(),
                    first: [of_states.1, &followed(first)].concat(),
                    rate: scales.rate,
                },
            })
        };
        let posed = |indices: &[usize], order: [usize; 2]| {
            let order = order.map(|index| parameters[index]);
            Some(ExtendedSystem {
                setting: setting(indices),
                lifted: Arc::new(lifted(system, values, &order).ok()?),
            })
        };
        let first = posed(&[0], [0, 1])?;
        Some(EquilibriumPlane {
            parameters,
            both: ExtendedSystem {
                setting: setting(&[0, 1]),
                lifted: first.lifted.clone(),
            },
            single: [first, posed(&[1], [1, 0])?],
        })
    }

    /// The equilibria of a mode in both parameters.
    fn family(&self, mode: usize) -> Option<EquilibriumCurve> {
        /// A rate whose derivatives all are smaller than this part of a state's own is zero but for them where the curve
        /// begins, as at a branch point: it is not scaled up any further.
        const LEAST: f64 = 1e-3;
        let ExtendedSystem { setting, lifted } = &self.both;
        let own = EquilibriumCurve::of(setting.clone(), lifted.clone(), (mode, None))?;
        let EquilibriumScales { units, rate, .. } = &setting.scales;
        let rates = own.rates.iter().zip(units);
        let rates = rates.map(|(factor, unit)| factor.min(1.0 / (LEAST * rate * unit)));
        let rates = rates.collect();
        Some(EquilibriumCurve { rates, ..own })
    }

    /// The equilibria of a mode in one of the parameters, at a value of the other one. Their equations are the same.
    pub fn curve(
        &self,
        mode: &RestMode,
        values: [f64; 2],
        index: usize,
    ) -> Option<EquilibriumCurve> {
        let ExtendedSystem { setting, lifted } = &self.single[index];
        let other = 1 - index;
        let curve = EquilibriumCurve {
            setting: setting.clone(),
            lifted: lifted.clone(),
            beside: Some((self.parameters[other], values[other])),
            signature: mode.clone(),
            ..self.family(mode.mode)?
        };
        Some(curve.observing())
    }

    /// Residuals and derivatives of a special equilibrium in its unknowns, of which the parameters are the last.
    ///
    /// # Errors
    /// Rates or derivatives have no finite value there.
    pub fn evaluate(
        &self,
        (mode, name): (usize, &str),
        special: SpecialCondition,
        point: &Vector,
        (residual, jacobian): (&mut [f64], &mut Matrix),
    ) -> Result<(), EquilibriumFailure> {
        let no_value = || EquilibriumFailure::NoValue {
            mode: name.to_owned(),
        };
        let family = self.family(mode).ok_or_else(no_value)?;
        let n = family.states();
        let (condition, near) = match special {
            SpecialCondition::Fold => (Condition::Fold, &[][..]),
            SpecialCondition::Pair(near) => (Condition::Neutral, near),
            SpecialCondition::Crossing(near) => (Condition::Branching, near),
        };
        if condition != Condition::Fold && near.len() != n {
            return Err(no_value());
        }
        let extended = Extended {
            curve: &family,
            condition,
            near: Vector::from_column_slice(near),
            omega: family.setting.scales.rate,
        };
        extended.evaluate(point, residual, jacobian)?;
        let (last, vector) = (residual.len() - 1, point.rows(n, n));
        let (value, by) = match condition {
            Condition::Fold => (0.5 * (vector.norm_squared() - 1.0), vector.clone_owned()),
            _ => (extended.near.dot(&vector) - 1.0, extended.near.clone()),
        };
        residual[last] = value;
        for (column, by) in by.iter().enumerate() {
            jacobian[(last, n + column)] = *by;
        }
        Ok(())
    }
}

/// The further unknowns of a special equilibrium, and the vector that normalises them.
#[derive(Clone, Debug, PartialEq)]
pub struct CriticalUnknowns {
    /// The normalising vector.
    pub near: Vec<f64>,
    /// The unknowns that follow the states.
    pub further: Vec<f64>,
}

impl EquilibriumCurve {
    /// Units along a curve in two parameters: of states, of which one that is small here may grow, at least a part of the largest
    /// in the units that balance the matrix; of rates the geometric mean of all eigenvalues but those next to zero. `known` are
    /// the units of a branch, beside which a state may be nothing but rounding.
    ///
    /// # Errors
    /// Rates or guards have no finite value there.
    pub fn wide_scales(
        &self,
        point: &Vector,
        known: Option<&EquilibriumScales>,
    ) -> Result<EquilibriumScales, EquilibriumFailure> {
        const PART: f64 = 0.3;
        /// A state smaller than this part of its unit on the branch is zero.
        const NOTHING: f64 = 1e-9;
        /// An eigenvalue smaller than this part of the largest may be one that the curve keeps at zero.
        const ZERO: f64 = 1e-6;
        let at = self.linearised(point)?;
        let mut scales = self.setting.scales.clone();
        if let Some(known) = known {
            scales.rate = known.rate;
        }
        // where nothing but a zero eigenvalue is left, as at a fold within a surface, what acts one way has this rate
        let (balanced, _) = balance(&at.slopes(), scales.rate);
        let sizes: Vec<f64> = eigenvalues(&at)
            .iter()
            .map(|one| one.value.norm())
            .collect();
        let most = sizes
            .iter()
            .fold(scales.rate, |most: f64, size| most.max(*size));
        let logs = sizes.iter().filter(|size| **size > ZERO * most);
        let logs: Vec<f64> = logs.map(|size| size.ln()).collect();
        let rate = (logs.iter().sum::<f64>() / logs.len() as f64).exp();
        if rate.is_normal() {
            scales.rate = rate;
        }
        if let Some(known) = known.filter(|known| known.units.len() == scales.units.len()) {
            scales.units.clone_from(&known.units);
        }
        let least = |index: usize| known.map_or(0.0, |known| NOTHING * known.units[index]);
        let states = self.state(point);
        let sizes = states.iter().map(|x| x.abs()).enumerate();
        let sizes: Vec<f64> = sizes
            .map(|(index, x)| if x > least(index) { x } else { 0.0 })
            .collect();
        let shares = sizes.iter().zip(balanced.iter());
        let largest = shares.fold(0.0, |most: f64, (x, unit)| most.max(x / unit));
        if largest > 0.0 {
            for (index, size) in sizes.into_iter().enumerate() {
                scales.units[index] = size.max(PART * largest * balanced[index]);
            }
        }
        Ok(scales)
    }

    /// Those of the pair of eigenvalues next to the imaginary axis; `None` where it is real.
    pub fn pair_unknowns(&self, point: &Vector) -> Option<CriticalUnknowns> {
        let (mut unknowns, omega) = self.unknowns_of(point, Condition::Neutral)?;
        let n = self.states();
        // r and κ in the unit of rates
        let turn = omega / self.setting.scales.rate;
        unknowns.further[n..2 * n]
            .iter_mut()
            .for_each(|r| *r /= turn);
        unknowns.further[2 * n] = turn * turn;
        Some(unknowns)
    }

    /// Those of a branch point.
    pub fn crossing_unknowns(&self, point: &Vector) -> Option<CriticalUnknowns> {
        Some(self.unknowns_of(point, Condition::Branching)?.0)
    }

    fn unknowns_of(&self, point: &Vector, condition: Condition) -> Option<(CriticalUnknowns, f64)> {
        let node = Node::on(self, point.clone())?;
        let (extended, guess) = Extended::near(self, &node, condition)?;
        let n = self.states();
        let further = guess.as_slice()[n..guess.len() - 1].to_vec();
        let near = extended.near.as_slice().to_vec();
        Some((CriticalUnknowns { near, further }, extended.omega))
    }

    /// Whether the equilibria of a branch point cross in this parameter, too: ψᵀE_p is zero but for rounding, so that the
    /// branches stay together.
    pub fn stays_crossed(&self, point: &Vector, unknowns: &CriticalUnknowns) -> bool {
        /// In equations of order one: the null vector is known to rounding times their condition.
        const ROUNDED: f64 = 1e-9;
        let Ok(at) = self.linearised(point) else {
            return false;
        };
        let n = self.states();
        let rows = self.rows(&at);
        let terms = rows.iter().zip(&unknowns.further);
        let product: f64 = terms.map(|(row, psi)| row.by[n] * psi).sum();
        product.abs() <= ROUNDED
    }
}

/// The unknowns a, r and κ of a pair. With b = √κ r the vectors of the same pair are those of (a + ib)e^(iφ), times a number.
#[derive(Clone, Debug, PartialEq)]
pub struct PairVectors {
    a: Vector,
    r: Vector,
    kappa: f64,
}

impl PairVectors {
    /// Those among further unknowns; `None` where these have another length.
    pub fn of(further: &[f64]) -> Option<PairVectors> {
        let n = further.len() / 2;
        (further.len() == 2 * n + 1).then(|| PairVectors {
            a: Vector::from_column_slice(&further[..n]),
            r: Vector::from_column_slice(&further[n..2 * n]),
            kappa: further[2 * n],
        })
    }

    /// Further unknowns.
    fn further(&self) -> Vec<f64> {
        let all = self.a.iter().chain(&self.r).copied();
        all.chain([self.kappa]).collect()
    }

    /// The vector c with c·a = 1 and c·r = 0 in the plane of both.
    pub fn across(&self) -> Option<Vec<f64>> {
        let across = &self.a - &self.r * (self.a.dot(&self.r) / self.r.norm_squared());
        let size = across.dot(&self.a);
        size.is_normal()
            .then(|| (across / size).as_slice().to_vec())
    }

    /// The vectors of the same pair with c·a = 1 and c·r = 0 for a given c.
    pub fn normalised(&self, near: &[f64]) -> Option<Vec<f64>> {
        let near = Vector::from_column_slice(near);
        if near.len() != self.a.len() {
            return None;
        }
        let (along, across) = (near.dot(&self.a), near.dot(&self.r));
        let size = along * along + self.kappa * across * across;
        let (keep, turn) = (along / size, across / size);
        let turned = PairVectors {
            a: &self.a * keep + &self.r * (self.kappa * turn),
            r: &self.r * keep - &self.a * turn,
            kappa: self.kappa,
        };
        size.is_normal().then(|| turned.further())
    }

    /// Vectors of the same pair of which a is the longer one, across b, and their c, where the own ones are far from that: as ω
    /// falls r would grow without bound. Vectors that are longer than the other unknowns are shortened, or a step would be a
    /// step of theirs alone.
    pub fn renewed(&self) -> Option<CriticalUnknowns> {
        /// How many times longer than a b may be: more than 1, or a pair that turns in a circle would turn at every step.
        const LONGER: f64 = 2.0;
        /// Cosine of the angle between a and r from which these are made orthogonal.
        const SKEW: f64 = 0.7;
        /// The longest that a and r may be, where the other unknowns are of order one.
        const LONGEST: f64 = 4.0;
        let omega = self.kappa.sqrt();
        let is_long = omega * self.r.norm() > LONGER * self.a.norm();
        if is_long && omega.is_normal() {
            let turned = self.turned(omega);
            let near = (&turned.a / turned.a.norm_squared()).as_slice().to_vec();
            return Some(CriticalUnknowns {
                near,
                further: turned.further(),
            });
        }
        // a multiple of a in r is a phase: without it r is as long as need be, or it would grow as ω falls
        let skew = self.a.dot(&self.r) / (self.a.norm() * self.r.norm());
        if skew.abs() > SKEW {
            let near = (&self.a / self.a.norm_squared()).as_slice().to_vec();
            let further = self.normalised(&near)?;
            return Some(CriticalUnknowns { near, further });
        }
        let length = self.a.norm().max(self.r.norm());
        if length <= LONGEST {
            return None;
        }
        let shortened = PairVectors {
            a: &self.a / length,
            r: &self.r / length,
            kappa: self.kappa,
        };
        Some(CriticalUnknowns {
            near: shortened.across()?,
            further: shortened.further(),
        })
    }

    /// Vectors of the same pair of which a is longer than b, and across it.
    fn turned(&self, omega: f64) -> PairVectors {
        let parts = self.a.iter().zip(&self.r);
        let parts: Vec<Complex<f64>> = parts.map(|(a, r)| Complex::new(*a, omega * r)).collect();
        let (a, b) = turned(&parts);
        PairVectors {
            r: b / omega,
            a,
            kappa: self.kappa,
        }
    }
}
