//! A result folder as one page of HTML, which opens without a network.
//!
//! The page holds the tables and pictures of the folder. That of a run has a diagram besides, in which pointing at a point shows
//! its wave, orbit or eigenvalues and the sentence of its event ([`branch`]). The page says what it leaves out.

mod branch;

use std::fmt::Write;

use super::layout::{ACCURACY, BRANCH, CERTIFICATES, CURVE, MAP, SCAN, SERIES, STEADY};
use super::origin;
use super::pictures::page;
use super::run::RunFolder;
use super::store::{self, FolderKind, SOURCE, Store, StoreError, VERSION, damaged, unfinished};
use crate::branch::run::WaveRunner;
use crate::problem::Any;
use crate::table::Table;
use branch::Explorer;

pub(crate) const PAGE: &str = "report.html";

/// The page around its content, with `{{name}}` where content goes, and what draws on it.
const FRAME: &str = include_str!("page.html");
const SCRIPT: &str = include_str!("page.js");

/// What the page shows at most, with what [`branch`] does: together about a megabyte.
/// Rows of a table.
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
    let kind = store.kind().map_or("", FolderKind::name);
    let title = title.unwrap_or_else(|| format!("Results of {kind}"));
    let mut left = Vec::new();
    let mut tables = String::new();
    let explorer = match (there(BRANCH), &problem) {
        (true, Some(problem)) => branch::explorer(folder, problem, &there, &mut left)?,
        _ => Explorer::default(),
    };
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
        false => ("Problem, with all its settings", settings(problem.as_ref())),
    };
    let left = match left.is_empty() {
        true => String::new(),
        false => format!(
            "<p class=\"left\">To keep this page small it leaves out some of what lies beside it. {}</p>",
            left.join(" ")
        ),
    };
    let [zones, dark] = explorer.style_sheets;
    let content = [
        ("title", escaped(&title)),
        ("kind", kind.to_owned()),
        ("version", VERSION.to_owned()),
        ("zones", zones),
        ("dark", dark),
        ("data", explorer.data),
        ("script", SCRIPT.to_owned()),
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
        Some(FolderKind::Run) if saved => (BRANCH, None),
        Some(FolderKind::Run) => return RunFolder::<WaveRunner>::saved(store).map(|_| ()),
        Some(FolderKind::Map) => (MAP, Some("map")),
        Some(FolderKind::Scan) => (SCAN, Some("scan")),
        Some(FolderKind::Curve) => (CURVE, Some("curve")),
        Some(FolderKind::Accuracy) => (ACCURACY, Some("accuracy")),
        Some(FolderKind::Simulation) => (SERIES, (!saved).then_some("simulate")),
        Some(FolderKind::Certificate) => (CERTIFICATES, None),
        Some(FolderKind::Steady) => (STEADY, None),
        Some(FolderKind::MapShard | FolderKind::ScanShard) | None => return Ok(()),
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
fn settings(problem: Option<&Any>) -> String {
    let pretty = ron::ser::PrettyConfig::default();
    let text = problem.and_then(|problem| {
        let problem: &dyn erased_serde::Serialize = match problem {
            Any::Tube(problem) => &**problem,
            Any::System(problem) => &**problem,
        };
        ron::ser::to_string_pretty(problem, pretty).ok()
    });
    text.unwrap_or_default()
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
        let table = Table::parse("a,b\n1,</script><b>\n".as_bytes()).unwrap();
        assert!(!listed("<i>", &table).contains("<b>"));
        assert!(!encoded("<svg fill=\"#fff\"/>").contains(['<', '"', '#']));
    }

    /// A number in a table has all its digits.
    #[test]
    fn numbers_of_tables_keep_their_digits() {
        assert_eq!(digits("5.0228410362756751e-2"), "0.05022841036275675");
    }
}
