//! Equilibria of every mode and every sliding mode, admissible or virtual, with their eigenvalues.
//!
//! An affine mode has one, by [`solve`]: exact to rounding in each state. Others are found by Newton's method from many
//! places, and known to δ = |J⁻¹|ρ, ρ the rounding of the terms of each rate. Where J changes by as much as its size
//! within δ, or is singular, an equilibrium is degenerate: steps of Newton's method then shrink like 1 − 1/m to a zero of
//! order m, and steps of m times the length are quadratic again.

use nalgebra::Complex;

use super::mode::{AffineMode, AffineSystem, Row};
use super::surfaces::Surfaces;
use crate::interval::Interval;
use crate::linalg::{
    Factors, Matrix, Vector, even, known_eigenvalues, pseudo_inverse, radius, solve,
};

/// An equilibrium of a mode: f(x) = 0, also on the surfaces that the mode does not leave.
#[derive(Clone, Debug, PartialEq)]
pub struct Equilibrium {
    /// The mode.
    pub mode: usize,
    /// The state.
    pub state: Vec<f64>,
    /// Eigenvalues of ∂f/∂x within these surfaces, the fastest growing first.
    pub eigenvalues: Vec<Complex<f64>>,
    /// Whether perturbations decay, as far as more than rounding says so: false where one grows.
    pub stable: Option<bool>,
    /// ∂f/∂x.
    pub slopes: Matrix,
    /// Where it lies by the guards of its mode.
    pub place: Admissibility,
    /// Whether others lie next to it.
    pub isolation: Isolation,
}

/// Where an equilibrium lies by the guards of its mode, over every phase of the forcing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Admissibility {
    /// All of them are positive.
    Admissible,
    /// One is negative: for one phase at least, or for all.
    Virtual {
        /// The most negative one.
        guard: usize,
        /// Whether it is negative at some phases only.
        at_times: bool,
    },
    /// The least value of one is zero, to rounding.
    Boundary {
        /// Which.
        guard: usize,
    },
}

/// Whether an equilibrium stands alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Isolation {
    /// ∂f/∂x is regular.
    Simple,
    /// It is singular, to rounding.
    Degenerate,
    /// It is singular at many equilibria, of which this is one.
    Family,
}

/// What a mode has in the place of one equilibrium.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NoEquilibrium {
    /// Its rates depend on the phase.
    #[error("the mode is forced: nothing rests in it")]
    Forced,
    /// Its matrix is singular, to rounding.
    #[error("the matrix of the mode is singular: no equilibrium, or a family of them")]
    Singular,
    /// Newton's method finds none.
    #[error(
        "undecided: Newton's method settles on no equilibrium from {STARTS} places up to {FARTHEST} away, nor in units of the mode"
    )]
    NotFound,
}

/// Places from which equilibria of a mode that is not affine are looked for, and how far the farthest are; those of
/// the last quarter are smaller than the rest by up to this factor.
const STARTS: usize = 400;
const FARTHEST: f64 = 10.0;
const SMALLEST: f64 = 1e-12;

/// Places are gone on with until there are so many times as many as the last new equilibrium took, and no more than these.
const FURTHER: usize = 4;
const MOST_STARTS: usize = 16 * STARTS;

/// States whose sizes differ from 1 by no more than this have all of these places within reach; others are looked for from as many more
/// in their own units.
const ALIKE: f64 = 8.0;

/// Equilibria lie up to so many times as far out as where something begins to change.
const BEYOND: f64 = 4.0;

/// Newton's steps from each of them; toward a degenerate equilibrium steps after which their ratio is seen, and then steps
/// of m times the length.
const STEPS: usize = 60;
const PLAIN_STEPS: usize = 24;
const LONG_STEPS: usize = 30;

/// Steps of Newton's method that are smaller than this part of every state, or so many times what it is known to, would be nothing after one
/// or two more; where so many of them shrink by no more than this they are rounding: at a zero of order m they shrink by 1 − 1/m.
const JITTER: f64 = 1e-11;
const JITTERS: f64 = 16.0;
const SHRINKS: f64 = 0.9;
const STALLED: usize = 3;

/// Part of the usual terms of a rate that their rounding may hide.
const HIDDEN: f64 = 1e-3;

/// Roundings of a rate, relative to its terms.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// Two simple equilibria whose states differ by no more than so many times what they are known to are one; a degenerate
/// one is known to the square or cube root of rounding only.
const SAME: f64 = 64.0;
const SAME_DEGENERATE: f64 = 1e-4;

/// Derivatives that change by this part of them within what a state is known to are zero to rounding: Newton's method ends
/// where its step is four times as long as that.
const CHANGED: f64 = 0.05;

/// States of an equilibrium that are smaller are zero if the rates are: steps toward a degenerate one shrink for ever, and those toward
/// one on what is invariant, as an axis without predators, end at any number next to zero.
const NOTHING: f64 = 1e-30;

/// More degenerate equilibria than this are a family, and more that are far away are some of infinitely many.
const FEW: usize = 4;

/// What vanishes where a mode rests.
pub(super) struct RatesAt {
    /// The values.
    pub values: Vector,
    /// Their derivatives by the states.
    pub slopes: Matrix,
    /// The terms of each, and what a rounding of each state makes of it.
    sizes: Vector,
}

impl RatesAt {
    /// Whether one of them is zero to rounding.
    pub(super) fn is_zero(&self, row: usize) -> bool {
        self.values[row].abs() <= ROUNDING * self.sizes[row]
    }
}

/// What Newton's method has at a state.
struct NewtonStep {
    /// The next state.
    next: Vector,
    /// Derivatives of the rates, and those of the equations that are solved; these include those of surfaces.
    slopes: Matrix,
    square: Matrix,
    /// The surfaces of the mode there.
    surfaces: Surfaces,
    /// What a rounding of every equation is relative to.
    sizes: Vector,
    /// Whether every equation that is solved holds to rounding.
    rests: bool,
    /// Whether the equations are regular.
    regular: bool,
}

/// A state at which a mode rests.
struct RestState {
    state: Vector,
    /// What each state is known to.
    error: Vector,
    slopes: Matrix,
    surfaces: Surfaces,
    isolation: Isolation,
}

impl RestState {
    fn is_same(&self, other: &RestState) -> bool {
        let degenerate = [self, other].map(|rest| rest.isolation != Isolation::Simple);
        (0..self.state.len()).all(|index| {
            let (x, y) = (self.state[index], other.state[index]);
            let known = SAME * (self.error[index] + other.error[index]) + f64::MIN_POSITIVE;
            let part = if degenerate.contains(&true) {
                SAME_DEGENERATE
            } else {
                SAME * f64::EPSILON
            };
            (x - y).abs() <= known + part * x.abs().max(y.abs())
        })
    }
}

impl AffineSystem {
    /// The equilibria of a mode: the one of an affine mode; of another all that Newton's method finds where no state
    /// exceeds 10, or 40 times its size, and those beyond where they are few, in the order of the first state.
    ///
    /// # Errors
    /// Why there is none, or a family of them.
    pub fn equilibria(&self, mode: usize) -> Result<Vec<Equilibrium>, NoEquilibrium> {
        let n = self.states;
        let own = &self.modes[mode];
        let AffineMode { field, matrix, .. } = own;
        let is_forced = |row: &Row| self.turns(&row.at);
        if field.is_forced(matrix, n) || own.surfaces().any(is_forced) {
            return Err(NoEquilibrium::Forced);
        }
        if field.is_exact {
            let rest = self.affine_rest(mode).ok_or(NoEquilibrium::Singular)?;
            return Ok(vec![self.equilibrium(mode, &rest)]);
        }
        let (mut found, mut far): (Vec<RestState>, Vec<RestState>) = Default::default();
        // in units of 1 and, where the mode has others, in its own
        let plain = Vector::from_element(n, 1.0);
        let sizes = self.sizes(mode);
        let usual = self.rates(mode, &sizes).map(|rates| rates.sizes);
        let is_alike = sizes
            .iter()
            .all(|size| (1.0 / ALIKE..=ALIKE).contains(size));
        let scaled = (!is_alike).then(|| sizes * BEYOND);
        let farthest = scaled.as_ref().unwrap_or(&plain).sup(&plain) * FARTHEST;
        for units in std::iter::once(&plain).chain(&scaled) {
            let (mut start, mut last) = (0, STARTS);
            while start < last {
                let state = place(start, n).component_mul(units);
                start += 1;
                let rest = self
                    .settle(mode, &state)
                    .or_else(|| self.settle_degenerate(mode, &state));
                if let Some(rest) = rest.filter(|rest| self.is_told(mode, rest, usual.as_ref())) {
                    let mut within = rest.state.iter().zip(&farthest);
                    let near = within.all(|(x, farthest)| x.abs() <= *farthest);
                    let list = if near { &mut found } else { &mut far };
                    if !list.iter().any(|known| known.is_same(&rest)) {
                        if near && rest.isolation == Isolation::Simple {
                            last = last.max(FURTHER * start).min(MOST_STARTS);
                        }
                        list.push(rest);
                    }
                }
            }
        }
        // a pendulum has infinitely many: those far away count where they are few, or where there is none nearby
        if found.is_empty() || far.len() <= FEW {
            found.append(&mut far);
        }
        single_out(&mut found);
        found.sort_by(|one, other| one.state[0].total_cmp(&other.state[0]));
        let found: Vec<_> = found
            .iter()
            .map(|rest| self.equilibrium(mode, rest))
            .collect();
        Some(found)
            .filter(|found| !found.is_empty())
            .ok_or(NoEquilibrium::NotFound)
    }

    /// Whether rates are zero at a degenerate equilibrium by more than that rounding of their terms hides what they are elsewhere, where
    /// terms have these sizes: far out exponentials leave nothing of the others.
    fn is_told(&self, mode: usize, rest: &RestState, usual: Option<&Vector>) -> bool {
        if rest.isolation == Isolation::Simple {
            return true;
        }
        let there = self.rates(mode, &rest.state);
        usual.zip(there).is_none_or(|(usual, there)| {
            let mut pairs = there.sizes.iter().zip(usual);
            pairs.all(|(there, usual)| *usual == 0.0 || ROUNDING * there <= usual * HIDDEN)
        })
    }

    /// The simple equilibrium of a mode that Newton's method finds from a state; of an affine mode the only one.
    pub(super) fn equilibrium_near(&self, mode: usize, state: &[f64]) -> Option<Equilibrium> {
        if self.modes[mode].field.is_exact {
            return self.equilibria(mode).ok()?.pop();
        }
        let rest = self.settle(mode, &Vector::from_column_slice(state))?;
        (rest.isolation == Isolation::Simple).then(|| self.equilibrium(mode, &rest))
    }

    /// The equilibrium of an affine mode.
    fn affine_rest(&self, mode: usize) -> Option<RestState> {
        let step = self.newton_step(mode, &Vector::zeros(self.states))?;
        step.regular.then(|| RestState {
            error: step.next.abs() * ROUNDING,
            state: step.next,
            slopes: step.slopes,
            surfaces: step.surfaces,
            isolation: Isolation::Simple,
        })
    }

    /// Newton's method for an equilibrium of a mode, until what is left is rounding.
    fn settle(&self, mode: usize, start: &Vector) -> Option<RestState> {
        let mut state = start.clone();
        let (mut stalled, mut before) = (0, f64::INFINITY);
        for _ in 0..STEPS {
            let step = self.newton_step(mode, &state)?;
            if !step.regular {
                if step.rests {
                    return Some(self.cleared_rest(mode, &state, step));
                }
                state = step.next;
                continue;
            }
            let error = known_to(&step)?;
            let mut moves = step.next.iter().zip(&state).zip(&error);
            let settled = moves.all(|((next, x), error)| {
                (next - x).abs() <= 4.0 * error + 2.0 * f64::EPSILON * next.abs()
            });
            if settled && step.rests {
                return Some(self.cleared_rest(mode, &state, step));
            }
            // rounding within the terms may be more than that of the terms: what is left of a step then is that, and no less next time
            let moved = (&step.next - &state).abs();
            let parts = moved.iter().zip(&state).zip(&error);
            let part = parts
                .map(|((moved, x), error)| moved / (JITTER * x.abs() + JITTERS * error))
                .fold(0.0, f64::max);
            stalled += usize::from(part <= 1.0 && part >= SHRINKS * before);
            before = part;
            if stalled == STALLED {
                let rest = self.cleared_rest(mode, &state, step);
                let error = rest.error.sup(&moved);
                return Some(RestState { error, ..rest });
            }
            state = step.next;
            if !state.iter().all(|x| x.is_finite()) {
                return None;
            }
        }
        None
    }

    /// The same where the steps shrink by a factor 1 − 1/m: after a few of them, every second step is m times as long. What is
    /// regular beside goes too far then, and is brought back by the steps between.
    fn settle_degenerate(&self, mode: usize, start: &Vector) -> Option<RestState> {
        let mut state = start.clone();
        let mut before = 0.0;
        let mut order = 1.0;
        for index in 0..PLAIN_STEPS + LONG_STEPS {
            let step = self.newton_step(mode, &state)?;
            let change = &step.next - &state;
            if step.rests {
                return Some(self.cleared_rest(mode, &state, step));
            }
            let length = change.norm();
            if index + 1 == PLAIN_STEPS {
                let ratio: f64 = length / before;
                order = (1.0 / (1.0 - ratio)).round();
                if !(2.0..=9.0).contains(&order) {
                    return None;
                }
            }
            before = length;
            let long = (index + 1)
                .checked_sub(PLAIN_STEPS)
                .is_some_and(|after| after % 2 == 0);
            state += change * if long { order } else { 1.0 };
            if !state.iter().all(|x| x.is_finite()) {
                return None;
            }
        }
        None
    }

    /// The equilibrium at a state, or at the one without what is next to nothing in it, if the mode rests there.
    fn cleared_rest(&self, mode: usize, state: &Vector, step: NewtonStep) -> RestState {
        let cleared = state.map(|x| if x.abs() < NOTHING { 0.0 } else { x });
        let rests = (cleared != *state).then(|| self.newton_step(mode, &cleared));
        match rests.flatten().filter(|step| step.rests) {
            Some(step) => self.rest(mode, &cleared, step),
            None => self.rest(mode, state, step),
        }
    }

    fn rest(&self, mode: usize, state: &Vector, step: NewtonStep) -> RestState {
        let error = known_to(&step).filter(|_| step.regular);
        let isolation = error.as_ref().map_or(Isolation::Degenerate, |error| {
            // the slopes at both ends of what the state is known to
            let beside = [1.0, -1.0].map(|sign| self.newton_step(mode, &(state + error * sign)));
            let inverse = Factors::new(&step.square).inverse();
            let changes = |beside: &Option<NewtonStep>| {
                let moved = beside.as_ref().zip(inverse.as_ref());
                moved.is_none_or(|(beside, inverse)| {
                    // in the units of the states in which that is least
                    let changed = inverse.abs() * (&beside.square - &step.square).abs();
                    radius(&changed) > CHANGED
                })
            };
            match beside.iter().any(changes) {
                true => Isolation::Degenerate,
                false => Isolation::Simple,
            }
        });
        RestState {
            state: state.clone(),
            error: error.unwrap_or_else(|| state.abs() * f64::EPSILON),
            slopes: step.slopes,
            surfaces: step.surfaces,
            isolation,
        }
    }

    /// What vanishes where a mode rests, at a state: its rates, then its surfaces. `None` where one has no value.
    pub(super) fn rates(&self, mode: usize, state: &Vector) -> Option<RatesAt> {
        let n = self.states;
        let own = &self.modes[mode];
        let AffineMode { matrix, field, .. } = own;
        let z = self.lift(mode, state.as_slice(), 0.0);
        let extra = own.surfaces().map(|row| row.at.transpose());
        let rates = (0..n).map(|row| matrix.at.row(row).into_owned());
        let rows: Vec<_> = rates.chain(extra).collect();
        let equations = Matrix::from_rows(&rows);
        let slopes = match field.is_exact {
            true => Matrix::identity(z.len(), n),
            false => field.series(&z, 0, true, true).derivatives().0,
        };
        let slopes = &equations * slopes.columns(0, n);
        let values = &equations * &z;
        let sizes = equations.abs() * z.abs() + slopes.abs() * state.abs();
        let finite = slopes.iter().chain(&values).all(|x| x.is_finite());
        finite.then_some(RatesAt {
            values,
            slopes,
            sizes,
        })
    }

    /// Where the rates of a mode are zero if they change as at a state, and their derivatives there; where these are
    /// singular the nearest such place. `None` where rates have no value.
    fn newton_step(&self, mode: usize, state: &Vector) -> Option<NewtonStep> {
        let n = self.states;
        let rates = self.rates(mode, state)?;
        let slopes = rates.slopes.rows(0, n).into_owned();
        let gradients = (n..rates.slopes.nrows()).map(|row| rates.slopes.row(row).transpose());
        let surfaces = Surfaces::balanced(&gradients.collect::<Vec<_>>(), &slopes);
        // the rates of states that surfaces give follow from the others, and give way to their equations
        let mut solved_rows: Vec<usize> = (0..n).collect();
        for (row, form) in surfaces.given() {
            solved_rows[row] = n + form;
        }
        let rests = solved_rows.iter().all(|row| rates.is_zero(*row));
        let square = rates.slopes.select_rows(&solved_rows);
        let right = (&rates.slopes * state - &rates.values).select_rows(&solved_rows);
        let solved = solve(&square, &right);
        let regular = solved.is_some();
        let nearest = || Some(state - pseudo_inverse(&square, 1e-13)? * (&square * state - &right));
        Some(NewtonStep {
            next: solved.or_else(nearest)?,
            slopes,
            surfaces,
            square,
            sizes: rates.sizes.select_rows(&solved_rows),
            rests,
            regular,
        })
    }

    fn equilibrium(&self, mode: usize, rest: &RestState) -> Equilibrium {
        let known = known_eigenvalues(&rest.surfaces.within(&rest.slopes)).unwrap_or_default();
        // one eigenvalue of a degenerate equilibrium is zero, and only another that grows decides
        let is_simple = rest.isolation == Isolation::Simple;
        let least = known
            .iter()
            .enumerate()
            .min_by(|(_, one), (_, other)| one.value.norm().total_cmp(&other.value.norm()));
        let zero = least.map(|(index, _)| index).filter(|_| !is_simple);
        let mut decisive = known
            .iter()
            .enumerate()
            .filter(|(index, _)| Some(*index) != zero);
        let grows = decisive.any(|(_, one)| one.value.re > one.error);
        let decays = is_simple && known.iter().all(|one| one.value.re < -one.error);
        let mut eigenvalues: Vec<Complex<f64>> = known.iter().map(|one| one.value).collect();
        eigenvalues.sort_by(|one, other| {
            let key = |value: &Complex<f64>| (-value.re, -value.im);
            let (one, other) = (key(one), key(other));
            one.0.total_cmp(&other.0).then(one.1.total_cmp(&other.1))
        });
        let known_states = rest.state.iter().zip(&rest.error);
        let known_states: Vec<Interval> = known_states
            .map(|(x, error)| Interval::around(*x, *error))
            .collect();
        Equilibrium {
            mode,
            state: rest.state.iter().copied().collect(),
            eigenvalues,
            stable: if grows {
                Some(false)
            } else {
                decays.then_some(true)
            },
            slopes: rest.slopes.clone(),
            place: self.place(mode, &known_states),
            isolation: rest.isolation,
        }
    }
}

/// First-order bound of what rounding of the rates leaves in each state: |J⁻¹| times the rounding of the terms of each.
fn known_to(step: &NewtonStep) -> Option<Vector> {
    let inverse = Factors::new(&step.square).inverse()?;
    Some(inverse.abs() * (&step.sizes * ROUNDING))
}

/// The places from which equilibria are looked for: as many of every size, first 0, then the golden sequence of every state.
fn place(start: usize, states: usize) -> Vector {
    let of_all = (start % STARTS) as f64 / STARTS as f64;
    let size = match of_all < 0.75 {
        true => FARTHEST.powf(2.0 * of_all / 0.75 - 1.0),
        false => SMALLEST.powf(4.0 * of_all - 3.0),
    };
    let shares = even(start).take(states);
    let shares = shares.map(|share| size * (2.0 * share - 1.0));
    let mut place = Vector::from_iterator(states, shares);
    if start == 0 {
        place.fill(0.0);
    }
    place
}

/// Of many degenerate equilibria one stands for all, the nearest to zero.
fn single_out(found: &mut Vec<RestState>) {
    let degenerate = |rest: &RestState| rest.isolation == Isolation::Degenerate;
    if found.iter().filter(|rest| degenerate(rest)).count() <= FEW {
        return;
    }
    let (family, mut simple): (Vec<RestState>, Vec<RestState>) =
        found.drain(..).partition(degenerate);
    let nearest = family
        .into_iter()
        .min_by(|one, other| one.state.norm().total_cmp(&other.state.norm()));
    simple.extend(nearest.map(|rest| RestState {
        isolation: Isolation::Family,
        ..rest
    }));
    *found = simple;
}
