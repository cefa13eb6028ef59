//! A result folder as one page of HTML, which opens without a network.
//!
//! The page holds the tables and pictures of the folder. That of a run has a diagram besides, in which
//! pointing at a point shows its wave, its pressure, its spectrum and the sentence of its event: the
//! numbers stand in the page as CSV, thinned out to what a screen can show, and a script draws them.

use std::fmt::Write;
use std::path::Path;

use super::pictures::colours;
use super::run::{BRANCH, EVENTS, RunFolder, SPECTRUM, profile_file};
use super::simulation::SERIES;
use super::store::{self, Kind, Store, StoreError, VERSION, damaged, unfinished};
use super::{accuracy, certify, curve, map, origin, steady};
use crate::problem::Problem;
use crate::table::{self, Table};

/// Name of the page.
pub(crate) const PAGE: &str = "report.html";

/// The page around its content: style and script, with `{{name}}` where content goes.
const FRAME: &str = include_str!("page.html");

/// What the page shows of each kind, at most: together well below a megabyte.
const POINTS: usize = 3_000;
const SAMPLES: usize = 8_000;
/// Events, and eigenvalues.
const EIGENVALUES: usize = 4_000;
const ROWS: usize = 400;
/// Bytes of pictures.
const PICTURES: usize = 250_000;

/// The page of a folder.
///
/// # Errors
/// A table or the saved state is damaged.
pub(crate) fn page(store: &Store) -> Result<String, StoreError> {
    let folder = store.path();
    let names = store.names();
    let there = |name: &str| names.iter().any(|known| known == name) && folder.join(name).exists();
    let problem = origin::problem(folder)?;
    complete(store, problem.as_ref())?;
    let title = problem.as_ref().and_then(|problem| problem.title.clone());
    let kind = store.kind().map_or("", Kind::name);
    let title = title.unwrap_or_else(|| format!("Results of {kind}"));
    let mut data = String::new();
    let mut tables = String::new();
    if let (true, Some(problem)) = (there(BRANCH), &problem) {
        data = branch(folder, problem, &there)?;
    }
    for name in &names {
        let shown = name.ends_with(".csv") && !name.contains('/') && name != BRANCH;
        if shown && there(name) {
            tables.push_str(&listed(name, &store::table(&folder.join(name))?));
        }
    }
    let pretty = ron::ser::PrettyConfig::default();
    let file = problem.and_then(|problem| {
        ron::ser::to_string_pretty(&problem as &dyn erased_serde::Serialize, pretty).ok()
    });
    let content = [
        ("title", escaped(&title)),
        ("kind", kind.to_owned()),
        ("version", VERSION.to_owned()),
        ("colours", colours::of_zones()),
        ("data", data),
        ("pictures", pictures(folder, &names)?),
        ("tables", tables),
        ("problem", escaped(&file.unwrap_or_default())),
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
fn complete(store: &Store, problem: Option<&Problem>) -> Result<(), StoreError> {
    let saved = problem.is_some();
    let (table, verb) = match store.kind() {
        Some(Kind::Run) if saved => (BRANCH, None),
        Some(Kind::Run) => return RunFolder::saved(store).map(|_| ()),
        Some(Kind::Map) => (map::TABLE, Some("map")),
        Some(Kind::Curve) => (curve::TABLE, Some("curve")),
        Some(Kind::Accuracy) => (accuracy::TABLE, Some("accuracy")),
        Some(Kind::Simulation) => (SERIES, (!saved).then_some("simulate")),
        Some(Kind::Certificate) => (certify::TABLE, None),
        Some(Kind::Steady) => (steady::TABLE, None),
        Some(Kind::MapShard) | None => return Ok(()),
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

/// The numbers of a branch, as the script reads them.
fn branch(
    folder: &Path,
    problem: &Problem,
    there: &impl Fn(&str) -> bool,
) -> Result<String, StoreError> {
    let points = store::table(&folder.join(BRANCH))?;
    let parameter = problem.parameter().column();
    let every = points.len().div_ceil(POINTS).max(1);
    let labelled = |row: usize| !points.text(row, "label").is_empty();
    let kept = |row: &usize| row.is_multiple_of(every) || labelled(*row);
    let rows: Vec<usize> = (0..points.len()).filter(kept).collect();
    let columns = [
        parameter, "speed", "point", "leg", "label", "type", "regimes", "stable", "unstable", "why",
    ];
    let mut text = block("points", &points, &rows, &columns);
    let others: [(&str, &str, &[&str]); 2] = [
        ("sentences", EVENTS, &["label", "type", "what"]),
        ("spectrum", SPECTRUM, &["label", "sector", "re", "im"]),
    ];
    for (id, name, columns) in others {
        if there(name) {
            let table = store::table(&folder.join(name))?;
            let rows: Vec<usize> = (0..table.len().min(EIGENVALUES)).collect();
            text.push_str(&block(id, &table, &rows, columns));
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
    for (label, profile) in profiles {
        let last = profile.len().saturating_sub(1);
        let kept = |row: &usize| row.is_multiple_of(every) || *row == last;
        let rows: Vec<usize> = (0..profile.len()).filter(kept).collect();
        let columns = ["theta", "U", "V", "P", "regime"];
        let id = format!("profile-{label}");
        text.push_str(&block(&id, &profile, &rows, &columns));
    }
    Ok(text)
}

/// Some rows and columns of a table as a block of CSV in the page, with as many digits as can be seen.
fn block(id: &str, table: &Table, rows: &[usize], columns: &[&str]) -> String {
    let mut text = format!("<script type=\"text/csv\" id=\"{id}\">\n");
    let names: Vec<String> = columns.iter().map(ToString::to_string).collect();
    text.push_str(&table::line_of(&names));
    for &row in rows {
        let cells = columns.iter().map(|column| short(table.text(row, column)));
        text.push_str(&table::line_of(&cells.collect::<Vec<_>>()));
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

/// A table for reading.
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

/// The pictures of a folder, inside the page.
fn pictures(folder: &Path, names: &[String]) -> Result<String, StoreError> {
    let mut text = String::new();
    let mut room = PICTURES;
    for name in names.iter().filter(|name| name.ends_with(".svg")) {
        let path = folder.join(name);
        if !path.exists() {
            continue;
        }
        let picture = store::read(&path)?;
        if picture.len() > room {
            let _ = writeln!(text, "<p>{} is left out: it is large.</p>", escaped(name));
            continue;
        }
        room -= picture.len();
        let _ = writeln!(
            text,
            "<figure><img alt=\"{0}\" src=\"data:image/svg+xml,{1}\"><figcaption>{0}</figcaption></figure>",
            escaped(name),
            encoded(&picture)
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
        let text = block("points", &table, &[0], &["a", "b"]);
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
