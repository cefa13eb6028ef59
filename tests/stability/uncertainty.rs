//! The uncertainty of a crossing is honest: met with other steps, so with other roundings, it lies no farther
//! off than the uncertainties say; and it is never below the rounding of the value it is printed for.

use brakewave::branch::{Event, EventType};
use brakewave::problem;

use crate::stability::observed;
use crate::stability::waves::follow;

/// Half a unit in the last place.
fn half_unit(value: f64) -> f64 {
    0.5 * (value.abs().next_up() - value.abs())
}

/// The events of a problem with its steps chosen.
fn events(text: &str, ds: f64) -> Vec<Event> {
    let text = text.replace("STEPS", &format!("ds: {ds}, ds_max: {}", 2.0 * ds));
    let problem = problem::parse(&text, "steps").expect("a problem");
    let items = follow(&problem, &text).items;
    items.into_iter().filter_map(|item| item.event).collect()
}

#[test]
fn crossings_met_by_other_steps_lie_within_their_uncertainties() {
    // just beyond a take-off, where the mismatch is stationary along the branch; before a fold, where the
    // wave itself is known less well than its eigenvalues
    let take_off = "(model: (coefficients: Geometry(nu: 0.428, xi: 2.15033, gamma: 0.327), friction: 0.897,
        mismatch: 0.0506), wave: (mode: 3, start: Fast), continuation: (parameter: Mismatch,
        range: (0.05052, 0.0506), toward: Down, STEPS), stability: (sectors: Only([1]), max_frequency: 9.0))";
    let fold = "(model: (coefficients: Geometry(nu: 0.061, xi: 1.85, gamma: 0.9), friction: 0.127,
        mismatch: 0.06573, damping: (mass: 0.03615)), wave: (mode: 6, start: Fast),
        continuation: (parameter: Gamma, range: (0.8, 0.9), toward: Down, STEPS),
        stability: (sectors: Only([2]), max_frequency: 3.0))";
    for (text, parameter) in [(take_off, 0), (fold, 1)] {
        let value = |event: &Event| match parameter {
            0 => event.model.mismatch,
            _ => event
                .model
                .source
                .geometry()
                .map_or(f64::NAN, |of| of.gamma),
        };
        let runs = [0.005, 0.0041, 0.0033].map(|ds| events(text, ds));
        let mut crossings = 0;
        for event in &runs[0] {
            let rounding = half_unit(value(event));
            assert!(
                event.uncertainty >= rounding,
                "{event:?} below {rounding:e}"
            );
            if event.kind != EventType::HB {
                continue;
            }
            crossings += 1;
            for run in &runs[1..] {
                let alike =
                    |other: &&Event| other.kind == event.kind && other.sector == event.sector;
                let off = |other: &&Event| (value(other) - value(event)).abs();
                let others = run.iter().filter(alike);
                let other = others.min_by(|one, two| off(one).total_cmp(&off(two)));
                let other = other.expect("the same crossing");
                let share = off(&other) / (event.uncertainty + other.uncertainty);
                observed("crossing by other steps, share of the uncertainty", share);
                assert!(share <= 1.0, "{event:?} {other:?}");
            }
        }
        assert!(crossings > 0);
    }
}
