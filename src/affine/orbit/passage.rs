//! The passage of an orbit through a zone: where it ends, and forms of z along it with all their derivatives.

use crate::affine::flow::{TERMS, propagator};
use crate::affine::mode::{AffineMode, Row};
use crate::linalg::{Matrix, Vector};

/// A number with its derivatives in z at the entry, in time, and in the parameter at a fixed z.
#[derive(Clone, Debug, PartialEq)]
pub struct Jet {
    /// Its value.
    pub value: f64,
    /// ∂/∂z at the entry of the zone.
    pub by_z: Vector,
    /// ∂/∂t.
    pub by_time: f64,
    /// ∂/∂p.
    pub by_parameter: f64,
}

impl Jet {
    /// A form at the entry of a zone.
    pub fn at_entry(row: &Row, entry: &Vector) -> Jet {
        Jet {
            value: row.at.dot(entry),
            by_z: row.at.clone(),
            by_time: 0.0,
            by_parameter: row.by[0].dot(entry),
        }
    }

    /// The jet times a number.
    pub fn scaled(mut self, factor: f64) -> Jet {
        self.value *= factor;
        self.by_z *= factor;
        self.by_time *= factor;
        self.by_parameter *= factor;
        self
    }

    fn add(&mut self, factor: f64, other: &Jet) {
        self.value += factor * other.value;
        self.by_z.axpy(factor, &other.by_z, 1.0);
        self.by_time += factor * other.by_time;
        self.by_parameter += factor * other.by_parameter;
    }
}

/// A zone from its entry to a time.
#[derive(Clone, Debug)]
pub struct Passage<'a> {
    mode: &'a AffineMode,
    /// Norm of its matrix.
    norm: f64,
    /// z at the entry.
    pub entry: Vector,
    /// Time since.
    pub time: f64,
    /// exp(Mt).
    pub flow: Matrix,
    /// z at the time.
    pub end: Vector,
    /// ∂z/∂p there.
    by: Vector,
}

impl<'a> Passage<'a> {
    /// The passage from z through a mode whose matrix has this norm.
    pub fn new(mode: &'a AffineMode, norm: f64, entry: Vector, time: f64) -> Passage<'a> {
        let [flow, by] = propagator(&mode.matrix.at, &mode.matrix.by[0], norm, time);
        Passage {
            end: &flow * &entry,
            by: by * &entry,
            mode,
            norm,
            entry,
            time,
            flow,
        }
    }

    /// exp(−Mt).
    pub fn backward(&self) -> Matrix {
        let matrix = &self.mode.matrix.at;
        let [flow, _] = propagator(matrix, &Matrix::zeros(0, 0), self.norm, -self.time);
        flow
    }

    /// ż at the end.
    pub fn rate(&self) -> Vector {
        &self.mode.matrix.at * &self.end
    }

    /// A form at the end.
    pub fn at_end(&self, row: &Row) -> Jet {
        Jet {
            value: row.at.dot(&self.end),
            by_z: self.flow.tr_mul(&row.at),
            by_time: self.mode.matrix.at.tr_mul(&row.at).dot(&self.end),
            by_parameter: row.by[0].dot(&self.end) + row.at.dot(&self.by),
        }
    }

    /// The derivative of this order of a form.
    pub fn derivative(&self, row: &Row, order: usize) -> Row {
        (0..order).fold(row.clone(), |row, _| row.through(&self.mode.matrix))
    }

    /// q(t) = c·z(t)/tᵐ and q̇(t), where c·z has a zero of order m at the entry: its first m Taylor coefficients
    /// are left out, whatever they are. Regular at t = 0.
    pub fn divided(&self, row: &Row, order: usize) -> [Jet; 2] {
        if order > 0 && self.norm * self.time.abs() <= 1.0 {
            return self.divided_series(row, order);
        }
        // P(t) = tᵐq(t) and Ṗ(t)
        let mut forms = [row.clone(), row.through(&self.mode.matrix)].map(|row| self.at_end(&row));
        let (mut taylor, mut power) = (row.clone(), 1.0);
        let mut second = self.derivative(row, 2).at.dot(&self.end);
        // tᵏ/k!, and the powers below
        let mut before = [0.0, 0.0];
        for k in 0..order {
            let jet = Jet::at_entry(&taylor, &self.entry);
            forms[0].add(-power, &jet);
            forms[1].add(-before[0], &jet);
            second -= before[1] * jet.value;
            before = [power, before[0]];
            power *= self.time / (k + 1) as f64;
            taylor = taylor.through(&self.mode.matrix);
        }
        let [mut q, mut rate] = forms;
        let m = order as f64;
        let t = self.time;
        let divisor = t.powi(-(order as i32));
        q = q.scaled(divisor);
        rate = rate.scaled(divisor);
        if order == 0 {
            q.by_time = rate.value;
            rate.by_time = second;
            return [q, rate];
        }
        rate.add(-m / t, &q);
        q.by_time = rate.value;
        // P̈ = tᵐq̈ + 2mtᵐ⁻¹q̇ + m(m − 1)tᵐ⁻²q
        rate.by_time =
            second * divisor - 2.0 * m / t * rate.value - m * (m - 1.0) / (t * t) * q.value;
        [q, rate]
    }

    /// The same by the series, for short times.
    fn divided_series(&self, row: &Row, order: usize) -> [Jet; 2] {
        let zero = || Jet {
            value: 0.0,
            by_z: Vector::zeros(self.entry.len()),
            by_time: 0.0,
            by_parameter: 0.0,
        };
        let (mut q, mut rate, mut second) = (zero(), zero(), 0.0);
        let factorial: f64 = (1..=order).map(|k| k as f64).product();
        let mut taylor = self.derivative(row, order);
        // tʲ/k!, j = k − m, and the two powers below with the factors of their derivatives
        let mut weights = [factorial.recip(), 0.0, 0.0];
        for j in 0..=TERMS {
            let jet = Jet::at_entry(&taylor, &self.entry);
            let next = f64::from(j + 1);
            q.add(weights[0], &jet);
            rate.add(weights[1], &jet);
            second += weights[2] * jet.value;
            let k = next + order as f64;
            weights = [
                weights[0] * self.time / k,
                weights[0] * next / k,
                weights[1] * next / k,
            ];
            taylor = taylor.through(&self.mode.matrix);
        }
        q.by_time = rate.value;
        rate.by_time = second;
        [q, rate]
    }
}
