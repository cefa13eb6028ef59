//! Observed orders of convergence.

use brakewave::tube::flow::numeric::collocation::Mesh;
use brakewave::tube::flow::numeric::shooting::ShootingSteps;
use brakewave::tube::flow::numeric::{Integrator, NumericalContact};
use brakewave::tube::model::FrictionLaw;
use brakewave::tube::model::signature::Regime;

use crate::methods::observed;
use crate::methods::waves::{fast, tube};

/// Error of (Y, W) at the end of the slip zone of the mode-4 wave.
fn error(integrator: Integrator) -> f64 {
    let (wave, point) = fast(&tube(0.5, 0.2, FrictionLaw::Coulomb));
    let flows = wave.flows(&point).expect("a frame");
    let slide = wave.slide_at(&point, 0);
    let (entry, duration) = (slide.entry, slide.duration);
    let exact = flows
        .contact(Regime::Slip)
        .state(&slide, duration)
        .expect("a state");
    let flow = NumericalContact::new(&flows.frame, FrictionLaw::Coulomb, 1.0, integrator);
    let found = flow.state(entry, duration).expect("a state");
    (exact[0] - found[0]).abs().max((exact[1] - found[1]).abs())
}

/// Slope of the last two of a sequence of errors under halved steps; the errors stay far above
/// rounding.
fn order(name: &str, errors: &[f64]) -> f64 {
    let count = errors.len();
    assert!(errors[count - 1] > 1e-13, "{name}: at rounding, {errors:?}");
    let order = (errors[count - 2] / errors[count - 1]).log2();
    observed(&format!("order of {name}"), order);
    order
}

/// Gauss collocation of degree m is of order 2m at mesh points.
#[test]
fn collocation_is_superconvergent() {
    for (degree, finest) in [(2, 32), (3, 16), (4, 8)] {
        let errors: Vec<f64> = [finest / 4, finest / 2, finest]
            .into_iter()
            .map(|intervals| {
                error(Integrator::Collocation(Mesh {
                    intervals,
                    degree,
                    passes: 0,
                }))
            })
            .collect();
        let found = order(&format!("degree {degree}"), &errors);
        assert!(
            (found - 2.0 * degree as f64).abs() < 0.35,
            "degree {degree}: {found}, {errors:?}"
        );
    }
}

/// Dormand and Prince's pair is of order 8: with a tolerance that never binds, the longest step is
/// the step.
#[test]
fn shooting_is_of_order_eight() {
    let errors: Vec<f64> = [4.0, 8.0]
        .into_iter()
        .map(|steps: f64| {
            error(Integrator::Shooting(ShootingSteps {
                tolerance: 1e3,
                longest: 1.0 / steps,
            }))
        })
        .collect();
    let found = order("shooting", &errors);
    assert!((found - 8.0).abs() < 0.8, "{found}, {errors:?}");
}
