//! Certificates of orbits of systems, against figures of other origin and closed forms.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use brakewave::certify::orbit::{self, OrbitProof, SequenceOrbit};
use brakewave::certify::{Certificate, CertifiedPoint, ProofOutcome};
use brakewave::interval::Interval;
use brakewave::orbit::EventType;
use tempfile::TempDir;

use crate::certify::with_a_field_more;

pub fn brakewave(arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_brakewave"));
    command.args(arguments).output().unwrap()
}

/// A row of `certificates.csv` by its columns.
pub type Row = std::collections::HashMap<String, String>;

/// A problem file of the repository as far as its system, with another value in it.
fn system_of(name: &str, old: &str, new: &str) -> String {
    let problems = concat!(env!("CARGO_MANIFEST_DIR"), "/problems");
    let problem = fs::read_to_string(format!("{problems}/{name}.ron")).unwrap();
    let (system, _) = problem.split_once("    orbit:").unwrap();
    system.replace(old, new)
}

/// Certifies a problem into a folder.
pub fn certified(text: &str, folder: &Path, options: &[&str]) -> (Option<i32>, Vec<Row>) {
    let (file, out) = (folder.join("problem.ron"), folder.join("out"));
    fs::write(&file, text).unwrap();
    let [file, to] = [&file, &out].map(|path| path.to_str().unwrap());
    let run = brakewave(&[&["certify", file, "--out", to], options].concat());
    let table = out.join("certificates.csv");
    let mut reader = csv::Reader::from_path(table).unwrap_or_else(|_| panic!("{run:?}"));
    let rows = reader.deserialize().map(Result::unwrap).collect();
    (run.status.code(), rows)
}

/// That an interval of a row has a number of 20 digits, and is no wider than so many units of its last place.
pub fn encloses(row: &Row, columns: [&str; 2], value: f64, widest: f64) {
    let [low, high] = columns.map(|column| row[column].parse::<f64>().unwrap());
    assert!(low <= value && value <= high, "{row:?}: {value}");
    assert!(high - low <= widest * value.abs(), "{row:?}: {value}");
}

/// Types of the points, and whether the arc before each is proven.
pub fn arcs(rows: &[Row]) -> Vec<[&str; 2]> {
    rows.iter()
        .map(|row| [&*row["type"], &*row["arc"]])
        .collect()
}

pub const VALUE: [&str; 2] = ["low", "high"];

fn oscillator(values: &str, rest: &str) -> String {
    format!(
        r#"(
    system: (
        states: ["x", "v"],
        parameters: {{{values}}},
        forcing: "w",
        modes: {{"free": (
            rates: {{"x": "v", "v": "A*cos(phase) - c*v - x"}},
            until: [(zero: "d - x", to: "free", reset: {{"v": "-e*v"}})],
        )}},
    ),
    {rest}
    stability: (),
)"#
    )
}

/// Fold and graze of the COCO demo `impact`: the fold with 20 digits, the graze at the amplitude of resonance.
#[test]
fn fold_and_graze_of_an_impact_oscillator() {
    let folder = TempDir::new().unwrap();
    let text = oscillator(
        r#""c": 0.1, "A": 0.12, "w": 1.0, "d": 1.0, "e": 0.8"#,
        r#"orbit: (start: Given(mode: "free", state: {"x": 1.0, "v": -0.08}, phase: 1.03)),
    continuation: (parameter: "A", range: (0.05, 0.12), toward: Down),"#,
    );
    let (code, rows) = certified(&text, folder.path(), &[]);
    let types: Vec<&str> = rows.iter().map(|row| &*row["type"]).collect();
    assert_eq!(types, ["EP", "LP", "GR", "EP"]);
    assert_eq!(code, Some(0), "{rows:?}");
    encloses(&rows[1], VALUE, 0.099_970_753_628_313_27, 1e-12);
    encloses(&rows[2], VALUE, 0.1, 1e-12);
    for row in &rows {
        let period = std::f64::consts::TAU;
        encloses(row, ["period_low", "period_high"], period, 1e-12);
    }
    // beyond the graze a linear oscillator with damping, whose orbit is stable
    assert_eq!(rows[3]["outside"], "0");

    // as it is written it holds; otherwise it does not
    let out = folder.path().join("out");
    let (folder, file) = (out.to_str().unwrap(), out.join("certificate.ron"));
    let verified = brakewave(&["certify", "--verify", folder]);
    assert_eq!(verified.status.code(), Some(0), "{verified:?}");
    let honest = fs::read_to_string(&file).unwrap();
    for (old, new) in [
        ("kind: GR", "kind: CO"),
        ("kind: LP", "kind: PD"),
        ("condition: Fold", "condition: Doubling"),
        ("\"d - x\"", "\"d + x\""),
        ("low: 0.0999707536", "low: 0.0999707537"),
        ("outside: Some(0)", "outside: Some(1)"),
    ] {
        assert!(honest.contains(old), "{old}");
        fs::write(&file, honest.replace(old, new)).unwrap();
        let refused = brakewave(&["certify", "--verify", folder]);
        assert_eq!(refused.status.code(), Some(1), "{old}: {refused:?}");
        let told = String::from_utf8_lossy(&refused.stdout).into_owned();
        assert!(told.contains("refused"), "{old}: {told}");
    }
    // no part of it has a field that says more
    let parts = with_a_field_more(&honest);
    for (first, forged) in &parts {
        fs::write(&file, forged).unwrap();
        let refused = brakewave(&["certify", "--verify", folder]);
        assert_ne!(refused.status.code(), Some(0), "{first}: {refused:?}");
    }
    assert!(parts.len() > 8, "{:?}", parts.keys());
}

/// What is proven of a graze does not depend on the unit of a state: formulas tell that the speed is zero where the guard is
/// stationary, whatever number stands before it.
#[test]
fn a_graze_in_any_unit_of_the_velocity() {
    let folder = TempDir::new().unwrap();
    for (unit, speed) in [("1.0", -0.08), ("0.1", -0.8), ("2/3", -0.12)] {
        let text = oscillator(
            r#""c": 0.1, "A": 0.12, "w": 1.0, "d": 1.0, "e": 0.8"#,
            &format!(
                r#"orbit: (start: Given(mode: "free", state: {{"x": 1.0, "v": {speed}}}, phase: 1.03)),
    continuation: (parameter: "A", range: (0.09, 0.12), toward: Down, stop_after: [(event: GR, count: 1)]),"#
            ),
        );
        let scaled = text
            .replace(r#""x": "v""#, &format!(r#""x": "{unit}*v""#))
            .replace(
                "A*cos(phase) - c*v - x",
                &format!("(A*cos(phase) - c*{unit}*v - x)/({unit})"),
            );
        let (code, rows) = certified(&scaled, folder.path(), &["--force"]);
        let types: Vec<&str> = rows.iter().map(|row| &*row["type"]).collect();
        assert_eq!(types, ["EP", "LP", "GR"], "{unit}");
        assert_eq!(code, Some(0), "{unit}: {rows:?}");
        encloses(&rows[2], VALUE, 0.1, 1e-12);
    }
}

/// Between the events of the impact oscillator there is no other, from the fold on both sides, and none beyond the graze, where
/// nothing switches any more. A certificate from which the fold is left out, a fold between two points, and
/// another orbit beyond the graze are refused.
#[test]
fn arcs_to_both_sides_of_a_fold() {
    let folder = TempDir::new().unwrap();
    let text = oscillator(
        r#""c": 0.1, "A": 0.12, "w": 1.0, "d": 1.0, "e": 0.8"#,
        r#"orbit: (start: Given(mode: "free", state: {"x": 1.0, "v": -0.08}, phase: 1.03)),
    continuation: (parameter: "A", range: (0.05, 0.12), toward: Down),"#,
    );
    let (code, rows) = certified(&text, folder.path(), &["--arcs"]);
    let expected = [["EP", ""], ["LP", "yes"], ["GR", "yes"], ["EP", "yes"]];
    assert_eq!(arcs(&rows), expected, "{rows:?}");
    assert_eq!(code, Some(0), "{rows:?}");
    let file = folder.path().join("out/certificate.ron");
    let honest = fs::read_to_string(&file).unwrap();
    let points: Vec<&str> = honest.split_inclusive("\n        ),\n").collect();
    assert_eq!(points.len(), 5);
    assert!(points[1].contains("kind: LP"));
    let (point, beyond) = points[2].split_once("seen: [").unwrap();
    let (near, other) = beyond.split_once("parameter: 0.").unwrap();
    let other = honest.replace(
        points[2],
        &format!("{point}seen: [{near}parameter: 0.2{other}"),
    );
    assert_ne!(other, honest);
    for (text, code) in [
        (honest.clone(), 0),
        (honest.replace(points[1], ""), 1),
        (other, 1),
    ] {
        fs::write(&file, text).unwrap();
        let verified = brakewave(&["certify", "--verify", file.to_str().unwrap()]);
        assert_eq!(verified.status.code(), Some(code), "{verified:?}");
    }
}

/// A spring that is met at x = d with a preload: beyond the graze a zone opens that begins and ends where its guard is zero. The
/// graze is where resonance without the spring has the amplitude d: (1 − w²)² + c²w² = (A/d)². Before it nothing switches.
#[test]
fn a_zone_that_begins_and_ends_where_its_guard_is_zero() {
    let folder = TempDir::new().unwrap();
    let text = r#"(
    system: (
        states: ["x", "v"], parameters: {"c": 0.05, "k": 6.5, "A": 0.6, "w": 1.7, "d": 0.35, "f": 0.2}, forcing: "w",
        modes: {
            "soft": (rates: {"x": "v", "v": "A*cos(phase) - c*v - x"}, until: [(zero: "d - x", to: "hard")]),
            "hard": (rates: {"x": "v", "v": "A*cos(phase) - c*v - x - k*(x - d) - f"}, until: [(zero: "x - d", to: "soft")]),
        },
    ),
    orbit: (start: Given(mode: "soft", state: {"x": -0.31682, "v": 0.024223}, phase: 0.0)),
    continuation: (parameter: "w", range: (1.6, 1.7), toward: Down), stability: (),
)"#;
    let (code, rows) = certified(text, folder.path(), &["--arcs"]);
    let expected = [["EP", ""], ["GR", "yes"], ["LP", "yes"], ["EP", "yes"]];
    assert_eq!(arcs(&rows), expected, "{rows:?}");
    assert_eq!(code, Some(0), "{rows:?}");
    let (less, ratio): (f64, f64) = (2.0 - 0.05 * 0.05, 0.6 / 0.35);
    let squared = 0.5 * (less + (less * less - 4.0 * (1.0 - ratio * ratio)).sqrt());
    let [low, high] = VALUE.map(|column| rows[1][column].parse::<f64>().unwrap());
    assert!((0.5 * (low + high) - squared.sqrt()).abs() < 1e-13);
    let file = folder.path().join("out/certificate.ron");
    let honest = fs::read_to_string(&file).unwrap();
    // the orbit beyond as that of another value, and without it
    let (point, beyond) = honest.split_once("seen: [").unwrap();
    let other = beyond.replacen("parameter: 1.6469", "parameter: 1.6479", 1);
    assert_ne!(other, beyond);
    for (text, code) in [(honest.clone(), 0), (format!("{point}seen: [{other}"), 1)] {
        fs::write(&file, text).unwrap();
        let verified = brakewave(&["certify", "--verify", file.to_str().unwrap()]);
        assert_eq!(verified.status.code(), Some(code), "{verified:?}");
    }
}

/// Friction of another level each way. Stick sets in where the velocity comes to rest inside slip: the time of it grows like the root
/// of the distance, so that the parameter is stationary where the arc beyond begins.
#[test]
fn stick_that_sets_in_at_a_graze() {
    let folder = TempDir::new().unwrap();
    let text = r#"(
    system: (
        states: ["x", "v"], parameters: {"w": 0.55, "F": 0.45, "G": 0.6, "z": 0.07, "B": 0.3}, forcing: "w",
        define: {"rest": "cos(phase) + B*cos(2*phase) - 2*z*v - x"},
        modes: {
            "forth": (rates: {"x": "v", "v": "rest - F"}, until: [(zero: "v", to: "back")]),
            "back": (rates: {"x": "v", "v": "rest + G"}, until: [(zero: "-v", to: "forth")]),
        },
        sliding: {"stick": ("forth", "back")},
    ),
    orbit: (start: Simulate(mode: "forth", state: {"x": 0.0, "v": 0.5}, settle: 200)),
    continuation: (parameter: "w", range: (0.5375, 0.55), toward: Down), stability: (),
)"#;
    let (code, rows) = certified(text, folder.path(), &["--arcs"]);
    let expected = [["EP", ""], ["GR", "yes"], ["SL", "yes"], ["EP", "yes"]];
    assert_eq!(arcs(&rows), expected, "{rows:?}");
    assert_eq!(code, Some(0), "{rows:?}");
    let out = folder.path().join("out");
    let verified = brakewave(&["certify", "--verify", out.to_str().unwrap()]);
    assert_eq!(verified.status.code(), Some(0), "{verified:?}");
}

/// Period doubling and inner graze with 20 digits.
#[test]
fn doubling_and_inner_graze() {
    let folder = TempDir::new().unwrap();
    let text = oscillator(
        r#""c": 0.1, "A": 0.6, "w": 0.8, "d": 1.0, "e": 0.8"#,
        r#"orbit: (start: Given(mode: "free", state: {"x": 1.0, "v": -0.5}, phase: 0.0)),
    continuation: (parameter: "A", range: (0.5, 2.1), toward: Both, stop_after: [(event: GR, count: 1)]),"#,
    );
    let (_, rows) = certified(&text, folder.path(), &[]);
    let found = |kind: &str| rows.iter().find(|row| row["type"] == kind).unwrap();
    encloses(found("PD"), VALUE, 0.518_209_866_597_872_6, 1e-11);
    encloses(found("GR"), VALUE, 2.090_283_359_201_795_1, 1e-11);
    assert_eq!(found("PD")["proven"], "yes");
    assert_eq!(found("GR")["proven"], "yes");
}

/// The certificate in a folder of the symmetric orbit of Chua's circuit through three regions, y being counted from elsewhere in the
/// system: it loses its symmetry where the multiplier of its half is −1, with 20 digits.
fn loss_of_symmetry(system: &str, y: f64, folder: &Path) -> String {
    let text = format!(
        r#"{system}    orbit: (start: Given(mode: "upper", state: {{"x": 1.0, "y": {y:?}, "z": -0.8123}}, period: 4.6152)),
    continuation: (parameter: "alpha", range: (13.7, 13.74), toward: Down, stop_after: [(event: BP, count: 1)]),
    stability: (),
)"#
    );
    let (code, rows) = certified(&text, folder, &[]);
    assert_eq!(code, Some(0), "{rows:?}");
    assert_eq!(rows[1]["type"], "BP", "{rows:?}");
    encloses(&rows[1], VALUE, 13.728_817_274_033_318, 1e-10);
    fs::read_to_string(folder.join("out/certificate.ron")).unwrap()
}

/// That a certificate in a folder, in which one text stands for another, is verified with this exit code.
fn verifies(folder: &Path, honest: &str, (old, new): (&str, &str), code: i32) {
    assert!(honest.contains(old), "{old}: {honest}");
    let file = folder.join("out/certificate.ron");
    fs::write(&file, honest.replace(old, new)).unwrap();
    let verified = brakewave(&["certify", "--verify", file.to_str().unwrap()]);
    assert_eq!(verified.status.code(), Some(code), "{new}: {verified:?}");
}

/// That the half of the orbit doubles is not that it doubles.
#[test]
fn symmetry_is_lost() {
    let folder = TempDir::new().unwrap();
    let system = system_of("chua", "\"alpha\": 7.5", "\"alpha\": 13.74");
    let honest = loss_of_symmetry(&system, 0.0937, folder.path());
    for (old, new, code) in [
        ("kind: BP", "kind: BP", 0),
        ("kind: BP", "kind: PD", 1),
        ("condition: Branching", "condition: Doubling", 1),
        ("\"x - 1\"", "\"x - 1.001\"", 1),
    ] {
        verifies(folder.path(), &honest, (old, new), code);
    }
}

/// The same where a state is counted from elsewhere: the centre of the symmetry is not the origin then. What is proven is the same, and
/// an orbit whose system is symmetric around another point is refused.
#[test]
fn symmetry_is_lost_around_another_centre() {
    let folder = TempDir::new().unwrap();
    let system = system_of("chua", "\"alpha\": 7.5", "\"alpha\": 13.74")
        .replace("(y - ", "((y - 0.25) - ")
        .replace("x - y", "x - (y - 0.25)")
        .replace("-beta*y", "-beta*(y - 0.25)");
    let honest = loss_of_symmetry(&system, 0.3437, folder.path());
    let old = "-beta*(y - 0.25)";
    for (new, code) in [(old, 0), ("-beta*(y - 0.2501)", 1)] {
        verifies(folder.path(), &honest, (old, new), code);
    }
}

/// Without damping the free oscillator has multipliers e^{±iT}: the pair crosses at c = 0, T = 2π/w.
#[test]
fn a_pair_on_the_circle() {
    let folder = TempDir::new().unwrap();
    let text = oscillator(
        r#""c": 0.1, "A": 0.5, "w": 1.7, "d": 10.0, "e": 0.8"#,
        r#"orbit: (start: Given(mode: "free", state: {"x": -0.3, "v": 0.0}, phase: 0.0)),
    continuation: (parameter: "c", range: (-0.1, 0.1), toward: Down),"#,
    );
    let (code, rows) = certified(&text, folder.path(), &[]);
    assert_eq!(code, Some(0), "{rows:?}");
    let pair = rows.iter().find(|row| row["type"] == "NS").unwrap();
    let [low, high] = VALUE.map(|column| pair[column].parse::<f64>().unwrap());
    assert!(low <= 0.0 && high >= 0.0 && high - low < 1e-12, "{pair:?}");
    let angle = std::f64::consts::TAU * (1.0 - 1.0 / 1.7);
    encloses(pair, ["angle_low", "angle_high"], angle, 1e-12);
    let outside: Vec<&str> = rows.iter().map(|row| &*row["outside"]).collect();
    assert_eq!(outside, ["0", "", "2"]);
}

/// Stick between two bounds, a Filippov sliding mode: closed form of the period of a belt without damping.
#[test]
fn stick_and_sliding_modes() {
    let folder = TempDir::new().unwrap();
    let text = r#"(
    system: (
        states: ["x", "v"],
        parameters: {"z": 0.0, "s": 1.5, "k": 1.0, "u": 1.0},
        modes: {
            "slip": (rates: {"x": "v", "v": "k - x - 2*z*v"}, until: [(zero: "u - v", to: "stick")]),
            "stick": (rates: {"x": "u", "v": "0"}, until: [(zero: "s - x - 2*z*u", to: "slip")]),
        },
    ),
    orbit: (start: Given(mode: "slip", state: {"x": 1.5, "v": 1.0}, period: 6.3)),
    continuation: (parameter: "z", range: (0.0, 0.01), toward: Up),
    stability: (),
)"#;
    let (code, rows) = certified(text, folder.path(), &[]);
    assert_eq!(code, Some(0), "{rows:?}");
    // 2π − 2 arctan(D/u) in slip and 2D/u in stick, with D = s − k
    let period = std::f64::consts::TAU - 2.0 * 0.5_f64.atan() + 1.0;
    encloses(&rows[0], ["period_low", "period_high"], period, 1e-12);
    // the stick leaves nothing of a perturbation but the shift in time
    assert!(rows.iter().all(|row| row["outside"] == "0"), "{rows:?}");
}

/// Dry friction about the onset of stick.
const ONSET: &str = r#"(
    system: (
        states: ["x", "v"],
        parameters: {"w": 0.7227, "F": 0.6666666666666666, "z": 0.05},
        forcing: "w",
        define: {"rest": "cos(phase) - 2*z*v - x"},
        modes: {
            "forth": (rates: {"x": "v", "v": "rest - F"}, until: [(zero: "v", to: "back")]),
            "back": (rates: {"x": "v", "v": "rest + F"}, until: [(zero: "-v", to: "forth")]),
        },
        sliding: {"stick": ("forth", "back")},
    ),
    orbit: (start: Given(mode: "back", state: {"x": 1.3413989268352018, "v": 0.0}, phase: 0.8302632936342363)),
    continuation: (parameter: "w", range: (0.72266, 0.7227), toward: Down),
    stability: (),
)"#;

/// Onset of stick between dry friction's two slips, a Filippov sliding mode: it happens in both halves of the symmetric orbit
/// at once, by the symmetry of the formulas. Closed form of the frequency with 19 digits. Beyond it there is no other event.
#[test]
fn stick_sets_in_in_both_halves() {
    let folder = TempDir::new().unwrap();
    let (code, rows) = certified(ONSET, folder.path(), &["--arcs"]);
    assert_eq!(code, Some(0), "{rows:?}");
    assert_eq!(arcs(&rows), [["EP", ""], ["SL", "yes"], ["EP", "yes"]]);
    let onset: Vec<&Row> = rows.iter().filter(|row| row["type"] == "SL").collect();
    assert!(!onset.is_empty(), "{rows:?}");
    for row in onset {
        encloses(row, VALUE, 0.722_679_194_438_143_1, 1e-11);
    }
    // it is stable with and without stick
    let outside: Vec<&str> = rows.iter().map(|row| &*row["outside"]).collect();
    assert!(
        outside
            .iter()
            .all(|count| count.is_empty() || *count == "0"),
        "{outside:?}"
    );
    let out = folder.path().join("out");
    let verified = brakewave(&["certify", "--verify", out.to_str().unwrap()]);
    assert_eq!(verified.status.code(), Some(0), "{verified:?}");
}

/// The same on a frame that moves with speed 1 and stands beside by a third: the centre of the symmetry is another point.
#[test]
fn stick_sets_in_around_another_centre() {
    let folder = TempDir::new().unwrap();
    let text = ONSET
        .replace("2*z*v - x", "2*z*(v + 1) - (x - 1/3)")
        .replace(r#""x": "v""#, r#""x": "v + 1""#)
        .replace(r#"zero: "v""#, r#"zero: "v + 1""#)
        .replace(r#"zero: "-v""#, r#"zero: "-v - 1""#)
        .replace(
            r#""x": 1.3413989268352018, "v": 0.0"#,
            r#""x": 1.6747322601685351, "v": -1.0"#,
        );
    let (code, rows) = certified(&text, folder.path(), &[]);
    assert_eq!(code, Some(0), "{rows:?}");
    let onset = rows.iter().find(|row| row["type"] == "SL");
    let onset = onset.unwrap_or_else(|| panic!("{rows:?}"));
    encloses(onset, VALUE, 0.722_679_194_438_143_1, 1e-11);
    let out = folder.path().join("out");
    let verified = brakewave(&["certify", "--verify", out.to_str().unwrap()]);
    assert_eq!(verified.status.code(), Some(0), "{verified:?}");
}

/// The onset of stick as the orbit with a stick of no duration in either half, seen in the sequence without: true as well. Its
/// enclosure is about as wide as that of the other, and over a tenth of the distance there is no other, too.
#[test]
fn an_orbit_with_a_zone_of_no_duration_is_that_without_it() {
    let folder = TempDir::new().unwrap();
    certified(ONSET, folder.path(), &[]);
    let text = fs::read_to_string(folder.path().join("out/certificate.ron")).unwrap();
    let certificate: Certificate<OrbitProof> = ron::from_str(&text).unwrap();
    let onset = |point: &&CertifiedPoint<OrbitProof>| point.kind == EventType::SL;
    let point = certificate.points.iter().find(onset).unwrap();
    let ProofOutcome::Proven(honest) = &point.outcome else {
        panic!("{point:?}");
    };
    let mut proof = honest.clone();
    proof.posed.system = certificate.system.clone();
    let there = proof.seen.pop().unwrap();
    proof.seen.push(SequenceOrbit {
        condition: std::mem::replace(&mut proof.condition, there.condition),
        near: std::mem::replace(&mut proof.near, there.near),
    });
    assert!(proof.near.sequence.len() > proof.seen[0].near.sequence.len());
    let wider = |said: Interval| Interval::new(said.low - 1e-11, said.high + 1e-11);
    proof.statement.parameter = wider(proof.statement.parameter);
    proof.statement.period = wider(proof.statement.period);
    proof.statement.unique *= 0.1;
    let verdicts = (0..40).map(|inequalities| {
        proof.statement.inequalities = inequalities;
        orbit::verify(point, &proof)
    });
    // of its inequalities there is one number
    let verdicts: Vec<_> = verdicts.collect();
    let holding = verdicts.iter().filter(|verdict| verdict.is_ok());
    assert_eq!(holding.count(), 1, "{verdicts:?}");
}

/// The converter of `problems/buck_converter.ron`: its orbit of two periods doubles again, and later a zone shrinks to nothing
/// at the tip of the ramp, where another switch takes over. Both with 20 digits.
#[test]
fn a_zone_that_closes() {
    let folder = TempDir::new().unwrap();
    let system = system_of("buck_converter", "\"E\": 22.0", "\"E\": 30.0");
    let text = format!(
        r#"{system}    orbit: (start: Simulate(mode: "off", state: {{"v": 12.0, "i": 0.6, "ramp": 3.8}}, settle: 0.2)),
    continuation: (parameter: "E", range: (29.0, 37.0), toward: Up),
    stability: (),
)"#
    );
    let (code, rows) = certified(&text, folder.path(), &[]);
    assert_eq!(code, Some(0), "{rows:?}");
    let types: Vec<&str> = rows.iter().map(|row| &*row["type"]).collect();
    assert_eq!(types, ["EP", "PD", "CO", "EP"]);
    encloses(&rows[1], VALUE, 31.117_902_006_770_976, 1e-11);
    encloses(&rows[2], VALUE, 36.353_237_064_076_766, 1e-11);
    assert_eq!((&*rows[0]["outside"], &*rows[3]["outside"]), ("0", "1"));
}

/// Two guards that are zero at the same instants of every orbit, by what is zero and not by their formulas: with different
/// impacts nothing is proven, with the same all of it. Nor is anything where a guard is zero for ever.
#[test]
fn no_guard_is_the_first_of_two() {
    let folder = TempDir::new().unwrap();
    let text = |switch: &str| {
        format!(
            r#"(
    system: (
        states: ["x", "v", "q"],
        parameters: {{"c": 0.1, "A": 0.12, "w": 1.0, "d": 1.0, "e": 0.8}},
        forcing: "w",
        modes: {{"free": (
            rates: {{"x": "v", "v": "A*cos(phase) - c*v - x", "q": "0"}},
            until: [(zero: "d - x", to: "free", reset: {{"v": "-e*v", "q": "0"}}), {switch}],
        )}},
    ),
    orbit: (start: Given(mode: "free", state: {{"x": 1.0, "v": -0.08, "q": 0.0}}, phase: 1.03)),
    continuation: (parameter: "A", range: (0.11, 0.12), toward: Down),
    stability: (),
)"#
        )
    };
    for (reset, proven) in [("-0.5*v", "no"), ("q - e*v", "yes")] {
        let switch =
            format!(r#"(zero: "d - x + q", to: "free", reset: {{"v": "{reset}", "q": "0"}})"#);
        let (code, rows) = certified(&text(&switch), folder.path(), &["--force"]);
        assert_eq!(code, Some(i32::from(proven == "no")), "{rows:?}");
        assert_eq!(rows.len(), 2);
        assert!(rows.iter().all(|row| row["proven"] == proven), "{rows:?}");
    }
}

/// Without damping the multipliers of an orbit have the product 1: −1 is double where it doubles, in one Jordan block. What is
/// stated is what is proven. The system stands in the certificate once.
#[test]
fn a_doubling_without_damping() {
    let folder = TempDir::new().unwrap();
    let text = r#"(
    system: (
        states: ["x", "v"],
        parameters: {"A": 0.3, "w": 1.3, "d": 1.0},
        forcing: "w",
        modes: {"free": (
            rates: {"x": "v", "v": "A*cos(phase) - x"},
            until: [(zero: "d - x", to: "free", reset: {"v": "-v"})],
        )},
    ),
    orbit: (start: Given(mode: "free", state: {"x": 1.0, "v": -1.7}, phase: 0.0)),
    continuation: (parameter: "w", range: (0.9, 1.3), toward: Down),
    stability: (),
)"#;
    let (code, rows) = certified(text, folder.path(), &[]);
    assert_eq!(code, Some(0), "{rows:?}");
    let doubling = rows.iter().find(|row| row["type"] == "PD").unwrap();
    encloses(doubling, VALUE, 1.0, 1e-12);
    let read = |file: &str| fs::read_to_string(folder.path().join("out").join(file)).unwrap();
    let theorem = read("theorem.md");
    let (_, theorem) = theorem.split_once(": PD\n").unwrap();
    let (theorem, _) = theorem.split_once("\n## ").unwrap();
    assert!(theorem.contains("geometrically simple"), "{theorem}");
    assert!(theorem.contains("det(P + 1)"), "{theorem}");
    assert_eq!(
        read("certificate.ron").matches("A*cos(phase) - x").count(),
        1
    );
}
