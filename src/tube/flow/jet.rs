//! Numbers with derivatives, and the arithmetic that carries the derivatives along.

use std::ops::{Add, Div, Mul, Neg, Sub};

use serde::{Deserialize, Serialize};

/// A number with its derivatives in D quantities.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct MultiDual<const D: usize> {
    /// The number without its derivatives.
    pub value: f64,
    /// Its derivatives in the D quantities, in their order.
    #[serde(with = "saved")]
    pub by: [f64; D],
}

/// A number with its derivatives in the seven quantities a zone depends on, in the order of
/// [`ENTRY_Y`], [`ENTRY_W`], [`DURATION`], [`EXCESS`], [`PARAMETER`], [`LAYER`], [`RADIAL_LAYER`].
pub type Jet = MultiDual<SOURCES>;

/// Index of Y at the entry of the zone.
pub const ENTRY_Y: usize = 0;
/// Index of W at the entry of the zone.
pub const ENTRY_W: usize = 1;
/// Index of the duration T of the zone.
pub const DURATION: usize = 2;
/// Index of ln e, the logarithm of the excess speed.
pub(crate) const EXCESS: usize = 3;
/// Index of the continuation parameter.
pub(crate) const PARAMETER: usize = 4;
/// Index of the amplitude of the boundary layer at the end of the zone (β > 0 only).
pub(crate) const LAYER: usize = 5;
/// Index of the amplitude of the radial boundary layer at the end of separation (β > 0 only).
pub(crate) const RADIAL_LAYER: usize = 6;
/// Number of quantities a zone depends on.
pub(crate) const SOURCES: usize = 7;

/// Derivatives as files keep them: without the last one where it is zero.
mod saved {
    use std::fmt;

    use serde::de::{Error, SeqAccess, Visitor};
    use serde::ser::SerializeTuple;
    use serde::{Deserializer, Serializer};

    pub(super) fn serialize<S: Serializer, const D: usize>(
        by: &[f64; D],
        serializer: S,
    ) -> Result<S::Ok, S::Error> {
        let kept = match by.split_last() {
            Some((0.0, rest)) => rest,
            _ => by,
        };
        let mut tuple = serializer.serialize_tuple(kept.len())?;
        for number in kept {
            tuple.serialize_element(number)?;
        }
        tuple.end()
    }

    struct Derivatives<const D: usize>;

    impl<'de, const D: usize> Visitor<'de> for Derivatives<D> {
        type Value = [f64; D];

        fn expecting(&self, out: &mut fmt::Formatter) -> fmt::Result {
            write!(
                out,
                "{D} derivatives, the last one left out where it is zero"
            )
        }

        fn visit_seq<A: SeqAccess<'de>>(self, mut numbers: A) -> Result<[f64; D], A::Error> {
            let mut by = [0.0; D];
            for (index, slot) in by.iter_mut().enumerate() {
                match numbers.next_element()? {
                    Some(number) => *slot = number,
                    None if index + 1 == D => {}
                    None => return Err(A::Error::invalid_length(index, &self)),
                }
            }
            Ok(by)
        }
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>, const N: usize>(
        deserializer: D,
    ) -> Result<[f64; N], D::Error> {
        deserializer.deserialize_tuple(N, Derivatives)
    }
}

impl<const D: usize> MultiDual<D> {
    /// A number that does not vary.
    pub(crate) fn constant(value: f64) -> MultiDual<D> {
        MultiDual {
            value,
            by: [0.0; D],
        }
    }

    pub(crate) fn variable(value: f64, index: usize) -> MultiDual<D> {
        let mut dual = MultiDual::constant(value);
        dual.by[index] = 1.0;
        dual
    }

    pub(crate) fn inverse(self) -> MultiDual<D> {
        let inverse = 1.0 / self.value;
        MultiDual {
            value: inverse,
            by: self.by.map(|by| -by * inverse * inverse),
        }
    }

    /// A quantity itself among all those that a zone depends on; one that does not vary among fewer.
    pub(crate) fn own(value: f64, index: usize) -> MultiDual<D> {
        match D {
            SOURCES => MultiDual::variable(value, index),
            _ => MultiDual::constant(value),
        }
    }

    /// A number of the frame among all quantities that a zone depends on, or among none.
    pub(crate) fn lifted(of: MultiDual<2>) -> MultiDual<D> {
        let mut lifted = MultiDual::constant(of.value);
        if D == SOURCES {
            lifted.by[EXCESS] = of.by[0];
            lifted.by[PARAMETER] = of.by[1];
        }
        lifted
    }
}

impl<const D: usize> Default for MultiDual<D> {
    fn default() -> MultiDual<D> {
        MultiDual::constant(0.0)
    }
}

impl<const D: usize> Add for MultiDual<D> {
    type Output = MultiDual<D>;
    fn add(mut self, other: MultiDual<D>) -> MultiDual<D> {
        self.value += other.value;
        self.by
            .iter_mut()
            .zip(other.by)
            .for_each(|(by, more)| *by += more);
        self
    }
}

impl<const D: usize> Sub for MultiDual<D> {
    type Output = MultiDual<D>;
    fn sub(mut self, other: MultiDual<D>) -> MultiDual<D> {
        self.value -= other.value;
        self.by
            .iter_mut()
            .zip(other.by)
            .for_each(|(by, less)| *by -= less);
        self
    }
}

impl<const D: usize> Neg for MultiDual<D> {
    type Output = MultiDual<D>;
    fn neg(self) -> MultiDual<D> {
        self * -1.0
    }
}

#[allow(clippy::suspicious_arithmetic_impl)] // the product rule adds
impl<const D: usize> Mul for MultiDual<D> {
    type Output = MultiDual<D>;
    fn mul(self, other: MultiDual<D>) -> MultiDual<D> {
        MultiDual {
            value: self.value * other.value,
            by: std::array::from_fn(|index| {
                self.by[index] * other.value + self.value * other.by[index]
            }),
        }
    }
}

impl<const D: usize> Add<f64> for MultiDual<D> {
    type Output = MultiDual<D>;
    fn add(mut self, constant: f64) -> MultiDual<D> {
        self.value += constant;
        self
    }
}

impl<const D: usize> Sub<f64> for MultiDual<D> {
    type Output = MultiDual<D>;
    fn sub(self, constant: f64) -> MultiDual<D> {
        self + -constant
    }
}

impl<const D: usize> Mul<f64> for MultiDual<D> {
    type Output = MultiDual<D>;
    fn mul(mut self, factor: f64) -> MultiDual<D> {
        self.value *= factor;
        self.by.iter_mut().for_each(|by| *by *= factor);
        self
    }
}

impl<const D: usize> Div<f64> for MultiDual<D> {
    type Output = MultiDual<D>;
    fn div(mut self, divisor: f64) -> MultiDual<D> {
        self.value /= divisor;
        self.by.iter_mut().for_each(|by| *by /= divisor);
        self
    }
}

#[allow(clippy::suspicious_arithmetic_impl)] // the quotient rule multiplies and subtracts
impl<const D: usize> Div for MultiDual<D> {
    type Output = MultiDual<D>;
    fn div(self, other: MultiDual<D>) -> MultiDual<D> {
        let value = self.value / other.value;
        MultiDual {
            value,
            by: std::array::from_fn(|i| (self.by[i] - value * other.by[i]) / other.value),
        }
    }
}

/// A number with derivatives or without: right sides are written once for both.
pub trait JetNumber:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Add<f64, Output = Self>
    + Sub<f64, Output = Self>
    + Mul<f64, Output = Self>
{
    /// The number itself.
    fn value(self) -> f64;
    /// A function of self by its value and slope there.
    fn map(self, value: f64, slope: f64) -> Self;
    /// A jet, without its derivatives if the number has others or none.
    fn of(jet: Jet) -> Self;
}

impl JetNumber for f64 {
    fn value(self) -> f64 {
        self
    }
    fn map(self, value: f64, _: f64) -> f64 {
        value
    }
    fn of(jet: Jet) -> f64 {
        jet.value
    }
}

impl<const D: usize> JetNumber for MultiDual<D> {
    fn value(self) -> f64 {
        self.value
    }
    fn map(self, value: f64, slope: f64) -> MultiDual<D> {
        MultiDual {
            value,
            ..self * slope
        }
    }
    fn of(jet: Jet) -> MultiDual<D> {
        let kept = |index| if D == SOURCES { jet.by[index] } else { 0.0 };
        MultiDual {
            value: jet.value,
            by: std::array::from_fn(kept),
        }
    }
}
