//! A bracket of a zero, shrunk by the Illinois variant of the secant rule.
//!
//! The secant of a bracket converges from one side and leaves the other end behind; halving the value
//! remembered there when the same side moves twice brings it along: order 1.44 without derivatives
//! (Dowell & Jarratt, BIT 11 (1971) 168).

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

    /// Where the secant is zero.
    pub fn secant(&self) -> f64 {
        (self.low.0 * self.high.1 - self.high.0 * self.low.1) / (self.high.1 - self.low.1)
    }

    /// Takes in the value at a place inside. Returns whether the lower end moved.
    pub fn shrink(&mut self, place: f64, value: f64) -> bool {
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
        lower
    }

    /// Distance of the ends.
    pub fn width(&self) -> f64 {
        self.high.0 - self.low.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// cos x = x³ to rounding in few steps, from values of very different size.
    #[test]
    fn finds_a_zero() {
        let f = |x: f64| x.cos() - x * x * x;
        let mut bracket = Bracket::new((0.0, f(0.0)), (4.0, f(4.0)));
        let mut steps = 0;
        while bracket.width() > 1e-15 && steps < 60 {
            let x = bracket.secant();
            let value = f(x);
            bracket.shrink(x, value);
            steps += 1;
            if value == 0.0 {
                break;
            }
        }
        let zero = bracket.secant();
        assert!(f(zero).abs() < 1e-15 && steps < 16, "{zero} after {steps}");
    }
}
