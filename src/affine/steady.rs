//! Equilibria of every mode and every sliding mode, admissible or virtual, with their eigenvalues.

use nalgebra::Complex;

use super::mode::{AffineMode, AffineSystem};
use crate::linalg::{Matrix, Vector, condition, eigenvalues, solve};

/// An equilibrium of a mode: f(x) = 0; of a sliding mode, also on its surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Equilibrium {
    /// The mode.
    pub mode: usize,
    /// The state.
    pub state: Vec<f64>,
    /// Eigenvalues of ∂f/∂x, the fastest growing first; a sliding mode has one zero for the direction it takes away.
    pub eigenvalues: Vec<Complex<f64>>,
    /// ∂f/∂x.
    pub slopes: Matrix,
    /// The guard that is negative there, the most negative one: the equilibrium is virtual. `None` where it is
    /// admissible.
    pub violated: Option<usize>,
}

/// What a mode has in the place of one equilibrium.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NoEquilibrium {
    /// Its rates depend on the phase.
    #[error("the mode is forced: nothing rests in it")]
    Forced,
    /// Its matrix is singular, to rounding.
    #[error("the matrix of the mode is singular: no equilibrium, or a family of them")]
    Singular,
    /// Newton's method finds none.
    #[error("no equilibrium is found from {STARTS} places up to {FARTHEST} away")]
    NotFound,
}

/// Places from which equilibria of a mode that is not affine are looked for, and how far the farthest are.
const STARTS: usize = 400;
const FARTHEST: f64 = 10.0;

/// Newton's steps from each of them.
const STEPS: usize = 60;

/// A step of this part of the state is rounding, and equilibria this close are one.
const STILL: f64 = 1e-13;
const SAME: f64 = 1e-8;

impl AffineSystem {
    /// The equilibria of a mode: the one of an affine mode; of another all that Newton's method finds where no state
    /// exceeds 10, in the order of the first state.
    ///
    /// # Errors
    /// Why there is none, or a family of them.
    pub fn equilibria(&self, mode: usize) -> Result<Vec<Equilibrium>, NoEquilibrium> {
        let n = self.states;
        let AffineMode { field, matrix, .. } = &self.modes[mode];
        if field.is_forced(matrix, n) {
            return Err(NoEquilibrium::Forced);
        }
        let zero = Vector::zeros(n);
        if field.is_exact {
            let (state, slopes) = self.newton_step(mode, &zero)?;
            return Ok(vec![self.equilibrium(mode, &state, &slopes)]);
        }
        let (mut found, mut far): (Vec<Equilibrium>, Vec<Equilibrium>) = Default::default();
        for start in 0..STARTS {
            // places of the same share of every size: 0, then the golden sequence of every state
            let size = FARTHEST.powf(2.0 * start as f64 / STARTS as f64 - 1.0);
            let share = |state: usize| (start as f64 * ((state + 2) as f64).sqrt()).fract() - 0.5;
            let mut state = Vector::from_fn(n, |state, _| 2.0 * size * share(state));
            if start == 0 {
                state.fill(0.0);
            }
            let slopes = self.settle(mode, &mut state);
            let same = |one: &Equilibrium| {
                let pairs = one.state.iter().zip(&state);
                let off = pairs.map(|(x, y)| (x - y).abs()).fold(0.0, f64::max);
                off <= SAME * state.amax().max(1.0)
            };
            if let Some(slopes) = slopes.filter(|_| !found.iter().chain(&far).any(same)) {
                let near = state.amax() <= FARTHEST;
                let list = if near { &mut found } else { &mut far };
                list.push(self.equilibrium(mode, &state, &slopes));
            }
        }
        // a pendulum has infinitely many: those far away count where there is none nearby
        if found.is_empty() {
            found = far;
        }
        found.sort_by(|one, other| one.state[0].total_cmp(&other.state[0]));
        Some(found)
            .filter(|found| !found.is_empty())
            .ok_or(NoEquilibrium::NotFound)
    }

    /// The equilibrium of a mode that Newton's method finds from a state; of an affine mode the only one.
    pub(super) fn equilibrium_near(&self, mode: usize, state: &[f64]) -> Option<Equilibrium> {
        if self.modes[mode].field.is_exact {
            return self.equilibria(mode).ok()?.pop();
        }
        let mut state = Vector::from_column_slice(state);
        let slopes = self.settle(mode, &mut state)?;
        Some(self.equilibrium(mode, &state, &slopes))
    }

    /// Newton's method for an equilibrium of a mode: the derivatives of its rates there.
    fn settle(&self, mode: usize, state: &mut Vector) -> Option<Matrix> {
        for _ in 0..STEPS {
            let (next, slopes) = self.newton_step(mode, state).ok()?;
            let step = (&next - &*state).amax();
            *state = next;
            if step <= STILL * state.amax().max(STILL) {
                return Some(slopes);
            }
        }
        None
    }

    /// Where the rates of a mode are zero if they change as at a state, and their derivatives there.
    fn newton_step(&self, mode: usize, state: &Vector) -> Result<(Vector, Matrix), NoEquilibrium> {
        let n = self.states;
        let AffineMode {
            matrix,
            surface,
            field,
            ..
        } = &self.modes[mode];
        let z = self.lift(mode, state.as_slice(), 0.0);
        // on a surface its own equation takes the place of the direction that sliding leaves out
        let extra = surface.iter().map(|row| row.at.transpose());
        let rates = (0..n).map(|row| matrix.at.row(row).into_owned());
        let rows: Vec<_> = rates.chain(extra).collect();
        let equations = Matrix::from_rows(&rows);
        let slopes = match field.is_exact {
            true => Matrix::identity(z.len(), n),
            false => field.series(&z, 0, true, true).derivatives(0.0).0,
        };
        let left = &equations * slopes.columns(0, n);
        let right = &left * state - &equations * z;
        let own = left.rows(0, n).into_owned();
        if !left.iter().chain(&right).all(|x| x.is_finite()) {
            return Err(NoEquilibrium::Singular);
        }
        let replaced = |row: usize| {
            let (mut square, mut values) = (own.clone(), right.rows(0, n).into_owned());
            if surface.is_some() {
                square.set_row(row, &left.row(n));
                values[row] = right[n];
            }
            (square, values)
        };
        // rates along the normal of a surface are zero in it: the row that makes the best system gives way to its equation
        let candidates = if surface.is_some() { 0..n } else { 0..1 };
        let systems = candidates.map(replaced);
        let best =
            systems.min_by(|(one, _), (other, _)| condition(one).total_cmp(&condition(other)));
        let solved = best.and_then(|(square, values)| solve(&square, &values));
        Ok((solved.ok_or(NoEquilibrium::Singular)?, own))
    }

    fn equilibrium(&self, mode: usize, state: &Vector, slopes: &Matrix) -> Equilibrium {
        let state: Vec<f64> = state.iter().copied().collect();
        let z = self.lift(mode, &state, 0.0);
        let guards = &self.modes[mode].guards;
        let values = guards.iter().map(|guard| guard.row.at.dot(&z)).enumerate();
        let worst = values.min_by(|one, other| one.1.total_cmp(&other.1));
        let mut eigenvalues = eigenvalues(slopes).unwrap_or_default();
        eigenvalues.sort_by(|one, other| {
            let key = |value: &Complex<f64>| (-value.re, -value.im);
            let (one, other) = (key(one), key(other));
            one.0.total_cmp(&other.0).then(one.1.total_cmp(&other.1))
        });
        Equilibrium {
            mode,
            state,
            eigenvalues,
            slopes: slopes.clone(),
            violated: worst
                .filter(|(_, value)| *value < 0.0)
                .map(|(guard, _)| guard),
        }
    }
}
