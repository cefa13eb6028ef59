//! The limit of Re λ at high frequency.
//!
//! For slip-stick waves in closed form: with q = √a/|c|, G = |fD/c|, F = G − α, A, B = (1 ± q)/2,
//! y₁ = (Fq/(1+q) − G)/(2q), y₂ = (Fq/(1−q) + G)/(2q), it is the root ρ of
//!
//! ```text
//! A e^{y₁T₁ − ρ(T − qT₁/(1+q))} + B e^{y₂T₁ − ρ(T + qT₁/(1−q))} = 1.
//! ```

use brakewave::tube::model::Model;
use brakewave::tube::stability::asymptotic::HighFrequency;
use brakewave::tube::stability::characteristic::Characteristic;
use brakewave::tube::stability::spectrum::{SpectrumRequest, spectrum};
use brakewave::tube::wave::start::Which;

use crate::stability::observed;
use crate::stability::waves::{damped, linearised, mode4, tube, wave, with_coulomb_impact};

/// The closed form, by Newton's method on a falling convex function from the left.
fn closed_form(model: &Model, mode: u32, which: Which) -> f64 {
    let (wave, point) = wave(model, mode, which);
    assert_eq!(wave.signature.to_string(), "slip-stick");
    let parameters = model.constants();
    let speed = wave.speed_at(&point).abs();
    let (slip, period) = {
        let slip = wave.duration_at(&point, 0);
        (slip, slip + wave.duration_at(&point, 1))
    };
    let q = parameters.coefficients.a.sqrt() / speed;
    let drive = (parameters.friction * parameters.coefficients.coupling / speed).abs();
    let force = drive - parameters.mass_damping;
    let one = (force * q / (1.0 + q) - drive) / (2.0 * q);
    let two = (force * q / (1.0 - q) + drive) / (2.0 * q);
    let terms = [
        (0.5 * (1.0 + q), one * slip, period - q * slip / (1.0 + q)),
        (0.5 * (1.0 - q), two * slip, period + q * slip / (1.0 - q)),
    ];
    // each term alone is 1 at a ρ left of the root
    let mut rho = terms
        .iter()
        .map(|(factor, growth, delay)| (factor.ln() + growth) / delay)
        .fold(f64::NEG_INFINITY, f64::max);
    for _ in 0..60 {
        let value: f64 = terms
            .iter()
            .map(|(factor, growth, delay)| factor * (growth - rho * delay).exp())
            .sum();
        let slope: f64 = terms
            .iter()
            .map(|(factor, growth, delay)| -delay * factor * (growth - rho * delay).exp())
            .sum();
        rho -= (value - 1.0) / slope;
    }
    rho
}

#[test]
fn slip_stick_in_closed_form() {
    let cases = [
        (mode4(0.2), 4, Which::Fast),
        (mode4(0.8), 4, Which::Slow),
        (tube(0.3, 1.5, 0.1, 0.3), 4, Which::Fast),
        (tube(0.3, 1.5, 0.8, 0.4), 4, Which::Fast),
        (damped(0.1), 4, Which::Fast),
        (damped(0.3), 4, Which::Fast),
        (tube(0.25, 1.25, 0.446, 0.06), 8, Which::Fast),
        (tube(0.45, 1.25, 0.1, 0.1), 4, Which::Fast),
        (tube(0.3, 1.5, 0.4, 0.2), 1, Which::Fast),
    ];
    let mut worst = 0.0_f64;
    for (model, mode, which) in cases {
        let expected = closed_form(&model, mode, which);
        let found = HighFrequency::new(&linearised(&model, mode, which)).limit();
        let error = (found - expected).abs() / (1.0 + expected.abs());
        worst = worst.max(error);
        assert!(error < 1e-12, "{model:?}: {found} for {expected}");
    }
    observed("limit at high frequency", worst);
    let known = HighFrequency::new(&linearised(&mode4(0.2), 4, Which::Fast)).limit();
    // known to three digits
    assert!((known - 0.0434).abs() < 1e-4, "{known}");
}

/// Largest Re λ with |Im λ| in a range, all sectors.
fn largest(characteristic: &Characteristic, low: f64, high: f64) -> f64 {
    let request = SpectrumRequest {
        sectors: (0..=characteristic.mode as usize / 2).collect(),
        eigenvalues: 1,
        max_frequency: high,
    };
    let spectrum = spectrum(characteristic, &request, None);
    assert!(spectrum.complete);
    spectrum
        .sectors
        .iter()
        .flat_map(|sector| &sector.eigenvalues)
        .filter(|one| one.im.abs() >= low && one.im.abs() <= high)
        .map(|one| one.re)
        .fold(f64::NEG_INFINITY, f64::max)
}

/// The lim sup is approached from either side; what is left of it falls like 1/|Im λ|.
#[test]
fn eigenvalues_approach_the_limit() {
    let characteristic = linearised(&mode4(0.2), 4, Which::Fast);
    let limit = HighFrequency::new(&characteristic).limit();
    let found = largest(&characteristic, 200.0, 400.0);
    println!(
        "observed: largest Re λ of slip-stick at high frequency: {found:.6}, limit {limit:.6}"
    );
    assert!((found - limit).abs() < 5e-3, "{found} for {limit}");
}

#[test]
fn no_eigenvalue_exceeds_the_limit() {
    /// Over |Im λ|.
    const EXCESS: f64 = 1.0;
    for (model, mode) in [
        (mode4(0.08), 4),
        (mode4(0.045), 4),
        (mode4(0.02), 4),
        (mode4(0.001), 4),
        (tube(0.45, 1.25, 0.1, 0.01), 4),
        (with_coulomb_impact(0.045), 4),
        (with_coulomb_impact(0.01), 4),
    ] {
        let (wave, point) = wave(&model, mode, Which::Fast);
        let characteristic = Characteristic::new(&wave, &point).expect("a linear law");
        let limit = HighFrequency::new(&characteristic).limit();
        let found = largest(&characteristic, 100.0, 200.0);
        println!(
            "observed: largest Re λ of {} at high frequency: {found:.6}, limit {limit:.6}",
            wave.signature
        );
        assert!(
            found < limit + EXCESS / 100.0,
            "{}: {found} beyond {limit}",
            wave.signature
        );
    }
}
