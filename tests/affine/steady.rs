//! Equilibria in closed form.

use brakewave::affine::steady::{Admissibility, Equilibrium, Isolation, NoEquilibrium};

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
        assert_eq!(
            found.place == Admissibility::Admissible,
            admissible,
            "{mode}"
        );
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
/// eigenvalue ρ of the zeros of the process.
#[test]
fn a_virtual_equilibrium_and_one_in_sliding() {
    let system = system(RELAY);
    let affine = at(&system, &[("rho", 0.25)]);
    let plus = &affine.equilibria(system.mode("plus").unwrap()).unwrap()[0];
    assert!(
        (plus.state[0] + 0.0625).abs() < 1e-14
            && matches!(plus.place, Admissibility::Virtual { guard: 0, .. })
    );
    let slide = &affine.equilibria(system.mode("slide").unwrap()).unwrap()[0];
    assert!(
        slide.state.iter().all(|x| x.abs() < 1e-14) && slide.place == Admissibility::Admissible
    );
    let sum: f64 = slide.eigenvalues.iter().map(|value| value.re).sum();
    assert!((sum - 0.5).abs() < 1e-14);
    // a double eigenvalue is known to the square root of rounding
    assert_eq!(slide.eigenvalues.len(), 2);
    assert!((slide.eigenvalues[0] - 0.25).norm() < 1e-7);
}

/// On the surface x = 0 Filippov's field is y' = (y + .36)/(-y - .6), regular where it rests: its slope there is -1/.24, although the state
/// across the surface is known to be zero exactly.
#[test]
fn an_equilibrium_on_a_surface_is_known_across_it() {
    let system = system(
        r#"(states: ["x", "y"], parameters: {"mu": 0.5}, modes: {
            "R": (rates: {"x": "0.4*x - y", "y": "1.2*(x - mu)"}, until: [(zero: "x", to: "L")]),
            "L": (rates: {"x": "0.6", "y": "-1"}, until: [(zero: "-x", to: "R")])},
            sliding: {"S": ("R", "L")})"#,
    );
    let all = at(&system, &[])
        .equilibria(system.mode("S").unwrap())
        .unwrap();
    assert_eq!(all.len(), 1);
    assert_eq!(all[0].stable, Some(true));
    assert!((all[0].state[1] + 0.36).abs() <= 1e-15 && all[0].state[0] == 0.0);
    assert!((all[0].eigenvalues[0].re + 1.0 / 0.24).abs() <= 1e-14);
}

#[test]
fn what_is_forced_or_singular_does_not_rest() {
    let forced = system(IMPACT);
    assert_eq!(at(&forced, &[]).equilibria(0), Err(NoEquilibrium::Forced));
    let free = system(r#"(states: ["x", "v"], modes: {"only": (rates: {"x": "v", "v": "-v"})})"#);
    assert_eq!(at(&free, &[]).equilibria(0), Err(NoEquilibrium::Singular));
}

/// Figures of 40 digits: states whose sizes differ by 1e4, where the matrix in these units has the condition 1e7.
#[test]
fn equilibria_do_not_depend_on_units() {
    let text = |rates: [&str; 3], zero: &str| {
        let [x, y, z] = rates;
        format!(
            r#"(states: ["x", "y", "z"], modes: {{"only": (rates: {{"x": "{x}", "y": "{y}", "z": "{z}"}},
                until: [(zero: "{zero}", to: "only", reset: {{"z": "0"}})])}})"#
        )
    };
    let first = [
        "2*x - 30*y + 20000*z - 300",
        "0.3*x - 2*y - 3000*z",
        "0.0003*x + 0.002*y + 0.01",
    ];
    let second = [
        "-30*y - 10000*z",
        "0.3*x - 3*y - 2000*z - 10",
        "-0.0001*x + 0.001*y - z - 0.03",
    ];
    let third = [
        "-3*x - 3000*y + 20",
        "0.001*x - 3*y - 0.03*z + 0.02",
        "-0.2*x + 100*y + z",
    ];
    for (rates, zero, exact) in [
        (
            first,
            "1e9 - x",
            [
                7.936_507_936_507_937,
                -6.190_476_190_476_190_5,
                0.004_920_634_920_634_921,
            ],
        ),
        (second, "z + 0.022", [-100.0 / 3.0, 20.0 / 3.0, -0.02]),
        (third, "1e6 - x", [4.0, 1.0 / 375.0, 8.0 / 15.0]),
    ] {
        let system = system(&text(rates, zero));
        let found = &at(&system, &[]).equilibria(0).unwrap()[0];
        for (state, exact) in found.state.iter().zip(exact) {
            // the decimals of the file are rounded: times the condition of the scaled matrix
            assert!(
                (state - exact).abs() < 1e-12 * exact.abs(),
                "{:?} {exact}",
                found.state
            );
        }
    }
}

/// x = 0 rests in `a`, whose guard 1/2 + cos φ − x is negative for a third of every period; x = 3 in `b` lies beyond its
/// guard always; with 1 + cos φ the guard touches zero, and with 1.5 it stays positive.
#[test]
fn guards_are_judged_at_every_phase() {
    let place = |zero: &str, mode: usize| {
        let text = format!(
            r#"(states: ["x"], parameters: {{"w": 1.0}}, forcing: "w", modes: {{
                "a": (rates: {{"x": "-x"}}, until: [(zero: "{zero}", to: "b")]),
                "b": (rates: {{"x": "3 - x"}}, until: [(zero: "2 - x", to: "a", reset: {{"x": "0"}})]),
            }})"#
        );
        at(&system(&text), &[]).equilibria(mode).unwrap()[0].place
    };
    let guard = 0;
    let at_times = Admissibility::Virtual {
        guard,
        at_times: true,
    };
    assert_eq!(place("0.5 + cos(phase) - x", 0), at_times);
    assert_eq!(
        place("0.5 + cos(phase) - x", 1),
        Admissibility::Virtual {
            guard,
            at_times: false
        }
    );
    assert_eq!(place("1.5 + cos(phase) - x", 0), Admissibility::Admissible);
    assert_eq!(
        place("1 + cos(phase) - x", 0),
        Admissibility::Boundary { guard }
    );
    // the least value of s + s², s = sin φ, is −1/4
    assert_eq!(
        place("0.2501 + sin(phase) + sin(phase)^2 - x", 0),
        Admissibility::Admissible
    );
    assert_eq!(place("0.2499 + sin(phase) + sin(phase)^2 - x", 0), at_times);
    // the least value of s + s² is told to rounding, as that of one harmonic
    for (above, expected) in [(1e-13, Admissibility::Admissible), (-1e-13, at_times)] {
        let zero = format!("0.25 + {above:e} + sin(phase) + sin(phase)^2 - x");
        assert_eq!(place(&zero, 0), expected, "{above:e}");
    }
}

/// A double well in units of 1e-9: ẍ = x − 10¹⁸x³ − cẋ rests at 0, a saddle, and at ±1e-9, foci.
#[test]
fn equilibria_are_told_apart_by_their_own_size() {
    let well = system(
        r#"(states: ["x", "v"], modes: {"only": (rates: {"x": "v", "v": "x - 1e18*x^3 - 0.1*v"})})"#,
    );
    let found = at(&well, &[]).equilibria(0).unwrap();
    let states: Vec<f64> = found.iter().map(|one| one.state[0]).collect();
    assert_eq!(states.len(), 3, "{states:?}");
    for (x, exact) in states.iter().zip([-1e-9, 0.0, 1e-9]) {
        assert!((x - exact).abs() < 1e-23, "{x:e}");
    }
    let stable: Vec<_> = found.iter().map(|one| one.stable).collect();
    assert_eq!(stable, [Some(true), Some(false), Some(true)]);
}

/// Lorenz' system rests at 0 and at x = y = ±√(β(ρ − 1)), z = ρ − 1, in whatever units x and z are; a pseudo-equilibrium on y = 0.4 does,
/// in whatever units y is.
#[test]
fn equilibria_of_modes_that_are_not_affine_do_not_depend_on_units() {
    for (x, z) in [
        (1.0, 1.0),
        (1e-6, 1.0),
        (1e9, 1.0),
        (1.0, 1e-6),
        (1e-3, 1e6),
    ] {
        let text = format!(
            r#"(states: ["x", "y", "z"], modes: {{"flow": (rates: {{
                "x": "10*(y/{x:e} - x)", "y": "28*{x:e}*x - y - {x:e}*{z:e}*x*z", "z": "{x:e}*x*y/{z:e} - 2*z"}})}})"#
        );
        let found = at(&system(&text), &[]).equilibria(0).unwrap();
        let own = |state: &[f64]| [state[0] * x, state[1], state[2] * z];
        let states: Vec<[f64; 3]> = found.iter().map(|one| own(&one.state)).collect();
        let root = 54f64.sqrt();
        let expected = [[-root, -root, 27.0], [0.0; 3], [root, root, 27.0]];
        assert_eq!(states.len(), 3, "{x:e}, {z:e}: {states:?}");
        for (state, expected) in states.iter().flatten().zip(expected.iter().flatten()) {
            assert!((state - expected).abs() < 1e-12, "{x:e}, {z:e}: {states:?}");
        }
    }
    for y in [1.0, 1e-6, 1e3, 1e9] {
        let eaten = format!("x*{y:e}*y/(0.3 + x)");
        let mode = |name: &str, other: &str, loss: f64, sign: &str| {
            format!(
                r#""{name}": (rates: {{"x": "x*(1 - x) - {eaten}", "y": "({eaten} - {loss}*{y:e}*y)/{y:e}"}},
                    until: [(zero: "{sign}(0.4 - {y:e}*y)", to: "{other}")])"#
            )
        };
        let text = format!(
            r#"(states: ["x", "y"], modes: {{{}, {}}}, sliding: {{"slide": ("low", "high")}})"#,
            mode("low", "high", 0.4, ""),
            mode("high", "low", 0.6, "-"),
        );
        let system = at(&system(&text), &[]);
        // modes of sliding follow those of the file
        let found = system.equilibria(2).unwrap();
        // x = 0, and (1 − x)(0.3 + x) = 0.4
        let states: Vec<f64> = found.iter().map(|one| one.state[0]).collect();
        assert_eq!(states.len(), 3, "{y:e}: {states:?}");
        for (x, expected) in states.iter().zip([0.0, 0.2, 0.5]) {
            assert!((x - expected).abs() < 1e-12, "{y:e}: {states:?}");
        }
    }
}

/// ẋ = −x³ and ẋ = (x − 1)² rest where their slope is zero; ẋ = y² rests on a whole line; ẋ = 1 + x² nowhere, which
/// Newton's method does not decide.
#[test]
fn degenerate_equilibria_are_found() {
    let rest = |states: &str, rates: &str| {
        let text = format!("(states: [{states}], modes: {{\"only\": (rates: {{{rates}}})}})");
        at(&system(&text), &[]).equilibria(0)
    };
    for (rate, exact, known) in [
        ("-x^3", 0.0, 0.0),
        ("(x - 1)^2", 1.0, 1e-7),
        ("x^2 - 2*x + 1", 1.0, 1e-7),
    ] {
        let found = rest("\"x\"", &format!("\"x\": \"{rate}\"")).unwrap();
        assert_eq!(found.len(), 1, "{rate}: {found:?}");
        assert!(
            (found[0].state[0] - exact).abs() <= known,
            "{rate}: {found:?}"
        );
        assert_eq!(
            (found[0].isolation, found[0].stable),
            (Isolation::Degenerate, None),
            "{rate}"
        );
    }
    // beside a rate that is regular
    let beside = "\"x\": \"-(x - 1)^3\", \"y\": \"x^5 - y\"";
    let found = rest("\"x\", \"y\"", beside).unwrap();
    assert_eq!(found.len(), 1, "{found:?}");
    assert!(
        found[0].state.iter().all(|x| (x - 1.0).abs() <= 1e-5),
        "{found:?}"
    );
    assert_eq!(found[0].isolation, Isolation::Degenerate);
    let line = rest("\"x\", \"y\"", "\"x\": \"y*x\", \"y\": \"y*x - y\"").unwrap();
    assert!(
        line.iter().any(|one| one.isolation == Isolation::Family),
        "{line:?}"
    );
    assert_eq!(
        rest("\"x\"", "\"x\": \"1 + x^2\""),
        Err(NoEquilibrium::NotFound)
    );
}

/// The food chain of Hastings and Powell: planes without a species are invariant, and Newton's method comes to the equilibria on them with
/// any number next to zero in the place of the species that is not there. Each is listed once: x = y = z = 0, x = 1, and those of prey
/// with one predator; there is one more off the axes, and one with x = 0, for a negative number of top predators.
#[test]
fn equilibria_on_invariant_planes_are_listed_once() {
    let text = r#"(states: ["x", "y", "z"], modes: {"flow": (rates: {
        "x": "x*(1 - x) - 5*x*y/(1 + 2.6*x)",
        "y": "5*x*y/(1 + 2.6*x) - 0.1*y*z/(1 + 2*y) - 0.4*y",
        "z": "0.1*y*z/(1 + 2*y) - 0.01*z"})})"#;
    let system = system(text);
    let system = at(&system, &[]);
    let found = system.equilibria(0).unwrap();
    for (index, one) in found.iter().enumerate() {
        let far = |other: &Equilibrium| {
            let pairs = one.state.iter().zip(&other.state);
            pairs.map(|(x, y)| (x - y).abs()).fold(0.0, f64::max) > 1e-6
        };
        assert!(found[index + 1..].iter().all(far), "{:?}", one.state);
        assert!(one.state.iter().all(|x| *x == 0.0 || x.abs() > 1e-6));
    }
    // 5x = 0.4(1 + 2.6x), 5y = (1 − x)(1 + 2.6x)
    let x = 0.4 / (5.0 - 0.4 * 2.6);
    let prey = [x, (1.0 - x) * (1.0 + 2.6 * x) / 5.0, 0.0];
    for expected in [[0.0; 3], [1.0, 0.0, 0.0], prey] {
        let near = |one: &&Equilibrium| {
            let pairs = one.state.iter().zip(&expected);
            pairs.map(|(x, y)| (x - y).abs()).fold(0.0, f64::max) < 1e-14
        };
        assert_eq!(found.iter().filter(near).count(), 1);
    }
}

/// Three cubic cells that drive one another in a ring have 3³ equilibria, no fewer where they are nearly apart and no more by Bézout: nine of
/// each size of the symmetry x → y → z, and their mirror images.
#[test]
fn a_ring_of_cubic_cells_has_all_its_equilibria() {
    for k in ["0.01", "0.1"] {
        let system = system(&format!(
            r#"(states: ["x", "y", "z"], parameters: {{"k": {k}}}, modes: {{"f": (rates: {{
                "x": "x - x^3 + k*y", "y": "y - y^3 + k*z", "z": "z - z^3 + k*x"}})}})"#
        ));
        let at = system.at(&system.values(), &[]).unwrap();
        let all = at.equilibria(0).unwrap();
        assert_eq!(all.len(), 27, "k = {k}");
        for one in &all {
            let [x, y, z] = [0, 1, 2].map(|state| one.state[state]);
            let images = [[y, z, x], [-x, -y, -z]];
            for image in images {
                let is_image = |other: &&Equilibrium| {
                    other
                        .state
                        .iter()
                        .zip(image)
                        .all(|(x, y)| (x - y).abs() <= 1e-13)
                };
                let image = all.iter().find(is_image);
                assert_eq!(image.map(|image| image.stable), Some(one.stable), "{one:?}");
            }
        }
        // the signs of the three cells
        assert_eq!(all.iter().filter(|one| one.stable == Some(true)).count(), 8);
    }
}
