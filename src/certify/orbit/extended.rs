//! Folds, and multipliers on the unit circle: F(x, p) = 0, (Fₓ + (μ − 1)B)v = 0, ⟨ℓ, v⟩ = 1.
//!
//! B has the terms by which the cycle closes: what a perturbation is at the first entry is μ times as large after a
//! period. Of forced systems the phase is one of its components, so that perturbations are compared at equal time.
//! μ is 1 at a fold (G. Moore, A. Spence 1980), −1 where the period doubles, and e^{iθ} with unknown θ and complex
//! v at a pair. A zero is regular exactly where the fold is quadratic, or where a simple multiplier passes
//! the circle with a speed along the branch that is not zero.

use super::critical::NullVector;
use super::equations::OrbitResiduals;
use super::system::{OrbitCondition, OrbitSystem};
use crate::certify::equations::Evaluated;
use crate::interval::{Gradient, Interval};
use crate::linalg::{Factors, Matrix, Vector};

/// Steps of inverse iteration.
const ITERATIONS: usize = 3;
/// What is added to the diagonal, as parts of the largest entry: the first with which no pivot vanishes.
const SHIFTS: [f64; 3] = [1e-15, 4e-15, 16e-15];

impl OrbitSystem<'_> {
    /// The null vector of the equations next to a point, by inverse iteration.
    pub fn direction(&self, guess: &[f64]) -> Option<NullVector> {
        let (factor, directions) = match self.condition {
            OrbitCondition::Fold => ([1.0, 0.0], 1),
            OrbitCondition::Doubling | OrbitCondition::Branching => ([-1.0, 0.0], 1),
            OrbitCondition::Torus { angle } => ([angle.cos(), angle.sin()], 2),
            _ => return None,
        };
        let points: Vec<Interval> = guess.iter().copied().map(Interval::point).collect();
        let terms = self.terms(&points).ok()?;
        let orbit = guess.len() - 1;
        let units = self.units(guess);
        let mut matrix = Matrix::zeros(directions * orbit, directions * orbit);
        let mut add = |row: usize, column: usize, [re, im]: [f64; 2]| {
            for direction in 0..directions {
                matrix[(direction * orbit + row, direction * orbit + column)] += re;
            }
            if directions == 2 {
                matrix[(row, orbit + column)] -= im;
                matrix[(orbit + row, column)] += im;
            }
        };
        let rows = terms
            .entries
            .iter()
            .filter(|(row, column, _)| *row < orbit && *column < orbit);
        for (row, column, value) in rows {
            add(*row, *column, [value.middle() * units[*column], 0.0]);
        }
        for (row, column, sign) in &terms.wrap {
            let unit = sign * units[*column];
            add(*row, *column, [(factor[0] - 1.0) * unit, factor[1] * unit]);
        }
        // a matrix that is singular to the last digit, as one of a few may be that differ by roundings, is not worse than one
        // that is nearly so
        let size = matrix.amax();
        let null = |shift: f64| {
            let mut shifted = matrix.clone();
            for index in 0..shifted.nrows() {
                shifted[(index, index)] += shift * size;
            }
            let factors = Factors::new(&shifted);
            let mut vector = Vector::from_fn(directions * orbit, |i, _| 1.0 + (i % 7) as f64 / 7.0);
            for _ in 0..ITERATIONS {
                let norm = factors.solve(&mut vector).then(|| vector.norm());
                vector /= norm.filter(|norm| norm.is_normal())?;
            }
            Some(vector)
        };
        let vector = SHIFTS.into_iter().find_map(null)?;
        let part = |direction: usize| -> Vec<f64> {
            (0..orbit)
                .map(|index| vector[direction * orbit + index] * units[index])
                .collect()
        };
        let normal = |direction: usize| -> Vec<f64> {
            (0..orbit)
                .map(|index| vector[direction * orbit + index] / units[index])
                .collect()
        };
        Some(NullVector {
            factor,
            vectors: (0..directions).map(part).collect(),
            normals: (0..directions).map(normal).collect(),
            orbit,
        })
    }

    fn extended<const D: usize>(&self, critical: &NullVector, x: &[Interval]) -> Option<Evaluated> {
        let orbit = critical.orbit;
        let numbers: Vec<Gradient<Interval, D>> = (0..=orbit)
            .map(|index| Gradient {
                value: x[index],
                by: std::array::from_fn(|direction| match index < orbit {
                    true => x[critical.first(direction) + index],
                    false => Interval::ZERO,
                }),
            })
            .collect();
        let OrbitResiduals {
            residual,
            entries,
            wrap,
        } = self.terms(&numbers).ok()?;
        let size = x.len();
        let mut evaluated = Evaluated::zero(size);
        let one = |column: usize, value| std::iter::once((Some(column), value));
        for (row, value) in residual.iter().enumerate() {
            evaluated.add(row, value.value, std::iter::empty());
            for (direction, by) in value.by.iter().enumerate() {
                evaluated.add(orbit * (direction + 1) + row, *by, std::iter::empty());
            }
        }
        for (row, column, value) in entries {
            evaluated.add(row, Interval::ZERO, one(column, value.value));
            for (direction, by) in value.by.iter().enumerate() {
                let below = orbit * (direction + 1) + row;
                evaluated.add(below, Interval::ZERO, one(column, *by));
                if column < orbit {
                    let along = critical.first(direction) + column;
                    evaluated.add(below, Interval::ZERO, one(along, value.value));
                }
            }
        }
        let ([less, sine], slope) = critical.shifted(x);
        let last = size - 1;
        for (row, column, sign) in wrap {
            // ∓(μ − 1)v in its real and its imaginary part
            let minus = Interval::point(-sign);
            let (less, sine) = (less * minus, sine * minus);
            let slope = slope.map(|slope| slope * minus);
            let v: [Interval; D] = std::array::from_fn(|one| x[critical.first(one) + column]);
            for direction in 0..D {
                let below = orbit * (direction + 1) + row;
                let own = critical.first(direction) + column;
                evaluated.add(below, -(less * v[direction]), one(own, -less));
                if D == 2 {
                    let other = critical.first(1 - direction) + column;
                    let cross = if direction == 0 { sine } else { -sine };
                    evaluated.add(below, cross * v[1 - direction], one(other, cross));
                    let turn = if direction == 0 { slope[1] } else { -slope[1] };
                    let by = turn * v[1 - direction] - slope[0] * v[direction];
                    evaluated.add(below, Interval::ZERO, one(last, by));
                }
            }
        }
        Self::normalised::<D>(critical, x, &mut evaluated);
        Some(evaluated)
    }

    /// ⟨ℓ, v⟩ = 1.
    fn normalised<const D: usize>(
        critical: &NullVector,
        x: &[Interval],
        evaluated: &mut Evaluated,
    ) {
        let orbit = critical.orbit;
        let one = |column: usize, value| std::iter::once((Some(column), value));
        // ⟨ℓ, v⟩ = 1
        let first = orbit * (D + 1);
        evaluated.add(first, -Interval::ONE, std::iter::empty());
        for index in 0..orbit {
            for direction in 0..D {
                let normal = Interval::point(critical.normals[direction][index]);
                let own = critical.first(direction) + index;
                evaluated.add(first, normal * x[own], one(own, normal));
                if D == 2 {
                    let sign = if direction == 0 { 1.0 } else { -1.0 };
                    let other = critical.first(1 - direction) + index;
                    let normal = normal * Interval::point(sign);
                    evaluated.add(first + 1, normal * x[other], one(other, normal));
                }
            }
        }
    }

    /// Residual and derivatives over intervals of the unknowns.
    pub fn evaluate(&self, x: &[Interval]) -> Option<Evaluated> {
        match &self.critical {
            Some(critical) if critical.directions() == 2 => self.extended::<2>(critical, x),
            Some(critical) => self.extended::<1>(critical, x),
            None => {
                let terms = self.terms(x).ok()?;
                let mut evaluated = Evaluated::zero(x.len());
                if terms.residual.len() != x.len() {
                    return None;
                }
                for (row, value) in terms.residual.into_iter().enumerate() {
                    evaluated.add(row, value, std::iter::empty());
                }
                for (row, column, value) in terms.entries {
                    let entry = std::iter::once((Some(column), value));
                    evaluated.add(row, Interval::ZERO, entry);
                }
                Some(evaluated)
            }
        }
    }
}
