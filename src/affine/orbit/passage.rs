//! The passage of an orbit through a zone: where it ends, and forms of z along it with all their derivatives.

use std::borrow::Cow;
use std::ops::Range;

use crate::affine::dual::VARYING;
use crate::affine::exponential::{TERMS, propagator};
use crate::affine::flow::{MOST_PIECES, counted};
use crate::affine::mode::{AffineMode, MatrixBy, Row};
use crate::affine::recurrence::{Series, in_order};
use crate::affine::series::ORDER;
use crate::affine::stiff::Splitting;
use crate::linalg::{Matrix, Vector, add_product, product};

/// A number with its derivatives in z at the beginning of a shot of a zone, in the time since, and in the parameters that vary, at
/// a fixed z.
#[derive(Clone, Debug, PartialEq)]
pub struct Jet {
    /// Its value.
    pub value: f64,
    /// The shot.
    pub shot: usize,
    /// ∂/∂z at the beginning of the shot.
    pub by_z: Vector,
    /// ∂/∂t.
    pub by_time: f64,
    /// ∂/∂p of every parameter.
    pub by: [f64; VARYING],
}

impl Jet {
    /// A form at the entry of a zone.
    pub fn at_entry(row: &Row, entry: &Vector) -> Jet {
        Jet {
            value: row.at.dot(entry),
            shot: 0,
            by_z: row.at.clone(),
            by_time: 0.0,
            by: row.by.each_ref().map(|by| by.dot(entry)),
        }
    }

    /// A component of z at the entry of a zone.
    pub fn of_component(component: usize, entry: &Vector) -> Jet {
        let mut by_z = Vector::zeros(entry.len());
        by_z[component] = 1.0;
        Jet {
            value: entry[component],
            shot: 0,
            by_z,
            by_time: 0.0,
            by: [0.0; VARYING],
        }
    }

    /// The same at the beginning of a shot.
    pub fn of_shot(self, shot: usize) -> Jet {
        Jet { shot, ..self }
    }

    /// Puts another form at the entry in its place.
    fn put_at_entry(&mut self, row: &Row, entry: &Vector) {
        self.value = row.at.dot(entry);
        self.by_z.copy_from(&row.at);
        self.by = row.by.each_ref().map(|by| by.dot(entry));
    }

    /// Zero, where z has this length.
    pub fn nothing(size: usize) -> Jet {
        Jet {
            value: 0.0,
            shot: 0,
            by_z: Vector::zeros(size),
            by_time: 0.0,
            by: [0.0; VARYING],
        }
    }

    /// The jet times a number.
    pub fn scaled(mut self, factor: f64) -> Jet {
        self.value *= factor;
        self.by_z *= factor;
        self.by_time *= factor;
        self.by = self.by.map(|by| factor * by);
        self
    }

    pub(super) fn add(&mut self, factor: f64, other: &Jet) {
        self.value += factor * other.value;
        self.by_z.axpy(factor, &other.by_z, 1.0);
        self.by_time += factor * other.by_time;
        for (by, other) in self.by.iter_mut().zip(other.by) {
            *by += factor * other;
        }
    }
}

/// A shot of a zone from its beginning to a time.
#[derive(Clone, Debug)]
pub struct Passage<'a> {
    mode: &'a AffineMode,
    /// The shot.
    pub shot: usize,
    /// Norm of its matrix.
    norm: f64,
    /// z at the beginning, for the first shot that at the entry of the zone.
    pub entry: Vector,
    /// Time since.
    pub time: f64,
    /// ∂z/∂z₀, z₀ at the beginning: exp(Mt) where the mode is linear.
    pub flow: Matrix,
    /// ∂z/∂p of every parameter on which it depends.
    by: [Option<Vector>; VARYING],
    /// z at the time.
    pub end: Vector,
    /// ż there.
    pub rate: Vector,
    /// Where the mode is not linear.
    numerical: Option<Numerical>,
}

/// exp(Mt) of a linear mode, and its derivatives in the parameters on which it depends.
#[derive(Clone, Debug)]
pub struct Propagators {
    flow: Matrix,
    by: [Option<Matrix>; VARYING],
}

impl Propagators {
    /// Those of a mode whose matrix has this norm; what is slow of it, where it is stiff.
    pub fn new(mode: &AffineMode, norm: f64, stiff: Option<&Splitting>, time: f64) -> Propagators {
        let MatrixBy { at, by } = &mode.matrix;
        let by = by.each_ref().map(Some);
        let (flow, by) = propagator(at, by, mode.states, norm, time);
        let flow = stiff.map_or(flow, |way| way.propagator(time));
        Propagators { flow, by }
    }
}

/// Series of z at both ends.
#[derive(Clone, Debug)]
struct Numerical {
    first: Series,
    /// Time up to which it holds.
    length: f64,
    last: Series,
}

/// A piece of an integrated passage.
#[derive(Clone, Debug)]
pub struct PassageStage {
    /// Time of its beginning.
    pub begun: f64,
    /// How much of its series belongs to it.
    pub time: f64,
    /// How long its series holds.
    pub length: f64,
    /// z from its beginning on.
    pub series: Series,
    /// ∂z/∂z₀ at its beginning, and ∂z/∂p of every parameter.
    pub(super) by: Derivatives,
}

/// Derivatives of z in z₀ at the entry, and in every parameter.
pub(super) type Derivatives = (Matrix, [Vector; VARYING]);

/// A passage through pieces of series, with its derivatives in all that vary.
#[derive(Clone, Debug)]
pub struct Integrated {
    /// Its pieces in their order; none of a passage that takes no time, or that leaves the range of numbers.
    pub stages: Vec<PassageStage>,
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
        let (base, forward, whole) = (field.base(), time >= 0.0, time.abs());
        let series = |z: &Vector| field.series(z, ORDER, true, forward);
        let first = series(entry);
        let mut by = in_no_time(base);
        let (mut last, mut z, mut stages) = (first.clone(), entry.clone(), Vec::new());
        let (mut begun, mut before) = (0.0, whole);
        while begun < whole {
            let rest = whole - begun;
            let length = field.length(&last, rest, forward);
            // what is not finite gives a passage that is not
            before = counted(before, length);
            let count = (stages.len() + 1) as f64 + rest / before;
            if length.is_nan() || length <= 0.0 || count > MOST_PIECES {
                by.0.fill(f64::NAN);
                stages.clear();
                break;
            }
            let time = share(rest, length);
            let end = if time == rest { whole } else { begun + time };
            let signed = if forward { time } else { -time };
            let along = moved(&last, &by, signed);
            z = last.at(signed);
            stages.push(PassageStage {
                begun,
                time,
                length,
                series: std::mem::replace(&mut last, series(&z)),
                by: std::mem::replace(&mut by, along),
            });
            begun = end;
        }
        if !stages.is_empty() {
            z = last.first();
        }
        let length = stages.first().map_or(0.0, |stage| stage.length);
        Integrated::of(by, (first, length), (z, last), stages)
    }

    /// The passage up to a time at which it has not ended yet; `None` where it is not known so far.
    pub fn until(&self, mode: &AffineMode, time: f64) -> Option<Integrated> {
        let stage = self.stages.iter().rfind(|stage| stage.begun <= time)?;
        let part = time - stage.begun;
        let z = stage.series.at(part);
        let last = mode.field.series(&z, ORDER, true, true);
        let by = moved(&stage.series, &stage.by, part);
        let first = (self.first.clone(), self.length);
        Some(Integrated::of(by, first, (last.first(), last), Vec::new()))
    }

    /// With what is made of other components, which follows them.
    fn of(
        (flow, by): Derivatives,
        (first, length): (Series, f64),
        (end, last): (Vector, Series),
        stages: Vec<PassageStage>,
    ) -> Integrated {
        let (size, base) = (end.len(), flow.ncols());
        let (slopes, own) = last.derivatives();
        let mut all = Matrix::zeros(size, size);
        all.columns_mut(0, base).copy_from(&(&slopes * flow));
        let mut own = own.into_iter();
        Integrated {
            stages,
            flow: all,
            by: by.map(|by| &slopes * by + own.next().unwrap_or_else(|| Vector::zeros(size))),
            rate: Vector::from_fn(size, |c, _| last.value(1, c)),
            end,
            first,
            length,
            last,
        }
    }
}

/// How much of what is left of a zone the next piece takes, of those that hold so long: the last two are of one length,
/// so that none is tiny.
pub(super) fn share(rest: f64, length: f64) -> f64 {
    match rest / length {
        ratio if ratio <= 1.0 => rest,
        ratio if ratio <= 2.0 => 0.5 * rest,
        _ => length,
    }
}

/// Those where no time has passed, of so many components.
pub(super) fn in_no_time(base: usize) -> Derivatives {
    let nothing = std::array::from_fn(|_| Vector::zeros(base));
    (Matrix::identity(base, base), nothing)
}

/// Derivatives at a time after the beginning of a series, where those at its beginning are known.
pub(super) fn moved(series: &Series, (flow, by): &Derivatives, time: f64) -> Derivatives {
    let (along, own) = series.derivatives_of(flow.nrows(), time);
    let mut moved = Matrix::zeros(flow.nrows(), flow.ncols());
    let (left, sum) = (along.as_slice(), moved.as_mut_slice());
    add_product(1.0, left, flow.nrows(), flow.as_slice(), sum);
    let by = std::array::from_fn(|p| product(&along, &by[p]) + &own[p]);
    (moved, by)
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
        let propagators = Propagators::new(mode, norm, stiff, time);
        Passage::linear(mode, norm, &propagators, entry, time)
    }

    /// The passage from z through a linear mode.
    pub fn linear(
        mode: &'a AffineMode,
        norm: f64,
        Propagators { flow, by }: &Propagators,
        entry: Vector,
        time: f64,
    ) -> Passage<'a> {
        let end = flow * &entry;
        let by = by.each_ref().map(|by| by.as_ref().map(|by| by * &entry));
        Passage {
            rate: &mode.matrix.at * &end,
            end,
            by,
            flow: flow.clone(),
            norm,
            shot: 0,
            mode,
            entry,
            time,
            numerical: None,
        }
    }

    /// The same as a shot of its zone.
    pub fn of_shot(self, shot: usize) -> Passage<'a> {
        Passage { shot, ..self }
    }

    /// The passage through a mode that is integrated; `parameter` is the place of the first of its parameters among those of
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
            by: in_order(parameter).map(|place| Some(known.by[place].clone())),
            rate: known.rate.clone(),
            end: known.end.clone(),
            norm: 0.0,
            shot: 0,
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
        for (own, place) in self.by.iter_mut().zip(in_order(parameter)) {
            let along = own.as_ref().map(|own| &slopes * own.rows(0, base));
            *own = along.map(|along| along + &by[place]);
        }
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
            return self.linear_at_end(&derivative(self.mode, row, order));
        };
        let (value, gradient, by) = last.jet(row, order);
        let jet = Jet {
            value,
            shot: self.shot,
            by_time: (order + 1) as f64 * last.of(&row.at, order + 1),
            by: self.along(&gradient, by),
            by_z: self.flow.tr_mul(&gradient),
        };
        jet.scaled(factorial(order))
    }

    /// A form at the end of a linear mode.
    fn linear_at_end(&self, row: &Row) -> Jet {
        let mut terms = row.at.iter().enumerate().filter(|(_, c)| **c != 0.0);
        // most resets leave most states as they are
        let by_z = match (terms.next(), terms.next()) {
            (Some((component, c)), None) => {
                let entries = self.flow.row(component);
                Vector::from_iterator(row.at.len(), entries.iter().map(|entry| entry * c))
            }
            _ => self.flow.tr_mul(&row.at),
        };
        Jet {
            value: row.at.dot(&self.end),
            shot: self.shot,
            by_z,
            by_time: row.at.dot(&self.rate),
            by: self.along(&row.at, row.by.each_ref().map(|by| by.dot(&self.end))),
        }
    }

    /// Derivatives in the parameters at a fixed end, with what the end moves by along a gradient.
    pub(super) fn along(&self, gradient: &Vector, at_end: [f64; VARYING]) -> [f64; VARYING] {
        let moved = |p: usize| self.by[p].as_ref().map_or(0.0, |by| gradient.dot(by));
        std::array::from_fn(|p| at_end[p] + moved(p))
    }

    /// The derivatives of a form at the entry, from an order on: so many, or as many as are known.
    pub fn derivatives_at_entry(&self, row: &Row, from: usize, count: usize) -> Vec<Jet> {
        let mut jets = Vec::with_capacity(count);
        self.each_derivative_at_entry(row, from..from + count, |_, jet| jets.push(jet.clone()));
        jets
    }

    /// Calls a function with the number of each of these derivatives, counted from zero, and the derivative.
    fn each_derivative_at_entry(
        &self,
        row: &Row,
        orders: Range<usize>,
        mut call: impl FnMut(usize, &Jet),
    ) {
        if let Some(Numerical { first, .. }) = &self.numerical {
            let known = orders.take_while(|order| *order <= ORDER);
            for (index, order) in known.enumerate() {
                let (value, by_z, by) = first.jet(row, order);
                let jet = Jet {
                    value,
                    shot: self.shot,
                    by_z,
                    by_time: 0.0,
                    by,
                };
                call(index, &jet.scaled(factorial(order)));
            }
            return;
        }
        if orders.is_empty() {
            return;
        }
        let form = derivative(self.mode, row, orders.start);
        let mut jet = Jet::at_entry(&form, &self.entry).of_shot(self.shot);
        call(0, &jet);
        if orders.len() > 1 {
            let mut form = form.into_owned();
            let mut next = form.clone();
            for index in 1..orders.len() {
                form.put_through(&self.mode.matrix, &mut next);
                std::mem::swap(&mut form, &mut next);
                jet.put_at_entry(&form, &self.entry);
                call(index, &jet);
            }
        }
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
        self.each_derivative_at_entry(row, 0..order, |k, jet| {
            forms[0].add(-power, jet);
            forms[1].add(-before[0], jet);
            second -= before[1] * jet.value;
            before = [power, before[0]];
            power *= self.time / (k + 1) as f64;
        });
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
        let zero = || Jet::nothing(self.entry.len()).of_shot(self.shot);
        let (mut q, mut rate, mut second) = (zero(), zero(), 0.0);
        // tʲ/k!, j = k − m, and the two powers below with the factors of their derivatives
        let mut weights = [factorial(order).recip(), 0.0, 0.0];
        let orders = order..order + TERMS as usize + 1;
        self.each_derivative_at_entry(row, orders, |j, jet| {
            let next = (j + 1) as f64;
            q.add(weights[0], jet);
            rate.add(weights[1], jet);
            second += weights[2] * jet.value;
            let k = next + order as f64;
            weights = [
                weights[0] * self.time / k,
                weights[0] * next / k,
                weights[1] * next / k,
            ];
        });
        q.by_time = rate.value;
        rate.by_time = second;
        [q, rate]
    }
}

/// The derivative of this order of a form of a linear mode.
pub(in crate::affine) fn derivative<'r>(
    mode: &AffineMode,
    row: &'r Row,
    order: usize,
) -> Cow<'r, Row> {
    let first = Cow::Borrowed(row);
    (0..order).fold(first, |row, _| Cow::Owned(row.through(&mode.matrix)))
}

fn factorial(k: usize) -> f64 {
    (1..=k).map(|k| k as f64).product()
}
