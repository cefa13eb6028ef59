//! The spectrum does not depend on the neighbour whose eigenvalues served as starts.

use brakewave::tube::stability::spectrum::{Sector, Spectrum, spectrum};
use brakewave::tube::wave::start::Which;

use crate::stability::observed;
use crate::stability::waves::{damped, linearised, mode4, request, tube, window};

/// Both are zeros of the same function, polished from different starts.
const BOUND: f64 = 1e-12;

/// Largest distance between eigenvalues right of `left`, which must be as many.
fn distance(one: &Sector, other: &Sector, left: f64) -> f64 {
    let list = |sector: &Sector| {
        let all = sector.eigenvalues.iter().map(|one| one.value());
        // the window itself may differ: its top is moved where an eigenvalue sits on it
        all.filter(|value| value.re > left && value.im.abs() < 12.4)
            .collect::<Vec<_>>()
    };
    let (one, other) = (list(one), list(other));
    assert_eq!(one.len(), other.len());
    let nearest = |value: &nalgebra::Complex<f64>| {
        other
            .iter()
            .map(|known| (known - value).norm())
            .fold(f64::INFINITY, f64::min)
    };
    one.iter().map(nearest).fold(0.0, f64::max)
}

#[test]
fn seeds_do_not_matter() {
    let mut worst = 0.0_f64;
    let pairs = [
        (mode4(0.2), mode4(0.19)),
        (mode4(0.09), mode4(0.085)),
        (mode4(0.045), mode4(0.04)),
        (mode4(0.02), mode4(0.019)),
        // of another signature, and of another wave
        (mode4(0.024), mode4(0.023)),
        (mode4(0.2), mode4(0.001)),
        (damped(0.2), damped(0.21)),
        (tube(0.45, 1.25, 0.1, 0.1), tube(0.45, 1.25, 0.1, 0.09)),
    ];
    for (neighbour, model) in pairs {
        let seeds: Spectrum = window(&linearised(&neighbour, 4, Which::Fast));
        let characteristic = linearised(&model, 4, Which::Fast);
        let without = window(&characteristic);
        let with = spectrum(&characteristic, &request(4), Some(&seeds));
        assert!(with.complete && without.complete);
        assert_eq!(with.stable, without.stable);
        assert_eq!(with.unstable(), without.unstable());
        let left = with.left.max(without.left) + 1e-3;
        for (one, other) in with.sectors.iter().zip(&without.sectors) {
            worst = worst.max(distance(one, other, left));
        }
    }
    assert!(worst < BOUND, "{worst:e}");
    observed("spectra with and without seeds", worst);
}
