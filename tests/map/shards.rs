//! The same bytes from one thread or many, in one piece or shards, at once or after a kill.

use std::fs;
use std::sync::OnceLock;

use crate::map::{MODEL, files, problem, run, succeed};

fn small() -> String {
    problem(
        "map: (first: (parameter: Friction, range: (0.2, 1.05)), \
         second: (parameter: Mismatch, range: (0.03, 0.2)), \
         points: Grid(rows: 9, columns: 2), starts: [Fast, Slow])",
    )
}

/// Its table, in one piece.
fn whole_table() -> &'static Vec<u8> {
    static TABLE: OnceLock<Vec<u8>> = OnceLock::new();
    TABLE.get_or_init(|| {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path();
        fs::write(path.join("p.ron"), small()).unwrap();
        succeed(path, &["map", "p.ron", "--out", "whole"]);
        fs::read(path.join("whole/map.csv")).unwrap()
    })
}

const TABLES: [&str; 2] = [
    "map.csv",
    if cfg!(feature = "parquet") {
        "map.parquet"
    } else {
        "map.ron"
    },
];

#[test]
fn shards_merge_to_the_bytes_of_one_run() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    fs::write(path.join("p.ron"), small()).unwrap();
    succeed(path, &["map", "p.ron", "--out", "whole", "--threads", "1"]);
    succeed(
        path,
        &["map", "p.ron", "--out", "parallel", "--threads", "3"],
    );
    let shards = ["1/4", "2/4", "3/4", "4/4"].map(|shard| {
        let out = format!("shard{}", &shard[..1]);
        succeed(path, &["map", "p.ron", "--shard", shard, "--out", &out]);
        out
    });
    // a shard alone is no map
    let output = run(
        path,
        &["map", "merge", &shards[0], &shards[1], "--out", "half"],
    );
    assert_eq!(output.status.code(), Some(2));
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(
        said.contains("4 of 9 rows are missing") && said.contains("row 2"),
        "{said}"
    );
    let mut arguments = vec!["map", "merge", "--out", "merged"];
    arguments.extend(shards.iter().rev().map(String::as_str));
    succeed(path, &arguments);
    for name in TABLES {
        let read = |folder: &str| fs::read(path.join(folder).join(name)).unwrap();
        let whole = read("whole");
        assert!(whole.len() > 100);
        assert!(
            whole == read("parallel"),
            "{name} depends on the number of threads"
        );
        assert!(whole == read("merged"), "{name} depends on the shards");
    }
}

/// Parquet holds the very doubles of the CSV, and nothing where that is empty.
#[cfg(feature = "parquet")]
#[test]
fn parquet_holds_the_numbers_of_the_table() {
    use parquet::file::reader::{FileReader, SerializedFileReader};
    use parquet::record::Field;

    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    fs::write(path.join("p.ron"), small()).unwrap();
    succeed(path, &["map", "p.ron", "--out", "m"]);
    let file = fs::File::open(path.join("m/map.parquet")).unwrap();
    let reader = SerializedFileReader::new(file).unwrap();
    // nine rows of two nodes, two starts each, from either of which several waves may be found
    assert!(reader.metadata().file_metadata().num_rows() >= 9 * 2 * 2);
    let mut table = csv::Reader::from_path(path.join("m/map.csv")).unwrap();
    let columns = table.headers().unwrap().len();
    let mut records = table.records();
    for row in reader.get_row_iter(None).unwrap() {
        let record = records.next().unwrap().unwrap();
        let row = row.unwrap();
        assert_eq!((row.len(), record.len()), (columns, columns));
        for ((_, found), text) in row.get_column_iter().zip(&record) {
            let same = match found {
                Field::Null => text.is_empty(),
                Field::Long(value) => text.parse() == Ok(*value),
                Field::Double(value) => text.parse::<f64>().unwrap().to_bits() == value.to_bits(),
                Field::Str(value) => value == text,
                _ => false,
            };
            assert!(same, "{found:?} {text}");
        }
    }
    assert!(records.next().is_none() && columns > 20);
}

#[test]
fn a_killed_map_resumes_to_the_same_files() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    fs::write(path.join("p.ron"), small()).unwrap();
    succeed(path, &["map", "p.ron", "--out", "m"]);
    let whole = files(&path.join("m"));
    // what a kill leaves: some rows, no table
    for name in TABLES {
        if name != "map.ron" {
            fs::remove_file(path.join("m").join(name)).unwrap();
        }
    }
    for row in [0, 4, 7] {
        fs::remove_file(path.join(format!("m/rows/{row:09}.csv"))).unwrap();
    }
    let refused = run(path, &["map", "p.ron", "--out", "m"]);
    assert_eq!(refused.status.code(), Some(2));
    succeed(path, &["map", "p.ron", "--out", "m", "--resume"]);
    assert!(files(&path.join("m")) == whole);
    // and once more with nothing left to do
    succeed(path, &["map", "p.ron", "--out", "m", "--resume"]);
    assert!(files(&path.join("m")) == whole);
    // not with another problem
    fs::write(path.join("q.ron"), small().replace("0.03", "0.04")).unwrap();
    let refused = run(path, &["map", "q.ron", "--out", "m", "--resume"]);
    assert_eq!(refused.status.code(), Some(2));
    succeed(path, &["map", "q.ron", "--out", "m", "--force"]);
    assert!(files(&path.join("m")) != whole);
}

#[test]
fn bad_usage_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    fs::write(path.join("p.ron"), small()).unwrap();
    fs::write(path.join("none.ron"), problem("")).unwrap();
    let given = "(model: (coefficients: Given(a: 1.1, b: 0.3, D: -0.8, g: 18.0, h: 8.5), \
        friction: 0.5, mismatch: 0.2), wave: (mode: 4, start: Fast), \
        map: (first: (parameter: Nu, range: (0.2, 0.3)), second: (parameter: Mismatch, \
        range: (0.03, 0.2)), points: Grid(rows: 2, columns: 2)))";
    fs::write(path.join("given.ron"), given).unwrap();
    for arguments in [
        &["map"][..],
        &["map", "none.ron"],
        &["map", "given.ron"],
        &["map", "p.ron", "--shard", "0/4"],
        &["map", "p.ron", "--shard", "5/4"],
        &["map", "p.ron", "--shard", "2"],
        &["map", "p.ron", "--threads", "0"],
        &["map", "p.ron", "--plot", "map.gif"],
        &["map", "merge", "nowhere", "--out", "x"],
    ] {
        let output = run(path, arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(!said.contains("panicked"), "{said}");
    }
    assert_eq!(fs::read_dir(path).unwrap().count(), 3);
}

/// Four shards in `path`.
fn four(path: &std::path::Path) -> Vec<String> {
    fs::write(path.join("p.ron"), small()).unwrap();
    (1..=4)
        .map(|number| {
            let (shard, out) = (format!("{number}/4"), format!("s{number}"));
            succeed(path, &["map", "p.ron", "--shard", &shard, "--out", &out]);
            out
        })
        .collect()
}

/// A row that is empty, of another place, cut short or without a cell is told, and nothing is
/// written.
#[test]
fn damaged_rows_are_not_joined() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let shards = four(path);
    let mut merge = vec!["map", "merge", "--out", "joined"];
    merge.extend(shards.iter().map(String::as_str));
    let row = path.join("s1/rows/000000004.csv");
    let whole = fs::read_to_string(&row).unwrap();
    let other = fs::read_to_string(path.join("s1/rows/000000008.csv")).unwrap();
    let lines: Vec<&str> = whole.lines().collect();
    let dropped: Vec<&str> = [&lines[..3], &lines[4..]].concat();
    let cells = whole.replacen("slip-stick", "slip", 1);
    let damages = [
        ("empty", String::new()),
        ("another row", other.clone()),
        (
            "another row's cells",
            format!("{}\n{}", lines[0], other.split_once('\n').unwrap().1),
        ),
        ("a cell dropped", dropped.join("\n") + "\n"),
        ("truncated", whole[..whole.len() - 40].to_owned()),
        ("changed", cells),
        ("without its first line", lines[1..].join("\n") + "\n"),
    ];
    for (name, text) in damages {
        assert!(text != whole, "{name}");
        fs::write(&row, text).unwrap();
        let before = files(path);
        let output = run(path, &merge);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(4), "{name}: {said}");
        assert!(
            said.contains("s1/rows/000000004.csv: damaged: "),
            "{name}: {said}"
        );
        assert!(files(path) == before, "{name}");
    }
    // the shard itself computes it once more
    succeed(
        path,
        &["map", "p.ron", "--shard", "1/4", "--out", "s1", "--resume"],
    );
    assert_eq!(fs::read_to_string(&row).unwrap(), whole);
    succeed(path, &merge);
    assert!(&fs::read(path.join("joined/map.csv")).unwrap() == whole_table());
    // a row of another map with the same number
    let q = small().replace("0.03", "0.04");
    fs::write(path.join("q.ron"), q).unwrap();
    succeed(path, &["map", "q.ron", "--out", "other"]);
    fs::copy(path.join("other/rows/000000004.csv"), &row).unwrap();
    merge.push("--force");
    let before = files(path);
    assert_eq!(run(path, &merge).status.code(), Some(4));
    assert!(files(path) == before);
    // shards of another version
    let description = path.join("s1/map.ron");
    let text = fs::read_to_string(&description).unwrap();
    let version = format!("version:\"{}\"", env!("CARGO_PKG_VERSION"));
    let text = text.replacen(&version, "version:\"0.0.7\"", 1);
    fs::write(&description, text).unwrap();
    let output = run(path, &merge);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(
        said.contains("s1/map.ron: written by version 0.0.7"),
        "{said}"
    );
    // not what a map is described by
    fs::write(&description, "(version:").unwrap();
    assert_eq!(run(path, &merge).status.code(), Some(4));
}

/// The folder of a shard, however it is written, keeps its rows when the map is joined there.
#[test]
fn a_map_joined_in_a_shard_loses_no_row() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    four(path);
    let rows = files(&path.join("s1/rows"));
    for (out, code) in [("./s1", 2), ("s2/../s1", 2)] {
        let merge = ["map", "merge", "s1", "s2", "--out", out, "--force"];
        assert_eq!(
            run(path, &merge).status.code(),
            Some(code),
            "rows are missing"
        );
        assert!(files(&path.join("s1/rows")) == rows, "{out}");
    }
    succeed(
        path,
        &[
            "map", "merge", "s1", "s2", "s3", "s4", "--out", "./s1", "--force",
        ],
    );
    assert!(files(&path.join("s1/rows")) == rows);
    assert!(&fs::read(path.join("s1/map.csv")).unwrap() == whole_table());
}

/// Shards in the folder where their map goes are not in its way.
#[test]
fn shards_may_lie_in_the_folder_of_their_map() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    fs::write(path.join("p.ron"), small()).unwrap();
    for shard in ["1/2", "2/2"] {
        succeed(path, &["map", "p.ron", "--shard", shard, "--quiet"]);
    }
    let parts = ["shard-1-of-2", "shard-2-of-2"].map(|name| format!("results/p_map/{name}"));
    let merge = [
        "map",
        "merge",
        &parts[0],
        &parts[1],
        "--out",
        "results/p_map",
    ];
    succeed(path, &merge);
    let shards = parts.each_ref().map(|part| files(&path.join(part)));
    let refused = run(path, &merge);
    assert_eq!(refused.status.code(), Some(2));
    succeed(path, &[&merge[..], &["--force"]].concat());
    assert!(parts.each_ref().map(|part| files(&path.join(part))) == shards);
}

/// What is found to be refused in the first row only: no folder is left, and an old map stays.
#[test]
fn a_map_that_is_refused_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    fs::write(path.join("p.ron"), small()).unwrap();
    let model = MODEL.replace(
        "mismatch: 0.2)",
        "mismatch: 0.2, damping: (stiffness: 0.01))",
    );
    let text = small().replace(
        MODEL,
        &format!("{model} method: Shooting(tolerance: 1e-9),"),
    );
    assert!(text.contains("Shooting") && text.contains("stiffness"));
    fs::write(path.join("refused.ron"), text).unwrap();
    let before = files(path);
    let map = ["map", "refused.ron", "--out", "m/m"];
    assert_eq!(run(path, &map).status.code(), Some(2));
    assert!(files(path) == before && !path.join("m").exists());
    succeed(path, &["map", "p.ron", "--out", "m/m"]);
    let before = files(path);
    let forced = run(path, &[&map[..], &["--force"]].concat());
    assert_eq!(forced.status.code(), Some(2));
    assert!(files(path) == before);
}
