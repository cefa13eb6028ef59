//! Modes of the user's own times those of contacts: what a switch of the first leads to is settled in the same instant.

use brakewave::affine::orbit::AffineOrbit;
use brakewave::affine::orbit::start::{Beginning, Search, Wanted, first};
use brakewave::linalg::Vector;
use brakewave::orbit::Zones;

use crate::affine::systems::system;

/// A block with friction F on a spring, pushed with A for T1 and with B for T2. States come in units, the place from an origin.
fn clock(unit: f64, origin: f64, order: [usize; 3]) -> String {
    let place = format!("((x - {origin:?})/{unit:?})");
    let all = [
        ("x".to_owned(), format!("{unit:?}*v")),
        ("v".to_owned(), format!("PUSH - {place} + q")),
        ("s".to_owned(), "1".to_owned()),
    ];
    let names = order.map(|index| format!("{:?}", all[index].0)).join(", ");
    let rates = |push: &str| {
        let rates = order.map(|index| {
            let (name, rate) = &all[index];
            format!("{name:?}: {:?}", rate.replace("PUSH", push))
        });
        rates.join(", ")
    };
    let (on, off) = (rates("A"), rates("B"));
    format!(
        r#"(
            states: [{names}],
            parameters: {{"F": 0.4, "A": 1.0, "B": -0.1, "T1": 1.2, "T2": 5.0}},
            contacts: {{"q": Friction(slip: "v", bound: "F")}},
            modes: {{
                "on": (rates: {{{on}}}, until: [(zero: "T1 - s", to: "off", reset: {{"s": "0"}})]),
                "off": (rates: {{{off}}}, until: [(zero: "T2 - s", to: "on", reset: {{"s": "0"}})]),
            }},
        )"#
    )
}

/// The orbit that a motion from rest settles on.
fn settled(text: &str, origin: f64, order: [usize; 3], time: f64) -> (AffineOrbit, Vector) {
    let system = system(text);
    let beginning = Beginning {
        mode: system.mode("on.stick").unwrap(),
        state: order.map(|index| [origin, 0.0, 0.0][index]).to_vec(),
        phase: 0.0,
    };
    let mut wanted = Wanted::new(system, "T1", (0.8, 1.4)).unwrap();
    wanted.values[3] = time;
    wanted.periods = 12;
    wanted.stability = true;
    first(&wanted, &beginning, Search::Settles(200.0)).unwrap()
}

/// While it is pushed with B it comes to rest, and is released by A. With a = A − F, b = B − F and c = B + F it goes from rest at x₀
/// along a circle about a for T1, along one about b to its rest, and along one about c to the next, where it stays:
/// x₀ = 2c − b − r, r being the radius of the second. That is linear in u = a − x₀.
#[test]
fn a_block_is_released_by_a_clock() {
    let (a, b, c) = (0.6_f64, -0.5_f64, 0.3_f64);
    for time in [0.9_f64, 1.2] {
        // r² = (a − b − u cos T)² + (u sin T)² = (2c − b − a + u)²
        let (cos, reach) = (time.cos(), 2.0 * c - b - a);
        let u = ((a - b).powi(2) - reach.powi(2)) / (2.0 * (reach + (a - b) * cos));
        let radius = reach + u;
        let multiplier = (u - (a - b) * cos) / radius;
        for (unit, origin, order) in [
            (1.0, 0.0, [0, 1, 2]),
            (1e3, 0.0, [0, 1, 2]),
            (1.0, 1.7, [0, 1, 2]),
            (1.0, 0.0, [2, 1, 0]),
        ] {
            let text = clock(unit, origin, order);
            let (orbit, point) = settled(&text, origin, order, time);
            let names = orbit.cycle(&point).unwrap().names.join("-");
            assert_eq!(names, "on.forward-off.forward-off.backward-off.stick");
            let examined = orbit.examination(&point).unwrap();
            let place = order.iter().position(|index| *index == 0).unwrap();
            let least = (examined.extremes[place].0 - origin) / unit;
            assert!((least - (a - u)).abs() < 1e-13, "{least} for {}", a - u);
            let own = examined.multipliers.iter().filter(|one| !one.trivial);
            let leading = own.max_by(|one, other| one.value.norm().total_cmp(&other.value.norm()));
            let leading = leading.unwrap().value;
            let off = (leading.re - multiplier).hypot(leading.im);
            assert!(off < 1e-12, "{leading} for {multiplier}");
        }
    }
}
