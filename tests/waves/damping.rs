//! Mass damping shrinks the stick zone to nothing at the Hopf point of steady sliding.

use brakewave::branch::EventType;
use brakewave::tube::model::Parameter;

use crate::waves::branches::{Case, fast_in_mismatch, lengths, speed};
use crate::waves::observed;
use crate::waves::tube::coefficients;

#[test]
fn stick_vanishes_at_the_hopf_point() {
    let case = Case {
        parameter: Parameter::MassDamping,
        range: (0.0, 0.5),
        up: true,
        until: Some((EventType::ST, 1)),
        ..fast_in_mismatch()
    };
    let run = case.follow(&[]);
    let events = run.events();
    assert_eq!(events.len(), 1);
    let found = events[0];
    assert_eq!(found.kind(), Some(EventType::ST));
    assert_eq!(found.orbit.signature.to_string(), "slip-stick");
    // steady sliding: λ² + αλ + K + iS = 0, K = ak² + h, S = kfD, has a root iω at α√K = |S|
    let tube = coefficients(0.3, 1.5, 1.0);
    let hopf = 4.0 * 0.5 * tube.coupling.abs() / (16.0 * tube.a + tube.h).sqrt();
    // computed by an independent program
    let program = 0.3189475197930335;
    for expected in [hopf, program] {
        let error = (found.parameter / expected - 1.0).abs();
        observed("α at the Hopf point", error);
        // rounding of the coefficients, by quadrature, is 1e-14
        assert!(error < 1e-12, "{} for {expected}", found.parameter);
    }
    // a linear wave of speed ω/k, ω² = K
    let expected = -(tube.a + tube.h / 16.0).sqrt();
    assert!((speed(found) / expected - 1.0).abs() < 1e-12);
    assert!((speed(found) + 1.271294354034047).abs() < 1e-12);
    let zones = lengths(&found.orbit, &found.node.point);
    assert!((zones[0] - std::f64::consts::FRAC_PI_2).abs() < 1e-12);
    assert!(zones[1].abs() < 1e-12);
}
