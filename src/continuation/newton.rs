//! Newton's method for a system of n equations in n + 1 unknowns closed by one constraint.

use std::cell::Cell;

use serde::{Deserialize, Serialize};

use crate::linalg::{Factors, Matrix, Vector, even, pseudo_inverse};

/// n equations R(u) = 0 in n + 1 unknowns, scaled so that unknowns and residuals are of order one.
pub trait Equations {
    /// Why the system could not be evaluated at a point.
    type Failure: std::error::Error;

    /// Whether evaluations take most of the time, and what was found at a point is kept for whoever looks at it next: a step then
    /// begins where the curve bends to, and Newton's method leaves a point where it is once it is known but for rounding.
    const KEEPS: bool = false;

    /// Whether R has kinks, as an absolute value has: the curve may turn at a point then.
    fn has_kinks(&self) -> bool {
        false
    }

    /// Number n + 1 of unknowns; the last of them is the continuation parameter.
    fn unknowns(&self) -> usize;

    /// Writes R (length n) and its Jacobian (n rows at least, n + 1 columns). Entries of further
    /// rows must be left alone; the Jacobian comes filled with zeros.
    fn evaluate(
        &self,
        point: &Vector,
        residual: &mut [f64],
        jacobian: &mut Matrix,
    ) -> Result<(), Self::Failure>;
}

/// The equation that closes the system.
pub trait Constraint<S: Equations> {
    /// Value at `point`; writes the gradient, which comes filled with zeros.
    fn evaluate(
        &mut self,
        system: &S,
        point: &Vector,
        gradient: &mut [f64],
    ) -> Result<f64, S::Failure>;
}

/// t·(u − u₀) = 0: the plane through a predicted point across the tangent (pseudo-arclength).
#[derive(Clone, Copy, Debug)]
pub struct Plane<'a> {
    /// Normal of the plane.
    pub normal: &'a Vector,
    /// A point of the plane.
    pub through: &'a Vector,
}

impl<S: Equations> Constraint<S> for Plane<'_> {
    fn evaluate(&mut self, _: &S, point: &Vector, gradient: &mut [f64]) -> Result<f64, S::Failure> {
        gradient.copy_from_slice(self.normal.as_slice());
        Ok(self
            .normal
            .iter()
            .zip(point.iter().zip(self.through.iter()))
            .map(|(normal, (here, there))| normal * (here - there))
            .sum())
    }
}

/// u_index = value.
#[derive(Clone, Copy, Debug)]
pub struct Fixed {
    /// Index of the unknown.
    pub index: usize,
    /// Its value.
    pub value: f64,
}

impl<S: Equations> Constraint<S> for Fixed {
    fn evaluate(&mut self, _: &S, point: &Vector, gradient: &mut [f64]) -> Result<f64, S::Failure> {
        gradient[self.index] = 1.0;
        Ok(point[self.index] - self.value)
    }
}

/// Tolerances of Newton's method.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Largest component of the last correction, relative to the scaled unknowns of order one.
    /// Convergence is quadratic: a last correction of 1e-10 leaves an error near 1e-20.
    pub tolerance: f64,
    /// Iterations after which the attempt is given up.
    pub most_iterations: usize,
    /// How often a correction may be halved to make the residual fall. None within a continuation
    /// step, where a shorter step is the better remedy.
    pub halvings: usize,
    /// Iterations done after the tolerance was met, to take out the last rounding; the point is moved by the last of them whatever it is.
    pub polish: usize,
}

impl Default for Settings {
    fn default() -> Self {
        Settings {
            tolerance: 1e-10,
            most_iterations: 8,
            halvings: 0,
            polish: 0,
        }
    }
}

/// A solution.
#[derive(Clone, Debug)]
pub struct Solution {
    /// The point.
    pub point: Vector,
    /// Iterations spent.
    pub iterations: usize,
    /// Largest ratio of two successive corrections; 0 if one iteration was enough.
    pub contraction: f64,
    /// Largest component of the last correction.
    pub correction: f64,
    /// Largest relative residual before the last correction.
    pub residual: f64,
    /// LU factors of the bordered Jacobian at the iterate before the last correction.
    pub factors: Factors,
}

/// How an attempt failed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, thiserror::Error)]
pub enum Failure<F: std::error::Error> {
    /// The system could not be evaluated.
    #[error("{0}")]
    System(F),
    /// The bordered Jacobian is singular.
    #[error("the Newton matrix is singular")]
    Singular,
    /// Corrections do not shrink.
    #[error("Newton's corrections do not shrink: {correction:e} after {iterations} iterations")]
    Slow {
        /// Largest component of the last correction.
        correction: f64,
        /// Iterations spent.
        iterations: usize,
    },
}

/// The bordered system at one point.
pub struct Bordered {
    /// Its Jacobian.
    pub matrix: Matrix,
    /// Its residual.
    pub right_side: Vector,
}

thread_local! {
    static EVALUATIONS: Cell<u64> = const { Cell::new(0) };
}

/// How many bordered systems have been evaluated on this thread: a measure of work that is the same on every machine.
pub(crate) fn evaluations() -> u64 {
    EVALUATIONS.with(Cell::get)
}

/// The system together with a constraint at a point.
///
/// # Errors
/// One of them cannot be evaluated there.
pub fn bordered<S: Equations>(
    system: &S,
    constraint: &mut impl Constraint<S>,
    point: &Vector,
) -> Result<Bordered, S::Failure> {
    EVALUATIONS.with(|count| count.set(count.get() + 1));
    let n = system.unknowns();
    let mut matrix = Matrix::zeros(n, n);
    let mut right_side = Vector::zeros(n);
    system.evaluate(point, &mut right_side.as_mut_slice()[..n - 1], &mut matrix)?;
    let mut gradient = vec![0.0; n];
    right_side[n - 1] = constraint.evaluate(system, point, &mut gradient)?;
    for (column, value) in gradient.into_iter().enumerate() {
        matrix[(n - 1, column)] = value;
    }
    Ok(Bordered { matrix, right_side })
}

/// Residuals below this, relative to their rows, are rounding. At the stiff end, c² → a, a change of
/// c in its last place moves other unknowns by more than the tolerance, and corrections stop
/// shrinking there; [`Solution::correction`] then says how well the unknowns are known.
const ROUNDED: f64 = 1e-13;

/// Unknowns of order one known no better than this are no solution.
const MOST_ROUNDED: f64 = 1e-6;

/// Largest noise seen in each equation: what its values a few hundred roundings beside a point differ
/// from the linear ones. Cancellation inside an equation shows here, not in its derivatives.
/// `None` where it cannot be evaluated.
pub fn noise<S: Equations>(system: &S, matrix: &Matrix, point: &Vector) -> Option<Vector> {
    const SAMPLES: usize = 8;
    let n = system.unknowns();
    let value = |point: &Vector| {
        let evaluated = evaluated(system, point).ok();
        evaluated.map(|(_, residual)| residual)
    };
    let here = value(point)?;
    let mut noise = Vector::zeros(n);
    for sample in 1..=SAMPLES {
        let mut places = even(sample);
        let beside = Vector::from_fn(n, |unknown, _| {
            let place = places.next().unwrap_or_default();
            point[unknown] * (1.0 + 1024.0 * f64::EPSILON * (place - 0.5))
        });
        let moved = value(&beside)? - &here - matrix.rows(0, n - 1) * (&beside - point);
        for (largest, moved) in noise.iter_mut().zip(moved.iter()) {
            *largest = moved.abs().max(*largest);
        }
    }
    Some(noise)
}

/// First-order bound of what rounding leaves at a solution: |J⁻¹| times the rounding of each equation, which is that of the
/// unknowns it is formed from and, where asked for, thrice the largest noise seen. Of more equations than unknowns it is that of
/// least squares.
pub struct Rounding<'a> {
    inverse: Matrix,
    formed: Vector,
    noise: Option<&'a Vector>,
}

impl Rounding<'_> {
    /// Where the equations have this Jacobian, for unknowns of these sizes; `None` where it is singular.
    pub fn new<'a>(
        matrix: &Matrix,
        sizes: &Vector,
        noise: Option<&'a Vector>,
    ) -> Option<Rounding<'a>> {
        let inverse = if matrix.is_square() {
            Factors::new(matrix).inverse()?
        } else {
            pseudo_inverse(matrix, f64::EPSILON)?
        };
        let formed = Vector::from_fn(matrix.nrows(), |row, _| {
            let columns = 0..sizes.len();
            columns
                .map(|column| matrix[(row, column)].abs() * sizes[column])
                .sum()
        });
        Some(Rounding {
            inverse,
            formed,
            noise,
        })
    }

    /// That of what changes by so much with each equation.
    fn through(&self, by: impl Iterator<Item = f64> + Clone) -> f64 {
        /// Operations behind one residual, each of which may round.
        const OPERATIONS: f64 = 8.0;
        let share = |residuals: &Vector| -> f64 {
            let shares = by.clone().zip(residuals);
            shares.map(|(by, residual)| by.abs() * residual).sum()
        };
        let seen = self.noise.map_or(0.0, |noise| 3.0 * share(noise));
        OPERATIONS * f64::EPSILON * share(&self.formed) + seen
    }

    /// That of every unknown.
    pub fn of_unknowns(&self) -> Vector {
        Vector::from_fn(self.inverse.nrows(), |unknown, _| {
            self.through(self.inverse.row(unknown).iter().copied())
        })
    }

    /// That of a function with this gradient. What the unknowns are off together may leave it as it is.
    pub fn of(&self, gradient: &Vector) -> f64 {
        let by = self.inverse.tr_mul(gradient);
        self.through(by.iter().copied())
    }
}

/// That of every unknown: [`Rounding`].
pub fn rounding(matrix: &Matrix, sizes: &Vector, noise: Option<&Vector>) -> Option<Vector> {
    Some(Rounding::new(matrix, sizes, noise)?.of_unknowns())
}

/// Corrections below this are rounding of unknowns of order one, times a condition of a few hundred:
/// a smaller tolerance would compare rounding with rounding.
const LEAST_TOLERANCE: f64 = 1e-13;

/// A correction of unknowns of order one below this is rounding, and so is one below [`LEAST_TOLERANCE`] that comes of residuals that
/// are, relative to their rows: unless a polish is asked for, a point of a system that keeps it is left where it is.
const UNMOVED: f64 = 4.0 * f64::EPSILON;

/// Unknowns larger than the inverse of this are not of order one.
const FAR: f64 = 0.1;

/// The largest component of a correction, of unknowns that are far from order one relative to them. One of these does not excuse
/// what the others are off by.
fn far_ones_relative(step: &Vector, point: &Vector) -> f64 {
    let pairs = step.iter().zip(point);
    let sizes = pairs.map(|(step, x)| step.abs() / (FAR * x.abs()).max(1.0));
    sizes.fold(0.0, f64::max)
}

/// Solves R(u) = 0 together with the constraint, from a guess.
pub fn solve<S: Equations>(
    system: &S,
    constraint: &mut impl Constraint<S>,
    guess: &Vector,
    settings: &Settings,
) -> Result<Solution, Failure<S::Failure>> {
    let mut point = guess.clone();
    let mut contraction = 0.0_f64;
    let (mut before, mut residual_before) = (f64::INFINITY, f64::INFINITY);
    let mut polish = settings.polish;
    let mut stuck = 0;
    let tolerance = settings.tolerance.max(LEAST_TOLERANCE);
    let mut at = bordered(system, constraint, &point).map_err(Failure::System)?;
    for iterations in 1..=settings.most_iterations {
        let factors = Factors::new(&at.matrix);
        let mut step = at.right_side.clone();
        if !factors.solve(&mut step) {
            return Err(Failure::Singular);
        }
        let correction = far_ones_relative(&step, &point);
        let slow = Failure::Slow {
            correction,
            iterations,
        };
        let solution = |point: Vector, residual: f64, contraction: f64| Solution {
            point,
            iterations,
            contraction,
            correction,
            residual,
            factors,
        };
        let relative = || relative_residual(&at.matrix, at.right_side.as_slice());
        // corrections at the level of rounding no longer contract
        if iterations > 1 && correction > tolerance {
            let ratio = correction / before;
            if ratio > SLOWEST
                && let Some(residual) = rounded(system, &at, &point, step.amax())
            {
                return Ok(solution(point, residual, contraction));
            }
            // where an equation has little to do with an unknown, as that of a fold of small orbits with the parameters, what the
            // others leave there is a large correction, but it converges as the residuals do
            let fallen = || (at.right_side.amax() / residual_before).sqrt();
            let ratio = if ratio > SLOWEST {
                ratio.min(fallen())
            } else {
                ratio
            };
            // of what rounding makes of equations that hold a ratio says nothing
            if ratio > contraction && relative() >= ROUNDED {
                contraction = ratio;
            }
            if ratio > SLOWEST && settings.halvings == 0 {
                return Err(slow);
            }
        }
        (before, residual_before) = (correction, at.right_side.amax());
        if correction <= tolerance {
            // where a point stays as it is, what was found there holds for whoever looks at it next
            let residual = relative();
            let is_rounding =
                correction <= UNMOVED || residual <= UNMOVED && correction <= LEAST_TOLERANCE;
            let is_moved = !S::KEEPS || settings.polish > 0 || !is_rounding;
            if is_moved {
                point -= &step;
            }
            if polish == 0 {
                return Ok(solution(point, residual, contraction));
            }
            polish -= 1;
            at = bordered(system, constraint, &point).map_err(Failure::System)?;
            continue;
        }
        let residual = at.right_side.amax();
        let damped = damped(
            system,
            constraint,
            (&point, residual),
            &step,
            settings.halvings,
        );
        let Some(next) = damped.map_err(Failure::System)? else {
            return Err(slow);
        };
        let falls = next.1.right_side.amax() < residual;
        stuck += usize::from(settings.halvings > 0 && !falls);
        if stuck > MOST_STUCK {
            return Err(slow);
        }
        (point, at) = next;
    }
    Err(Failure::Slow {
        correction: before,
        iterations: settings.most_iterations,
    })
}

/// The relative residual at a point from which a correction is nothing but rounding; `None` where it is more. There
/// the equations hold to rounding: what is left moves the unknowns and nothing else.
fn rounded<S: Equations>(
    system: &S,
    at: &Bordered,
    point: &Vector,
    correction: f64,
) -> Option<f64> {
    let relative = relative_residual(&at.matrix, at.right_side.as_slice());
    let bounded = || {
        let noise = noise(system, &at.matrix, point)?;
        let bound = rounding(&at.matrix, &point.abs(), Some(&noise))?.amax();
        Some(correction <= bound && bound <= MOST_ROUNDED)
    };
    let small = correction <= MOST_ROUNDED;
    (relative < ROUNDED || small && bounded() == Some(true)).then_some(relative)
}

/// The point after a step, or after as much of it as makes the residual fall within so many halvings; after the
/// last one any finite residual will do, and where none is there is no point. Without halvings the whole step.
///
/// # Errors
/// The system cannot be evaluated after the last halving.
fn damped<S: Equations>(
    system: &S,
    constraint: &mut impl Constraint<S>,
    (point, residual): (&Vector, f64),
    step: &Vector,
    halvings: usize,
) -> Result<Option<(Vector, Bordered)>, S::Failure> {
    let mut factor = 1.0;
    for left in (0..=halvings).rev() {
        let trial = point - step * factor;
        match bordered(system, constraint, &trial) {
            Ok(next) => {
                let there = next.right_side.amax();
                if halvings == 0 || there < residual || left == 0 && there.is_finite() {
                    return Ok(Some((trial, next)));
                }
            }
            Err(failure) if left == 0 => return Err(failure),
            Err(_) => {}
        }
        factor *= 0.5;
    }
    Ok(None)
}

/// A correction larger than this fraction of the last one ends an undamped attempt: Newton's
/// method close to a solution contracts quadratically.
const SLOWEST: f64 = 0.5;

/// Iterations of a damped attempt in which no halving makes the residual fall: after more it is given up.
const MOST_STUCK: usize = 4;

/// Largest residual, each relative to the largest entry of its row of the Jacobian where that is
/// above one: a zone with strong growth multiplies the rounding of its entry state, and its
/// equations by the same factor.
pub fn relative_residual(matrix: &Matrix, residual: &[f64]) -> f64 {
    residual
        .iter()
        .enumerate()
        .fold(0.0, |worst, (row, value)| {
            // no row makes it larger
            if value.abs() > worst {
                worst.max(value.abs() / matrix.row(row).amax().max(1.0))
            } else {
                worst
            }
        })
}

/// Jacobian of the system alone, n × (n+1), and its residual.
pub fn evaluated<S: Equations>(system: &S, point: &Vector) -> Result<(Matrix, Vector), S::Failure> {
    let n = system.unknowns();
    let mut matrix = Matrix::zeros(n - 1, n);
    let mut residual = Vector::zeros(n - 1);
    system.evaluate(point, residual.as_mut_slice(), &mut matrix)?;
    Ok((matrix, residual))
}

/// Jacobian of the system alone, n × (n+1), and the largest relative residual.
pub fn jacobian<S: Equations>(system: &S, point: &Vector) -> Result<(Matrix, f64), S::Failure> {
    let (matrix, residual) = evaluated(system, point)?;
    let size = relative_residual(&matrix, residual.as_slice());
    Ok((matrix, size))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::continuation::circle::UnitCircle;

    /// x_i² = x_{i+1} + 2 in 300 unknowns, the last of them given: as large as a wave with many zones.
    struct Chain;

    impl Equations for Chain {
        type Failure = std::convert::Infallible;

        fn unknowns(&self) -> usize {
            300
        }

        fn evaluate(
            &self,
            point: &Vector,
            residual: &mut [f64],
            jacobian: &mut Matrix,
        ) -> Result<(), Self::Failure> {
            for index in 0..299 {
                residual[index] = point[index].powi(2) - point[index + 1] - 2.0;
                jacobian[(index, index)] = 2.0 * point[index];
                jacobian[(index, index + 1)] = -1.0;
            }
            Ok(())
        }
    }

    #[test]
    fn solves_systems_of_any_size() {
        let mut constraint = Fixed {
            index: 299,
            value: 2.0,
        };
        let guess = Vector::from_element(300, 2.1);
        let solution = solve(&Chain, &mut constraint, &guess, &Settings::default()).unwrap();
        assert!(solution.point.iter().all(|x| (x - 2.0).abs() < 1e-14));
        // a residual beyond the first hundreds counts too
        let mut residual = vec![0.0; 299];
        residual[298] = 1.0;
        let size = relative_residual(&Matrix::identity(299, 300), &residual);
        assert_eq!(size, 1.0);
    }

    #[test]
    fn converges_quadratically_and_refuses_the_impossible() {
        let guess = Vector::from_vec(vec![0.7, 0.6]);
        let mut constraint = Fixed {
            index: 1,
            value: 0.6,
        };
        let solution = solve(&UnitCircle, &mut constraint, &guess, &Settings::default()).unwrap();
        assert!((solution.point[0] - 0.8).abs() <= f64::EPSILON);
        assert!(solution.iterations <= 5);

        let mut outside = Fixed {
            index: 1,
            value: 1.5,
        };
        assert!(solve(&UnitCircle, &mut outside, &guess, &Settings::default()).is_err());
    }
}
