//! A branch may begin at a mismatch where its wave is not slip-stick any more.

use brakewave::branch::first_wave::first_wave;
use brakewave::tube::model::{FrictionLaw, Model, Parameter};
use brakewave::tube::wave::start::Which;

use crate::waves::branches::{STEPS, fast_in_mismatch, lengths, mode4, speed};
use crate::waves::observed;

/// The slow wave of a static coefficient above the kinetic one, whose slip grows a hundredfold: speeds of a closed form of the
/// slip by an independent program.
#[test]
fn the_slow_wave_has_a_static_friction() {
    for (ratio, expected) in [
        (1.01, -1.048_049_634_6),
        (1.1, -1.050_267_740_3),
        (1.2, -1.054_865_999_4),
        (1.3, -1.066_385_698_8),
    ] {
        let model = Model {
            law: FrictionLaw::Static { ratio },
            ..mode4(0.8)
        };
        let found = first_wave(&model, Parameter::Mismatch, 4, Which::Slow, 1.0, STEPS);
        let (wave, point) = found.unwrap_or_else(|reason| panic!("{ratio}: {reason}"));
        let off = wave.speed_at(&point) - expected;
        assert!(off.abs() <= 1e-10, "{ratio}: {off:e}");
    }
}

/// Both waves are polished solutions of one system: they differ by rounding times its condition.
#[test]
fn first_wave_is_the_one_of_the_branch() {
    let values = [0.08, 0.045, 0.02, 0.004, 0.001];
    let run = fast_in_mismatch().follow(&values);
    let mut worst = 0.0_f64;
    for value in values {
        let found = run.user_points(value)[0];
        for parameter in [Parameter::Mismatch, Parameter::Friction, Parameter::Xi] {
            let (wave, point) = first_wave(&mode4(value), parameter, 4, Which::Fast, 1.0, STEPS)
                .expect("there is a first wave");
            assert_eq!(wave.signature, found.orbit.signature);
            assert_eq!(wave.parameter, parameter);
            let mut compare = |one: f64, other: f64, unit: f64| {
                worst = worst.max((one - other).abs() / unit);
                assert!((one - other).abs() < 1e-12 * unit, "{one} for {other}");
            };
            let expected = wave.model.value(parameter).expect("a tube");
            compare(wave.parameter_at(&point), expected, expected.abs());
            compare(wave.speed_at(&point), speed(found), 1.0);
            let zones = lengths(&wave, &point);
            for (length, other) in zones
                .into_iter()
                .zip(lengths(&found.orbit, &found.node.point))
            {
                compare(length, other, 1.0);
            }
            let (states, others) = (wave.unpack(&point), found.orbit.unpack(&found.node.point));
            for (state, other) in states.into_iter().zip(others) {
                compare(state.entry[0], other.entry[0], 1.0);
                compare(state.entry[1], other.entry[1], 1.0);
            }
        }
    }
    observed("first wave where it is not slip-stick", worst);
}
