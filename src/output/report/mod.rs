//! A result folder as one page of HTML, which opens without a network.
//!
//! The page holds the tables and pictures of the folder. That of a run has a diagram besides, in which
//! pointing at a point shows its wave, its pressure, its spectrum and the sentence of its event: the
//! numbers stand in the page as CSV, thinned out to what a screen can show, and a script draws them. The
//! page says what it leaves out.

use std::fmt::Write;
use std::path::Path;

use super::layout::{
    ACCURACY, BRANCH, CERTIFICATES, CURVE, EVENTS, MAP, SCAN, SERIES, SPECTRUM, STEADY,
    profile_file,
};
use super::origin;
use super::pictures::{colours, page};
use super::run::RunFolder;
use super::store::{self, Kind, SOURCE, Store, StoreError, VERSION, damaged, unfinished};
use crate::branch::run::Runner;
use crate::problem::{Any, Problem};
use crate::table::{self, Table};

pub(crate) const PAGE: &str = "report.html";

/// The page around its content: style and script, with `{{name}}` where content goes.
const FRAME: &str = include_str!("page.html");

/// What the page shows of each kind, at most: together about a megabyte.
/// Points times columns.
const CELLS: usize = 40_000;
const SAMPLES: usize = 8_000;
const EIGENVALUES: usize = 4_000;
const ROWS: usize = 400;
/// Bytes of pictures, small ones first.
const PICTURES: usize = 600_000;

/// The page of a folder.
///
/// # Errors
/// A table or the saved state is damaged.
pub(crate) fn page(store: &Store) -> Result<String, StoreError> {
    let folder = store.path();
    let names = store.names();
    let there = |name: &str| names.iter().any(|known| known == name) && folder.join(name).exists();
    let problem = origin::problem(folder)?;
    complete(store, problem.is_some())?;
    let title = problem.as_ref().and_then(|problem| problem.title());
    let title = title.map(str::to_owned);
    let shown = |picture: &str| page::description(picture, store.kind(), problem.as_ref());
    let tube = match &problem {
        Some(Any::Tube(problem)) => Some(&**problem),
        _ => None,
    };
    let kind = store.kind().map_or("", Kind::name);
    let title = title.unwrap_or_else(|| format!("Results of {kind}"));
    let mut left = Vec::new();
    let mut data = String::new();
    let mut tables = String::new();
    if let (true, Some(problem)) = (there(BRANCH), tube) {
        data = branch(folder, problem, &there, &mut left)?;
    }
    for name in &names {
        let shown = name.ends_with(".csv") && !name.contains('/') && name != BRANCH;
        if shown && there(name) {
            tables.push_str(&listed(name, &store::table(&folder.join(name))?));
        }
    }
    let pictures = pictures(store, &shown, &mut left)?;
    let (origin, file) = match there(SOURCE) {
        true => (
            "Problem file, as it was written",
            store::read(&folder.join(SOURCE))?,
        ),
        false => ("Problem, with all its settings", settings(tube)),
    };
    let left = match left.is_empty() {
        true => String::new(),
        false => format!(
            "<p class=\"left\">To keep this page small it leaves out some of what lies beside it. {}</p>",
            left.join(" ")
        ),
    };
    let [zones, dark] = colours::style_sheets();
    let content = [
        ("title", escaped(&title)),
        ("kind", kind.to_owned()),
        ("version", VERSION.to_owned()),
        ("zones", zones),
        ("dark", dark),
        ("data", data),
        ("left", left),
        ("pictures", pictures),
        ("tables", tables),
        ("origin", origin.to_owned()),
        ("problem", escaped(&file)),
    ];
    // each name once, from left to right: content is not searched for names
    let mut page = String::new();
    let mut rest = FRAME;
    while let Some((before, after)) = rest.split_once("{{") {
        page.push_str(before);
        let (name, beyond) = after.split_once("}}").unwrap_or((after, ""));
        let known = content.iter().find(|(known, _)| *known == name);
        page.push_str(known.map_or("", |(_, text)| text));
        rest = beyond;
    }
    page.push_str(rest);
    Ok(page)
}

/// Refuses a folder without the table that all the rest belongs to, or without what must be saved with it.
fn complete(store: &Store, saved: bool) -> Result<(), StoreError> {
    let (table, verb) = match store.kind() {
        Some(Kind::Run) if saved => (BRANCH, None),
        Some(Kind::Run) => return RunFolder::<Runner>::saved(store).map(|_| ()),
        Some(Kind::Map) => (MAP, Some("map")),
        Some(Kind::Scan) => (SCAN, Some("scan")),
        Some(Kind::Curve) => (CURVE, Some("curve")),
        Some(Kind::Accuracy) => (ACCURACY, Some("accuracy")),
        Some(Kind::Simulation) => (SERIES, (!saved).then_some("simulate")),
        Some(Kind::Certificate) => (CERTIFICATES, None),
        Some(Kind::Steady) => (STEADY, None),
        Some(Kind::MapShard | Kind::ScanShard) | None => return Ok(()),
    };
    let path = store.path().join(table);
    let there = path.exists() && !store::table(&path)?.columns().all(str::is_empty);
    match verb {
        _ if there => Ok(()),
        Some(verb) => Err(unfinished(
            store.path(),
            verb,
            format!("{table} is missing"),
        )),
        None => Err(damaged(&path, "it is missing, or has no header")),
    }
}

/// A problem with all its settings, where its file was not kept.
fn settings(problem: Option<&Problem>) -> String {
    let pretty = ron::ser::PrettyConfig::default();
    let text = problem.and_then(|problem| {
        ron::ser::to_string_pretty(problem as &dyn erased_serde::Serialize, pretty).ok()
    });
    text.unwrap_or_default()
}

/// The numbers of a branch, as the script reads them; adds to what is left out.
fn branch(
    folder: &Path,
    problem: &Problem,
    there: &impl Fn(&str) -> bool,
    left: &mut Vec<String>,
) -> Result<String, StoreError> {
    let drawn = page::drawn(folder, problem)?;
    let points = &drawn.branch;
    let every = (points.len() * drawn.columns.len()).div_ceil(CELLS).max(1);
    let labelled = |row: usize| !points.text(row, "label").is_empty();
    let kept = |row: &usize| row.is_multiple_of(every) || labelled(*row);
    let rows: Vec<usize> = (0..points.len()).filter(kept).collect();
    if rows.len() < points.len() {
        let (shown, all) = (rows.len(), points.len());
        left.push(format!(
            "The diagram has {shown} of {all} points, all labelled ones among them."
        ));
    }
    let words = [
        "point", "leg", "label", "regimes", "stable", "unstable", "why",
    ];
    let numbers = drawn.columns.iter().map(|(name, _)| name.as_str());
    let numbers = numbers.filter(|name| !words.contains(name));
    let columns: Vec<&str> = numbers.chain(words).collect();
    let header = [&columns[..], &["line", "mark"]].concat();
    let body = rows.iter().map(|&row| {
        let cells = columns.iter().map(|column| short(points.text(row, column)));
        let look = [drawn.lines[row].to_owned(), drawn.marks[row].clone()];
        cells.chain(look).collect()
    });
    let mut text = block("points", &header, body);
    let axes = drawn
        .columns
        .iter()
        .enumerate()
        .map(|(index, (name, caption))| {
            let logarithmic = if index == 0 && drawn.logarithmic {
                "yes"
            } else {
                "no"
            };
            vec![name.clone(), caption.clone(), logarithmic.to_owned()]
        });
    text.push_str(&block(
        "columns",
        &["column", "caption", "logarithmic"],
        axes,
    ));
    let others: [(&str, &str, &[&str]); 2] = [
        ("sentences", EVENTS, &["label", "type", "what"]),
        ("spectrum", SPECTRUM, &["label", "sector", "re", "im"]),
    ];
    for (id, name, columns) in others {
        if there(name) {
            let table = store::table(&folder.join(name))?;
            let shown = table.len().min(EIGENVALUES);
            if shown < table.len() {
                let all = table.len();
                left.push(format!("It has the first {shown} of {all} rows of {name}."));
            }
            text.push_str(&block(id, columns, cells(&table, 0..shown, columns)));
        }
    }
    let mut profiles = Vec::new();
    for row in (0..points.len()).filter(|row| labelled(*row)) {
        let label: usize = points.field(row, "label").unwrap_or_default();
        let name = profile_file(label);
        if there(&name) {
            profiles.push((label, store::table(&folder.join(&name))?));
        }
    }
    let samples: usize = profiles.iter().map(|(_, table)| table.len()).sum();
    let every = samples.div_ceil(SAMPLES).max(1);
    if every > 1 {
        left.push(format!("Of the profiles one sample in {every} is here."));
    }
    for (label, profile) in profiles {
        let last = profile.len().saturating_sub(1);
        let kept = |row: &usize| row.is_multiple_of(every) || *row == last;
        let rows = (0..profile.len()).filter(kept);
        let columns = ["theta", "U", "V", "P", "regime"];
        let id = format!("profile-{label}");
        text.push_str(&block(&id, &columns, cells(&profile, rows, &columns)));
    }
    Ok(text)
}

/// Some rows and columns of a table, with as many digits as can be seen.
fn cells(
    table: &Table,
    rows: impl Iterator<Item = usize>,
    columns: &[&str],
) -> impl Iterator<Item = Vec<String>> {
    let cells = move |row| {
        columns
            .iter()
            .map(|column| short(table.text(row, column)))
            .collect()
    };
    rows.map(cells)
}

/// Rows as a block of CSV in the page.
fn block(id: &str, columns: &[&str], rows: impl Iterator<Item = Vec<String>>) -> String {
    let mut text = format!("<script type=\"text/csv\" id=\"{id}\">\n");
    let names: Vec<String> = columns.iter().map(ToString::to_string).collect();
    text.push_str(&table::line_of(&names));
    for row in rows {
        text.push_str(&table::line_of(&row));
    }
    // nothing inside may end the element
    let end = text.len().min(id.len() + 33);
    let body = text.split_off(end).replace("</", "<\\/");
    text + &body + "</script>\n"
}

/// A cell with seven significant digits, if it is a number of more.
fn short(cell: &str) -> String {
    match cell.parse::<f64>() {
        Ok(value) if cell.len() > 9 && value.is_finite() => {
            let rounded: f64 = format!("{value:.6e}").parse().unwrap_or(value);
            let (plain, scientific) = (format!("{rounded}"), format!("{rounded:e}"));
            if plain.len() <= scientific.len() {
                plain
            } else {
                scientific
            }
        }
        _ => cell.to_owned(),
    }
}

fn listed(name: &str, table: &Table) -> String {
    let name = escaped(name);
    let mut text = format!("<details><summary>{name}</summary>\n<table>\n<tr>");
    let columns: Vec<&str> = table
        .columns()
        .filter(|column| (0..table.len()).any(|row| !table.text(row, column).is_empty()))
        .collect();
    // writing to a string does not fail
    for column in &columns {
        let _ = write!(text, "<th>{}</th>", escaped(column));
    }
    text.push_str("</tr>\n");
    for row in 0..table.len().min(ROWS) {
        text.push_str("<tr>");
        for column in &columns {
            let cell = escaped(&digits(table.text(row, column)));
            let _ = write!(text, "<td>{cell}</td>");
        }
        text.push_str("</tr>\n");
    }
    text.push_str("</table>\n");
    if table.len() > ROWS {
        let _ = writeln!(text, "<p>{ROWS} of {} rows.</p>", table.len());
    }
    text.push_str("</details>\n");
    text
}

/// A number of a table to all its digits, without an exponent where that is short.
fn digits(cell: &str) -> String {
    match cell.parse::<f64>() {
        Ok(value) if cell.contains('e') && (1e-4..1e6).contains(&value.abs()) => format!("{value}"),
        Ok(0.0) => "0".to_owned(),
        _ => cell.to_owned(),
    }
}

/// The pictures of a folder, inside the page, as many of them as there is room for, small ones first; adds to
/// what is left out.
fn pictures(
    store: &Store,
    shown: &dyn Fn(&str) -> String,
    left: &mut Vec<String>,
) -> Result<String, StoreError> {
    let folder = store.path();
    let mut found = Vec::new();
    for name in store.names() {
        if name.ends_with(".svg") && folder.join(&name).exists() {
            found.push((store::read(&folder.join(&name))?, name));
        }
    }
    let mut sizes: Vec<usize> = found.iter().map(|(picture, _)| picture.len()).collect();
    sizes.sort_unstable();
    let sums = sizes.iter().scan(0, |sum, size| {
        *sum += size;
        Some((*sum, *size))
    });
    let largest = sums.take_while(|(sum, _)| *sum <= PICTURES).last();
    let largest = largest.map_or(0, |(_, size)| size);
    let mut text = String::new();
    for (picture, name) in &found {
        let shown = escaped(&shown(name));
        let name = escaped(name);
        if picture.len() > largest {
            let (size, limit) = (picture.len().div_ceil(1000), PICTURES / 1000);
            left.push(format!(
                "The picture <a href=\"{name}\">{name}</a> ({size} KB) is not in it: pictures take {limit} KB \
                 at most, the smallest first."
            ));
            continue;
        }
        let data = encoded(picture);
        let _ = writeln!(
            text,
            "<figure><img alt=\"{shown}\" src=\"data:image/svg+xml,{data}\"><figcaption>{name}</figcaption></figure>"
        );
    }
    Ok(text)
}

/// A text for a URL of data: percent-encoded where a browser needs it.
fn encoded(text: &str) -> String {
    let mut encoded = String::with_capacity(text.len() + text.len() / 4);
    for c in text.chars() {
        match c {
            '\n' | '\r' | '\t' => encoded.push(' '),
            '%' | '#' | '<' | '>' | '"' | '&' | '{' | '}' | '\\' | '^' | '`' | '|' | '?' => {
                let _ = write!(encoded, "%{:02X}", u32::from(c));
            }
            c => encoded.push(c),
        }
    }
    encoded
}

/// A text that stands in HTML or XML for itself.
pub(crate) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// No text of a folder can end the element it stands in.
    #[test]
    fn texts_stay_where_they_are_put() {
        let hostile = "a,b\n1,</script><b>\n";
        let table = Table::parse(hostile.as_bytes()).unwrap();
        let columns = ["a", "b"];
        let text = block("points", &columns, cells(&table, 0..1, &columns));
        assert_eq!(text.matches("</").count(), 1);
        assert!(text.ends_with("</script>\n"));
        assert!(!listed("<i>", &table).contains("<b>"));
        assert!(!encoded("<svg fill=\"#fff\"/>").contains(['<', '"', '#']));
    }

    /// Seven digits are kept of a number, and what is no number stays as it is.
    #[test]
    fn numbers_are_shortened_to_what_is_seen() {
        assert_eq!(short("-1.2465331234567890e0"), "-1.246533");
        assert_eq!(short("2.0000000000000000e-12"), "2e-12");
        assert_eq!(short("slip-stick"), "slip-stick");
        assert_eq!(short("17"), "17");
        assert_eq!(digits("5.0228410362756751e-2"), "0.05022841036275675");
    }
}
