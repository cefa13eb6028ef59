//! The tables of a result folder say what they promise, and the waves in them obey the laws of
//! contact and friction.

use std::f64::consts::TAU;
use std::fs;
use std::path::Path;

use crate::cli::harness::{Bench, PROBLEMS, SMALL, Table, changed, finite, off};

/// The least that `branch.csv` has, in this order.
const BRANCH: &str = "point,label,type,regimes,mismatch,friction,mass_damping,stiffness_damping,\
gamma,nu,xi,speed,switches,min_pressure,max_gap,amplitude,stable,unstable,lead_re,lead_im,\
lead_sector,newton,residual";
const EVENTS: &str = "label,type,mismatch,friction,mass_damping,stiffness_damping,gamma,nu,xi,\
speed,sector,omega,regimes_before,regimes_after,uncertainty,what";
const PROFILE: &str = "theta,U,V,U_dot,V_dot,P,Q,regime";
const PARAMETERS: [&str; 7] = [
    "mismatch",
    "friction",
    "mass_damping",
    "stiffness_damping",
    "gamma",
    "nu",
    "xi",
];

/// Runs a problem of the repository and returns its folder.
fn results(bench: &Bench, name: &str) -> std::path::PathBuf {
    let file = Path::new(PROBLEMS).join(name);
    let file = file.to_str().expect("UTF-8");
    bench
        .run(&["run", file, "--out", "out", "--quiet"])
        .expect(0);
    bench.path("out")
}

/// With the rotation of the shaft tables end in k|c|Ω/2π and |ω|Ω/2π; all the rest of them is as without it.
#[test]
fn frequencies_are_told_in_hertz_where_the_rotation_is_known() {
    let bench = Bench::new();
    bench.put("plain.ron", SMALL);
    let rotation = 62.5;
    let output = format!("profiles: 2, rotation: {rotation:?}");
    bench.put("heard.ron", changed(SMALL, "profiles: 2", &output));
    bench.run(&["run", "plain.ron", "--out", "plain"]).expect(0);
    let said = bench.run(&["run", "heard.ron", "--out", "heard"]).expect(0);
    let read = |name: &str| fs::read_to_string(bench.path(name)).expect("a table");
    let (plain, heard) = (read("plain/branch.csv"), read("heard/branch.csv"));
    assert!(!plain.contains("hertz"));
    for (row, (one, other)) in plain.lines().zip(heard.lines()).enumerate() {
        let (same, last) = other.rsplit_once(',').expect("columns");
        assert_eq!(same, one, "row {row}");
        assert_eq!(last == "hertz", row == 0);
    }
    assert_eq!(plain.lines().count(), heard.lines().count());
    let branch = Table::read(&bench.path("heard/branch.csv"));
    for row in 0..branch.rows.len() {
        let wanted = 4.0 * branch.number(row, "speed").abs() * rotation / TAU;
        assert!(off(branch.number(row, "hertz"), wanted) < 1e-15);
    }
    assert!(
        said.stdout.contains("Hz") && said.stdout.contains("49.45"),
        "{}",
        said.stdout
    );
    let steady = |name: &str| {
        bench
            .run(&["steady", name, "--modes", "3..4"])
            .expect(0)
            .stdout
    };
    assert!(!steady("plain.ron").contains("hertz"));
    let modes = Table::parse(steady("heard.ron").as_bytes());
    for row in 0..modes.rows.len() {
        for (omega, hertz) in [("omega", "hertz"), ("full_omega", "full_hertz")] {
            let wanted = modes.number(row, omega).abs() * rotation / TAU;
            assert!(off(modes.number(row, hertz), wanted) < 1e-15, "{hertz}");
        }
    }
    bench.put("wrong.ron", changed(SMALL, "profiles: 2", "rotation: -1"));
    let refused = bench.run(&["run", "wrong.ron"]).expect(2);
    assert!(refused.stderr.contains("in rad/s"), "{}", refused.stderr);
}

#[cfg(feature = "completions")]
#[test]
fn completions_and_the_manual_name_every_verb() {
    let bench = Bench::new();
    let help = bench.run(&["--help"]).expect(0).stdout;
    let verbs = help.lines().skip_while(|line| *line != "Commands:").skip(1);
    let verbs = verbs.map_while(|line| line.split_whitespace().next());
    let verbs: Vec<&str> = verbs.filter(|verb| *verb != "help").collect();
    assert!(
        verbs.contains(&"run") && verbs.contains(&"man"),
        "{verbs:?}"
    );
    let manual = bench.run(&["man"]).expect(0).stdout;
    for verb in &verbs {
        assert!(manual.contains(&format!(".TH brakewave-{verb} ")), "{verb}");
    }
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let script = bench.run(&["completions", shell]).expect(0).stdout;
        assert!(verbs.iter().all(|verb| script.contains(verb)), "{shell}");
    }
    // as files, where a package has them: the same pages and scripts
    let written = bench.run(&["man", "--out", "share"]).expect(0).stdout;
    let read = |name: &str| std::fs::read_to_string(bench.path(name)).unwrap();
    let pages = written.lines().filter(|name| name.ends_with(".1"));
    let pages: Vec<&str> = pages.collect();
    assert_eq!(
        pages.iter().map(|name| read(name)).collect::<String>(),
        manual
    );
    for verb in verbs.into_iter().chain(["map-merge", "scan-merge"]) {
        let page = format!("share/man/man1/brakewave-{verb}.1");
        assert!(pages.contains(&&*page), "{page}");
    }
    // every page that another one names is there
    let named = manual.split("brakewave\\-").skip(1);
    let named = named.filter_map(|rest| rest.split_once("(1)"));
    for (verb, _) in named.filter(|(verb, _)| !verb.contains(char::is_whitespace)) {
        let page = format!("brakewave-{}.1", verb.replace('\\', ""));
        assert!(pages.iter().any(|name| name.ends_with(&page)), "{page}");
    }
    for (shell, file) in [
        ("bash", "share/bash-completion/completions/brakewave"),
        ("zsh", "share/zsh/site-functions/_brakewave"),
        ("fish", "share/fish/vendor_completions.d/brakewave.fish"),
    ] {
        let script = bench.run(&["completions", shell]).expect(0).stdout;
        assert!(written.lines().any(|name| name == file), "{file}");
        assert_eq!(read(file), script, "{shell}");
    }
    let refused = bench
        .run(&["man", "--out", "share/man/man1/brakewave.1"])
        .expect(4);
    assert!(refused.stderr.contains("brakewave.1"), "{}", refused.stderr);
}

#[test]
fn mode4_in_the_mismatch() {
    let wanted = [0.08, 0.045, 0.02, 0.004, 0.001];
    examine("mode4_mismatch.ron", 4, "mismatch", &wanted);
}

#[test]
fn mode4_in_the_friction_coefficient() {
    examine("mode4_friction.ron", 4, "friction", &[0.3, 0.5, 0.8]);
}

#[test]
fn the_slow_wave() {
    examine("mode4_slow.ron", 4, "mismatch", &[]);
}

#[test]
fn mode8() {
    examine("mode8_reverse.ron", 8, "mismatch", &[0.026773139826513]);
}

#[test]
fn the_wave_that_runs_with_the_shaft() {
    examine("positive_coupling.ron", 4, "mismatch", &[]);
}

/// From the first point beyond take-off on, be it ever so small.
#[test]
fn an_open_separation_has_its_gap() {
    for name in ["mode8_reverse.ron", "positive_coupling.ron"] {
        let bench = Bench::new();
        let out = results(&bench, name);
        let branch = Table::read(&out.join("branch.csv"));
        for row in 0..branch.rows.len() {
            let open = branch.text(row, "regimes").contains("separation");
            let gap = branch.number(row, "max_gap");
            // at an event the zone may have no length
            if open && branch.text(row, "type").is_empty() {
                assert!(gap > 0.0, "{name}: no gap in row {row}");
            } else if !open {
                assert_eq!(gap, 0.0, "{name}: a gap in row {row}");
            }
            let label = branch.text(row, "label");
            if label.is_empty() {
                continue;
            }
            let profile = Table::read(&out.join(format!("profiles/{label}.csv")));
            let mismatch = branch.number(row, "mismatch");
            let sampled = (0..profile.rows.len())
                .map(|row| profile.number(row, "U") - mismatch)
                .fold(0.0, f64::max);
            // samples come near the largest value, not beyond
            let rounding = 4.0 * f64::EPSILON * mismatch;
            let short = gap - sampled;
            assert!(
                (-rounding..=0.02 * gap + rounding).contains(&short),
                "{name}, label {label}: {gap} but {sampled} in the profile"
            );
        }
    }
}

fn examine(name: &str, mode: u32, parameter: &str, wanted: &[f64]) {
    let bench = Bench::new();
    let out = results(&bench, name);
    let wavelength = TAU / f64::from(mode);
    let branch = Table::read(&out.join("branch.csv"));
    assert!(branch.columns.join(",").starts_with(BRANCH));
    let mut labels = 0;
    for row in 0..branch.rows.len() {
        assert_eq!(branch.text(row, "point"), (row + 1).to_string());
        for column in PARAMETERS {
            branch.number(row, column);
        }
        for column in ["speed", "min_pressure", "max_gap", "amplitude", "residual"] {
            branch.number(row, column);
        }
        for column in ["stable", "unstable", "lead_re", "lead_im", "lead_sector"] {
            assert_eq!(branch.text(row, column), "", "stability is not asked for");
        }
        assert!(branch.text(row, "newton").parse::<u32>().is_ok());
        let switches: Vec<f64> = branch
            .text(row, "switches")
            .split(' ')
            .map(finite)
            .collect();
        assert_eq!(
            switches.len(),
            branch.text(row, "regimes").split('-').count()
        );
        assert!(switches[0] > 0.0 && switches.is_sorted(), "{switches:?}");
        assert!(off(switches[switches.len() - 1], wavelength) <= 1e-13);
        assert!(branch.number(row, "amplitude") > 0.0);
        assert!(branch.number(row, "max_gap") >= 0.0);
        if !branch.text(row, "label").is_empty() {
            labels += 1;
            assert_eq!(branch.text(row, "label"), labels.to_string());
        } else {
            assert_eq!(branch.text(row, "type"), "", "special points have labels");
        }
    }

    // user points are met exactly, not nearly
    let users: Vec<f64> = branch
        .all("type", "UZ")
        .into_iter()
        .map(|row| branch.number(row, parameter))
        .collect();
    for value in wanted {
        assert!(users.contains(value), "{value} in {users:?}");
    }
    assert_eq!(wanted.is_empty(), users.is_empty());

    // events are the special points, with the same figures
    let events = Table::read(&out.join("events.csv"));
    assert_eq!(events.columns.join(","), EVENTS);
    let special = (0..branch.rows.len()).filter(|row| !branch.text(*row, "type").is_empty());
    let special: Vec<usize> = special.collect();
    assert_eq!(special.len(), events.rows.len());
    for (event, row) in special.into_iter().enumerate() {
        for column in ["label", "type", "speed"].iter().chain(&PARAMETERS) {
            assert_eq!(events.text(event, column), branch.text(row, column));
        }
        let uncertainty = events.number(event, "uncertainty");
        assert!((0.0..1e-5).contains(&uncertainty), "{uncertainty}");
        assert!(!events.text(event, "what").is_empty());
        assert_eq!(
            events.text(event, "regimes_before"),
            branch.text(row, "regimes")
        );
    }

    // a profile for each label and no other
    let files = fs::read_dir(out.join("profiles"))
        .expect("profiles")
        .count();
    assert_eq!(files, labels);
    for label in 1..=labels {
        let row = branch.only("label", &label.to_string());
        let profile = Table::read(&out.join(format!("profiles/{label}.csv")));
        Waveform::of(
            &profile,
            &branch,
            row,
            wavelength,
            &format!("{name}, label {label}"),
        );
    }
}

/// A tabulated wave with the units of its figures.
struct Waveform<'a> {
    table: &'a Table,
    name: &'a str,
}

impl Waveform<'_> {
    fn of(table: &Table, branch: &Table, at: usize, wavelength: f64, name: &str) {
        assert_eq!(table.columns.join(","), PROFILE);
        let wave = Waveform { table, name };
        let mismatch = branch.number(at, "mismatch");
        let friction = branch.number(at, "friction");
        wave.laws(mismatch, friction);
        wave.continuity(wavelength);
        // the row of the branch sums up this wave
        let rows = || 0..table.rows.len();
        // at an event a zone may have no length, so that neighbours of one regime tell nothing
        let mut found: Vec<&str> = rows().map(|row| table.text(row, "regime")).collect();
        let mut told: Vec<&str> = branch.text(at, "regimes").split('-').collect();
        found.dedup();
        told.dedup();
        assert_eq!(found, told, "{name}");
        // samples cannot see more than the extremes that were computed
        let touching = rows().filter(|row| table.text(*row, "regime") != "separation");
        let least = touching
            .map(|row| table.number(row, "P"))
            .fold(f64::INFINITY, f64::min);
        let pressure = branch.number(at, "min_pressure");
        let unit = wave.size("P");
        assert!(
            least >= pressure - 1e-9 * unit,
            "{name}: P {least} < {pressure}"
        );
        assert!(
            least <= pressure + 0.05 * unit,
            "{name}: P {least} > {pressure}"
        );
    }

    /// Largest magnitude of a column.
    fn size(&self, column: &str) -> f64 {
        (0..self.table.rows.len())
            .map(|row| self.table.number(row, column).abs())
            .fold(0.0, f64::max)
    }

    fn laws(&self, mismatch: f64, friction: f64) {
        let Waveform { table, name } = self;
        let pressure_unit = self.size("P");
        let rate_unit = self.size("V_dot").max(1.0);
        for row in 0..table.rows.len() {
            let [u, u_dot, v_dot, p, q] =
                ["U", "U_dot", "V_dot", "P", "Q"].map(|column| table.number(row, column));
            let regime = table.text(row, "regime");
            let here = format!("{name}, row {row}, {regime}");
            let tiny = 1e-12 * pressure_unit;
            assert!(p >= -tiny, "{here}: P = {p}");
            assert!(
                q.abs() <= friction * p * (1.0 + 1e-12) + tiny,
                "{here}: P = {p}, Q = {q}"
            );
            let slack = 1e-9 * rate_unit;
            match regime {
                "slip" | "reverse" => {
                    let sign = if regime == "slip" { 1.0 } else { -1.0 };
                    assert!(
                        (q - sign * friction * p).abs() <= tiny,
                        "{here}: P = {p}, Q = {q}"
                    );
                    // friction opposes sliding: the shaft runs at speed 1
                    assert!(sign * (1.0 - v_dot) >= -slack, "{here}: V_dot = {v_dot}");
                    assert!(off(u, mismatch) <= 1e-15 && u_dot == 0.0, "{here}: U = {u}");
                }
                "stick" => {
                    assert!((v_dot - 1.0).abs() <= 1e-13, "{here}: V_dot = {v_dot}");
                    assert!(off(u, mismatch) <= 1e-15 && u_dot == 0.0, "{here}: U = {u}");
                }
                "separation" => {
                    assert_eq!((p, q), (0.0, 0.0), "{here}");
                    assert!(u >= mismatch * (1.0 - 1e-12), "{here}: U = {u}");
                }
                other => panic!("{here}: {other}"),
            }
        }
    }

    fn continuity(&self, wavelength: f64) {
        let Waveform { table, name } = self;
        let last = table.rows.len() - 1;
        assert_eq!(table.number(0, "theta"), 0.0, "{name}");
        assert!(
            off(table.number(last, "theta"), wavelength) <= 1e-13,
            "{name}"
        );
        let joined = |before: usize, after: usize| {
            for column in ["U", "V", "V_dot"] {
                let step = table.number(after, column) - table.number(before, column);
                // impact without friction leaves V_dot alone
                let unit = self.size(column);
                assert!(
                    step.abs() <= 1e-9 * unit,
                    "{name}: {column} jumps by {step} in row {after}"
                );
            }
            // only a landing stops the radial motion at once
            if table.text(before, "regime") != "separation" {
                assert_eq!(table.number(before, "U_dot"), 0.0, "{name}, row {before}");
                assert_eq!(table.number(after, "U_dot"), 0.0, "{name}, row {after}");
            }
        };
        // θ is a sum of durations: equal to rounding where both sides of a switch are sampled
        let rounding = 4.0 * f64::EPSILON * wavelength;
        for row in 1..=last {
            let [before, here] = [row - 1, row].map(|row| table.number(row, "theta"));
            assert!(
                here >= before - rounding,
                "{name}: theta falls in row {row}"
            );
            let switch = table.text(row, "regime") != table.text(row - 1, "regime");
            if here - before <= rounding {
                joined(row - 1, row);
            } else {
                assert!(!switch, "{name}: one side only of the switch in row {row}");
            }
        }
        // the wave closes
        joined(last, 0);
    }
}
