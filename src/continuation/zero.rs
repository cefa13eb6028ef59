//! Zeros of functions of one variable, from a bracket. Every search of the crate for a single zero is
//! one of three:
//!
//! | search | knows of the function | guarantee |
//! |---|---|---|
//! | [`zero`] | values | the bracket is kept and halved at least once in [`PATIENCE`] + 1 values |
//! | [`zero_by_slope`] | values and slopes | the bracket is kept; at most [`MOST_STEPS`] values |
//! | [`boundary`] | on which side a place lies | the bracket is halved by every value |
//!
//! The simulation of the ring has a search of its own, for it shares nothing with the rest.

/// Places in a row that need not halve a bracket, before the next one is its middle.
pub const PATIENCE: u32 = 12;

/// Most values of [`zero_by_slope`] and of [`boundary`].
pub(crate) const MOST_STEPS: usize = 200;

/// Two places at which a function has values of different signs.
#[derive(Clone, Copy, Debug)]
pub struct Bracket {
    /// Lower place and the weight of its value.
    pub low: (f64, f64),
    /// Upper place and the weight of its value.
    pub high: (f64, f64),
    /// The end that moved last: −1 the lower, 1 the upper, 0 none yet.
    side: i8,
}

impl Bracket {
    /// A bracket from places and values.
    pub fn new(low: (f64, f64), high: (f64, f64)) -> Bracket {
        Bracket { low, high, side: 0 }
    }

    /// Where the secant is zero: in the bracket, but for rounding.
    fn secant(&self) -> f64 {
        (self.low.0 * self.high.1 - self.high.0 * self.low.1) / (self.high.1 - self.low.1)
    }

    /// Takes in the value at a place inside.
    pub(super) fn shrink(&mut self, place: f64, value: f64) {
        let lower = (value > 0.0) == (self.low.1 > 0.0);
        let (moved, kept, side) = if lower {
            (&mut self.low, &mut self.high, -1)
        } else {
            (&mut self.high, &mut self.low, 1)
        };
        *moved = (place, value);
        if self.side == side {
            kept.1 *= 0.5;
        }
        self.side = side;
    }

    fn width(&self) -> f64 {
        (self.high.0 - self.low.0).abs()
    }
}

/// Where a search ended.
#[derive(Clone, Copy, Debug)]
pub struct Zero<T> {
    /// The last place.
    pub place: f64,
    /// What the function found there besides its value.
    pub found: T,
    /// What is left of the bracket, the last place being one of its ends.
    pub bracket: Bracket,
}

/// A zero in a bracket by the Illinois variant of the secant rule.
///
/// The secant of a bracket converges from one side and leaves the other end behind; halving the value
/// remembered there when the same side moves twice brings it along: order 1.44 without derivatives at
/// a simple zero of a smooth function (Dowell & Jarratt, BIT 11 (1971) 168). Where [`PATIENCE`] places
/// have not halved the bracket its middle is next, so that there are at most
/// (`PATIENCE` + 1)·log₂(width of the bracket/`width`) values for any function.
///
/// The search ends where the value is exactly zero, which a function should return where nothing but
/// rounding is left, or where the bracket is narrower than `width` or two neighbouring numbers.
///
/// # Errors
/// The first one of the function.
pub fn zero<T, E>(
    mut bracket: Bracket,
    width: f64,
    mut f: impl FnMut(f64) -> Result<(f64, T), E>,
) -> Result<Zero<T>, E> {
    let mut halved = bracket.width();
    let mut waited = 0;
    loop {
        let (low, high) = (bracket.low.0, bracket.high.0);
        let middle = 0.5 * (low + high);
        let neighbours = middle == low || middle == high;
        let mut place = bracket.secant();
        if !(place >= low.min(high) && place <= low.max(high)) || waited >= PATIENCE {
            place = middle;
        }
        let (value, found) = f(place)?;
        bracket.shrink(place, value);
        if value == 0.0 || bracket.width() < width || neighbours {
            return Ok(Zero {
                place,
                found,
                bracket,
            });
        }
        waited += 1;
        if bracket.width() <= 0.5 * halved {
            (halved, waited) = (bracket.width(), 0);
        }
    }
}

/// A zero in a bracket by Newton's method, from a guess. `f` gives value and slope; it is negative at
/// the first end of the bracket, which may be the upper one, and positive at the second. A step that
/// would leave the bracket goes to its middle instead.
///
/// The search ends with a step that is short `enough`, by its length and the place it begins at. The
/// answer is that place and the one the step leads to, whose error is of the order of the square of
/// the step at a simple zero: convergence is quadratic.
pub(crate) fn zero_by_slope(
    (mut negative, mut positive): (f64, f64),
    guess: f64,
    mut enough: impl FnMut(f64, f64) -> bool,
    f: impl Fn(f64) -> (f64, f64),
) -> (f64, f64) {
    let mut place = guess;
    let mut steps = 0;
    loop {
        let (value, slope) = f(place);
        if value < 0.0 {
            negative = place;
        } else {
            positive = place;
        }
        let mut next = place - value / slope;
        if !(next > negative.min(positive) && next < negative.max(positive)) {
            next = 0.5 * (negative + positive);
        }
        steps += 1;
        let near = enough((next - place).abs(), place);
        if near || next == negative || next == positive || steps == MOST_STEPS {
            return (place, next);
        }
        place = next;
    }
}

/// The two sides of the place between `near` and `far` beyond which a condition holds, by bisection:
/// closer to one another than `relative` times the second of them, or neighbouring numbers, or 2^−200
/// of their distance at first. The condition holds at the second, if it is not still `far`.
pub fn boundary((near, far): (f64, f64), relative: f64, holds: impl Fn(f64) -> bool) -> (f64, f64) {
    let (mut before, mut beyond) = (near, far);
    for _ in 0..MOST_STEPS {
        let middle = 0.5 * (before + beyond);
        let near = (beyond - before).abs() <= relative * beyond.abs();
        if near || middle == before || middle == beyond {
            break;
        }
        if holds(middle) {
            beyond = middle;
        } else {
            before = middle;
        }
    }
    (before, beyond)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::Cell;

    /// A function together with the number of its values.
    fn counted(count: &Cell<u32>, f: impl Fn(f64) -> f64) -> impl Fn(f64) -> Result<(f64, ()), ()> {
        move |x| {
            count.set(count.get() + 1);
            Ok((f(x), ()))
        }
    }

    fn of(f: impl Fn(f64) -> f64, low: f64, high: f64) -> (f64, u32) {
        let count = Cell::new(0);
        let bracket = Bracket::new((low, f(low)), (high, f(high)));
        let place = zero(bracket, 1e-15, counted(&count, &f)).unwrap().place;
        (place, count.get())
    }

    /// cos x = x³ to rounding in few steps, from values of very different size.
    #[test]
    fn a_simple_zero_takes_few_values() {
        let f = |x: f64| x.cos() - x * x * x;
        let (place, count) = of(f, 0.0, 4.0);
        assert!(
            f(place).abs() < 1e-15 && count < 17,
            "{place} after {count}"
        );
    }

    /// A zero of order 99, and a jump next to an end: the bracket shrinks all the same.
    #[test]
    fn the_number_of_values_is_bounded() {
        let bound = (PATIENCE + 1) * 55;
        let (_, count) = of(|x: f64| (x - 0.3).powi(99), 0.0, 1.0);
        assert!(count < bound, "{count}");
        let jump = |x: f64| if x < 1e-9 { -1e-300 } else { 1e300 };
        let (place, count) = of(jump, 0.0, 1.0);
        assert!((place - 1e-9).abs() <= 1e-15 && count < bound, "{count}");
    }

    /// Between neighbouring numbers a secant is rounding: it may stay at an end, or leave the bracket.
    #[test]
    fn a_bracket_of_a_few_numbers_is_searched_to_its_end() {
        let number = |index: u32| 0.5 + 0.5 * f64::EPSILON * f64::from(index);
        for (last, height) in
            (2..12).flat_map(|last| (-40..40).map(move |e| (last, 1.7_f64.powi(e))))
        {
            for step in 1..last {
                let values = Cell::new(0);
                let f = |x: f64| {
                    values.set(values.get() + 1);
                    assert!(values.get() <= 4 * (PATIENCE + 1), "{last} {height} {step}");
                    Ok::<_, ()>((if x < number(step) { height } else { -0.3 }, ()))
                };
                let bracket = Bracket::new((0.5, height), (number(last), -0.3));
                let found = zero(bracket, f64::EPSILON, f).unwrap().bracket;
                assert!(found.low.0 < number(step) && found.high.0 >= number(step));
            }
        }
    }

    #[test]
    fn an_error_ends_the_search() {
        let bracket = Bracket::new((0.0, -1.0), (1.0, 1.0));
        assert_eq!(zero::<(), _>(bracket, 0.0, |_| Err("no")).err(), Some("no"));
    }

    /// Newton's method on x³ = 2 from a guess outside its basin, and on a function whose slope it
    /// cannot use.
    #[test]
    fn slopes_lead_to_the_zero() {
        let rounded = |step: f64, x: f64| step <= 2.0 * f64::EPSILON * x.abs();
        let f = |x: f64| (x * x * x - 2.0, 3.0 * x * x);
        let (_, place) = zero_by_slope((-5.0, 5.0), -1e-3, rounded, f);
        assert!((place - 2.0_f64.cbrt()).abs() < 4.0 * f64::EPSILON);
        let flat = |x: f64| ((x - 0.7).signum(), 0.0);
        let (_, place) = zero_by_slope((0.0, 1.0), 0.5, rounded, flat);
        assert!((place - 0.7).abs() < 4.0 * f64::EPSILON);
    }

    #[test]
    fn a_boundary_is_found_to_the_last_digit() {
        let (before, beyond) = boundary((0.0, 2.0), 0.0, |x| x * x >= 2.0);
        assert!(before * before < 2.0 && beyond * beyond >= 2.0);
        assert_eq!(before.next_up(), beyond);
        // downwards, and a place that is zero
        let (before, beyond) = boundary((3.0, -1.0), 0.0, |x| x <= 0.0);
        assert!(before > 0.0 && before < 1e-50 && beyond <= 0.0);
    }
}
