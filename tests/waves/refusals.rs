//! Where there is no slip-stick wave, the library says why, with the number that decides.

use brakewave::branch::first_wave::first_wave;
use brakewave::branch::wanted::NoFirstWave;
use brakewave::tube::model::coefficients::Coefficients;
use brakewave::tube::model::{CoefficientSource, Model, Parameter};
use brakewave::tube::wave::start::{NoWave, Which, slip_stick};

use crate::waves::branches::{STEPS, mode4};
use crate::waves::observed;
use crate::waves::tube::coefficients;

fn refusal(model: &Model) -> NoWave {
    let fast = slip_stick(model, 4, Which::Fast).expect_err("there is no wave");
    let slow = slip_stick(model, 4, Which::Slow).expect_err("there is no wave");
    assert_eq!(fast, slow);
    let start = first_wave(model, Parameter::Mismatch, 4, Which::Fast, 1.0, STEPS);
    assert_eq!(start.expect_err("no wave"), NoFirstWave::NoWave(fast));
    fast
}

/// The fold is where the least length of all slip-stick waves is the wavelength. A minimum of
/// lengths known to 1e-15 is itself known to 1e-15, only its place is not.
#[test]
fn beyond_the_fold() {
    // computed by an independent program
    let expected = 1.09151842035911;
    for friction in [1.0916, 1.2, 5.0, 100.0] {
        let model = mode4(0.2).with(Parameter::Friction, friction);
        match refusal(&model) {
            NoWave::BeyondFold {
                mode,
                friction: asked,
                fold,
            } => {
                assert_eq!((mode, asked), (4, friction));
                let error = (fold / expected - 1.0).abs();
                observed("fold in f", error);
                assert!(error < 1e-10, "{fold}");
            }
            other => panic!("{other}"),
        }
    }
    // just before it both waves exist
    let model = mode4(0.2).with(Parameter::Friction, expected * (1.0 - 1e-9));
    let fast = slip_stick(&model, 4, Which::Fast).expect("a wave");
    let slow = slip_stick(&model, 4, Which::Slow).expect("a wave");
    assert!(fast.speed.abs() > slow.speed.abs());
}

#[test]
fn beyond_the_hopf_point() {
    let tube = coefficients(0.3, 1.5, 1.0);
    let expected = 4.0 * 0.5 * tube.coupling.abs() / (16.0 * tube.a + tube.h).sqrt();
    for factor in [1.0 + 1e-9, 1.5, 100.0] {
        let model = mode4(0.2).with(Parameter::MassDamping, expected * factor);
        // the slow wave may live on beyond the point where the fast one has lost its stick
        match slip_stick(&model, 4, Which::Fast).expect_err("there is no wave") {
            NoWave::BeyondHopf {
                mode,
                damping,
                hopf,
            } => {
                assert_eq!((mode, damping), (4, model.damping.mass));
                assert!((hopf / expected - 1.0).abs() < 1e-12);
            }
            other => panic!("{other}"),
        }
    }
    let model = mode4(0.2).with(Parameter::MassDamping, expected * (1.0 - 1e-6));
    let wave = slip_stick(&model, 4, Which::Fast).expect("a wave");
    assert!(wave.stick > 0.0);
}

#[test]
fn without_friction_or_coupling() {
    let model = mode4(0.2).with(Parameter::Friction, 0.0);
    assert_eq!(refusal(&model), NoWave::Frictionless);
    let model = Model {
        source: CoefficientSource::from(Coefficients {
            coupling: 0.0,
            ..mode4(0.2).constants().coefficients
        }),
        ..mode4(0.2)
    };
    assert_eq!(refusal(&model), NoWave::Uncoupled);
}
