//! Branches of orbits there and back through their events, against figures of an independent program.

use std::f64::consts::{PI, TAU};

use brakewave::EventType;
use brakewave::affine::orbit::AffineOrbit;
use brakewave::affine::orbit::start::{Beginning, NoStart, Search, Wanted, first};
use brakewave::continuation::Steps;
use brakewave::linalg::Vector;
use brakewave::orbit::follow::{Follower, Limits, LocatedPoint};
use brakewave::orbit::special::Special;

use crate::affine::orbits::{Reference, impact, solved};
use crate::affine::systems::{
    BALL, BELT, CHUA, FRICTION, IMPACT, RELAY, THERMOSTAT, system, values,
};

/// An event: its type, the parameter, the sequences before and after.
pub struct Seen {
    pub kind: EventType,
    pub value: f64,
    pub what: String,
}

/// The orbit on which a motion of a system settles from a state in a mode at a phase, in this time, to be followed in a parameter.
pub fn started(
    text: &str,
    (mode, state, phase): (&str, &[f64], f64),
    along: (&str, (f64, f64)),
    settle: f64,
) -> Result<(AffineOrbit, Vector), NoStart> {
    begun(text, (mode, state, phase), along, Search::Settles(settle))
}

/// The orbit that is found from a state in a mode at a phase, to be followed in a parameter.
pub fn begun(
    text: &str,
    (mode, state, phase): (&str, &[f64], f64),
    (parameter, range): (&str, (f64, f64)),
    search: Search,
) -> Result<(AffineOrbit, Vector), NoStart> {
    let system = system(text);
    let beginning = Beginning {
        mode: system.mode(mode).unwrap(),
        state: state.to_vec(),
        phase,
    };
    let wanted = Wanted::new(system, parameter, range).unwrap();
    first(&wanted, &beginning, search)
}

/// What a branch meets until its range or this many points.
pub fn follow(
    orbit: &AffineOrbit,
    point: &Vector,
    up: bool,
    range: (f64, f64),
    most: usize,
) -> (Vec<Seen>, Vec<LocatedPoint<AffineOrbit>>) {
    let limits = Limits {
        range,
        stop_at: Vec::new(),
        steps: Steps {
            ds: 0.01,
            ds_min: 1e-12,
            ds_max: 0.05,
            tolerance: 1e-10,
        },
    };
    let follower = Follower::new(orbit.clone(), point, up, limits).unwrap();
    let all: Vec<_> = follower.points().take(most).collect();
    let special = all
        .iter()
        .filter_map(|one| one.special.as_ref().map(|special| (one, special)));
    let seen = special.map(|(one, special)| Seen {
        kind: special.kind(),
        value: one.parameter,
        what: match special.after() {
            Some(after) => format!("{} > {after}", one.orbit.sequence),
            None => one.orbit.sequence.to_string(),
        },
    });
    (seen.collect(), all)
}

fn start(reference: &Reference) -> (AffineOrbit, Vector) {
    let (orbit, guess) = reference.posed();
    let point = solved(&orbit, &guess);
    (orbit, point)
}

/// The events that a branch meets, in order: types, values and sequences.
pub fn meets(seen: &[Seen], expected: &[(EventType, f64, &str)], allowed: f64) {
    let list = |seen: &[Seen]| -> String {
        let lines = seen
            .iter()
            .map(|one| format!("{} {} {}\n", one.kind, one.value, one.what));
        lines.collect()
    };
    assert_eq!(seen.len(), expected.len(), "{}", list(seen));
    for (one, (kind, value, what)) in seen.iter().zip(expected) {
        assert_eq!(one.kind, *kind, "{}", list(seen));
        // which half of a symmetric orbit comes first is rounding
        let named = what.is_empty() || one.what == *what;
        assert!(named, "{what}: {}", list(seen));
        let off = (one.value - value).abs();
        assert!(
            off <= allowed * value.abs(),
            "{kind} at {} for {value}: {off:e}",
            one.value
        );
    }
}

use EventType::{BP, CO, EP, GR, LP, PD, SL};

#[test]
fn down_to_the_fold_and_through_the_graze() {
    let (orbit, point) = start(&impact(2.0, 1.0, 0.8, 1, 0.0, &[(-2.7, TAU)]));
    let (seen, all) = follow(&orbit, &point, false, (0.05, 3.0), 500);
    let expected = [
        (LP, 0.099970753628313271803, "free"),
        (GR, 0.1, "free > free"),
        (EP, 0.05, "free"),
    ];
    meets(&seen, &expected, 1e-13);
    // beyond the graze nothing switches any more, and the amplitude is that of the linear oscillator
    let last = all.last().unwrap();
    assert_eq!(last.orbit.sequence.switches(), 0);
    let extremes = last.orbit.extremes(&last.node.point).unwrap();
    for (low, high) in extremes {
        // |G| = 10 at resonance
        assert!(
            (high - 0.5).abs() < 1e-12 && (low + 0.5).abs() < 1e-12,
            "{low} {high}"
        );
    }
    // and back
    let node = &last.node;
    let (seen, _) = follow(&last.orbit, &node.point, true, (0.04, 2.0), 500);
    let expected = [
        (GR, 0.1, "free > free"),
        (LP, 0.099970753628313271803, "free"),
        (EP, 2.0, "free"),
    ];
    meets(&seen, &expected, 1e-13);
}

#[test]
fn through_the_doubling_to_the_inner_graze() {
    let (orbit, point) = start(&impact(1.0, 0.8, 0.8, 1, 6.2, &[(-1.5, TAU / 0.8)]));
    let (seen, _) = follow(&orbit, &point, false, (0.2, 3.0), 500);
    let expected = [
        (PD, 0.5182098665978725691, "free"),
        (GR, 0.3687817782917154924, "free > free"),
        (EP, 0.2, "free"),
    ];
    meets(&seen, &expected, 1e-13);
    let (seen, all) = follow(&orbit, &point, true, (0.2, 14.0), 1000);
    let expected = [
        (GR, 2.0902833592017951225, "free > free-free"),
        (LP, 1.5051413292414020217, "free-free"),
        (PD, 13.532041105032496003, "free-free"),
        (EP, 14.0, "free-free"),
    ];
    meets(&seen, &expected, 1e-13);
    let last = all.last().unwrap();
    let (seen, _) = follow(&last.orbit, &last.node.point, false, (1.0, 15.0), 1000);
    let expected = [
        (PD, 13.532041105032496003, "free-free"),
        (LP, 1.5051413292414020217, "free-free"),
        (GR, 2.0902833592017951225, "free-free > free"),
        (EP, 1.0, "free"),
    ];
    meets(&seen, &expected, 1e-13);
}

/// The orbit on which a motion settles.
pub fn settled(
    text: &str,
    replaced: &[(&str, f64)],
    parameter: &str,
    mode: &str,
    state: &[f64],
    settle: f64,
) -> (AffineOrbit, Vector) {
    let system = system(text);
    let wanted = Wanted {
        values: values(&system, replaced),
        periods: 4,
        ..Wanted::new(system, parameter, (0.0, 1.0)).unwrap()
    };
    let beginning = Beginning {
        mode: wanted.system.mode(mode).unwrap(),
        state: state.to_vec(),
        phase: 0.0,
    };
    first(&wanted, &beginning, Search::Settles(settle)).unwrap()
}

/// Both halves of a symmetric orbit meet the onset of stick, or of sliding, at once: one event.
#[test]
fn through_the_onset_of_stick_and_of_sliding() {
    let dry = settled(FRICTION, &[("w", 0.8)], "w", "forth", &[0.0, 0.1], 60.0);
    let (seen, all) = follow(&dry.0, &dry.1, false, (0.6, 1.0), 200);
    let onset = 0.7226791944381431415;
    let expected = [(SL, onset, ""), (EP, 0.6, "forth-stick-back-stick")];
    meets(&seen, &expected, 1e-12);
    let last = all.last().unwrap();
    let multipliers = last.orbit.multipliers(&last.node.point).unwrap();
    assert!((multipliers[0].value.re - 0.041769776878522).abs() < 1e-12 && multipliers[1].trivial);
    let relay = settled(
        RELAY,
        &[("rho", 3.0)],
        "rho",
        "plus",
        &[0.0, 2.8, 17.0],
        100.0,
    );
    let (seen, _) = follow(&relay.0, &relay.1, false, (1.5, 3.0), 200);
    let onset = 2.0988410675607513346;
    let expected = [(SL, onset, ""), (EP, 1.5, "plus-slide-minus-slide")];
    meets(&seen, &expected, 1e-12);
}

/// The table throws the ball, and catches it in flight once more at every graze.
#[test]
fn from_the_ball_to_its_saddle_and_through_grazes() {
    let (orbit, point) = settled(BALL, &[("G", 1.1)], "G", "flight", &[0.0, 2.0], 200.0);
    let (seen, _) = follow(&orbit, &point, false, (1.0, 2.6), 160);
    let expected = [
        (LP, std::f64::consts::FRAC_PI_3, "flight"),
        (GR, 2.5042999536516703382, "flight > flight-flight"),
        (PD, 1.5168023602477137906, "flight-flight"),
        (LP, 1.48422083296340167, "flight-flight"),
        (
            GR,
            1.8942634188461103942,
            "flight-flight > flight-flight-flight",
        ),
        (PD, 1.5827602547039797066, "flight-flight-flight"),
        (LP, 1.574256307872913754, "flight-flight-flight"),
    ];
    meets(&seen[..expected.len()], &expected, 1e-12);
}

/// Both halves of a symmetric friction orbit touch at once, and zones open like square roots: one event there and
/// one back, at one place.
#[test]
fn four_and_six_stops_there_and_back() {
    let (two, four) = (
        "forth-stick-back-stick",
        "forth-stick-forth-stick-back-stick-back-stick",
    );
    let six = "forth-stick-forth-stick-forth-stick-back-stick-back-stick-back-stick";
    let (first, second) = (0.14483869701668354458, 0.081510747892607914497);
    let dry = settled(FRICTION, &[("w", 0.15)], "w", "forth", &[0.0, 0.1], 300.0);
    let (seen, all) = follow(&dry.0, &dry.1, false, (0.0803, 0.2), 300);
    let expected = [
        (GR, first, ""),
        (GR, second, &*format!("{four} > {six}")),
        (EP, 0.0803, six),
    ];
    meets(&seen, &expected, 1e-11);
    let last = all.last().unwrap();
    let (seen, _) = follow(&last.orbit, &last.node.point, true, (0.08, 0.15), 300);
    let expected = [
        (GR, second, &*format!("{six} > {four}")),
        (GR, first, &*format!("{four} > {two}")),
        (EP, 0.15, two),
    ];
    meets(&seen, &expected, 1e-11);
    // with little friction the slip touches v = 0 twice, and a short one vanishes after the turn
    let small = [("w", 0.4), ("F", 0.1), ("z", 0.02)];
    let dry = settled(FRICTION, &small, "w", "forth", &[0.0, 0.1], 300.0);
    let (seen, _) = follow(&dry.0, &dry.1, false, (0.2, 0.5), 600);
    let expected = [
        (GR, 0.38295771764306100346, ""),
        (SL, 0.35467657048289267737, ""),
        (GR, 0.30627209010980353084, &*format!("{two} > {four}")),
        (GR, 0.29479965736345052875, &*format!("{four} > {two}")),
        (EP, 0.2, two),
    ];
    meets(&seen, &expected, 1e-11);
}

/// Where the equilibrium of `on` reaches its own threshold, Q = a·high/b, the period grows like a logarithm: the place is known
/// to rounding, as the equilibrium is.
#[test]
fn a_period_without_bound_is_an_end() {
    let thermostat = settled(THERMOSTAT, &[("Q", 1.2)], "Q", "on", &[1.0, 0.5], 100.0);
    let (_, all) = follow(&thermostat.0, &thermostat.1, false, (1.0, 3.0), 2000);
    let last = all.last().unwrap();
    let what = last.special.as_ref().unwrap().to_string();
    assert!(what.contains("rests on the boundary of `on`"), "{what}");
    let off = (last.parameter - 1.1).abs();
    assert!(off <= last.known_to() && last.known_to() < 1e-13, "{off:e}");
}

/// What lags behind by `th` has died out long before the next switch, e^(−0.2/th): the period is known in closed form,
/// and the branch ends where it would without a lag.
#[test]
fn a_stiff_mode_is_followed_as_one_that_is_not() {
    for th in [1e-3, 1e-6] {
        let replaced = [("Q", 2.0), ("th", th)];
        let thermostat = settled(THERMOSTAT, &replaced, "Q", "on", &[1.0, 0.5], 20.0);
        let (_, all) = follow(&thermostat.0, &thermostat.1, false, (1.0, 3.0), 2000);
        for one in all.iter().filter(|one| one.parameter > 1.12) {
            let q = one.parameter;
            let lag = q * th / (1.0 - th);
            let on = ((q + lag - 0.9) / (q - 1.1)).ln();
            let off = ((1.1 + lag) / 0.9).ln();
            let at = one.orbit.at(&one.node.point).unwrap();
            for (zone, of) in at.zones.iter().zip(&one.orbit.sequence.0) {
                let exact = if of.name == "on" { on } else { off };
                let error = (zone.duration - exact).abs();
                // the closed form has the rounding of Q − 1.1
                assert!(error < 2e-15 / (q - 1.1), "th = {th}, Q = {q}: {error:e}");
            }
            let multipliers = one.orbit.multipliers(&one.node.point).unwrap();
            let rounding = 1e-15 / th;
            assert!(multipliers[0].trivial && multipliers[1].value.norm() < rounding);
        }
        let last = all.last().unwrap();
        let what = last.special.as_ref().unwrap().to_string();
        assert!(what.contains("rests on the boundary of `on`"), "{what}");
        let off = (last.parameter - 1.1).abs();
        assert!(off <= last.known_to() && last.known_to() < 1e-13, "{off:e}");
    }
}

/// A symmetric orbit loses its symmetry where the multiplier of its half passes −1: the branch passes 1 with no fold.
#[test]
fn symmetry_is_lost_at_a_branch_point() {
    let system = system(CHUA);
    let wanted = Wanted {
        values: values(&system, &[("alpha", 13.74)]),
        ..Wanted::new(system, "alpha", (0.0, 1.0)).unwrap()
    };
    let beginning = Beginning {
        mode: wanted.system.mode("upper").unwrap(),
        state: vec![1.0, 0.0937, -0.8123],
        phase: 0.0,
    };
    let (orbit, point) = first(&wanted, &beginning, Search::Guess(2.0 * 2.3076)).unwrap();
    let (down, _) = follow(&orbit, &point, false, (13.7, 14.0), 200);
    meets(&down[..1], &[(BP, 13.728817274033318115, "")], 1e-12);
    let (up, _) = follow(&orbit, &point, true, (13.7, 14.0), 200);
    meets(&up[..1], &[(LP, 13.750880142522143392, "")], 1e-12);
}

/// x″ + x = cos φ.
const UNDAMPED: &str = r#"(
    system: (
        states: ["x", "v"],
        parameters: {"w": 0.6},
        forcing: "w",
        modes: {"only": (rates: {"x": "v", "v": "cos(phase) - x"}, until: [])},
    ),
    orbit: (start: Given(mode: "only", state: {"x": 1.5625, "v": 0.0})),
)"#;

/// The reasons for which branches end, and where, in closed form or from the reference.
#[test]
fn ends_that_mathematics_knows_have_names() {
    let last = |all: &[LocatedPoint<AffineOrbit>]| {
        let last = all.last().unwrap();
        let change = match last.special.as_ref().unwrap() {
            Special::Change(change) => change.end.as_ref().map(ToString::to_string),
            special => Some(special.to_string()),
        };
        (last.parameter, last.uncertainty, change.unwrap())
    };
    // the slip comes up to the belt with no acceleration, and the stick lasts 1/2: GR and nothing else
    let belt = settled(BELT, &[], "z", "stick", &[0.0, 1.0], 50.0);
    let (seen, all) = follow(&belt.0, &belt.1, true, (0.0, 0.05), 500);
    assert_eq!(seen.len(), 1);
    meets(&seen, &[(GR, 0.017938095904388093253, "")], 1e-12);
    let (_, _, why) = last(&all);
    assert!(
        why.contains("`u - v` of `slip` does not come to zero any more"),
        "{why}"
    );
    // friction as large as the force, which is 1, arrests the mass
    let dry = settled(
        FRICTION,
        &[("w", 0.8), ("F", 0.98)],
        "F",
        "forth",
        &[0.0, 0.5],
        20.0,
    );
    let (_, all) = follow(&dry.0, &dry.1, true, (0.3, 1.3), 500);
    let (value, error, why) = last(&all);
    assert!(why.contains("comes to rest: beyond it `stick`"), "{why}");
    assert!(
        (value - 1.0).abs() < 2.0 * error && error < 1e-5,
        "{value} {error:e}"
    );
    // no rebound: an impact is followed by a flight while the force pulls the mass off, A cos φ < d with cos φ
    // of the impact; beyond, it stays at the stop
    let dead = settled(IMPACT, &[("e", 0.0)], "A", "free", &[0.0, 0.0], 200.0);
    let (seen, all) = follow(&dead.0, &dead.1, true, (0.5, 3.0), 500);
    assert_eq!(seen.len(), 1);
    let (value, _, why) = last(&all);
    assert!(why.contains("met again as soon as `free` begins"), "{why}");
    let zone = &all
        .last()
        .unwrap()
        .orbit
        .at(&all.last().unwrap().node.point)
        .unwrap()
        .zones[0];
    assert!((value * zone.phase.cos() - 1.0).abs() < 1e-10, "{value}");
    // x = A cos φ/(1 − w²)
    let free = settled(UNDAMPED, &[], "w", "only", &[1.5625, 0.0], 0.0);
    let (seen, all) = follow(&free.0, &free.1, true, (0.55, 1.5), 2000);
    // its multipliers are on the unit circle all along: no event
    assert_eq!(seen.len(), 1);
    let (value, error, why) = last(&all);
    assert!(why.contains("grow without bound"), "{why}");
    assert!(
        (value - 1.0).abs() < error && error < 1e-4,
        "{value} {error:e}"
    );
}

/// Without restitution an impact leaves no speed, but only there: the branch comes to e = 0 as to any other value.
#[test]
fn a_restitution_that_vanishes_is_no_event() {
    let (orbit, point) = settled(IMPACT, &[("w", 0.8)], "e", "free", &[0.0, 0.0], 200.0);
    let (seen, _) = follow(&orbit, &point, false, (0.0, 1.0), 500);
    meets(&seen, &[(EP, 0.0, "")], 1.0);
}

/// A spring as the stop changes the rate by nothing as it is met: at the graze the multipliers of the orbit that meets it are those
/// of the one that does not, of modulus exp(−cT/2).
#[test]
fn a_stiff_spring_has_the_multipliers_of_the_graze() {
    let spring = r#"(
        states: ["x", "v"],
        parameters: {"c": 0.1, "A": 0.9605, "w": 0.2, "d": 1.0, "k": 1e4},
        forcing: "w",
        modes: {
            "free": (rates: {"x": "v", "v": "A*cos(phase) - x - c*v"}, until: [(zero: "d - x", to: "wall")]),
            "wall": (
                rates: {"x": "v", "v": "A*cos(phase) - x - c*v - k*(x - d)"},
                until: [(zero: "x - d", to: "free")],
            ),
        },
    )"#;
    let (orbit, point) = settled(spring, &[], "A", "free", &[0.0, 0.0], 200.0);
    assert_eq!(orbit.zones(), 2);
    let (_, all) = follow(&orbit, &point, false, (0.95, 1.1), 500);
    let graze = all
        .iter()
        .find(|one| one.kind() == Some(GR) && one.orbit.zones() == 2)
        .unwrap();
    let modulus = (-0.05 * TAU / 0.2_f64).exp();
    for one in graze.orbit.multipliers(&graze.node.point).unwrap() {
        let off = (one.value.norm() - modulus).abs();
        assert!(off < 1e-3, "{} for {modulus}", one.value);
    }
}

/// Two foci that meet in x = 0: at m = 0.3 their equilibrium is on the line, and orbits beside it are one another but
/// for their size, which is proportional to m − 0.3: their period and their multipliers are the same.
const FOCI: &str = r#"(
    states: ["x", "y"],
    parameters: {"l": -1.0, "r": 0.5, "m": 1.0},
    modes: {
        "left": (rates: {"x": "l*x - y", "y": "x + 0.3 - m"}, until: [(zero: "-x", to: "right")]),
        "right": (rates: {"x": "r*x - y", "y": "x + 0.3 - m"}, until: [(zero: "x", to: "left")]),
    },
)"#;

#[test]
fn an_orbit_shrinks_to_a_point_where_its_modes_meet() {
    let (orbit, point) = settled(FOCI, &[], "m", "right", &[0.1, 0.0], 200.0);
    let of = |orbit: &AffineOrbit, point: &Vector| {
        let multipliers = orbit.multipliers(point).unwrap();
        let own = multipliers.iter().find(|one| !one.trivial).unwrap();
        (orbit.cycle(point).unwrap().period, own.value.re)
    };
    let (period, multiplier) = of(&orbit, &point);
    let (seen, all) = follow(&orbit, &point, false, (-1.0, 2.0), 500);
    meets(&seen, &[(BP, 0.3, "")], 1e-15);
    let last = all.last().unwrap();
    let what = last.special.as_ref().unwrap().to_string();
    assert!(what.contains("boundary equilibrium"), "{what}");
    let there = of(&last.orbit, &last.node.point);
    let off = (there.0 - period).abs().max((there.1 - multiplier).abs());
    assert!(off < 1e-6, "{there:?}");
}

/// The same where a part of the orbit slides: y = 0 draws motions in from above, below it turns about an unstable focus that comes to
/// y = 0 at m = 1.06. There all that the push of a side does along the surface vanishes, by chance: beside it that is not so.
#[test]
fn an_orbit_that_slides_shrinks_to_a_point() {
    let text = r#"(states: ["x", "y"], parameters: {"m": 0.1}, modes: {
        "up": (rates: {"x": "-1", "y": "-1"}, until: [(zero: "y", to: "lo")]),
        "lo": (rates: {"x": "0.6*x - (y + 1) + m", "y": "x + 0.1*(y + 1)"}, until: [(zero: "-y", to: "up")])},
        sliding: {"sl": ("up", "lo")})"#;
    let (orbit, point) = settled(text, &[], "m", "lo", &[0.3, -1.0], 200.0);
    let (seen, all) = follow(&orbit, &point, true, (-1.5, 1.5), 500);
    meets(&seen, &[(BP, 1.06, "")], 1e-15);
    let last = all.last().unwrap();
    let what = last.special.as_ref().unwrap().to_string();
    assert!(what.contains("boundary equilibrium"), "{what}");
}

/// A relay whose output has a continuous slope: without hysteresis it would switch without end at rest.
#[test]
fn a_relay_without_hysteresis_has_no_period() {
    let relay = r#"(
        states: ["y", "v"],
        parameters: {"h": 0.2},
        modes: {
            "on": (rates: {"y": "v", "v": "1 - 0.6*v - y"}, until: [(zero: "h - y", to: "off")]),
            "off": (rates: {"y": "v", "v": "-1 - 0.6*v - y"}, until: [(zero: "y + h", to: "on")]),
        },
    )"#;
    let (orbit, point) = settled(relay, &[], "h", "on", &[0.0, 0.0], 100.0);
    let (seen, all) = follow(&orbit, &point, false, (-1.0, 1.0), 500);
    let last = all.last().unwrap();
    assert!(seen.len() == 1 && last.parameter.abs() < 1e-12);
    let what = match last.special.as_ref().unwrap() {
        Special::Change(change) => change.end.as_ref().unwrap().to_string(),
        other => other.to_string(),
    };
    assert!(what.contains("shrink to nothing together"), "{what}");
}

/// A branch that begins with an orbit a thousand times smaller than others takes few steps.
#[test]
fn steps_grow_with_the_orbit() {
    let small = settled(IMPACT, &[("A", 1e-4)], "A", "free", &[0.0, 0.0], 400.0);
    let (seen, all) = follow(&small.0, &small.1, true, (1e-5, 0.2), 2000);
    assert!(all.len() < 700, "{}", all.len());
    let expected = [
        (GR, 0.1, "free > free"),
        (LP, 0.099970753628313271803, "free"),
        (EP, 0.2, "free"),
    ];
    meets(&seen, &expected, 1e-11);
}

/// A wheel of spokes of unit rate: its speed before an impact follows from v₋² = v₊² + 4ag and v₊ = cv₋, so that its
/// multiplier is c² on the whole branch, which ends where it does not come over its spoke, at (a − g)² = 4agc²/(1 − c²).
#[test]
fn a_wheel_that_hardly_comes_over_its_spoke_keeps_its_multiplier() {
    const WHEEL: &str = r#"(
        states: ["q", "v"],
        parameters: {"a": 0.4, "g": 0.12, "c": 0.8},
        modes: {"stance": (
            rates: {"q": "v", "v": "q"},
            until: [(zero: "g + a - q", to: "stance", reset: {"q": "g - a", "v": "c*v"})],
        )},
    )"#;
    let (orbit, point) = settled(WHEEL, &[], "g", "stance", &[-0.28, 0.6], 60.0);
    let (seen, all) = follow(&orbit, &point, false, (0.04, 0.2), 2000);
    meets(&seen, &[(EventType::HC, 0.4 / 9.0, "stance")], 1e-12);
    let mut largest = 0.0_f64;
    for one in &all {
        for multiplier in one.orbit.multipliers(&one.node.point).unwrap() {
            let off = (multiplier.value.re - 0.64).abs();
            // rounding, and how well the orbit closes: to 1e-10 in units of the states, of which its velocity is a third,
            // in several unknowns
            let allowed = multiplier.error + 1e-9;
            assert!(
                multiplier.trivial || off <= allowed,
                "{off:e} {multiplier:?}"
            );
            largest = largest.max(multiplier.error);
        }
    }
    // it stays near its saddle for long, and is known nevertheless
    assert!(largest < 1e-3, "{largest:e}");
}

/// Friction that is zero at one value slides along the direction that it has nearby: a branch ends there and begins there
/// as at any other value, with the amplitude of the oscillator without friction.
#[test]
fn friction_may_vanish() {
    let (w, z) = (0.8_f64, 0.05);
    let amplitude = (1.0 - w * w).hypot(2.0 * z * w).recip();
    let turns = |orbit: &AffineOrbit, point: &Vector| {
        let at = orbit.at(point).unwrap();
        let off = |zone: usize| (at.zones[zone].state[0].abs() - amplitude).abs();
        off(0).max(off(1))
    };
    let dry = |friction: f64| {
        let replaced = [("w", w), ("F", friction)];
        settled(FRICTION, &replaced, "F", "forth", &[0.0, 0.5], 60.0)
    };
    let (orbit, point) = dry(0.3);
    let (seen, all) = follow(&orbit, &point, false, (0.0, 0.5), 200);
    meets(&seen, &[(EP, 0.0, "")], 1e-15);
    let last = all.last().unwrap();
    assert!(turns(&last.orbit, &last.node.point) < 1e-12);
    let (orbit, point) = dry(0.0);
    assert!(turns(&orbit, &point) < 1e-12);
    let (seen, _) = follow(&orbit, &point, true, (0.0, 0.3), 200);
    meets(&seen, &[(EP, 0.3, "")], 1e-15);
}

/// Friction k and negative damping: x'' − 2sx' + x = −k sign x'. Half a turn takes π/√(1 − s²) and grows by
/// q = exp(sπ/√(1 − s²)), so that the orbit turns at a = k(q + 1)/(q − 1). Where the focus −k of one half becomes a node, at
/// s = 1, the period is infinite and a = k: the branch ends short of it, with a distance from the focus that is rounding.
#[test]
fn an_orbit_comes_to_an_equilibrium_on_its_boundary() {
    let text = r#"(
        states: ["x", "v"],
        parameters: {"s": 0.5, "k": 1.0},
        modes: {
            "forth": (rates: {"x": "v", "v": "2*s*v - x - k"}, until: [(zero: "v", to: "back")]),
            "back": (rates: {"x": "v", "v": "2*s*v - x + k"}, until: [(zero: "-v", to: "forth")]),
        },
        sliding: {"stick": ("forth", "back")},
    )"#;
    let half = |s: f64| PI / (1.0 - s * s).sqrt();
    let turn = |s: f64| {
        let grown = (s * half(s)).exp();
        (grown + 1.0) / (grown - 1.0)
    };
    let system = system(text);
    let wanted = Wanted {
        values: values(&system, &[]),
        ..Wanted::new(system, "s", (0.0, 2.0)).unwrap()
    };
    let beginning = Beginning {
        mode: 0,
        state: vec![-turn(0.5), 0.0],
        phase: 0.0,
    };
    let (orbit, point) = first(&wanted, &beginning, Search::Guess(2.0 * half(0.5))).unwrap();
    let (_, all) = follow(&orbit, &point, true, (0.0, 2.0), 2000);
    for found in &all {
        let at = found.orbit.at(&found.node.point).unwrap();
        let s = found.parameter;
        // beside the focus rounding grows as the distance does
        let allowed = 1e-14 * (1.0 + (s * half(s)).exp());
        assert!(
            (at.zones[0].duration - half(s)).abs() <= allowed * half(s),
            "{s}"
        );
        assert!((at.zones[0].state[0].abs() - turn(s)).abs() < 1e-12, "{s}");
    }
    let last = all.last().unwrap();
    let why = last.special.as_ref().unwrap().to_string();
    assert!(
        why.contains("begins ever nearer to its equilibrium"),
        "{why}"
    );
    let left = 1.0 - last.parameter;
    assert!(
        left > 0.0 && left < 1.5 * last.uncertainty && last.uncertainty < 0.05,
        "{left} {}",
        last.uncertainty
    );
}

/// A hopper whose leg pushes by u where it is shortest leaves the ground while u > (g/k)(1 − q), q what is left of an
/// amplitude after half a turn: from rest on the ground it sinks by (g/k)(1 + q) and rises to l − g/k + u + (u + qg/k)q.
#[test]
fn a_hopper_that_only_just_leaves_the_ground() {
    let text = r#"(
        states: ["y", "v"],
        parameters: {"g": 1.0, "k": 20.0, "c": 0.5, "u": 0.3, "l": 1.0},
        modes: {
            "flight": (rates: {"y": "v", "v": "-g"}, until: [(zero: "y - l", to: "squeeze")]),
            "squeeze": (rates: {"y": "v", "v": "k*(l - y) - g - c*v"}, until: [(zero: "-v", to: "thrust")]),
            "thrust": (rates: {"y": "v", "v": "k*(l + u - y) - g - c*v"}, until: [(zero: "l - y", to: "flight")]),
        },
    )"#;
    let (orbit, point) = settled(text, &[("u", 0.05)], "u", "flight", &[1.05, 0.0], 60.0);
    let (seen, all) = follow(&orbit, &point, false, (0.0, 1.0), 500);
    let turn = (20.0_f64 - 0.0625).sqrt();
    let least = 0.05 * (1.0 - (-0.25 * PI / turn).exp());
    meets(&seen, &[(CO, least, "")], 1e-9);
    let Some(Special::Change(change)) = &all.last().unwrap().special else {
        panic!("no change");
    };
    let why = change.end.as_ref().unwrap().to_string();
    assert!(why.contains("of `thrust` does not come to zero"), "{why}");
}
