//! The Coulomb impact: at landing m_a[V̇] = f m_b|U̇⁻| towards V̇ = 1, and not beyond it.

use brakewave::branch::EventType::{CO, GR, RV};
use brakewave::problem::Impact;
use brakewave::wave::profile::sample;

use crate::branches::{Run, speed, with_coulomb_impact};
use crate::observed;
use crate::tube::coefficients;

/// Rounding of U̇⁻, with |U̇⁻| of the order of the velocities, and of V̇ on both sides.
const ROUNDING: f64 = 1e-12;

/// Largest violation of the law, and the number of free and of capped landings.
fn landings(run: &Run) -> (f64, usize, usize) {
    let tube = coefficients(0.3, 1.5, 1.0);
    let (mut worst, mut free, mut capped) = (0.0_f64, 0, 0);
    for found in &run.points {
        assert_eq!(found.wave.model.impact, Impact::Coulomb);
        let square = speed(found).powi(2);
        let (ma, mb) = (1.0 - tube.a / square, 1.0 - tube.b / square);
        let friction = found.wave.model.friction;
        let samples = sample(&found.wave, &found.node.point, 100).expect("a profile");
        for pair in samples.windows(2) {
            let (before, after) = (&pair[0], &pair[1]);
            if before.regime != "separation" || after.regime == "separation" {
                continue;
            }
            assert!(before.radial_rate <= 0.0 && after.radial_rate == 0.0);
            let largest = friction * mb * before.radial_rate.abs() / ma;
            let lag = 1.0 - before.tangential_rate;
            let jump = after.tangential_rate - before.tangential_rate;
            let size = 1.0 + lag.abs() + largest;
            let arrested = (after.tangential_rate - 1.0).abs() <= ROUNDING * size;
            let error = if arrested && lag.abs() <= largest {
                capped += 1;
                (jump - lag).abs()
            } else {
                free += 1;
                // towards V̇ = 1, and not as far as that
                assert!(largest < lag.abs() + ROUNDING * size, "{largest} {lag}");
                (jump - largest.copysign(lag)).abs()
            };
            worst = worst.max(error / size);
            assert!(error <= ROUNDING * size, "{before:?} {after:?}");
        }
    }
    (worst, free, capped)
}

#[test]
fn coulomb_impact_obeys_its_law() {
    let run = with_coulomb_impact().follow(&[]);
    let last = run.points.last().expect("points");
    let kinds: Vec<_> = run.events().iter().filter_map(|found| found.kind).collect();
    assert_eq!(kinds, [RV, GR, CO, CO]);
    assert_eq!(last.parameter, 0.001, "{:?}", run.status);
    let (worst, free, capped) = landings(&run);
    observed(
        &format!("Coulomb impact, {free} free and {capped} capped landings"),
        worst,
    );
    assert!(free > 0 && capped > 0, "{free} {capped}");
}
