//! Margins that vanish together: the place where several are zero at once, by least squares over all of them.

use super::{AtZero, Orbit};
use crate::continuation::arclength::Node;
use crate::continuation::locate::Place;
use crate::continuation::newton::{self, Constraint};
use crate::linalg::{Matrix, Vector, pseudo_inverse};

/// Several margins vanish together where they and the equations do to this, relative to their rows: an event is
/// known to about 1e-13.
const TOGETHER: f64 = 1e-11;

/// They do so within this many scaled units of where one of them vanishes.
const BESIDE: f64 = 1e-5;

/// The place where several margins vanish at once, by least squares of more equations than unknowns, and the error
/// of the parameter there. `None` where they do not, to rounding.
pub(super) fn together<O: Orbit>(
    orbit: &O,
    place: &Place,
    margins: &[O::Margin],
) -> Option<(Place, f64)> {
    /// Iterations at most: near enough the method is quadratic.
    const MOST: usize = 8;
    let n = orbit.unknowns();
    let mut margins: Vec<AtZero<O>> = margins
        .iter()
        .map(|margin| AtZero {
            margin: margin.clone(),
        })
        .collect();
    let rows = n - 1 + margins.len();
    let mut point = place.node.point.clone();
    for _ in 0..MOST {
        let mut matrix = Matrix::zeros(rows, n);
        let mut residual = Vector::zeros(n - 1);
        orbit
            .evaluate(&point, residual.as_mut_slice(), &mut matrix)
            .ok()?;
        let mut right = residual.resize_vertically(rows, 0.0);
        let mut gradient = vec![0.0; n];
        for (row, margin) in (n - 1..).zip(&mut margins) {
            gradient.fill(0.0);
            right[row] = margin.evaluate(orbit, &point, &mut gradient).ok()?;
            for (column, by) in gradient.iter().enumerate() {
                matrix[(row, column)] = *by;
            }
        }
        let blur = pseudo_inverse(&matrix, f64::EPSILON)? * &right;
        if blur.amax() > TOGETHER {
            point -= blur;
            continue;
        }
        let relative = newton::relative_residual(&matrix, right.as_slice());
        if relative > TOGETHER || (&point - &place.node.point).amax() > BESIDE {
            return None;
        }
        let rounding = newton::rounding(&matrix, &point.abs(), None)?;
        let node = Node {
            residual: relative,
            point,
            ..place.node.clone()
        };
        let place = Place {
            s: place.s,
            node,
            blur: blur.amax(),
        };
        return Some((place, (rounding[n - 1] + blur.amax()) * orbit.unit()));
    }
    None
}
