//! How well the place is known at which an eigenvalue crosses the imaginary axis.

use super::C64;
use super::characteristic::Characteristic;
use crate::continuation::newton::jacobian;
use crate::linalg::Vector;
use crate::tube::wave::Wave;

/// Step of central differences, relative to an unknown: truncation and rounding leave 1e-10 of the derivative.
const DIFFERENCE: f64 = 1e-6;

/// First-order bound of the error of the scaled parameter where Re λ = 0: the equations of the wave and
/// Re λ = 0 determine it together, `rounding` being that of Re λ itself. `None` where they do not.
pub(super) fn uncertainty(
    wave: &Wave,
    point: &Vector,
    sector: usize,
    lambda: C64,
    rounding: f64,
) -> Option<f64> {
    let count = point.len();
    let value = |point: &Vector| {
        let characteristic = Characteristic::new(wave, point).ok()?;
        let z = characteristic.multiplier(sector);
        Some(characteristic.evaluate(lambda).sector(z))
    };
    let (_, by) = value(point)?;
    let (equations, _) = jacobian(wave, point).ok()?;
    let mut matrix = equations.insert_row(count - 1, 0.0);
    for column in 0..count {
        let size = point[column].abs();
        // ln(e/e₀) may be zero or near it, a zone as brief as it likes
        let whole = column == count - 2 || size == 0.0;
        let step = DIFFERENCE * if whole { 1.0 } else { size };
        let moved = |by: f64| {
            let mut moved = point.clone();
            moved[column] += by;
            Some(value(&moved)?.0)
        };
        matrix[(count - 1, column)] = -((moved(step)? - moved(-step)?) / (by * (2.0 * step))).re;
    }
    wave.parameter_rounding(&matrix, point, rounding)
}
