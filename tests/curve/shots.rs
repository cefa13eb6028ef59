//! Curves of events of orbits along which a motion grows by much: they take new unknowns on their way.

use crate::curve::systems::whole;

/// The fold of Rayleigh's oscillator with dry friction, which becomes a canard: the curve keeps its direction as zones are parted into
/// more shots. Its place at the edge is that of an independent integration of half a period, whose map has the slope 1 there.
#[test]
fn a_curve_keeps_its_direction_in_more_shots() {
    let text = r#"(system: (states: ["x", "v"], parameters: {"mu": 2.45, "f": 0.1},
        modes: {
            "pos": (rates: {"x": "v", "v": "mu*(v - v^3/3) - x - f"}, until: [(zero: "v", to: "neg")]),
            "neg": (rates: {"x": "v", "v": "mu*(v - v^3/3) - x + f"}, until: [(zero: "-v", to: "pos")]),
        }, sliding: {"stick": ("pos", "neg")}),
        orbit: (start: Simulate(mode: "pos", state: {"x": 0.0, "v": 1.5}, settle: 200)),
        continuation: (parameter: "f", range: (0.0, 2.0)),
        curve: (event: LP, parameters: ("f", "mu"), range: ((0.0, 2.0), (2.45, 2.535))))"#;
    let found = whole(text);
    let points = found.points.iter().map(|point| point.parameters);
    let points: Vec<_> = points.collect();
    let falls = points.windows(2).filter(|pair| pair[1][1] < pair[0][1]);
    assert_eq!(falls.count(), 0);
    let last = points.last().unwrap();
    assert_eq!(last[1], 2.535);
    assert!((last[0] - 1.424_726_254_276_5).abs() < 1e-12, "{}", last[0]);
}
