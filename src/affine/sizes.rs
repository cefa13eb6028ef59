//! Sizes of the states of a mode that is not affine, told by its rates: they change with the units of each state.
//!
//! A rate or a slope that is not zero at the origin changes by a part of itself where one state has a size, and the smallest such
//! size is that of the state: √μ of μ − x², K of x(1 − x/K). States that make no such change alone, as those of a product or of a
//! linear coupling, do so together: in units in which they act on one another alike.

use super::mode::AffineSystem;
use super::steady::RatesAt;
use crate::linalg::Vector;
use crate::linalg::periodic_schur::balance;

/// A rate or a slope has changed where it does by this part of what it was.
const CHANGED: f64 = 0.5;

/// Sizes that are tried, as powers of the root of 10: from 1e-12 to 1e12.
const SIZES: std::ops::RangeInclusive<i32> = -24..=24;

impl RatesAt {
    /// Whether one that is not zero differs at another state.
    fn differs(&self, other: &RatesAt) -> bool {
        let differ =
            |one: f64, other: f64| one != 0.0 && (other - one).abs() >= CHANGED * one.abs();
        let mut slopes = self.slopes.iter().zip(&other.slopes);
        let mut values = self.values.iter().zip(&other.values).enumerate();
        slopes.any(|(one, other)| differ(*one, *other))
            || values.any(|(row, (one, other))| !self.is_zero(row) && differ(*one, *other))
    }
}

impl AffineSystem {
    /// The size of each state of a mode, 1 where nothing tells it.
    pub(super) fn sizes(&self, mode: usize) -> Vector {
        let n = self.states;
        let origin = Vector::zeros(n);
        let axis = |state: usize| Vector::from_fn(n, |row, _| f64::from(u8::from(row == state)));
        let own: Vec<Option<f64>> = (0..n)
            .map(|state| self.least_size(mode, &origin, &axis(state)))
            .collect();
        let known = Vector::from_iterator(n, own.iter().map(|size| size.unwrap_or(0.0)));
        let others: Vec<usize> = (0..n).filter(|state| own[*state].is_none()).collect();
        let together = || {
            let slopes = self.rates(mode, &known)?.slopes;
            let alike = balance(&[&slopes.select_rows(&others).select_columns(&others)]);
            let mut along = Vector::zeros(n);
            for (state, alike) in others.iter().zip(alike) {
                along[*state] = alike;
            }
            Some(&along * self.least_size(mode, &known, &along)?)
        };
        let made = together().unwrap_or_else(|| Vector::from_element(n, 1.0));
        Vector::from_fn(n, |state, _| own[state].unwrap_or(made[state]))
    }

    /// How far along a direction, either way, something differs from what it is at a state; `None` where nothing does.
    fn least_size(&self, mode: usize, from: &Vector, along: &Vector) -> Option<f64> {
        let origin = self.rates(mode, from)?;
        let mut sizes = SIZES.map(|power| 10f64.powf(0.5 * f64::from(power)));
        sizes.find(|size| {
            let both = [1.0, -1.0].map(|sign| self.rates(mode, &(from + along * (sign * size))));
            both.iter().flatten().any(|there| origin.differs(there))
        })
    }
}
