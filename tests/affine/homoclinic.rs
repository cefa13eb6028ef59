//! Smooth cycles that come to a homoclinic orbit, and some that do not, in several units, orders and places of the states. Figures are
//! zeros of what the manifolds of the saddle are apart, integrated by an independent program to 13 digits.

use brakewave::EventType::{BP, EP, HC, LP, MX};
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
/// for every K and comes to no connection. Where the prey is counted from elsewhere its digits are lost on the way.
#[test]
fn a_cycle_that_passes_a_saddle_comes_to_no_homoclinic_orbit() {
    for shift in [0.0, 1.3] {
        let x = format!("(x + {shift:?})");
        let text = format!(
            r#"(states: ["x", "y"], parameters: {{"K": 1.5, "a": 1.1, "b": 0.6, "d": 0.37}}, modes: {{"flow": (rates: {{
                "x": "{x}*(1 - {x}/K) - a*{x}*y/(b + {x})", "y": "a*{x}*y/(b + {x}) - d*y"}})}})"#
        );
        let range = (0.9, 6.0);
        let state = [0.6 - shift, 0.4];
        let (orbit, point) = started(&text, ("K", range), &state, Search::Settles(2000.0));
        let (seen, all) = follow(&orbit, &point, true, range, 1000);
        let last = if shift == 0.0 { EP } else { MX };
        assert_eq!(seen.len(), 1, "{:?}", all.last().unwrap().special);
        assert_eq!(seen[0].kind, last, "{:?}", all.last().unwrap().special);
    }
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
