//! Perturbations of a motion: directions that the linearised flow takes along, and every switch by its saltation.
//!
//! Along a zone q̇ = ∂f/∂x·q. A perturbation reaches the guard g of a switch later by δt = −gᵀq/ġ, so that at equal time
//!
//! ```text
//! q⁺ = Rₓq⁻ − (f⁺ − Rẋ⁻)δt.                                                                              (1)
//! ```
//!
//! Where several switches follow in one instant, each because its guard is negative already, they share the delay of the
//! first. Directions are kept orthonormal, Q′R = DF·Q (Benettin et al., Meccanica 15 (1980) 9): ln Rⱼⱼ is how the j-th of them
//! grows. A dimension that sliding, stick, or a reset takes away is lost.
//!
//! | threshold | meaning | reason |
//! |---|---|---|
//! | `KNOWN` | least Rⱼⱼ of a piece, by the largest entry of its flow | ten digits of Rⱼⱼ are left |
//! | `GONE` | a direction is lost where it is this part of its length before | far above rounding, far below what jumps leave |

use std::f64::consts::TAU;

use super::exponential::plain_propagator;
use super::mode::{AffineMode, AffineSystem, Row};
use super::motion::{Moment, Switching};
use super::orbit::passage::{Integrated, Passage, derivative};
use super::orbit::saltation::{NOTHING, Saltation, rank};
use super::slots::Slots;
use crate::linalg::{Matrix, Vector, balance, product};

const KNOWN: f64 = 1e-6;
const GONE: f64 = 1e-10;

/// Most parts that a piece of an exact flow is cut into, and how often one of an integrated flow is halved: what decays
/// faster is not resolved.
const MOST_PARTS: usize = 1 << 20;
const MOST_HALVINGS: u32 = 20;

/// A form is zero within this many units of its terms: the state at a switch is known to a few roundings.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// Directions at the beginning are as good as random ones: multiples of the golden ratio less their integers.
const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// Why growth is not known: a switch without speed at its guard, or what grows or decays too fast to be resolved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NotResolved;

/// A perturbation, in units of the states.
#[derive(Clone, Debug)]
struct Direction {
    at: Vector,
    /// How much later it comes to the switch of this instant.
    delay: f64,
}

/// The flow of the states of an exact mode, in their units.
#[derive(Debug)]
struct LinearFlow {
    matrix: Matrix,
    /// Norm of the matrix in units that balance it.
    norm: f64,
}

/// Directions along a motion, and how they have grown.
#[derive(Debug)]
pub struct TangentFrame<'a> {
    system: &'a AffineSystem,
    /// A rate that counts for nothing.
    slow: f64,
    /// How many directions are asked for.
    count: usize,
    /// Units of the states.
    units: Vector,
    /// Largest size of every state so far.
    sizes: Vector,
    directions: Vec<Direction>,
    /// ln of the growth of each since it was last taken.
    growth: Vec<f64>,
    /// Whether one that others follow has been lost since.
    broken: bool,
    flows: Slots<LinearFlow>,
}

/// The linear map of a switch, in units of the states.
struct Crossing {
    /// Rₓ.
    reset: Matrix,
    /// f⁺ − Rẋ⁻.
    shift: Vector,
    /// −g/ġ where the motion crosses the guard.
    delay: Option<Vector>,
    /// Errors of the entries of the whole map.
    bounds: Matrix,
}

impl<'a> TangentFrame<'a> {
    /// So many directions at the beginning of a motion; times are compared with a unit.
    ///
    /// # Errors
    /// The state is no number.
    pub fn new(
        system: &'a AffineSystem,
        place: &Moment,
        count: usize,
        unit: f64,
    ) -> Result<TangentFrame<'a>, NotResolved> {
        let n = system.states;
        let mut frame = TangentFrame {
            system,
            slow: unit.recip(),
            count: count.min(n),
            units: Vector::repeat(n, 1.0),
            sizes: Vector::zeros(n),
            directions: Vec::new(),
            growth: Vec::new(),
            broken: false,
            flows: Slots::new(system.modes.len()),
        };
        frame.measure_anew(place)?;
        Ok(frame)
    }

    /// How many directions are left.
    pub fn len(&self) -> usize {
        self.directions.len()
    }

    /// Whether none is.
    pub fn is_empty(&self) -> bool {
        self.directions.is_empty()
    }

    /// Logarithms of the growth since they were last taken; none where they do not belong together, since a direction
    /// that others follow has been lost.
    pub fn take_growth(&mut self) -> Option<Vec<f64>> {
        let whole = !std::mem::take(&mut self.broken);
        let growth = self.growth.clone();
        self.growth.fill(0.0);
        whole.then_some(growth)
    }

    /// Takes as units of the states their largest sizes so far, to powers of two, forgets how directions have grown, and
    /// puts new ones in the place of those that are lost: where the motion is. A state that is next to nothing there, as on its section,
    /// has the unit of what its rate makes of a unit of time.
    ///
    /// # Errors
    /// A direction is no number.
    pub fn measure_anew(&mut self, place: &Moment) -> Result<(), NotResolved> {
        /// Part of that below which it is next to nothing.
        const LITTLE: f64 = 1e-9;
        self.see(&place.state);
        let z = self.system.lift(place.mode, &place.state, place.phase);
        let rates = &self.system.modes[place.mode].matrix.at * z;
        let unit = |state: usize, size: f64| {
            let made = rates[state].abs() / (TAU * self.slow);
            let size = if size > LITTLE * made { size } else { made };
            match size > 0.0 && size.is_finite() {
                true => size.log2().round().exp2(),
                false => 1.0,
            }
        };
        let units = self
            .sizes
            .map_with_location(|state, _, size| unit(state, size));
        for direction in &mut self.directions {
            let pairs = self.units.iter().zip(&units);
            let entries = direction.at.iter_mut().zip(pairs);
            entries.for_each(|(entry, (old, new))| *entry *= old / new);
        }
        self.units = units;
        self.flows = Slots::new(self.system.modes.len());
        let n = self.system.states;
        let entry = |i: usize, j: usize| ((i + 1) as f64 * (j + 1) as f64 * GOLDEN).fract() - 0.5;
        let fresh = (self.len()..self.count).map(|j| Direction {
            at: Vector::from_fn(n, |i, _| entry(i, j)),
            delay: 0.0,
        });
        self.directions.extend(fresh);
        let Moment { mode, phase, .. } = *place;
        self.land(mode, &place.state, phase);
        let held = self.held(mode, &place.state, phase).len();
        self.growth = vec![0.0; self.count];
        let known = self.orthonormalise(n - held.min(n), 0.0);
        self.growth.fill(0.0);
        self.broken = false;
        match known {
            true => Ok(()),
            false => Err(NotResolved),
        }
    }

    fn see(&mut self, state: &[f64]) {
        let pairs = self.sizes.iter_mut().zip(state);
        pairs.for_each(|(size, x)| *size = size.max(x.abs()));
    }

    /// Takes the directions along the zone that a motion is in.
    ///
    /// # Errors
    /// Growth is not resolved.
    pub fn carry(&mut self, from: &Moment, time: f64) -> Result<(), NotResolved> {
        self.see(&from.state);
        if self.is_empty() || time <= 0.0 {
            return Ok(());
        }
        self.directions.iter_mut().for_each(|one| one.delay = 0.0);
        if self.system.modes[from.mode].field.is_exact {
            return self.carry_linear(from, time);
        }
        // an integration that takes long keeps many series
        let parts = (time * self.slow).ceil().max(1.0);
        let mut z = self.system.lift(from.mode, &from.state, from.phase);
        for _ in 0..parts as usize {
            z = self.carry_integrated(from.mode, z, time / parts, MOST_HALVINGS)?;
        }
        Ok(())
    }

    /// Along an exact mode, in as many parts as it takes to resolve all directions.
    fn carry_linear(&mut self, from: &Moment, time: f64) -> Result<(), NotResolved> {
        let before = (self.directions.clone(), self.growth.clone());
        let mut parts = 1;
        while parts <= MOST_PARTS {
            let flow = self.linear_flow(from.mode);
            let n = self.system.states;
            let flow = plain_propagator(&flow.matrix, n, flow.norm, time / parts as f64);
            let mut all = 0..parts;
            if all.all(|_| self.apply(from, &flow)) {
                return Ok(());
            }
            (self.directions, self.growth) = before.clone();
            parts *= 4;
        }
        Err(NotResolved)
    }

    /// Along an integrated mode from z, halved until all directions are resolved; z at the end.
    fn carry_integrated(
        &mut self,
        mode: usize,
        z: Vector,
        time: f64,
        halvings: u32,
    ) -> Result<Vector, NotResolved> {
        let before = (self.directions.clone(), self.growth.clone());
        let passage = Passage::new(&self.system.modes[mode], 0.0, None, z.clone(), time);
        let mut flow = passage.forward();
        let units = &self.units;
        for (j, mut column) in flow.column_iter_mut().enumerate() {
            let entries = column.iter_mut().zip(units);
            entries.for_each(|(entry, unit)| *entry *= units[j] / unit);
        }
        let end = Moment {
            time: 0.0,
            phase: self.phase_of(&passage.end),
            mode,
            state: passage.end.rows(0, self.system.states).as_slice().to_vec(),
        };
        if self.apply(&end, &flow) {
            return Ok(passage.end);
        }
        (self.directions, self.growth) = before;
        let halvings = halvings.checked_sub(1).ok_or(NotResolved)?;
        let middle = self.carry_integrated(mode, z, 0.5 * time, halvings)?;
        self.carry_integrated(mode, middle, 0.5 * time, halvings)
    }

    /// The phase that z has; zero without forcing.
    fn phase_of(&self, z: &Vector) -> f64 {
        let n = self.system.states;
        match self.system.harmonics {
            0 => 0.0,
            _ => z[n + 2].atan2(z[n + 1]),
        }
    }

    fn linear_flow(&self, mode: usize) -> &LinearFlow {
        self.flows.get_or_make(mode, || {
            let (n, units) = (self.system.states, &self.units);
            let of_mode = &self.system.modes[mode].matrix.at;
            let matrix = Matrix::from_fn(n, n, |i, j| of_mode[(i, j)] * units[j] / units[i]);
            let norm = balance(&matrix, self.slow).1;
            LinearFlow { matrix, norm }
        })
    }

    /// Applies a flow that ends at a place in its mode. False where a direction is not resolved.
    fn apply(&mut self, end: &Moment, flow: &Matrix) -> bool {
        let largest = flow.amax();
        if !largest.is_finite() {
            return false;
        }
        for direction in &mut self.directions {
            direction.at = product(flow, &direction.at);
        }
        self.land(end.mode, &end.state, end.phase);
        self.orthonormalise(self.len(), KNOWN * largest)
    }

    /// Takes the directions through a switch.
    ///
    /// # Errors
    /// It has no linear map.
    pub fn jump(&mut self, switching: &Switching, elapsed: f64) -> Result<(), NotResolved> {
        self.see(&switching.before);
        self.see(&switching.after);
        if self.is_empty() {
            return Ok(());
        }
        let n = self.system.states;
        let Crossing {
            reset,
            shift,
            delay,
            bounds,
        } = self.crossing(switching, elapsed)?;
        let own = delay.as_ref();
        let whole = match own {
            Some(delay) => &reset - &shift * delay.transpose(),
            None => reset.clone(),
        };
        if !whole.iter().all(|entry| entry.is_finite()) {
            return Err(NotResolved);
        }
        let before = Matrix::from_fn(n, n, |i, j| self.directions.get(j).map_or(0.0, |q| q.at[i]));
        for direction in &mut self.directions {
            direction.delay = own.map_or(direction.delay, |delay| delay.dot(&direction.at));
            direction.at = product(&reset, &direction.at) - &shift * direction.delay;
        }
        if self.rests(switching) {
            self.come_to_rest(switching);
        }
        let phase = switching.phase;
        self.land(switching.to, &switching.after, phase);
        let mut left = self.len();
        if rank(whole.clone(), bounds.clone()) < n {
            let after =
                Matrix::from_fn(n, n, |i, j| self.directions.get(j).map_or(0.0, |q| q.at[i]));
            let errors = (bounds + whole.abs() * NOTHING) * before.abs();
            left = left.min(rank(after, errors));
        }
        let held = self.held(switching.to, &switching.after, phase).len();
        left = left.min(n - held.min(n));
        match self.orthonormalise(left, 0.0) {
            true => Ok(()),
            false => Err(NotResolved),
        }
    }

    /// Rₓ, f⁺ − Rẋ⁻ and −g/ġ of a switch, in the units of the states.
    fn crossing(&self, switching: &Switching, elapsed: f64) -> Result<Crossing, NotResolved> {
        let Switching { from, to, .. } = *switching;
        let (system, n) = (self.system, self.system.states);
        let mode = &system.modes[from];
        let z = system.lift(from, &switching.before, switching.phase);
        let passage = at_switch(mode, z);
        let guard = &mode.guards[switching.guard];
        let exit = &guard.exits[switching.exit];
        let mut entry = passage.end.clone();
        entry
            .rows_mut(0, n)
            .copy_from(&Vector::from_column_slice(&switching.after));
        system.modes[to].field.complete(&mut entry);
        let matrix = &system.modes[to].matrix.at;
        let saltation = Saltation::new(&passage, exit, &passage.rate, (matrix, &entry));
        let fall = guard.row.at.dot(&passage.rate);
        let normal = passage.gradient(&guard.row).rows(0, n).into_owned();
        // a guard of one state has no other terms where that is zero
        let terms = guard.row.size(&passage.end) + normal.abs().dot(&self.sizes);
        let is_zero = guard.row.value(&passage.end) >= -ROUNDING * terms;
        let delay = match (fall < 0.0, elapsed > 0.0) {
            (true, crossed) if crossed || is_zero => Some(-normal / fall),
            (_, true) if saltation.shift.amax() > 0.0 => return Err(NotResolved),
            _ => None,
        };
        let by_delay = |j: usize| delay.as_ref().map_or(0.0, |delay| delay[j].abs());
        let bounds = saltation.bounds(by_delay);
        let units = &self.units;
        let scaled =
            |matrix: &Matrix| Matrix::from_fn(n, n, |i, j| matrix[(i, j)] * units[j] / units[i]);
        Ok(Crossing {
            reset: scaled(&saltation.reset),
            bounds: scaled(&bounds),
            shift: saltation.shift.component_div(units),
            delay: delay.map(|delay| delay.component_mul(units)),
        })
    }

    /// Gradients of what is zero all along in a mode, in the units of the states; each has a state that no other has.
    fn held(&self, mode: usize, state: &[f64], phase: f64) -> Vec<Vector> {
        let AffineMode { held, surface, .. } = &self.system.modes[mode];
        let rows = held.iter().chain(surface);
        let gradients = rows.map(|row| self.gradient(mode, (row, 0), (state, phase)));
        reduced(gradients.collect())
    }

    /// The gradient of a derivative in time of a form in a mode, of this order, in the units of the states.
    fn gradient(
        &self,
        mode: usize,
        (row, order): (&Row, usize),
        (state, phase): (&[f64], f64),
    ) -> Vector {
        let (n, mode) = (self.system.states, (mode, &self.system.modes[mode]));
        let (number, AffineMode { field, .. }) = mode;
        let gradient = match field.is_exact {
            true => derivative(mode.1, row, order).at.clone(),
            false => {
                let z = self.system.lift(number, state, phase);
                field.series(&z, order, true, true).jet(row, order).1
            }
        };
        gradient.rows(0, n).component_mul(&self.units)
    }

    /// Takes away what rounding has put beside the surfaces that the motion is held in.
    fn land(&mut self, mode: usize, state: &[f64], phase: f64) {
        let gradients = self.held(mode, state, phase);
        self.project(&gradients);
    }

    /// Whether a switch is the last of infinitely many.
    fn rests(&self, switching: &Switching) -> bool {
        let guard = &self.system.modes[switching.from].guards[switching.guard];
        let exit = &guard.exits[switching.exit];
        exit.to != switching.to && exit.rest == Some(switching.to)
    }

    /// After infinitely many switches in finite time nothing is left of a perturbation of their guard and of its rate.
    fn come_to_rest(&mut self, switching: &Switching) {
        let Switching { from, guard, .. } = *switching;
        let mode = &self.system.modes[from];
        let row = &mode.guards[guard].row;
        let place = (&switching.before[..], switching.phase);
        let gradients = [0, 1].map(|order| self.gradient(from, (row, order), place));
        self.project(&reduced(gradients.to_vec()));
    }

    /// Makes every direction orthogonal to gradients, by changes of the states that one of these has alone.
    fn project(&mut self, gradients: &[Vector]) {
        for gradient in gradients {
            let pivot = gradient.iamax();
            for direction in &mut self.directions {
                let off = gradient.dot(&direction.at);
                direction.at[pivot] -= off / gradient[pivot];
            }
        }
    }

    /// Makes the directions orthonormal, and so many of them; their lengths are how they have grown. False where one is
    /// less than `least`.
    fn orthonormalise(&mut self, left: usize, least: f64) -> bool {
        let mut lost = self.len() - left.min(self.len());
        let mut kept: Vec<Direction> = Vec::with_capacity(left);
        let mut growth = Vec::with_capacity(left);
        let old = std::mem::take(&mut self.directions);
        for (index, mut direction) in old.into_iter().enumerate() {
            let length = direction.at.norm();
            // twice is enough
            for _ in 0..2 {
                for other in &kept {
                    let part = other.at.dot(&direction.at);
                    direction.at.axpy(-part, &other.at, 1.0);
                    direction.delay -= part * other.delay;
                }
            }
            let rest = direction.at.norm();
            if kept.len() == left || lost > 0 && rest <= GONE * length {
                self.broken |= kept.len() < left;
                lost = lost.saturating_sub(1);
                continue;
            }
            if !(rest >= least && rest > 0.0 && rest.is_finite()) {
                return false;
            }
            direction.at /= rest;
            direction.delay /= rest;
            kept.push(direction);
            growth.push(self.growth[index] + rest.ln());
        }
        (self.directions, self.growth) = (kept, growth);
        true
    }
}

/// A passage of no duration to a switch, with all that its reset is made of.
fn at_switch(mode: &AffineMode, z: Vector) -> Passage<'_> {
    if mode.field.is_exact {
        return Passage::new(mode, 0.0, None, z, 0.0);
    }
    let known = Integrated::new(mode, &z, 0.0);
    Passage::integrated(mode, z, (0.0, true), &known, 0)
}

/// Vectors that span the same space: each has its largest entry where all others are zero.
fn reduced(vectors: Vec<Vector>) -> Vec<Vector> {
    let mut reduced: Vec<Vector> = Vec::new();
    for mut vector in vectors {
        let size = vector.amax();
        for known in &reduced {
            take_away(&mut vector, known);
        }
        // what is left of a dependent one is rounding
        if vector.amax() > GONE * size {
            let known = reduced.iter_mut();
            known.for_each(|known| take_away(known, &vector));
            reduced.push(vector);
        }
    }
    reduced
}

/// Takes away a multiple of another vector, so that nothing is left where that is largest.
fn take_away(vector: &mut Vector, other: &Vector) {
    let pivot = other.iamax();
    let factor = vector[pivot] / other[pivot];
    vector.axpy(-factor, other, 1.0);
    vector[pivot] = 0.0;
}
