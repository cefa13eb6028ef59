//! Pictures can be drawn again from the tables, whatever is left of these.

use std::fs;
use std::process::Command;

use crate::cli::fields::BASE;
use crate::cli::harness::{Bench, SMALL, Table, assert_same, changed, off, problem, snapshot};

/// A folder with results and every kind of picture.
fn results() -> Bench {
    let bench = Bench::new();
    let text = problem("mode4_mismatch.ron");
    let text = changed(&text, "[Diagram,", "[Diagram, Spectrum,");
    // as few eigenvalues as there can be
    let stability = "stability: (sectors: Only([0]), eigenvalues: 1, max_frequency: 0.5), output:";
    bench.put("problem.ron", changed(&text, "output:", stability));
    bench
        .run(&["run", "problem.ron", "--out", "out", "--quiet"])
        .expect(0);
    bench
}

const PICTURES: [&str; 8] = [
    "diagram",
    "spectrum",
    "column_switches",
    "column_amplitude",
    "pressure",
    "displacement",
    "phase_plane",
    "friction",
];

/// Formats that this build writes.
const FORMATS: &[&str] = if cfg!(feature = "raster") {
    &["svg", "png", "pdf"]
} else {
    &["svg"]
};

/// Checks that the pictures begin and end as files of their format do.
fn assert_pictures(bench: &Bench, format: &str, names: &[&str]) {
    for name in names {
        let path = bench.path("out").join(format!("{name}.{format}"));
        let bytes = fs::read(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        let (head, tail): (&[u8], &[u8]) = match format {
            "svg" => (b"<svg ", b"</svg>"),
            "png" => (b"\x89PNG\r\n\x1a\n", b"IEND\xaeB`\x82"),
            _ => (b"%PDF-", b"%%EOF"),
        };
        assert!(bytes.starts_with(head), "{}", path.display());
        assert!(bytes.trim_ascii_end().ends_with(tail), "{}", path.display());
        assert!(bytes.len() > 500, "{} is empty", path.display());
    }
}

#[test]
fn all_formats_are_drawn_again() {
    let bench = results();
    let out = bench.path("out");
    let first = snapshot(&out);
    assert_pictures(&bench, "svg", &PICTURES);
    for name in PICTURES {
        fs::remove_file(out.join(format!("{name}.svg"))).expect("a picture");
    }
    let outcome = bench.run(&["plot", "out"]).expect(0);
    assert_eq!(outcome.stdout.lines().count(), PICTURES.len());
    // as they were drawn by the run
    assert_same(&snapshot(&out), &first, "svg");
    for format in &FORMATS[1..] {
        let outcome = bench.run(&["plot", "out", "--format", format]).expect(0);
        for line in outcome.stdout.lines() {
            assert!(bench.path(line).exists(), "{line}");
        }
        assert_pictures(&bench, format, &PICTURES);
    }
}

/// Braces and environments of a document that end in the order in which they begin; escaped braces are text.
fn assert_nested(text: &str, name: &str) {
    let plain = text.replace("\\{", "").replace("\\}", "");
    let mut depth = 0_i64;
    for c in plain.chars() {
        depth += i64::from(c == '{') - i64::from(c == '}');
        assert!(depth >= 0, "{name}");
    }
    assert_eq!(depth, 0, "{name}");
    let mut open = Vec::new();
    for piece in plain.split('\\').skip(1) {
        let environment = |word| piece.strip_prefix(word)?.split('}').next();
        if let Some(begun) = environment("begin{").filter(|_| !piece.contains("stands in")) {
            open.push(begun);
        } else if let Some(ended) = environment("end{") {
            assert_eq!(open.pop(), Some(ended), "{name}");
        }
    }
    assert!(open.is_empty(), "{name}: {open:?}");
}

/// Source for pgfplots holds the data of the tables, and pdfLaTeX makes one page of it.
#[test]
fn pgfplots_has_the_data_and_compiles() {
    let bench = results();
    let text = fs::read_to_string(bench.path("problem.ron")).expect("a problem");
    let title = "title: \"50 % of {δ} & c_∞ → #1 ~ x^2 \\\\ 漢 Größe\"";
    let own = text
        .lines()
        .find(|line| line.contains("title:"))
        .expect("a title");
    bench.put(
        "problem.ron",
        changed(&text, own.trim().trim_end_matches(','), title),
    );
    let run = ["run", "problem.ron", "--out", "out", "--quiet", "--force"];
    bench.run(&run).expect(0);
    bench.run(&["plot", "out", "--format", "tex"]).expect(0);
    let branch = Table::read(&bench.path("out/branch.csv"));
    let read = |name: &str| {
        let path = bench.path("out").join(format!("{name}.tex"));
        fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
    };
    for name in PICTURES {
        let source = read(name);
        assert_nested(&source, name);
        assert!(
            source.contains("\\begin{axis}") && source.contains("coordinates {"),
            "{name}"
        );
        assert!(source.chars().all(|c| c <= '\u{ff}'), "{name}");
    }
    // every point of a column, with nine figures
    let drawn: Vec<(f64, f64)> = read("column_amplitude")
        .split('(')
        .filter_map(|piece| piece.split_once(')')?.0.split_once(','))
        .filter_map(|(x, y)| Some((x.parse().ok()?, y.parse().ok()?)))
        .collect();
    for row in 0..branch.rows.len() {
        let (x, y) = (
            branch.number(row, "mismatch"),
            branch.number(row, "amplitude"),
        );
        let there = drawn
            .iter()
            .any(|at| off(at.0, x) < 1e-8 && off(at.1, y) < 1e-8);
        assert!(there, "row {row}: ({x}, {y})");
    }
    let tex = |name: &str| {
        let arguments = ["-interaction=nonstopmode", "-halt-on-error", name];
        let command = Command::new("pdflatex")
            .args(arguments)
            .current_dir(bench.path("out"))
            .output();
        command.map(|output| String::from_utf8_lossy(&output.stdout).into_owned())
    };
    for name in PICTURES {
        match tex(name) {
            Ok(said) if !said.contains("pgfplots.sty' not found") => {
                assert!(
                    said.contains(&format!("{name}.pdf (1 page")),
                    "{name}: {said}"
                );
            }
            _ => {
                return eprintln!("pdflatex with pgfplots is not here: the source is not compiled");
            }
        }
    }
}

#[test]
fn branches_of_few_points_are_drawn() {
    let bench = results();
    let cut = |name: &str, rows: usize| {
        let path = bench.path("out").join(name);
        let text = fs::read_to_string(&path).expect("a table");
        let kept: String = text.split_inclusive('\n').take(rows + 1).collect();
        fs::write(&path, kept).expect("a table");
    };
    // downwards: what is cut off is gone
    for rows in [2, 1, 0] {
        cut("branch.csv", rows);
        cut("events.csv", rows);
        for format in FORMATS {
            // conversion is the same for all of them; the slow ones are spared where rows remain
            if rows > 0 && *format != "svg" {
                continue;
            }
            bench.run(&["plot", "out", "--format", format]).expect(0);
            assert_pictures(&bench, format, &PICTURES);
        }
    }
    // not even the events, and not even the profiles
    fs::remove_file(bench.path("out/events.csv")).expect("the events");
    fs::remove_dir_all(bench.path("out/profiles")).expect("the profiles");
    bench.run(&["plot", "out"]).expect(0);
    assert_pictures(&bench, "svg", &PICTURES);
    // without the branch there is nothing to draw
    fs::remove_file(bench.path("out/branch.csv")).expect("the branch");
    let stderr = bench.run(&["plot", "out"]).expect(4).stderr;
    assert!(stderr.contains("branch.csv"), "{stderr}");
}

#[test]
fn a_row_cut_short_is_left_out() {
    let bench = results();
    let path = bench.path("out/branch.csv");
    let whole = fs::read(&path).expect("the branch");
    let rows = whole.iter().rposition(|byte| *byte == b'\n').expect("rows");
    for cut in [rows, rows - 1, rows - 60, rows - 180] {
        fs::write(&path, &whole[..cut]).expect("the branch");
        bench.run(&["plot", "out"]).expect(0);
        assert_pictures(&bench, "svg", &PICTURES);
    }
}

#[test]
fn unknown_columns_are_refused_with_the_known_ones() {
    let bench = Bench::new();
    let odd = r#"plots: [Column("ampltude")]"#;
    let text = changed(SMALL, "plots: [Diagram]", odd);
    bench.put("problem.ron", text);
    let stderr = bench
        .run(&["run", "problem.ron", "--out", "out"])
        .expect(2)
        .stderr;
    for known in ["ampltude", "amplitude", "min_pressure", "switches"] {
        assert!(stderr.contains(known), "no {known} in {stderr}");
    }
    // before anything is computed
    assert_eq!(bench.names(), ["problem.ron"]);

    // a folder may ask for what its table lacks, too: another version may have written it
    bench.put(
        "problem.ron",
        changed(SMALL, "[Diagram]", r#"[Column("amplitude")]"#),
    );
    bench.run(&["run", "problem.ron", "--out", "out"]).expect(0);
    let restart = bench.path("out/branch.ron");
    let text = fs::read_to_string(&restart).expect("the restart file");
    let text = changed(&text, r#"Column("amplitude")"#, r#"Column("ampltude")"#);
    fs::write(&restart, text).expect("the restart file");
    let stderr = bench.run(&["plot", "out"]).expect(2).stderr;
    for known in ["ampltude", "amplitude", "min_pressure", "switches"] {
        assert!(stderr.contains(known), "no {known} in {stderr}");
    }
}

#[test]
fn folders_without_results_are_refused() {
    let bench = Bench::new();
    fs::create_dir(bench.path("empty")).expect("a folder");
    bench.put("file", "");
    for folder in ["empty", "missing", "file"] {
        let stderr = bench.run(&["plot", folder]).expect(2).stderr;
        let said = match folder {
            "empty" => "empty/branch.ron".to_owned(),
            folder => format!("{folder}: there is no such folder"),
        };
        assert!(stderr.contains(&said), "{stderr}");
    }
    assert_eq!(bench.names(), ["empty", "file"]);
}

/// Titles are the user's own: they may hold what means something in XML.
#[test]
fn titles_are_text() {
    let bench = Bench::new();
    let title = r#"(title: "<&> \" ' ν ]]>","#;
    bench.put(
        "problem.ron",
        format!("{title}{}", SMALL.trim_start_matches('(')),
    );
    bench.run(&["run", "problem.ron", "--out", "out"]).expect(0);
    // the converters parse the XML
    for format in FORMATS {
        bench.run(&["plot", "out", "--format", format]).expect(0);
        assert_pictures(&bench, format, &["diagram"]);
    }
}

/// Every kind of folder has its picture without being asked, and `plot` draws the same one again, title
/// and all; views are of branches only.
#[test]
fn every_kind_of_folder_is_drawn() {
    let bench = Bench::new();
    bench.put("problem.ron", BASE);
    let accuracy = ["accuracy", "--budget", "0.15", "--repeats", "1"];
    let verbs: [(&[&str], &str, i32); 5] = [
        (&["map"], "map.svg", 0),
        // it ends at `max_points`
        (&["curve"], "curve.svg", 3),
        (&accuracy, "accuracy.svg", 0),
        (&["steady", "--modes", "4"], "steady.svg", 0),
        (&["simulate"], "space_time.svg", 0),
    ];
    for (verb, picture, code) in verbs {
        let out = ["problem.ron", "--out", "out"];
        bench.run(&[verb, &out[..]].concat()).expect(code);
        let path = bench.path("out").join(picture);
        let first = fs::read(&path).unwrap_or_else(|error| panic!("{picture}: {error}"));
        assert!(
            String::from_utf8_lossy(&first).contains("small"),
            "no title in {picture}"
        );
        fs::remove_file(&path).expect("the picture");
        let stdout = bench.run(&["plot", "out"]).expect(0).stdout;
        assert!(stdout.contains(picture), "{stdout}");
        assert_eq!(fs::read(&path).expect("the picture"), first, "{picture}");
        if picture != "space_time.svg" {
            let stderr = bench.run(&["plot", "out", "--log"]).expect(2).stderr;
            assert!(stderr.contains("no branch"), "{stderr}");
        }
        fs::remove_dir_all(bench.path("out")).expect("the folder");
    }
}

/// A shard is no map yet, and proofs have no picture.
#[test]
fn folders_without_a_picture_say_so() {
    let bench = Bench::new();
    bench.put("problem.ron", BASE);
    let shard = ["map", "problem.ron", "--out", "out", "--shard", "1/2"];
    bench.run(&shard).expect(0);
    let stderr = bench.run(&["plot", "out"]).expect(2).stderr;
    assert!(stderr.contains("map merge"), "{stderr}");
}
