//! How long the series of a field holds.
//!
//! The polynomial of degree 16 holds until the terms of the next two degrees are as large as the tolerance allows, beside other terms of
//! the same component, or of what that acts on. They know nothing of what is smaller than rounding at the beginning, and so is in all
//! of its derivatives, as tanh kv where it is 1 or exp(−kx²) far from x = 0: of a function that may be so its values over the range of its operand
//! tell whether its polynomial has all that it does.

use super::algebra::Function;
use super::coefficients::Sparse;
use super::form::Rule;
use super::program::Program;
use super::recurrence::{ProgramStep, Series};
use super::series::{Field, ORDER};
use crate::orbit::sign::{Bernstein, COEFFICIENTS};

/// Of what polynomials of derivatives leave out as much more is allowed than of the motion, so that no piece is shorter for it where
/// perturbations are as smooth as the motion.
const MORE: f64 = 1e3;

impl Field {
    /// What rounding of the terms of its rate leaves in an order of a state; zero of other components.
    fn rounding_of_order(&self, series: &Series, component: usize, order: usize) -> f64 {
        let terms = self
            .rates
            .get(component)
            .map_or(&[][..], |rate| &rate.terms);
        let size = terms
            .iter()
            .map(|(j, by)| (by.value * series.values(*j)[order - 1]).abs());
        2.0 * f64::EPSILON * size.sum::<f64>() / order as f64
    }

    /// Sizes of the terms of which a product is made, over a length of these powers: where they cancel, as in x(μ − x² − y²) on
    /// the circle, the product has their rounding. Zero of other components.
    fn size_of_product(&self, series: &Series, component: usize, powers: &[f64; ORDER + 1]) -> f64 {
        let step = component.checked_sub(self.program.base);
        let step = step.map(|index| &self.program.steps[index]);
        let Some(step) = step.filter(|step| step.rule == Rule::Product) else {
            return 0.0;
        };
        let of = |operand: &Sparse| self.largest_of(operand, series, powers);
        step.operands.iter().map(of).product()
    }

    /// How long the polynomial of degree 16 holds for z, and at most: until it has left out as much as the tolerance
    /// allows, until an operand of `abs` changes its sign, or until a root comes to zero.
    pub fn length(&self, series: &Series, longest: f64, forward: bool) -> f64 {
        /// Products of the tolerance with what is smaller are none, and have no digits left: a square of a state that has died out.
        const LOST: f64 = f64::MIN_POSITIVE / (f64::EPSILON * f64::EPSILON);
        /// A component that is made of others is asked for what it does where it would make the length less than this part of what it is.
        const PART: f64 = 0.5;
        /// It is small where it makes less than this part of the terms to which it is added.
        const SMALL: f64 = 1e-3;
        let base = self.program.base;
        let counts = |c: &usize| *c < base || self.needed[*c - base];
        // a number that is none has no greatest and no least
        if !series.is_finite() {
            return f64::NAN;
        }
        let mut length = longest;
        let mut powers = self::powers(length);
        for c in (0..series.size()).filter(counts) {
            let z = series.values(c);
            for last in [COEFFICIENTS, COEFFICIENTS + 1] {
                let tail = z[last].abs();
                // |z_K|hᴷ is at most the allowed part of |z_j|hʲ for one j: most components hold as long as others
                let holds = |j: usize| tail * powers[last - j] <= self.tolerance * z[j].abs();
                // a state whose rate vanishes but for rounding, as that across a surface, has no order of its own
                let rounding = || self.rounding_of_order(series, c, last);
                if tail > LOST && !(0..last).any(holds) && tail > rounding() {
                    let first = z[0].abs().max(self.size_of_product(series, c, &powers));
                    let own = |j: usize| if j == 0 { first } else { z[j].abs() };
                    let allowed = |j: usize| self.tolerance * own(j) / tail;
                    let mut own = longest_of(allowed, last);
                    // what is small beside that to which it is added need not be known as well as itself
                    if c >= base && own < PART * length {
                        let reach = self.reach(series, c, &powers);
                        let reach = reach.rates.max(reach.looked_at);
                        if reach * series.largest(c, &powers) < SMALL {
                            let allowed = self.tolerance / (reach * tail);
                            let least = allowed.powf((last as f64).recip());
                            own = own.max(least.min(length));
                        }
                    }
                    length = length.min(own);
                    powers = self::powers(length);
                }
            }
        }
        if series.has_derivatives() {
            length = self.length_of_derivatives(series, length);
        }
        let direction = if forward { 1.0 } else { -1.0 };
        length = self.without_surprise(series, length, (longest, direction));
        self.within_signs(series, length, direction)
    }

    /// How long, and at most, in this direction, what is positive stays so: an operand of `abs` by its sign, and a root.
    fn within_signs(&self, series: &Series, longest: f64, direction: f64) -> f64 {
        let base = self.program.base;
        let mut length = longest;
        for (index, step) in self.program.steps.iter().enumerate() {
            if !self.needed[index] {
                continue;
            }
            // what is positive over the piece, but for a zero of this order at its beginning
            let (coefficients, sign, order) = match step.rule {
                Rule::Function(Function::Abs) => {
                    let order = series.first_order(&self.program.steps, index);
                    (series.operands(index), series.signs[index], order)
                }
                // a root is none where its series becomes negative, though what it is of may only touch zero there
                _ if step.rule.is_a_root() && series.value(0, base + index) > 0.0 => {
                    (series.values(base + index), 1.0, 0)
                }
                _ => continue,
            };
            let mut taylor: [f64; COEFFICIENTS] = std::array::from_fn(|k| {
                sign * coefficients[k] * (direction * length).powi(k as i32)
            });
            taylor[..order.min(COEFFICIENTS)].fill(0.0);
            taylor.rotate_left(order.min(COEFFICIENTS));
            if let Some(place) = Bernstein::from_taylor(&taylor, 0.0).first_crossing() {
                length *= place;
            }
        }
        length
    }

    /// How long the polynomials have all that functions do, and at most, where so much time is left, in this direction.
    fn without_surprise(&self, series: &Series, longest: f64, left: (f64, f64)) -> f64 {
        /// After as many halvings a length is none.
        const HALVINGS: usize = 64;
        /// From zero on a root has no series: what it does over so small a part of the length, to the power 3/2, is 1e-22 of all that it
        /// does, and shorter ones lead to where its derivatives are no numbers.
        const OF_A_ROOT: usize = 48;
        let mut length = longest;
        let mut powers = powers(length);
        for index in (0..self.needed.len()).filter(|index| self.needed[*index]) {
            let rule = self.program.steps[index].rule;
            let is_zero = series.value(0, self.program.base + index) == 0.0;
            let most = match rule.is_a_root() && is_zero {
                true => OF_A_ROOT,
                false => HALVINGS,
            };
            for _ in 0..most {
                if self.has_all(series, index, &powers, left) {
                    break;
                }
                length *= 0.5;
                powers = self::powers(length);
            }
        }
        length
    }

    /// Whether the polynomial of a step has all that its function does over a length of these powers, which may be smaller than rounding at the
    /// beginning with all of its derivatives: the function does not change by many times what the polynomial does, or changes
    /// nothing that counts.
    fn has_all(
        &self,
        series: &Series,
        index: usize,
        powers: &[f64; ORDER + 1],
        (rest, direction): (f64, f64),
    ) -> bool {
        /// What a polynomial changes by is at most the sum of its terms, and that of a function of it nearly so.
        const TIMES: f64 = 4.0;
        let step = &self.program.steps[index];
        let c = self.program.base + index;
        let (operand, spread) = series.of_operand((index, 0), powers);
        let Some((value, slope)) = at(step.rule, operand) else {
            return true;
        };
        let ends = match step.rule.ends_at_zero() {
            // on one side of zero it is nothing
            true => series.bounds_of_operand(index, powers, direction),
            false => places(step.rule, operand, spread),
        };
        let ends = ends.into_iter().filter_map(|x| at(step.rule, x));
        let (mut change, mut of_slopes) = (0.0_f64, 0.0_f64);
        for (end, by) in ends {
            change = change.max((end - value).abs());
            of_slopes = of_slopes.max((by - slope).abs());
        }
        if change <= TIMES * series.change(c, powers) {
            return true;
        }
        let reach = self.reach(series, c, powers);
        let reach = reach.states.max(reach.looked_at);
        let is_nothing =
            change <= 4.0 * f64::EPSILON * value.abs() || change * reach <= self.tolerance;
        if !is_nothing || !series.has_derivatives() {
            return is_nothing;
        }
        // the slope of a power that ends at zero comes to nothing with the time that it is looked at
        if step.rule.ends_at_zero()
            && let Some(back) = self.comes_back(index, powers[1], rest)
        {
            return of_slopes * back <= MORE * self.tolerance;
        }
        let moved = self.largest_of(&step.operands[0], series, powers);
        of_slopes * moved * reach <= self.tolerance
    }

    /// What an error of 1 in the slope of a step over a length does to the operand of the step in the time that is left: to first and to second
    /// order. `None` where it acts on states by other steps.
    fn comes_back(&self, step: usize, length: f64, rest: f64) -> Option<f64> {
        let Program {
            base,
            states,
            steps,
        } = &*self.program;
        let component = base + step;
        let of = |form: &Sparse, c: usize| {
            let own = form.terms.iter().find(|(known, _)| *known == c);
            own.map_or(0.0, |(_, by)| by.value.abs())
        };
        let mut operands = steps.iter().flat_map(|step| &step.operands);
        if operands.any(|operand| of(operand, component) != 0.0) {
            return None;
        }
        let moved: Vec<f64> = (0..*states)
            .map(|state| length * of(&self.rates[state], component))
            .collect();
        let later = |state: usize| -> f64 {
            let terms = moved.iter().enumerate();
            let terms = terms.map(|(other, moved)| of(&self.rates[state], other) * moved);
            rest * terms.sum::<f64>()
        };
        let operand = &steps[step].operands[0];
        let terms = (0..*states).map(|state| of(operand, state) * (moved[state] + later(state)));
        Some(terms.sum())
    }

    /// The sum of the largest terms of what a form is made of, over a length of these powers.
    fn largest_of(&self, form: &Sparse, series: &Series, powers: &[f64; ORDER + 1]) -> f64 {
        let terms = form.terms.iter();
        let sizes = terms.map(|(c, by)| by.value.abs() * series.largest(*c, powers));
        sizes.sum()
    }

    /// What an error of 1 in a component that is made of others does over a length of these powers.
    fn reach(&self, series: &Series, component: usize, powers: &[f64; ORDER + 1]) -> Reach {
        let base = self.program.base;
        let mut moved = vec![0.0; series.size()];
        moved[component] = 1.0;
        let of = |form: &Sparse, moved: &[f64]| -> f64 {
            let terms = form.terms.iter();
            terms.map(|(c, by)| by.value.abs() * moved[*c]).sum()
        };
        let steps = self.program.steps.iter().enumerate();
        for (index, step) in steps.skip(component - base + 1) {
            let own = step.operands.each_ref().map(|operand| of(operand, &moved));
            if self.needed[index] && own != [0.0; 2] {
                let slopes = slopes(step, index, series, powers);
                let terms = own.iter().zip(slopes).filter(|(own, _)| **own > 0.0);
                moved[base + index] = terms.map(|(own, slope)| own * slope).sum();
            }
        }
        let in_units = |moved: f64, size: f64| if moved == 0.0 { 0.0 } else { moved / size };
        let mut reach = Reach::default();
        for form in &self.looked_at {
            let size = self.largest_of(form, series, powers);
            reach.looked_at = in_units(of(form, &moved), size).max(reach.looked_at);
        }
        for (state, rate) in self.rates.iter().take(self.program.states).enumerate() {
            let (moved, size) = (of(rate, &moved), self.largest_of(rate, series, powers));
            reach.rates = in_units(moved, size).max(reach.rates);
            let size = series.largest(state, powers);
            reach.states = in_units(moved * powers[1], size).max(reach.states);
        }
        reach
    }

    /// How long the polynomials of the derivatives of the components before the terms hold, and at most. A motion on a slow
    /// manifold is smooth however fast perturbations of it decay: where a piece is long for these, their polynomials grow
    /// instead, and of the flow nothing is left.
    ///
    /// What perturbations of the sizes of the components make of one is looked at, against the largest of its own orders.
    fn length_of_derivatives(&self, series: &Series, longest: f64) -> f64 {
        let (base, left_out) = (self.program.base, MORE * self.tolerance);
        let mut powers = powers(longest);
        let whole = powers;
        // the last order is one of the two that are looked at
        let largest = |l: usize| series.largest(l, &whole[..=COEFFICIENTS]);
        // the phase moves by a radian, as cosines and sines do by their size
        let states = (0..self.program.states).map(largest);
        let moved: Vec<f64> = states.chain([1.0]).collect();
        let mut length = longest;
        for c in 0..base {
            let size = |j: usize| {
                let lanes = series.by_inner(j, c).zip(&moved);
                lanes.fold(0.0_f64, |most, (by, size)| most.max(by.abs() * size))
            };
            for last in [COEFFICIENTS, COEFFICIENTS + 1] {
                let tail = size(last);
                let long = |own: f64| tail * powers[last] <= left_out * own;
                // the first order is enough for most
                if tail > 0.0 && !long(series.value(0, c).abs()) && !long(largest(c)) {
                    let allowed = |j: usize| left_out * size(j) / tail;
                    length = length.min(longest_of(allowed, last));
                    powers = self::powers(length);
                }
            }
        }
        length
    }
}

/// 1, h, h², … up to the highest order.
fn powers(h: f64) -> [f64; ORDER + 1] {
    let mut next = 1.0;
    std::array::from_fn(|_| {
        let power = next;
        next *= h;
        power
    })
}

/// The largest length h with h^{last−j} ≤ allowed(j) for one j at least.
fn longest_of(allowed: impl Fn(usize) -> f64, last: usize) -> f64 {
    let (mut most, mut powers) = (0.0_f64, powers(0.0));
    for j in 0..last {
        let (allowed, power) = (allowed(j), last - j);
        // most orders allow less than another, and roots are slow
        if allowed > powers[power] {
            most = allowed.powf((power as f64).recip()).max(most);
            powers = self::powers(most);
        }
    }
    most
}

/// Value and slope of a function that may be smaller than rounding with all of its derivatives; `None` of others, which have one
/// that is not.
fn at(rule: Rule, x: f64) -> Option<(f64, f64)> {
    match rule {
        // beyond zero it goes on as nothing
        Rule::Power(_) if rule.ends_at_zero() && x < 0.0 => Some((0.0, 0.0)),
        Rule::Power(r) => Some((x.powf(r), r * x.powf(r - 1.0))),
        Rule::Function(function) if function.fades() => Some(function.at(x)),
        _ => None,
    }
}

/// Places at which such a function has its least and its largest value beside one, as far as this.
fn places(rule: Rule, x: f64, spread: f64) -> [f64; 3] {
    let [mut low, high] = [x - spread, x + spread];
    let r = match rule {
        Rule::Power(r) => r,
        Rule::Function(Function::Sqrt) => 0.5,
        _ => return [low, high, x],
    };
    // what is no whole power has no value below zero
    if r.fract() != 0.0 && x >= 0.0 {
        low = low.max(0.0);
    }
    [low, high, if low < 0.0 && high > 0.0 { 0.0 } else { x }]
}

/// What an error does, in units of the largest terms of what it is done to.
#[derive(Default)]
struct Reach {
    /// To the rates of the states.
    rates: f64,
    /// To the states, over a length.
    states: f64,
    /// To what is looked at.
    looked_at: f64,
}

/// Bounds of the slopes of a step in its operands, over a length of these powers.
fn slopes(
    step: &ProgramStep,
    index: usize,
    series: &Series,
    powers: &[f64; ORDER + 1],
) -> [f64; 2] {
    let (a, spread) = series.of_operand((index, 0), powers);
    let (least, most) = ((a.abs() - spread).max(0.0), a.abs() + spread);
    let other = || {
        let (b, spread) = series.of_operand((index, 1), powers);
        ((b.abs() - spread).max(0.0), b.abs() + spread)
    };
    let of_a = match step.rule {
        Rule::Product => return [other().1, most],
        Rule::Quotient => {
            let (divisor, _) = other();
            return [divisor.recip(), most / (divisor * divisor)];
        }
        Rule::Power(r) => r.abs() * most.powf(r - 1.0).max(least.powf(r - 1.0)),
        Rule::Function(function) => function.steepest(a, spread),
    };
    [of_a, 0.0]
}
