//! The point around which orbits are symmetric: 2c − x half a period later.

use super::enclosure::Enclosure;
use super::fraction::Fraction;
use crate::interval::Interval;

/// The centre of a symmetry.
#[derive(Clone, Debug)]
pub struct Centre {
    /// Twice it.
    pub twice: Vec<Fraction>,
    /// The same in intervals.
    enclosed: Vec<Interval>,
}

impl Centre {
    /// That of twice its coordinates; `None` beyond the range of doubles.
    pub fn new(twice: Vec<Fraction>) -> Option<Centre> {
        let value = |twice: &Fraction| Some(twice.value::<Enclosure>().ok()?.value);
        let enclosed = twice.iter().map(value);
        Some(Centre {
            enclosed: enclosed.collect::<Option<_>>()?,
            twice,
        })
    }

    /// Twice the coordinate of a state.
    pub fn enclosed(&self, state: usize) -> Interval {
        self.enclosed[state]
    }

    /// The image of a value of a state.
    pub fn image(&self, state: usize, x: Interval) -> Interval {
        self.enclosed(state) - x
    }
}
