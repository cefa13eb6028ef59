//! The equations of an orbit with their derivatives, in numbers of any kind.
//!
//! The Jacobian is written by hand. Over numbers x + εv it has Fₓv and its derivatives as well: that is all a fold
//! or a multiplier on the unit circle needs.
//!
//! A zone of no duration that begins where its guard is zero ends there for any state: there the guard is divided by a power of the
//! duration.

use super::OpenOrbit;
use super::enclosure::Enclosure;
use super::flow::{IntervalFlow, Timed, dot, product};
use super::modes::{IntervalModes, Row};
use super::system::{OrbitCondition, OrbitSystem, Passing, SegmentEnd};
use crate::interval::{Gradient, Interval, Number};

/// A number through a function of another.
pub trait Varying: Number {
    /// f(self) from f and f′ at its value.
    fn composed(self, value: Interval, slope: Interval) -> Self;
}

impl Varying for Interval {
    fn composed(self, value: Interval, _: Interval) -> Interval {
        value
    }
}

impl<const D: usize> Varying for Gradient<Interval, D> {
    fn composed(self, value: Interval, slope: Interval) -> Self {
        Gradient {
            value,
            by: self.by.map(|by| by * slope),
        }
    }
}

/// Residuals and the entries of the Jacobian that are not zero; of those, the entry of the first stretch where the cycle closes,
/// with its sign.
pub struct OrbitResiduals<N> {
    pub residual: Vec<N>,
    pub entries: Vec<(usize, usize, N)>,
    pub wrap: Vec<(usize, usize, f64)>,
}

impl<N: Varying> OrbitResiduals<N> {
    fn put(&mut self, row: usize, column: usize, value: N) {
        if !value.is_zero() {
            self.entries.push((row, column, value));
        }
    }
}

/// A place of the orbit: where its y stands among the unknowns, z, and ∂z/∂φ.
struct OrbitPlace<N> {
    node: usize,
    z: Vec<N>,
    turned: Vec<N>,
}

impl OrbitSystem<'_> {
    /// The equations of the orbit and, where one is enough, that of the event: over intervals of the unknowns, and
    /// numbers with these values.
    pub fn terms<N: Varying>(&self, x: &[N]) -> Result<OrbitResiduals<N>, OpenOrbit> {
        let values: Vec<Interval> = x.iter().map(Number::value).collect();
        let modes = self.enclosed(values[self.parameter()])?;
        let passings = self.passings(&modes, &values);
        let mut terms = OrbitResiduals {
            residual: Vec::new(),
            entries: Vec::new(),
            wrap: Vec::new(),
        };
        let count = self.stretches.len();
        for (index, passing) in passings.iter().enumerate() {
            self.flow_terms(&modes, passing, index, x, &mut terms);
            let end = self.at(x, self.place(index, true));
            let next = (index + 1) % count;
            let stretch = self.stretches[index];
            let mode = &modes.modes[stretch.mode];
            let reset = match stretch.end {
                SegmentEnd::Exit { guard, exit } => Some(&mode.guards[guard].exits[exit].reset),
                _ => None,
            };
            let node = self.place(next, false);
            for state in 0..modes.states {
                let row = terms.residual.len();
                match reset {
                    Some(reset) => self.form(&reset[state], &end, &mut terms),
                    None => {
                        terms.residual.push(x[end.node + state]);
                        terms.put(row, end.node + state, N::double(1.0));
                    }
                }
                self.minus(row, node + state, next == 0, x, &mut terms);
            }
            if self.is_forced() {
                let row = terms.residual.len();
                let turns = if next == 0 {
                    self.turns()
                } else {
                    Interval::ZERO
                };
                let phase = end.node + modes.states;
                terms.residual.push(x[phase] - N::constant(turns));
                terms.put(row, phase, N::double(1.0));
                self.minus(row, node + modes.states, next == 0, x, &mut terms);
            }
            match stretch.end {
                SegmentEnd::Exit { guard, .. } => {
                    let row = &mode.guards[guard].row;
                    match self.divisor(index) {
                        0 => self.form(row, &end, &mut terms),
                        _ => self.quotient_terms(&passing.flow, index, row, x, &mut terms),
                    }
                }
                SegmentEnd::Touch { guard } => {
                    self.form(
                        &mode.derivative(&mode.guards[guard].row, 1),
                        &end,
                        &mut terms,
                    );
                }
                SegmentEnd::Never => {
                    // the phase at the entry is 0
                    let phase = self.place(0, false) + modes.states;
                    terms.put(terms.residual.len(), phase, N::double(1.0));
                    terms.residual.push(x[phase]);
                }
            }
        }
        self.event_equation(&modes, x, &mut terms)?;
        Ok(terms)
    }

    /// The equation that singles out the event, where one is enough.
    fn event_equation<N: Varying>(
        &self,
        modes: &IntervalModes<Enclosure>,
        x: &[N],
        terms: &mut OrbitResiduals<N>,
    ) -> Result<(), OpenOrbit> {
        let parameter = self.parameter();
        let value = match self.condition {
            OrbitCondition::Value(value) => Some(value.interval()),
            _ => self.fixed,
        };
        if let Some(value) = value {
            terms.put(terms.residual.len(), parameter, N::double(1.0));
            terms.residual.push(x[parameter] - N::constant(value));
        } else if let Some(vanishing) = self.vanishing.first() {
            let mode = &modes.modes[self.stretches[vanishing.stretch].mode];
            let row = vanishing.source.row(mode).ok_or(OpenOrbit::Sequence)?;
            let place = self.at(x, self.place(vanishing.stretch, vanishing.at_end));
            self.form(&row, &place, terms);
        } else if let Some(stretch) = self.closed.first() {
            let duration = self.duration(*stretch);
            terms.put(terms.residual.len(), duration, N::double(1.0));
            terms.residual.push(x[duration]);
        }
        Ok(())
    }

    fn at<N: Varying>(&self, x: &[N], node: usize) -> OrbitPlace<N> {
        let z = self.lift(&x[node..node + self.width()]);
        OrbitPlace {
            turned: self.turned(&z),
            node,
            z,
        }
    }

    /// A form at a place as one more equation.
    fn form<N: Varying>(
        &self,
        form: &Row<Enclosure>,
        place: &OrbitPlace<N>,
        terms: &mut OrbitResiduals<N>,
    ) {
        let row = terms.residual.len();
        let sum = |z: &[N], part: fn(&Enclosure) -> Interval| {
            let terms = form.iter().zip(z);
            terms.fold(N::double(0.0), |sum, (c, z)| sum + z.scaled(part(c)))
        };
        terms.residual.push(sum(&place.z, |c| c.value));
        for (state, entry) in form.iter().enumerate().take(self.exact.states) {
            terms.put(row, place.node + state, N::constant(entry.value));
        }
        if self.is_forced() {
            let by_phase = sum(&place.turned, |c| c.value);
            terms.put(row, place.node + self.exact.states, by_phase);
        }
        terms.put(row, self.parameter(), sum(&place.z, |c| c.by[0]));
    }

    /// The guard of a stretch as one more equation, divided by a power of its duration: it has a zero of that order at the entry.
    fn quotient_terms<N: Varying>(
        &self,
        flow: &IntervalFlow,
        index: usize,
        form: &Row<Enclosure>,
        x: &[N],
        terms: &mut OrbitResiduals<N>,
    ) {
        let row = terms.residual.len();
        let time = x[self.duration(index)];
        let quotient = flow.quotient(form, self.divisor(index), time.value());
        // one of these derivatives of it, with its own in the time
        let part = |of: fn(&Timed) -> Gradient<Interval, 1>| -> Vec<N> {
            let entries = quotient.iter().map(of);
            entries
                .map(|entry| time.composed(entry.value, entry.by[0]))
                .collect()
        };
        let at = part(|entry| entry.value);
        let place = self.at(x, self.place(index, false));
        terms.residual.push(dot(&at, &place.z));
        for (state, entry) in at.iter().enumerate().take(self.exact.states) {
            terms.put(row, place.node + state, *entry);
        }
        if self.is_forced() {
            let by_phase = dot(&at, &place.turned);
            terms.put(row, place.node + self.exact.states, by_phase);
        }
        let by_time = part(|entry| entry.by[0]);
        terms.put(row, self.duration(index), dot(&by_time, &place.z));
        let by_parameter = part(|entry| entry.by[1]);
        terms.put(row, self.parameter(), dot(&by_parameter, &place.z));
    }

    /// Less what stands at an entry.
    fn minus<N: Varying>(
        &self,
        row: usize,
        column: usize,
        wraps: bool,
        x: &[N],
        terms: &mut OrbitResiduals<N>,
    ) {
        // half an orbit ends at 2c − x
        let centre = self.half.as_ref();
        let centre = centre.filter(|_| wraps && column < self.exact.states);
        let sign = if centre.is_some() { 1.0 } else { -1.0 };
        terms.residual[row] = terms.residual[row] + x[column].scaled(Interval::point(sign));
        if let Some(centre) = centre {
            terms.residual[row] = terms.residual[row] - N::constant(centre.enclosed(column));
        }
        terms.put(row, column, N::double(sign));
        if wraps {
            terms.wrap.push((row, column, sign));
        }
    }

    /// Every step of a stretch.
    fn flow_terms<N: Varying>(
        &self,
        modes: &IntervalModes<Enclosure>,
        passing: &Passing,
        index: usize,
        x: &[N],
        terms: &mut OrbitResiduals<N>,
    ) {
        let Passing { flow, whole, .. } = passing;
        let states = modes.states;
        let share = Interval::ONE / Interval::point(self.steps[index] as f64);
        let (duration, parameter) = (self.duration(index), self.parameter());
        let time = x[duration].scaled(share);
        let rate = product(&flow.matrix, &whole.at);
        let rate_by = {
            let one = product(&flow.by, &whole.at);
            super::flow::sum(&one, &product(&flow.matrix, &whole.by))
        };
        let omega = &modes.omega;
        for step in 0..self.steps[index] {
            let place = self.at(x, self.node(index, step));
            let next = self.node(index, step + 1);
            let row = terms.residual.len();
            let mut end = Vec::with_capacity(self.width());
            for state in 0..states {
                let entries: Vec<N> = (0..place.z.len())
                    .map(|column| time.composed(whole.at[state][column], rate[state][column]))
                    .collect();
                let sum = |z: &[N]| {
                    let terms = entries.iter().zip(z);
                    terms.fold(N::double(0.0), |sum, (e, z)| sum + *e * *z)
                };
                end.push(sum(&place.z));
                for (column, entry) in entries.iter().enumerate().take(states) {
                    terms.put(row + state, place.node + column, *entry);
                }
                if self.is_forced() {
                    terms.put(row + state, place.node + states, sum(&place.turned));
                }
                let by = (0..place.z.len()).fold(N::double(0.0), |sum, column| {
                    let by = time.composed(whole.by[state][column], rate_by[state][column]);
                    sum + by * place.z[column]
                });
                terms.put(row + state, parameter, by);
            }
            if self.is_forced() {
                let phase = place.node + states;
                end.push(x[phase] + time.scaled(omega.value));
                terms.put(row + states, phase, N::double(1.0));
                terms.put(row + states, duration, N::constant(omega.value * share));
                terms.put(row + states, parameter, time.scaled(omega.by[0]));
            }
            let z = self.lift(&end);
            for state in 0..states {
                let row_of = flow.matrix[state].iter().zip(&z);
                let moved = row_of.fold(N::double(0.0), |sum, (m, z)| sum + z.scaled(*m));
                terms.put(row + state, duration, moved.scaled(share));
            }
            for (component, value) in end.into_iter().enumerate() {
                terms.residual.push(value);
                self.minus(row + component, next + component, false, x, terms);
            }
        }
    }
}
