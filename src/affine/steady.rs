//! Equilibria of every mode and every sliding mode, admissible or virtual, with their eigenvalues.

use nalgebra::Complex;

use super::mode::{AffineMode, AffineSystem};
use crate::linalg::{Matrix, Vector};

/// An equilibrium of a mode: Ax + b = 0; of a sliding mode, also on its surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Equilibrium {
    /// The mode.
    pub mode: usize,
    /// The state.
    pub state: Vec<f64>,
    /// Eigenvalues of A, the fastest growing first; a sliding mode has one zero for the direction it takes away.
    pub eigenvalues: Vec<Complex<f64>>,
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
}

/// Least singular value, in units of the largest, below which a matrix is singular to rounding.
const SINGULAR: f64 = 1e-13;

impl AffineSystem {
    /// The equilibrium of a mode.
    ///
    /// # Errors
    /// Why there is none, or more than one.
    pub fn equilibrium(&self, mode: usize) -> Result<Equilibrium, NoEquilibrium> {
        let n = self.states;
        let AffineMode {
            matrix,
            guards,
            surface,
        } = &self.modes[mode];
        let forced = matrix.at.view((0, n + 1), (n, 2 * self.harmonics));
        if forced.amax() > 0.0 {
            return Err(NoEquilibrium::Forced);
        }
        let own = matrix.at.view((0, 0), (n, n)).into_owned();
        // on a surface its own equation takes the place of the direction that sliding leaves out
        let extra = surface.iter().map(|row| row.at.rows(0, n + 1).into_owned());
        let extra: Vec<Vector> = extra.collect();
        let equations = Matrix::from_fn(n + extra.len(), n + 1, |row, column| match row {
            _ if row < n => matrix.at[(row, column)],
            _ => extra[row - n][column],
        });
        let left = equations.columns(0, n).into_owned();
        let right = -equations.column(n);
        let decomposition = left.svd(true, true);
        let (largest, least) = (
            decomposition.singular_values.max(),
            decomposition.singular_values.min(),
        );
        if least.is_nan() || least <= SINGULAR * largest {
            return Err(NoEquilibrium::Singular);
        }
        let solved = decomposition.solve(&right, 0.0);
        let state = solved.map_err(|_| NoEquilibrium::Singular)?;
        let state: Vec<f64> = state.iter().copied().collect();
        let z = self.lift(&state, 0.0);
        let values = guards.iter().map(|guard| guard.row.at.dot(&z)).enumerate();
        let worst = values.min_by(|one, other| one.1.total_cmp(&other.1));
        let mut eigenvalues: Vec<Complex<f64>> =
            own.complex_eigenvalues().iter().copied().collect();
        eigenvalues.sort_by(|one, other| {
            let key = |value: &Complex<f64>| (-value.re, -value.im);
            let (one, other) = (key(one), key(other));
            one.0.total_cmp(&other.0).then(one.1.total_cmp(&other.1))
        });
        Ok(Equilibrium {
            mode,
            state,
            eigenvalues,
            violated: worst
                .filter(|(_, value)| *value < 0.0)
                .map(|(guard, _)| guard),
        })
    }
}
