//! The passage of an orbit through a zone: where it ends, and forms of z along it with all their derivatives.

use std::borrow::Cow;

use crate::affine::exponential::{TERMS, propagator};
use crate::affine::flow::MOST_PIECES;
use crate::affine::form::VARYING;
use crate::affine::mode::{AffineMode, MatrixBy, Row};
use crate::affine::recurrence::Series;
use crate::affine::series::ORDER;
use crate::affine::stiff::Splitting;
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

    /// Zero, where z has this length.
    pub fn nothing(size: usize) -> Jet {
        Jet {
            value: 0.0,
            by_z: Vector::zeros(size),
            by_time: 0.0,
            by_parameter: 0.0,
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
    /// ∂z/∂z₀, z₀ at the entry: exp(Mt) where the mode is linear.
    pub flow: Matrix,
    /// ∂z/∂p.
    by_parameter: Vector,
    /// z at the time.
    pub end: Vector,
    /// ż there.
    pub rate: Vector,
    /// Where the mode is not linear.
    numerical: Option<Numerical>,
}

/// Series of z at both ends.
#[derive(Clone, Debug)]
struct Numerical {
    first: Series,
    /// Time up to which it holds.
    length: f64,
    last: Series,
}

/// A passage through pieces of series, with its derivatives in all that vary.
#[derive(Clone, Debug)]
pub struct Integrated {
    /// ∂z/∂z₀.
    flow: Matrix,
    /// ∂z/∂p of every parameter.
    by: [Vector; VARYING],
    /// z and ż at the end.
    end: Vector,
    rate: Vector,
    /// The series at both ends, and the time up to which the first holds.
    first: Series,
    length: f64,
    last: Series,
}

impl Integrated {
    /// The passage from z through a mode that is integrated.
    pub fn new(mode: &AffineMode, entry: &Vector, time: f64) -> Integrated {
        let field = &mode.field;
        let (size, base) = (entry.len(), field.base());
        let forward = time >= 0.0;
        let series = |z: &Vector| field.series(z, ORDER, true, forward);
        let first = series(entry);
        let length = field.length(&first, time.abs(), forward);
        let mut flow = Matrix::identity(base, base);
        let mut by: [Vector; VARYING] = std::array::from_fn(|_| Vector::zeros(base));
        let (mut last, mut z, mut rest) = (first.clone(), entry.clone(), time.abs());
        let (mut pieces, mut before) = (0_u32, f64::INFINITY);
        while rest > 0.0 {
            let part = match pieces {
                0 => length,
                _ => field.length(&last, rest, forward),
            };
            // what is not finite gives a passage that is not
            pieces += 1;
            let count = f64::from(pieces) + rest / part.max(before);
            if part.is_nan() || part <= 0.0 || count > MOST_PIECES {
                by.iter_mut().for_each(|by| by.fill(f64::NAN));
                flow.fill(f64::NAN);
                break;
            }
            before = part;
            rest -= part;
            let part = part.copysign(time);
            let (along, own) = last.derivatives_of(base, part);
            flow = &along * flow;
            for (by, own) in by.iter_mut().zip(own) {
                *by = &along * &*by + own;
            }
            z = last.at(part);
            last = series(&z);
        }
        if pieces > 0 {
            z = last.first();
        }
        // what is made of other components follows them
        let (slopes, own) = last.derivatives();
        let mut all = Matrix::zeros(size, size);
        all.columns_mut(0, base).copy_from(&(&slopes * flow));
        let mut own = own.into_iter();
        Integrated {
            flow: all,
            by: by.map(|by| &slopes * by + own.next().unwrap_or_else(|| Vector::zeros(size))),
            rate: Vector::from_fn(size, |c, _| last.value(1, c)),
            end: z,
            first,
            length,
            last,
        }
    }
}

impl<'a> Passage<'a> {
    /// The passage from z through a mode whose matrix has this norm; what is slow of it, where it is stiff.
    pub fn new(
        mode: &'a AffineMode,
        norm: f64,
        stiff: Option<&Splitting>,
        entry: Vector,
        time: f64,
    ) -> Passage<'a> {
        if !mode.field.is_exact {
            let known = Integrated::new(mode, &entry, time);
            return Passage::integrated(mode, entry, (time, false), &known, 0);
        }
        let MatrixBy { at, by } = &mode.matrix;
        let (flow, by) = propagator(at, Some(&by[0]), mode.states, norm, time);
        let flow = stiff.map_or(flow, |way| way.propagator(time));
        let end = &flow * &entry;
        Passage {
            rate: at * &end,
            end,
            by_parameter: by.map_or_else(|| Vector::zeros(entry.len()), |by| by * &entry),
            flow,
            norm,
            mode,
            entry,
            time,
            numerical: None,
        }
    }

    /// The passage through a mode that is integrated; `parameter` is the place of that of its derivatives among those of
    /// the integration. At a switch conditions and resets have values, too.
    pub fn integrated(
        mode: &'a AffineMode,
        entry: Vector,
        (time, is_switch): (f64, bool),
        known: &Integrated,
        parameter: usize,
    ) -> Passage<'a> {
        let mut passage = Passage {
            flow: known.flow.clone(),
            by_parameter: known.by[parameter].clone(),
            rate: known.rate.clone(),
            end: known.end.clone(),
            norm: 0.0,
            mode,
            entry,
            time,
            numerical: Some(Numerical {
                first: known.first.in_parameter(parameter),
                length: known.length,
                last: known.last.in_parameter(parameter),
            }),
        };
        if is_switch && mode.field.ends_by_more() {
            passage.complete(parameter);
        }
        passage
    }

    /// Gives what conditions and resets are made of its values and derivatives at the end.
    fn complete(&mut self, parameter: usize) {
        let field = &self.mode.field;
        let base = field.base();
        let last = field.series_at_switch(&self.end, ORDER, self.time >= 0.0);
        let (slopes, by) = last.derivatives();
        let flow = self.flow.view((0, 0), (base, base)).into_owned();
        self.flow.columns_mut(0, base).copy_from(&(&slopes * flow));
        let own = self.by_parameter.rows(0, base).into_owned();
        self.by_parameter = slopes * own + &by[parameter];
        self.end = last.first();
        self.rate = Vector::from_fn(self.end.len(), |c, _| last.value(1, c));
        if let Some(numerical) = &mut self.numerical {
            numerical.last = last.in_parameter(parameter);
        }
    }

    /// Of a matrix for z that of the states.
    fn of_states(&self, matrix: &Matrix) -> Matrix {
        let states = self.mode.states;
        matrix.view((0, 0), (states, states)).into_owned()
    }

    /// ∂x/∂x₀ of the states x.
    pub fn forward(&self) -> Matrix {
        self.of_states(&self.flow)
    }

    /// The gradient of a form at the end, in z there.
    pub fn gradient(&self, row: &Row) -> Vector {
        match &self.numerical {
            Some(numerical) => numerical.last.jet(row, 0).1,
            None => row.at.clone(),
        }
    }

    /// The derivatives of the states after a reset in those at the end.
    pub fn slopes(&self, reset: &Matrix) -> Matrix {
        let states = reset.nrows();
        match &self.numerical {
            Some(numerical) => reset * numerical.last.derivatives().0.columns(0, states),
            None => reset.columns(0, states).into_owned(),
        }
    }

    /// A form at the end.
    pub fn at_end(&self, row: &Row) -> Jet {
        self.derivative_at_end(row, 0)
    }

    /// The derivative of this order of a form, at the end.
    pub fn derivative_at_end(&self, row: &Row, order: usize) -> Jet {
        let Some(Numerical { last, .. }) = &self.numerical else {
            return self.linear_at_end(&self.derivative(row, order));
        };
        let (value, gradient, by) = last.jet(row, order);
        let jet = Jet {
            value,
            by_time: (order + 1) as f64 * last.of(&row.at, order + 1),
            by_parameter: by + gradient.dot(&self.by_parameter),
            by_z: self.flow.tr_mul(&gradient),
        };
        jet.scaled(factorial(order))
    }

    /// A form at the end of a linear mode.
    fn linear_at_end(&self, row: &Row) -> Jet {
        Jet {
            value: row.at.dot(&self.end),
            by_z: self.flow.tr_mul(&row.at),
            by_time: row.at.dot(&self.rate),
            by_parameter: row.by[0].dot(&self.end) + row.at.dot(&self.by_parameter),
        }
    }

    /// The derivatives of a form at the entry, from an order on: so many, or as many as are known.
    pub fn derivatives_at_entry(&self, row: &Row, from: usize, count: usize) -> Vec<Jet> {
        let orders = from..from + count;
        if let Some(Numerical { first, .. }) = &self.numerical {
            let of = |order: usize| {
                let (value, by_z, by_parameter) = first.jet(row, order);
                let jet = Jet {
                    value,
                    by_z,
                    by_time: 0.0,
                    by_parameter,
                };
                jet.scaled(factorial(order))
            };
            return orders.take_while(|order| *order <= ORDER).map(of).collect();
        }
        let mut last: Option<Cow<Row>> = None;
        let of = |_| {
            let next = match &last {
                None => self.derivative(row, from),
                Some(last) => Cow::Owned(last.through(&self.mode.matrix)),
            };
            let jet = Jet::at_entry(&next, &self.entry);
            last = Some(next);
            jet
        };
        orders.map(of).collect()
    }

    /// The derivative of this order of a form of a linear mode.
    fn derivative<'r>(&self, row: &'r Row, order: usize) -> Cow<'r, Row> {
        let first = Cow::Borrowed(row);
        (0..order).fold(first, |row, _| Cow::Owned(row.through(&self.mode.matrix)))
    }

    /// Whether the time is so short that a series at the entry holds.
    fn is_short(&self) -> bool {
        match &self.numerical {
            Some(numerical) => self.time.abs() <= numerical.length,
            None => self.norm * self.time.abs() <= 1.0,
        }
    }

    /// q(t) = c·z(t)/tᵐ and q̇(t), where c·z has a zero of order m at the entry: its first m Taylor coefficients
    /// are left out, whatever they are. Regular at t = 0.
    pub fn divided(&self, row: &Row, order: usize) -> [Jet; 2] {
        if order > 0 && self.is_short() {
            return self.divided_series(row, order);
        }
        // P(t) = tᵐq(t) and Ṗ(t)
        let mut forms = match &self.numerical {
            Some(_) => [0, 1].map(|k| self.derivative_at_end(row, k)),
            None => [row, &row.through(&self.mode.matrix)].map(|row| self.linear_at_end(row)),
        };
        let mut second = forms[1].by_time;
        // tᵏ/k!, and the powers below
        let (mut power, mut before) = (1.0, [0.0, 0.0]);
        let taylor = self.derivatives_at_entry(row, 0, order);
        for (k, jet) in taylor.into_iter().enumerate() {
            forms[0].add(-power, &jet);
            forms[1].add(-before[0], &jet);
            second -= before[1] * jet.value;
            before = [power, before[0]];
            power *= self.time / (k + 1) as f64;
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
        let zero = || Jet::nothing(self.entry.len());
        let (mut q, mut rate, mut second) = (zero(), zero(), 0.0);
        // tʲ/k!, j = k − m, and the two powers below with the factors of their derivatives
        let mut weights = [factorial(order).recip(), 0.0, 0.0];
        let taylor = self.derivatives_at_entry(row, order, TERMS as usize + 1);
        for (j, jet) in taylor.into_iter().enumerate() {
            let next = (j + 1) as f64;
            q.add(weights[0], &jet);
            rate.add(weights[1], &jet);
            second += weights[2] * jet.value;
            let k = next + order as f64;
            weights = [
                weights[0] * self.time / k,
                weights[0] * next / k,
                weights[1] * next / k,
            ];
        }
        q.by_time = rate.value;
        rate.by_time = second;
        [q, rate]
    }
}

fn factorial(k: usize) -> f64 {
    (1..=k).map(|k| k as f64).product()
}
