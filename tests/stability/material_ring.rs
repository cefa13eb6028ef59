//! Material damping β > 0: the discretised ring, which knows neither fronts nor layers, against the
//! eigenfunction problem of third order.

use brakewave::discretised::{RingSettings, SemiDiscreteWave, solve};
use brakewave::tube::model::coefficients::Geometry;
use brakewave::tube::model::{Damping, Model};
use faer::c64;

use crate::stability::observed;

/// ε so small that the error is that of the spacing.
const EPSILON: f64 = 1e-5;

fn semi_discrete(
    (nu, xi): (f64, f64),
    mode: u32,
    stiffness_damping: f64,
    points: usize,
) -> SemiDiscreteWave {
    let geometry = Geometry { nu, xi, gamma: 1.0 };
    let model = Model {
        damping: Damping {
            mass: 0.0,
            stiffness: stiffness_damping,
        },
        ..Model::tube(geometry, 0.5, 0.4)
    };
    let settings = RingSettings {
        points,
        epsilon: EPSILON,
        ..RingSettings::default()
    };
    solve(&model, mode, &settings).expect("a wave")
}

fn nearest(wave: &SemiDiscreteWave, sector: u32, to: c64) -> c64 {
    wave.eigenvalues(sector, 12.0, 400)
        .expect("eigenvalues")
        .into_iter()
        .min_by(|one, other| (one - to).norm().total_cmp(&(other - to).norm()))
        .expect("an eigenvalue")
}

/// An error of second order in the spacing: from n and 2n it extrapolates to the exact values, to a
/// fifth at least of what it is at 2n. A wrong sign of the phase in sector 1 would be off by 0.8.
#[track_caller]
fn extrapolates(waves: [&SemiDiscreteWave; 2], speed: f64, exact: &[(u32, [f64; 2])]) {
    let claim = |name: &str, coarse: c64, fine: c64, exact: c64| {
        let extrapolated = fine + (fine - coarse) / 3.0;
        let (error, before) = ((extrapolated - exact).norm(), (fine - exact).norm());
        observed(&format!("{name}, extrapolated"), error);
        assert!(error < 0.2 * before, "{name}: {error:e} {before:e}");
    };
    let [coarse, fine] = waves.map(|wave| c64::new(wave.speed, 0.0));
    claim("speed", coarse, fine, c64::new(speed, 0.0));
    for &(sector, [re, im]) in exact {
        let exact = c64::new(re, im);
        let [coarse, fine] = waves.map(|wave| nearest(wave, sector, exact));
        claim(&format!("sector {sector}"), coarse, fine, exact);
    }
}

/// β = 0.005, mode 4, c < 0.
#[test]
fn a_wave_against_the_shaft() {
    let waves = [50, 100].map(|points| semi_discrete((0.3, 1.5), 4, 0.005, points));
    extrapolates(
        [&waves[0], &waves[1]],
        -1.261_254_202_768_949,
        &[
            (0, [-0.1344375436, 2.5264162621]),
            (1, [0.0179574384, -0.4043702750]),
            (1, [-0.0037914386, 1.4034596198]),
            (2, [0.0474783043, 0.8515475024]),
        ],
    );
}

/// β = 0.045, mode 2, c > 0: stable but for translation, and so is the semi-discrete wave.
#[test]
fn a_stable_wave_with_the_shaft() {
    let waves = [50, 100].map(|points| semi_discrete((0.45, 1.25), 2, 0.045, points));
    extrapolates(
        [&waves[0], &waves[1]],
        3.1390133416904114,
        &[
            (0, [-0.429466484385, 4.06593526045]),
            (1, [-0.070914051173, 1.888261790938]),
        ],
    );
    for sector in 0..2 {
        for multiplier in waves[1].multipliers(sector).expect("multipliers") {
            let neutral = sector == 0 && (multiplier - c64::new(1.0, 0.0)).norm() < 1e-7;
            assert!(neutral || multiplier.norm() < 1.0, "{sector} {multiplier}");
        }
    }
}
