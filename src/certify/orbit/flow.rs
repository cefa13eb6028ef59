//! exp(Mt) of a mode, and forms of z along it, by power series with remainders.
//!
//! In scales D in which M is balanced, with θ = ‖D⁻¹MD‖t ≤ 1 in the norm of column sums,
//!
//! ```text
//! Σ_{k>K} ‖(Mt)ᵏ‖/k! ≤ θ^{K+1}/(K + 1)!/(1 − θ/(K + 2)),
//! Σ_{k>K} ‖∂(Mt)ᵏ/∂p‖/k! ≤ t‖∂M/∂p‖ θᴷ/K!/(1 − θ/(K + 1)).
//! ```
//!
//! A form g that is zero with its derivatives up to order m at z is tᵐ Σ gM^{k+m}tᵏ/(k + m)! times z after a time t.

use super::enclosure::Enclosure;
use super::modes::Row;
use crate::certify::arc::Moving;
use crate::interval::{Gradient, Interval, Normed, Number};
use crate::linalg::{Matrix, Vector, balance};

/// Degree K of the polynomials: 1/(K + 1)! = 4e-23.
pub const DEGREE: usize = 22;

/// A matrix of intervals, row by row.
pub type Rows = Vec<Vec<Interval>>;

/// The flow of a mode.
#[derive(Clone, Debug)]
pub struct IntervalFlow {
    /// M.
    pub matrix: Rows,
    /// ∂M/∂p.
    pub by: Rows,
    /// D.
    scales: Vector,
    /// ‖D⁻¹MD‖ and that of ∂M/∂p, from above.
    pub norm: f64,
    norm_by: f64,
}

/// exp(Mt) and its derivative in p.
#[derive(Clone, Debug)]
pub struct IntervalExponential {
    pub at: Rows,
    pub by: Rows,
}

/// A number that depends on a time and the parameter: with its derivatives in both, and with those of all these in the time.
pub type Timed = Gradient<Gradient<Interval, 1>, 2>;

/// AB.
pub fn product<N: Number>(one: &[Vec<N>], other: &[Vec<N>]) -> Vec<Vec<N>> {
    let width = other.first().map_or(0, Vec::len);
    let row = |row: &Vec<N>| {
        let mut sum = vec![N::double(0.0); width];
        let terms = row.iter().zip(other);
        for (a, row) in terms.filter(|(a, _)| !a.is_zero()) {
            for (sum, b) in sum.iter_mut().zip(row) {
                *sum = *sum + *a * *b;
            }
        }
        sum
    };
    one.iter().map(row).collect()
}

/// A + B.
pub fn sum(one: &Rows, other: &Rows) -> Rows {
    let rows = one.iter().zip(other);
    rows.map(|(one, other)| one.iter().zip(other).map(|(a, b)| *a + *b).collect())
        .collect()
}

fn scaled<N: Number>(rows: &mut [Vec<N>], factor: Interval) {
    for entry in rows.iter_mut().flatten() {
        *entry = entry.scaled(factor);
    }
}

/// I.
pub fn identity(size: usize) -> Rows {
    let row = |i: usize| (0..size).map(move |j| Interval::point(f64::from(u8::from(i == j))));
    (0..size).map(|i| row(i).collect()).collect()
}

/// θⁿ/n!/(1 − θ/(n + 1)): what a series leaves out from the power n on.
fn tail(theta: f64, n: usize) -> Interval {
    let theta = Interval::point(theta);
    let power = (1..=n).fold(Interval::ONE, |power, k| {
        power * theta / Interval::point(k as f64)
    });
    let rest = Interval::ONE - theta / Interval::point((n + 1) as f64);
    match rest.is_positive() {
        true => power / rest,
        false => Interval::ENTIRE,
    }
}

/// ‖D⁻¹MD‖ in the norm of column sums, from above.
fn norm<N: Number>(scales: &Vector, rows: &[Vec<N>]) -> f64 {
    let size = rows.len();
    let column = |j: usize| {
        let terms = (0..size).map(|i| {
            let ratio = Interval::point(scales[j]) / Interval::point(scales[i]);
            Interval::point(rows[i][j].norm()) * ratio
        });
        terms.fold(Interval::ZERO, |sum, term| sum + term).high
    };
    (0..size).map(column).fold(0.0, f64::max)
}

impl IntervalFlow {
    pub fn new(matrix: &[Row<Enclosure>]) -> IntervalFlow {
        let rows = |part: fn(&Enclosure) -> Interval| -> Rows {
            let row = |row: &Row<Enclosure>| row.iter().map(part).collect();
            matrix.iter().map(row).collect()
        };
        let (at, by) = (rows(|entry| entry.value), rows(|entry| entry.by[0]));
        let size = at.len();
        let (scales, _) = balance(&Matrix::from_fn(size, size, |i, j| at[i][j].middle()), 0.0);
        IntervalFlow {
            norm: norm(&scales, &at),
            norm_by: norm(&scales, &by),
            matrix: at,
            by,
            scales,
        }
    }

    /// Parts of a time, a power of two, in which θ is at most 1.
    pub fn parts(&self, time: Interval) -> u32 {
        let theta = self.norm * time.magnitude();
        match theta > 1.0 {
            true => (theta.log2().ceil() as u32).min(30),
            false => 0,
        }
    }

    /// exp(Mt) over 1/2ⁿ of a time ≥ 0.
    pub fn part(&self, time: Interval, halvings: u32) -> IntervalExponential {
        let size = self.matrix.len();
        let time = time * Interval::point(f64::from(halvings).exp2().recip());
        let (mut at, mut by) = (identity(size), vec![vec![Interval::ZERO; size]; size]);
        let (mut term, mut term_by) = (at.clone(), by.clone());
        for k in 1..=DEGREE {
            let factor = time / Interval::point(k as f64);
            term_by = sum(&product(&term_by, &self.matrix), &product(&term, &self.by));
            term = product(&term, &self.matrix);
            scaled(&mut term, factor);
            scaled(&mut term_by, factor);
            at = sum(&at, &term);
            by = sum(&by, &term_by);
        }
        let length = time.magnitude();
        let theta = (Interval::point(self.norm) * Interval::point(length)).high;
        let rest = tail(theta, DEGREE + 1).high;
        let rest_by = tail(theta, DEGREE) * Interval::point(length) * Interval::point(self.norm_by);
        for i in 0..size {
            for j in 0..size {
                let ratio = Interval::point(self.scales[i]) / Interval::point(self.scales[j]);
                for (entry, rest) in [(&mut at[i][j], rest), (&mut by[i][j], rest_by.high)] {
                    // what no path joins stays zero
                    let bound = (Interval::point(rest) * ratio).high;
                    *entry = *entry + Interval::new(-bound, bound);
                }
            }
        }
        IntervalExponential { at, by }
    }

    /// A form after a time t, as a form of z at its beginning, there zero with its derivatives below order m: divided by tᵐ.
    pub fn quotient(&self, form: &Row<Enclosure>, order: usize, time: Interval) -> Vec<Timed> {
        /// A remainder and all its derivatives are far below rounding.
        const NEGLIGIBLE: f64 = 1e-40;
        const HIGHEST: usize = 200;
        let lifted = |value: Interval, by: Interval| Timed {
            value: Gradient::constant(value),
            by: [Gradient::double(0.0), Gradient::constant(by)],
        };
        let rows = self.matrix.iter().zip(&self.by);
        let row = |(row, by): (&Vec<Interval>, &Vec<Interval>)| {
            let entries = row.iter().zip(by);
            entries.map(|(value, by)| lifted(*value, *by)).collect()
        };
        let matrix: Vec<Vec<Timed>> = rows.map(row).collect();
        let form = form.iter().map(|entry| lifted(entry.value, entry.by[0]));
        let form: Vec<Timed> = form.collect();
        let time = Timed {
            value: Gradient {
                value: time,
                by: [Interval::ONE],
            },
            by: [Gradient::double(1.0), Gradient::double(0.0)],
        };
        let (size, norm) = (self.size(&form), norm(&self.scales, &matrix));
        let theta = (Interval::point(norm) * Interval::point(time.norm())).high;
        let rest = |degree: usize| tail(theta, degree + 1).high;
        let mut degrees = DEGREE..HIGHEST;
        let degree = degrees.find(|degree| rest(*degree) < NEGLIGIBLE);
        let degree = degree.unwrap_or(HIGHEST);
        let mut term = vec![form];
        let mut sum = vec![Timed::double(0.0); self.scales.len()];
        for k in 1..=degree + order {
            term = product(&term, &matrix);
            let share = Interval::ONE / Interval::point(k as f64);
            for (sum, term) in sum.iter_mut().zip(&mut term[0]) {
                *term = term.scaled(share);
                if k > order {
                    *term = *term * time;
                }
                if k >= order {
                    *sum = *sum + *term;
                }
            }
        }
        let power = (0..order).fold(Interval::point(size), |power, _| {
            power * Interval::point(norm)
        });
        let rest = power * Interval::point(rest(degree));
        let entries = sum.into_iter().zip(&self.scales);
        let bound = |scale: &f64| (rest / Interval::point(*scale)).high;
        entries
            .map(|(entry, scale)| entry.widened(bound(scale)))
            .collect()
    }

    /// max |gᵢ|Dᵢ, from above.
    fn size<N: Number>(&self, row: &[N]) -> f64 {
        let sizes = row.iter().zip(&self.scales);
        let size = sizes.map(|(g, d)| (Interval::point(g.norm()) * Interval::point(*d)).high);
        size.fold(0.0, f64::max)
    }

    /// M along a curve, on which the parameter has this derivative.
    pub fn moving(&self, rate: Interval) -> Vec<Vec<Moving>> {
        let rows = self.matrix.iter().zip(&self.by);
        let row = |(at, by): (&Vec<Interval>, &Vec<Interval>)| {
            let both = at.iter().zip(by);
            both.map(|(value, by)| moving(*value, *by * rate)).collect()
        };
        rows.map(row).collect()
    }

    /// A form along the flow.
    pub fn along(&self, matrix: &[Vec<Moving>], row: &[Moving]) -> GuardCoefficients {
        let mut rows = vec![row.to_vec()];
        for k in 1..=DEGREE {
            let mut next = product(&rows[k - 1..k], matrix);
            scaled(&mut next, Interval::ONE / Interval::point(k as f64));
            rows.append(&mut next);
        }
        GuardCoefficients {
            rows,
            size: self.size(row),
            norm: norm(&self.scales, matrix),
        }
    }

    /// The polynomial of a form from z on, for times up to `length` in modulus.
    pub fn polynomial(&self, along: &GuardCoefficients, z: &[Moving], length: f64) -> Polynomial {
        let terms = z.iter().zip(&self.scales);
        let amplitude = terms.fold(Interval::ZERO, |sum, (z, d)| {
            sum + Interval::point(z.norm()) / Interval::point(*d)
        });
        Polynomial {
            coefficients: along.rows.iter().map(|row| dot(row, z)).collect(),
            theta: (Interval::point(along.norm) * Interval::point(length)).high,
            length,
            size: (amplitude * Interval::point(along.size)).high,
        }
    }
}

/// A number with its derivative along a curve.
pub fn moving(value: Interval, by: Interval) -> Moving {
    Moving { value, by: [by] }
}

impl IntervalExponential {
    /// exp(2Mt).
    pub fn doubled(&self) -> IntervalExponential {
        let IntervalExponential { at, by } = self;
        IntervalExponential {
            by: sum(&product(at, by), &product(by, at)),
            at: product(at, at),
        }
    }
}

/// Σ aᵢbᵢ.
pub fn dot<N: Number>(one: &[N], other: &[N]) -> N {
    let terms = one.iter().zip(other);
    terms.fold(N::double(0.0), |sum, (a, b)| sum + *a * *b)
}

/// gMᵏ/k!.
#[derive(Clone, Debug)]
pub struct GuardCoefficients {
    rows: Vec<Vec<Moving>>,
    size: f64,
    norm: f64,
}

/// A form over a piece of a zone: Σ cₖtᵏ, and a bound of what is left out, in the norm of numbers with derivatives.
#[derive(Clone, Debug)]
pub struct Polynomial {
    coefficients: Vec<Moving>,
    length: f64,
    theta: f64,
    size: f64,
}

impl Polynomial {
    /// Σ_{k≥m} cₖtᵏ⁻ᵐ and its derivative in t, over times up to the length in modulus.
    fn at(&self, time: Interval, m: usize) -> (Moving, Moving) {
        let terms = self.coefficients.iter().skip(m).rev();
        let zero = Moving::double(0.0);
        let (value, slope) = terms.fold((zero, zero), |(value, slope), c| {
            (value.scaled(time) + *c, slope.scaled(time) + value)
        });
        // ‖cₖ‖tᵏ ≤ size·θᵏ/k! and (k − m)‖cₖ‖tᵏ ≤ size·θ·θᵏ⁻¹/(k − 1)!
        let length = Interval::point(self.length);
        let power = (0..m).fold(Interval::point(self.size), |power, _| power / length);
        let theta = Interval::point(self.theta);
        let rest_slope = power * theta / length * tail(self.theta, DEGREE);
        (
            value.widened((power * tail(self.theta, DEGREE + 1)).high),
            slope.widened(rest_slope.high),
        )
    }

    /// f(t)/tᵐ over times, whose sign is that of f where those are not negative, or m is even.
    pub fn over(&self, time: Interval, m: usize) -> Moving {
        let middle = Interval::point(time.middle());
        let (value, _) = self.at(middle, m);
        let (_, slope) = self.at(time, m);
        value + slope.scaled(time - middle)
    }
}
