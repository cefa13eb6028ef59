//! The plane of a map. That of waves is coloured by their signatures, in the colours of all pictures; white where no
//! branch comes to a point, hatched where the search for one was cut short. That of a system is coloured by what its
//! motions settle on.

use crate::output::render::{
    Axis, BLACK, CATEGORIES, ColourCell, Extent, GREY, HEIGHT, Key, Layer, Legend, Mark, MarkShape,
    Panel, Pattern, Pen, Picture, Point, Quantity, WHITE, mix,
};
use std::collections::{BTreeMap, HashSet};
use std::path::Path;

use plotters::style::RGBColor;

use super::codes::Codes;
use super::colours::RARE;
use super::names::{quantity, short_signature, signature_colour};
use super::orbit_kind::OrbitKind;
use super::orbits::constants;
use crate::map::{self, NOT_REACHED, UNDECIDED};
use crate::output::layout::MAP;
use crate::output::store::{StoreError, resumable, unfinished};
use crate::problem::{MapPoints, Problem, SystemProblem};

/// How much of its colour a region keeps, by the stability of its waves; unknown stability counts
/// as stable.
const SHADES: [(&str, f64); 3] = [("yes", 1.0), ("undecided", 0.7), ("no", 0.45)];

/// What is shown at a point: the wave of the first passage of a branch, or what a motion settles on.
struct ShownPoint {
    row: usize,
    column: usize,
    at: Point,
    start: String,
    /// What waves have in common that have one colour.
    kind: String,
    stable: String,
}

/// A point without a wave of a start.
struct Blank {
    row: usize,
    column: usize,
    at: Point,
    start: String,
    /// Whether a search was cut short.
    cut: bool,
}

/// The cells of a row of the table by their columns.
type Cells<'a> = &'a dyn Fn(&str) -> String;

/// A plane, and the words for what is in it.
struct DrawnPlane {
    points: MapPoints,
    /// Where its points are, if no columns of the table tell.
    begun: Option<map::MapPlane>,
    /// Name, quantity and range of the second parameter, and of the first.
    x: MapSide,
    y: MapSide,
    /// What a row of the table has: a wave of a kind, nothing, or what is passed over.
    found: fn(Cells) -> MapPoint,
    /// The word before the name of a start.
    start: &'static str,
    /// What stands for an empty picture, for points without a wave, and for those not reached.
    words: [&'static str; 3],
}

struct MapSide {
    column: String,
    quantity: Quantity,
    range: (f64, f64),
}

enum MapPoint {
    Wave(String),
    Blank { cut: bool },
    Further,
}

const NO_SECTION: &str = "there is no section `map`";

/// The picture of the table in a map's folder.
///
/// # Errors
/// When the table cannot be read.
pub(crate) fn picture(folder: &Path, problem: &Problem) -> Result<Picture, StoreError> {
    let Some(map) = &problem.map else {
        return Err(unfinished(folder, "map", NO_SECTION));
    };
    let [x, y] = [&map.second, &map.first].map(|axis| MapSide {
        column: axis.parameter.column().to_owned(),
        quantity: quantity(axis.parameter.column()),
        range: axis.range,
    });
    let plane = DrawnPlane {
        points: map.points,
        begun: None,
        x,
        y,
        found: |cell| match &*cell("passage") {
            "0" => MapPoint::Blank {
                cut: cell("found") == NOT_REACHED,
            },
            "1" => MapPoint::Wave(cell("regimes")),
            _ => MapPoint::Further,
        },
        start: "",
        words: [
            "no wave was found",
            "no branch comes here",
            "not reached: a branch fails before",
        ],
    };
    let (waves, blanks) = plane.read(folder)?;
    let shown = |kind: &str| (signature_colour(kind), short_signature(kind));
    Ok(plane.picture(&waves, &blanks, &shown))
}

/// The same of a system, coloured by signature and period.
///
/// # Errors
/// As [`picture`].
pub(crate) fn of_system(folder: &Path, problem: &SystemProblem) -> Result<Picture, StoreError> {
    let Some(map) = &problem.map else {
        return Err(unfinished(folder, "map", NO_SECTION));
    };
    let [x, y] = [&map.second, &map.first].map(|axis| MapSide {
        column: axis.name().to_owned(),
        quantity: (axis.name(), "").into(),
        range: axis.range,
    });
    let plane = DrawnPlane {
        points: map.points,
        // the columns of states tell of orbits, not where motions begin
        begun: map.is_basin().then(|| map::MapPlane::new(map)),
        x,
        y,
        found: |cell| match &*cell("found") {
            map::NONE => MapPoint::Blank { cut: false },
            UNDECIDED => MapPoint::Blank { cut: true },
            "orbit" => {
                let switches = if cell("switches").is_empty() { "0" } else { "" };
                let orbit = [&cell("periods"), &cell("regimes"), switches];
                MapPoint::Wave(numbered(cell) + &orbit.join(" "))
            }
            "equilibrium" => MapPoint::Wave(numbered(cell) + "equilibrium"),
            other => MapPoint::Wave(other.to_owned()),
        },
        start: "start ",
        words: [
            "no motion is known",
            "the system makes no sense",
            "undecided",
        ],
    };
    let (mut waves, blanks) = plane.read(folder)?;
    let kinds = name_orbits(&mut waves);
    let greys = WITHOUT_ORBIT.map(|(word, share)| (word.to_owned(), mix(WHITE, BLACK, share)));
    let mut colours = BTreeMap::from(greys);
    // all categories but black
    let palette = CATEGORIES[..CATEGORIES.len() - 1].iter().chain(&RARE);
    let orbits = ranked(&waves).into_iter().filter(|kind| is_orbit(kind));
    let mut orbits: Vec<&str> = orbits.take(palette.clone().count()).collect();
    orbits.sort_by_key(|kind| attractor(kind));
    let coloured = orbits.into_iter().zip(palette);
    let coloured = coloured.map(|(kind, colour)| (kind.to_owned(), *colour));
    colours.extend(coloured.collect::<Vec<_>>());
    for wave in waves
        .iter_mut()
        .filter(|wave| !colours.contains_key(&wave.kind))
    {
        OTHERS.clone_into(&mut wave.kind);
    }
    let named = || kinds.iter().filter(|(kind, _)| colours.contains_key(*kind));
    let codes = Codes::of(named().map(|(_, orbit)| orbit.signature.as_str()));
    let shown = |kind: &str| {
        let orbit = kinds.get(kind);
        let words = orbit.map_or_else(|| kind.to_owned(), |orbit| orbit.words(&codes));
        (colours[kind], words)
    };
    let mut picture = plane.picture(&waves, &blanks, &shown);
    let key = codes.key().into_iter().map(|words| (Key::Word, words));
    picture.legend = picture.legend.with("", key);
    let followed = [map.first.name(), map.second.name()];
    let constants = constants(&problem.system.source, &followed);
    Ok(picture
        .titled(problem.title.as_deref())
        .subtitled(&constants))
}

/// Gives all cyclic forms of an orbit one kind: its name, unless another one has that, too. Returns the orbits by their kinds.
fn name_orbits(waves: &mut [ShownPoint]) -> BTreeMap<String, OrbitKind> {
    let mut orbits: BTreeMap<String, OrbitKind> = BTreeMap::new();
    let mut known: BTreeMap<String, String> = BTreeMap::new();
    for ShownPoint { kind, .. } in waves {
        let name = known.entry(kind.clone()).or_insert_with_key(|kind| {
            let Some(orbit) = OrbitKind::read(kind) else {
                return kind.clone();
            };
            if let Some((name, _)) = orbits.iter().find(|(_, other)| **other == orbit) {
                return name.clone();
            }
            let name = orbit.words(&Codes::default());
            let name = if orbits.contains_key(&name) {
                kind.clone()
            } else {
                name
            };
            orbits.insert(name.clone(), orbit);
            name
        });
        kind.clone_from(name);
    }
    orbits
}

/// The number of an attractor in front of its name; nothing in a plane of parameters.
fn numbered(cell: Cells) -> String {
    match &*cell("attractor") {
        "" => String::new(),
        number => format!("{number}: "),
    }
}

/// Orbits beyond those that have colours of their own.
const OTHERS: &str = "other orbits";
/// What leaves every bound: its cells have lines, so that they are told from all greys.
const UNBOUNDED: &str = "unbounded";
const LIGHT_HATCHING: Pen = Pen {
    colour: WHITE,
    width: 1.2,
    pattern: Pattern::Solid,
};
/// What is no orbit, the rest in black with this share.
const WITHOUT_ORBIT: [(&str, f64); 6] = [
    ("not periodic", 0.2),
    ("chattering", 0.35),
    ("slides", 0.5),
    (UNBOUNDED, 0.65),
    ("stuck", 0.8),
    (OTHERS, 1.0),
];

fn is_orbit(kind: &str) -> bool {
    WITHOUT_ORBIT.iter().all(|(word, _)| *word != kind)
}

/// The number with which the kind of an attractor begins, if it has one.
fn attractor(kind: &str) -> Option<usize> {
    kind.split_once(": ")?.0.parse().ok()
}

/// Kinds of waves, those with most points first, and last what is no orbit.
fn ranked(waves: &[ShownPoint]) -> Vec<&str> {
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    for wave in waves {
        *counts.entry(&wave.kind).or_default() += 1;
    }
    let mut names: Vec<&str> = counts.keys().copied().collect();
    names.sort_by_key(|name| (!is_orbit(name), std::cmp::Reverse(counts[name])));
    names
}

impl DrawnPlane {
    /// The picture of what was read; `shown` gives the colour and the name of a kind.
    fn picture(
        &self,
        waves: &[ShownPoint],
        blanks: &[Blank],
        shown: &dyn Fn(&str) -> (RGBColor, String),
    ) -> Picture {
        let mut ranked = ranked(waves);
        // attractors in the order of their numbers
        ranked.sort_by_key(|kind| (!is_orbit(kind), attractor(kind)));
        let kinds: Vec<(&str, (RGBColor, String))> =
            ranked.into_iter().map(|kind| (kind, shown(kind))).collect();
        let colours: BTreeMap<&str, RGBColor> = kinds
            .iter()
            .map(|(kind, (colour, _))| (*kind, *colour))
            .collect();
        let colour = |wave: &ShownPoint| {
            let shade = SHADES.iter().find(|shade| shade.0 == wave.stable);
            let share = shade.map_or(1.0, |shade| shade.1);
            mix(WHITE, colours[&*wave.kind], share)
        };
        let mut starts: Vec<&str> = waves.iter().map(|wave| wave.start.as_str()).collect();
        starts.sort_unstable();
        starts.dedup();
        // half a cell more on either side
        let half = |side: &MapSide, count: usize| {
            0.5 * (side.range.1 - side.range.0) / (count.max(2) - 1) as f64
        };
        let (half_width, half_height) = match self.points {
            MapPoints::Grid { rows, columns } => (half(&self.x, columns), half(&self.y, rows)),
            MapPoints::QuasiRandom { .. } => (0.0, 0.0),
        };
        let axis = |side: &MapSide, half: f64, prefix: &str| {
            let mut quantity = side.quantity.clone();
            quantity.word.insert_str(0, prefix);
            Axis::new(
                quantity,
                Extent::Fixed(side.range.0 - half, side.range.1 + half),
            )
        };
        let panel = |layers, prefix: &str, height| {
            let x = axis(&self.x, half_width, "");
            Panel::new(x, axis(&self.y, half_height, prefix), layers).high(height)
        };
        let panels = starts.iter().map(|start| {
            let shown: Vec<&ShownPoint> =
                waves.iter().filter(|wave| wave.start == *start).collect();
            let cut = blanks.iter().filter(|one| one.cut && one.start == *start);
            let layers = self.layers(&shown, cut, (half_width, half_height), &colour);
            match starts.len() {
                1 => panel(layers, "", HEIGHT),
                _ => panel(layers, &format!("{}{start}: ", self.start), HEIGHT / 1.3),
            }
        });
        let mut panels: Vec<Panel> = panels.collect();
        let [empty, ..] = self.words;
        if panels.is_empty() {
            panels.push(panel(Vec::new(), "", HEIGHT).unless(true, empty));
        }

        let legend = self.legend(waves, blanks, &kinds, &starts);
        Picture::new(panels, legend)
    }

    /// What is shown of one start: waves in their colours, points that a search was `cut` short at, unbounded motions.
    fn layers<'a>(
        &self,
        shown: &[&ShownPoint],
        cut: impl Iterator<Item = &'a Blank>,
        (half_width, half_height): (f64, f64),
        colour: &dyn Fn(&ShownPoint) -> RGBColor,
    ) -> Vec<Layer> {
        match self.points {
            MapPoints::QuasiRandom { .. } => {
                let mut layers = scattered(shown, colour);
                let cut = cut.map(|blank| blank.at).collect();
                layers.push(Layer::Marks(cut, Mark::new(MarkShape::Cross, 3.0, GREY)));
                layers
            }
            MapPoints::Grid { rows, columns } => {
                let mut layers = vec![cells(shown, (half_width, half_height), colour)];
                let cut = cut.map(|blank| (blank.row, blank.column)).collect();
                let corner = (self.x.range.0 - half_width, self.y.range.0 - half_height);
                let cell = (2.0 * half_width, 2.0 * half_height);
                let grid = ((rows, columns), corner, cell);
                layers.extend(hatched(&cut, grid, hatching()));
                let kind = |wave: &&&ShownPoint| wave.kind == UNBOUNDED;
                let unbounded = shown.iter().filter(kind);
                let unbounded = unbounded.map(|wave| (wave.row, wave.column)).collect();
                layers.extend(hatched(&unbounded, grid, LIGHT_HATCHING));
                layers
            }
        }
    }

    /// The colours of kinds, and the marks of points without a wave that are in a panel.
    fn legend(
        &self,
        waves: &[ShownPoint],
        blanks: &[Blank],
        kinds: &[(&str, (RGBColor, String))],
        starts: &[&str],
    ) -> Legend {
        let [_, none, not_reached] = self.words;
        // in the colour of the first: greys are what is no orbit
        let example = kinds.first().map_or(BLACK, |(_, (colour, _))| *colour);
        let shades = SHADES
            .into_iter()
            .filter(|(verdict, _)| waves.iter().any(|wave| wave.stable == *verdict))
            .map(|(verdict, share)| (Key::Area(mix(WHITE, example, share)), verdict));
        let coloured = kinds.iter().map(|(kind, (colour, name))| {
            let lined = *kind == UNBOUNDED && matches!(self.points, MapPoints::Grid { .. });
            let key = match lined {
                true => Key::Hatched(LIGHT_HATCHING, *colour),
                false => Key::Area(*colour),
            };
            (key, name.clone())
        });
        let blank = |cut: bool| {
            let of_panel = |one: &&Blank| one.cut == cut && starts.contains(&one.start.as_str());
            blanks.iter().find(of_panel)
        };
        let cut = match self.points {
            MapPoints::QuasiRandom { .. } => Key::Mark(Mark::new(MarkShape::Cross, 3.0, GREY)),
            MapPoints::Grid { .. } => Key::Hatched(hatching(), WHITE),
        };
        let none = blank(false).map(|_| (Key::Area(WHITE), none.to_owned()));
        let cut = blank(true).map(|_| (cut, not_reached.to_owned()));
        let mut legend = Legend::default().with("", coloured.chain(none).chain(cut));
        // the full colour alone tells nothing
        if waves
            .iter()
            .any(|wave| !["", "yes"].contains(&&*wave.stable))
        {
            legend = legend.with("stable", shades);
        }
        legend
    }

    /// First passages of the table and points without a wave, in its order, row by row: maps may be long.
    fn read(&self, folder: &Path) -> Result<(Vec<ShownPoint>, Vec<Blank>), StoreError> {
        let path = folder.join(MAP);
        if !path.exists() {
            return Err(unfinished(folder, "map", "its rows are not joined yet"));
        }
        let fault = |error: csv::Error| resumable(&path, error.to_string());
        let mut reader = csv::Reader::from_path(&path).map_err(fault)?;
        let header = reader.headers().map_err(fault)?.clone();
        let place = |column: &str| header.iter().position(|name| name == column);
        let needed = ["row", "column", "passage", "start", "regimes", "stable"];
        let sides = [&*self.x.column, &self.y.column];
        let sides = sides.into_iter().filter(|_| self.begun.is_none());
        for column in needed.into_iter().chain(sides) {
            if place(column).is_none() {
                return Err(resumable(&path, format!("it has no column `{column}`")));
            }
        }
        let (mut waves, mut blanks) = (Vec::new(), Vec::new());
        for record in reader.records() {
            let record = record.map_err(fault)?;
            // tables of earlier versions do not tell what was found
            let cell = |column: &str| {
                let cell = place(column).and_then(|place| record.get(place));
                cell.unwrap_or("").to_owned()
            };
            let value = |column: &str| cell(column).parse::<f64>().unwrap_or(f64::NAN);
            let count = |column: &str| cell(column).parse().unwrap_or(usize::MAX - 1);
            let (row, column, start) = (count("row"), count("column"), cell("start"));
            let at = match &self.begun {
                None => (value(&self.x.column), value(&self.y.column)),
                Some(plane) => {
                    let at = plane.point(row, column);
                    at.map_or((f64::NAN, f64::NAN), |[first, second]| (second, first))
                }
            };
            match (self.found)(&cell) {
                MapPoint::Wave(kind) => waves.push(ShownPoint {
                    row,
                    column,
                    at,
                    start,
                    kind,
                    stable: cell("stable"),
                }),
                MapPoint::Blank { cut } => blanks.push(Blank {
                    row,
                    column,
                    at,
                    start,
                    cut,
                }),
                MapPoint::Further => {}
            }
        }
        Ok((waves, blanks))
    }
}

fn scattered(waves: &[&ShownPoint], colour: impl Fn(&ShownPoint) -> RGBColor) -> Vec<Layer> {
    let size = (200.0 / (waves.len().max(1) as f64).sqrt()).clamp(1.0, 4.0);
    let layer = |wave: &&ShownPoint| {
        Layer::Marks(
            vec![wave.at],
            Mark::new(MarkShape::Disc, size, colour(wave)),
        )
    };
    waves.iter().map(layer).collect()
}

/// Rectangles around the points; neighbours of the same colour in a row make one.
fn cells(waves: &[&ShownPoint], half: Point, colour: impl Fn(&ShownPoint) -> RGBColor) -> Layer {
    let rows = waves.chunk_by(|one, next| {
        one.row == next.row && one.column + 1 == next.column && colour(one) == colour(next)
    });
    let cell = |stretch: &[&ShownPoint]| {
        let (first, last) = (stretch[0], stretch[stretch.len() - 1]);
        ColourCell {
            from: (first.at.0 - half.0, first.at.1 - half.1),
            to: (last.at.0 + half.0, last.at.1 + half.1),
            colour: colour(first),
        }
    };
    Layer::Cells(rows.map(cell).collect())
}

/// Lines of the hatching across the panel, how far each leans, as a part of the width, and parts of the
/// height in which they are looked at: less than a pixel.
const HATCHES: usize = 60;
const LEANS: f64 = 0.5;
const PARTS: usize = 600;

fn hatching() -> Pen {
    Pen::solid(GREY, 0.8)
}

/// Leaning lines over these cells of a grid, whose lower left corner and size of a cell are given.
fn hatched(
    cut: &HashSet<(usize, usize)>,
    ((rows, columns), corner, cell): ((usize, usize), Point, Point),
    pen: Pen,
) -> Vec<Layer> {
    if cut.is_empty() {
        return Vec::new();
    }
    let mut layers = Vec::new();
    for number in 0..HATCHES {
        let foot = (1.0 + LEANS) * (number as f64 + 0.5) / HATCHES as f64 - LEANS;
        let place = |part: usize| {
            let up = (part as f64 + 0.5) / PARTS as f64;
            (foot + LEANS * up, up)
        };
        let inside = |part: usize| {
            let (across, up) = place(part);
            let number = |share: f64, count: usize| (share * count as f64) as usize;
            (0.0..1.0).contains(&across)
                && cut.contains(&(number(up, rows), number(across, columns)))
        };
        let parts: Vec<usize> = (0..PARTS).collect();
        for run in parts.chunk_by(|one, next| inside(*one) == inside(*next)) {
            let (first, last) = (run[0], run[run.len() - 1]);
            if inside(first) {
                let ends = [first, last].map(|part| {
                    let (across, up) = place(part);
                    (
                        corner.0 + across * columns as f64 * cell.0,
                        corner.1 + up * rows as f64 * cell.1,
                    )
                });
                layers.push(Layer::Line(ends.to_vec(), pen));
            }
        }
    }
    layers
}

#[cfg(test)]
mod tests {
    use super::*;

    /// White has a legend entry, and only cells that were not reached are hatched.
    #[test]
    fn cells_without_a_wave_are_white_or_hatched() {
        let folder = tempfile::tempdir().unwrap();
        let text = "(
            model: (coefficients: Geometry(nu: 0.3, xi: 1.5, gamma: 1.0), friction: 0.1, mismatch: 0.2),
            wave: (mode: 4, start: Fast),
            map: (
                first: (parameter: Friction, range: (0.1, 0.2)),
                second: (parameter: Mismatch, range: (0.1, 0.2)),
                points: Grid(rows: 2, columns: 2),
                starts: [Fast],
            ),
        )";
        let problem = crate::problem::parse(text, "p.ron").unwrap();
        let table = "row,column,start,passage,found,regimes,mismatch,friction,stable\n\
            0,0,fast,1,wave,slip-stick,0.1,0.1,\n\
            0,1,fast,0,none,,0.2,0.1,\n\
            1,0,fast,0,not reached,,0.1,0.2,\n\
            1,1,fast,1,wave,slip-stick,0.2,0.2,\n";
        std::fs::write(folder.path().join(MAP), table).unwrap();
        let picture = picture(folder.path(), &problem).unwrap();
        let entries = picture
            .legend
            .groups
            .iter()
            .flat_map(|group| &group.entries);
        let words: Vec<&str> = entries.map(|(_, word)| word.as_str()).collect();
        assert_eq!(
            words,
            [
                "sl-st",
                "no branch comes here",
                "not reached: a branch fails before"
            ]
        );
        let lines = picture.panels[0]
            .layers
            .iter()
            .filter_map(|layer| match layer {
                Layer::Line(points, _) => Some(points),
                _ => None,
            });
        let points: Vec<&Point> = lines.flatten().collect();
        assert!(points.len() >= 20);
        assert!(points.iter().all(|(x, y)| *x < 0.15 && *y > 0.15));
    }
}
