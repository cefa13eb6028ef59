//! `expected_error` bounds the error of a wave: the slip-stick wave against its closed form in 240
//! binary digits.

use brakewave::branch::conditioning::conditioning;
use brakewave::branch::first_wave::first_wave;
use brakewave::continuation::locate::retangent;
use brakewave::continuation::newton::Equations;
use brakewave::linalg::Vector;
use brakewave::tube::model::coefficients::Geometry;
use brakewave::tube::model::{Model, Parameter};
use brakewave::tube::wave::precise;
use brakewave::tube::wave::start::{Which, fold_in_friction, least_mismatch, slip_stick};

use crate::waves::branches::STEPS;
use crate::waves::observed;

#[test]
fn expected_error_bounds_the_error() {
    let (mut worst, mut count) = (0.0_f64, 0);
    for (nu, xi, gamma, mode) in [
        (0.3, 1.5, 1.0, 4),
        (-0.2, 1.2, 3.0, 7),
        (0.1, 2.0, 1e-6, 2),
        (0.45, 1.25, 20.0, 12),
        (0.05, 1.8, 60.0, 5),
    ] {
        let tube = Model::tube(Geometry { nu, xi, gamma }, 0.1, 1.0);
        let fold = fold_in_friction(&tube, mode).expect("a fold");
        // from nearly harmonic waves to 1e-7 before the fold, where unknowns are known to 1e-12
        for share in [0.003, 0.05, 0.3, 0.7, 0.95, 0.999, 1.0 - 1e-5, 1.0 - 1e-7] {
            let model = tube.with(Parameter::Friction, share * fold);
            for which in [Which::Fast, Which::Slow] {
                let closed = slip_stick(&model, mode, which).expect("a wave");
                let exact = precise::slip_stick(&model, mode, &closed).expect("its digits");
                let mismatch = 2.0 * least_mismatch(&model, &closed);
                let model = model.with(Parameter::Mismatch, mismatch);
                let parameter = Parameter::Mismatch;
                let (wave, point) =
                    first_wave(&model, parameter, mode, which, 1.0, STEPS).expect("a first wave");
                let mut along = Vector::zeros(wave.unknowns());
                along[wave.unknowns() - 1] = 1.0;
                let node = retangent(&wave, &point, &along, 0).expect("a tangent");
                let expected = conditioning(&wave, &node)
                    .expect("a Jacobian")
                    .expected_error;
                let time = wave.scales.time;
                let errors = [
                    (wave.excess_at(&point) / exact.excess).ln(),
                    (wave.duration_at(&point, 0) - exact.slip) / time,
                    (wave.duration_at(&point, 1) - exact.stick) / time,
                ];
                let error = errors
                    .into_iter()
                    .fold(0.0_f64, |most, one| most.max(one.abs()));
                assert!(
                    error <= expected,
                    "ν = {nu}, {which:?} at {share} of the fold: {error:e} for {expected:e}"
                );
                // a bound, but not one of any size
                assert!(expected < 1e-7, "{expected:e}");
                worst = worst.max(error / expected);
                count += 1;
            }
        }
    }
    observed(
        &format!("error by its bound, {count} waves, at most"),
        worst,
    );
    assert!(worst > 1e-3, "the bound is never near: {worst:e}");
}
