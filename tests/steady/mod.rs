//! Claims about the stability of steady sliding: the closed form against roots found otherwise, the
//! radial problem against Bessel functions, its own orders, symmetries and limits, the command line.

mod bessel;
mod command;
mod law;
mod radial;
mod reduced;

use brakewave::tube::model::Damping;
use brakewave::tube::model::coefficients::Geometry;

use crate::observed;

fn tube(nu: f64, xi: f64) -> Geometry {
    Geometry { nu, xi, gamma: 1.0 }
}

fn damping(mass: f64, stiffness: f64) -> Damping {
    Damping { mass, stiffness }
}
