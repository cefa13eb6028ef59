//! Branches that leave every bound while their parameter comes to a limit.

use crate::linalg::Vector;

/// Unknowns this many times as large as their units grow without bound, if the parameter changes by less than the part
/// of its unit while they grow without end: its slope decays at least like their size, squared.
const LARGE: f64 = 1e4;
const SETTLED: f64 = 1e-4;

/// The branch leads away from the origin by this part of its length at least.
const OUTWARDS: f64 = 0.9;

/// Whether unknowns of this size, with a unit tangent, grow and the parameter, which is the last of them, comes to a limit.
pub fn grows(point: &Vector, tangent: &Vector, size: f64) -> bool {
    let settled = || size * tangent[tangent.len() - 1].abs() < SETTLED;
    let outwards = || point.dot(tangent) > OUTWARDS * point.norm();
    size > LARGE && settled() && outwards()
}

/// How far the parameter then is from its limit, by a slope that decays like the square of the size.
pub fn short_of(point: &Vector, tangent: &Vector) -> f64 {
    let slope = tangent[tangent.len() - 1].abs();
    2.0 * slope * point.norm_squared() / point.dot(tangent).abs()
}
