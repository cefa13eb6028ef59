//! Rows and tables against the library that reads and writes CSV.

use super::*;
use serde::{Deserialize, Serialize};

#[derive(Debug, Default, PartialEq, Serialize, Deserialize)]
struct Place {
    x: f64,
    y: Option<f64>,
}

#[derive(Debug, Default, PartialEq, Serialize, Deserialize)]
struct Row {
    count: usize,
    #[serde(rename = "type")]
    kind: String,
    place: Place,
    list: Vec<f64>,
    last: f64,
}

#[test]
fn structures_are_columns_and_lists_are_cells() {
    assert_eq!(header::<Row>(), "count,type,x,y,list,last\n");
    let row = Row {
        count: 3,
        kind: "a, \"b\"".to_owned(),
        place: Place {
            x: 1.0 / 3.0,
            y: None,
        },
        list: vec![0.5, -2.0],
        last: f64::NAN,
    };
    assert_eq!(
        line(&row),
        "3,\"a, \"\"b\"\"\",3.3333333333333331e-1,,\
         5.0000000000000000e-1 -2.0000000000000000e0,\n"
    );
}

/// What a cell holds is what is read, and a line is the one that a writer of CSV makes.
#[test]
fn any_words_survive_a_line() {
    let words = [
        "",
        "a",
        "a,b",
        "\"",
        "a\"b",
        "two\nlines",
        "\r",
        "ä → b",
        "a b",
    ];
    for one in words {
        for other in words {
            let cells = [one.to_owned(), other.to_owned(), "end".to_owned()];
            for cells in [&cells[..], &cells[..1], &cells[1..]] {
                let mut writer = csv::Writer::from_writer(Vec::new());
                writer.write_record(cells).unwrap();
                let text = line_of(cells);
                assert_eq!(text.as_bytes(), writer.into_inner().unwrap());
                let mut reader = csv::ReaderBuilder::new();
                let mut reader = reader.has_headers(false).from_reader(text.as_bytes());
                let read = reader.records().next().unwrap().unwrap();
                assert!(read.iter().eq(cells.iter()));
            }
        }
    }
}

/// Reading gives back the same doubles, whatever they are.
#[test]
fn numbers_survive_a_table() {
    let rows: Vec<Place> = (1..100)
        .map(|n| Place {
            x: f64::from(n).sqrt() * 10_f64.powi(6 * n - 300),
            y: (n % 2 == 0).then_some(-f64::MIN_POSITIVE / f64::from(n)),
        })
        .collect();
    let text = table(rows.iter().map(|row| Place { ..*row }));
    let read = Table::parse(text.as_bytes()).unwrap();
    assert_eq!(read.rows::<Place>().unwrap(), rows);
    assert_eq!(read.field::<f64>(3, "x"), Some(rows[3].x));
    // a kill within the last row
    let cut = Table::parse(&text.as_bytes()[..text.len() - 1]).unwrap();
    assert_eq!(cut.len(), rows.len() - 1);
}

/// Numbers are written as the library writes them, ties included, whichever of the two writes.
#[test]
fn numbers_are_those_of_the_library() {
    let exponents = (-40..40).flat_map(|n| [10_f64.powi(n), 2_f64.powi(3 * n)]);
    let factors = (0..200).map(|n| f64::from(n).sqrt() - 3.0);
    let products = exponents.flat_map(|size| factors.clone().map(move |x| x * size));
    // a quarter, a half and three quarters in the seventeenth digit, and what rounds up to the next power of ten
    let ties = (0..400).map(|n| 1_234_567_890_123_456.0 + 0.25 * f64::from(n));
    let nines = (-16..18).flat_map(|n| {
        let power = 10_f64.powi(n);
        [power.next_down(), power, power.next_up()]
    });
    let limits = [0.0, -0.0, 1.0, f64::MAX, f64::MIN_POSITIVE, 5e-324, 3e-310];
    for value in products.chain(ties).chain(nines).chain(limits) {
        assert_eq!(number(value), format!("{value:.16e}"));
    }
}

/// The short way through a table without quotes leads to what the library reads.
#[test]
fn tables_are_those_of_the_library() {
    let plain = "a, b ,c\n1,2,3\n\n4\n , 5 ,\n6,7,8,9\n";
    let table = Table::parse(plain.as_bytes()).unwrap();
    for other in [
        plain.replace('\n', "\r\n"),
        plain.replace('2', "\"2\""),
        format!("\u{feff}{plain}10,11"),
    ] {
        assert_eq!(Table::parse(other.as_bytes()).unwrap(), table);
    }
    assert_eq!(table.columns().collect::<Vec<_>>(), ["a", "b", "c"]);
    assert_eq!(
        [0, 1, 2, 3].map(|row| table.text(row, "b")),
        ["2", "", "5", "7"]
    );
}

#[test]
fn what_is_not_there_is_empty() {
    let table = Table::parse(b"\xef\xbb\xbflabel, a\n1, 2 3\n7\n").unwrap();
    assert_eq!(table.list(0, "a"), [2.0, 3.0]);
    assert_eq!(table.labelled("7"), Some(1));
    assert_eq!((table.text(1, "a"), table.text(5, "a")), ("", ""));
    let selected = table.select(["a", "b", "label"]);
    assert!(selected.eq([["2 3", "", "1"], ["", "", "7"]]));
    assert!(!table.has("b") && table.field::<usize>(0, "b").is_none());
    assert!(table.rows::<Place>().is_err());
}
