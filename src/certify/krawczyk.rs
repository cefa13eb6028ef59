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

use super::equations::Evaluated;
use crate::interval::Interval;
use crate::linalg::{Factors, Matrix, Vector};

/// A zero that is proven.
pub struct ProvenZero {
    pub at: Vec<Interval>,
    /// C F(m), C, and the radius of the box that is mapped into itself.
    step: Vec<Interval>,
    inverse: Matrix,
    radius: Vec<f64>,
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

/// Equations with their derivatives over intervals of the unknowns.
pub trait IntervalEquations: Fn(&[Interval]) -> Option<Evaluated> {}

impl<F: Fn(&[Interval]) -> Option<Evaluated>> IntervalEquations for F {}

/// Refines a guess by Newton's method, in doubles.
pub fn refined(equations: &impl IntervalEquations, guess: &[f64]) -> Option<Vec<f64>> {
    let mut middle = guess.to_vec();
    for _ in 0..NEWTON {
        let Evaluated { residual, jacobian } = equations(&points(&middle))?;
        let n = middle.len();
        let mut step = Vector::from_fn(n, |i, _| residual[i].middle());
        let matrix = Matrix::from_fn(n, n, |i, j| jacobian[i][j].middle());
        if !Factors::new(&matrix).solve(&mut step) {
            return None;
        }
        for (x, step) in middle.iter_mut().zip(step.iter()) {
            *x -= step;
        }
    }
    middle.iter().all(|x| x.is_finite()).then_some(middle)
}

fn points(middle: &[f64]) -> Vec<Interval> {
    middle.iter().copied().map(Interval::point).collect()
}

fn correction(
    equations: &impl IntervalEquations,
    middle: &[f64],
) -> Option<(Vec<Interval>, Matrix)> {
    let n = middle.len();
    let Evaluated { residual, jacobian } = equations(&points(middle))?;
    let matrix = Matrix::from_fn(n, n, |i, j| jacobian[i][j].middle());
    let inverse = Factors::new(&matrix).inverse()?;
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
fn defect(equations: &impl IntervalEquations, inverse: &Matrix, x: &[Interval]) -> Option<Matrix> {
    Some(defect_of(inverse, &equations(x)?.jacobian))
}

fn defect_of(inverse: &Matrix, jacobian: &[Vec<Interval>]) -> Matrix {
    let n = jacobian.len();
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
    defect
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

fn inside(image: &Vector, radius: &[f64]) -> bool {
    image.iter().zip(radius).all(|(k, r)| k < r)
}

/// The zero next to `middle`; `units` are those of the unknowns. `None` if it is not proven.
pub fn enclosed(
    equations: &impl IntervalEquations,
    middle: &[f64],
    units: &[f64],
) -> Option<ProvenZero> {
    let (step, inverse) = correction(equations, middle)?;
    // a box a little larger than the correction, until it is mapped into itself
    let floor = |unit: f64| f64::EPSILON * 0.125 * unit + f64::MIN_POSITIVE;
    let sizes = step.iter().zip(units);
    let mut radius: Vec<f64> = sizes
        .map(|(step, unit)| 1.01 * step.magnitude() + floor(*unit))
        .collect();
    let still = vec![Interval::ZERO; step.len()];
    for _ in 0..INFLATIONS {
        let defect = defect(equations, &inverse, &boxed(middle, &radius))?;
        let image = image(&step, &defect, &radius);
        if inside(&image, &radius) {
            // the zero lies in m − CF(m) ± |I − CF′|r as well, which is sharper
            let rest = self::image(&still, &defect, &radius);
            let ends = middle.iter().zip(&step).zip(rest.iter());
            let at = ends
                .map(|((m, step), rest)| Interval::point(*m) - *step + Interval::new(-rest, *rest));
            return Some(ProvenZero {
                at: at.collect(),
                step,
                inverse,
                radius,
            });
        }
        for ((radius, image), unit) in radius.iter_mut().zip(image.iter()).zip(units) {
            *radius = 1.5 * radius.max(*image) + floor(*unit);
        }
        if radius.iter().any(|r| !r.is_finite()) {
            return None;
        }
    }
    None
}

/// The zero next to `middle`, where that is known to a share of the units; else it is not the one that is meant.
pub fn known(
    equations: &impl IntervalEquations,
    middle: &[f64],
    units: &[f64],
    share: f64,
) -> Option<ProvenZero> {
    let zero = enclosed(equations, middle, units)?;
    let mut numbers = middle.iter().zip(&zero.at).zip(units);
    let near =
        numbers.all(|((m, x), unit)| Interval::around(*m, share * unit).contains(x.middle()));
    near.then_some(zero)
}

impl ProvenZero {
    /// Distance of the unknown `index` within which, and the same share of the other units, there is no other: it is looked for,
    /// or is a stored one, in whose place 0 is where that does not hold.
    pub fn distance(
        &self,
        equations: &impl IntervalEquations,
        middle: &[f64],
        units: &[f64],
        index: usize,
        stored: Option<f64>,
    ) -> f64 {
        let unit = units[index];
        match stored {
            None => self.unique(equations, middle, units) * unit,
            Some(stored) if self.is_unique(equations, middle, units, stored / unit) => stored,
            Some(_) => 0.0,
        }
    }

    /// Share of the units of the unknowns around `middle` within which there is no other: that of a larger box
    /// of another shape. The box of the zero has one at least as large as its narrowest side.
    fn unique(&self, equations: &impl IntervalEquations, middle: &[f64], units: &[f64]) -> f64 {
        let narrowest = self.narrowest(units);
        let share_of = |share: f64| units.iter().map(|unit| unit * share).collect::<Vec<f64>>();
        let over = |radius: &[f64]| defect(equations, &self.inverse, &boxed(middle, radius));
        let still = vec![Interval::ZERO; middle.len()];
        let probe = over(&share_of(PROBE)).map_or(f64::INFINITY, |defect| {
            let spread = image(&still, &defect, &share_of(PROBE));
            let shares = spread.iter().zip(units).map(|(k, unit)| k / (unit * PROBE));
            shares.fold(0.0, f64::max)
        });
        let first = (0.7 * PROBE / probe).min(LARGEST);
        (0..TRIES)
            .map(|index| first * 0.25_f64.powi(index))
            .take_while(|share| *share > narrowest)
            .find(|share| self.holds(equations, middle, &share_of(*share)))
            .unwrap_or(narrowest)
    }

    fn narrowest(&self, units: &[f64]) -> f64 {
        let sides = self.radius.iter().zip(units).map(|(r, unit)| r / unit);
        sides.fold(LARGEST, f64::min)
    }

    /// Whether within a share of the units, up to the largest that is tried, there is no other.
    fn is_unique(
        &self,
        equations: &impl IntervalEquations,
        middle: &[f64],
        units: &[f64],
        share: f64,
    ) -> bool {
        let radius: Vec<f64> = units.iter().map(|unit| unit * share).collect();
        let known = share >= 0.0 && share <= self.narrowest(units);
        known || share <= LARGEST * (1.0 + 1e-9) && self.holds(equations, middle, &radius)
    }

    /// Whether a box around `middle` has no other zero.
    fn holds(&self, equations: &impl IntervalEquations, middle: &[f64], radius: &[f64]) -> bool {
        let defect = defect(equations, &self.inverse, &boxed(middle, radius));
        defect.is_some_and(|defect| inside(&image(&self.step, &defect, radius), radius))
    }
}

/// Linear equations with a matrix of intervals.
pub struct LinearEquations {
    inverse: Matrix,
    defect: Matrix,
}

impl LinearEquations {
    /// `None` if it has no inverse in doubles.
    pub fn new(matrix: &[Vec<Interval>]) -> Option<LinearEquations> {
        let n = matrix.len();
        let middle = Matrix::from_fn(n, n, |i, j| matrix[i][j].middle());
        let inverse = Factors::new(&middle).inverse()?;
        let defect = defect_of(&inverse, matrix);
        Some(LinearEquations { inverse, defect })
    }

    /// Encloses the one solution for every matrix and right side in the intervals: x = Cb + (I − CA)x. `None` if it is not known to be
    /// the only one.
    pub fn solve(&self, side: &[Interval]) -> Option<Vec<Interval>> {
        let n = side.len();
        let about = |i: usize| dot((0..n).map(|j| (self.inverse[(i, j)], side[j])));
        let about: Vec<Interval> = (0..n).map(about).collect();
        let still = vec![Interval::ZERO; n];
        let mut size: Vec<f64> = about
            .iter()
            .map(|x| 1.1 * x.magnitude() + f64::MIN_POSITIVE)
            .collect();
        for round in 0..2 * INFLATIONS {
            let image = image(&about, &self.defect, &size);
            if inside(&image, &size) {
                let rest = self::image(&still, &self.defect, &size);
                let both = about.iter().zip(rest.iter());
                return Some(both.map(|(x, r)| *x + Interval::new(-r, *r)).collect());
            }
            for (size, image) in size.iter_mut().zip(image.iter()) {
                // where all grow alike what is zero stays behind the others: at last only what is too small grows
                if round < INFLATIONS || image >= size {
                    *size = 1.5 * size.max(*image);
                }
            }
        }
        None
    }
}

/// Whether a box around the zero next to `middle` has no other: a larger one is mapped into itself.
pub fn is_only_zero(equations: &impl IntervalEquations, middle: &[f64], x: &[Interval]) -> bool {
    let Some((step, inverse)) = correction(equations, middle) else {
        return false;
    };
    let reach = x.iter().zip(middle);
    let mut radius: Vec<f64> = reach
        .map(|(x, m)| (*x - Interval::point(*m)).magnitude() + f64::MIN_POSITIVE)
        .collect();
    for _ in 0..INFLATIONS {
        let Some(defect) = defect(equations, &inverse, &boxed(middle, &radius)) else {
            return false;
        };
        let image = image(&step, &defect, &radius);
        if inside(&image, &radius) {
            return true;
        }
        for (radius, image) in radius.iter_mut().zip(image.iter()) {
            *radius = radius.max(1.1 * image);
        }
    }
    false
}

/// A chord of a curve, with one of the unknowns as its coordinate.
pub struct Chord {
    /// κ.
    pub coordinate: usize,
    pub middle: Vec<f64>,
    /// t, with t_κ = 1.
    pub slope: Vec<f64>,
    /// h: |x_κ − m_κ| ≤ h on the chord.
    pub reach: f64,
}

impl Chord {
    /// The chord between two points, a little longer at both ends.
    pub fn between(from: &[f64], to: &[f64], coordinate: usize) -> Chord {
        const LONGER: f64 = 1.0 + 1e-6;
        let length = to[coordinate] - from[coordinate];
        let both = from.iter().zip(to);
        let mut slope: Vec<f64> = both.clone().map(|(a, b)| (b - a) / length).collect();
        slope[coordinate] = 1.0;
        Chord {
            coordinate,
            middle: both.map(|(a, b)| 0.5 * a + 0.5 * b).collect(),
            slope,
            reach: 0.5 * length.abs() * LONGER,
        }
    }

    /// Intervals of a tube around it.
    pub fn hull(&self, radius: &[f64]) -> Vec<Interval> {
        let along = Interval::new(-self.reach, self.reach);
        let numbers = self.middle.iter().zip(&self.slope).zip(radius);
        let hull =
            numbers.map(|((m, t), r)| Interval::around(*m, *r) + along * Interval::point(*t));
        hull.collect()
    }
}

/// Radius of a tube around a chord in which there is exactly one solution for every value of the coordinate, at
/// least `narrowest`. The last equation is that of the coordinate.
pub fn tube(
    equations: &impl IntervalEquations,
    chord: &Chord,
    narrowest: &[f64],
) -> Option<Vec<f64>> {
    let n = chord.middle.len();
    let (step, inverse) = correction(equations, &chord.middle)?;
    let reach = Interval::point(chord.reach);
    let mut radius = narrowest.to_vec();
    for _ in 0..INFLATIONS {
        let x = chord.hull(&radius);
        let jacobian = equations(&x)?.jacobian;
        // C J t h, without the equation of the coordinate
        let drift: Vec<Interval> = (0..n - 1)
            .map(|row| {
                dot((0..n).map(|column| (chord.slope[column], jacobian[row][column]))) * reach
            })
            .collect();
        let moved = |i: usize| dot((0..n - 1).map(|row| (inverse[(i, row)], drift[row])));
        let ends: Vec<Interval> = (0..n)
            .map(|i| {
                let size = step[i].magnitude() + moved(i).magnitude();
                Interval::point(size.next_up())
            })
            .collect();
        let image = image(&ends, &defect_of(&inverse, &jacobian), &radius);
        if inside(&image, &radius) {
            return Some(radius);
        }
        for (radius, image) in radius.iter_mut().zip(image.iter()) {
            *radius = radius.max(1.25 * image);
        }
        if radius.iter().any(|r| !r.is_finite()) {
            return None;
        }
    }
    None
}
