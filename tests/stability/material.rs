//! Eigenvalues of waves with material damping β: translation, the limit β → 0, derivatives, spectral
//! collocation of the boundary-value problem, eigenfunctions, and a wave that is stable on the full
//! circle.

use brakewave::branch::run::WaveItem;
use brakewave::branch::{EventType, Stability};
use brakewave::linalg::Vector;
use brakewave::problem;
use brakewave::tube::model::{Damping, Model};
use brakewave::tube::stability::characteristic::Characteristic;
use brakewave::tube::stability::eigenfunction::eigenfunction;
use brakewave::tube::stability::spectrum::{Spectrum, WaveEigenvalue};
use brakewave::tube::wave::Wave;
use brakewave::tube::wave::start::Which;
use nalgebra::{DMatrix, DVector};

use crate::chebyshev::differentiation;
use crate::stability::observed;
use crate::stability::waves::{C64, follow, mode4, tube, wave, window};

fn with_beta(mismatch: f64, beta: f64) -> Model {
    Model {
        damping: Damping {
            mass: 0.0,
            stiffness: beta,
        },
        ..mode4(mismatch)
    }
}

/// Slip-stick and slip-reverse-stick waves, from a layer as thick as the zones to none.
fn specimens() -> Vec<(f64, Wave, Vector)> {
    let mut waves = Vec::new();
    for (mismatch, regimes, betas) in [
        (0.2, "slip-stick", [1.1e-2, 3e-3, 1e-4, 1e-6, 1e-8, 1e-10]),
        (
            0.07,
            "slip-reverse-stick",
            [2e-3, 1e-3, 1e-4, 1e-5, 1e-6, 1e-8],
        ),
    ] {
        for beta in betas {
            let (wave, point) = wave(&with_beta(mismatch, beta), 4, Which::Fast);
            assert_eq!(wave.signature.to_string(), regimes);
            waves.push((beta, wave, point));
        }
    }
    waves
}

#[test]
fn zero_is_an_eigenvalue() {
    let mut worst = 0.0_f64;
    for (_, wave, point) in specimens() {
        let characteristic = Characteristic::new(&wave, &point).expect("Coulomb's law");
        let [trace, _] = characteristic.evaluate(C64::new(0.0, 0.0)).numbers();
        worst = worst.max((trace - 1.0).norm());
    }
    observed("translation with material damping", worst);
    // V̇ is carried over the zones to the rounding of V̈ over that of V⃛ in a reversal
    assert!(worst < 1e-11, "{worst:e}");
}

/// Eigenvalues of a spectrum with Re λ above a bound.
pub fn leading(spectrum: &Spectrum, least: f64) -> Vec<(usize, C64)> {
    assert!(spectrum.complete);
    spectrum
        .sectors
        .iter()
        .flat_map(|sector| {
            spectrum.listed(sector).map(|one| {
                // the error that is stated is one of rounding, however small β is
                let scale = 1.0 + one.value().norm();
                assert!(one.error < 1e-12 * scale, "{one:?}");
                (sector.sector, one.value())
            })
        })
        .filter(|(_, value)| value.re > least)
        .collect()
}

/// (λ(β) − λ(0))/β tends to a limit: β = 0 is a regular point of the spectrum too.
#[test]
fn the_undamped_limit_is_regular() {
    let spectrum = |beta: f64| {
        let (wave, point) = wave(&with_beta(0.2, beta), 4, Which::Fast);
        window(&Characteristic::new(&wave, &point).expect("Coulomb's law"))
    };
    let undamped = leading(&spectrum(0.0), -0.1);
    let slopes = |beta: f64| -> Vec<C64> {
        let damped = leading(&spectrum(beta), -0.2);
        undamped
            .iter()
            .map(|(sector, value)| {
                let near = damped.iter().filter(|(other, _)| other == sector);
                let moved = near.map(|(_, other)| other - value);
                let least = moved.min_by(|one, other| one.norm().total_cmp(&other.norm()));
                least.expect("eigenvalues of this sector") / beta
            })
            .collect()
    };
    assert!(undamped.len() > 10);
    let limit = slopes(1e-7);
    for beta in [1e-6, 1e-8, 1e-9] {
        for (slope, limit) in slopes(beta).into_iter().zip(&limit) {
            // rounding of eigenvalues, 1e-13, and the term of second order
            let allowed = 1e4 * beta.max(1e-7) * (1.0 + limit.norm()) + 1e-12 / beta;
            assert!(
                (slope - limit).norm() < allowed,
                "β = {beta}: {slope} for {limit}"
            );
        }
    }
}

/// The derivative of N(λ)e^{−λT} against fourth-order differences.
#[test]
fn derivatives_equal_differences() {
    const STEP: f64 = 1e-3;
    let mut worst = 0.0_f64;
    // below, the exponent of the common factor e^{T/ρ} is too large a number for differences
    for (beta, wave, point) in specimens().into_iter().filter(|(beta, ..)| *beta > 5e-6) {
        let characteristic = Characteristic::new(&wave, &point).expect("Coulomb's law");
        for lambda in [
            C64::new(0.0, 0.0),
            C64::new(0.1, 2.5),
            C64::new(-0.4, 7.0),
            C64::new(0.02, 31.0),
            C64::new(0.0, 400.0),
        ] {
            let at = |shift: f64| characteristic.evaluate(lambda + shift * STEP);
            let here = at(0.0);
            let top = here.top() + here.offset;
            let f = |shift: f64| {
                let value = at(shift);
                value.sector(C64::new(0.0, 1.0)).0 * (value.top() + value.offset - top).exp()
            };
            let difference = ((f(1.0) - f(-1.0)) * 8.0 - (f(2.0) - f(-2.0))) / (12.0 * STEP);
            let (value, derivative) = here.sector(C64::new(0.0, 1.0));
            // the common factor is known to the rounding of its exponent
            let exponent = here.offset.abs() * f64::EPSILON;
            let size = derivative.norm() + value.norm();
            let error = (difference - derivative).norm() / size;
            let allowed = 1e-8 + 4.0 * exponent / STEP * value.norm() / size;
            assert!(error < allowed, "β = {beta}, λ = {lambda}: {error:e}");
            worst = worst.max(error);
        }
    }
    observed("dF/dλ with material damping", worst);
}

/// N(λ) of slip-stick waves by spectral collocation of the third-order equation with η = 1, η′ = 0 at
/// release and η′ = 0 at arrest.
#[test]
fn collocation_finds_the_same_function() {
    let mut worst = 0.0_f64;
    for (beta, n) in [(1.1e-2, 44), (6e-3, 56), (3e-3, 72)] {
        let (wave, point) = wave(&with_beta(0.2, beta), 4, Which::Fast);
        let characteristic = Characteristic::new(&wave, &point).expect("Coulomb's law");
        let c = wave.model_at(&point).constants().coefficients;
        let speed = wave.speed_at(&point);
        let slip = wave.duration_at(&point, 0);
        let ratio = c.a / (speed * speed);
        let drive = wave.model.friction * c.coupling / speed;
        let d = differentiation(n, slip).map(C64::from);
        let identity = DMatrix::<C64>::identity(n + 1, n + 1);
        for lambda in [
            C64::new(0.0, 0.0),
            C64::new(0.05, 2.5),
            C64::new(-0.3, -6.0),
            C64::new(0.4, 11.0),
        ] {
            // η″ + [h − σfκ(d − λ) − ã(d − λ)²](η + βη′) = 0
            let shifted = &d - &identity * lambda;
            let stress = &identity * C64::from(c.h)
                - &shifted * C64::from(drive)
                - &shifted * &shifted * C64::from(ratio);
            let hat = &identity + &d * C64::from(beta);
            let mut matrix = &d * &d + stress * hat;
            let mut right = DVector::<C64>::zeros(n + 1);
            matrix.set_row(0, &d.row(0).clone_owned());
            matrix.set_row(n, &d.row(n).clone_owned());
            matrix.set_row(n - 1, &identity.row(n).clone_owned());
            right[n - 1] = C64::from(1.0);
            let eta = matrix.lu().solve(&right).expect("a regular problem");
            let expected = eta[0] * (-lambda * characteristic.period).exp();
            let [found, _] = characteristic.evaluate(lambda).numbers();
            let error = (found - expected).norm() / expected.norm().max(1.0);
            // rounding of the third derivative, N⁶ε/T³ and what three products add, in units of hη
            let rounding = (n as f64).powi(6) * f64::EPSILON / slip.powi(3);
            let allowed = 100.0 * rounding * beta * ratio / c.h;
            assert!(error < allowed, "{error:e}, allowed {allowed:e}");
            worst = worst.max(error);
        }
    }
    observed("N(λ) against spectral collocation", worst);
}

/// How far the eigenfunctions of a window are from closing, and from their equations.
pub fn eigenfunction_defects(characteristic: &Characteristic, speed: f64) -> [f64; 2] {
    let (mut closure, mut residual) = (0.0_f64, 0.0_f64);
    for (sector, lambda) in leading(&window(characteristic), -0.3) {
        let found = eigenfunction(characteristic, speed, sector, lambda, 60);
        closure = closure.max(found.closure_residual);
        residual = residual.max(found.equation_residual);
    }
    [closure, residual]
}

/// Eigenfunctions come from a linear system over all zones, the eigenvalues from the compound flow:
/// both agree, and the equations hold.
#[test]
fn eigenfunctions_close() {
    let (mut closure, mut residual) = (0.0_f64, 0.0_f64);
    for (_, wave, point) in specimens() {
        let characteristic = Characteristic::new(&wave, &point).expect("Coulomb's law");
        let defects = eigenfunction_defects(&characteristic, wave.speed_at(&point));
        closure = closure.max(defects[0]);
        residual = residual.max(defects[1]);
    }
    observed("closure of eigenfunctions with material damping", closure);
    observed("their equations, by differences", residual);
    // λ is known to 1e-13, and so is N
    assert!(closure < 1e-10, "{closure:e}");
    // sixth-order differences err by (h|λ|)⁶/140, h being 1e-2 of a zone and |λ| up to 13
    assert!(residual < 2e-7, "{residual:e}");
}

/// Mode 2 just above its Hopf point, with both kinds of damping: no eigenvalue of either sector grows,
/// at any frequency.
#[test]
fn a_wave_is_stable_on_the_full_circle() {
    let at = |friction: f64| {
        let model = Model {
            damping: Damping {
                mass: 0.05,
                stiffness: 0.004,
            },
            ..tube(0.3, 1.5, friction, 0.6)
        };
        let (wave, point) = wave(&model, 2, Which::Fast);
        assert_eq!(wave.signature.to_string(), "slip-stick");
        window(&Characteristic::new(&wave, &point).expect("Coulomb's law"))
    };
    let stable = at(0.24);
    assert!(stable.complete && stable.stable == Stability::Yes);
    assert_eq!(stable.unstable(), 0);
    assert!(stable.lead().expect("an eigenvalue").0.re < -3e-3);
    // beyond the Hopf point of sector 1, f = 0.25397
    let unstable = at(0.26);
    assert_eq!((unstable.stable, unstable.unstable()), (Stability::No, 2));
}

/// Real eigenvalues of a sector that is its own conjugate are listed, on whichever side of the axis
/// rounding puts them: here λ = −2.957945006031965 of sector 1, known from 60 digits.
#[test]
fn real_eigenvalues_are_listed() {
    let model = Model {
        damping: Damping {
            mass: 0.0,
            stiffness: 0.045,
        },
        ..tube(0.45, 1.25, 0.5, 0.4)
    };
    let (wave, point) = wave(&model, 2, Which::Fast);
    let spectrum = window(&Characteristic::new(&wave, &point).expect("Coulomb's law"));
    assert_eq!(spectrum.stable, Stability::Yes);
    let sector = &spectrum.sectors[1];
    let real = spectrum.listed(sector).find(|value| value.im == 0.0);
    let error = real.expect("a real eigenvalue").re + 2.957_945_006_031_965;
    assert!(error.abs() < 1e-12, "{error:e}");
    // every other zero of the sector has its conjugate
    let listed = spectrum.listed(sector);
    let all: usize = listed.map(|value| 1 + usize::from(value.im > 0.0)).sum();
    let inside = sector.eigenvalues.iter();
    assert_eq!(all, inside.filter(|value| value.im.abs() <= 12.0).count());
}

/// The wave of a problem file that a branch in the mismatch reaches, and its spectrum.
fn reached(text: &str) -> Spectrum {
    let problem = problem::parse(text, "damped").expect("a problem");
    let rows = follow(&problem, text);
    let user = |item: &WaveItem| item.point.kind == Some(EventType::UZ);
    let item = rows.items.iter().find(|item| user(item)).expect("a point");
    let (wave, point) = item.wave();
    window(&Characteristic::new(wave, point).expect("Coulomb's law"))
}

/// Eigenvalues of an independent program, in these sectors, and how well they are known.
#[track_caller]
fn has(spectrum: &Spectrum, known: f64, expected: &[(usize, [f64; 2])]) {
    for &(sector, [re, im]) in expected {
        let value = C64::new(re, im);
        let near = |one: &WaveEigenvalue| (one.value() - value).norm();
        let all = spectrum.sectors[sector].eigenvalues.iter();
        let error = all.map(near).fold(f64::INFINITY, f64::min);
        observed(&format!("eigenvalue of sector {sector}"), error);
        assert!(error < known, "{value}: {error:e}");
    }
}

/// A wave whose period ends as the reaction brings V̇ to 1: two conditions join a period to the next, not
/// three, for the landing forgets V̈.
#[test]
fn arrested_landings_may_close_a_period() {
    let spectrum = reached(
        "(model: (coefficients: Geometry(nu: 0.27, xi: 1.43, gamma: 1.0), friction: 0.5, mismatch: 0.2,
          damping: (stiffness: 0.004)), wave: (mode: 3, start: Fast), continuation: (parameter: Mismatch,
          range: (0.0067, 0.2), toward: Down, ds: 0.05, ds_max: 0.05, stop_at: [0.0067055661985]))",
    );
    let growing = [0.01080817551, -0.8568059725];
    let decaying = [-0.001478614178, 1.751497998];
    // ten digits are given
    has(&spectrum, 2e-9, &[(1, growing), (1, decaying)]);
    assert_eq!(spectrum.stable, Stability::No);
    let defect = spectrum.translation_defect.expect("sector 0 was asked for");
    assert!(defect < 1e-11, "{defect:e}");
}

/// Layers whose amplitude at the other end of a zone is of the order 1e-200 leave the spectrum as it is.
#[test]
fn faint_layers_do_not_refuse_a_spectrum() {
    for (beta, [re, im]) in [
        (0.0008, [-0.021356294273, 1.2548105316]),
        (0.001, [-0.02065449641, 1.254861908]),
    ] {
        let spectrum = reached(&format!(
            "(model: (coefficients: Geometry(nu: 0.25, xi: 1.5, gamma: 1.0), friction: 0.5, mismatch: 0.2,
              damping: (stiffness: {beta})), wave: (mode: 2, start: Fast), continuation: (parameter: Mismatch,
              range: (0.0234, 0.2), toward: Down, ds: 0.05, ds_max: 0.05, stop_at: [0.0234606]))",
        ));
        // the mismatch is given to seven digits
        has(&spectrum, 1e-7, &[(1, [re, im])]);
        assert_eq!(spectrum.unstable(), 0);
    }
}
