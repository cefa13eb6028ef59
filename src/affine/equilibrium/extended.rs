//! Special equilibria by extended systems, which are regular there and whose derivatives are exact.
//!
//! With E(x, p) the n equations, A = ∂f/∂x, all in scaled unknowns:
//!
//! | point | unknowns | equations |
//! |---|---|---|
//! | fold | x, v, p | E = 0, E_x v = 0, c·v = 1 |
//! | Hopf point | x, a, b, ω, p | E = 0, Aa + ωb = 0, Ab − ωa = 0, c·b = 0, c·a = 1 |
//! | neutral pair | x, a, r, κ, p | E = 0, Aa + κr = 0, Ar − a = 0, c·r = 0, c·a = 1 |
//! | branch point | x, ψ, β, p | E + βd = 0, ψᵀE_x = 0, ψᵀE_p = 0, d·ψ = 1 |
//!
//! c and d are what v, a and ψ are near the point; at a branch point that branches do pass β is zero (G. Moore, A. Spence,
//! SIAM J. Numer. Anal. 17, 1980; A. Griewank, G. Reddien, IMA J. Numer. Anal. 3, 1983; G. Moore, Numer. Funct. Anal. Optim.
//! 2, 1980). The second form of a Hopf point, κ = ω², is regular where ω is zero, too, and goes on to pairs of real
//! eigenvalues with the sum zero (D. Roose, V. Hlavaček, SIAM J. Appl. Math. 45, 1985).
//!
//! With one parameter the systems have a solution, with two a curve of them, where p in E_p is the first.

use nalgebra::Complex;

use super::curve::{EquilibriumCurve, EquilibriumFailure, EquilibriumScales, EquilibriumSetting};
use super::field::{Linearised, LocalField, Of};
use super::normal_form::Eigenvector;
use crate::continuation::Node;
use crate::continuation::branch_point::PERFECT;
use crate::continuation::newton::{self, Constraint, Equations};
use crate::linalg::{self, Matrix, Vector};
use crate::orbit::{AtZero, Examined as _, Zones};

/// Which special points are asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Condition {
    Fold,
    Hopf,
    Neutral,
    Branching,
}

/// An extended system: its last unknowns are the parameters, its last equation is left to a constraint.
pub(super) struct Extended<'a> {
    pub curve: &'a EquilibriumCurve,
    pub condition: Condition,
    /// What v, a or ψ is near the point.
    pub near: Vector,
    /// The unit of ω.
    pub omega: f64,
}

/// A row of a matrix.
type RowView<'a> =
    nalgebra::MatrixView<'a, f64, nalgebra::U1, nalgebra::Dyn, nalgebra::U1, nalgebra::Dyn>;

/// A special equilibrium.
pub(super) struct Located {
    /// Scaled unknowns.
    pub point: Vector,
    /// Error of the parameter, in physical units.
    pub uncertainty: f64,
}

/// Settings of Newton's method: one iteration more than needed.
const NEWTON: newton::Settings = newton::Settings {
    tolerance: 1e-12,
    most_iterations: 20,
    halvings: 0,
    polish: 1,
};

/// The last equation: c·v = 1.
struct Normalised;

impl Constraint<Extended<'_>> for Normalised {
    fn evaluate(
        &mut self,
        system: &Extended,
        point: &Vector,
        gradient: &mut [f64],
    ) -> Result<f64, EquilibriumFailure> {
        let n = system.curve.states();
        gradient[n..2 * n].copy_from_slice(system.near.as_slice());
        Ok(system.near.dot(&point.rows(n, n)) - 1.0)
    }
}

/// The special equilibrium of a kind next to a node. `None` where there is none.
pub(super) fn locate(
    curve: &EquilibriumCurve,
    node: &Node,
    condition: Condition,
) -> Option<Located> {
    let (extended, guess) = Extended::near(curve, node, condition)?;
    let solution = newton::solve(&extended, &mut Normalised, &guess, &NEWTON).ok()?;
    let found = solution.point;
    let n = curve.states();
    let beta = || found[2 * n].abs();
    if condition == Condition::Branching && beta() > PERFECT {
        return None;
    }
    let rounding = rounding(&extended, &mut Normalised, &found)?;
    let last = found.len() - 1;
    // in units of order one less than a rounding of these is nothing, and would be the unit of a state that is zero
    let is_known = |x: &f64| x.abs() > f64::EPSILON;
    let state = |index: usize| Some(found[index]).filter(is_known).unwrap_or(0.0);
    let point = Vector::from_fn(n + 1, |index, _| match index == n {
        true => found[last],
        false => state(index),
    });
    Some(Located {
        point,
        uncertainty: (rounding + solution.correction.min(NEWTON.tolerance))
            * curve.setting.scales.units[n],
    })
}

/// What rounding leaves in the last unknown of a solution.
fn rounding<S: Equations>(
    system: &S,
    constraint: &mut impl Constraint<S>,
    found: &Vector,
) -> Option<f64> {
    let bordered = newton::bordered(system, constraint, found).ok()?;
    let noise = newton::noise(system, &bordered.matrix, found);
    let rounding = newton::rounding(&bordered.matrix, &found.abs(), noise.as_ref())?;
    Some(rounding[found.len() - 1])
}

/// A special equilibrium of a mode, in physical units.
pub struct SpecialEquilibrium {
    /// States.
    pub state: Vec<f64>,
    /// The parameter.
    pub parameter: f64,
    /// Its error.
    pub error: f64,
}

impl EquilibriumCurve {
    /// The place that the units of the setting come from, in scaled unknowns.
    fn beginning(&self) -> Vector {
        let EquilibriumScales { units, first, .. } = &self.setting.scales;
        let scaled = first.iter().zip(units).map(|(x, unit)| x / unit);
        Vector::from_iterator(units.len(), scaled)
    }

    fn special(&self, Located { point, uncertainty }: Located) -> SpecialEquilibrium {
        let physical = point.iter().zip(&self.setting.scales.units);
        let mut state: Vec<f64> = physical.map(|(x, unit)| x * unit).collect();
        let parameter = state.remove(self.states());
        SpecialEquilibrium {
            state,
            parameter,
            error: uncertainty,
        }
    }
}

/// The fold of the equilibria of a mode next to the state and the parameter from which the units of a setting come, whether
/// or not they have an equilibrium. `None` where there is none.
pub fn fold_near(setting: EquilibriumSetting, mode: usize) -> Option<SpecialEquilibrium> {
    let curve = EquilibriumCurve::new(setting, mode)?;
    let point = curve.beginning();
    let located = locate(&curve, &Node::at(point.clone(), point), Condition::Fold)?;
    Some(curve.special(located))
}

/// The equilibrium of a mode next to the same state and parameter at which a guard of it is zero. `None` where there is none.
pub fn boundary_near(
    setting: EquilibriumSetting,
    mode: usize,
    guard: usize,
) -> Option<SpecialEquilibrium> {
    let curve = EquilibriumCurve::new(setting, mode)?;
    let point = curve.beginning();
    let examination = curve.examination(&point).ok()?;
    let mut margins = examination.margins().iter();
    let margin = margins.find(|margin| margin.guard == guard)?.clone();
    let mut zero = AtZero { margin };
    let solution = newton::solve(&curve, &mut zero, &point, &NEWTON).ok()?;
    let rounding = rounding(&curve, &mut zero, &solution.point)?;
    let unit = curve.setting.scales.units[curve.states()];
    Some(curve.special(Located {
        uncertainty: (rounding + solution.correction.min(NEWTON.tolerance)) * unit,
        point: solution.point,
    }))
}

impl<'a> Extended<'a> {
    /// The system, and a guess from an equilibrium nearby.
    pub fn near(
        curve: &'a EquilibriumCurve,
        node: &Node,
        condition: Condition,
    ) -> Option<(Extended<'a>, Vector)> {
        let n = curve.states();
        let at = curve.linearised(&node.point).ok()?;
        let rows = curve.rows(&at);
        let equations = Matrix::from_fn(n, n, |row, column| rows[row].by[column]);
        let (near, more, omega) = match condition {
            Condition::Fold => (linalg::least(&equations)?.right, Vec::new(), 1.0),
            Condition::Branching => {
                let whole = Matrix::from_fn(n, n + 1, |row, column| rows[row].by[column]);
                (linalg::least_vector(&whole.transpose())?, vec![0.0], 1.0)
            }
            Condition::Hopf | Condition::Neutral => {
                let Eigenvector { value, right } = Eigenvector::critical(&at)?;
                let units = &curve.setting.scales.units;
                let scaled = right
                    .iter()
                    .zip(units)
                    .map(|(q, unit)| q / Complex::from(*unit));
                let (a, b) = turned(&scaled.collect::<Vec<_>>());
                let size = a.norm_squared();
                // in the unit of ω both forms are the same here
                let mut more: Vec<f64> = b.iter().copied().collect();
                more.push(1.0);
                let near = &a / size;
                let guess = guess(node, &a, &more);
                let extended = Extended {
                    curve,
                    condition,
                    near,
                    omega: value.im,
                };
                return Some((extended, guess));
            }
        };
        let guess = guess(node, &near, &more);
        let extended = Extended {
            curve,
            condition,
            near,
            omega,
        };
        Some((extended, guess))
    }

    /// Rows of derivatives of E_x v in the unknowns x and p, with factors and units; `rates` where v is an eigenvector.
    fn second(&self, place: &[f64], functions: &[(Of, f64)], v: &[f64]) -> Matrix {
        let units = &self.curve.setting.scales.units;
        let (all, n) = (units.len(), v.len());
        let along = |index: usize| {
            if index < n {
                v[index] * units[index]
            } else {
                0.0
            }
        };
        let v = Vector::from_fn(all, |index, _| along(index));
        let others: Vec<Vector> = (0..all)
            .map(|column| {
                Vector::from_fn(
                    all,
                    |index, _| if index == column { units[index] } else { 0.0 },
                )
            })
            .collect();
        let (of, factors): (Vec<Of>, Vec<f64>) = functions.iter().copied().unzip();
        let local = self.curve.local(place);
        let mut found = local.second(&of, &v, &others);
        // across a kink that the equilibria stay at the matrix jumps, and they know nothing of that
        if found.iter().any(|x| x.is_nan()) {
            let sides = [1.0, -1.0].map(|side| {
                let signs = local.on_side(side);
                let local = LocalField {
                    signs: &signs,
                    ..local
                };
                local.second(&of, &v, &others)
            });
            found = 0.5 * (&sides[0] + &sides[1]);
        }
        for (mut row, factor) in found.row_iter_mut().zip(factors) {
            row *= factor;
        }
        found
    }

    /// The parts of the equations that are those of an equilibrium.
    fn equilibrium(&self, at: &Linearised, residual: &mut [f64], jacobian: &mut Matrix) -> Matrix {
        let n = self.curve.states();
        let rows = self.curve.rows(at);
        for (row, linear) in rows.iter().enumerate() {
            residual[row] = linear.value;
            for (variable, by) in linear.by.iter().enumerate() {
                let column = self.column(variable, jacobian);
                jacobian[(row, column)] = *by;
            }
        }
        Matrix::from_fn(n, n + 1, |row, column| rows[row].by[column])
    }

    /// The column of a state or parameter.
    fn column(&self, variable: usize, jacobian: &Matrix) -> usize {
        let n = self.curve.states();
        if variable < n {
            variable
        } else {
            jacobian.ncols() - self.curve.parameters() + variable - n
        }
    }

    fn fold(&self, at: &Linearised, point: &Vector, residual: &mut [f64], jacobian: &mut Matrix) {
        let n = self.curve.states();
        let by = self.equilibrium(at, residual, jacobian);
        let v = &point.as_slice()[n..2 * n];
        let place = self.curve.place(&self.unknown(point));
        let second = self.second(&place, &self.curve.equations(at), v);
        for row in 0..n {
            residual[n + row] = (0..n).map(|column| by[(row, column)] * v[column]).sum();
            for column in 0..n {
                jacobian[(n + row, n + column)] = by[(row, column)];
            }
            self.put(n + row, &second.row(row), jacobian);
        }
    }

    /// Derivatives of an equation in states and parameters.
    fn put(&self, line: usize, by: &RowView, jacobian: &mut Matrix) {
        for (variable, by) in by.iter().enumerate() {
            let column = self.column(variable, jacobian);
            jacobian[(line, column)] = *by;
        }
    }

    fn hopf(&self, at: &Linearised, point: &Vector, residual: &mut [f64], jacobian: &mut Matrix) {
        let n = self.curve.states();
        self.equilibrium(at, residual, jacobian);
        let units = &self.curve.setting.scales.units;
        let rates: Vec<(Of, f64)> = (0..n)
            .map(|state| (Of::Rate(state), self.curve.rates[state]))
            .collect();
        let place = self.curve.place(&self.unknown(point));
        let (a, b) = (&point.as_slice()[n..2 * n], &point.as_slice()[2 * n..3 * n]);
        let omega = point[3 * n] * self.omega;
        // what a and b are multiplied by, with its derivative in the unknown: ω both, or κ and 1 in the unit of ω
        let turn = (omega, self.omega);
        let back = match self.condition {
            Condition::Neutral => (self.omega, 0.0),
            _ => turn,
        };
        for (first, (own, own_at), (other, other_at), sign, (omega, by_omega)) in [
            (n, (a, n), (b, 2 * n), 1.0, turn),
            (2 * n, (b, 2 * n), (a, n), -1.0, back),
        ] {
            let second = self.second(&place, &rates, own);
            for row in 0..n {
                let (line, factor) = (first + row, self.curve.rates[row]);
                let slope = |column: usize| at.rates[row].by[column] * units[column] * factor;
                let turn = sign * units[row] * factor;
                let sum: f64 = (0..n).map(|column| slope(column) * own[column]).sum();
                residual[line] = sum + turn * omega * other[row];
                for column in 0..n {
                    jacobian[(line, own_at + column)] = slope(column);
                }
                self.put(line, &second.row(row), jacobian);
                jacobian[(line, other_at + row)] += turn * omega;
                jacobian[(line, 3 * n)] = turn * by_omega * other[row];
            }
        }
        residual[3 * n] = (0..n).map(|index| self.near[index] * b[index]).sum();
        for index in 0..n {
            jacobian[(3 * n, 2 * n + index)] = self.near[index];
        }
    }

    fn branching(
        &self,
        at: &Linearised,
        point: &Vector,
        residual: &mut [f64],
        jacobian: &mut Matrix,
    ) {
        let n = self.curve.states();
        let by = self.equilibrium(at, residual, jacobian);
        let (psi, beta) = (&point.as_slice()[n..2 * n], point[2 * n]);
        let place = self.curve.place(&self.unknown(point));
        let (of, factors): (Vec<Of>, Vec<f64>) = self.curve.equations(at).into_iter().unzip();
        let units = &self.curve.setting.scales.units;
        let all = units.len();
        let axes: Vec<Vector> = (0..all)
            .map(|column| {
                Vector::from_fn(
                    all,
                    |index, _| if index == column { units[index] } else { 0.0 },
                )
            })
            .collect();
        for row in 0..n {
            residual[row] += beta * self.near[row];
            jacobian[(row, 2 * n)] = self.near[row];
        }
        for line in 0..=n {
            residual[n + line] = (0..n).map(|row| psi[row] * by[(row, line)]).sum();
            let second = self.curve.local(&place).second(&of, &axes[line], &axes);
            let curved = |column: usize| -> f64 {
                let rows = 0..n;
                rows.map(|row| psi[row] * factors[row] * second[(row, column)])
                    .sum()
            };
            for column in 0..n {
                jacobian[(n + line, n + column)] = by[(column, line)];
            }
            for variable in 0..all {
                let column = self.column(variable, jacobian);
                jacobian[(n + line, column)] = curved(variable);
            }
        }
    }

    /// Scaled states and parameters of scaled unknowns.
    fn unknown(&self, point: &Vector) -> Vector {
        let (n, own) = (self.curve.states(), self.curve.parameters());
        let first = point.len() - own;
        let of = |variable: usize| {
            if variable < n {
                variable
            } else {
                first + variable - n
            }
        };
        Vector::from_fn(n + own, |variable, _| point[of(variable)])
    }
}

/// States, the vector, what follows it, and the parameter.
fn guess(node: &Node, vector: &Vector, more: &[f64]) -> Vector {
    let n = vector.len();
    let states = node.point.iter().take(n);
    let all = states.chain(vector.iter()).chain(more);
    let all: Vec<f64> = all.copied().chain([node.point[n]]).collect();
    Vector::from_vec(all)
}

/// Real and imaginary part of an eigenvector, turned so that they are orthogonal and the first is the longer one.
pub(super) fn turned(vector: &[Complex<f64>]) -> (Vector, Vector) {
    let part = |turn: Complex<f64>, of: fn(Complex<f64>) -> f64| {
        Vector::from_iterator(vector.len(), vector.iter().map(|q| of(q * turn)))
    };
    // q·q becomes real and positive
    let square: Complex<f64> = vector.iter().map(|q| q * q).sum();
    let turn = Complex::from_polar(1.0, -0.5 * square.arg());
    (part(turn, |q| q.re), part(turn, |q| q.im))
}

impl Equations for Extended<'_> {
    type Failure = EquilibriumFailure;

    fn unknowns(&self) -> usize {
        let n = self.curve.states();
        let own = match self.condition {
            Condition::Fold => 2 * n,
            Condition::Hopf | Condition::Neutral => 3 * n + 1,
            Condition::Branching => 2 * n + 1,
        };
        own + self.curve.parameters()
    }

    fn evaluate(
        &self,
        point: &Vector,
        residual: &mut [f64],
        jacobian: &mut Matrix,
    ) -> Result<(), EquilibriumFailure> {
        let at = self.curve.linearised(&self.unknown(point))?;
        match self.condition {
            Condition::Fold => self.fold(&at, point, residual, jacobian),
            Condition::Hopf | Condition::Neutral => self.hopf(&at, point, residual, jacobian),
            Condition::Branching => self.branching(&at, point, residual, jacobian),
        }
        Ok(())
    }
}
