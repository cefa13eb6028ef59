//! The uncertainty of a fold is honest: the same fold met with other steps, so with other roundings,
//! lies within it.

use brakewave::branch::EventType;
use brakewave::continuation::Steps;
use brakewave::tube::model::coefficients::Geometry;
use brakewave::tube::model::{Model, Parameter};
use brakewave::tube::wave::start::Which;

use crate::waves::branches::{Case, STEPS, fast_in_mismatch, slow_in_mismatch};
use crate::waves::observed;

fn slow(geometry: (f64, f64, f64), friction: f64, mismatch: f64, mode: u32) -> Case {
    let (nu, xi, gamma) = geometry;
    Case {
        model: Model::tube(Geometry { nu, xi, gamma }, friction, mismatch),
        mode,
        which: Which::Slow,
        ..fast_in_mismatch()
    }
}

/// Slow waves with e = |c|/√a − 1 from 1e-2 to 1e-5, where folds are known to 1e-13 and U − δ has lost
/// five digits.
#[test]
fn uncertainties_of_folds_are_honest() {
    let in_gamma = Case {
        parameter: Parameter::Gamma,
        range: (0.06, 0.2),
        up: true,
        until: Some((EventType::LP, 1)),
        ..slow(
            (0.3704760425060343, 1.2969349963768129, 0.07),
            0.027263475021445372,
            4.155207047487803,
            3,
        )
    };
    let in_mismatch = Case {
        range: (0.05, 10.0),
        until: Some((EventType::LP, 5)),
        ..slow((-0.3, 1.2, 1.0), 0.3, 5.0, 4)
    };
    let mut compared = 0;
    for case in [in_gamma, in_mismatch, slow_in_mismatch()] {
        let folds = |factor: f64| -> Vec<(f64, f64)> {
            let steps = Steps {
                ds: STEPS.ds * factor,
                ds_max: STEPS.ds_max * factor,
                ..STEPS
            };
            let run = case.follow_with(steps, &[]);
            let events = run.events().into_iter();
            events
                .filter(|found| found.kind() == Some(EventType::LP))
                .map(|found| (found.parameter, found.uncertainty))
                .collect()
        };
        let first = folds(1.0);
        for factor in [0.83, 0.71, 1.21] {
            let other = folds(factor);
            assert_eq!(first.len(), other.len());
            for ((one, u1), (two, u2)) in first.iter().zip(&other) {
                let share = (one - two).abs() / (u1 + u2);
                observed(
                    &format!("fold at {one:.6}, share of its uncertainty"),
                    share,
                );
                assert!(share <= 1.0, "{one} ± {u1:e}, {two} ± {u2:e}");
                // and not of any size
                assert!(u1 / one.abs() < 1e-9, "{u1:e}");
                compared += 1;
            }
        }
    }
    assert!(compared >= 24, "{compared}");
}
