//! Multipliers that rounding, or a coarse tolerance, tells badly: of orbits whose states grow by much within a zone, and beside
//! the unit circle.

use brakewave::EventType;
use brakewave::hybrid::OrbitItem;
use brakewave::orbit::Stability;

use super::counts::{events, has_no_silent_change, problem, rows};

/// The spike of an adaptive exponential neuron (Brette and Gerstner 2005) is met at 7e9 mV/ms, up from less than 1 at its
/// reset: a factor 1e10 that the reset takes away again. By Runge-Kutta in extended precision, with V or w in the place of
/// the time: −47.717352053112235 mV.
#[test]
fn a_neuron_doubles_its_period() {
    let system = r#"(
        states: ["V", "w"],
        parameters: {"I": 500.0, "b": 60.0, "a": 2.0, "r": -50.0, "tau": 100.0},
        modes: {"rest": (
            rates: {"V": "(-10*(V + 70) + 20*exp((V + 50)/2) - w + I)/200", "w": "(a*(V + 70) - w)/tau"},
            until: [(zero: "-V", to: "rest", reset: {"V": "r", "w": "w + b"})],
        )},
    )"#;
    let orbit = r#"(start: Simulate(mode: "rest", state: {"V": -70.0, "w": 0.0}, settle: 3000))"#;
    let along = r#"(parameter: "r", range: (-50, -47.65), toward: Up)"#;
    let items = rows(&problem(system, orbit, along));
    has_no_silent_change(&items, "neuron");
    let found = events(&items, "r");
    assert_eq!(found.len(), 1, "{found:?}");
    let (kind, value, _) = &found[0];
    assert_eq!(*kind, EventType::PD);
    assert!((value + 47.717352053112235).abs() <= 2e-13, "{value}");
    for OrbitItem { point, .. } in &items {
        let known = point
            .multipliers
            .iter()
            .map(|one| one.error)
            .fold(0.0, f64::max);
        assert!(known < 1e-8, "{known:e}");
    }
}

/// At a coarse tolerance of the flow multipliers are known to 1e-4, and steps are so short that several points lie in the disc
/// about −1: between the last one before it and the first one beyond a row says that the number changes.
#[test]
fn what_is_hidden_in_rounding_has_a_row() {
    let system = r#"(
        states: ["x", "v"],
        parameters: {"A": 0.264, "c": 0.3},
        forcing: "1.2",
        flow_tolerance: 1e-4,
        modes: {"well": (rates: {"x": "v", "v": "A*cos(phase) - c*v + x - x^3"})},
    )"#;
    let orbit = r#"(start: Simulate(mode: "well", state: {"x": 1.0, "v": 0.0}, settle: 200))"#;
    let along = r#"(parameter: "A", range: (0.264, 0.2657), toward: Up, ds: 1.2e-3, ds_max: 1.2e-3, tolerance: 1e-4)"#;
    let items = rows(&problem(system, orbit, along));
    has_no_silent_change(&items, "coarse");
    let undecided = |item: &&OrbitItem| item.point.stable == Some(Stability::Undecided);
    assert!(items.iter().filter(undecided).count() > 1);
    let found = events(&items, "A");
    assert_eq!(found.len(), 1, "{found:?}");
    let (kind, value, what) = &found[0];
    assert_eq!(*kind, EventType::MX);
    assert!(what.contains("changes from 0 to 1 between"), "{what}");
    // with the default tolerance the period doubles at 0.265581786056
    assert!((value - 0.265581786056).abs() < 1e-4);
}
