//! How multipliers pass the unit circle: slowly, flat, in opposite directions, as a Jordan block; and what is said of it in other
//! units. Everything here has a closed form.

use std::f64::consts::PI;
use std::fs;

use brakewave::EventType::{self, BP, GR, NS, PD};
use brakewave::affine::orbit::Multiplier;
use brakewave::affine::orbit::SlidingBifurcation;
use brakewave::hybrid::{Note, OrbitEvent, OrbitItem};
use brakewave::orbit::Stability;
use brakewave::orbit::special::Close;

use super::counts::{events, has_no_silent_change, problem, rows, rows_and_notes};
use super::rests::{Course, meets, number};

/// States that a clock resets at every tick, by these expressions: multipliers are what these multiply by.
fn ticks(resets: &[&str]) -> String {
    let names: Vec<String> = (0..resets.len()).map(|index| format!("x{index}")).collect();
    let quoted: Vec<String> = names.iter().map(|name| format!("\"{name}\"")).collect();
    let each = |of: &dyn Fn(usize) -> String| -> String { (0..names.len()).map(of).collect() };
    format!(
        r#"(
        states: ["s", {}],
        parameters: {{"a": 0.7}},
        modes: {{"m": (
            rates: {{"s": "1"{}}},
            until: [(zero: "1 - s", to: "m", reset: {{"s": "0"{}}})],
        )}},
    )"#,
        quoted.join(", "),
        each(&|index| format!(", \"{}\": \"0\"", names[index])),
        each(&|index| format!(", \"{}\": \"{}\"", names[index], resets[index])),
    )
}

fn of_ticks(resets: &[&str]) -> (Vec<OrbitItem>, Vec<Note>) {
    let states: String = (0..resets.len())
        .map(|index| format!(", \"x{index}\": 0.0"))
        .collect();
    let orbit = format!(r#"(start: Given(mode: "m", state: {{"s": 0.0{states}}}, period: 1.0))"#);
    let continuation = r#"(parameter: "a", range: (0.3, 2.0), toward: Up)"#;
    rows_and_notes(&problem(&ticks(resets), &orbit, continuation))
}

fn found(items: &[OrbitItem], kind: EventType) -> Vec<&OrbitEvent> {
    let all = items.iter().filter_map(|item| item.event.as_ref());
    all.filter(|event| event.kind == kind).collect()
}

/// The value of a parameter at an event.
fn value(event: &OrbitEvent, parameter: &str) -> f64 {
    let mut parameters = event.parameters.iter();
    parameters.find(|(name, _)| name == parameter).unwrap().1
}

/// One multiplier that leaves the circle and another that enters it within a step, at 1 and a little beyond: their product has one
/// sign at both ends, and their number is one.
#[test]
fn one_leaves_and_another_enters_within_a_step() {
    for (kind, sign) in [(PD, "-"), (BP, "")] {
        for apart in [3e-3, 1e-4, 1e-7] {
            let other = format!("{sign}(1.5 - 0.5*a + 0.5*{apart:e})*x1");
            let (items, _) = of_ticks(&[&format!("{sign}a*x0"), &other]);
            let seen = events(&items, "a");
            let places: Vec<f64> = seen.iter().map(|(_, a, _)| *a).collect();
            assert!(seen.iter().all(|(seen, ..)| *seen == kind), "{seen:?}");
            assert_eq!(places.len(), 2, "{seen:?}");
            for (event, expected) in found(&items, kind).iter().zip([1.0, 1.0 + apart]) {
                let off = (value(event, "a") - expected).abs();
                assert!(off <= event.uncertainty && off < 1e-12, "{off:e}");
            }
            has_no_silent_change(&items, "one in, one out");
        }
    }
}

/// At one value no orbit beside it tells that one leaves as the other enters: the point says what is not decided there.
#[test]
fn one_that_leaves_as_another_enters_is_not_passed_in_silence() {
    let (items, notes) = of_ticks(&["-a*x0", "-(1.5 - 0.5*a)*x1"]);
    assert!(events(&items, "a").is_empty());
    let [Note::Close { value, what, .. }] = &notes[..] else {
        panic!("{notes:?}");
    };
    assert!(*what == Close::Circle && (1.0..1.02).contains(value));
}

/// Three maps, each coupled to the others: the multiplier a + 3/20 of what is across their mean is double, and where it passes 1 the
/// equations of an orbit lose two ranks.
#[test]
fn multipliers_that_a_symmetry_makes_pass_at_once_hold_what_is_true() {
    let cell = |own: usize| {
        let [one, other] = [(own + 1) % 3, (own + 2) % 3];
        let off = format!("(x{own} - 0.3)");
        format!("0.3 + a*{off} - 0.05*(x{one} + x{other} - 2*x{own}) + {off}^2 - {off}^3")
    };
    let cells = [0, 1, 2].map(cell);
    let (items, _) = of_ticks(&cells.each_ref().map(String::as_str));
    let special = |item: &&OrbitItem| item.point.kind == Some(BP);
    let item = items.iter().find(special).unwrap();
    let event = item.event.as_ref().unwrap();
    let off = (value(event, "a") - 0.85).abs();
    assert!(
        off <= event.uncertainty && event.uncertainty < 1e-12,
        "{event:?}"
    );
    let passes = |one: &&Multiplier| !one.trivial && (one.value - 1.0).norm() <= one.error;
    let passing = item.point.multipliers.iter().filter(passes);
    assert_eq!(passing.count(), 2, "{:?}", item.point.multipliers);
}

/// Where a multiplier passes slowly its rounding moves the place by that over its speed; where it passes flat, by a root.
#[test]
fn the_error_of_a_place_knows_how_fast_a_multiplier_passes() {
    let turned = |by: &str| {
        [
            format!("{by}*(cos(1.0)*x0 - sin(1.0)*x1)"),
            format!("{by}*(sin(1.0)*x0 + cos(1.0)*x1)"),
        ]
    };
    let [x, y] = turned("(1 + (a - 1)*1e-6)");
    let cases: [(EventType, Vec<&str>, f64); 6] = [
        (PD, vec!["(-1 - (a - 1)*1e-3)*x0"], 1e-10),
        (PD, vec!["(-1 - (a - 1)*1e-6)*x0"], 1e-6),
        (PD, vec!["(-1 - (a - 1)^3)*x0"], 1e-3),
        (NS, vec![&x, &y], 1e-6),
        (BP, vec!["(1 + (a - 1)*1e-3)*x0"], 1e-11),
        (BP, vec!["(1 + (a - 1)*1e-6)*x0"], 1e-8),
    ];
    for (kind, resets, most) in cases {
        let (items, _) = of_ticks(&resets);
        let [event] = found(&items, kind)[..] else {
            panic!("{resets:?}: {:?}", events(&items, "a"));
        };
        let (off, told) = ((value(event, "a") - 1.0).abs(), event.uncertainty);
        assert!(
            off <= told && told < most,
            "{resets:?}: {off:e}, told {told:e}"
        );
    }
}

/// The real part p³ of a pair is less than its rounding where |p| < 1e-5, also for the equations of a Hopf point.
#[test]
fn the_error_of_a_hopf_point_knows_how_flat_a_pair_passes() {
    let course = Course {
        system: r#"(states: ["x", "y"], parameters: {"p": -0.7}, modes: {"m": (rates: {
            "x": "p^3*x - y - x*(x^2 + y^2)", "y": "x + p^3*y - y*(x^2 + y^2)"})})"#,
        mode: "m",
        state: &[0.0; 2],
        parameter: "p",
        range: (-1.0, 1.3),
    };
    let all = course.events();
    let [hopf] = &all[..] else {
        panic!("{all:?}");
    };
    assert_eq!(hopf.kind, EventType::HB);
    let off = number(hopf, "p").abs();
    assert!(
        off <= hopf.uncertainty && hopf.uncertainty < 1e-4,
        "{hopf:?}"
    );
}

/// Half a period of rotation by π and half a period of shear, both damped: the monodromy matrix is −e^(−2πc/w)(1, π/w; 0, 1), a double
/// multiplier with one vector, and what is off the diagonal of half a turn is rounding.
#[test]
fn a_double_multiplier_with_one_vector_is_known_to_a_root() {
    const SHEAR: &str = r#"(
        states: ["x", "v"],
        parameters: {"A": 1.0, "w": 1.0, "c": {c}},
        forcing: "w",
        modes: {
            "spring": (rates: {"x": "{u}*v - c*x", "v": "(A*cos(phase) - w^2*x)/{u} - c*v"}, until: [(zero: "sin(phase)", to: "free")]),
            "free": (rates: {"x": "{u}*v - c*x", "v": "A*cos(3*phase)/{u} - c*v"}, until: [(zero: "-sin(phase)", to: "spring")]),
        },
    )"#;
    let orbit = r#"(start: Given(mode: "spring", state: {"x": 0.0, "v": 0.0}, phase: 0.001))"#;
    let continuation = r#"(parameter: "A", range: (0.5, 1.5), toward: Both)"#;
    for (damping, c) in [("0.0", 0.0), ("4e-9", 4e-9), ("1e-3", 1e-3), ("0.1", 0.1)] {
        for unit in ["1.0", "1e3", "1e-6"] {
            let system = SHEAR.replace("{u}", unit).replace("{c}", damping);
            let items = rows(&problem(&system, orbit, continuation));
            assert!(
                events(&items, "A").is_empty(),
                "{c} {unit}: {:?}",
                events(&items, "A")
            );
            let expected = -(-2.0 * PI * c).exp();
            for item in &items {
                assert_eq!(item.point.multipliers.len(), 2);
                for one in &item.point.multipliers {
                    let off = (one.value - expected).norm();
                    // the root of a rounding, 6e-8, times what units leave of the coupling
                    assert!(off <= one.error && one.error < 1e-5, "{c} {unit}: {one:?}");
                }
                let told = (1.0 + expected) > item.point.multipliers[0].error.max(1e-9);
                let stable = match told {
                    true => Stability::Yes,
                    false => Stability::Undecided,
                };
                assert!(told || c < 1e-4);
                assert_eq!(item.point.stable, Some(stable), "{c} {unit}");
            }
        }
    }
}

/// Three cells on a ring, coupled alike: at p = 3/2 the double eigenvalue of what is across their mean passes zero, and no fold is there.
#[test]
fn a_double_eigenvalue_of_a_symmetry_passes_zero() {
    let cell = |own: &str, others: [&str; 2]| {
        let [one, other] = others;
        format!(r#""{own}": "p*{own} + 0.5*({one} + {other} - 2*{own}) - {own}^3""#)
    };
    let system = format!(
        r#"(states: ["x", "y", "z"], parameters: {{"p": -0.5}}, modes: {{"m": (rates: {{{}, {}, {}}})}})"#,
        cell("x", ["y", "z"]),
        cell("y", ["z", "x"]),
        cell("z", ["x", "y"])
    );
    let course = Course {
        system: &system,
        mode: "m",
        state: &[0.0; 3],
        parameter: "p",
        range: (-1.0, 3.0),
    };
    let all = course.events();
    meets(&all, BP, "p", 0.0, &[]);
    let [_, double] = &all[..] else {
        panic!("{all:?}");
    };
    let off = (number(double, "p") - 1.5).abs();
    assert_eq!(double.kind, BP);
    assert!(
        off <= double.uncertainty && double.uncertainty < 1e-10,
        "{double:?}"
    );
}

/// The one graze of a problem file of the project, and what it is where some texts of the file are replaced by others for each unit.
fn grazes_alike(
    (file, parameter): (&str, &str),
    units: &[&str],
    in_unit: impl Fn(&str) -> Vec<(&'static str, String)>,
) -> OrbitItem {
    let path = format!("{}/problems/{file}.ron", env!("CARGO_MANIFEST_DIR"));
    let plain = fs::read_to_string(path).unwrap();
    let graze = |text: &str| {
        let items = rows(text);
        let item = items
            .into_iter()
            .find(|item| found(std::slice::from_ref(item), GR).len() == 1);
        item.unwrap()
    };
    let expected = graze(&plain);
    for unit in units {
        let mut text = plain.clone();
        for (old, new) in in_unit(unit) {
            assert!(text.contains(old), "{old}");
            text = text.replace(old, &new);
        }
        let item = graze(&text);
        let [one, other] = [&item, &expected].map(|item| item.event.clone().unwrap());
        assert_eq!(one.what, other.what, "{unit}");
        let off = (value(&one, parameter) - value(&other, parameter)).abs();
        assert!(
            off <= one.uncertainty + other.uncertainty && one.uncertainty < 1e-11,
            "{one:?}"
        );
        let [own, others] = [&item, &expected].map(|item| &item.point.multipliers);
        assert_eq!(own.len(), others.len());
        for (one, other) in own.iter().zip(others) {
            assert!(
                (one.value - other.value).norm() <= 1e-9,
                "{unit}: {one:?} for {other:?}"
            );
        }
    }
    expected
}

/// At a graze of a damped spring two zones close at once, that of the contact and that in which the spring only relaxes behind it. The
/// first tells the event, and multipliers there are those of any unit.
#[test]
fn zones_that_close_at_one_instant_do_so_in_any_units() {
    let expected = grazes_alike(("gear_rattle", "w"), &["1e3", "1e6", "1e-3"], |unit| {
        vec![
            ("d - x", format!("d - x/{unit}")),
            ("x + d", format!("x/{unit} + d")),
            ("\"x\": \"v\", \"v\"", format!("\"x\": \"{unit}*v\", \"v\"")),
        ]
    });
    let what = expected.event.unwrap().what;
    assert!(what.contains("`open.closed`"), "{what}");
}

/// A block sticks for no time at all at a graze: in some units of its speed the guard falls at a rate of exactly zero there, and
/// what is divided by that vanishes with it.
#[test]
fn multipliers_of_a_zone_without_length_are_those_of_any_units() {
    let expected = grazes_alike(("brake_coupling", "mu"), &["1e3", "1e6", "1e-3"], |unit| {
        vec![
            ("\"v - vb\"", format!("\"v/{unit} - vb\"")),
            (
                "\"x\": \"v\", \"v\": \"-k1*x - kc*y - c*v + q\"",
                format!("\"x\": \"v/{unit}\", \"v\": \"{unit}*(-k1*x - kc*y - c*v/{unit} + q)\""),
            ),
        ]
    });
    let pair = expected
        .point
        .multipliers
        .iter()
        .filter(|one| one.value.im != 0.0);
    assert_eq!(pair.count(), 2);
}

/// Friction as a contact and as two modes with sliding between them: the same events have the same names.
#[test]
fn sliding_has_its_names_where_a_contact_makes_the_modes() {
    let file = |name: &str| {
        let path = format!("{}/problems/{name}.ron", env!("CARGO_MANIFEST_DIR"));
        rows(&fs::read_to_string(path).unwrap())
    };
    let names = |items: &[OrbitItem]| -> Vec<(EventType, Option<SlidingBifurcation>)> {
        let all = items.iter().filter_map(|item| item.event.as_ref());
        all.filter(|event| event.kind != EventType::EP)
            .map(|event| (event.kind, event.sliding))
            .collect()
    };
    let [contact, written] = ["contact_friction", "friction_oscillator"].map(file);
    assert_eq!(names(&contact), names(&written));
    let crossing = Some(SlidingBifurcation::Crossing);
    assert!(
        names(&contact)
            .iter()
            .any(|(_, sliding)| *sliding == crossing)
    );
}
