//! A branch on the page of a report: what the script needs to show its points, as blocks of CSV in the page.
//!
//! Waves, orbits and equilibria have the same blocks. `points` are the rows that are shown, with a line of `looks` for each; `columns`
//! what may be drawn over the parameter; `pictures` those beside the diagram, whose numbers are in `values` and in a
//! `profile` of every label. Numbers are thinned out and shortened to what a screen can show.

use std::path::Path;

use crate::output::layout::{EVENTS, profile_file};
use crate::output::pictures::colours::{self, ZoneColours};
use crate::output::pictures::page::{self, Drawn};
use crate::output::store::{self, StoreError};
use crate::problem::Any;
use crate::table::{self, Table};
use crate::tube::model::signature::Regime;

/// What the page shows of a branch at most: of its points, and of all profiles together, rows times columns.
const CELLS: usize = 40_000;
/// Rows of each other table.
const ROWS: usize = 4_000;

/// The data of the script.
#[derive(Default)]
pub(super) struct Explorer {
    pub data: String,
    /// Colours of zones: in the light theme, in the dark one.
    pub style_sheets: [String; 2],
}

/// Collects the data of a branch; adds to what is left out.
///
/// # Errors
/// A table is damaged.
pub(super) fn explorer(
    folder: &Path,
    problem: &Any,
    there: &impl Fn(&str) -> bool,
    left: &mut Vec<String>,
) -> Result<Explorer, StoreError> {
    let drawn = page::drawn(folder, problem)?;
    let mut data = points(&drawn, left);
    data.push_str(&descriptions(&drawn));
    let tables: [(&str, &str, &[&str]); 2] = [
        ("sentences", EVENTS, &["label", "type", "what"]),
        (
            "values",
            drawn.subject.values,
            &["label", "re", "im", "error"],
        ),
    ];
    for (id, name, columns) in tables {
        if there(name) {
            let table = store::table(&folder.join(name))?;
            let shown = table.len().min(ROWS);
            if shown < table.len() {
                let all = table.len();
                left.push(format!("It has the first {shown} of {all} rows of {name}."));
            }
            data.push_str(&block(id, columns, cells(&table, 0..shown, columns)));
        }
    }
    let mut profiles = Vec::new();
    for row in (0..drawn.branch.len()).filter(|row| is_labelled(&drawn.branch, *row)) {
        let label: usize = drawn.branch.field(row, "label").unwrap_or_default();
        let name = profile_file(label);
        if there(&name) {
            profiles.push((label, store::table(&folder.join(&name))?));
        }
    }
    let zones = zones(&drawn, &profiles);
    let mut key = drawn.codes.key();
    // the legend of the zones says it of theirs
    key.retain(|words| {
        !zones
            .iter()
            .any(|zone| drawn.codes.explained(zone) == *words)
    });
    let key = key.into_iter().map(|words| vec![words]);
    data.push_str(&block("key", &["words"], key));
    data.push_str(&sampled(&drawn, &profiles, &zones, left));
    let colours: Vec<ZoneColours> = zones
        .iter()
        .enumerate()
        .map(|(place, name)| match problem {
            Any::Tube(_) => colours::of_wave_zone(Regime::named(name)),
            Any::System(_) => colours::of_mode_zone(place),
        })
        .collect();
    Ok(Explorer {
        data,
        style_sheets: colours::style_sheets(&colours),
    })
}

fn is_labelled(branch: &Table, row: usize) -> bool {
    !branch.text(row, "label").is_empty()
}

/// The points with their looks, as many as the page has room for, all labelled ones among them.
fn points(drawn: &Drawn, left: &mut Vec<String>) -> String {
    let points = &drawn.branch;
    let every = (points.len() * drawn.columns.len()).div_ceil(CELLS).max(1);
    let kept = |row: &usize| row.is_multiple_of(every) || is_labelled(points, *row);
    let rows: Vec<usize> = (0..points.len()).filter(kept).collect();
    if rows.len() < points.len() {
        let (shown, all) = (rows.len(), points.len());
        left.push(format!(
            "The diagram has {shown} of {all} points, all labelled ones among them."
        ));
    }
    let words = ["point", "leg", "label", "stable", "unstable", "why"];
    let numbers = drawn.columns.iter().map(|column| column.name.as_str());
    let numbers = numbers.filter(|name| !words.contains(name));
    let columns: Vec<&str> = numbers.chain(words).collect();
    let mut text = block(
        "points",
        &columns,
        cells(points, rows.iter().copied(), &columns),
    );
    let mut sequences: Vec<&str> = Vec::new();
    let looks: Vec<Vec<String>> = rows
        .iter()
        .map(|&row| {
            let own = points.text(row, "regimes");
            let known = sequences.iter().position(|known| *known == own);
            let sequence = known.unwrap_or(sequences.len());
            if known.is_none() {
                sequences.push(own);
            }
            let [line, mark] = [drawn.lines[row].to_owned(), drawn.marks[row].clone()];
            vec![line, mark, sequence.to_string()]
        })
        .collect();
    text.push_str(&block(
        "looks",
        &["line", "mark", "sequence"],
        looks.into_iter(),
    ));
    let names = sequences.iter().map(|own| vec![drawn.codes.name(own)]);
    text.push_str(&block("sequences", &["name"], names));
    text
}

/// What is drawn, in words: columns, marks and the pictures beside the diagram.
fn descriptions(drawn: &Drawn) -> String {
    let columns = drawn.columns.iter().enumerate().map(|(index, column)| {
        let logarithmic = index == 0 && drawn.logarithmic;
        let logarithmic = if logarithmic { "yes" } else { "no" };
        let words = [&column.name, &column.caption, &column.symbol];
        let words = words.into_iter().cloned();
        words.chain([logarithmic.to_owned()]).collect()
    });
    let header = ["column", "caption", "symbol", "logarithmic"];
    let mut text = block("columns", &header, columns);
    let marks = page::marks(&drawn.marks).into_iter().map(Vec::from);
    text.push_str(&block("marks", &["type", "words", "path", "look"], marks));
    let beside = drawn.subject.beside.iter().map(|picture| {
        let [across, up] = picture.captions.map(str::to_owned);
        let [name, shows] = [picture.name, picture.shows].map(str::to_owned);
        let columns = [&picture.x, &picture.y, &picture.choices].map(Clone::clone);
        let words = [name, shows].into_iter().chain(columns);
        words
            .chain([across, up, picture.height.to_string()])
            .collect()
    });
    let header = [
        "name", "shows", "x", "y", "choices", "across", "up", "height",
    ];
    text.push_str(&block("pictures", &header, beside));
    let noun = vec![drawn.subject.noun.to_owned()];
    text.push_str(&block("subject", &["noun"], [noun].into_iter()));
    text
}

/// The regimes or modes in profiles, in the order in which they come.
fn zones(drawn: &Drawn, profiles: &[(usize, Table)]) -> Vec<String> {
    let mut zones: Vec<String> = Vec::new();
    let Some(column) = drawn.subject.profile.last() else {
        return zones;
    };
    for (_, profile) in profiles {
        for row in 0..profile.len() {
            let own = profile.text(row, column);
            // the last zone is that of most rows
            if zones.last().is_none_or(|last| last != own)
                && !zones.iter().any(|known| known == own)
            {
                zones.push(own.to_owned());
            }
        }
    }
    zones
}

/// The profiles, with the places of their zones in the list of these; adds to what is left out.
fn sampled(
    drawn: &Drawn,
    profiles: &[(usize, Table)],
    zones: &[String],
    left: &mut Vec<String>,
) -> String {
    let named = zones
        .iter()
        .map(|zone| vec![drawn.codes.mode(zone), drawn.codes.explained(zone)]);
    let mut text = block("zones", &["name", "words"], named);
    let Some((zone, columns)) = drawn.subject.profile.split_last() else {
        return text;
    };
    let columns: Vec<&str> = columns.iter().map(String::as_str).collect();
    let header = [&columns[..], &["zone"]].concat();
    let most = (CELLS / (header.len() * profiles.len().max(1))).max(2);
    let mut thinned = false;
    for (label, profile) in profiles {
        let kept = spread(profile, columns[0], most);
        thinned |= kept.len() < profile.len();
        let rows = kept.into_iter().map(|row| {
            let own = profile.text(row, zone);
            let known = zones.iter().position(|known| known == own);
            let numbers = columns
                .iter()
                .map(|column| short(profile.text(row, column)));
            let known = known.map_or_else(String::new, |known| known.to_string());
            numbers.chain([known]).collect()
        });
        text.push_str(&block(&format!("profile-{label}"), &header, rows));
    }
    if thinned {
        left.push(format!(
            "Profiles have some {most} samples each, those at switches among them."
        ));
    }
    text
}

/// About so many rows of a profile, evenly spread along it: its ends, both sides of every switch, which are at one place, and between
/// them rows that are at least a part of its length apart.
fn spread(profile: &Table, column: &str, most: usize) -> Vec<usize> {
    let places: Vec<f64> = (0..profile.len())
        .map(|row| profile.field(row, column).unwrap_or(f64::NAN))
        .collect();
    let (Some(first), Some(last)) = (places.first(), places.last()) else {
        return Vec::new();
    };
    if places.len() <= most {
        return (0..places.len()).collect();
    }
    let apart = (last - first) / most as f64;
    let mut before = f64::NEG_INFINITY;
    let mut kept = Vec::new();
    for (row, &place) in places.iter().enumerate() {
        let beside = [row.checked_sub(1), Some(row + 1)].into_iter().flatten();
        let switches = beside
            .filter_map(|row| places.get(row))
            .any(|other| *other == place);
        let end = row + 1 == places.len();
        // what is no number is no reason to leave a row out
        let near = place - before < apart;
        if !near || switches || end {
            kept.push(row);
            before = place;
        }
    }
    kept
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
    }

    /// Rows are left out where they are close, never at a switch or an end.
    #[test]
    fn profiles_are_thinned_between_switches() {
        let rows: String = (0..100)
            .map(|row| format!("{}\n", f64::from(row) * 0.01))
            .collect();
        let text = format!("time\n{rows}1\n1\n{}", "5\n");
        let table = Table::parse(text.as_bytes()).unwrap();
        let kept = spread(&table, "time", 10);
        assert_eq!(kept, [0, 50, 100, 101, 102]);
        assert_eq!(spread(&table, "time", 200).len(), 103);
        assert!(spread(&Table::default(), "time", 10).is_empty());
    }

    /// Seven digits are kept of a number, and what is no number stays as it is.
    #[test]
    fn numbers_are_shortened_to_what_is_seen() {
        assert_eq!(short("-1.2465331234567890e0"), "-1.246533");
        assert_eq!(short("2.0000000000000000e-12"), "2e-12");
        assert_eq!(short("slip-stick"), "slip-stick");
        assert_eq!(short("17"), "17");
    }
}
