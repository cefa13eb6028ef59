//! The flow of a mode at fixed parameters, piece by piece: exact states where it is linear, those of a series where it
//! is not, and every guard as a polynomial whose sign is proven over the whole piece.

mod exact;

use super::mode::{AffineMode, Row};
use super::recurrence::{ROUNDING, Series};
use super::series::{Field, ORDER};
use super::stiff::{Splitting, Vanished};
use crate::linalg::{Vector, add_product, balance, product};
use crate::orbit::sign::{Bernstein, COEFFICIENTS};
use exact::Exact;

/// A guard is zero at the beginning of a zone within this many units of the noise of its polynomial: the
/// state at a switch is known to a few of them.
const ON_GUARD: f64 = 8.0;

/// Longest step of the Newton step that polishes a crossing, in units of a piece: longer, and the crossing is so
/// flat that the guard itself is rounding there.
const POLISHED: f64 = 1e-10;

/// More pieces than this are not gone through: no zone of interest has them, and their examination would take longer
/// than a second.
pub(super) const MOST_PIECES: f64 = 1e5;

/// The length by which the pieces that are left are counted, after a piece of this length and those before it: of pieces in a row the
/// longest counts, and ever less from one to the next. A kink may cut one short, and beside a root they grow from next to nothing.
pub(super) fn counted(before: f64, length: f64) -> f64 {
    /// From the whole of a zone down to a piece of which it has too many it takes a hundred pieces.
    const LESS: f64 = 0.9;
    length.max(LESS * before)
}

/// The flow of a mode.
#[derive(Clone, Debug)]
pub struct ModeFlow {
    /// Guards as forms of z.
    guards: Vec<Vector>,
    field: Field,
    /// Longest piece.
    longest: f64,
    /// Where the mode is linear.
    exact: Option<Exact>,
}

/// z over the beginning of a piece: coefficients of powers of time/`length`/`part`.
#[derive(Default)]
pub(super) struct Expansion {
    /// Of every component; of the states alone where the mode is not linear.
    terms: Vec<[f64; COEFFICIENTS]>,
}

/// A piece of a motion.
#[derive(Clone, Debug)]
pub struct FlowPiece {
    /// z at its beginning.
    pub z: Vector,
    /// How long it is.
    pub length: f64,
    course: PieceMotion,
}

/// What is known of z over a piece.
#[derive(Clone, Debug)]
enum PieceMotion {
    /// It is that of a linear mode.
    Exact,
    /// It is that of its slow part alone, by this number.
    Slow(usize, Vanished),
    /// Where the mode is not linear.
    Series(Series),
}

impl FlowPiece {
    /// One of a mode that is integrated, by its series, which holds so long.
    pub(super) fn integrated(series: Series, length: f64) -> FlowPiece {
        FlowPiece {
            z: series.first(),
            length,
            course: PieceMotion::Series(series),
        }
    }
}

impl Expansion {
    /// The coefficients of a component.
    pub fn taylor(&self, component: usize) -> &[f64; COEFFICIENTS] {
        &self.terms[component]
    }

    /// Sets the coefficients of an order.
    fn set(&mut self, order: usize, of_components: &[f64]) {
        let pairs = self.terms.iter_mut().zip(of_components);
        pairs.for_each(|(terms, coefficient)| terms[order] = *coefficient);
    }
}

/// What a guard does at the beginning of a zone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Onset {
    /// It is positive, but for a zero of this order at the very beginning.
    Positive(usize),
    /// It is negative at once.
    Negative,
    /// It is zero over the whole piece.
    Zero,
}

/// The coefficients of a form over the beginning of a piece of a series, what they leave out, and the rounding
/// of what they are made of.
fn polynomial(piece: &FlowPiece, part: f64, row: &Vector) -> ([f64; COEFFICIENTS], f64) {
    let PieceMotion::Series(series) = &piece.course else {
        return ([0.0; COEFFICIENTS], f64::INFINITY);
    };
    let length = part * piece.length;
    let (mut all, mut amplitude) = ([0.0; ORDER + 1], 0.0);
    for (c, by) in row.iter().enumerate().filter(|(_, by)| **by != 0.0) {
        let z = series.values(c);
        amplitude += (by * z[0]).abs();
        all.iter_mut().zip(z).for_each(|(sum, z)| *sum += by * z);
    }
    let mut power = 1.0;
    for coefficient in &mut all {
        *coefficient *= power;
        power *= length;
    }
    let taylor: [f64; COEFFICIENTS] = std::array::from_fn(|k| all[k]);
    // the terms left out fall geometrically, by less than a half
    let rest: f64 = all[COEFFICIENTS..].iter().map(|x| x.abs()).sum();
    let changes: f64 = taylor[1..].iter().map(|a: &f64| a.abs()).sum();
    (
        taylor,
        2.0 * rest + 2.0 * f64::EPSILON * (amplitude + changes),
    )
}

/// That of a state.
fn of_state(piece: &FlowPiece, part: f64, state: usize) -> ([f64; COEFFICIENTS], f64) {
    polynomial(piece, part, &Row::unit(piece.z.len(), state).at)
}

impl ModeFlow {
    /// The flow of a mode in pieces no longer than `longest`.
    pub fn new(mode: &AffineMode, longest: f64) -> ModeFlow {
        ModeFlow::balanced(mode, longest, || balance(&mode.matrix.at, longest.recip()))
    }

    /// The same, where the matrix has been balanced.
    pub fn balanced(
        mode: &AffineMode,
        longest: f64,
        balance: impl FnOnce() -> (Vector, f64),
    ) -> ModeFlow {
        ModeFlow {
            guards: mode
                .guards
                .iter()
                .map(|guard| guard.row.at.clone())
                .collect(),
            field: mode.field.clone(),
            exact: mode
                .field
                .is_exact
                .then(|| Exact::of(mode, longest, balance())),
            longest,
        }
    }

    /// One more linear form of z whose sign is looked at, after those that are there.
    pub(super) fn watch(&mut self, form: Vector) {
        self.field.watch(&form);
        self.guards.push(form.clone());
        if !self.field.is_exact {
            self.exact = None;
        } else if let Some(exact) = &mut self.exact {
            exact.watch(form);
        }
    }

    /// Watches the bounds of friction of its mode.
    pub(super) fn watch_bounds(&mut self, mode: &AffineMode) {
        let bounds = mode.bounds.iter();
        bounds.for_each(|(_, bound)| self.watch(bound.at.clone()));
    }

    /// The splitting that knows exp(Mt) best, where it is stiff.
    pub(super) fn split(&self, time: f64) -> Option<&Splitting> {
        let ways = self.exact.iter().flat_map(|exact| &exact.stiff);
        let ways = ways.map(|(way, _)| way);
        ways.min_by(|one, other| one.rounding(time).total_cmp(&other.rounding(time)))
    }

    /// Whether a piece begins in numbers where the rates have values, and has a length.
    pub(super) fn is_defined(&self, piece: &FlowPiece) -> bool {
        piece.length > 0.0
            && piece.z.iter().all(|x| x.is_finite())
            && !self.lacks_value(&piece.z, ROUNDING)
    }

    /// Whether a root in the rates is zero where a piece begins.
    pub(super) fn begins_at_root(&self, piece: &FlowPiece) -> bool {
        match &piece.course {
            PieceMotion::Series(series) => self.field.begins_at_root(series),
            _ => false,
        }
    }

    /// Whether the rates have no value at z, by more than this part of what they are made of.
    pub(super) fn lacks_value(&self, z: &Vector, part: f64) -> bool {
        self.field.lacks_value(|c| z[c], part)
    }

    /// The piece that begins at z. Its length is no number where the rates have no value.
    pub fn piece(&self, mut z: Vector) -> FlowPiece {
        let (length, course) = match &self.exact {
            Some(exact) => {
                let mut slow = exact.stiff.iter().enumerate();
                let slow = slow.find_map(|(index, (way, slow))| {
                    Some((slow.length, PieceMotion::Slow(index, way.vanished(&z)?)))
                });
                slow.unwrap_or((exact.length, PieceMotion::Exact))
            }
            None => {
                let series = self.field.series(&z, ORDER, false, true);
                z = series.first();
                let length = self.field.length(&series, self.longest, true);
                (length, PieceMotion::Series(series))
            }
        };
        FlowPiece { z, length, course }
    }

    /// Length of the longest piece that may follow one, where that is known before.
    pub(super) fn longest(&self, piece: &FlowPiece) -> f64 {
        let slow = self.exact.iter().flat_map(|exact| exact.stiff.first());
        slow.map(|(_, slow)| slow.length)
            .fold(piece.length, f64::max)
    }

    /// z after a whole piece.
    pub fn advance(&self, piece: &FlowPiece) -> Vector {
        match (&self.exact, &piece.course) {
            (Some(exact), PieceMotion::Exact) => product(&exact.step, &piece.z),
            (Some(exact), PieceMotion::Slow(index, at)) => {
                let (way, slow) = &exact.stiff[*index];
                &way.along * product(&slow.step, &at.slow)
            }
            _ => self.within(piece, piece.length),
        }
    }

    /// z after a part of a piece, 0 ≤ `time` ≤ its length.
    pub fn within(&self, piece: &FlowPiece, time: f64) -> Vector {
        match (&self.exact, &piece.course) {
            (Some(exact), PieceMotion::Exact) => exact.within(&piece.z, time),
            (Some(exact), PieceMotion::Slow(index, at)) => {
                let (way, slow) = &exact.stiff[*index];
                &way.along * slow.within(&at.slow, time)
            }
            (_, PieceMotion::Series(series)) => {
                let mut z = series.at(time);
                self.field.complete(&mut z);
                z
            }
            (None, _) => piece.z.clone(),
        }
    }

    /// z at a time ≥ 0 after the beginning; no numbers where that is more than [`MOST_PIECES`] away.
    pub(super) fn after(&self, z: &Vector, time: f64) -> Vector {
        let (mut piece, mut rest) = (self.piece(z.clone()), time);
        let mut before = time;
        while rest > piece.length {
            before = counted(before, piece.length);
            if rest > MOST_PIECES * before {
                return Vector::from_element(z.len(), f64::NAN);
            }
            rest -= piece.length;
            piece = self.piece(self.advance(&piece));
        }
        self.within(&piece, rest)
    }

    /// Value, rate and curvature of a form of which this mode has all components, at z.
    pub(super) fn slopes(&self, row: &Vector, z: &Vector) -> [f64; 3] {
        match &self.exact {
            Some(Exact { matrix, .. }) => {
                let through = |row: &Vector| {
                    let mut through = Vector::zeros(row.len());
                    let sum = through.as_mut_slice();
                    add_product(1.0, row.as_slice(), 1, matrix.as_slice(), sum);
                    through
                };
                let rate = through(row);
                [row, &rate, &through(&rate)].map(|row| row.dot(z))
            }
            None => {
                let series = self.field.series(z, 2, false, true);
                [0, 1, 2].map(|k| (1.0 + f64::from(k == 2)) * series.of(row, k as usize))
            }
        }
    }

    /// z over the beginning of a piece, of so many states, in place of another expansion.
    pub(super) fn expand(
        &self,
        piece: &FlowPiece,
        part: f64,
        states: usize,
        expansion: &mut Expansion,
    ) {
        *expansion = match (&self.exact, &piece.course) {
            (Some(exact), PieceMotion::Slow(index, at)) => {
                let (way, slow) = &exact.stiff[*index];
                let mut of_slow = Expansion::default();
                slow.expand(&at.slow, part, &mut of_slow);
                let sum = |state: usize, of: &dyn Fn(usize, f64) -> f64| -> f64 {
                    let along = way.along.row(state);
                    along.iter().enumerate().map(|(c, by)| of(c, *by)).sum()
                };
                let of_order = |state, k: usize| sum(state, &|c, by| by * of_slow.terms[c][k]);
                let term = |state| std::array::from_fn(|k| of_order(state, k));
                Expansion {
                    terms: (0..states).map(term).collect(),
                }
            }
            (Some(exact), _) => return exact.expand(&piece.z, part, expansion),
            (None, _) => Expansion {
                terms: (0..states)
                    .map(|state| of_state(piece, part, state).0)
                    .collect(),
            },
        };
    }

    /// What the expansion of so many states leaves out.
    pub(super) fn left_out(
        &self,
        (piece, part): (&FlowPiece, f64),
        states: usize,
        expansion: &Expansion,
    ) -> Vec<f64> {
        match (&self.exact, &piece.course) {
            (Some(exact), PieceMotion::Slow(index, at)) => {
                let (way, slow) = &exact.stiff[*index];
                let mut of_slow = Expansion::default();
                slow.expand(&at.slow, part, &mut of_slow);
                let left_out = Vector::from_vec(slow.left_out(&of_slow, part));
                let all = way.along.abs() * left_out;
                all.rows(0, states).iter().copied().collect()
            }
            (Some(exact), _) => exact.left_out(expansion, part),
            (None, _) => (0..states)
                .map(|state| of_state(piece, part, state).1)
                .collect(),
        }
    }

    /// A guard over the beginning of a piece over which z is known.
    pub(super) fn guard_of(
        &self,
        guard: usize,
        (piece, part): (&FlowPiece, f64),
        expansion: &Expansion,
    ) -> ([f64; COEFFICIENTS], f64) {
        let (Some(exact), PieceMotion::Exact) = (&self.exact, &piece.course) else {
            return self.taylor(guard, piece, part);
        };
        let series = &exact.guards[guard];
        let mut taylor = [0.0; COEFFICIENTS];
        for (component, weight) in series.form.as_slice().iter().enumerate() {
            if *weight != 0.0 {
                let pairs = taylor.iter_mut().zip(expansion.taylor(component));
                pairs.for_each(|(sum, a)| *sum += weight * a);
            }
        }
        (taylor, exact.error(guard, &piece.z, part, 0))
    }

    /// A guard over the beginning of a piece, as a polynomial in time/`length`/`part`.
    pub(super) fn taylor(
        &self,
        guard: usize,
        piece: &FlowPiece,
        part: f64,
    ) -> ([f64; COEFFICIENTS], f64) {
        self.taylor_beyond(guard, piece, part, 0)
    }

    /// The same, and what the polynomial without its first coefficients, so many, leaves out where these are zero.
    fn taylor_beyond(
        &self,
        guard: usize,
        piece: &FlowPiece,
        part: f64,
        zeros: usize,
    ) -> ([f64; COEFFICIENTS], f64) {
        match (&self.exact, &piece.course) {
            (Some(exact), PieceMotion::Slow(index, at)) => {
                let (way, slow) = &exact.stiff[*index];
                let (taylor, remainder) = slow.taylor(guard, &at.slow, part, zeros);
                let left_out = way.of_fast(&self.guards[guard]) * at.left_out;
                (taylor, remainder + left_out)
            }
            (Some(exact), _) => exact.taylor(guard, &piece.z, part, zeros),
            (None, _) => polynomial(piece, part, &self.guards[guard]),
        }
    }

    /// A bound of friction of the mode that is negative over the beginning of a piece: the guard that is its slip, the time of its
    /// least value after that beginning, and that value. The bounds are the forms watched last.
    pub(super) fn negative_bound(
        &self,
        mode: &AffineMode,
        piece: &FlowPiece,
        part: f64,
    ) -> Option<(usize, f64, f64)> {
        let first = self.guards.len() - mode.bounds.len();
        let bounds = mode.bounds.iter().enumerate();
        let mut negative = bounds.filter_map(|(index, (guard, _))| {
            let (after, value) = self.least_below_zero(first + index, piece, part)?;
            Some((*guard, after, value))
        });
        negative.next()
    }

    /// Where a form that is watched is least over the beginning of a piece, as a time after that, and its value there; `None`
    /// where it is positive but for rounding.
    fn least_below_zero(&self, guard: usize, piece: &FlowPiece, part: f64) -> Option<(f64, f64)> {
        /// Part of its terms within which it is zero but for rounding.
        const ZERO: f64 = 1e-9;
        let form = &self.guards[guard];
        let (taylor, left_out) = self.taylor(guard, piece, part);
        let others: f64 = taylor[1..].iter().map(|a| a.abs()).sum();
        if taylor[0] > others + left_out {
            return None;
        }
        let turns = Bernstein::from_taylor(&taylor, left_out).minima(&mut false);
        let value = |place: f64| taylor.iter().rev().fold(0.0, |sum, a| sum * place + a);
        let places = [0.0, 1.0].into_iter().chain(turns);
        let valued = places.map(|place| (place, value(place)));
        let (place, least) = valued.min_by(|one, other| one.1.total_cmp(&other.1))?;
        let terms: f64 = form
            .iter()
            .zip(&piece.z)
            .filter(|(c, _)| **c != 0.0)
            .map(|(c, z)| (c * z).abs())
            .sum();
        let is_negative = least < -ZERO * terms.max(others) - left_out;
        is_negative.then_some((place * part * piece.length, least))
    }

    /// What a guard does just after a zone begins with a piece.
    pub(super) fn onset(&self, guard: usize, piece: &FlowPiece) -> Onset {
        self.onset_from(guard, piece, 0)
    }

    /// The same, where the first coefficients, so many, are known to be zero.
    pub(super) fn onset_from(&self, guard: usize, piece: &FlowPiece, zeros: usize) -> Onset {
        let (mut taylor, remainder) = self.taylor(guard, piece, 1.0);
        taylor[..zeros].fill(0.0);
        let largest = taylor.iter().fold(0.0, |size: f64, a| size.max(a.abs()));
        let rounding = match &piece.course {
            PieceMotion::Series(series) => {
                let form = &self.guards[guard];
                f64::EPSILON * piece.length * self.field.size_of_rate(series, form)
            }
            _ => 0.0,
        };
        let noise = ON_GUARD * (remainder + f64::EPSILON * largest + rounding);
        match taylor.iter().position(|a| a.abs() > noise) {
            None => Onset::Zero,
            Some(order) if taylor[order] > 0.0 => Onset::Positive(order),
            Some(_) => Onset::Negative,
        }
    }

    /// Time at which a guard first becomes negative within `part` of a piece, where it has a zero of this order at the
    /// beginning: divided out, so that the shortest zone is told from none.
    pub(super) fn crossing(
        &self,
        guard: usize,
        piece: &FlowPiece,
        order: usize,
        part: f64,
    ) -> Option<f64> {
        let (mut taylor, remainder) = self.taylor_beyond(guard, piece, part, order);
        taylor[..order].fill(0.0);
        taylor.rotate_left(order);
        // most guards are far from zero most of the time
        let others: f64 = taylor[1..].iter().map(|a| a.abs()).sum();
        if taylor[0] > others + remainder {
            return None;
        }
        let polynomial = Bernstein::from_taylor(&taylor, remainder);
        let place = polynomial.first_crossing()?;
        let time = place * part * piece.length;
        if order > 0 {
            return Some(time);
        }
        // one step of Newton's method on the guard itself takes away the rounding of the polynomial
        let z = self.within(piece, time);
        let [value, slope] = match &self.exact {
            Some(exact) => {
                let of_order = |k: usize| {
                    let components = exact.coefficients(guard).iter().zip(&z);
                    components.map(|(orders, z)| orders[k] * z).sum::<f64>()
                };
                [of_order(0), of_order(1) / exact.length]
            }
            None => {
                let [value, slope, _] = self.slopes(&self.guards[guard], &z);
                [value, slope]
            }
        };
        let better = time - value / slope;
        let close = (better - time).abs() <= POLISHED * piece.length;
        if close {
            return Some(better.max(0.0));
        }
        // a guard that is hardly above zero at the beginning of the piece falls below its noise long after its zero
        let zero = polynomial.zero_before(place);
        Some(zero.map_or(time, |zero| zero * part * piece.length))
    }
}
