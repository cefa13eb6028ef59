//! Equilibria in closed form.

use brakewave::affine::steady::NoEquilibrium;

use crate::affine::systems::{CHUA, IMPACT, RELAY, at, system};

/// Chua's circuit has x = ±1.5, y = 0, z = −x, with eigenvalues ±iω at the Hopf point: α_H = 6.80175…, ω² = β − α_H(1 − n).
#[test]
fn equilibria_of_chua() {
    let (n, beta) = (2.0_f64 / 7.0, 14.3);
    let half = (1.0 - n) / (2.0 * n * (1.0 - n));
    let alpha = -half + (half * half + beta / (n * (1.0 - n))).sqrt();
    assert!((alpha - 6.801_754_206_009_431).abs() < 1e-13);
    let system = system(CHUA);
    let affine = at(&system, &[("alpha", alpha)]);
    for (mode, x, admissible) in [
        ("inner", 0.0, true),
        ("upper", 1.5, true),
        ("lower", -1.5, true),
    ] {
        let found = &affine.equilibria(system.mode(mode).unwrap()).unwrap()[0];
        for (state, expected) in found.state.iter().zip([x, 0.0, -x]) {
            assert!(
                (state - expected).abs() < 1e-13,
                "{mode}: {:?}",
                found.state
            );
        }
        assert_eq!(found.violated.is_none(), admissible, "{mode}");
        if x != 0.0 {
            let omega = (beta - alpha * (1.0 - n)).sqrt();
            let [first, second, _] = found.eigenvalues[..] else {
                panic!()
            };
            // simple eigenvalues of a matrix of norm 15
            assert!(
                first.re.abs() < 1e-13 && second.re.abs() < 1e-13,
                "{first} {second}"
            );
            assert!((first.im - omega).abs() < 1e-13 && (second.im + omega).abs() < 1e-13);
        }
    }
}

/// The relay has its equilibria where its own output says otherwise, but for the one in sliding: the double
/// eigenvalue ρ of the zeros of the process, and the zero of the direction across.
#[test]
fn a_virtual_equilibrium_and_one_in_sliding() {
    let system = system(RELAY);
    let affine = at(&system, &[("rho", 0.25)]);
    let plus = &affine.equilibria(system.mode("plus").unwrap()).unwrap()[0];
    assert!((plus.state[0] + 0.0625).abs() < 1e-14 && plus.violated == Some(0));
    let slide = &affine.equilibria(system.mode("slide").unwrap()).unwrap()[0];
    assert!(slide.state.iter().all(|x| x.abs() < 1e-14) && slide.violated.is_none());
    let sum: f64 = slide.eigenvalues.iter().map(|value| value.re).sum();
    assert!((sum - 0.5).abs() < 1e-14);
    // a double eigenvalue is known to the square root of rounding
    assert!((slide.eigenvalues[0] - 0.25).norm() < 1e-7 && slide.eigenvalues[2].norm() < 1e-14);
}

#[test]
fn what_is_forced_or_singular_does_not_rest() {
    let forced = system(IMPACT);
    assert_eq!(at(&forced, &[]).equilibria(0), Err(NoEquilibrium::Forced));
    let free = system(r#"(states: ["x", "v"], modes: {"only": (rates: {"x": "v", "v": "-v"})})"#);
    assert_eq!(at(&free, &[]).equilibria(0), Err(NoEquilibrium::Singular));
}
