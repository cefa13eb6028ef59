//! Curves of events of orbits along which a motion grows by much: they take new unknowns on their way.

use crate::curve::systems::whole;

/// The curve of the fold of Rayleigh's oscillator with dry friction, which becomes a canard, up to a value of mu: values of (f, mu).
fn fold_of_rayleigh(mu: f64, f: f64, highest: f64) -> Vec<[f64; 2]> {
    let text = format!(
        r#"(system: (states: ["x", "v"], parameters: {{"mu": {mu:?}, "f": {f:?}}},
        modes: {{
            "pos": (rates: {{"x": "v", "v": "mu*(v - v^3/3) - x - f"}}, until: [(zero: "v", to: "neg")]),
            "neg": (rates: {{"x": "v", "v": "mu*(v - v^3/3) - x + f"}}, until: [(zero: "-v", to: "pos")]),
        }}, sliding: {{"stick": ("pos", "neg")}}),
        orbit: (start: Simulate(mode: "pos", state: {{"x": 0.0, "v": 1.5}}, settle: 200)),
        continuation: (parameter: "f", range: (0.0, 2.0)),
        curve: (event: LP, parameters: ("f", "mu"), range: ((0.0, 2.0), ({mu:?}, {highest:?}))))"#
    );
    let found = whole(&text);
    let points = found.points.iter().map(|point| point.parameters);
    points.collect()
}

/// The curve keeps its direction as zones are parted into more shots. Its place at the edge is that of an independent integration of
/// half a period, whose map has the slope 1 there.
#[test]
fn a_curve_keeps_its_direction_in_more_shots() {
    let points = fold_of_rayleigh(2.45, 0.1, 2.535);
    let falls = points.windows(2).filter(|pair| pair[1][1] < pair[0][1]);
    assert_eq!(falls.count(), 0);
    let last = points.last().unwrap();
    assert_eq!(last[1], 2.535);
    assert!((last[0] - 1.424_726_254_276_5).abs() < 1e-12, "{}", last[0]);
}

/// Where the null vector is known to 1e-10 only, corrections of that size do not contract, which shortened every step until none led on. The
/// place at the edge is that of Newton's method in 40 digits for half a period.
#[test]
fn steps_are_not_shortened_by_rounding() {
    let points = fold_of_rayleigh(2.79, 1.2, 2.8);
    let last = points.last().unwrap();
    assert_eq!(last[1], 2.8);
    let off = (last[0] - 1.516_271_991_319_899_7).abs();
    assert!(off < 1e-12, "{off:e}");
    assert!(points.len() < 300, "{}", points.len());
}
