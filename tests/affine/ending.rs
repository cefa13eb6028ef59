//! Branches that end, or do not end: the same events from both sides, closed branches on which the phase winds, events
//! without end, and jumps of the return map.

use std::f64::consts::TAU;

use brakewave::EventType::{BP, CO, EP, GR, HC, LP, MX, SL};
use brakewave::affine::orbit::start::{Beginning, Search, Wanted, first};
use brakewave::affine::orbit::{AffineOrbit, OrbitTermination};
use brakewave::orbit::follow::LocatedPoint;
use brakewave::orbit::special::Special;

use crate::affine::branches::{Seen, follow, meets, settled};
use crate::affine::counts::rows;
use crate::affine::rests::in_units;
use crate::affine::systems::{BRAKE_BY_HAND, TWO_MASSES, system, values};

/// Why a branch ends, as its last point says.
fn why(all: &[LocatedPoint<AffineOrbit>]) -> String {
    let special = all.last().and_then(|last| last.special.as_ref());
    match special.expect("the last point is special") {
        Special::Change(change) => change.end.as_ref().map(ToString::to_string).unwrap(),
        special => special.to_string(),
    }
}

/// Two zones that vanish together, of which the shorter one falls like the square of the other, are passed in either
/// direction. The branch ends where the mass comes to rest: at A = 1/5, where both A − g ≤ x ≤ hA + g and x + A = f hold
/// for the first time.
#[test]
fn zones_that_vanish_together_are_passed_both_ways() {
    let events = [
        0.225_415_022_708_337_7,
        0.220_792_685_844_998_2,
        0.220_348_214_554_937_1,
        0.218_627_364_676_733_6,
        0.213_059_396_019_525_4,
        0.212_216_960_382_876_8,
        0.210_064_380_372_856_1,
    ];
    let high = settled(BRAKE_BY_HAND, &[], "A", "p", &[0.0, 0.5], 100.0);
    let (seen, all) = follow(&high.0, &high.1, false, (0.05, 1.5), 2000);
    let changes: Vec<_> = seen.iter().filter(|one| one.kind != MX).collect();
    assert_eq!(changes.len(), events.len());
    for (one, value) in changes.iter().zip(events) {
        assert!(
            (one.value - value).abs() < 1e-12,
            "{} for {value}",
            one.value
        );
    }
    let reason = why(&all);
    assert!(
        reason.contains("comes to rest: beyond it `hold`, `Hold`"),
        "{reason}"
    );
    let last = all.last().unwrap();
    assert!(
        (last.parameter - 0.2).abs() < 2.0 * last.uncertainty && last.uncertainty < 1e-4,
        "{} {:e}",
        last.parameter,
        last.uncertainty
    );
    let low = settled(BRAKE_BY_HAND, &[("A", 0.216)], "A", "p", &[0.0, 0.5], 100.0);
    let (seen, _) = follow(&low.0, &low.1, true, (0.05, 0.3), 2000);
    let expected = [
        (CO, events[3], ""),
        (SL, events[2], ""),
        (CO, events[1], ""),
        (SL, events[0], ""),
        (EP, 0.3, "p-hold-n-hold-P"),
    ];
    meets(&seen, &expected, 1e-12);
}

/// A mass on dry ground, whose static friction S is above the kinetic one F.
const STATIC: &str = r#"(
    states: ["x", "v"],
    parameters: {"w": 0.4, "F": 0.5, "S": 0.6},
    forcing: "w",
    define: {"s": "cos(phase) - x"},
    modes: {
        "forth": (rates: {"x": "v", "v": "s - F"}, until: [(zero: "v", to: "back", if: ["-s - S"]), (zero: "v", to: "stick")]),
        "back": (rates: {"x": "v", "v": "s + F"}, until: [(zero: "-v", to: "forth", if: ["s - S"]), (zero: "-v", to: "stick")]),
        "stick": (rates: {"x": "0", "v": "0"}, until: [(zero: "S - s", to: "forth"), (zero: "S + s", to: "back")]),
    },
)"#;

/// Where stick touches its other bound the mass slips off with a jump of its friction: the return map is discontinuous.
/// The same brake with its speed in other units: what a guard leaves out over a piece is measured by what acts on it, not by units.
#[test]
fn a_brake_in_other_units_has_the_same_events() {
    let expected = [
        (CO, 0.317_958_379_697_163),
        (SL, 0.323_746_798_568_215),
        (CO, 0.566_486_406_688_595),
    ];
    for unit in ["1e9", "1e-9"] {
        let rates = ["a - f", "a + f", "a - g", "a + g"];
        let text = rates.iter().fold(BRAKE_BY_HAND.to_owned(), |text, rate| {
            text.replace(&format!("\"{rate}\""), &format!("\"({rate})/{unit}\""))
        });
        let text = text
            .replace("0.1*v", &format!("0.1*{unit}*v"))
            .replace(r#""x": "v""#, &format!(r#""x": "{unit}*v""#));
        let speed = 0.5 / unit.parse::<f64>().unwrap();
        let (orbit, point) = settled(&text, &[], "A", "p", &[0.0, speed], 100.0);
        let (seen, _) = follow(&orbit, &point, true, (0.05, 0.7), 2000);
        let seen: Vec<_> = seen.iter().filter(|one| one.kind != EP).collect();
        assert_eq!(seen.len(), expected.len());
        for (one, (kind, value)) in seen.iter().zip(expected) {
            assert_eq!(one.kind, kind);
            assert!(
                (one.value - value).abs() < 1e-12,
                "{} for {value}",
                one.value
            );
        }
    }
}

/// The same with S = F is passed: the slip that is born lasts no time.
#[test]
fn a_jump_of_the_return_map_is_an_end() {
    let jump = settled(STATIC, &[], "w", "forth", &[0.0, 0.5], 100.0);
    let (seen, all) = follow(&jump.0, &jump.1, false, (0.05, 1.0), 2000);
    meets(&seen, &[(GR, 0.136_814_545_601_076_25, "")], 1e-12);
    let reason = why(&all);
    assert!(reason.contains("return map is discontinuous"), "{reason}");
    let passed = settled(STATIC, &[("S", 0.5)], "w", "forth", &[0.0, 0.5], 100.0);
    let (seen, _) = follow(&passed.0, &passed.1, false, (0.1, 1.0), 2000);
    let kinds: Vec<_> = seen.iter().map(|one| one.kind).collect();
    assert!(
        kinds.contains(&GR) && kinds.last() == Some(&EP),
        "{kinds:?}"
    );
}

/// Stick that only just comes to its bound in both halves of a symmetric orbit: what motions beside it are off by is the fourth root of how
/// far the parameter is, on the side on which they come back; on the other the block is held at a distance. The force is at its greatest there,
/// 2.21P + 0.46|x| = 1.733.
#[test]
fn two_grazes_of_a_bound_in_one_period_are_an_end() {
    let text = r#"(states: ["x", "v"], parameters: {"P": 0.85}, forcing: "1.89",
        contacts: {"q": Friction(slip: "v", bound: "1.0", static: "1.733")},
        rates: {"x": "v", "v": "2.21*P*sin(phase) - 0.12*v - 0.46*x + q"})"#;
    let (orbit, point) = settled(text, &[], "P", "backward", &[-0.286, -0.1043], 300.0);
    let (seen, all) = follow(&orbit, &point, false, (0.6, 1.0), 2000);
    let kinds: Vec<_> = seen.iter().map(|one| one.kind).collect();
    assert_eq!(kinds, [LP, GR]);
    let reason = why(&all);
    assert!(reason.contains("return map is discontinuous"), "{reason}");
    // by shooting over half a period from the instant of that force
    let value = seen[1].value;
    assert!((value - 0.770_416_578_280_611).abs() <= 1e-12, "{value}");
}

/// Where slip only just stops and goes on, static friction above the kinetic one holds the mass until the pull has grown from
/// the one to the other: a jump, of 3e-3 here. With both the same the branch goes on through the same graze.
#[test]
fn slip_that_grazes_rest_is_held_by_static_friction() {
    let text = |bound: &str| {
        r#"(states: ["x", "v"], parameters: {"w": 1.441, "N": 0.303, "g": 0.313, "r": 0.63}, forcing: "w",
            contacts: {"p": Stop(gap: "g - x", restitution: "r"), "q": Friction(slip: "v", bound: "N"STATIC)},
            rates: {"x": "v", "v": "cos(phase) - x - 0.05*v - p + q"})"#
            .replace("STATIC", bound)
    };
    let down = |bound: &str| {
        let (orbit, point) = settled(&text(bound), &[], "w", "open.forward", &[0.0, 0.1], 400.0);
        follow(&orbit, &point, false, (0.9, 1.5), 2000)
    };
    let (held, all) = down(", static: \"1.4*N\"");
    let (passed, _) = down("");
    let kinds = |seen: &[Seen]| seen.iter().map(|one| one.kind).collect::<Vec<_>>();
    assert_eq!(kinds(&held), [GR]);
    let reason = why(&all);
    assert!(reason.contains("return map is discontinuous"), "{reason}");
    let graze = &passed[0];
    assert_eq!((graze.kind, kinds(&passed).last()), (GR, Some(&EP)));
    assert!((held[0].value - graze.value).abs() < 1e-12);
}

/// Static friction only just lets go: beyond that the mass is held for good, and the branch ends there, whatever the units and
/// the order of the states.
#[test]
fn a_mass_that_is_held_for_good() {
    let text = r#"(states: ["x", "v"], parameters: {"A": 0.991, "w": 1.202, "F": 0.693, "c": 0.01}, forcing: "w",
        contacts: {"q": Friction(slip: "v", bound: "F", static: "1.25*F")},
        rates: {"x": "v", "v": "A*cos(phase) - x - c*v + q"})"#;
    let scaled = r#"(states: ["v", "x"], parameters: {"A": 0.991, "w": 1.202, "F": 0.693, "c": 0.01}, forcing: "w",
        contacts: {"q": Friction(slip: "v", bound: "F", static: "1.25*F")},
        rates: {"x": "1e4*v", "v": "A*cos(phase) - 1e-4*x - c*v + q"})"#;
    let ends = [(text, [0.0, 0.099]), (scaled, [0.099, 0.0])].map(|(text, state)| {
        let (orbit, point) = settled(text, &[], "F", "forward", &state, 200.0);
        let (seen, all) = follow(&orbit, &point, true, (0.6, 1.1), 2000);
        let kinds: Vec<_> = seen.iter().map(|one| one.kind).collect();
        assert_eq!(kinds, [LP, GR]);
        let reason = why(&all);
        assert!(reason.contains("stay in `stick` for good"), "{reason}");
        seen[1].value
    });
    assert!((ends[0] / ends[1] - 1.0).abs() < 1e-11, "{ends:?}");
}

/// A mass with friction, tied to one that is forced, slips in both directions while the spring pulls by more than F. Both slips
/// vanish at once where it only just does, with the mass held at zero: at A = F/k |1 + k - w² + icw|. Below, and for stronger friction,
/// it is held for good, and no motion slips in one direction only.
#[test]
fn both_slips_of_a_mass_beside_another_vanish_at_once() {
    let text = |parameters: &str| {
        format!(
            r#"(states: ["x", "v", "y", "u"], parameters: {{{parameters}}}, forcing: "w",
            modes: {{
                "f": (rates: {{"x": "v", "v": "-x - k*(x - y) - c*v - F", "y": "u", "u": "A*cos(phase) - y - k*(y - x) - c*u"}},
                    until: [(zero: "v", to: "b")]),
                "b": (rates: {{"x": "v", "v": "-x - k*(x - y) - c*v + F", "y": "u", "u": "A*cos(phase) - y - k*(y - x) - c*u"}},
                    until: [(zero: "-v", to: "f")]),
            }},
            sliding: {{"stick": ("f", "b")}})"#
        )
    };
    let gain = |w: f64, c: f64, k: f64| (1.0 + k - w * w).hypot(c * w) / k;
    let weak = r#""A": 1.0605, "w": 0.4349, "F": 0.2947, "c": 0.0668, "k": 0.3949"#;
    let stiff = r#""A": 1.076, "w": 0.4313, "F": 0.4977, "c": 0.0577, "k": 1.0731"#;
    let cases = [
        (
            weak,
            "A",
            false,
            (0.6363, 1.803),
            0.2947 * gain(0.4349, 0.0668, 0.3949),
        ),
        (
            stiff,
            "F",
            true,
            (0.29, 0.84),
            1.076 / gain(0.4313, 0.0577, 1.0731),
        ),
    ];
    for (parameters, parameter, up, range, end) in cases {
        let state = [0.0, 0.5, 0.0, 0.0];
        let (orbit, point) = settled(&text(parameters), &[], parameter, "f", &state, 300.0);
        let (seen, all) = follow(&orbit, &point, up, range, 1000);
        assert_eq!(seen.len(), 1);
        assert!(
            (seen[0].value / end - 1.0).abs() < 1e-12,
            "{} for {end}",
            seen[0].value
        );
        let reason = why(&all);
        assert!(reason.contains("stay in `stick` for good"), "{reason}");
    }
}

/// A clock whose period is 1 + p, with a parabola beside it that rests where it comes to zero: y = r² + k(p - p₀) - 2rt + t², r = 1.35, p₀ = .47, falls to zero at t = r - √(k(p₀ - p)) and rests to the end of the period. Beyond its
/// graze at p₀ the zone of rest has a length at once, which no chain of switches makes: the branch goes on in either direction. The zone
/// vanishes where 1 + p = r - √(k(p₀ - p)). So it is in any unit of y, beside which the units of what acts on it one way are as they are.
#[test]
fn a_zone_of_some_length_comes_at_a_graze() {
    let text = r#"(states: ["t", "y", "z"], parameters: {"p": 1.0, "k": 0.1, "U": 1.0},
        modes: {
            "run": (rates: {"t": "1", "y": "U*z", "z": "2"},
                until: [(zero: "1 + p - t", to: "run", reset: {"t": "0", "y": "U*(1.8225 + k*(p - 0.47))", "z": "-2.7"}),
                    (zero: "y", to: "rest")]),
            "rest": (rates: {"t": "1", "y": "0", "z": "0"},
                until: [(zero: "1 + p - t", to: "run", reset: {"t": "0", "y": "U*(1.8225 + k*(p - 0.47))", "z": "-2.7"})]),
        })"#;
    let (k, left) = (0.1_f64, 0.12);
    let root = 0.5 * (k.sqrt() + (k + 4.0 * left).sqrt());
    let vanishes = 0.47 - root * root;
    let ways = [(1.0, false), (0.4, true), (0.4, false)].map(|way| (way, 1.0));
    let in_units = [1e-9, 1e7, 1e9].map(|unit| ((1.0, false), unit));
    for ((p, up), unit) in ways.into_iter().chain(in_units) {
        let state = [0.0, unit * (1.8225 + k * (p - 0.47)), -2.7];
        let values = [("p", p), ("U", unit)];
        let (orbit, point) = settled(text, &values, "p", "run", &state, 20.0);
        let (seen, _) = follow(&orbit, &point, up, (0.0, 1.0), 1000);
        let found = seen.iter().filter(|one| one.kind != EP);
        let found: Vec<_> = found.map(|one| (one.kind, one.value)).collect();
        let expected = [(GR, 0.47), (CO, vanishes)];
        let expected = match (p > 0.47, up) {
            (true, _) => &expected[..],
            (_, true) => &expected[..1],
            (_, false) => &expected[1..],
        };
        assert_eq!(found.len(), expected.len(), "in {unit}: {found:?}");
        for (one, expected) in found.iter().zip(expected) {
            assert_eq!(one.0, expected.0);
            assert!((one.1 - expected.1).abs() < 1e-11, "in {unit}: {found:?}");
        }
    }
}

/// Two masses with friction, tied to one another: where both halves of their symmetric orbit change at once, four zones that
/// open like roots take the place of two. The branch goes on there and back; an independent program has that place.
#[test]
#[allow(clippy::approx_constant)] // a frequency near π/6 is none of its multiples
fn a_symmetric_orbit_changes_in_both_halves_by_several_zones() {
    let text = r#"(states: ["x1", "v1", "x2", "v2"], parameters: {"a": 1.0, "w": 0.5235, "k": 0.6, "F1": 0.2, "F2": 0.25, "c": 0.1, "m": 1.5},
        forcing: "w", contacts: {"q1": Friction(slip: "v1", bound: "F1"), "q2": Friction(slip: "v2", bound: "F2")},
        rates: {"x1": "v1", "v1": "a*cos(phase) - x1 - k*(x1 - x2) - c*v1 + q1",
            "x2": "v2", "v2": "(-x2 - k*(x2 - x1) - c*v2 + q2)/m"})"#;
    let place = 0.504_592_645_688_733_2;
    for (w, range) in [(0.5235, (0.49, 0.57)), (0.48, (0.47, 0.51))] {
        let at_rest = [0.0, 0.1, 0.0, 0.1];
        let (orbit, point) = settled(text, &[("w", w)], "w", "forward.forward", &at_rest, 60.0);
        let (seen, all) = follow(&orbit, &point, w < place, range, 1000);
        let kinds: Vec<_> = seen.iter().map(|one| one.kind).collect();
        assert_eq!(kinds, [SL, EP], "from {w}");
        let event = all.iter().find(|one| one.kind() == Some(SL));
        let (off, told) = ((seen[0].value - place).abs(), event.unwrap().known_to());
        assert!(off < told && told < 1e-12, "off by {off}, told {told}");
    }
}

/// A clock: a pendulum with dry friction, kicked as it comes back through x = 0, in which nobody has written down stick.
pub(crate) const CLOCK: &str = r#"(
    states: ["x", "v"],
    parameters: {"f": 0.05, "z": 0.02, "p": 0.3},
    define: {"s": "-sin(x) - 2*z*v"},
    modes: {
        "right": (rates: {"x": "v", "v": "s - f"}, until: [(zero: "v", to: "left")]),
        "left": (rates: {"x": "v", "v": "s + f"}, until: [(zero: "-v", to: "pre")]),
        "pre": (rates: {"x": "v", "v": "s - f"}, until: [(zero: "-x", to: "right", reset: {"v": "sqrt(v^2 + p^2)"}), (zero: "v", to: "left")]),
    },
)"#;

/// With a weak kick the pendulum only just comes back to x = 0, at a value that an independent integration of one swing
/// confirms. Beyond it turns before and comes to where it would stick, which no mode does: the end says where that is missing,
/// though the strength of the kick has no part in the way there.
#[test]
fn stick_that_is_missing_is_named() {
    let clock = settled(CLOCK, &[], "p", "right", &[0.0, 1.0], 400.0);
    let (seen, all) = follow(&clock.0, &clock.1, false, (0.05, 3.0), 2000);
    let graze = 0.265_111_038_339_112;
    meets(&seen, &[(GR, graze, ""), (MX, graze, "")], 1e-11);
    let reason = why(&all);
    assert!(
        reason.contains("motions beside its orbit stop where `-v` of `left` is zero")
            && reason.contains("an entry of `sliding` for the two modes is missing"),
        "{reason}"
    );
}

/// The second mass moves only where the spring between them pulls harder than its friction, k·max x > g. As the force
/// falls its motion dies away where max x = g/k for the first mass alone, with a stiffness of 1 + k: its slips in closed
/// form, with the instants of release and rest by bisection, give the force. It is the same with a speed in other units,
/// though what stays zero in stick acts on the rest by as much as these are.
#[test]
fn a_part_of_the_motion_comes_to_rest() {
    const ALONE: f64 = 0.563_952_062_234_286_7;
    for [v, u] in [[1.0, 1.0], [1e3, 1.0], [1e-9, 1.0], [1e9, 1.0], [1.0, 1e6]] {
        let source = in_units(TWO_MASSES, &[1.0, v, 1.0, u], false);
        let text = ron::to_string(&source).unwrap();
        let (orbit, point) = settled(
            &text,
            &[("A", 0.7), ("g", 0.3)],
            "A",
            "pp",
            &[0.0, 0.5 / v, 0.0, 0.1 / u],
            100.0,
        );
        let (seen, all) = follow(&orbit, &point, false, (0.3, 1.0), 2000);
        meets(&seen, &[(MX, ALONE, "")], 1e-8);
        let reason = why(&all);
        assert!(
            reason.contains("the motion of `y`, `u` comes to rest while the rest moves on"),
            "{v:e}, {u:e}: {reason}"
        );
        let last = all.last().unwrap();
        assert!(
            (last.parameter - ALONE).abs() <= last.uncertainty && last.uncertainty < 1e-8,
            "{v:e}, {u:e}: {} {:e}",
            last.parameter,
            last.uncertainty
        );
    }
}

/// A neuron with leak and drive I + k sin φ fires once in a period: a closed branch on which the phase of its spike winds
/// once. It fires where z = k/√(1 + w²)·sin(φ − atan w) has I − 1 + z − (I + z)e^(−T) = 0 for z between its bounds, which
/// are the folds.
#[test]
fn a_branch_on_which_the_phase_winds_closes() {
    let text = r#"(
        states: ["v"],
        parameters: {"I": 1.55, "k": 0.3, "w": 6.0},
        forcing: "w",
        modes: {"rest": (rates: {"v": "I - v + k*sin(phase)"}, until: [(zero: "1 - v", to: "rest", reset: {"v": "0"})])},
    )"#;
    // 1 = (I + z)(1 − q) with q = exp(−2π/w)
    let fired = (1.0 - (-TAU / 6.0).exp()).recip();
    let swing = 0.3 / 37.0_f64.sqrt();
    let (orbit, point) = settled(text, &[], "I", "rest", &[0.0], 500.0);
    for up in [true, false] {
        let (seen, _) = follow(&orbit, &point, up, (0.8, 3.0), 4000);
        let mut folds = [(LP, fired + swing, ""), (LP, fired - swing, "")];
        if !up {
            folds.reverse();
        }
        let expected = [folds[0], folds[1], (EP, 1.55, "rest")];
        meets(&seen, &expected, 1e-12);
    }
}

/// Rinzel and Keller's wave trains come to the pulse, beside a saddle that is left five times as fast as it is come to:
/// their digits are lost before they are near it, and the pulse itself is computed. Its speed is that of an independent
/// program.
#[test]
fn a_branch_that_loses_its_digits_names_the_pulse() {
    let text = r#"(
        states: ["v", "y", "w"],
        parameters: {"c": 0.25416445, "a": 0.25, "b": 0.05},
        modes: {
            "low": (rates: {"v": "y", "y": "c*y + v + w", "w": "b*v/c"}, until: [(zero: "a - v", to: "high")]),
            "high": (rates: {"v": "y", "y": "c*y + v - 1 + w", "w": "b*v/c"}, until: [(zero: "v - a", to: "low")]),
        },
    )"#;
    let system = system(text);
    let wanted = Wanted {
        values: values(&system, &[]),
        ..Wanted::new(system, "c", (0.1, 1.5)).unwrap()
    };
    let beginning = Beginning {
        mode: wanted.system.mode("high").unwrap(),
        state: vec![0.25, 0.329_770_82, 0.060_267_64],
        phase: 0.0,
    };
    let (orbit, point) = first(&wanted, &beginning, Search::Guess(14.0)).unwrap();
    let (_, all) = follow(&orbit, &point, true, (0.1, 1.5), 4000);
    let (last, reason) = (all.last().unwrap(), why(&all));
    assert_eq!(last.kind(), Some(HC), "{reason}");
    let off = (last.parameter - 0.257_671_772_127).abs();
    // the figure has twelve digits
    assert!(off < 1e-12 + last.uncertainty, "{last:?}");
    assert!(last.uncertainty < 1e-13, "{last:?}");
}

/// Two masses with friction and two Jenkins elements, of which one never slips: its offset is that of the start. Where its force
/// comes to the bound orbits that keep another offset go on, and motions beyond come to one of them.
#[test]
fn beyond_the_bound_of_a_kept_offset_others_of_the_family_go_on() {
    let text = r#"(
        states: ["x1", "v1", "x2", "v2"], parameters: {"w": 0.474}, forcing: "w",
        contacts: {
            "q0": Friction(slip: "v1 - v2", bound: "0.467"),
            "q1": Jenkins(slip: "v1", stiffness: "0.771", bound: "0.221"),
            "q2": Jenkins(slip: "v2 - v1", stiffness: "0.821", bound: "0.461"),
        },
        rates: {
            "x1": "v1", "v1": "(1.864*cos(phase + 5.146) - 1.485*x1 - 0.107*v1 + 0.411*x2 + q0 + q1 - q2)/0.925",
            "x2": "v2", "v2": "(0.457*cos(phase + 0.924) + 0.411*x1 - 3.124*x2 - 0.196*v2 - q0 + q2)/0.731",
        },
    )"#;
    let state = [0.0, 0.21, 0.0, 0.275, 0.0, 0.0];
    let (orbit, point) = settled(text, &[], "w", "backward.stick.stick", &state, 100.0);
    let (_, all) = follow(&orbit, &point, true, (0.474, 0.488), 300);
    let reason = why(&all);
    assert!(reason.contains("others of the family"), "{reason}");
    let end = all.last().unwrap().parameter;
    assert!((end - 0.479_868_314_329_773_23).abs() < 1e-12, "{end}");
}

/// A neuron whose slow adaptation makes it turn below its threshold: beyond the graze it rests at V = I/1.3 < 1. A converter whose
/// switch is turned on at every tick of a clock and off at once. Neither has a family of orbits there.
#[test]
fn only_a_centre_has_a_family_of_orbits() {
    let neuron = r#"(
        system: (states: ["V", "w"], parameters: {"I": 2.0}, modes: {"rest": (
            rates: {"V": "-V + I - w", "w": "0.2*(0.3*V - w)"},
            until: [(zero: "1 - V", to: "rest", reset: {"V": "0"})])}),
        orbit: (start: Simulate(mode: "rest", state: {"V": 0.0, "w": 0.0}, settle: 200)),
        continuation: (parameter: "I", range: (0.5, 3.0), toward: Down),
        stability: (),
    )"#;
    let converter = r#"(
        system: (states: ["i", "v", "c"], parameters: {"r": 1.2}, modes: {
            "on": (rates: {"i": "1", "v": "-v/8", "c": "1"}, until: [
                (zero: "r - i", to: "off"), (zero: "1 - c", to: "on", reset: {"c": "c - 1"})]),
            "off": (rates: {"i": "(10 - v)/10", "v": "2.5*i - v/8", "c": "1"}, until: [
                (zero: "1 - c", to: "on", reset: {"c": "c - 1"})])}),
        orbit: (start: Simulate(mode: "on", state: {"i": 0.5, "v": 12.0, "c": 0}, settle: 400)),
        continuation: (parameter: "r", range: (0.1, 1.5), toward: Down),
        stability: (),
    )"#;
    for (text, kind, at) in [(neuron, GR, 1.259038621604), (converter, CO, 0.5)] {
        let all = rows(text);
        let last = all
            .iter()
            .rev()
            .find_map(|item| item.event.as_ref().zip(Some(&item.point)));
        let (event, point) = last.unwrap();
        assert_eq!(event.kind, kind, "{event:?}");
        assert!((point.parameters[0] - at).abs() < 1e-11, "{point:?}");
        assert!(!event.what.contains("family"), "{}", event.what);
    }
}

/// Where the laws of contacts do not say what follows, no modes by hand are missed.
#[test]
fn a_stop_of_contacts_speaks_of_their_laws() {
    let stop = |by_contacts| OrbitTermination::Halts {
        mode: "stick.open".to_owned(),
        guard: "the gap of `p`".to_owned(),
        by_contacts,
    };
    assert!(stop(false).to_string().contains("`sliding`"));
    let words = stop(true).to_string();
    assert!(
        words.contains("laws of contacts") && !words.contains("sliding"),
        "{words}"
    );
}

/// ẍ = −x − ẋ + (1 + p) sat(ẋ): below the saturation the law at p = 0 is a centre, whose circles are a family at that value, of the period
/// 2π. The branch of saturated cycles comes to it tangentially, and ends there.
#[test]
fn a_branch_ends_at_the_family_below_a_saturation() {
    for unit in [1.0, 1e-3] {
        let text = format!(
            r#"(states: ["x", "y"], parameters: {{"p": 0.3}}, modes: {{"flow": (rates: {{
                "x": "y/{unit:?}", "y": "-x*{unit:?} - y + (1 + p)*max(-{unit:?}, min({unit:?}, y))"}})}})"#
        );
        let (orbit, point) = settled(&text, &[], "p", "flow", &[1.4, 0.0], 400.0);
        let (seen, all) = follow(&orbit, &point, false, (-0.5, 0.5), 300);
        let kinds: Vec<_> = seen.iter().map(|one| one.kind).collect();
        assert_eq!(kinds, [BP]);
        let last = all.last().unwrap();
        let period = last.orbit.cycle(&last.node.point).unwrap().period;
        assert!(last.parameter.abs() <= last.uncertainty && (period - TAU).abs() < 1e-9);
        assert!(why(&all).contains("family"), "{}", why(&all));
    }
}
