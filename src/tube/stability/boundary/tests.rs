//! N against an independent program, its derivative, and the compound flow.

use super::*;
use crate::tube::stability::perturbation::{Reaction, Value};

/// ν = 0.3, ξ = 1.5, γ = 1, f = 0.5, mode 4, without mass damping.
fn wave(beta: f64, speed: f64, zones: Vec<LinearZone>) -> Characteristic {
    let [a, b, d, g, h]: [f64; 5] = [
        1.087571206929277,
        0.31073463055122197,
        -0.8109523622920911,
        17.855545645727595,
        8.457890042713071,
    ];
    let square = speed * speed;
    Characteristic {
        period: zones.iter().map(|zone| zone.duration).sum(),
        zones,
        stick: true,
        mode: 4,
        excess: speed.abs() / a.sqrt() - 1.0,
        ma: 1.0 - a / square,
        mb: 1.0 - b / square,
        a: a / square,
        b: b / square,
        kappa: d / speed,
        g,
        h,
        friction: 0.5,
        static_friction: 0.5,
        damping: 0.0,
        beta,
        turn: 0.0,
        defect: 0.0,
    }
}

fn zone(regime: Regime, duration: f64, jump: PerturbationJump) -> LinearZone {
    LinearZone {
        regime,
        duration,
        jump,
        course: None,
    }
}

/// slip-separation-stick at δ = 0.01, from an independent program, with V̈/Ü before the landing.
fn separated(beta: f64, [slip, free, stick]: [f64; 3], speed: f64, ratio: f64) -> Characteristic {
    let share = 0.5 * 0.31073463055122197 / 1.087571206929277;
    let landing = Reaction {
        before: ratio,
        after: 0.0,
        bend: 0.0,
        share,
        lift: 0.0,
        arrested: true,
    };
    let zones = vec![
        zone(Regime::Slip, slip, PerturbationJump::Depart(share)),
        zone(Regime::Separation, free, PerturbationJump::Settle(landing)),
        zone(Regime::Stick, stick, PerturbationJump::None),
    ];
    let mut wave = wave(beta, speed, zones);
    wave.turn = wave.material_turn();
    wave
}

fn specimens() -> [(Characteristic, [C64; 4]); 3] {
    let number = C64::new;
    [
        (
            separated(
                0.005,
                [0.3352077195928157, 0.8167057053031375, 0.09190901759717841],
                -1.2628782639155272,
                0.0829631002327951,
            ),
            [
                number(1.0, 0.0),
                number(-0.4423034386157088, -0.6816164577859914),
                number(0.43385317297565, -0.6803887415518491),
                number(-1.0145105895653699, -0.055474937299201464),
            ],
        ),
        (
            separated(
                0.001,
                [0.33083316494179377, 0.8195999707021037, 0.09692399427074753],
                -1.25929959361549,
                0.004100293122075833,
            ),
            [
                number(1.0, 0.0),
                number(-0.5098192055689909, -0.5826178613675397),
                number(0.5417361049113807, -0.8070189253941591),
                number(-1.345094002303426, -0.12145905424470385),
            ],
        ),
        (
            separated(
                1e-6,
                [0.3301748216008823, 0.8205530863955943, 0.09727835809135124],
                -1.2586445833472704,
                -0.013920682629959083,
            ),
            [
                number(1.0, 0.0),
                number(-0.5345329422448382, -0.5472062135130125),
                number(0.6135388179633604, -0.8425484060987555),
                number(-1.4469387942118943, -0.17912658617268695),
            ],
        ),
    ]
}

/// N of waves whose data have some 13 digits, over β.
#[test]
fn values_of_an_independent_program() {
    let places = [(0.0, 0.0), (0.1, 1.0), (0.3, 9.0), (1.0, 30.0)];
    for (wave, expected) in specimens() {
        for ((re, im), expected) in places.into_iter().zip(expected) {
            let lambda = C64::new(re, im);
            let [found, _] = wave.evaluate_material(lambda).numbers();
            let error = (found * (lambda * wave.period).exp() - expected).norm();
            assert!(error < 1e-11, "β = {}, λ = {lambda}: {error:e}", wave.beta);
        }
    }
}

/// Derivatives against differences of fourth order: of the size F they err by (hT)⁴/30, and by the
/// rounding ε(1 + |λ|T) of exponents over hT, times the hundred operations of an elimination.
#[test]
fn derivatives_are_those_of_the_values() {
    for (wave, _) in specimens() {
        for (re, im) in [(0.0, 0.0), (0.3, 1.7), (-0.4, 12.0), (0.1, 70.0)] {
            let lambda = C64::new(re, im);
            // N e^{−λT}, in which the exponents of the layers cancel
            let of = |lambda: C64| {
                let Value { unit, trace, .. } = wave.evaluate_material(lambda);
                let [value, _] = wave.evaluate_material(lambda).numbers();
                let by = trace.derivative / trace.value - unit.derivative / unit.value;
                (value, value * by)
            };
            let h = 1e-3;
            let f = |shift: f64| of(lambda + shift * h).0;
            let difference = ((f(1.0) - f(-1.0)) * 8.0 - (f(2.0) - f(-2.0))) / (12.0 * h);
            let (value, by) = of(lambda);
            let error = (difference - by).norm() / (value.norm() + by.norm());
            let turned = f64::EPSILON * (1.0 + lambda.norm() * wave.period) / h;
            let allowed = 100.0 * ((h * wave.period).powi(4) / 30.0 + turned);
            assert!(
                error < allowed,
                "β = {}, λ = {lambda}: {error:e}",
                wave.beta
            );
        }
    }
}

/// N of waves that slide is the same from determinants and by the compound flow.
#[test]
fn sliding_as_by_the_compound_flow() {
    for beta in [1e-2, 1e-4, 1e-8] {
        let zones = vec![
            zone(Regime::Slip, 0.98, PerturbationJump::Bend(0.7 / beta)),
            zone(Regime::Reverse, 0.07, PerturbationJump::Arrest),
            zone(Regime::Stick, 0.21, PerturbationJump::None),
        ];
        let wave = wave(beta, -1.243, zones);
        for (re, im) in [
            (0.0, 0.0),
            (0.3, 1.7),
            (-0.4, 12.0),
            (0.1, 70.0),
            (1.2, 0.0),
        ] {
            let lambda = C64::new(re, im);
            let [expected, _] = wave.evaluate_material(lambda).numbers();
            let (values, common) = wave.boundary_values(lambda);
            let [found, _] = wave.quotient(lambda, values, common).numbers();
            let error = (found - expected).norm() / expected.norm().max(1.0);
            assert!(error < 1e-12, "β = {beta}, λ = {lambda}: {error:e}");
        }
    }
}

/// N tends to a limit with the length of a separation zone, and smoothly, however brief the zone is against
/// the layers: second differences over 1e-3 of a length are of the size 1e-6, and rounding is below that.
#[test]
fn nascent_zones_are_smooth() {
    for beta in [5e-3, 1e-5, 1e-8] {
        let lambda = C64::new(0.2, 3.0);
        let split = |length: f64| {
            let share = 0.5 * 0.31073463055122197 / 1.087571206929277;
            let landing = Reaction {
                before: 0.0,
                after: 0.0,
                bend: 0.0,
                share,
                lift: 0.0,
                arrested: false,
            };
            let zones = vec![
                zone(Regime::Slip, 0.5, PerturbationJump::Depart(share)),
                zone(
                    Regime::Separation,
                    length,
                    PerturbationJump::Settle(landing),
                ),
                zone(Regime::Slip, 0.48, PerturbationJump::Arrest),
                zone(Regime::Stick, 0.28, PerturbationJump::None),
            ];
            let [value, _] = wave(beta, -1.243, zones)
                .evaluate_material(lambda)
                .numbers();
            value
        };
        for length in [1e-12, 1e-9, 1e-7, 1e-5, 1e-3] {
            let [one, two, three] = [0.999, 1.0, 1.001].map(|factor| split(length * factor));
            let size = two.norm().max(1e-3);
            let rough = (one + three - two * 2.0).norm() / size;
            assert!(rough < 1e-5, "β = {beta}, length {length:e}: {rough:e}");
            let moved = (two - split(1e-9)).norm() / size;
            // on the scale of the exponents, up to 10
            assert!(moved < 10.0 * length + 1e-5, "β = {beta}: {moved:e}");
        }
    }
}
