//! Waves that the claims are about.

use brakewave::branch::first_wave::first_wave;
use brakewave::branch::polish;
use brakewave::continuation::Steps;
use brakewave::linalg::Vector;
use brakewave::tube::flow::method::Method;
use brakewave::tube::model::coefficients::Geometry;
use brakewave::tube::model::{FrictionLaw, Model, Parameter};
use brakewave::tube::wave::Wave;
use brakewave::tube::wave::start::Which;

/// Steps of the default problem.
pub const STEPS: Steps = Steps {
    ds: 0.005,
    ds_min: 1e-12,
    ds_max: 0.01,
    tolerance: 1e-10,
};

/// The tube of the mode-4 branches under a friction law.
pub fn tube(friction: f64, mismatch: f64, law: FrictionLaw) -> Model {
    Model {
        law,
        ..Model::tube(
            Geometry {
                nu: 0.3,
                xi: 1.5,
                gamma: 1.0,
            },
            friction,
            mismatch,
        )
    }
}

/// The fast mode-4 wave of a model, posed in the mismatch.
pub fn fast(model: &Model) -> (Wave, Vector) {
    first_wave(model, Parameter::Mismatch, 4, Which::Fast, 1.0, STEPS).expect("there is a wave")
}

/// The same wave solved by another method.
pub fn by_method(wave: &Wave, point: &Vector, method: Method) -> Vector {
    polish(&wave.clone().with_method(method), point).expect("the other method solves it too")
}

/// Largest difference of two solutions: e relative, zones in the units of the wave.
pub fn difference(wave: &Wave, one: &Vector, other: &Vector) -> f64 {
    let speed = (wave.excess_at(other) / wave.excess_at(one) - 1.0).abs();
    (one - other).amax().max(speed)
}
