//! Numbers with an exponent of their own: products of many factors leave the range of doubles.

use nalgebra::{Complex, ComplexField};

pub(super) type Number = Complex<f64>;

/// A real or complex number.
pub(super) trait Scalar: ComplexField<RealField = f64> + Copy {
    /// Its modulus.
    fn size(self) -> f64;

    fn number(self) -> Number;

    /// A number that is known to be one of these.
    fn of(number: Number) -> Self;
}

impl Scalar for f64 {
    fn size(self) -> f64 {
        self.abs()
    }

    fn number(self) -> Number {
        Number::new(self, 0.0)
    }

    fn of(number: Number) -> f64 {
        number.re
    }
}

impl Scalar for Number {
    /// By its square, but where that leaves the range of numbers.
    fn size(self) -> f64 {
        const RANGE: std::ops::Range<f64> = 1e-280..1e280;
        let square = self.norm_sqr();
        match RANGE.contains(&square) {
            true => square.sqrt(),
            false => self.norm(),
        }
    }

    fn number(self) -> Number {
        self
    }

    fn of(number: Number) -> Number {
        number
    }
}

/// z·2ᵉ without overflow on the way.
pub(super) fn times_power<T: ComplexField<RealField = f64>>(number: T, exponent: i64) -> T {
    let half = (exponent / 2).clamp(-1022, 1023);
    let rest = (exponent - half).clamp(-1022, 1023);
    let power = |exponent: i64| f64::from_bits(((exponent + 1023) as u64) << 52);
    number.scale(power(half)).scale(power(rest))
}

/// |x|.
pub(super) fn size<T: Scalar>(number: T) -> f64 {
    number.size()
}

/// A number with an exponent of its own.
#[derive(Clone, Copy, Debug)]
pub(super) struct Product {
    pub number: Number,
    pub exponent: i64,
}

impl Product {
    pub const ONE: Product = Product {
        number: Number::new(1.0, 0.0),
        exponent: 0,
    };

    pub fn normalise(&mut self) {
        let size = self.number.norm();
        if size > 0.0 && size.is_finite() {
            let by = exponent_of(size);
            self.number = times_power(self.number, -by);
            self.exponent += by;
        }
    }

    pub fn times(&mut self, factor: Number) {
        /// Between these a factor of any size leaves the product in the range of numbers.
        const RANGE: std::ops::Range<f64> = 1e-5..1e5;
        self.number *= factor;
        if !RANGE.contains(&self.number.l1_norm()) {
            self.normalise();
        }
    }

    pub fn log_modulus(&self) -> f64 {
        self.number.norm().ln() + self.exponent as f64 * std::f64::consts::LN_2
    }
}

/// The exponent of a positive number.
pub(super) fn exponent_of(size: f64) -> i64 {
    match (size.to_bits() >> 52) as i64 & 0x7ff {
        0 => size.log2().floor() as i64,
        biased => biased - 1023,
    }
}
