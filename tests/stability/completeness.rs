//! As many eigenvalues as the argument principle counts, by a walk of its own.
//!
//! Here the whole edge of the box is sampled evenly, 20 000 points on each side, without symmetry
//! and without derivatives.

use brakewave::tube::stability::characteristic::Characteristic;
use brakewave::tube::stability::spectrum::{SpectrumRequest, spectrum};
use brakewave::tube::wave::start::Which;

use crate::stability::observed;
use crate::stability::waves::{C64, linearised, mode4};

const SAMPLES: usize = 20_000;

/// Turns of F of every sector along the edge of a box, and the largest turn between two samples.
fn turns(characteristic: &Characteristic, left: f64, right: f64, top: f64) -> (Vec<f64>, f64) {
    let corners = [
        C64::new(left, -top),
        C64::new(right, -top),
        C64::new(right, top),
        C64::new(left, top),
    ];
    let sectors = characteristic.mode as usize;
    let at = |lambda: C64| -> Vec<C64> {
        let value = characteristic.evaluate(lambda);
        (0..sectors)
            .map(|sector| value.sector(characteristic.multiplier(sector)).0)
            .collect()
    };
    let mut turns = vec![0.0; sectors];
    let mut largest = 0.0_f64;
    let mut last = at(corners[0]);
    for side in 0..4 {
        let (from, to) = (corners[side], corners[(side + 1) % 4]);
        for index in 1..=SAMPLES {
            let next = at(from + (to - from) * (index as f64 / SAMPLES as f64));
            for (turn, (a, b)) in turns.iter_mut().zip(last.iter().zip(&next)) {
                let step = (b / a).arg();
                *turn += step;
                largest = largest.max(step.abs());
            }
            last = next;
        }
    }
    let whole = turns
        .iter()
        .map(|turn| turn / std::f64::consts::TAU)
        .collect();
    (whole, largest)
}

#[test]
fn found_are_as_many_as_counted() {
    let mut least = f64::INFINITY;
    let mut defect = 0.0_f64;
    let mut total = 0;
    for mismatch in [0.2, 0.02] {
        let characteristic = linearised(&mode4(mismatch), 4, Which::Fast);
        let request = SpectrumRequest {
            sectors: vec![0, 1, 2, 3],
            eigenvalues: 6,
            max_frequency: 60.0,
        };
        let spectrum = spectrum(&characteristic, &request, None);
        assert!(spectrum.complete);
        // a top on which no eigenvalue sits, within what was searched
        let top = 60.25;
        let (counted, largest) = turns(&characteristic, spectrum.left, spectrum.right + 0.5, top);
        assert!(largest < 1.0, "the samples are too far apart: {largest}");
        for (sector, turns) in spectrum.sectors.iter().zip(counted) {
            let inside: Vec<C64> = sector
                .eigenvalues
                .iter()
                .filter(|one| one.im.abs() < top)
                .map(|one| one.value())
                .collect();
            let translation = usize::from(sector.sector == 0);
            assert!((turns - turns.round()).abs() < 1e-9);
            assert_eq!(
                inside.len() + translation,
                turns.round() as usize,
                "δ = {mismatch}, sector {}",
                sector.sector
            );
            total += inside.len();
            let z = characteristic.multiplier(sector.sector);
            for (index, value) in inside.iter().enumerate() {
                // F over F′ is the distance from the zero
                let (f, by) = characteristic.evaluate(*value).sector(z);
                defect = defect.max((f / by).norm() / (1.0 + value.norm()));
                for other in &inside[..index] {
                    least = least.min((other - value).norm());
                }
            }
        }
    }
    assert!(defect < 1e-13, "{defect:e}");
    assert!(least > 1e-3, "two eigenvalues are one: {least:e}");
    println!("observed: {total} eigenvalues, the closest two {least:.1e} apart");
    observed("distance of the eigenvalues from the zeros", defect);
}

/// Asked for more eigenvalues than any window has, a spectrum lists those that it has.
#[test]
fn the_largest_number_of_eigenvalues_is_a_number_like_others() {
    let characteristic = linearised(&mode4(0.2), 4, Which::Fast);
    let listed = |eigenvalues| {
        let request = SpectrumRequest {
            sectors: vec![0],
            eigenvalues,
            max_frequency: 3.0,
        };
        spectrum(&characteristic, &request, None).sectors[0]
            .eigenvalues
            .len()
    };
    assert!(listed(usize::MAX) >= listed(2) && listed(2) >= 2);
}
