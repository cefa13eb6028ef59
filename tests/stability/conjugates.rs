//! The equations are real: sectors j and k − j are conjugate.

use brakewave::tube::model::Model;
use brakewave::tube::stability::spectrum::{SpectrumRequest, spectrum};
use brakewave::tube::wave::start::Which;

use crate::stability::observed;
use crate::stability::waves::{C64, linearised, mode4, tube};

/// Both are zeros of the same function, polished from different starts.
const BOUND: f64 = 1e-12;

fn check(model: &Model, mode: u32) -> f64 {
    let characteristic = linearised(model, mode, Which::Fast);
    let all = SpectrumRequest {
        sectors: (0..mode as usize).collect(),
        eigenvalues: 4,
        max_frequency: 12.0,
    };
    let spectrum = spectrum(&characteristic, &all, None);
    assert!(spectrum.complete);
    let values = |sector: usize| -> Vec<C64> {
        let list = &spectrum.sectors[sector].eigenvalues;
        list.iter().map(|one| one.value()).collect()
    };
    let mut worst = 0.0_f64;
    let mut total = 0;
    for sector in 0..mode as usize {
        let (one, other) = (
            values(sector),
            values((mode as usize - sector) % mode as usize),
        );
        assert_eq!(one.len(), other.len(), "sector {sector}");
        total += one.len();
        for value in one {
            let nearest = other
                .iter()
                .map(|known| (known.conj() - value).norm())
                .fold(f64::INFINITY, f64::min);
            worst = worst.max(nearest / (1.0 + value.norm()));
        }
    }
    assert!(total > 2 * mode as usize);
    assert!(worst < BOUND, "mode {mode}: {worst:e}");
    worst
}

#[test]
fn sectors_are_conjugate() {
    let mut worst = 0.0_f64;
    for mismatch in [0.2, 0.08, 0.045, 0.02, 0.001] {
        worst = worst.max(check(&mode4(mismatch), 4));
    }
    worst = worst.max(check(&tube(0.25, 1.25, 0.446, 0.06), 8));
    worst = worst.max(check(&tube(0.3, 1.5, 0.4, 0.1), 5));
    // with the shaft
    for mismatch in [0.1, 0.01] {
        worst = worst.max(check(&tube(0.45, 1.25, 0.1, mismatch), 4));
    }
    observed("conjugate sectors", worst);
}
