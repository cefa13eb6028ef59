//! Certificates of orbits of systems with contacts: the figures of the same systems with modes of their own, what the laws make an
//! event, and forged ones.

use std::fs;
use std::path::Path;

use tempfile::TempDir;

use super::orbits::{Row, VALUE, arcs, brakewave, certified, encloses};

/// A problem file of the repository without what it asks for beside the branch.
fn problem(name: &str) -> String {
    let problems = concat!(env!("CARGO_MANIFEST_DIR"), "/problems");
    let text = fs::read_to_string(format!("{problems}/{name}.ron")).unwrap();
    let (text, _) = text.split_once("    stability:").unwrap();
    let lines = text.lines().filter(|line| !line.contains("monitor:"));
    let kept: Vec<&str> = lines.collect();
    format!("{}\n    stability: (),\n)", kept.join("\n")).replace(", stop_at: [(\"hit\", 0.5)]", "")
}

/// Rows of a certificate in which everything is proven, and verified.
fn proven(text: &str, types: &str, options: &[&str]) -> Vec<Row> {
    let folder = TempDir::new().unwrap();
    let (code, rows) = certified(text, folder.path(), options);
    assert_eq!(code, Some(0), "{rows:?}");
    let found: Vec<&str> = rows.iter().map(|row| &*row["type"]).collect();
    assert_eq!(found, types.split(' ').collect::<Vec<_>>());
    assert!(verified(folder.path()).1.contains("verified"));
    rows
}

/// The code and the output of `--verify` on the certificate in a folder.
fn verified(folder: &Path) -> (Option<i32>, String) {
    let out = folder.join("out");
    let output = brakewave(&["certify", "--verify", out.to_str().unwrap()]);
    let told = [output.stdout, output.stderr].concat();
    (
        output.status.code(),
        String::from_utf8_lossy(&told).into_owned(),
    )
}

/// The figures of the systems with modes written by hand, of which those with contacts are copies: closed forms, and 20 digits of
/// another program.
#[test]
fn events_of_contacts_are_those_of_modes_by_hand() {
    let rows = proven(&problem("contact_friction"), "EP SL UZ EP", &[]);
    encloses(&rows[1], VALUE, 0.722_679_194_438_143_1, 1e-12);
    let rows = proven(&problem("contact_impact"), "EP LP GR EP", &[]);
    encloses(&rows[1], VALUE, 0.099_970_753_628_313_27, 1e-12);
    encloses(&rows[2], VALUE, 0.1, 1e-12);
    let rows = proven(&problem("contact_relay"), "EP SL EP", &[]);
    encloses(&rows[1], VALUE, 2.098_841_067_560_751, 1e-12);
    let rows = proven(&problem("contact_ball"), "EP LP EP EP PD EP", &[]);
    encloses(&rows[1], VALUE, std::f64::consts::FRAC_PI_3, 1e-12);
    encloses(&rows[4], VALUE, 1.526_823_700_519_061, 1e-12);
}

/// A ball without restitution rests and flies; damped springs on two sides; friction at rest above that of slip, where two blocks
/// change the order in which they do what they do; Jenkins elements, which do so in both halves of a symmetric orbit.
#[test]
fn every_law_is_proven() {
    proven(&problem("resting_ball"), "EP EP EP SL PD EP", &[]);
    let gear = problem("gear_rattle").replace("toward: Both", "toward: Up");
    proven(&gear, "EP LP LP PD GR EP", &[]);
    proven(&problem("two_blocks"), "EP CO EP EP EP", &[]);
    let blades = problem("blade_dampers").replace("(0.926, 1.058)", "(0.99, 1.058)");
    proven(&blades, "EP CO EP EP CO EP", &[]);
    // friction by the force of a spring that lifts off
    let brake =
        problem("brake_coupling").replace("(0.2, 0.7), toward: Both", "(0.25, 0.45), toward: Down");
    proven(&brake, "EP SL CO SL GR EP", &[]);
}

/// Friction under a force of three harmonics, without symmetry.
fn friction(range: &str) -> String {
    format!(
        r#"(
    system: (
        states: ["x", "v"],
        parameters: {{"w": 0.35, "F": 0.6, "z": 0.05, "b": 0.3}},
        forcing: "w",
        contacts: {{"q": Friction(slip: "v", bound: "F")}},
        rates: {{"x": "v", "v": "cos(phase) + b*cos(3*phase) + 0.15*cos(2*phase - 0.4) - 2*z*v - x + q"}},
    ),
    orbit: (start: Simulate(mode: "forward", state: {{"x": 0.0, "v": 0.5}}, settle: 100)),
    continuation: (parameter: "F", range: {range}, toward: Down),
    stability: (),
)"#
    )
}

/// A bound that is reached where stick begins is a condition of that switch, SL; one that is touched inside stick is a graze.
#[test]
fn a_bound_at_the_entry_of_stick_slides_and_one_inside_grazes() {
    let rows = proven(&friction("(0.528, 0.6)"), "EP SL GR EP", &[]);
    encloses(&rows[1], VALUE, 0.583_943_245_469_393, 1e-11);
    encloses(&rows[2], VALUE, 0.529_043_802_809_050, 1e-11);
}

/// From an end to the onset of sliding and beyond, to both sides of an event at which two blocks change their order.
#[test]
fn arcs_lead_through_changes_of_contacts() {
    let text = problem("contact_friction").replace("(0.2, 1.2)", "(0.7, 1.2)");
    let text = text.replace(", stop_at: [0.5]", "");
    let rows = proven(&text, "EP SL EP", &["--arcs"]);
    assert_eq!(arcs(&rows), [["EP", ""], ["SL", "yes"], ["EP", "yes"]]);
}

/// What is refused: a law, a bound, a restitution and a sign of the rates that are others, modes by other names and numbers, another
/// way on, and fewer inequalities than there are.
#[test]
fn forged_certificates_are_refused() {
    let folder = TempDir::new().unwrap();
    let (code, rows) = certified(&problem("contact_friction"), folder.path(), &[]);
    assert_eq!(code, Some(0), "{rows:?}");
    let [file, source] =
        ["certificate.ron", "source.ron"].map(|name| folder.path().join("out").join(name));
    let honest = fs::read_to_string(&file).unwrap();
    let written = fs::read_to_string(&source).unwrap();
    let stick = |of: &str| format!("mode: {of},");
    let (first, _) = honest.split_once("name: \"stick\"").unwrap();
    let at = first.rfind(&stick("2")).unwrap();
    let mode = |number: &str| {
        format!(
            "{}{}{}",
            &honest[..at],
            stick(number),
            &honest[at + stick("2").len()..]
        )
    };
    let renamed = |text: String, name: &str| {
        text.replacen("name: \"stick\"", &format!("name: \"{name}\""), 1)
    };
    let forged = [
        honest.replace("bound: \"F\"", "bound: \"z\""),
        honest.replace("- x + q", "- x - q"),
        honest.replace("slip: \"v\"", "slip: \"x\""),
        honest.replace("bound: \"F\"", "bound: \"F\", static: Some(\"2*F\")"),
        renamed(honest.clone(), "forward"),
        renamed(honest.clone(), "open"),
        renamed(mode("0"), "forward"),
        mode("3"),
        mode("18446744073709551615"),
        honest.replacen("exit: 1", "exit: 0", 1),
        honest.replacen("guard: 1", "guard: 2", 1),
        honest.replacen("inequalities: 8", "inequalities: 7", 1),
        honest.replacen("kind: SL", "kind: GR", 1),
        honest.replacen(
            "name: \"forward\"",
            "name: \"forward\", label: Some(\"q\")",
            1,
        ),
    ];
    for (number, text) in forged.iter().enumerate() {
        assert_ne!(*text, honest, "{number}");
        fs::write(&file, text).unwrap();
        let (code, told) = verified(folder.path());
        assert_ne!(code, Some(0), "{number}: {told}");
    }
    // beside a problem that is forged with it
    for (old, new) in [
        ("bound: \"F\"", "bound: \"1.01*F\""),
        ("- x + q", "- x - q"),
        ("- x + q", "- x + 1.1*q"),
        ("slip: \"v\"", "slip: \"-v\""),
    ] {
        for (path, text) in [(&file, &honest), (&source, &written)] {
            assert!(text.contains(old), "{old}");
            fs::write(path, text.replace(old, new)).unwrap();
        }
        let (code, told) = verified(folder.path());
        assert_ne!(code, Some(0), "{old}: {told}");
    }
}

/// A family of orbits at every value of the parameter, and rates that are not affine in the states, are not proven, and the reason is said.
#[test]
fn what_is_not_covered_is_said() {
    let folder = TempDir::new().unwrap();
    // of an element that never slips the offset is kept: its orbits are a family
    let element = r#"(
    system: (
        states: ["x", "v"],
        parameters: {"w": 0.5, "a": 0.1},
        forcing: "w",
        contacts: {"q": Jenkins(slip: "v", stiffness: "1", bound: "1"), "p": Stop(gap: "5 - x", restitution: "0.5")},
        rates: {"x": "v", "v": "a*cos(phase) - 0.2*v - x + q - p"},
    ),
    orbit: (start: Simulate(mode: "stick.open", state: {"x": 0.0, "v": 0.0}, settle: 100)),
    continuation: (parameter: "a", range: (0.05, 0.1), toward: Down),
    stability: (),
)"#;
    let (code, rows) = certified(element, folder.path(), &[]);
    assert_eq!(code, Some(1), "{rows:?}");
    assert!(rows.iter().all(|row| row["proven"] == "no"), "{rows:?}");
    // a spring that is not linear
    let folder = TempDir::new().unwrap();
    let cubic = problem("contact_impact").replace("- x - p", "- x - 0.01*x^3 - p");
    let cubic = cubic.replace("(0.05, 1.0)", "(0.9, 1.0)");
    let (code, rows) = certified(&cubic, folder.path(), &[]);
    assert_eq!(code, Some(1), "{rows:?}");
    let of_rate = |row: &Row| row["why"].contains("rates.v is not affine");
    assert!(rows.iter().all(of_rate), "{rows:?}");
}
