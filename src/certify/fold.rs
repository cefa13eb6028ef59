//! A fold: the equations of the wave, and those of the direction in which the parameter is stationary.

use super::equations::{EquationTerm, Evaluated};
use super::system::{EXCESS, PARAMETER, SLOTS, WaveSystem};
use crate::interval::{Gradient, Interval, Number};
use crate::linalg::{Matrix, kernel};

/// The derivative along a direction v, with first derivatives in the quantities and in v.
type Second = Gradient<Gradient<Interval, { 2 * SLOTS }>, 1>;

impl WaveSystem<'_> {
    /// The direction of the branch at a fold, without its vanishing component of the parameter.
    pub(super) fn fold_direction(&self, guess: &[f64]) -> Option<Vec<f64>> {
        let points: Vec<Interval> = guess.iter().copied().map(Interval::point).collect();
        let Evaluated { jacobian, .. } = self.waves_into(&points, self.waves())?;
        let n = self.waves();
        let middle = |i: usize, j: usize| jacobian[i][j].middle();
        let matrix = Matrix::from_fn(n - 1, n, middle);
        let kernel = kernel(&matrix)?;
        Some(kernel.null_vector.iter().take(n - 1).copied().collect())
    }

    /// The equations of a fold: rows of F, rows of F_x v, ⟨ℓ, v⟩ − 1.
    pub(super) fn fold_at(&self, x: &[Interval]) -> Option<Evaluated> {
        let n = self.waves();
        let [excess, parameter] = self.tail();
        // v has no component in the parameter
        let along = |column: usize| (column != parameter).then_some(n + column);
        let variable = |column: usize, slot: usize| Second {
            value: Gradient::variable(x[column], slot),
            by: [match along(column) {
                Some(direction) => Gradient::variable(x[direction], SLOTS + slot),
                None => Gradient::double(0.0),
            }],
        };
        let frame = self.frame(variable(excess, EXCESS), variable(parameter, PARAMETER))?;
        let terms = self.terms(&frame, |columns| {
            std::array::from_fn(|slot| match columns[slot] {
                Some(column) => variable(column, slot),
                None => Second::double(0.0),
            })
        })?;
        let mut evaluated = Evaluated::zero(2 * n - 1);
        for term in terms {
            match term {
                EquationTerm::Local(row, columns, value) => {
                    let directions = columns.map(|column| column.and_then(along));
                    for (row, part) in [(row, value.value), (row + n - 1, value.by[0])] {
                        let all = columns.into_iter().chain(directions).zip(part.by);
                        evaluated.add(row, part.value, all);
                    }
                }
                EquationTerm::Minus(row, column) => {
                    evaluated.subtract(row, column, x);
                    if let Some(direction) = along(column) {
                        evaluated.subtract(row + n - 1, direction, x);
                    }
                }
            }
        }
        let last = 2 * n - 2;
        let mut sum = -Interval::ONE;
        for (index, weight) in self.normal().iter().enumerate() {
            let weight = Interval::point(*weight);
            sum = sum + weight * x[n + index];
            evaluated.jacobian[last][n + index] = weight;
        }
        evaluated.residual[last] = sum;
        Some(evaluated)
    }
}
