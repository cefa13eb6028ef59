//! Equations of one's own, followed round their fold: `cargo run --no-default-features --example own_equations`.
//!
//! Bratu's problem u'' + λ exp u = 0, u(0) = u(1) = 0, in Numerov's scheme. Its fold is where √λ = 2√2 θ/cosh θ is
//! greatest, θ tanh θ = 1: λ = 3.513830719125162.

use std::convert::Infallible;

use brakewave::continuation::arclength::{Node, advance};
use brakewave::continuation::locate::zero_along;
use brakewave::continuation::newton::System;
use brakewave::linalg::{Matrix, Vector};

/// Inner points of the mesh, and the scale of λ: unknowns are of order one.
const POINTS: usize = 63;
const SCALE: f64 = 4.0;

struct Bratu;

impl System for Bratu {
    type Failure = Infallible;

    fn unknowns(&self) -> usize {
        POINTS + 1
    }

    fn evaluate(&self, u: &Vector, r: &mut [f64], by: &mut Matrix) -> Result<(), Infallible> {
        let quarter = SCALE / 12.0 / ((POINTS + 1) as f64).powi(2);
        for i in 0..POINTS {
            for (j, weight, second) in [
                (i.wrapping_sub(1), 1.0, 1.0),
                (i, 10.0, -2.0),
                (i + 1, 1.0, 1.0),
            ] {
                let inside = j < POINTS;
                let force = quarter * weight * if inside { u[j].exp() } else { 1.0 };
                r[i] += u[POINTS] * force;
                by[(i, POINTS)] += force;
                if inside {
                    r[i] += second * u[j];
                    by[(i, j)] += second + u[POINTS] * force;
                }
            }
        }
        Ok(())
    }
}

fn main() {
    // u = 0 solves it for λ = 0; the tangent points to greater λ
    let begin = Node::on(&Bratu, Vector::zeros(POINTS + 1)).expect("a regular point");
    let mut node = if begin.tangent[POINTS] < 0.0 {
        begin.backwards()
    } else {
        begin
    };
    let (mut ds, rise) = (0.05, |node: &Node| node.tangent[POINTS]);
    while node.point[POINTS] >= 0.0 && node.point.amax() < 6.0 {
        let Ok(step) = advance(&Bratu, &node, ds, 1e-10) else {
            ds *= 0.5;
            continue;
        };
        let length = node.tangent.dot(&(&step.node.point - &node.point));
        let ends = ((0.0, rise(&node)), (length, rise(&step.node)));
        if ends.0.1 * ends.1.1 < 0.0 {
            let fold = zero_along(&Bratu, &node, ends, (1e-14, 1e-14), 1e-12, |node| {
                Some(rise(node))
            });
            let (place, _) = fold.expect("a fold within the step");
            let (lambda, most) = (SCALE * place.node.point[POINTS], place.node.point.amax());
            println!("LP  lambda = {lambda:.12}  max u = {most:.12}");
            assert!((lambda - 3.513830719125162).abs() < 1e-6);
        }
        (node, ds) = (step.node, step.next.min(0.5));
    }
    println!(
        "end lambda = {:.12}  max u = {:.12}",
        SCALE * node.point[POINTS],
        node.point.amax()
    );
}
