//! Systems with contacts, against the same systems written mode by mode, and against figures of an independent program
//! that solves for switching times with exact flows in 69 digits.

use brakewave::EventType;
use brakewave::affine::contact::ContactMistake;
use brakewave::affine::motion::{Halt, Motion, Step};
use brakewave::affine::orbit::AffineOrbit;
use brakewave::affine::orbit::start::{Beginning, NoStart, Search, Wanted, first};
use brakewave::affine::system::System;
use brakewave::linalg::Vector;
use brakewave::orbit::follow::LocatedPoint;
use brakewave::problem::{Any, parse_any};

use crate::affine::branches::{Seen, follow, settled};
use crate::affine::systems::{BALL, FRICTION, IMPACT, RELAY, at, place, system};
use EventType::{CO, EP, GR, LP, PD, SL};

/// A start: the mode by name, the state, and how long it settles.
type From<'a> = (&'a str, &'a [f64], f64);

fn started(
    system: &System,
    (mode, state, settle): From,
    (parameter, range): (&str, (f64, f64)),
) -> Result<(AffineOrbit, Vector), NoStart> {
    let beginning = Beginning {
        mode: system.mode(mode).unwrap(),
        state: state.to_vec(),
        phase: 0.0,
    };
    let mut wanted = Wanted::new(system.clone(), parameter, range).unwrap();
    // without forcing an orbit may come back to its first switch several times
    if system.source.forcing.is_none() {
        wanted.periods = 12;
    }
    first(&wanted, &beginning, Search::Settles(settle))
}

/// What the branch meets in both directions, the ends of its range left out.
fn met(text: &str, from: From, along: (&str, (f64, f64))) -> Vec<Seen> {
    let (orbit, point) = started(&system(text), from, along).unwrap();
    let both = [true, false].map(|up| follow(&orbit, &point, up, along.1, 2000).0);
    let all = both.into_iter().flatten();
    all.filter(|one| one.kind != EP).collect()
}

/// The branch meets these events; an onset of stick is an end of a zone and of a condition at once, and may be told as
/// either.
fn meets(seen: &[Seen], expected: &[(EventType, f64)]) {
    let list: Vec<String> = seen
        .iter()
        .map(|one| format!("{} {:?} {}", one.kind, one.value, one.what))
        .collect();
    for (kind, value) in expected {
        let nearest = seen.iter().min_by(|one, other| {
            (one.value - value)
                .abs()
                .total_cmp(&(other.value - value).abs())
        });
        let nearest = nearest.unwrap_or_else(|| panic!("{kind} at {value} of {list:#?}"));
        let regime = [GR, SL, CO];
        let same = nearest.kind == *kind || regime.contains(kind) && regime.contains(&nearest.kind);
        // states to 1e-14, multiplied by conditions of events of less than 100
        let near = (nearest.value - value).abs() <= 1e-12 * value.abs();
        assert!(same && near, "{kind} at {value} of {list:#?}");
    }
}

const TWO_BLOCKS: &str = r#"(
    states: ["x1", "v1", "x2", "v2"],
    parameters: {"k": 1.2, "F1": 1.0, "F2": 1.3, "Fs1": 1.5, "Fs2": 2.1, "vb": 0.3, "c": 0.05},
    contacts: {
        "q1": Friction(slip: "v1 - vb", bound: "F1", static: "Fs1"),
        "q2": Friction(slip: "v2 - vb", bound: "F2", static: "Fs2"),
    },
    rates: {"x1": "v1", "v1": "-x1 - k*(x1 - x2) - c*v1 + q1", "x2": "v2", "v2": "-x2 - k*(x2 - x1) - c*v2 + q2"},
)"#;

/// Where a motion halts, which it does before this time.
fn halt(motion: &mut Motion, until: f64) -> Halt {
    loop {
        match motion.step(until) {
            Ok(step) => assert_ne!(step, Step::Reached),
            Err(halt) => break halt,
        }
    }
}

/// Two blocks on a belt, their friction at rest above that of slip: up and down in the velocity of the belt.
#[test]
fn two_blocks_on_a_belt() {
    let from: From = ("backward.backward", &[1.4, 0.1, 0.0, 0.0], 400.0);
    let seen = met(TWO_BLOCKS, from, ("vb", (0.22, 0.41)));
    let expected = [
        (GR, 0.408_653_524_897_609_1),
        (CO, 0.262_342_218_661_870_8),
        (GR, 0.221_110_502_341_419),
    ];
    meets(&seen, &expected);
    let (orbit, point) = started(&system(TWO_BLOCKS), from, ("vb", (0.2, 0.45))).unwrap();
    let off = orbit.cycle(&point).unwrap().period / 7.503_276_815_189_117 - 1.0;
    assert!(off.abs() < 1e-14, "{off:e}");
    let multipliers = orbit.multipliers(&point).unwrap();
    let own: Vec<f64> = multipliers.iter().map(|one| one.value.re).collect();
    for (own, known) in own
        .iter()
        .zip([1.0, 0.270_859_189_236_002, 0.028_081_235_477_176, 0.0])
    {
        assert!((own - known).abs() < 1e-13, "{own} {known}");
    }
}

/// The order of states and contacts, and the names of either, are no part of what happens.
#[test]
fn the_order_of_contacts_changes_nothing() {
    let turned = r#"(
        states: ["b", "vb2", "a", "va"],
        parameters: {"k": 1.2, "F1": 1.0, "F2": 1.3, "Fs1": 1.5, "Fs2": 2.1, "vb": 0.3, "c": 0.05},
        contacts: {
            "second": Friction(slip: "vb2 - vb", bound: "F2", static: "Fs2"),
            "first": Friction(slip: "va - vb", bound: "F1", static: "Fs1"),
        },
        rates: {"b": "vb2", "vb2": "-b - k*(b - a) - c*vb2 + second", "a": "va", "va": "-a - k*(a - b) - c*va + first"},
    )"#;
    let along = ("vb", (0.22, 0.41));
    let from: From = ("backward.backward", &[1.4, 0.1, 0.0, 0.0], 400.0);
    let seen = met(TWO_BLOCKS, from, along);
    let from: From = ("backward.backward", &[0.0, 0.0, 1.4, 0.1], 400.0);
    let other = met(turned, from, along);
    assert_eq!(seen.len(), other.len());
    for (one, other) in seen.iter().zip(&other) {
        assert_eq!(one.kind, other.kind);
        assert!(
            (one.value - other.value).abs() <= 1e-13,
            "{} {}",
            one.value,
            other.value
        );
    }
}

/// Friction, relay, stop and ball as contacts have the branches that they have mode by mode.
#[test]
fn a_contact_is_what_its_modes_written_out_are() {
    let friction = r#"(states: ["x", "v"], parameters: {"w": 1.2, "F": 0.6666666666666666, "z": 0.05}, forcing: "w",
        contacts: {"q": Friction(slip: "v", bound: "F")}, rates: {"x": "v", "v": "cos(phase) - 2*z*v - x + q"})"#;
    let relay = r#"(states: ["x", "y", "z"], parameters: {"rho": 3.0}, contacts: {"q": Friction(slip: "x", bound: "1")},
        rates: {"x": "-3*x + y + q", "y": "-3*x + z - 2*rho*q", "z": "-x + rho^2*q"})"#;
    let stop = r#"(states: ["x", "v"], parameters: {"c": 0.1, "A": 1.0, "w": 1.0, "d": 1.0, "e": 0.8}, forcing: "w",
        contacts: {"p": Stop(gap: "d - x", restitution: "e")}, rates: {"x": "v", "v": "A*cos(phase) - c*v - x - p"})"#;
    let ball = r#"(states: ["y", "v"], parameters: {"G": 1.06, "e": 0.5}, forcing: "1",
        contacts: {"p": Stop(gap: "y", restitution: "e")}, rates: {"y": "v", "v": "-1 + G*sin(phase) + p"})"#;
    type Case<'a> = (
        &'a str,
        &'a str,
        [&'a str; 2],
        &'a [f64],
        f64,
        (&'a str, (f64, f64)),
    );
    let cases: [Case; 4] = [
        (
            FRICTION,
            friction,
            ["forth", "forward"],
            &[0.0, 0.5],
            100.0,
            ("w", (0.3, 1.25)),
        ),
        (
            RELAY,
            relay,
            ["plus", "forward"],
            &[1.0, 0.0, 0.0],
            200.0,
            ("rho", (0.5, 3.2)),
        ),
        (
            IMPACT,
            stop,
            ["free", "open"],
            &[0.0, 0.0],
            200.0,
            ("A", (0.05, 1.1)),
        ),
        (
            BALL,
            ball,
            ["flight", "open"],
            &[0.0, 2.0944],
            400.0,
            ("G", (1.0, 1.6)),
        ),
    ];
    for (written, contacts, [one, other], state, settle, along) in cases {
        let values = [("G", 1.06)].iter().filter(|(name, _)| along.0 == *name);
        let mut by_hand = system(written);
        for (name, value) in values {
            let index = by_hand.source.parameters.index(name).unwrap();
            by_hand.source.parameters.0[index].1 = *value;
        }
        let branch = |system: &System, mode: &str| {
            let (orbit, point) = started(system, (mode, state, settle), along).unwrap();
            let both = [true, false].map(|up| follow(&orbit, &point, up, along.1, 2000).0);
            both.into_iter().flatten().collect::<Vec<Seen>>()
        };
        let (seen, other) = (branch(&by_hand, one), branch(&system(contacts), other));
        let kinds = |seen: &[Seen]| seen.iter().map(|one| one.kind).collect::<Vec<_>>();
        assert_eq!(kinds(&seen), kinds(&other), "{contacts}");
        assert!(seen.len() > 2, "{contacts}");
        for (one, other) in seen.iter().zip(&other) {
            let off = (one.value - other.value).abs();
            assert!(off <= 1e-12 * one.value.abs(), "{} {:e}", one.what, off);
        }
    }
}

/// A friction that falls with the velocity, whose flow is integrated, beside the problem file with its modes by hand.
#[test]
fn a_bound_that_depends_on_the_slip() {
    let contact = r#"(states: ["x", "v"], parameters: {"ze": 0.1, "ms": 1.0, "mk": 0.5, "vs": 0.5, "mst": 1.2, "vb": 1.0},
        contacts: {"q": Friction(slip: "v - vb", bound: "mk + (ms - mk)*exp(-abs(v - vb)/vs)", static: "mst")},
        rates: {"x": "v", "v": "-2*ze*v - x + q"})"#;
    let by_hand = include_str!("../../problems/stribeck_belt.ron");
    let along = ("vb", (0.6, 1.085));
    let [one, other] = [(by_hand, "stick"), (contact, "stick")].map(|(text, mode)| {
        let (orbit, point) = started(&system(text), (mode, &[0.0, 1.0], 50.0), along).unwrap();
        orbit.cycle(&point).unwrap().period
    });
    assert!((one / other - 1.0).abs() < 1e-13, "{one} {other}");
}

/// Where friction falls with the speed of the slip from its value at rest on, slip begins with no acceleration, whatever
/// the law: the period is that of the slip in a Taylor series of 25 digits from the release F(1 + s) on, and of the stick.
#[test]
fn slip_begins_where_a_falling_law_is_that_of_stick() {
    let with = |bound: &str| {
        let text = format!(
            r#"(states: ["x", "v"], parameters: {{"F": 1.2, "s": 0.27, "vb": 0.49, "k": 1.34, "c": 0.03, "vs": 0.3}},
            contacts: {{"q": Friction(slip: "v - vb", bound: "{bound}")}}, rates: {{"x": "v", "v": "-k*x - c*v + q"}})"#
        );
        let from: From = ("backward", &[2.5, 0.0], 200.0);
        let (orbit, point) = started(&system(&text), from, ("vb", (0.4, 0.6))).unwrap();
        orbit.cycle(&point).unwrap().period
    };
    let period = with("F*(1 + s*exp(-abs(v - vb)/vs))");
    assert!(
        (period / 5.7742576411730566 - 1.0).abs() < 1e-13,
        "{period}"
    );
    // the same law in other words: exp(-y) = (1 - tanh(y/2))/(1 + tanh(y/2))
    let tanh = "tanh(abs(v - vb)/(2*vs))";
    let other = with(&format!("F*(1 + s*(1 - {tanh})/(1 + {tanh}))"));
    assert!((other / 5.7742576411730566 - 1.0).abs() < 1e-13, "{other}");
    with("F*max(1 - s*abs(v - vb)/vs, 0.3)");
    with("F*(1 + s/(1 + abs(v - vb)/vs))");
}

/// A force that is a polynomial of the third degree or more has a slope in the force of a contact that is exactly what it is of a linear
/// one: the period is that of an integration with events, the law may be written in any way.
#[test]
fn friction_beside_a_cubic_spring() {
    for cube in ["x^3", "x^2*x", "x*x*x"] {
        let text = format!(
            r#"(states: ["x", "v"], parameters: {{"vb": 0.3, "d": 3.0}},
            contacts: {{"q": Friction(slip: "v - vb", bound: "1/(1 + d*abs(v - vb))")}},
            rates: {{"x": "v", "v": "-x - 0.1*{cube} + q"}})"#
        );
        let from: From = ("backward", &[1.5, 0.1], 100.0);
        let (orbit, point) = started(&system(&text), from, ("vb", (0.28, 0.32))).unwrap();
        let cycle = orbit.cycle(&point).unwrap();
        let off = cycle.period / 9.259601903958 - 1.0;
        assert!(off.abs() < 1e-12, "{cube}: {off:e}");
        assert_eq!(cycle.names.join("-"), "backward-stick");
    }
}

/// A wall of springs as two modes of one's own with friction in both, and as a contact beside the friction.
#[test]
fn modes_of_ones_own_with_a_contact() {
    let own = r#"(states: ["x", "v"], parameters: {"A": 1.0, "w": 0.6, "k": 4.0, "F": 0.2}, forcing: "w",
        contacts: {"q": Friction(slip: "v", bound: "F")},
        define: {"rest": "A*cos(phase) - x - 0.1*v + q"},
        modes: {
            "free": (rates: {"x": "v", "v": "rest"}, until: [(zero: "0.5 - x", to: "wall")]),
            "wall": (rates: {"x": "v", "v": "rest - k*(x - 0.5)"}, until: [(zero: "x - 0.5", to: "free")]),
        })"#;
    let both = r#"(states: ["x", "v"], parameters: {"A": 1.0, "w": 0.6, "k": 4.0, "F": 0.2}, forcing: "w",
        contacts: {"p": Spring(gap: "0.5 - x", stiffness: "k"), "q": Friction(slip: "v", bound: "F")},
        rates: {"x": "v", "v": "A*cos(phase) - x - 0.1*v + q - p"})"#;
    let along = ("A", (0.3, 1.5));
    let of = |text: &str, mode: &str| met(text, (mode, &[0.0, 0.1], 100.0), along);
    let (seen, other) = (of(own, "free.forward"), of(both, "open.forward"));
    assert!(!seen.is_empty() && seen.len() == other.len());
    for (one, other) in seen.iter().zip(&other) {
        assert_eq!(one.kind, other.kind);
        assert!(
            (one.value - other.value).abs() <= 1e-12,
            "{} {}",
            one.value,
            other.value
        );
        let renamed = one.what.replace("free", "open").replace("wall", "closed");
        assert_eq!(renamed, other.what);
    }
}

/// Friction under a mass that hits a stop: the impact turns its slip, and in between it may stick.
#[test]
fn an_impact_turns_a_slip() {
    let text = r#"(states: ["x1", "v1", "x2", "v2"],
        parameters: {"a": 1.0, "w": 0.8, "k": 0.8, "F1": 0.3, "F2": 0.1, "c": 0.1, "m": 0.6, "d": 0.4, "e": 0.7},
        forcing: "w",
        contacts: {
            "q1": Friction(slip: "v1", bound: "F1"),
            "q2": Friction(slip: "v2", bound: "F2"),
            "p": Stop(gap: "d - x2", restitution: "e"),
        },
        rates: {"x1": "v1", "v1": "a*cos(phase) - x1 - k*(x1 - x2) - c*v1 + q1",
            "x2": "v2", "v2": "(-k*(x2 - x1) - x2 - c*v2 + q2 - p)/m"})"#;
    let from: From = ("forward.forward.open", &[0.0, 0.1, 0.0, 0.1], 60.0);
    let expected = [
        (CO, 0.422_879_865_359_948),
        (CO, 0.431_760_756_043_553_6),
        (GR, 0.368_058_585_382_251_1),
        (CO, 0.361_647_721_517_456_6),
    ];
    meets(&met(text, from, ("d", (0.36, 0.434))), &expected);
}

/// One block on another: where one sticks to the other, the ground may hold neither, so that two contacts change in one
/// instant, and one that has begun to slip is held again.
#[test]
fn several_contacts_change_in_one_instant() {
    let text = |rest: &str| {
        format!(
            r#"(states: ["x1", "v1", "x2", "v2"], {rest}, forcing: "w",
            contacts: {{"q1": Friction(slip: "v1", bound: "F1"), "q2": Friction(slip: "v2 - v1", bound: "F2")}},
            rates: {{"x1": "v1", "v1": "a*cos(phase) - x1 - c*v1 + q1 - q2", "x2": "v2", "v2": "(-k*x2 - c*v2 + q2)/m"}})"#
        )
    };
    let own = text(
        r#"parameters: {"a": 1.5, "w": 0.7, "k": 0.9, "F1": 0.3, "F2": 0.7, "c": 0.1, "m": 0.8}"#,
    );
    let from: From = ("forward.forward", &[0.0, 0.1, 0.0, 0.2], 60.0);
    let expected = [(GR, 0.927_486_788_941_562_7), (SL, 0.583_751_824_697_269_7)];
    let seen = met(&own, from, ("w", (0.53, 0.93)));
    meets(&seen, &expected);
    let onset = seen.iter().find(|one| one.value < 0.6).unwrap();
    let longer = "forward.forward-forward.stick-stick.backward-backward.backward-backward.stick-stick.forward";
    assert!(onset.what.ends_with(longer), "{}", onset.what);
    let own = text(
        r#"parameters: {"a": 2.5, "w": 0.4, "k": 0.9, "F1": 0.3, "F2": 0.2, "c": 0.1, "m": 0.8}"#,
    );
    let expected = [
        (CO, 0.445_048_721_953_097_6),
        (SL, 0.445_074_288_065_642),
        (GR, 0.397_634_654_284_673_1),
        (CO, 0.393_239_132_752_406_9),
    ];
    meets(&met(&own, from, ("w", (0.39, 0.446))), &expected);
}

/// Elements of a spring and a slider, to the ground and between two masses.
#[test]
fn jenkins_elements() {
    let text = r#"(states: ["x1", "v1", "x2", "v2"],
        parameters: {"a": 0.8, "w": 1.0, "c": 0.05, "k": 0.5, "kj1": 0.8, "B1": 0.3, "kj2": 0.6, "B2": 0.05},
        forcing: "w",
        contacts: {
            "q1": Jenkins(slip: "v1", stiffness: "kj1", bound: "B1"),
            "q2": Jenkins(slip: "v2 - v1", stiffness: "kj2", bound: "B2"),
        },
        rates: {"x1": "v1", "v1": "a*cos(phase) - x1 - k*(x1 - x2) - c*v1 + q1 - q2",
            "x2": "v2", "v2": "-x2 - k*(x2 - x1) - c*v2 + q2"})"#;
    let from: From = ("stick.stick", &[0.0, 0.1, 0.0, 0.0, 0.0, 0.0], 100.0);
    let expected = [
        (CO, 1.055_635_407_786_786),
        (CO, 0.996_473_390_178_200_6),
        (CO, 0.928_746_916_233_485_2),
    ];
    meets(&met(text, from, ("w", (0.92, 1.06))), &expected);
    // one mass slips where kj a/|1 + kj - w² + icw| exceeds the bound
    let one = r#"(states: ["x", "v"], parameters: {"a": 0.5, "w": 1.1, "c": 0.05, "kj": 0.8, "B": 0.3}, forcing: "w",
        contacts: {"q": Jenkins(slip: "v", stiffness: "kj", bound: "B")}, rates: {"x": "v", "v": "a*cos(phase) - x - c*v + q"})"#;
    let onset = |sign: f64| {
        let (k, c2) = (1.8, 0.0025_f64);
        // |k - u + ic√u|² = (kj a/B)² in u = w²
        let (half, rest) = (k - c2 / 2.0, k * k - (0.8 * 0.5 / 0.3_f64).powi(2));
        (half + sign * (half * half - rest).sqrt()).sqrt()
    };
    let seen = met(one, ("stick", &[0.0, 0.1, 0.0], 200.0), ("w", (0.6, 1.9)));
    meets(&seen, &[(CO, onset(-1.0)), (CO, onset(1.0))]);
}

/// A spring on one side, without and with a damper; the latter lets go before its gap has opened, which is no zone of its
/// own in the names.
#[test]
fn springs_on_one_side() {
    let text = r#"(states: ["x", "v"], parameters: {"a": 1.0, "w": 0.42, "c": 0.2, "ks": 10.0, "d": 0.5}, forcing: "w",
        contacts: {"p": Spring(gap: "d - x", stiffness: "ks")}, rates: {"x": "v", "v": "a*cos(phase) - x - c*v - p"})"#;
    let from: From = ("open", &[0.0, 0.1], 60.0);
    let expected = [
        (PD, 0.437_410_391_750_068_5),
        (PD, 0.447_237_614_755_633_4),
        (GR, 0.454_807_175_661_707_8),
        (GR, 0.299_197_285_395_366_6),
        (LP, 0.299_180_745_971_860_6),
    ];
    meets(&met(text, from, ("w", (0.295, 0.53))), &expected);
    let damped = text.replace("\"ks\")", "\"ks\", damping: \"c\")");
    let (orbit, point) = started(&system(&damped), from, ("w", (0.3, 0.6))).unwrap();
    let names = orbit.sequence.to_string();
    let told: Vec<&str> = names.split('-').collect();
    let alternate = told.chunks(2).all(|pair| pair == ["open", "closed"]);
    assert!(
        alternate && 2 * orbit.sequence.len() == 3 * told.len(),
        "{names}"
    );
    // the force is never tension, and the energy of a period balances: ∫ẍẋ = 0
    let zones = orbit.at(&point).unwrap().zones;
    let closed = zones
        .iter()
        .zip(&orbit.sequence.0)
        .find(|(_, zone)| zone.mode == 1);
    let (entry, _) = closed.unwrap();
    // entered at the gap with the force of the damper alone
    assert!((entry.state[0] - 0.5).abs() < 1e-12 && entry.state[1] > 0.0);
}

/// A damped spring is touched where the slip of a friction changes its sign. Of the zones that open there the one up to
/// the peak lasts like the speed of the touch, the one in which the spring gives back like its square, so that they do
/// not grow alike. The branch meets the same events from either side.
#[test]
fn zones_open_each_at_a_rate_of_its_own() {
    let text = r#"(states: ["u", "v"], parameters: {"w": 0.53, "k": 50.0, "c": 0.2, "N": 0.1}, forcing: "w",
        contacts: {"p": Spring(gap: "0.5 - u", stiffness: "k", damping: "c"), "q": Friction(slip: "v", bound: "N")},
        rates: {"u": "v", "v": "cos(phase) - u - 0.05*v - p + q"})"#;
    let from: From = ("open.forward", &[0.0, 0.1], 300.0);
    let range = ("w", (0.45, 0.53));
    let without = met(text, from, range);
    let touching = met(&text.replace("0.53", "0.46"), from, range);
    let kinds = |seen: &[Seen]| seen.iter().map(|one| one.kind).collect::<Vec<_>>();
    assert_eq!(kinds(&without), [SL, CO, LP, LP]);
    assert_eq!(kinds(&touching), [LP, LP, CO, SL]);
    let values: Vec<_> = touching.iter().map(|one| (one.kind, one.value)).collect();
    meets(&without, &values);
    // just before the touch the peak is below the gap, just after it above: u = 1/2 and v = 0 at one instant
    assert!((without[1].value - 0.478_122_834_989_434).abs() < 1e-14);
}

/// A block that never slips keeps its place while another one swings. Where the spring between them reaches the bound of its friction
/// at the turns of that other one, on both sides, it begins to slip both ways, before and after each turn: four zones open like
/// square roots, and what was a family is one orbit. The branch meets it from either side.
#[test]
fn a_block_that_kept_its_place_slips_both_ways() {
    let text = r#"(states: ["x", "v", "y", "u"], parameters: {"w": 2.13, "h": 0.379, "F": 0.107, "G": 0.61}, forcing: "w",
        contacts: {"p": Friction(slip: "v", bound: "F"), "q": Friction(slip: "u", bound: "G")},
        rates: {"x": "v", "v": "(-2.57*x - 0.0238*v - h*(x - y) + 3.28*cos(phase) + p)/1.63",
            "y": "u", "u": "-2.01*y - 0.0238*u - h*(y - x) + q"})"#;
    let from: From = ("stick.stick", &[0.0; 4], 150.0);
    let range = ("w", (1.735, 2.13));
    let (orbit, point) = started(&system(text), from, range).unwrap();
    let (seen, points) = follow(&orbit, &point, false, range.1, 2000);
    let kinds: Vec<_> = seen.iter().map(|one| one.kind).collect();
    assert_eq!(kinds, [CO, EP]);
    let slips = points.iter().find(|one| one.special.is_some()).unwrap();
    let beyond = &points.last().unwrap().orbit;
    assert_eq!((slips.orbit.zones(), beyond.zones()), (2, 6));
    let back = met(&text.replace("2.13", "1.735"), from, range);
    meets(&back, &[(CO, slips.parameter)]);
    // the spring alone acts on the block that rests at zero: it reaches the bound where the other one turns at G/h
    let (low, high) = slips.orbit.extremes(&slips.node.point).unwrap()[0];
    let turn = 0.61 / 0.379;
    assert!(
        (high - turn).abs() < 1e-12 && (low + turn).abs() < 1e-12,
        "{low} {high}"
    );
}

/// An inelastic ball rests on its table until that falls faster than it, and leaves it with g, ġ and g̈ zero.
#[test]
fn an_inelastic_ball() {
    let text = r#"(states: ["y", "u"], parameters: {"G": 3.5, "g": 1.0, "w": 1.0, "e": 0.0}, forcing: "w",
        contacts: {"p": Stop(gap: "y", restitution: "e")}, rates: {"y": "u", "u": "G*sin(phase) - g + p"})"#;
    let seen = met(text, ("open", &[1.0, 0.0], 60.0), ("G", (3.0, 3.73)));
    let expected = [(SL, 3.296_908_309_475_615), (PD, 3.724_191_778_237_173)];
    meets(&seen, &expected);
    let bound = text.replace("\"e\": 0.0", "\"e\": -0.5");
    let error = crate::affine::systems::system(&bound);
    assert!(error.at(&error.values(), &[]).is_err());
}

/// Ten blocks have 3¹⁰ modes, of which a motion makes those that it enters.
#[test]
fn modes_are_made_when_they_are_entered() {
    let blocks = 1..=10;
    let join = |parts: Vec<String>| parts.join(", ");
    let states = blocks.clone().map(|i| format!("\"x{i}\", \"v{i}\""));
    let contacts = blocks
        .clone()
        .map(|i| format!("\"q{i}\": Friction(slip: \"v{i} - vb\", bound: \"0.{i}*F\")"));
    let rates = blocks.clone().map(|i| {
        let next = if i < 10 {
            format!(" - k*(x{i} - x{})", i + 1)
        } else {
            String::new()
        };
        let before = if i > 1 {
            format!(" - k*(x{i} - x{})", i - 1)
        } else {
            String::new()
        };
        format!("\"x{i}\": \"v{i}\", \"v{i}\": \"-x{i}{next}{before} - c*v{i} + q{i}\"")
    });
    let text = format!(
        "(states: [{}], parameters: {{\"k\": 3.0, \"c\": 0.1, \"vb\": 0.1, \"F\": 1.0}}, contacts: {{{}}}, rates: {{{}}})",
        join(states.collect()),
        join(contacts.collect()),
        join(rates.collect()),
    );
    let system = system(&text);
    let at = system.at(&system.values(), &[]).unwrap();
    assert_eq!(at.modes.len(), 59049);
    let stick = ["stick"; 10].join(".");
    let mode = system.mode(&stick).unwrap();
    assert_eq!(mode, 59048);
    // all at rest on the belt: nothing moves but the belt
    let z = at.lift(mode, &[0.0, 0.1].repeat(10), 0.0);
    let rates = &at.modes[mode].matrix.at * &z;
    for block in 0..10 {
        assert!((rates[2 * block] - 0.1).abs() < 1e-16 && rates[2 * block + 1].abs() < 1e-16);
    }
    assert_eq!(at.modes[mode].guards.len(), 20);
}

/// What is wrong with a contact is said at its place.
#[test]
fn a_contact_that_makes_no_sense_is_refused() {
    let whole = r#"(
        system: (
            states: ["x", "v"], parameters: {"F": 0.5, "e": 0.5, "d": 1.0}, forcing: "1",
            contacts: {"q": Friction(slip: "v", bound: "F"), "p": Stop(gap: "d - x", restitution: "e")},
            rates: {"x": "v", "v": "2*cos(phase) - x + q - p"},
        ),
        orbit: (start: Simulate(mode: "forward.open", state: {"x": 0.0, "v": 0.5}, settle: 100)),
    )"#;
    // a divisor that depends on a state is no force of the stop
    for bound in ["F", "F/(1 + abs(v))", "F*(1 + v^2)^(-1)"] {
        let with = whole.replace("bound: \"F\"", &format!("bound: \"{bound}\""));
        let parsed = parse_any(&with, "whole");
        assert!(matches!(parsed, Ok(Any::System(_))), "{bound}: {parsed:?}");
    }
    for (old, new, told) in [
        (
            "+ q - p",
            "+ q^2 - p",
            "the force `q` does not stand linearly here",
        ),
        ("+ q - p", "+ q*p", "does not stand linearly here"),
        (
            "+ q - p",
            "- q - p",
            "a positive force `q` would make its slip smaller",
        ),
        (
            "+ q - p",
            "+ q + p",
            "a positive force `p` would make its gap smaller",
        ),
        ("+ q - p", "+ q", "the force `p` does not change its gap"),
        (
            "\"x\": \"v\",",
            "\"x\": \"v + p\",",
            "the velocity of the gap depends on a force",
        ),
        ("bound: \"F\"", "bound: \"F - 1\"", "the bound is -0.5"),
        (
            "bound: \"F\"",
            "bound: \"F\", static: \"F/2\"",
            "the static bound 0.25 is less",
        ),
        (
            "bound: \"F\"",
            "bound: \"F*p\"",
            "whose friction is not modelled",
        ),
        ("\"e\": 0.5", "\"e\": -0.5", "the restitution is -0.5"),
        (
            "restitution: \"e\"",
            "restitution: \"e + 2*F\"",
            "the restitution is 1.5",
        ),
        ("+ q - p", "+ 1/q - p", "does not stand linearly here"),
        (
            "Stop(gap: \"d - x\", restitution: \"e\")",
            "Spring(gap: \"d - x\", stiffness: \"-F\")",
            "the stiffness is -0.5: it must not be negative",
        ),
        (
            "Stop(gap: \"d - x\", restitution: \"e\")",
            "Spring(gap: \"d - x\", stiffness: \"1\", damping: \"-F\")",
            "the damping is -0.5",
        ),
        (
            "Friction(slip: \"v\", bound: \"F\")",
            "Jenkins(slip: \"v\", stiffness: \"-1\", bound: \"F\")",
            "the stiffness is -1",
        ),
        ("slip: \"v\"", "slip: \"v + q\"", "`q` is no state"),
        (
            "\"q\": Friction",
            "\"F\": Friction",
            "`F` cannot be a name here",
        ),
        (
            "forward.open",
            "forward",
            "`forward` is no mode of the contacts",
        ),
        (
            "forward.open",
            "backward.open",
            "`backward.open` contradicts the state",
        ),
        ("forward.open", "forward.closed", "by the contact `p`"),
        (
            "rates: {",
            "modes: {}, sliding: {\"s\": (\"a\", \"b\")}, rates: {",
            "`sliding` has no meaning",
        ),
    ] {
        assert!(whole.contains(old), "{old}");
        let error = parse_any(&whole.replacen(old, new, 1), "bad").unwrap_err();
        assert!(error.to_string().contains(told), "{new}: {error}");
    }
}

/// An element that never slips is a spring, whose offset against the mass is that of the start: x'' + cx' + (1 + k)x = a cos φ,
/// multipliers e^(λT) with λ² + cλ + 1 + k = 0 and 1 for the offset. Slip begins at both bounds at once where the amplitude
/// is B/k, at two frequencies, ka = B|1 + k - w² + icw|.
#[test]
fn an_element_that_never_slips_keeps_its_offset() {
    let text = r#"(states: ["x", "v"], parameters: {"a": 0.5, "w": 0.9, "c": 0.05, "k": 0.8, "B": 0.3}, forcing: "w",
        contacts: {"q": Jenkins(slip: "v", stiffness: "k", bound: "B")},
        rates: {"x": "v", "v": "a*cos(phase) - x - c*v + q"})"#;
    let from: From = ("stick", &[0.0, 0.1, 0.0], 100.0);
    let along = ("w", (0.5, 2.0));
    let (orbit, point) = started(&system(text), from, along).unwrap();
    let (a, c, k, bound): (f64, f64, f64, f64) = (0.5, 0.05, 0.8, 0.3);
    // (1 + k - s)² + c²s = (ka/B)² for s = w²
    let (sum, product) = (
        2.0 * (1.0 + k) - c * c,
        (1.0 + k).powi(2) - (k * a / bound).powi(2),
    );
    let root = (sum * sum / 4.0 - product).sqrt();
    for (up, square) in [(true, sum / 2.0 + root), (false, sum / 2.0 - root)] {
        let (seen, all) = follow(&orbit, &point, up, along.1, 4000);
        let [onset, end] = &seen[..] else {
            panic!("{} events", seen.len());
        };
        // states to 1e-15, and a square root that opens there
        assert!((onset.value - square.sqrt()).abs() <= 1e-13);
        assert_eq!((onset.kind, end.kind), (GR, EP));
        assert_eq!(all[all.len() - 1].orbit.sequence.switches(), 0);
    }
    let text = text.replace("\"w\": 0.9", "\"w\": 0.6");
    let (orbit, point) = started(&system(&text), from, along).unwrap();
    let multipliers = orbit.multipliers(&point).unwrap();
    let period = std::f64::consts::TAU / 0.6;
    let turn = (1.0 + k - c * c / 4.0).sqrt() * period;
    let size = (-c / 2.0 * period).exp();
    assert_eq!(multipliers.len(), 3);
    assert!(multipliers[0].trivial && multipliers[0].value.re == 1.0);
    let pair = &multipliers[1].value;
    assert!((pair.re - size * turn.cos()).abs() < 1e-13);
    assert!((pair.im.abs() - size * turn.sin().abs()).abs() < 1e-13);
}

/// Two blocks that stick together, one on the ground and one at a damper, are one with both: their slips are two states, and
/// change in one instant.
#[test]
fn blocks_that_stick_together_are_one() {
    let parameters = r#"parameters: {"w": 1.2, "k": 0.8, "B": 0.15, "F": 0.2}, forcing: "w""#;
    let two = format!(
        r#"(states: ["x", "v", "y", "u"], {parameters},
        contacts: {{"j": Friction(slip: "u - v", bound: "100"), "q": Friction(slip: "v", bound: "F"),
            "r": Jenkins(slip: "u", stiffness: "k", bound: "B")}},
        rates: {{"x": "v", "v": "(cos(phase) - 0.1*v - x + q - j)/0.6", "y": "u", "u": "(r + j)/0.4"}})"#
    );
    let one = format!(
        r#"(states: ["x", "v"], {parameters},
        contacts: {{"q": Friction(slip: "v", bound: "F"), "r": Jenkins(slip: "v", stiffness: "k", bound: "B")}},
        rates: {{"x": "v", "v": "cos(phase) - 0.1*v - x + q + r"}})"#
    );
    let along = ("w", (0.5, 1.4));
    let of_two: From = ("stick.forward.stick", &[0.0, 0.5, 0.3, 0.5, 0.0], 100.0);
    let of_one: From = ("forward.stick", &[0.0, 0.5, 0.0], 100.0);
    let (seen, other) = (met(&two, of_two, along), met(&one, of_one, along));
    assert_eq!(seen.len(), other.len());
    for (seen, other) in seen.iter().zip(&other) {
        assert_eq!(seen.kind, other.kind);
        // states to 1e-14, multiplied by conditions of events of less than 100
        assert!((seen.value - other.value).abs() <= 1e-12);
    }
}

/// A block that friction holds for ever stays where it was, and its neighbour moves about what that makes of it.
#[test]
fn a_block_that_never_slips_stays_where_it_was() {
    let text = r#"(states: ["x", "v", "y", "u"], parameters: {"w": 0.7, "k": 0.5, "F": 3.0}, forcing: "w",
        contacts: {"q": Friction(slip: "v", bound: "F"), "s": Spring(gap: "2 - y", stiffness: "k")},
        rates: {"x": "v", "v": "-x - k*(x - y) + q", "y": "u", "u": "cos(phase) - y - k*(y - x) - 0.1*u - s"})"#;
    let from: From = ("stick.open", &[0.8, 0.0, 0.0, 0.0], 200.0);
    let (orbit, point) = started(&system(text), from, ("w", (0.6, 0.9))).unwrap();
    let (seen, all) = follow(&orbit, &point, true, (0.6, 0.9), 2000);
    assert!(seen.iter().all(|one| one.kind == EP));
    for found in &all {
        let zones = found.orbit.at(&found.node.point).unwrap().zones;
        let [x, v] = [0, 1].map(|state| zones[0].state[state]);
        assert!((x - 0.8).abs() < 1e-15 && v.abs() < 1e-15, "{x} {v}");
    }
    let multipliers = orbit.multipliers(&point).unwrap();
    let trivial = multipliers.iter().filter(|one| one.trivial);
    let values: Vec<f64> = trivial.map(|one| one.value.re).collect();
    assert_eq!(values, [1.0, 0.0]);
}

/// Painlevé's rod in one point: with much friction a force that opens the gap closes it by the friction that it causes.
#[test]
fn a_paradox_is_told() {
    let text = r#"(states: ["x", "v", "y", "u"], parameters: {"mu": 0.5},
        contacts: {"p": Stop(gap: "y", restitution: "0"), "q": Friction(slip: "v", bound: "mu*p")},
        rates: {"x": "v", "v": "q + 2*p", "y": "u", "u": "p + 1.5*q - 1"})"#;
    let own = system(text);
    let closed = own.mode("closed.forward").unwrap();
    let index = own.source.parameters.index("mu").unwrap();
    for (mu, told) in [(0.5, false), (0.7, true)] {
        let mut values = own.values();
        values[index] = mu;
        let at = own.at(&values, &[]).unwrap();
        // ÿ = p(1 - 1.5 mu) - 1 with forward slip
        assert_eq!(at.modes[closed].obstruction.is_some(), told, "{mu}");
    }
}

/// Two masses, the first between two stops: a closed branch, of which every event comes once. All zones are of one mode, and the
/// changes on the way lead back to the sequence with another zone as the first.
#[test]
fn a_closed_branch_ends_where_it_began() {
    const STOPS: &str = r#"(
        states: ["x1", "v1", "x2", "v2"],
        parameters: {"A": 1.016, "w": 1.468, "k": 0.775, "c": 0.093, "d": 0.814, "e": 0.739},
        forcing: "w",
        contacts: {"p": Stop(gap: "d - x1", restitution: "e"), "p2": Stop(gap: "x1 + 1.4*d", restitution: "e")},
        rates: {
            "x1": "v1", "v1": "A*cos(phase) - x1 - k*(x1 - x2) - c*v1 - p + p2",
            "x2": "v2", "v2": "-x2 - k*(x2 - x1) - c*v2",
        },
    )"#;
    let range = (0.88, 2.2);
    let mut wanted = Wanted::new(system(STOPS), "w", range).unwrap();
    wanted.periods = 6;
    let beginning = Beginning {
        mode: wanted.system.mode("open.open").unwrap(),
        state: vec![0.0, 0.1, 0.0, 0.0],
        phase: 0.0,
    };
    let (orbit, point) = first(&wanted, &beginning, Search::Settles(400.0)).unwrap();
    let (seen, all) = follow(&orbit, &point, true, range, 2000);
    let last = seen.last().unwrap();
    assert_eq!((last.kind, last.value), (EP, 1.468), "{} points", all.len());
    let of = |one: &LocatedPoint<AffineOrbit>| one.orbit.cycle(&one.node.point).unwrap();
    let (begun, ended) = (orbit.cycle(&point).unwrap(), of(all.last().unwrap()));
    assert_eq!(begun.names, ended.names);
    for (one, other) in begun.switches.iter().zip(&ended.switches) {
        assert!((one - other).abs() < 1e-9, "{one} and {other}");
    }
    let (events, mut values) = (&seen[..seen.len() - 1], Vec::new());
    for Seen { kind, value, what } in events {
        let known = |before: &f64| (before - value).abs() < 1e-9;
        assert!(!values.iter().any(known), "{kind} at {value} again: {what}");
        values.push(*value);
    }
    assert!(events.len() > 8, "{} events", events.len());
}

/// A mass with friction grazes a stop at which it turns: its slip is the rate of the gap, and which of the two is located first
/// is rounding. The event is the graze, in steps of any length, in either order of the states and in any units.
#[test]
fn a_graze_is_no_end_of_a_slip() {
    const STOPPED: &str = r#"(
        states: ["x", "v"], parameters: {"A": 2.0, "w": 0.6, "F": 0.5, "c": 0.03, "d": 3.0, "e": 0.6}, forcing: "w",
        contacts: {
            "q": Friction(slip: "v", bound: "F", static: "1.3*F"),
            "p": Stop(gap: "d - x", restitution: "e"),
        },
        rates: {"x": "v", "v": "A*cos(phase) - x - c*v + q - p"},
    )"#;
    let turned = STOPPED.replace(r#"["x", "v"]"#, r#"["v", "x"]"#).replace(
        r#""x": "v", "v": "A*cos(phase) - x - c*v + q - p""#,
        r#""v": "A*cos(phase) - x - c*v + q - p", "x": "v""#,
    );
    let scaled = STOPPED.replace("d - x", "1000*d - x").replace(
        "A*cos(phase) - x - c*v + q - p",
        "1000*(A*cos(phase) + q - p) - x - c*v",
    );
    let variants: [(&str, &[f64]); 3] = [
        (STOPPED, &[0.0, 0.1]),
        (&turned, &[0.1, 0.0]),
        (&scaled, &[0.0, 100.0]),
    ];
    for (text, state) in variants {
        for range in [(0.6, 3.5), (1.85, 2.1)] {
            let seen = met(text, ("forward.open", state, 100.0), ("A", range));
            let graze = seen
                .iter()
                .find(|one| (one.value - 1.964517885341).abs() < 1e-11);
            let graze = graze.unwrap_or_else(|| panic!("{range:?} of {text}"));
            assert_eq!(graze.kind, GR, "{range:?} of {text}: {}", graze.what);
        }
    }
}

/// A block falls on another that lies on a table: the impulse presses that one on the table in the same instant. The motion ends at
/// √2, when it has fallen by 1, and says on what; so does a branch of orbits of the first on a spring, where it grazes the second.
#[test]
fn an_impact_that_presses_on_a_closed_stop_is_refused() {
    let text = |x: &str, y: &str| {
        format!(
            r#"(states: ["x", "v", "y", "u"], parameters: {{"A": 0.3, "w": 0.7, "e": 0.3, "h": 1.0}}, forcing: "w",
            contacts: {{"p1": Stop(gap: "y", restitution: "0"), "p2": Stop(gap: "{x}", restitution: "e")}},
            rates: {{"x": "v", "v": "{y}", "y": "u", "u": "-2 + p1 - p2"}})"#
        )
    };
    let pressed = ContactMistake::Pressed {
        impact: "p2".to_owned(),
        closed: "p1".to_owned(),
    };
    let falls = system(&text("x - y", "-1 + p2"));
    let at = falls.at(&falls.values(), &[]).unwrap();
    for (mode, y) in [("closed.open", 0.0), ("open.open", 0.2)] {
        let begin = place(&falls, mode, &[1.0, 0.0, y, 0.0], 0.0);
        let mut motion = Motion::new(&at, begin, 5.0);
        let halt = halt(&mut motion, 5.0);
        let Halt::Refused { time, mistake, .. } = halt else {
            panic!("{halt}");
        };
        assert!((time - 2.0_f64.sqrt()).abs() < 1e-14, "{time}");
        assert_eq!(*mistake, pressed);
    }
    // it leaves the table instead where the impulse opens that gap
    let opens = text("x + y - 0.1", "-1 + p2").replace("p1 - p2", "p1 + p2");
    let opens = system(&opens);
    let at = opens.at(&opens.values(), &[]).unwrap();
    let begin = place(&opens, "closed.open", &[1.0, 0.0, 0.0, 0.0], 0.0);
    let mut motion = Motion::new(&at, begin, 5.0);
    let Step::Switched(switching) = motion.step(5.0).unwrap() else {
        panic!("no impact");
    };
    assert_eq!(opens.mode_name(switching.to), "open.open");
    // x has the amplitude h at a graze
    let hangs = text("x - y + h", "A*cos(phase) - x - 0.1*v + p2");
    let range = ("A", (0.3, 1.0));
    let from: From = ("closed.open", &[0.0; 4], 100.0);
    let (orbit, point) = started(&system(&hangs), from, range).unwrap();
    let (seen, _) = follow(&orbit, &point, true, range.1, 2000);
    let graze = (1.0_f64 - 0.7 * 0.7).hypot(0.1 * 0.7);
    assert_eq!(seen[0].kind, GR, "{}", seen[0].what);
    assert!((seen[0].value - graze).abs() < 1e-12, "{}", seen[0].value);
}

/// A mass rests at one of two stops, and another that nothing joins to it goes on switching: its switches are those that it has alone.
#[test]
fn a_mass_that_rests_leaves_the_switches_of_another() {
    for bound in ["B", "B*(1 + 0.3*exp(-abs(u)))"] {
        let friction = format!(r#""q": Friction(slip: "u", bound: "{bound}")"#);
        let own = r#""y": "u", "u": "A*sin(phase) - 0.5*y - 0.1*u + q""#;
        let given =
            r#"parameters: {"A": 1.2, "w": 0.9, "d": 0.3, "e": 0.0, "B": 0.2}, forcing: "w""#;
        let alone = format!(
            r#"(states: ["y", "u"], {}, contacts: {{{friction}}}, rates: {{{own}}})"#,
            given.replace(r#""d": 0.3, "e": 0.0, "#, "")
        );
        let both = format!(
            r#"(states: ["x", "v", "y", "u"], {given}, contacts: {{"p1": Stop(gap: "d + x", restitution: "e"),
            "p2": Stop(gap: "d - x", restitution: "e"), {friction}}},
            rates: {{"x": "v", "v": "A*cos(phase) - x - 0.1*v + p1 - p2", {own}}})"#
        );
        let switches = |text: &str, mode: &str, state: &[f64]| {
            let system = system(text);
            let at = system.at(&system.values(), &[]).unwrap();
            let mut motion = Motion::new(&at, place(&system, mode, state, 0.0), 7.0);
            let mut times = Vec::new();
            while let Step::Switched(one) = motion.step(40.0).unwrap() {
                let last =
                    |mode: usize| system.mode_name(mode).rsplit('.').next().map(str::to_owned);
                if last(one.from) != last(one.to) {
                    times.push(one.time);
                }
            }
            times
        };
        let one = switches(&alone, "forward", &[0.0, 0.2]);
        let other = switches(&both, "open.open.forward", &[0.0, 0.1, 0.0, 0.2]);
        assert!(
            one.len() > 10 && one.len() == other.len(),
            "{one:?} {other:?}"
        );
        for (one, other) in one.iter().zip(&other) {
            assert!((one - other).abs() < 1e-11, "{bound}: {one} {other}");
        }
    }
}

/// A bound by the force of another friction is a number in each of its slips. Where that is negative the motion ends: at the instant
/// at which the other, which nothing of it acts on, begins to slip forward.
#[test]
fn a_bound_that_another_friction_makes_negative_is_told() {
    let own = r#""x": "v", "v": "a*cos(phase) - x - 0.1*v + q""#;
    let given = r#"parameters: {"a": 1.0, "F": 0.3}, forcing: "1.3""#;
    let friction = r#""q": Friction(slip: "v", bound: "F")"#;
    let alone = system(&format!(
        r#"(states: ["x", "v"], {given}, contacts: {{{friction}}}, rates: {{{own}}})"#
    ));
    let both = system(&format!(
        r#"(states: ["x", "v", "y", "u"], {given}, contacts: {{{friction}, "q2": Friction(slip: "u", bound: "0.5*q")}},
        rates: {{{own}, "y": "u", "u": "-2*y - 0.1*u + q2"}})"#
    ));
    let [one, other] = [&alone, &both].map(|system| system.at(&system.values(), &[]).unwrap());
    let begin = place(&alone, "backward", &[0.5, -0.5], 2.0);
    let mut motion = Motion::new(&one, begin, 5.0);
    let begins = loop {
        let Step::Switched(switching) = motion.step(20.0).unwrap() else {
            panic!("no slip forward");
        };
        if switching.to == alone.mode("forward").unwrap() {
            break switching.time;
        }
    };
    let begin = place(&both, "backward.forward", &[0.5, -0.5, 0.0, 0.1], 2.0);
    let mut motion = Motion::new(&other, begin, 5.0);
    let halt = halt(&mut motion, 20.0);
    let Halt::NegativeBound { time, value, .. } = halt else {
        panic!("{halt}");
    };
    assert!((time - begins).abs() < 1e-12, "{time} {begins}");
    assert!((value + 0.15).abs() < 1e-12, "{value}");
}

/// A mass with a Jenkins element comes to an inelastic stop at the bound of the element, rests there and leaves to the other side, where
/// the element holds at once: the durations of the zones are those of an integration with events, in either order of the contacts.
#[test]
fn a_slider_holds_where_its_mass_leaves_a_stop() {
    let text = |contacts: &str| {
        format!(
            r#"(states: ["x", "v"], parameters: {{"A": 1.0, "w": 0.8, "kj": 0.8, "B": 0.2, "d": 0.5, "e": 0.0}}, forcing: "w",
            contacts: {{{contacts}}}, rates: {{"x": "v", "v": "A*cos(phase) - x - 0.1*v + q - p"}})"#
        )
    };
    let element = r#""q": Jenkins(slip: "v", stiffness: "kj", bound: "B")"#;
    let stop = r#""p": Stop(gap: "d - x", restitution: "e")"#;
    // from an impact on: it leaves, slips backward, holds, slips forward, and comes back
    let times = [
        14.9893089547,
        16.7022118057,
        18.5071162376,
        20.8219071118,
        21.7385839755,
    ];
    for (contacts, mode, turned) in [
        (format!("{element}, {stop}"), "stick.open", false),
        (format!("{stop}, {element}"), "open.stick", true),
    ] {
        let from: From = (mode, &[0.0, 0.1, 0.0], 100.0);
        let (orbit, point) = started(&system(&text(&contacts)), from, ("A", (0.9, 1.1))).unwrap();
        let cycle = orbit.cycle(&point).unwrap();
        let names = cycle.names.iter().map(|name| match name.split_once('.') {
            Some((one, other)) if turned => format!("{other}.{one}"),
            _ => name.clone(),
        });
        let names: Vec<String> = names.collect();
        let first = names
            .iter()
            .position(|name| name == "forward.closed")
            .unwrap();
        for (zone, name) in [
            "forward.closed",
            "stick.open",
            "backward.open",
            "stick.open",
            "forward.open",
        ]
        .iter()
        .enumerate()
        {
            let at = (first + zone) % 5;
            assert_eq!(names[at], *name);
            let begun = (cycle.switches[at] - cycle.switches[first]).rem_euclid(cycle.period);
            let expected = times[zone] - times[0];
            assert!(
                (begun - expected).abs() < 1e-9,
                "{name}: {begun} {expected} {:?}",
                cycle.switches
            );
        }
    }
}

/// A mass leaves a stop with its Jenkins element at the bound, and comes back without a slip: the element is at the bound and the gap is
/// closed in one instant, always. It rests whatever comes first by rounding, and leaves once a period from then on.
#[test]
fn a_slider_at_its_bound_rests_at_a_stop() {
    let text = r#"(states: ["x", "v"],
        parameters: {"m": 1.4, "k": 1.6, "c": 0.217, "A": 1.57, "w": 0.44, "kj": 0.89, "B": 0.09, "d": 0.84, "e": 0.0}, forcing: "w",
        contacts: {"q": Jenkins(slip: "v", stiffness: "kj", bound: "B"), "p": Stop(gap: "d + x", restitution: "e")},
        rates: {"x": "v", "v": "(A*cos(phase) - k*x - c*v + q + p)/m"})"#;
    let system = system(text);
    let at = system.at(&system.values(), &[]).unwrap();
    let mut motion = Motion::new(
        &at,
        place(&system, "stick.open", &[-0.06, 0.44, 0.0], 0.0),
        14.0,
    );
    let mut leaves = Vec::new();
    while let Step::Switched(one) = motion.step(400.0).unwrap() {
        let closed = |mode: usize| system.mode_name(mode).ends_with("closed");
        if closed(one.from) && !closed(one.to) {
            leaves.push(one.time);
        }
    }
    let period = std::f64::consts::TAU / 0.44;
    assert_eq!(leaves.len(), 28);
    for pair in leaves[1..].windows(2) {
        assert!((pair[1] - pair[0] - period).abs() < 1e-11, "{pair:?}");
    }
}

/// The same with impacts: they come to an end in `stick.closed`, at rest to rounding, and each of them is one switch, since the impact takes
/// back what would turn the slider. An orbit and its events are the same in any order of the two.
#[test]
fn a_slider_at_its_bound_bounces_off_a_stop() {
    let slider = r#""j": Jenkins(slip: "v", stiffness: "3", bound: "B")"#;
    let stop = r#""p": Stop(gap: "0.4 - x", restitution: "e")"#;
    let system = |contacts: [&str; 2]| {
        format!(
            r#"(states: ["x", "v"], parameters: {{"A": 2.2, "w": 1.3, "B": 0.25, "e": 0.6}}, forcing: "w",
            contacts: {{{}}}, rates: {{"x": "v", "v": "A*sin(phase) + 1.0 - 0.2*v - x + j - p"}})"#,
            contacts.join(", ")
        )
    };
    for (e, contacts) in [(0.6, [slider, stop]), (0.3, [stop, slider])] {
        let system = self::system(&system(contacts));
        let mut values = system.values();
        (values[0], values[3]) = (0.6, e);
        let at = system.at(&values, &[]).unwrap();
        let name = if contacts[0] == slider {
            "stick.open"
        } else {
            "open.stick"
        };
        let mut motion = Motion::new(&at, place(&system, name, &[0.0, 0.1, 0.0], 0.0), 10.0);
        let mut rests = 0;
        while let Step::Switched(one) = motion.step(60.0).unwrap() {
            let to = system.mode_name(one.to);
            if to.contains("closed") {
                assert!(to.contains("stick"), "{to}");
                let [v, z] = [one.after[1], one.after[2]];
                assert!(
                    v.abs() <= 1e-29 && (z - 0.25 / 3.0).abs() <= 1e-15,
                    "{v} {z}"
                );
                rests += 1;
            }
        }
        assert!(rests > 3, "{rests}");
    }
    let branch = |contacts: [&str; 2], mode: &str| {
        let items = super::counts::rows(&format!(
            r#"(system: {}, orbit: (start: Simulate(mode: "{mode}", state: {{"x": 0.0, "v": 0.1}}, settle: 400), periods: 3),
            continuation: (parameter: "A", range: (2.1, 2.4), toward: Both), stability: (), output: (plots: []))"#,
            system(contacts)
        ));
        super::counts::events(&items, "A")
    };
    let one = branch([slider, stop], "stick.open");
    let other = branch([stop, slider], "open.stick");
    let kinds: Vec<EventType> = one.iter().map(|(kind, ..)| *kind).collect();
    assert_eq!(kinds, [EventType::PD, EventType::GR, EventType::GR]);
    assert_eq!(one.len(), other.len());
    for ((kind, value, _), (_, same, _)) in one.iter().zip(&other) {
        assert!((value - same).abs() <= 1e-12, "{kind} {value} {same}");
    }
}

/// Two masses that friction holds together are one of both, on a belt whose friction falls with the slip: the switches of a motion, the
/// period of its cycle and its multipliers are those of the one, with the offset that they have at the start.
#[test]
fn masses_held_together_are_one_under_a_falling_law() {
    let given = r#"parameters: {"k": 0.79, "h": 1.18, "F": 0.81, "D": 2.5, "vb": 0.06"#;
    let law = r#""f": Friction(slip: "v - vb", bound: "F/(1 + D*abs(v - vb))")"#;
    let two = system(&format!(
        r#"(states: ["x", "v", "y", "u"], {given}, "B": 0.97}},
        contacts: {{"q": Friction(slip: "v - u", bound: "B"), {law}}},
        rates: {{"x": "v", "v": "-k*x + q + f", "y": "u", "u": "-h*y - q"}})"#
    ));
    let one = system(&format!(
        r#"(states: ["x", "v"], {given}}}, contacts: {{{law}}},
        rates: {{"x": "v", "v": "(-k*x - h*(x - 0.05) + f)/2"}})"#
    ));
    let starts = [
        (&two, "stick.stick", vec![0.4, 0.06, 0.35, 0.06]),
        (&one, "stick", vec![0.4, 0.06]),
    ];
    let [held, alone] = starts.clone().map(|(system, mode, state)| {
        let at = system.at(&system.values(), &[]).unwrap();
        let mut motion = Motion::new(&at, place(system, mode, &state, 0.0), 10.0);
        let mut times = Vec::new();
        while let Step::Switched(one) = motion.step(60.0).unwrap() {
            times.push(one.time);
        }
        times
    });
    assert!(alone.len() > 10 && held.len() == alone.len(), "{held:?}");
    for (one, other) in held.iter().zip(&alone) {
        assert!((one - other).abs() < 1e-12, "{one} {other}");
    }
    let [held, alone] = starts.map(|(system, mode, state)| {
        let (orbit, point) = started(system, (mode, &state, 50.0), ("F", (0.75, 0.85))).unwrap();
        let (_, all) = follow(&orbit, &point, true, (0.75, 0.85), 500);
        let last = &all[all.len() - 1];
        let own = last.orbit.multipliers(&last.node.point).unwrap();
        let own: Vec<_> = own.into_iter().filter(|one| !one.trivial).collect();
        (last.orbit.cycle(&last.node.point).unwrap().period, own)
    });
    assert!(
        (held.0 / alone.0 - 1.0).abs() < 1e-12,
        "{} {}",
        held.0,
        alone.0
    );
    assert_eq!(held.1.len(), alone.1.len());
}

/// A Jenkins element that never slips is a spring, also where the law of another contact is not affine: the orbit is that beside a
/// spring, with a multiplier 1 that is trivial, and the element begins to slip where its force there has come to the bound.
#[test]
fn an_element_that_never_slips_beside_a_falling_law_is_a_spring() {
    let text = |states: &str, contact: &str, force: &str| {
        format!(
            r#"(states: [{states}], parameters: {{"A": 0.4, "F": 0.1, "D": 0.5, "kj": 0.8}}, forcing: "1.7",
            contacts: {{{contact}"q": Friction(slip: "v - 3", bound: "F/(1 + D*abs(v - 3))")}},
            rates: {{"x": "v", "v": "A*cos(phase) - x - 0.2*v {force} + q"}})"#
        )
    };
    let element = r#""j": Jenkins(slip: "v", stiffness: "kj", bound: "0.6"), "#;
    let both = [
        (
            text(r#""x", "v""#, element, "+ j"),
            "stick.backward",
            vec![0.0, 0.1, 0.0],
        ),
        (
            text(r#""x", "v""#, "", "- kj*x"),
            "backward",
            vec![0.0, 0.1],
        ),
    ];
    let range = (0.3, 1.2);
    let [element, spring] = both.map(|(text, mode, state)| {
        let (orbit, point) = started(&system(&text), (mode, &state, 300.0), ("A", range)).unwrap();
        let extremes = orbit.extremes(&point).unwrap();
        let (seen, _) = follow(&orbit, &point, true, range, 500);
        let multipliers = orbit.multipliers(&point).unwrap();
        (extremes, multipliers, seen, orbit, point)
    });
    for (one, other) in element.0.iter().zip(&spring.0) {
        assert!((one.0 - other.0).abs() < 1e-12 && (one.1 - other.1).abs() < 1e-12);
    }
    assert!(element.1[0].trivial && element.1[0].value.re == 1.0 && element.1.len() == 3);
    for (one, other) in element.1[1..].iter().zip(&spring.1) {
        assert!(
            (one.value - other.value).norm() < 1e-12,
            "{:?} {:?}",
            one.value,
            other.value
        );
    }
    // at the first event x comes to 0.75 beside the spring
    let onset = &element.2[0];
    assert_eq!(onset.kind, GR, "{}", onset.what);
    let at = |value: f64| {
        let (_, all) = follow(&spring.3, &spring.4, true, (0.3, value), 500);
        let last = &all[all.len() - 1];
        last.orbit.extremes(&last.node.point).unwrap()[0].1
    };
    assert!(
        (at(onset.value) - 0.75).abs() < 1e-11,
        "{}",
        at(onset.value)
    );
}

/// The graze of a damped spring, which opens by its force before its gap does: two zones vanish at once, like a square root. It is where the
/// amplitude of the free motion is the gap, A = d|1 - w² + 0.1iw|, from both sides, and the branch goes on in `open`.
#[test]
fn a_damped_spring_is_left_by_a_graze() {
    for (w, k, c) in [
        (0.7_f64, 10.0, 0.7),
        (0.5, 30.0, 2.0),
        (0.62, 3.0, 1.0),
        (1.4, 5.0, 0.3),
    ] {
        let graze = (1.0 - w * w).hypot(0.1 * w);
        let text = format!(
            r#"(states: ["x", "v"], parameters: {{"A": {:?}, "k": {k:?}, "c": {c:?}}}, forcing: "{w:?}",
            contacts: {{"p": Spring(gap: "1 - x", stiffness: "k", damping: "c")}},
            rates: {{"x": "v", "v": "A*cos(phase) - x - 0.1*v - p"}})"#,
            1.2 * graze
        );
        let range = (0.8 * graze, 1.2 * graze);
        let (orbit, point) =
            started(&system(&text), ("open", &[0.0, 0.1], 200.0), ("A", range)).unwrap();
        assert!(orbit.sequence.switches() > 0);
        let (seen, all) = follow(&orbit, &point, false, range, 2000);
        let at_graze = |seen: &[Seen], way: &str| {
            let list: Vec<String> = seen
                .iter()
                .map(|one| format!("{} {:?} {}", one.kind, one.value, one.what))
                .collect();
            let met = seen.iter().find(|one| (one.value - graze).abs() < 1e-12);
            assert!(
                met.is_some_and(|one| one.kind == GR),
                "{way} at w = {w}: {list:#?}"
            );
        };
        at_graze(&seen, "down");
        let last = &all[all.len() - 1];
        assert_eq!(last.orbit.sequence.switches(), 0, "w = {w}");
        let (seen, _) = follow(&last.orbit, &last.node.point, true, range, 2000);
        at_graze(&seen, "up");
    }
}

/// A guess beside an orbit along which an element only sticks slips a little, and an orbit that slips one way alone drifts: what is found is
/// the orbit within `stick` with the offset of the guess, of the amplitude a/|1 + k - w² + icw|.
#[test]
fn a_guess_that_slips_leads_to_the_orbit_that_sticks() {
    let text = r#"(states: ["x", "v"], parameters: {"a": 0.5, "w": 0.6, "c": 0.05, "k": 0.8, "B": 0.3}, forcing: "w",
        contacts: {"q": Jenkins(slip: "v", stiffness: "k", bound: "B")},
        rates: {"x": "v", "v": "a*cos(phase) - x - c*v + q"})"#;
    let wanted = Wanted::new(system(text), "w", (0.6, 0.601)).unwrap();
    let amplitude = 0.5 / (1.8_f64 - 0.36).hypot(0.05 * 0.6);
    for guess in [0.3, 0.32, 0.34] {
        let beginning = Beginning {
            mode: wanted.system.mode("stick").unwrap(),
            state: vec![guess, 0.0, guess],
            phase: 0.0,
        };
        let search = Search::Guess(std::f64::consts::TAU / 0.6);
        let (orbit, point) = first(&wanted, &beginning, search).unwrap();
        assert_eq!(orbit.cycle(&point).unwrap().names, ["stick"], "{guess}");
        let (low, high) = orbit.extremes(&point).unwrap()[0];
        assert!((high - amplitude).abs() < 1e-13, "{guess}: {high}");
        assert!((low + amplitude).abs() < 1e-13, "{guess}: {low}");
        let multipliers = orbit.multipliers(&point).unwrap();
        assert!(multipliers[0].trivial && multipliers[0].value.re == 1.0);
    }
}

/// Two blocks with friction on the ground and between them: two of the three slips give the third, and a mode in which two stick and it
/// slips has no chains of changes, of which there were thousands. Where the bounds do not fall, D = 0, switches are those of constant
/// bounds.
#[test]
fn three_slips_of_two_blocks() {
    let text = |fall: &str, given: &str| {
        let bound = |slip: &str| match fall {
            "" => "F".to_owned(),
            fall => format!("F/(1 + {fall}*abs({slip}))"),
        };
        let [q1, q2, q3] = ["v", "u", "v - u"].map(bound);
        format!(
            r#"(states: ["x", "v", "y", "u"], parameters: {{"A": 1.5, "w": 0.9, "F": 0.2{given}}}, forcing: "w",
            contacts: {{"q1": Friction(slip: "v", bound: "{q1}"), "q2": Friction(slip: "u", bound: "{q2}"),
            "q3": Friction(slip: "v - u", bound: "{q3}")}},
            rates: {{"x": "v", "v": "A*cos(phase) - x - 0.1*v + q1 + q3", "y": "u", "u": "-y - 0.1*u + q2 - q3"}})"#
        )
    };
    let falls = system(&text("D", r#", "D": 0.3"#));
    let at = falls.at(&falls.values(), &[]).unwrap();
    let exits = (0..at.modes.len()).map(|mode| {
        let guards = at.modes[mode].guards.iter();
        guards.map(|guard| guard.exits.len()).sum::<usize>()
    });
    let most = exits.max().unwrap();
    assert!(most < 100, "{most}");
    let switches = |system: &System| {
        let at = system.at(&system.values(), &[]).unwrap();
        let begin = place(
            system,
            "forward.forward.forward",
            &[0.0, 0.6, 0.0, 0.5],
            0.0,
        );
        let mut motion = Motion::new(&at, begin, 7.0);
        let mut all = Vec::new();
        while let Step::Switched(one) = motion.step(40.0).unwrap() {
            all.push((one.time, system.mode_name(one.to).into_owned()));
        }
        all
    };
    let level = switches(&system(&text("D", r#", "D": 0.0"#)));
    let constant = switches(&system(&text("", "")));
    assert!(
        constant.len() > 20 && level.len() == constant.len(),
        "{level:?}"
    );
    for (one, other) in level.iter().zip(&constant) {
        assert!(
            (one.0 - other.0).abs() < 1e-10 && one.1 == other.1,
            "{one:?} {other:?}"
        );
    }
}

/// Two laws on one slip end together, and which of the two guards is said to vanish makes no other sequence: a symmetric orbit goes on
/// where the friction begins to hold, or the last of three elements to slip. Seen from both sides the events are the same.
#[test]
fn two_laws_on_one_slip_end_together() {
    let friction = |a: f64| {
        format!(
            r#"(states: ["x", "v"], parameters: {{"A": {a:?}, "w": 0.7, "c": 0.3}}, forcing: "w",
            contacts: {{"a": Jenkins(slip: "v", stiffness: "1", bound: "0.2"), "b": Friction(slip: "v", bound: "0.1")}},
            rates: {{"x": "v", "v": "A*cos(phase) - 0.5*x - c*v + a + b"}})"#
        )
    };
    let three = |a: f64| {
        format!(
            r#"(states: ["x", "v"], parameters: {{"A": {a:?}, "w": 0.7, "c": 0.3}}, forcing: "w",
            contacts: {{"a": Jenkins(slip: "v", stiffness: "1", bound: "0.2"),
                "b": Jenkins(slip: "v", stiffness: "0.7", bound: "0.35"),
                "d": Jenkins(slip: "v", stiffness: "0.6", bound: "0.6")}},
            rates: {{"x": "v", "v": "A*cos(phase) - 0.5*x - c*v + a + b + d"}})"#
        )
    };
    let place = ("stick.forward", &[0.0, 0.3, 0.0][..]);
    let elements = ("stick.stick.stick", &[0.0, 0.3, 0.0, 0.0, 0.0][..]);
    for (text, (mode, state), range) in [
        (friction(0.4), place, (0.25, 0.4)),
        (three(1.3), elements, (1.2, 1.3)),
    ] {
        let (orbit, point) = started(&system(&text), (mode, state, 100.0), ("A", range)).unwrap();
        let (down, all) = follow(&orbit, &point, false, range, 2000);
        let last = &all[all.len() - 1];
        let (mut up, _) = follow(&last.orbit, &last.node.point, true, range, 2000);
        up.pop();
        up.reverse();
        let [down, up] = [&down[..down.len() - 1], &up[..]];
        assert_eq!(last.parameter, range.0);
        assert!(!down.is_empty() && down.len() == up.len());
        for (one, other) in down.iter().zip(up) {
            let kinds = [GR, SL, CO];
            assert!(kinds.contains(&one.kind) && kinds.contains(&other.kind));
            assert!((one.value - other.value).abs() <= 1e-12 * one.value);
        }
    }
}

/// A mass with dry friction that hits a stop without restitution: it sticks there as long as friction holds it, is pressed on the stop
/// by what friction does not hold, and leaves where its load drives it back.
const AT_A_STOP: &str = r#"(states: ["x", "v"], parameters: {"A": 1.5, "w": 0.7, "c": 0.3, "k": 1.0, "F": 0.2, "Fs": 0.2, "d": 1.0}, forcing: "w",
    contacts: {"q": Friction(slip: "v", bound: "F", static: "Fs"), "p": Stop(gap: "d - x", restitution: "0")},
    rates: {"x": "v", "v": "A*cos(phase) - k*x - c*v + q - p"})"#;

fn at_a_stop(values: &[(&str, f64)]) -> System {
    let mut text = AT_A_STOP.to_owned();
    for (name, value) in values {
        let known = system(AT_A_STOP).source.parameters.0;
        let before = known.iter().find(|(known, _)| known == name).unwrap().1;
        text = text.replace(
            &format!("\"{name}\": {before:?}"),
            &format!("\"{name}\": {value:?}"),
        );
    }
    system(&text)
}

/// Motions against an integration from switch to switch by DOP853 with a tolerance of 1e-12, which each impact begins anew.
#[test]
fn friction_holds_at_a_stop() {
    type Case<'a> = (&'a [(&'a str, f64)], [f64; 2]);
    let cases: [Case; 3] = [
        (&[("Fs", 0.9)], [-2.290_906_104_859, 0.481_436_305_708]),
        (
            &[("Fs", 0.9), ("A", 2.2)],
            [-3.279_427_190_522, 0.628_618_346_181],
        ),
        (
            &[("F", 0.6), ("Fs", 0.6), ("k", 0.2), ("d", 0.3)],
            [-2.030_147_539_989, -0.910_669_153_013],
        ),
    ];
    for (values, expected) in cases {
        let system = at_a_stop(values);
        let affine = at(&system, &[]);
        let mut motion = Motion::new(
            &affine,
            place(&system, "forward.open", &[0.0, 0.3], 0.0),
            10.0,
        );
        while motion.step(60.0).unwrap() != Step::Reached {}
        for (x, known) in motion.place().state.iter().zip(expected) {
            assert!((x - known).abs() <= 1e-10, "{values:?}: {x} {known}");
        }
    }
}

/// The branch goes on through the graze of the stop, where it is met at the turn of the mass, and is the same on the way back; a mass
/// that is pressed on the stop is a zone of its own.
#[test]
fn a_branch_passes_the_graze_of_a_stop_without_restitution() {
    let seen = |values: &[(&str, f64)], range: (f64, f64)| {
        let system = at_a_stop(values);
        let from: From = ("forward.open", &[0.0, 0.3], 100.0);
        let (orbit, point) = started(&system, from, ("A", range)).unwrap();
        let both = [true, false].map(|up| follow(&orbit, &point, up, range, 2000).0);
        let mut all: Vec<Seen> = both
            .into_iter()
            .flatten()
            .filter(|one| one.kind != EP)
            .collect();
        all.sort_by(|one, other| one.value.total_cmp(&other.value));
        all
    };
    let (far, range) = (("d", 2.2), (1.2, 1.6));
    let [below, above] = [1.25, 1.5].map(|a| seen(&[far, ("A", a)], range));
    for all in [&below, &above] {
        meets(all, &[(GR, 1.322_745_880_098_59)]);
        assert_eq!(all.len(), 2);
        assert_eq!(all[1].kind, PD);
    }
    assert!((below[1].value - above[1].value).abs() <= 1e-12);
    let pressed = [("F", 0.6), ("Fs", 0.6), ("k", 0.2), ("d", 0.3)];
    let all = seen(&pressed, (0.9, 1.6));
    let names: Vec<&str> = all.iter().map(|one| one.what.as_str()).collect();
    assert!(
        all.len() == 2 && all.iter().all(|one| one.kind == SL),
        "{names:?}"
    );
    assert!(
        names.iter().any(|name| name.contains("forward.closed")),
        "{names:?}"
    );
}

/// Laws make no sense beyond a stiffness or a bound of zero and a restitution of 1, and do so there: a branch whose range ends
/// there comes to that end.
#[test]
fn a_range_may_end_where_a_law_does() {
    let spring = r#"Spring(gap: "0.4 - x", stiffness: "k", damping: "cd")"#;
    let stop = r#"Stop(gap: "0.4 - x", restitution: "e")"#;
    let friction = r#"Friction(slip: "v", bound: "mu")"#;
    let cases = [
        (spring, "open", "k", 0.0_f64),
        (friction, "forward", "mu", 0.0),
        (stop, "open", "e", 1.0),
    ];
    for (law, mode, parameter, edge) in cases {
        let sign = if law == friction { "+" } else { "-" };
        let text = format!(
            r#"(states: ["x", "v"], parameters: {{"k": 0.5, "cd": 0.6, "mu": 0.2, "e": 0.6}}, forcing: "0.7",
            contacts: {{"p": {law}}}, rates: {{"x": "v", "v": "cos(phase) - 0.3*v - x {sign} p"}})"#
        );
        let (orbit, point) = settled(&text, &[], parameter, mode, &[0.0, 0.1], 200.0);
        let up = edge > 0.5;
        let (seen, all) = follow(&orbit, &point, up, (0.0, f64::max(edge, 0.7)), 2000);
        let last = seen.last().unwrap();
        assert_eq!(
            (last.kind, last.value),
            (EP, edge),
            "{parameter}: {} points",
            all.len()
        );
    }
}
