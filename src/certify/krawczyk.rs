//! One and only one zero in a box: Krawczyk's operator.
//!
//! For F with derivatives in all of a box X = m + [−r, r] and any matrix C, the operator
//!
//! ```text
//! K(X) = m − C F(m) + (I − C F′(X)) [−r, r]
//! ```
//!
//! contains every zero in X; if it lies inside X there is exactly one, and it is regular (R. Krawczyk 1969;
//! R.E. Moore 1977). C is about the inverse of F′(m) in doubles: it need not be exact.

use super::system::{Evaluated, System};
use crate::interval::Interval;
use crate::linalg::{Factors, Matrix, Vector};

/// A zero that is proven.
pub struct Zero {
    /// Where it is.
    pub at: Vec<Interval>,
    /// Share of the units of the unknowns around `middle` within which there is no other.
    pub unique: f64,
}

/// Newton steps from the first guess: it is known to 1e-9 at least, so that three reach rounding.
const NEWTON: usize = 3;
/// Widenings of the first box.
const INFLATIONS: usize = 8;
/// Uniqueness is tried in boxes of this share of the units at most, the first guess of which comes from the
/// derivatives over a box of share [`PROBE`]: they leave those at the middle in proportion to the size.
const LARGEST: f64 = 1e-2;
const PROBE: f64 = 1e-7;
/// Further boxes tried, each a quarter of the last.
const TRIES: i32 = 4;

/// Refines a guess by Newton's method, in doubles.
pub fn refined(system: &System, guess: &[f64]) -> Option<Vec<f64>> {
    let mut middle = guess.to_vec();
    for _ in 0..NEWTON {
        let (step, _) = correction(system, &middle)?;
        for (x, step) in middle.iter_mut().zip(&step) {
            *x -= step.middle();
        }
    }
    middle.iter().all(|x| x.is_finite()).then_some(middle)
}

/// C F(m), and C.
fn correction(system: &System, middle: &[f64]) -> Option<(Vec<Interval>, Matrix)> {
    let n = middle.len();
    let points: Vec<Interval> = middle.iter().copied().map(Interval::point).collect();
    let Evaluated { residual, jacobian } = system.evaluate(&points)?;
    let matrix = Matrix::from_fn(n, n, |i, j| jacobian[i][j].middle());
    let inverse = Factors::new(matrix).inverse()?;
    if inverse.iter().any(|x| !x.is_finite()) {
        return None;
    }
    let rows = 0..n;
    let step = rows.map(|i| dot((0..n).map(|j| (inverse[(i, j)], residual[j]))));
    Some((step.collect(), inverse))
}

/// Σ cᵢxᵢ.
fn dot(terms: impl Iterator<Item = (f64, Interval)>) -> Interval {
    terms
        .filter(|(c, x)| *c != 0.0 && *x != Interval::ZERO)
        .fold(Interval::ZERO, |sum, (c, x)| sum + Interval::point(c) * x)
}

/// |I − C F′(X)|, from above.
fn defect(system: &System, inverse: &Matrix, x: &[Interval]) -> Option<Matrix> {
    let n = x.len();
    let jacobian = system.evaluate(x)?.jacobian;
    let mut defect = Matrix::zeros(n, n);
    for j in 0..n {
        let column: Vec<(usize, Interval)> = (0..n)
            .map(|row| (row, jacobian[row][j]))
            .filter(|(_, entry)| *entry != Interval::ZERO)
            .collect();
        for i in 0..n {
            let unit = if i == j {
                Interval::ONE
            } else {
                Interval::ZERO
            };
            let product = dot(column
                .iter()
                .map(|(row, entry)| (inverse[(i, *row)], *entry)));
            defect[(i, j)] = (unit - product).magnitude();
        }
    }
    Some(defect)
}

/// Radius of K(X) around m: |C F(m)| + |I − C F′(X)| r, from above.
fn image(step: &[Interval], defect: &Matrix, radius: &[f64]) -> Vector {
    Vector::from_fn(step.len(), |i, _| {
        let spread = dot((0..radius.len()).map(|j| (defect[(i, j)], Interval::point(radius[j]))));
        (Interval::point(step[i].magnitude()) + spread).high
    })
}

fn boxed(middle: &[f64], radius: &[f64]) -> Vec<Interval> {
    let ends = middle.iter().zip(radius);
    ends.map(|(m, r)| Interval::around(*m, *r)).collect()
}

/// The zero next to `middle`; `units` are those of the unknowns. `None` if it is not proven.
pub fn zero(system: &System, middle: &[f64], units: &[f64]) -> Option<Zero> {
    let (step, inverse) = correction(system, middle)?;
    let inside = |image: &Vector, radius: &[f64]| image.iter().zip(radius).all(|(k, r)| k < r);
    // a box a little larger than the correction, until it is mapped into itself
    let floor = |unit: f64| f64::EPSILON * 0.125 * unit + f64::MIN_POSITIVE;
    let sizes = step.iter().zip(units);
    let mut radius: Vec<f64> = sizes
        .map(|(step, unit)| 1.01 * step.magnitude() + floor(*unit))
        .collect();
    let mut found = None;
    for _ in 0..INFLATIONS {
        let defect = defect(system, &inverse, &boxed(middle, &radius))?;
        let image = image(&step, &defect, &radius);
        if inside(&image, &radius) {
            // the zero lies in m − CF(m) ± |I − CF′|r as well, which is sharper
            let rest = self::image(&vec![Interval::ZERO; step.len()], &defect, &radius);
            let ends = middle.iter().zip(&step).zip(rest.iter());
            let at = ends
                .map(|((m, step), rest)| Interval::point(*m) - *step + Interval::new(-rest, *rest));
            found = Some(at.collect::<Vec<Interval>>());
            break;
        }
        for ((radius, image), unit) in radius.iter_mut().zip(image.iter()).zip(units) {
            *radius = 1.5 * radius.max(*image) + floor(*unit);
        }
        if radius.iter().any(|r| !r.is_finite()) {
            return None;
        }
    }
    let at = found?;
    // a larger box of another shape; the box above has one at least as large as its narrowest side
    let narrowest = radius.iter().zip(units).map(|(r, unit)| r / unit);
    let narrowest = narrowest.fold(LARGEST, f64::min);
    let share_of = |share: f64| units.iter().map(|unit| unit * share).collect::<Vec<f64>>();
    let over = |radius: &[f64]| defect(system, &inverse, &boxed(middle, radius));
    let probe = over(&share_of(PROBE)).map_or(f64::INFINITY, |defect| {
        let spread = image(&vec![Interval::ZERO; step.len()], &defect, &share_of(PROBE));
        let shares = spread.iter().zip(units).map(|(k, unit)| k / (unit * PROBE));
        shares.fold(0.0, f64::max)
    });
    let first = (0.7 * PROBE / probe).min(LARGEST);
    let unique = (0..TRIES)
        .map(|index| first * 0.25_f64.powi(index))
        .take_while(|share| *share > narrowest)
        .find(|share| {
            let radius = share_of(*share);
            over(&radius).is_some_and(|defect| inside(&image(&step, &defect, &radius), &radius))
        });
    Some(Zero {
        at,
        unique: unique.unwrap_or(narrowest),
    })
}
