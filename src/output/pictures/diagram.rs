//! A column of the branch against the parameter.

use crate::output::render::{
    Axis, BLACK, Cell, Extent, GREY, HEIGHT, Heading, Key, Layer, Legend, Mark, Panel, Pattern,
    Pen, Picture, Point, Shape, WHITE, mix, range,
};
use plotters::style::RGBColor;

use super::names::{event, event_mark, quantity, short_signature, signature_colour};
use super::tables::{Tables, column, kind, number};
use crate::model::{EventType, Parameter};
use crate::output::store::StoreError;
use crate::table::Table;

/// Most signatures in the legend.
const MOST_NAMED: usize = 9;

/// How much of the colour of a sequence its band keeps.
const BAND: f64 = 0.16;

/// Width of the curve.
const CURVE: f64 = 2.2;

/// What an empty picture says.
pub(super) const NONE: &str = "the branch has no points";

/// Stability of a stretch of the curve, as far as it was examined.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Standing {
    Stable,
    Unstable,
    Undecided,
    Unknown,
}

/// Standings, what stands in their cells, what they are called and how they are drawn.
const STANDINGS: [(Standing, &str, &str, Pattern); 4] = {
    use Standing::{Stable, Undecided, Unknown, Unstable};
    [
        (Stable, "yes", "stable", Pattern::Solid),
        (Unstable, "no", "unstable", Pattern::Dashed),
        (Undecided, "undecided", "undecided", Pattern::Dotted),
        (Unknown, "", "not examined", Pattern::Solid),
    ]
};

impl Standing {
    fn of(branch: &Table, row: usize) -> Self {
        let cell = branch.text(row, "stable");
        let known = STANDINGS.iter().find(|standing| standing.1 == cell);
        known.map_or(Standing::Unknown, |standing| standing.0)
    }

    /// The line of this standing; `mixed` when other stretches were examined.
    fn pen(self, colour: RGBColor, mixed: bool) -> Pen {
        let thin = mixed && self == Standing::Unknown;
        Pen {
            colour,
            width: if thin { 0.6 * CURVE } else { CURVE },
            pattern: STANDINGS[self as usize].3,
        }
    }
}

/// A stretch of the curve drawn the same way.
struct Stretch<'a> {
    signature: &'a str,
    standing: Standing,
    points: Vec<Point>,
}

impl Stretch<'_> {
    /// Whether it covers values of the parameter; what is there at one value only is not seen.
    fn extends(&self) -> bool {
        self.points.windows(2).any(|pair| pair[0].0 != pair[1].0)
    }
}

/// What of a column of `branch.csv` is drawn.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct View {
    /// The column.
    pub column: String,
    /// Part of the horizontal axis.
    pub range: (f64, f64),
    /// Whether the horizontal axis is logarithmic; where nothing is said the values decide.
    pub logarithmic: Option<bool>,
}

/// Ratio of the ends of a branch from which on its axis is logarithmic, for else all that happens at
/// small values is one blob.
const WIDE: f64 = 100.0;

/// The same for ε of a smoothed friction law, a scale that goes to zero.
const WIDE_SCALE: f64 = 2.0;

impl View {
    /// All of the horizontal axis.
    pub(crate) const EVERYWHERE: (f64, f64) = (f64::NEG_INFINITY, f64::INFINITY);

    /// A column over the whole branch.
    pub(super) fn whole(column: &str) -> View {
        View {
            column: column.to_owned(),
            range: View::EVERYWHERE,
            logarithmic: None,
        }
    }

    /// The view with its axis decided.
    fn decided(&self, tables: &Tables) -> View {
        let values = column(&tables.branch, &tables.parameter);
        let wide = match Parameter::from_column(&tables.parameter) {
            Some(Parameter::Smoothing) => WIDE_SCALE,
            Some(_) => WIDE,
            None => f64::INFINITY,
        };
        let logarithmic = range(values).is_some_and(|(low, high)| low > 0.0 && high > wide * low);
        View {
            logarithmic: self.logarithmic.or(Some(logarithmic)),
            ..self.clone()
        }
    }

    fn shows(&self, (x, _): &Point) -> bool {
        let (low, high) = self.range;
        (low..=high).contains(x) && (*x > 0.0 || self.logarithmic != Some(true))
    }

    fn axis(&self, parameter: &str) -> Axis {
        let extent = match self.logarithmic {
            Some(true) => Extent::Logarithmic(0.04),
            _ => Extent::Data(0.04),
        };
        Axis::new(quantity(parameter), extent)
    }
}

/// The horizontal axis of pictures over the whole branch.
pub(super) fn parameter_axis(tables: &Tables) -> Axis {
    View::whole("").decided(tables).axis(&tables.parameter)
}

/// More Hopf points than this are strokes on the line: stars would hide it.
const MOST_STARS: usize = 8;

/// Height of the panel with the count of growing eigenvalues.
const COUNT_HEIGHT: f64 = 0.35 * HEIGHT;

/// The branch diagram: a column and, if stability was asked for, how many eigenvalues grow.
pub(super) fn diagram(tables: &Tables, view: &View) -> Result<Picture, StoreError> {
    let view = view.decided(tables);
    let mut picture = picture(tables, &view)?;
    let branch = &tables.branch;
    let count = |row: usize| number(branch, row, "unstable");
    let place = |row: usize| number(branch, row, &tables.parameter);
    let mut steps = Vec::new();
    for row in 0..branch.len() {
        if let (Some(x), Some(y)) = (place(row), count(row))
            && view.shows(&(x, y))
        {
            // the count changes at an event and not on the way to it
            if let Some(&(_, before)) = steps
                .last()
                .filter(|_| row > 0 && same_leg(branch, row - 1))
            {
                steps.push((x, before));
            } else {
                steps.push((f64::NAN, f64::NAN));
            }
            steps.push((x, y));
        }
    }
    if !steps.is_empty() {
        let most = steps.iter().map(|step| step.1).fold(2.0, f64::max);
        let y = Axis::new(("growing", ""), Extent::Fixed(-0.1 * most, 1.15 * most));
        let bands = |layer: &&Layer| matches!(layer, Layer::Cells(_));
        let mut layers: Vec<Layer> = picture.panels[0]
            .layers
            .iter()
            .filter(bands)
            .cloned()
            .collect();
        layers.push(Layer::Line(steps, Pen::solid(BLACK, 1.6)));
        let panel = Panel::new(view.axis(&tables.parameter), y, layers);
        picture.panels.push(panel.high(COUNT_HEIGHT));
    }
    Ok(picture)
}

/// Pale bands behind the curve, one for each sequence of regimes, with their names; none where the branch
/// turns back, for they would lie on top of each other.
fn bands(stretches: &[Stretch<'_>]) -> Vec<Layer> {
    let places = |one: &Stretch<'_>| -> Vec<f64> { one.points.iter().map(|p| p.0).collect() };
    let lines: Vec<Vec<f64>> = stretches.iter().map(places).collect();
    if !one_way(&lines) {
        return Vec::new();
    }
    let (mut cells, mut headings) = (Vec::new(), Vec::new());
    for group in stretches.chunk_by(|one, next| one.signature == next.signature) {
        let signature = group[0].signature;
        let (from, to) = ends(group.iter().flat_map(places)).unwrap_or_default();
        if from < to && !signature.is_empty() {
            let colour = mix(WHITE, signature_colour(signature), BAND);
            cells.push(Cell::upright(from, to, colour));
            headings.push(Heading {
                ends: [from, to],
                names: vec![signature.to_owned(), short_signature(signature)],
            });
        }
    }
    if cells.is_empty() {
        return Vec::new();
    }
    vec![Layer::Cells(cells), Layer::Headings(headings)]
}

/// The picture of a column of `branch.csv`.
pub(super) fn picture(tables: &Tables, view: &View) -> Result<Picture, StoreError> {
    let view = &view.decided(tables);
    let column = view.column.as_str();
    tables.check_column(column)?;
    let mut stretches = stretches(&tables.branch, &tables.parameter, column);
    for stretch in &mut stretches {
        stretch.points.retain(|point| view.shows(point));
    }
    stretches.retain(|stretch| !stretch.points.is_empty());
    let mut marks = tables.marks(column);
    for (_, points) in &mut marks {
        points.retain(|point| view.shows(point));
    }
    marks.retain(|(_, points)| !points.is_empty());
    let signatures = signatures(&stretches);
    let colour = |signature: &str| match signature {
        "" => BLACK,
        signature => signature_colour(signature),
    };
    let hopf = marks.iter().filter(|(kind, _)| *kind == EventType::HB);
    let crowded = hopf.map(|(_, points)| points.len()).sum::<usize>() > MOST_STARS;
    let mark = |kind: EventType| match kind {
        EventType::HB if crowded => Mark::new(Shape::Tick, 6.0, BLACK),
        kind => event_mark(kind),
    };
    let mixed = stretches
        .iter()
        .any(|stretch| stretch.standing != Standing::Unknown);

    let mut layers = bands(&stretches);
    let banded = !layers.is_empty();
    for stretch in &stretches {
        let pen = stretch.standing.pen(colour(stretch.signature), mixed);
        let points = stretch.points.clone();
        layers.push(match points.len() {
            // A branch of one point is a dot, unless an event marks it anyway.
            1 => Layer::Marks(points, Mark::new(Shape::Disc, 3.4, pen.colour)),
            _ => Layer::Line(points, pen),
        });
    }
    for (kind, points) in &marks {
        layers.push(Layer::Marks(points.clone(), mark(*kind)));
    }
    if stretches.is_empty() && marks.is_empty() {
        let none = tables.branch.is_empty();
        let remark = if none { NONE } else { "no values" };
        layers = vec![Layer::Remark(remark.to_owned())];
    }

    let standings = STANDINGS.into_iter().filter(|(standing, ..)| {
        let drawn = |one: &Stretch<'_>| one.standing == *standing && one.extends();
        mixed && stretches.iter().any(drawn)
    });
    let kinds = EventType::ALL.into_iter();
    let present = kinds.filter(|kind| marks.iter().any(|mark| mark.0 == *kind));
    let named = signatures.iter().take(MOST_NAMED).map(|signature| {
        let key = Key::Line(Pen::solid(colour(signature), CURVE + 0.6));
        (key, short_signature(signature))
    });
    let others = format!("and {} others", signatures.len().saturating_sub(MOST_NAMED));
    let others = (Key::Line(Pen::solid(GREY, CURVE)), others);
    let others = (signatures.len() > MOST_NAMED).then_some(others);
    // one sequence is named above its band
    let coloured = named
        .chain(others)
        .filter(|_| signatures.len() > 1 || !banded);
    let legend = Legend::default()
        .with(
            "",
            standings.map(|(one, _, name, _)| (Key::Line(one.pen(BLACK, mixed)), name)),
        )
        .with(
            "",
            present.map(|kind| (Key::Mark(mark(kind)), format!("{kind} {}", event(kind)))),
        )
        .with("", coloured);
    let x = view.axis(&tables.parameter);
    let y = Axis::new(quantity(column), Extent::Data(0.05));
    Ok(Picture::new(vec![Panel::new(x, y, layers)], legend))
}

/// Signatures in the order of their length along the branch, when there are more than the legend names;
/// otherwise in the order of appearance.
fn signatures<'a>(stretches: &[Stretch<'a>]) -> Vec<&'a str> {
    let mut found: Vec<(&str, usize)> = Vec::new();
    for stretch in stretches
        .iter()
        .filter(|one| !one.signature.is_empty() && (one.extends() || one.points.len() == 1))
    {
        let count = stretch.points.len();
        match found.iter_mut().find(|known| known.0 == stretch.signature) {
            Some(known) => known.1 += count,
            None => found.push((stretch.signature, count)),
        }
    }
    if found.len() > MOST_NAMED {
        found.sort_by_key(|known| std::cmp::Reverse(known.1));
    }
    found.into_iter().map(|known| known.0).collect()
}

/// Signature of the waves between two neighbouring rows.
///
/// At an event the row shows one side only; the neighbour knows on which side the step lies.
pub(super) fn signature_between(branch: &Table, row: usize) -> &str {
    if switches_regimes(kind(branch, row)) || branch.text(row, "regimes").is_empty() {
        branch.text(row + 1, "regimes")
    } else {
        branch.text(row, "regimes")
    }
}

/// Whether two neighbouring rows belong to the same leg of the branch.
pub(super) fn same_leg(branch: &Table, row: usize) -> bool {
    row + 1 < branch.len() && branch.text(row, "leg") == branch.text(row + 1, "leg")
}

fn switches_regimes(kind: Option<EventType>) -> bool {
    use EventType::{CO, GR, RV, ST};
    matches!(kind, Some(GR | RV | CO | ST))
}

/// Stability of the waves between two neighbouring rows.
fn standing_between(branch: &Table, row: usize) -> Standing {
    use EventType::{BP, HB, LP};
    let [first, second] = [row, row + 1].map(|row| Standing::of(branch, row));
    let [starts, ends] = [row, row + 1].map(|row| {
        let kind = kind(branch, row);
        matches!(kind, Some(LP | HB | BP)) || switches_regimes(kind)
    });
    // On the boundary itself the sign is chance.
    let first_tells = ends || first == Standing::Unknown;
    if first_tells && !starts {
        first
    } else {
        second
    }
}

/// Cuts the branch where its look changes, where a value is missing and between legs.
fn stretches<'a>(branch: &'a Table, parameter: &str, column: &str) -> Vec<Stretch<'a>> {
    let point = |row| {
        Some((
            number(branch, row, parameter)?,
            number(branch, row, column)?,
        ))
    };
    let step = |row| {
        let next = point(row + 1).filter(|_| same_leg(branch, row));
        let look = match next {
            Some(_) => (
                signature_between(branch, row),
                standing_between(branch, row),
            ),
            None => (branch.text(row, "regimes"), Standing::of(branch, row)),
        };
        Some((look, point(row)?, next))
    };
    let joined = joined(branch.len(), step).into_iter();
    joined
        .map(|((signature, standing), points)| Stretch {
            signature,
            standing,
            points,
        })
        .collect()
}

/// Smallest and largest value.
fn ends(values: impl Iterator<Item = f64>) -> Option<(f64, f64)> {
    let ends = values.map(|value| (value, value));
    ends.reduce(|all, one| (all.0.min(one.0), all.1.max(one.1)))
}

/// Whether lines along the branch pass every value of the parameter once, but for rounding.
pub(super) fn one_way(lines: &[Vec<f64>]) -> bool {
    let steps = lines.iter().flat_map(|line| line.windows(2));
    let travelled: f64 = steps.map(|pair| (pair[1] - pair[0]).abs()).sum();
    let ends = ends(lines.iter().flatten().copied());
    ends.is_none_or(|(low, high)| travelled <= (high - low) * (1.0 + 1e-9))
}

/// Steps from row to row, each with its look, where it begins and where it ends if it leads to the next row;
/// joined where one goes on from the other and looks the same.
pub(super) fn joined<Look: PartialEq, Value: PartialEq>(
    rows: usize,
    step: impl Fn(usize) -> Option<(Look, Value, Option<Value>)>,
) -> Vec<(Look, Vec<Value>)> {
    let mut lines: Vec<(Look, Vec<Value>)> = Vec::new();
    // the row that the last line leads to
    let mut reached = None;
    for row in 0..rows {
        let Some((look, here, next)) = step(row) else {
            continue;
        };
        let leads = next.is_some().then_some(row + 1);
        let on = |line: &&mut (Look, Vec<Value>)| {
            reached == Some(row) && line.0 == look && line.1.last() == Some(&here)
        };
        match lines.last_mut().filter(on) {
            Some(line) => line.1.extend(next),
            None if leads.is_none() && reached == Some(row) => {}
            None => lines.push((look, [here].into_iter().chain(next).collect())),
        }
        reached = leads;
    }
    lines
}
