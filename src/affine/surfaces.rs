//! The surfaces that a mode does not leave: that in which it slides, and the slips and gaps that contacts hold.
//!
//! On h(x) = 0, of k forms h, states of as many are functions of the others. The rates change no h there, so that k of them follow
//! from the others: they give way to h = 0 in the equations of an equilibrium, and of the derivatives of the rates those are left
//! that act within the surfaces.

use crate::linalg::{Matrix, Vector, balance};

/// Part of a gradient below which it is what rounding leaves of a sum of others: a form that is zero where they are.
const NOTHING: f64 = 1e-12;

/// One of the surfaces.
#[derive(Clone, Debug)]
struct KeptSurface {
    /// Its number.
    form: usize,
    /// The state that it gives by the others.
    state: usize,
    /// Its gradient less those of others, zero in the states that they give.
    gradient: Vector,
}

/// Surfaces through a place, each with a state that it gives.
#[derive(Clone, Debug, Default)]
pub(super) struct Surfaces {
    all: Vec<KeptSurface>,
}

impl Surfaces {
    /// Those of forms with these gradients, each with the state by which it changes most in the units of the states. One that
    /// is zero where those before it are is none.
    pub fn new(gradients: &[Vector], units: &Vector) -> Surfaces {
        let mut all: Vec<KeptSurface> = Vec::with_capacity(gradients.len());
        for (form, gradient) in gradients.iter().enumerate() {
            let size = gradient.component_mul(units).amax();
            let mut gradient = gradient.clone();
            all.iter().for_each(|known| known.clear(&mut gradient));
            let scaled = gradient.component_mul(units);
            if scaled.amax() <= NOTHING * size {
                continue;
            }
            let state = scaled.iamax();
            let own = KeptSurface {
                form,
                state,
                gradient,
            };
            all.iter_mut()
                .for_each(|known| own.clear(&mut known.gradient));
            all.push(own);
        }
        Surfaces { all }
    }

    /// Those by which a matrix of slopes is reduced: the units are those that balance it.
    pub fn balanced(gradients: &[Vector], slopes: &Matrix) -> Surfaces {
        match gradients.is_empty() {
            true => Surfaces::default(),
            false => Surfaces::new(gradients, &balance(slopes, 0.0).0),
        }
    }

    /// The states that are given, each with the number of the form that gives it.
    pub fn given(&self) -> impl Iterator<Item = (usize, usize)> {
        self.all.iter().map(|one| (one.state, one.form))
    }

    /// The number of the form that gives a state.
    pub fn form_of(&self, state: usize) -> Option<usize> {
        let mut given = self.given();
        given.find_map(|(given, form)| (given == state).then_some(form))
    }

    /// The states that are given, each with a gradient that has nothing of the other ones.
    pub fn reduced(&self) -> impl Iterator<Item = (usize, Vector)> {
        self.all.iter().map(|one| (one.state, one.gradient.clone()))
    }

    /// Puts into a matrix of slopes what the states that are given change by, where no surface changes: it follows from the others.
    pub fn complete(&self, slopes: &mut Matrix) {
        let n = slopes.nrows();
        for own in &self.all {
            let mut row = Vector::zeros(n).transpose();
            for other in (0..n).filter(|other| self.form_of(*other).is_none()) {
                row -= slopes.row(other) * (own.gradient[other] / own.gradient[own.state]);
            }
            slopes.set_row(own.state, &row);
        }
    }

    /// The matrix of the motion within them, in the states that they do not give.
    pub fn within(&self, slopes: &Matrix) -> Matrix {
        let states = 0..slopes.nrows();
        let others: Vec<usize> = states
            .filter(|state| self.form_of(*state).is_none())
            .collect();
        Matrix::from_fn(others.len(), others.len(), |i, j| {
            let (i, j) = (others[i], others[j]);
            let given = self.all.iter();
            given.fold(slopes[(i, j)], |sum, one| {
                sum - slopes[(i, one.state)] * one.gradient[j] / one.gradient[one.state]
            })
        })
    }
}

impl KeptSurface {
    /// Takes as much of it from a gradient as leaves nothing of the state that it gives.
    fn clear(&self, gradient: &mut Vector) {
        let factor = gradient[self.state] / self.gradient[self.state];
        if factor != 0.0 {
            gradient.axpy(-factor, &self.gradient, 1.0);
            gradient[self.state] = 0.0;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::known_eigenvalues;

    /// A mass between two others that are held together and to the ground: of x″ = −k(x − a), with a held at b and b′ at zero,
    /// the frequency √k is left, whatever the units and the order of the forms.
    #[test]
    fn the_motion_within_surfaces_is_that_of_the_states_that_are_left() {
        // states x, v, a, b: x′ = v, v′ = −4(x − a), a′ = b, b′ = 0 on a = 0 and b = 0
        let entries = [
            0.0, 1.0, 0.0, 0.0, -4.0, 0.0, 4.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0,
        ];
        for unit in [1e-6, 1.0, 1e6] {
            let units = [1.0, unit, 1.0 / unit, 3.0];
            let slopes = Matrix::from_row_slice(4, 4, &entries);
            let slopes = Matrix::from_fn(4, 4, |i, j| slopes[(i, j)] * units[j] / units[i]);
            let form = |by: [f64; 4]| Vector::from_fn(4, |i, _| by[i] * units[i]);
            let [a, b] = [form([0.0, 0.0, 1.0, 0.0]), form([0.0, 0.0, 0.5, -2.0])];
            for forms in [
                [a.clone(), b.clone(), a.clone() * 3.0],
                [b.clone(), a.clone(), b + a],
            ] {
                let surfaces = Surfaces::balanced(&forms, &slopes);
                assert_eq!(
                    surfaces.given().count(),
                    2,
                    "the third is zero where they are"
                );
                let values = known_eigenvalues(&surfaces.within(&slopes)).unwrap();
                assert_eq!(values.len(), 2);
                for one in values {
                    assert!((one.value.im.abs() - 2.0).abs() <= one.error + 4.0 * f64::EPSILON);
                    assert!(one.value.re.abs() <= one.error);
                }
            }
        }
    }
}
