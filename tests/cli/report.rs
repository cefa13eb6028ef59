//! A result folder as one page.

use std::fs;
use std::process::Command;

use crate::cli::harness::{Bench, SMALL, Table, changed, problem};

/// The page holds what the folder says, opens without a network, is small, and is the same twice.
#[test]
fn a_report_is_one_page_by_itself() {
    let bench = Bench::new();
    let title = "(\n    title: \"Squeal & <noise>\",\n    model:";
    let problem = changed(SMALL, "(\n    model:", title);
    let wanted =
        "stability: (sectors: Only([0]), eigenvalues: 3, max_frequency: 6.0),\n    output:";
    bench.put("problem.ron", changed(&problem, "output:", wanted));
    bench.run(&["run", "problem.ron", "--out", "out"]).expect(0);
    let said = bench.run(&["report", "out"]).expect(0).stdout;
    assert!(said.trim_end().ends_with("report.html"), "{said}");
    let page = fs::read_to_string(bench.path("out/report.html")).expect("the page");
    assert!(page.len() < 1_000_000, "{} bytes", page.len());
    // names of formats are URLs that nothing is loaded from
    let loads = page.replace("http://www.w3.org/", "");
    assert!(!loads.contains("http://") && !loads.contains("https://"));
    assert!(page.contains("Squeal &amp; &lt;noise&gt;") && !page.contains("<noise>"));
    let left_out = page.contains("leaves out");
    assert!(!left_out, "a small folder is there as a whole");
    let written = fs::read_to_string(bench.path("problem.ron")).expect("the problem");
    let shown = written.replace('&', "&amp;").replace('<', "&lt;");
    let shown = shown.replace('>', "&gt;").replace('"', "&quot;");
    assert!(page.contains(&shown), "the problem file as it was written");
    for part in [
        "alt=\"Branch diagram: speed c against mismatch",
        "prefers-color-scheme: dark",
        "user point mismatch = 0.195",
        "id=\"profile-1\"",
        "id=\"values\"",
        "events.csv",
    ] {
        assert!(page.contains(part), "{part}");
    }
    bench.run(&["report", "out"]).expect(0);
    assert_eq!(
        page,
        fs::read_to_string(bench.path("out/report.html")).unwrap()
    );
    // the folder stays a result folder
    bench.run(&["plot", "out"]).expect(0);
    bench
        .run(&["run", "problem.ron", "--out", "out", "--resume"])
        .expect(0);
    opens_in_a_browser(&bench);
}

/// The script of the page runs to its end in a browser, if one is there.
fn opens_in_a_browser(bench: &Bench) {
    let page = fs::read_to_string(bench.path("out/report.html")).expect("the page");
    let Some(text) = opened(bench, &page) else {
        return;
    };
    assert!(text.contains("class=\"ready\" data-label=\"1\""), "{text}");
    assert!(text.contains("stable: "), "the sentence of the first point");
    // a line for every run of equal stability, not one for every step
    let (_, looks) = page.split_once("id=\"looks\">\n").expect("the looks");
    let rows = looks
        .lines()
        .skip(1)
        .take_while(|line| !line.starts_with("</"));
    let look = |row: &str| row.split(',').next().map(str::to_owned);
    let mut looks: Vec<_> = rows.map(look).collect();
    // the last point begins no line
    looks.pop();
    assert!(looks.len() > 4, "{looks:?}");
    looks.dedup();
    assert_eq!(text.matches("data-line=").count(), looks.len());
    assert!(
        text.contains("<option value=\"amplitude\">"),
        "the choice of the column"
    );
    let beside = text
        .split("id=\"beside\"")
        .nth(1)
        .expect("pictures beside it");
    for name in ["wave", "pressure", "eigenvalues"] {
        assert!(beside.contains(&format!("id=\"{name}\"")), "{name}");
    }
}

/// What a browser makes of a page, if one is there.
fn opened(bench: &Bench, page: &str) -> Option<String> {
    let names = ["chromium", "chromium-browser", "google-chrome"];
    let there = |name: &&str| {
        let version = Command::new(name).arg("--version").output();
        version.is_ok_and(|said| said.status.success())
    };
    let Some(browser) = names.into_iter().find(there) else {
        println!("skipped: there is no browser to open the page in");
        return None;
    };
    let path = bench.put("opened.html", page);
    let url = format!("file://{}", path.display());
    let options = ["--headless", "--no-sandbox", "--disable-gpu", "--dump-dom"];
    let opened = Command::new(browser)
        .args(options)
        .arg(&url)
        .env("HOME", bench.path(""))
        .output()
        .expect("the browser runs");
    Some(String::from_utf8_lossy(&opened.stdout).into_owned())
}

/// A script at the end of a page: keys pressed in the diagram, and the numbers of the points to which they lead.
const KEYS: &str = r#"<script>
const diagram = document.getElementById("diagram"), said = [];
diagram.focus();
said.push(document.activeElement === diagram);
for (const key of ["End", "ArrowRight", "ArrowLeft", "Home", "ArrowLeft", "PageUp", "ArrowUp", "PageDown", "a"]) {
  diagram.dispatchEvent(new KeyboardEvent("keydown", { key, cancelable: true }));
  said.push(diagram.getAttribute("aria-valuenow"));
}
document.body.dataset.said = said.join(" ");
</script>"#;

/// The page of a branch of orbits shows phase plane, time series and multipliers of each label, and is told with the keyboard.
#[test]
fn a_report_of_a_system_shows_its_orbits() {
    let bench = Bench::new();
    bench.put("problem.ron", problem("impact_oscillator.ron"));
    bench.run(&["run", "problem.ron", "--out", "out"]).expect(0);
    bench.run(&["report", "out"]).expect(0);
    let page = fs::read_to_string(bench.path("out/report.html")).expect("the page");
    assert!(page.len() < 1_000_000, "{} bytes", page.len());
    let loads = page.replace("http://www.w3.org/", "");
    assert!(!loads.contains("http://") && !loads.contains("https://"));
    for part in [
        "A,A,A,no",
        "phase,phase,x,v,x v,",
        "time,along,time,x,x v,",
        "multipliers,circle,re,im,,Re μ,Im μ,",
        "id=\"profile-1\"",
        "LP,fold,",
        "fold in A",
    ] {
        assert!(page.contains(part), "{part}");
    }
    let branch = Table::read(&bench.path("out/branch.csv"));
    let rows = branch.rows.len();
    let labelled = |row: &usize| !branch.text(*row, "label").is_empty();
    let second = (0..rows).filter(labelled).nth(1).expect("two labels") + 1;
    let Some(text) = opened(&bench, &page.replace("</body>", &format!("{KEYS}</body>"))) else {
        return;
    };
    let last = rows - 1;
    let next = second + 1;
    let said =
        format!("data-said=\"true {rows} {rows} {last} 1 1 {second} {next} {second} {second}\"");
    assert!(text.contains(&said), "{said}");
    assert!(text.contains("role=\"slider\"") && text.contains("data-label=\"2\""));
    let names = ["phase", "time", "multipliers"];
    for name in names {
        let (_, picture) = text.split_once(&format!("<svg id=\"{name}\"")).expect(name);
        let (picture, _) = picture.split_once("</svg>").expect("its end");
        assert!(picture.contains("of the orbit of label 2"), "{name}");
        let drawn = if name == "multipliers" {
            "<circle"
        } else {
            "<polyline"
        };
        assert!(picture.contains(drawn), "{name}");
    }
}

/// Equilibria have eigenvalues and no profiles, and no word is said of profiles.
#[test]
fn a_report_of_equilibria_shows_eigenvalues() {
    let bench = Bench::new();
    bench.put("problem.ron", problem("brusselator.ron"));
    bench.run(&["run", "problem.ron", "--out", "out"]).expect(0);
    bench.run(&["report", "out"]).expect(0);
    let page = fs::read_to_string(bench.path("out/report.html")).expect("the page");
    assert!(page.contains("eigenvalues,axis,re,im,,"));
    if let Some(text) = opened(&bench, &page) {
        assert!(text.contains("2 eigenvalues of the equilibrium of label 1, 0 with Re"));
        assert!(text.contains("id=\"none\" hidden"));
    }
}

/// Any kind of result folder has a page; what is no result folder is refused.
#[test]
fn every_kind_of_folder_has_a_page() {
    let bench = Bench::new();
    let map = "map: (first: (parameter: Friction, range: (0.4, 0.5)), second: (parameter: Mismatch, \
               range: (0.19, 0.2)), points: Grid(rows: 2, columns: 2), starts: [Fast]),\n    output:";
    bench.put("problem.ron", changed(SMALL, "output:", map));
    bench.run(&["map", "problem.ron", "--out", "map"]).expect(0);
    bench.run(&["report", "map"]).expect(0);
    let page = fs::read_to_string(bench.path("map/report.html")).expect("the page");
    assert!(page.contains("map.csv"), "{page}");
    fs::create_dir(bench.path("other")).expect("a folder");
    let refused = bench.run(&["report", "other"]).expect(2).stderr;
    assert!(refused.contains("no result folder"), "{refused}");
}

/// A new problem file for a verb is one that the verb takes, and has what it reads.
#[test]
fn a_new_file_for_a_verb_runs() {
    let bench = Bench::new();
    let template = |verb: &str| bench.run(&["new", "--for", verb]).expect(0).stdout;
    for verb in ["curve", "steady", "run", "check", "spectrum"] {
        bench.put("new.ron", template(verb));
        bench.run(&[verb, "new.ron"]).expect(0);
    }
    // what takes longer only has its section
    for (verb, section) in [
        ("map", "map: ("),
        ("simulate", "simulation: ("),
        ("certify", "stability: ("),
    ] {
        let text = template(verb);
        assert!(text.contains(&format!("\n    {section}")), "{text}");
    }
    assert!(!template("steady").contains("\n    continuation: ("));
    let [run, plot, report] = ["run", "plot", "report"].map(template);
    assert!(run == plot && run == report && run != template("accuracy"));
}

/// A large picture is left out where small ones have taken the room, and the page says so.
#[test]
fn a_report_says_what_it_leaves_out() {
    let bench = Bench::new();
    bench.put("problem.ron", SMALL);
    bench.run(&["run", "problem.ron", "--out", "out"]).expect(0);
    let page = || {
        bench.run(&["report", "out"]).expect(0);
        fs::read_to_string(bench.path("out/report.html")).expect("the page")
    };
    assert!(page().contains("<figcaption>diagram.svg</figcaption>"));
    let mut picture = fs::read_to_string(bench.path("out/diagram.svg")).expect("the picture");
    picture.push_str(&"<!-- large -->".repeat(50_000));
    bench.put("out/diagram.svg", picture);
    let page = page();
    assert!(!page.contains("<figcaption>diagram.svg</figcaption>"));
    assert!(
        page.contains("<a href=\"diagram.svg\">diagram.svg</a> (7"),
        "the size in KB"
    );
}
