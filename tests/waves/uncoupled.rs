//! Where D passes zero a branch ends: nothing couples radial and tangential motion there.
//!
//! Undamped, F = fD/c → 0+ as D → 0: the stick zone vanishes, T2 ∝ √|D|, and what is left is the
//! linear wave of steady sliding with V̇ = cos ωs, c² = a + h/k². Under static friction a wave survives
//! D = 0, but beyond it c and D have different signs.

use brakewave::branch::EventType::{self, MX, ST};
use brakewave::branch::special::{Stop, WaveTermination};
use brakewave::continuation::walk::End;
use brakewave::tube::model::coefficients::Geometry;
use brakewave::tube::model::{FrictionLaw, Model, Parameter};
use brakewave::tube::wave::start::Which;

use crate::waves::branches::{Case, Run, fast_in_mismatch, lengths, speed};
use crate::waves::observed;
use crate::waves::tube::coefficients;

const GEOMETRY: Geometry = Geometry {
    nu: 0.369,
    xi: 1.6113,
    gamma: 8.0,
};

fn case(parameter: Parameter, range: (f64, f64), up: bool) -> Case {
    Case {
        model: Model::tube(GEOMETRY, 0.0334, 0.067),
        parameter,
        mode: 16,
        range,
        up,
        ..fast_in_mismatch()
    }
}

fn at(parameter: Parameter, value: f64) -> crate::waves::tube::Coefficients {
    match parameter {
        Parameter::Nu => coefficients(value, GEOMETRY.xi, GEOMETRY.gamma),
        _ => coefficients(GEOMETRY.nu, value, GEOMETRY.gamma),
    }
}

/// Root of D by bisection, from the coefficients by quadrature.
fn root(parameter: Parameter, (mut low, mut high): (f64, f64)) -> f64 {
    let sign = at(parameter, low).coupling.signum();
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if at(parameter, middle).coupling * sign > 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

fn kinds(run: &Run) -> Vec<EventType> {
    run.points.iter().filter_map(|found| found.kind()).collect()
}

#[test]
fn the_stick_zone_vanishes_where_the_coupling_does() {
    for (parameter, range, up) in [
        (Parameter::Nu, (0.33, 0.41), false),
        (Parameter::Xi, (1.4, 1.8), true),
    ] {
        let run = case(parameter, range, up).follow(&[]);
        let first = speed(&run.points[0]);
        assert!(run.points.iter().all(|found| speed(found) * first > 0.0));
        assert!(!kinds(&run).contains(&EventType::LP), "{:?}", kinds(&run));
        assert_eq!(kinds(&run)[kinds(&run).len() - 2..], [ST, MX]);
        assert_eq!(
            run.end,
            Some(End::Own(Stop::Own(WaveTermination::Undriven)))
        );
        let end = &run.points[run.points.len() - 2];
        let expected = root(parameter, range);
        let error = (end.parameter / expected - 1.0).abs();
        observed(&format!("D = 0 in {}", parameter.column()), error);
        // the coefficients by quadrature are known to 1e-14, D here to that of its terms
        assert!(error < 1e-13, "{} for {expected}", end.parameter);
        assert!(end.uncertainty < 1e-13);
        let tube = at(parameter, expected);
        let linear = (tube.a + tube.h / 256.0).sqrt();
        assert!((speed(end).abs() / linear - 1.0).abs() < 1e-12);
        assert!(lengths(&end.orbit, &end.node.point)[1].abs() < 1e-12);
        // V = A cos ωs with Aω = 1, ω = k|c|
        let (low, high) = end.examination.tangential;
        assert!((0.5 * (high - low) * 16.0 * linear - 1.0).abs() < 1e-12);
    }
}

#[test]
fn under_static_friction_the_branch_ends_with_its_reason() {
    let case = case(Parameter::Nu, (0.33, 0.41), false);
    let case = Case {
        model: Model {
            law: FrictionLaw::Static { ratio: 1.2 },
            mismatch: 0.3,
            ..case.model
        },
        which: Which::Fast,
        ..case
    };
    let run = case.follow(&[]);
    let first = speed(&run.points[0]);
    assert!(run.points.iter().all(|found| speed(found) * first > 0.0));
    let end = run.points.last().expect("points");
    assert_eq!(end.kind(), Some(MX));
    assert_eq!(run.end, Some(End::Own(Stop::Own(WaveTermination::Against))));
    let expected = root(Parameter::Nu, case.range);
    assert!((end.parameter / expected - 1.0).abs() < 1e-12);
}
