//! The vertical family at the Hopf point of steady sliding, and the branch that leaves it.

use brakewave::branch::EventType;
use brakewave::branch::run::{End, WaveRunner};
use brakewave::continuation::newton::{Equations, relative_residual};
use brakewave::linalg::Matrix;
use brakewave::orbit::legs::Run as _;
use brakewave::problem::parse;
use brakewave::tube::model::Parameter;
use brakewave::tube::wave::hopf::{NoHopf, family};

use crate::waves::branches::mode4;
use crate::waves::observed;

/// Every member solves the boundary-value problem of one slip zone to rounding: some ten operations
/// and the sine of an angle of 2π.
#[test]
fn the_family_solves_the_equations() {
    let mut worst = 0.0_f64;
    for (parameter, damping) in [(Parameter::Friction, 0.2), (Parameter::MassDamping, 0.0)] {
        let mut model = mode4(0.2);
        model.damping.mass = damping;
        let found = family(&model, parameter, 4, 1.0, 9).expect("a Hopf point");
        for point in &found.points {
            let n = found.wave.unknowns();
            let mut matrix = Matrix::zeros(n - 1, n);
            let mut residual = vec![0.0; n - 1];
            found
                .wave
                .evaluate(point, &mut residual, &mut matrix)
                .expect("the equations can be evaluated");
            worst = worst.max(relative_residual(&matrix, &residual));
        }
        // F = fκ − α = 0 at its speed
        let at = found
            .wave
            .flows(&found.points[0])
            .expect("a frame")
            .frame
            .at;
        assert!((at.friction * at.kappa - at.damping).abs() < 4.0 * f64::EPSILON);
    }
    observed("residual of the family at the Hopf point", worst);
    assert!(worst < 64.0 * f64::EPSILON, "{worst:e}");
}

#[test]
fn what_has_no_hopf_point_is_refused() {
    let model = mode4(0.2);
    let refused = |model, parameter| family(model, parameter, 4, 1.0, 9).err();
    assert_eq!(
        refused(&model, Parameter::Friction),
        Some(NoHopf::Zero { missing: "α = β" })
    );
    assert_eq!(
        refused(&model, Parameter::Mismatch),
        Some(NoHopf::Parameter)
    );
    let low = mode4(1e-3);
    assert!(matches!(
        refused(&low, Parameter::MassDamping),
        Some(NoHopf::Separation { .. })
    ));
}

/// Steady sliding, slip-only waves of growing amplitude, ST on α√(ak² + h) = kf|D|, slip-stick waves.
#[test]
fn the_branch_begins_at_steady_sliding() {
    let text = "(
        model: (
            coefficients: Geometry(nu: 0.3, xi: 1.5, gamma: 1.0),
            friction: 0.5, mismatch: 0.2, damping: (mass: 0.2),
        ),
        wave: (mode: 4, start: Hopf),
        continuation: (parameter: Friction, range: (0.1, 0.6), toward: Up),
    )";
    let problem = parse(text, "hopf").expect("a problem");
    let continuation = problem.continuation(text, "hopf").expect("a branch");
    let mut branch = WaveRunner::begin(&problem, continuation, None).expect("the branch begins");
    let mut points = Vec::new();
    while branch.progress().end.is_none() {
        points.extend(branch.step().into_iter().map(|item| item.point));
    }
    assert_eq!(branch.progress().end, Some(End::Finished));
    let coefficients = problem.model.constants().coefficients;
    let critical =
        0.2 * (coefficients.a * 16.0 + coefficients.h).sqrt() / (4.0 * coefficients.coupling.abs());
    assert_eq!(points[0].kind, Some(EventType::EP));
    assert_eq!(points[0].amplitude, 0.0);
    let opening = points
        .iter()
        .position(|point| point.kind == Some(EventType::ST))
        .expect("a stick zone opens");
    for pair in points.windows(2) {
        assert!(pair[1].amplitude > pair[0].amplitude);
    }
    for (index, point) in points.iter().enumerate() {
        let regimes = if index <= opening {
            "slip"
        } else {
            "slip-stick"
        };
        assert_eq!(point.regimes, regimes);
        let friction = point.model.friction;
        if index <= opening {
            assert!((friction / critical - 1.0).abs() < 4.0 * f64::EPSILON);
        } else {
            assert!(friction > critical);
        }
    }
}
