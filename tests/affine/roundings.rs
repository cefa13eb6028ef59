//! What is zero but for rounding decides nothing: which state a contact takes, whether a motion has returned, what is kept, and whether a zone is
//! there.

use brakewave::EventType;
use brakewave::affine::motion::{Motion, Step};
use brakewave::affine::orbit::AffineOrbit;
use brakewave::affine::orbit::start::Search;
use brakewave::linalg::Vector;
use brakewave::orbit::Zones;

use super::branches::{Seen, begun, follow, started};
use super::systems::{at, place, system};
use EventType::{EP, GR};

/// The events of a branch both ways, its ends left out.
fn met((orbit, point): &(AffineOrbit, Vector), range: (f64, f64)) -> Vec<Seen> {
    let both = [true, false].map(|up| follow(orbit, point, up, range, 2000).0);
    let all = both.into_iter().flatten();
    all.filter(|one| one.kind != EP).collect()
}

/// Friction and an inelastic stop on a mass of which all loads are multiples: it moves as one of mass 1 does. After the impact nothing is left of
/// the velocity, and of its rate where the stop presses, whatever the quotients of masses are in doubles.
#[test]
fn a_mass_in_other_units_stops_alike() {
    let end = |mass: f64| {
        let text = format!(
            r#"(states: ["x", "v"], parameters: {{"m": {mass:?}}}, forcing: "1",
            contacts: {{"q": Friction(slip: "v", bound: "0.4*m"), "p": Stop(gap: "0.3 - x", restitution: "0")}},
            rates: {{"x": "v", "v": "(m*(1.5*cos(phase) - 0.1*v - 0.3*x) + q - p)/m"}})"#
        );
        let system = system(&text);
        let affine = at(&system, &[]);
        let begin = place(&system, "forward.open", &[0.0, 0.5], 0.0);
        let mut motion = Motion::new(&affine, begin, 10.0);
        while motion.step(12.0).unwrap() != Step::Reached {}
        motion.place().state.clone()
    };
    let known = end(1.0);
    for k in 0..40 {
        let mass = 0.5 + 0.0137 * f64::from(k);
        for (x, known) in end(mass).iter().zip(&known) {
            assert!((x - known).abs() <= 1e-12, "{mass}: {x} {known}");
        }
    }
}

/// Two blocks that stick to one another for ever, and at times to a belt, are one: what they keep is the same, whatever holds them, and
/// however their masses divide.
#[test]
fn blocks_that_stick_to_one_another_and_to_a_belt_are_one() {
    let two = r#"(states: ["x", "v", "y", "u"], parameters: {"A": 0.814, "w": 1.731, "vb": 0.429, "F": 0.396}, forcing: "w",
        contacts: {"q": Friction(slip: "u - vb", bound: "F"), "j": Friction(slip: "v - u", bound: "100")},
        rates: {"x": "v", "v": "(-1.899*x - 0.223*v - 0.908*(x - y) + 0.464 + j)/0.656",
            "y": "u", "u": "(A*cos(phase) - 0.231*u - 0.908*(y - x) + q - j)/0.645"})"#;
    let one = r#"(states: ["x", "v"], parameters: {"A": 0.814, "w": 1.731, "vb": 0.429, "F": 0.396}, forcing: "w",
        contacts: {"q": Friction(slip: "v - vb", bound: "F")},
        rates: {"x": "v", "v": "(-1.899*x - 0.454*v + 0.464 + A*cos(phase) + q)/1.301"})"#;
    let along = ("w", (1.0, 2.5));
    let of_two = started(
        two,
        ("backward.stick", &[-0.442, 0.3, 0.279, 0.3], 0.0),
        along,
        200.0,
    );
    let of_one = started(one, ("backward", &[-0.442, 0.3], 0.0), along, 200.0);
    let [of_two, of_one] = [of_two, of_one].map(|found| met(&found.unwrap(), along.1));
    assert!(!of_one.is_empty());
    assert_eq!(of_two.len(), of_one.len(), "{:?}", of_two.len());
    for (seen, other) in of_two.iter().zip(&of_one) {
        assert_eq!(seen.kind, other.kind);
        // states to 1e-14, multiplied by conditions of events of less than 100
        assert!(
            (seen.value - other.value).abs() <= 1e-12,
            "{} {}",
            seen.value,
            other.value
        );
    }
}

/// A mass on springs, one to a block that friction holds, comes to rest: its velocity is rounding, of which a return is no better, and the orbit of
/// the others is there.
#[test]
fn the_velocity_of_what_rests_is_no_reason_to_wait() {
    let text = r#"(states: ["x", "v", "y", "u", "z", "r"], parameters: {"A": 0.875, "d": 1.277}, forcing: "1.475",
        contacts: {"q": Friction(slip: "u", bound: "0.637"), "p": Stop(gap: "d - x", restitution: "0")},
        rates: {"x": "v", "v": "(-1.386*x - 0.174*v - 0.624*(x - y) + 1.1*sin(phase) + 0.268 - p)/0.966",
            "y": "u", "u": "(0.2*A*cos(phase) - 0.2*y - 0.296*u - 0.404*(y - z) + q)/1.69",
            "z": "r", "r": "(-0.695*z - 0.238*r - 0.404*(z - y))/1.03"})"#;
    let state = |velocity: f64| {
        let [y, z] = [
            0.078_158_758_736_907_17,
            0.404 / 1.099 * 0.078_158_758_736_907_17,
        ];
        [-0.967_142_186_936_840_8, -0.225, y, 0.0, z, velocity]
    };
    let along = ("d", (0.9, 1.5));
    let periods = [0.0, -1.623_239_953_303_286_4e-17].map(|velocity| {
        let from = ("stick.open", &state(velocity)[..], 5.885_603_199_942_874);
        let found = started(text, from, along, 400.0);
        let (orbit, point) = found.unwrap_or_else(|reason| panic!("{velocity:e}: {reason}"));
        let zones = orbit.at(&point).unwrap().zones;
        zones.iter().map(|zone| zone.duration).sum::<f64>()
    });
    assert!((periods[0] - periods[1]).abs() <= 1e-14 * periods[0]);
}

/// A slider that gives one way only has moved after a period: no orbit has a zone of that. Where its bound is touched the branch ends,
/// also where it began with an orbit that just touches it; a zone of 1e-7 with what rounding leaves of its equation is none.
#[test]
fn no_slider_gives_one_way_only() {
    let text = r#"(states: ["x", "v", "y", "u"], parameters: {"A": 0.802}, forcing: "0.831",
        contacts: {"q": Friction(slip: "v", bound: "0.566", static: "0.932"), "r": Friction(slip: "u", bound: "0.109"),
            "j": Jenkins(slip: "u - v", stiffness: "1.912", bound: "0.528")},
        rates: {"x": "v", "v": "(-1.49*x - 0.181*v - 1.502*(x - y) - 0.076*(v - u) + q - j)/1.499",
            "y": "u", "u": "(A*cos(phase) - 1.29*y - 0.233*u - 1.502*(y - x) - 0.076*(u - v) + r + j)/1.199"})"#;
    let range = (0.7, 0.9);
    let from = (
        "forward.backward.stick",
        &[-0.358, 0.138, -0.698, -0.163, 0.0][..],
        0.0,
    );
    let (orbit, point) = started(text, from, ("A", range), 200.0).unwrap();
    for up in [true, false] {
        let (seen, all) = follow(&orbit, &point, up, range, 2000);
        for found in &all {
            let zones = found.orbit.signature().to_string();
            let gives = |way: &str| zones.split('-').any(|zone| zone.ends_with(way));
            assert_eq!(gives(".forward"), gives(".backward"), "{zones}");
        }
        let last = seen.last().unwrap();
        assert_eq!(last.kind, GR, "{}", last.what);
    }
}

/// A slip that is nothing beside what its rate makes of it in the time of the forcing is none: a state of a profile is one of its mode.
/// One of a thousandth is a slip.
#[test]
fn a_slip_of_rounding_sticks() {
    let text = r#"(states: ["x", "v"], parameters: {"F": 0.5}, forcing: "1.2",
        contacts: {"q": Friction(slip: "v", bound: "F")}, rates: {"x": "v", "v": "cos(phase) - x + q"})"#;
    let system = system(text);
    let affine = at(&system, &[]);
    let mode = |slip: f64| {
        let place = place(&system, "stick", &[0.3, slip], 1.0);
        let fits = system.fitting(&affine, place).unwrap().mode;
        system.mode_name(fits).into_owned()
    };
    for slip in [0.0, 2.6e-30, -1e-16] {
        assert_eq!(mode(slip), "stick", "{slip:e}");
    }
    assert_eq!(mode(1e-3), "forward");
    assert_eq!(mode(-1e-3), "backward");
}

/// A state that others cancel in, to zero but for rounding all along a cycle, has for its unit what they would make of it: at a = 0 its
/// multiplier e^{aT} passes 1, whatever the radius of the cycle. Nor does it tell when the cycle has come back.
#[test]
fn a_state_that_is_zero_on_a_cycle_has_a_unit() {
    for radius in [1.0, 32.0, 1024.0, 1e6] {
        let text = format!(
            r#"(states: ["x", "y", "z"], parameters: {{"a": -0.25, "R": {radius:?}}},
            define: {{"u": "x/R", "v": "y/R", "q": "1 - u^2 - v^2"}}, modes: {{"flow": (rates: {{
                "x": "R*(u*q - 1.75*v)", "y": "R*(v*q + 1.75*u)", "z": "a*z + R*u*q"}})}})"#
        );
        let along = ("a", (-0.3, 0.3));
        for search in [Search::Guess(3.59), Search::Settles(50.0)] {
            let cycle = begun(&text, ("flow", &[radius, 0.0, 0.0], 0.0), along, search).unwrap();
            let period = cycle.0.cycle(&cycle.1).unwrap().period;
            assert!(
                (period - std::f64::consts::TAU / 1.75).abs() <= 1e-12,
                "{radius}: {period}"
            );
            let events = met(&cycle, along.1);
            let kinds: Vec<EventType> = events.iter().map(|event| event.kind).collect();
            assert_eq!(kinds, [EventType::BP], "{radius}");
            assert!(events[0].value.abs() <= 1e-14, "{}", events[0].value);
        }
    }
}
