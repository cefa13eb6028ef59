//! The waves of the mode-4 branch, one of each kind, by every method.
//!
//! Shooting errs by its tolerance times the growth of a zone and the condition of the wave, below
//! 10³ together here; collocation with forty intervals of degree four by h⁸ of them.

use brakewave::discretised;
use brakewave::tube::flow::method::Method;
use brakewave::tube::model::FrictionLaw;
use brakewave::tube::wave::precise;
use brakewave::tube::wave::start::{Which, slip_stick};

use crate::methods::observed;
use crate::methods::waves::{by_method, difference, fast, tube};

const MISMATCHES: [f64; 4] = [0.2, 0.08, 0.045, 0.02];

#[test]
fn the_exact_flow_against_the_others() {
    for mismatch in MISMATCHES {
        let (wave, exact) = fast(&tube(0.5, mismatch, FrictionLaw::Coulomb));
        for (method, allowed) in [
            (Method::Shooting { tolerance: 1e-12 }, 1e-9),
            (
                Method::Collocation {
                    intervals: 40,
                    degree: 4,
                },
                1e-10,
            ),
        ] {
            let found = by_method(&wave, &exact, method);
            let error = difference(&wave, &exact, &found);
            observed(
                &format!("{} at δ = {mismatch} by {method:?}", wave.signature),
                error,
            );
            assert!(error < allowed, "{method:?}: {error:e}");
        }
    }
}

/// Second order in the spacing and first in ε: the ring's speed is off by no more than a few times
/// Δφ² ω² ≈ 1e-3 and ε·c ≈ 1e-2.
#[test]
fn the_ring_where_it_is_in_contact() {
    for mismatch in [0.2, 0.08] {
        let (wave, exact) = fast(&tube(0.5, mismatch, FrictionLaw::Coulomb));
        let settings = discretised::RingSettings {
            points: 64,
            epsilon: 0.02,
            ..discretised::RingSettings::default()
        };
        let ring = discretised::solve_from(&wave, &exact, &settings).expect("a semi-discrete wave");
        let error = (ring.speed / wave.speed_at(&exact) - 1.0).abs();
        observed(&format!("speed of the ring at δ = {mismatch}"), error);
        assert!(error < 1e-2, "{error:e}");
    }
}

/// The exact flow against the closed form in 200 binary digits: rounding times the growth of slip.
#[test]
fn the_exact_flow_against_higher_precision() {
    for friction in [0.05, 0.5, 1.0] {
        for which in [Which::Fast, Which::Slow] {
            let model = tube(friction, 50.0, FrictionLaw::Coulomb);
            let closed = slip_stick(&model, 4, which).expect("a wave");
            let precise = precise::slip_stick(&model, 4, &closed).expect("more digits");
            let (wave, point) = brakewave::branch::first_wave::first_wave(
                &model,
                brakewave::tube::model::Parameter::Mismatch,
                4,
                which,
                1.0,
                crate::methods::waves::STEPS,
            )
            .expect("a wave");
            let zones = wave.unpack(&point);
            let growth = 1.0 - closed.least_rate;
            let error = (wave.excess_at(&point) / precise.excess - 1.0)
                .abs()
                .max((zones[0].duration / precise.slip - 1.0).abs())
                .max((zones[1].duration / precise.stick - 1.0).abs());
            observed(&format!("closed form at f = {friction}, {which:?}"), error);
            assert!(
                error < 64.0 * f64::EPSILON * growth,
                "{error:e} of {growth:e}"
            );
        }
    }
}
