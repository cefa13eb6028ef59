//! Equations of one's own, followed round their fold: `cargo run --no-default-features --example own_equations`.
//!
//! Bratu's problem u'' + λ exp u = 0, u(0) = u(1) = 0, in Numerov's scheme. Its fold is where √λ = 2√2 θ/cosh θ is
//! greatest, θ tanh θ = 1: λ = 3.513830719125162.

use std::convert::Infallible;

use brakewave::continuation::newton::Equations;
use brakewave::continuation::{Path, Steps, locate::turning};
use brakewave::linalg::{Matrix, Vector};

/// Inner points of the mesh, and the scale of λ, the last unknown: all are of order one.
const POINTS: usize = 63;
const SCALE: f64 = 4.0;

struct Bratu;

impl Equations for Bratu {
    type Failure = Infallible;

    fn unknowns(&self) -> usize {
        POINTS + 1
    }

    fn evaluate(&self, u: &Vector, r: &mut [f64], by: &mut Matrix) -> Result<(), Infallible> {
        let quarter = SCALE / 12.0 / ((POINTS + 1) as f64).powi(2);
        for i in 0..POINTS {
            // the mesh points i, i + 1, i + 2 from its end on, where u is zero
            for (j, weight, second) in [(i, 1.0, 1.0), (i + 1, 10.0, -2.0), (i + 2, 1.0, 1.0)] {
                let inner = (1..=POINTS).contains(&j).then(|| j - 1);
                let force = quarter * weight * inner.map_or(1.0, |j| u[j].exp());
                r[i] += u[POINTS] * force + inner.map_or(0.0, |j| second * u[j]);
                by[(i, POINTS)] += force;
                if let Some(j) = inner {
                    by[(i, j)] += second + u[POINTS] * force;
                }
            }
        }
        Ok(())
    }
}

fn main() {
    let steps = Steps {
        ds_max: 0.5,
        ..Steps::default()
    };
    // u = 0 solves it for λ = 0
    let path = Path::from(&Bratu, Vector::zeros(POINTS + 1), true, steps).expect("full rank");
    for step in path.take_while(|[_, to]| to.point[POINTS] > 0.0 && to.point.amax() < 6.0) {
        if let Some(fold) = turning(&Bratu, &step, steps.tolerance) {
            let (lambda, most) = (SCALE * fold.node.point[POINTS], fold.node.point.amax());
            println!("LP  lambda = {lambda:.12}  max u = {most:.12}");
            assert!((lambda - 3.513830719125162).abs() < 1e-6);
        }
    }
}
