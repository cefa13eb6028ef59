//! Smooth cycles that come to a homoclinic orbit, and some that do not, in several units, orders and places of the states. Figures are
//! zeros of what the manifolds of the saddle are apart, integrated by an independent program to 13 digits.

use brakewave::EventType::{BP, EP, HC, LP};
use brakewave::affine::orbit::AffineOrbit;
use brakewave::affine::orbit::start::{Beginning, Search, Wanted, first};
use brakewave::linalg::Vector;
use brakewave::orbit::follow::LocatedPoint;
use brakewave::orbit::special::Special;

use crate::affine::branches::{follow, meets};
use crate::affine::systems::system;

fn started(
    text: &str,
    (parameter, range): (&str, (f64, f64)),
    state: &[f64],
    search: Search,
) -> (AffineOrbit, Vector) {
    let wanted = Wanted::new(system(text), parameter, range).unwrap();
    let beginning = Beginning {
        mode: 0,
        state: state.to_vec(),
        phase: 0.0,
    };
    first(&wanted, &beginning, search).unwrap_or_else(|error| panic!("{error}: {text}"))
}

/// ẋ = y, ẏ = −1/4 + b₂y + x² + xy: from a cycle of a hundredth beside the Hopf point at b₂ = 1/2 the branch comes to one a hundred
/// times as large.
#[test]
fn what_a_branch_began_with_does_not_decide_how_well_its_connection_is_known() {
    for (shift, unit) in [(0.0, 1.0), (1.3, 1.0), (0.0, 1e-3)] {
        let (x, y) = (format!("(x + {shift:?})"), format!("({unit:?}*y)"));
        let text = format!(
            r#"(states: ["x", "y"], parameters: {{"b2": 0.49994375}}, modes: {{"flow": (rates: {{
                "x": "{y}", "y": "(-0.25 + b2*{y} + {x}^2 + {x}*{y})/{unit:?}"}})}})"#
        );
        let range = (-0.5, 1.0);
        let state = [-0.485 - shift, 0.0];
        let search = Search::Guess(6.2838);
        let (orbit, point) = started(&text, ("b2", range), &state, search);
        let (seen, all) = follow(&orbit, &point, false, range, 1000);
        meets(&seen, &[(HC, 0.364_545_247_421_493_5, "")], 1e-11);
        assert!(all.last().unwrap().uncertainty < 1e-11);
    }
}

/// ẋ = y, ẏ = x − x³ + μy − x²y: the large cycle passes the saddle twice, which is left twice as fast as it is come to. All digits are
/// lost before the parameter stands still, and where they are the equilibrium beside the cycle solves its equations.
#[test]
fn a_branch_whose_digits_are_lost_before_it_stands_still_comes_to_its_homoclinic_orbit() {
    let text = r#"(states: ["x", "y"], parameters: {"mu": 1.2},
        modes: {"flow": (rates: {"x": "y", "y": "x - x^3 + mu*y - x^2*y"})})"#;
    let range = (0.3, 1.5);
    let (orbit, point) = started(text, ("mu", range), &[3.0, 0.0], Search::Settles(400.0));
    let (seen, all) = follow(&orbit, &point, false, range, 2000);
    let expected = [
        (LP, 0.771_215_070_536_11, ""),
        (HC, 0.813_793_663_106_6, ""),
    ];
    meets(&seen, &expected, 1e-11);
    for one in &all {
        let extremes = one.orbit.extremes(&one.node.point).unwrap();
        assert!(extremes.iter().all(|(low, high)| high - low > 1.0));
    }
}

/// The predator of Rosenzweig and MacArthur: the axis y = 0 is invariant, and with it the way into the saddle (K, 0): the cycle passes it
/// for every K and comes to no connection. Counted from elsewhere the prey is known to half a spacing of doubles near 1.3. That is a part of
/// its least value, 2.5e-10 where K = 6; as it grows at the rate 1 beside the saddle (0, 0), the passage takes as much more or less time. The
/// pieces of the passage before and after that value are each rounded so.
#[test]
fn a_cycle_that_passes_a_saddle_comes_to_no_homoclinic_orbit() {
    let last = [0.0, 1.3].map(|shift| {
        let x = format!("(x + {shift:?})");
        let text = format!(
            r#"(states: ["x", "y"], parameters: {{"K": 1.5, "a": 1.1, "b": 0.6, "d": 0.37}}, modes: {{"flow": (rates: {{
                "x": "{x}*(1 - {x}/K) - a*{x}*y/(b + {x})", "y": "a*{x}*y/(b + {x}) - d*y"}})}})"#
        );
        let range = (0.9, 6.0);
        let state = [0.6 - shift, 0.4];
        let (orbit, point) = started(&text, ("K", range), &state, Search::Settles(2000.0));
        let (seen, all) = follow(&orbit, &point, true, range, 1000);
        let last = all.last().unwrap();
        assert_eq!(seen.len(), 1, "{:?}", last.special);
        assert_eq!(seen[0].kind, EP, "{:?}", last.special);
        last.orbit.cycle(&last.node.point).unwrap().period
    });
    let moved = f64::EPSILON / 2.0 / 2.5e-10;
    assert!((last[1] - last[0]).abs() < 2.0 * moved, "{last:?}");
}

/// The relaxation cycle of FitzHugh and Nagumo becomes twice as long within 1e-9 of the current, as a canard, and no longer than that:
/// it shrinks to its Hopf point.
#[test]
fn the_period_of_a_canard_is_bounded() {
    let text = r#"(states: ["w", "v"], parameters: {"I": 1.29, "a": 0.7, "eps": 0.08, "b": 0.85},
        modes: {"flow": (rates: {"v": "v - v^3/3 - w + I", "w": "eps*(v + a - b*w)"})})"#;
    let range = (0.0, 2.0);
    let (orbit, point) = started(text, ("I", range), &[0.0, 2.0], Search::Settles(2000.0));
    let (_, all) = follow(&orbit, &point, true, range, 1000);
    let last = all.last().unwrap();
    let period = |one: &LocatedPoint<AffineOrbit>| one.orbit.cycle(&one.node.point).unwrap().period;
    let period = all.iter().map(period).fold(0.0, f64::max);
    // the trace of the slopes vanishes at v² = 1 − εb
    let v = (1.0_f64 - 0.08 * 0.85).sqrt();
    let at_hopf = (v + 0.7) / 0.85 - v + v.powi(3) / 3.0;
    assert!(
        (last.parameter - at_hopf).abs() < 1e-13 && period < 80.0,
        "{} {period} {:?}",
        last.parameter,
        last.special
    );
    assert_eq!(last.special.as_ref().map(Special::kind), Some(BP));
}

/// The same where time scales are farther apart: for a hundred steps the current stands still to rounding, which makes no fold; the multiplier
/// tells of the one. Growth of e⁴⁰ in a small part of the cycle takes more shots than in all of it.
#[test]
fn a_canard_turns_once() {
    let text = r#"(states: ["v", "w"], parameters: {"I": 0.3, "b": 0.8, "eps": 0.02, "a": 0.7},
        modes: {"flow": (rates: {"v": "v - v^3/3 - w + I", "w": "eps*(v + a - b*w)"})})"#;
    let range = (0.2, 0.4);
    let (orbit, point) = started(text, ("I", range), &[0.0, 2.0], Search::Settles(2000.0));
    let (seen, all) = follow(&orbit, &point, false, range, 250);
    let folds = seen.iter().filter(|one| one.kind == LP).count();
    assert!(folds <= 1, "{folds}");
    let last = all.last().unwrap();
    let period = last.orbit.cycle(&last.node.point).unwrap().period;
    assert!(all.len() > 200 && period > 180.0, "{} {period}", all.len());
    assert!(
        (last.parameter - 0.299_791_212_290_81).abs() < 1e-12,
        "{}",
        last.parameter
    );
}

/// Whether a branch ends at a cycle of connections of several saddles.
fn is_heteroclinic(one: &LocatedPoint<AffineOrbit>) -> bool {
    let special = one.special.as_ref().map(ToString::to_string);
    special.is_some_and(|words| words.contains("heteroclinic"))
}

/// ẋ = y, ẏ = ∓(x − x³) − y(H − h) with H = y²/2 ± (x²/2 − x⁴/4): the cycle is the level H = h for every h, and comes to the connections
/// of the saddle 0 with itself at H = 0, from within and from without, and to those between the saddles ±1 at H = 1/4. The saddles are
/// neutral there: the period grows like the logarithm of what is left, and the slope of the parameter is rounding, which makes no fold.
#[test]
fn a_level_of_energy_comes_to_its_saddles_and_has_no_fold_before() {
    let energy = "(y^2/2 - x^2/2 + x^4/4 - p + 0.1)";
    let within = format!("x - x^3 - y*{energy}");
    let between = "x^3 - x - y*(y^2/2 + x^2/2 - x^4/4 - p - 0.15)".to_owned();
    for (rate, first, x, up, heteroclinic) in [
        (&within, 0.05, 1.25, true, false),
        (&within, 0.15, 1.5, false, false),
        (&between, 0.0999, 0.95, true, true),
    ] {
        let text = format!(
            r#"(states: ["x", "y"], parameters: {{"p": {first:?}}},
                modes: {{"flow": (rates: {{"x": "y", "y": "{rate}"}})}})"#
        );
        let search = Search::Settles(200.0);
        let (orbit, point) = started(&text, ("p", (-0.1, 0.4)), &[x, 0.0], search);
        let (seen, all) = follow(&orbit, &point, up, (-0.1, 0.4), 1000);
        meets(&seen, &[(HC, 0.1, "")], 1e-13);
        let last = all.last().unwrap();
        assert!((last.parameter - 0.1).abs() <= last.uncertainty && last.uncertainty < 1e-13);
        assert_eq!(is_heteroclinic(last), heteroclinic, "{:?}", last.special);
    }
}

/// A predator of a prey that dies out where it is rare: the axis y = 0 leads from the saddle (m, 0) to the saddle (1, 0) for every d, and
/// the cycle comes to it where the other way between them is open. That is the zero of what the manifolds of the saddles are apart at
/// x = 0.45, integrated over x to 25 digits.
#[test]
fn a_cycle_comes_to_two_saddles_of_which_one_way_is_open_always() {
    for (order, state) in [(r#""x", "y""#, [0.55, 0.19]), (r#""y", "x""#, [0.19, 0.55])] {
        let text = format!(
            r#"(states: [{order}], parameters: {{"d": 0.545, "m": 0.1}},
                modes: {{"flow": (rates: {{"x": "x*(1 - x)*(x - m) - x*y", "y": "y*(x - d)"}})}})"#
        );
        let range = (0.3, 0.7);
        let (orbit, point) = started(&text, ("d", range), &state, Search::Settles(2000.0));
        let (seen, all) = follow(&orbit, &point, false, range, 1000);
        meets(&seen, &[(HC, 0.445_598_621_386_395_16, "")], 1e-12);
        let last = all.last().unwrap();
        assert!(is_heteroclinic(last) && last.uncertainty < 1e-12);
    }
}
