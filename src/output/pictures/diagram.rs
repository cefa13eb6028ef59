//! A column of the branch against the parameter.

use crate::output::render::{
    Axis, BLACK, ColourCell, Extent, GREY, HEIGHT, Heading, Key, Layer, Legend, Mark, MarkShape,
    Panel, Pattern, Pen, Picture, Point, VERMILLION, WHITE, mix,
};
use plotters::style::RGBColor;

use super::codes::Codes;
use super::colours::distinct;
use super::names::{event, event_mark, sequence, short_signature, signature_colour};
use super::tables::{Tables, kind, number};
use super::view::View;
use crate::orbit::EventType;
use crate::orbit::Stability;
use crate::output::store::StoreError;
use crate::table::Table;

/// Most signatures in the legend.
const MOST_NAMED: usize = 9;

/// How much of the colour of a sequence its band keeps.
const BAND: f64 = 0.16;

const CURVE: f64 = 2.2;

/// Part of an axis below which a stretch of a line is hidden by a mark on it: half of one.
const SEEN: f64 = 0.005;

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

impl Standing {
    fn of(branch: &Table, row: usize) -> Self {
        let cell = branch.text(row, "stable");
        let verdicts = [Stability::Yes, Stability::No, Stability::Undecided];
        match verdicts.into_iter().find(|one| one.word() == cell) {
            Some(Stability::Yes) => Standing::Stable,
            Some(Stability::No) => Standing::Unstable,
            Some(Stability::Undecided) => Standing::Undecided,
            None => Standing::Unknown,
        }
    }

    /// The pattern of this standing: solid is said of stable waves only.
    fn pattern(self) -> Pattern {
        match self {
            Standing::Stable => Pattern::Solid,
            Standing::Unstable => Pattern::Dashed,
            Standing::Undecided | Standing::Unknown => Pattern::Dotted,
        }
    }

    /// The line of this standing.
    fn pen(self, colour: RGBColor) -> Pen {
        Pen {
            colour,
            width: CURVE,
            pattern: self.pattern(),
        }
    }
}

/// Explains the lines of these standings.
fn standing_keys(drawn: impl Fn(Standing) -> bool) -> Vec<(Key, &'static str)> {
    use Standing::{Stable, Undecided, Unknown, Unstable};
    let key = |standing: Standing, name| (Key::Line(standing.pen(BLACK)), name);
    let stable = drawn(Stable).then(|| key(Stable, "stable"));
    let unstable = drawn(Unstable).then(|| key(Unstable, "unstable"));
    let open = match (drawn(Undecided), drawn(Unknown)) {
        (true, true) => Some("stability undecided or not asked for"),
        (true, false) => Some("stability undecided"),
        (false, true) => Some("stability not asked for"),
        (false, false) => None,
    };
    let open = open.map(|name| key(Unknown, name));
    stable.into_iter().chain(unstable).chain(open).collect()
}

/// A stretch of the curve drawn the same way.
struct DrawnSegment<'a> {
    signature: &'a str,
    standing: Standing,
    points: Vec<Point>,
}

impl DrawnSegment<'_> {
    /// Whether it covers values of the parameter; what is there at one value only is not seen.
    fn extends(&self) -> bool {
        self.points.windows(2).any(|pair| pair[0].0 != pair[1].0)
    }

    /// Whether it is long enough to be seen in a panel over so much of both axes; the figures of a logarithmic axis are others,
    /// so that there a short one counts as seen.
    fn is_seen(&self, all: [f64; 2]) -> bool {
        let own = extent(self.points.iter());
        let mut parts = own.into_iter().zip(all);
        parts.any(|(own, all)| own >= SEEN * all)
    }
}

/// Width and height of what points cover.
pub(super) fn extent<'a>(points: impl Iterator<Item = &'a Point> + Clone) -> [f64; 2] {
    let width = |values: Option<(f64, f64)>| values.map_or(0.0, |(low, high)| high - low);
    [
        width(ends(points.clone().map(|point| point.0))),
        width(ends(points.map(|point| point.1))),
    ]
}

/// Height of the panel with the count of growing eigenvalues.
const COUNT_HEIGHT: f64 = 0.35 * HEIGHT;

/// The branch diagram: a column and, if stability was asked for, how many eigenvalues grow.
pub(super) fn diagram(tables: &Tables, view: &View) -> Result<Picture, StoreError> {
    let view = view.decided(tables);
    let mut picture = picture(tables, &view)?;
    let branch = &tables.branch;
    let count = |row: usize| number(branch, row, "unstable");
    let place = |row: usize| number(branch, row, &tables.parameter);
    let (mut steps, mut beyond) = (Vec::new(), Vec::new());
    for row in 0..branch.len() {
        if let (Some(x), Some(y)) = (place(row), count(row))
            && view.shows_at(x)
        {
            // the count changes at an event and not on the way to it
            if let Some(&(_, before)) = steps
                .last()
                .filter(|_| row > 0 && same_leg(branch, row - 1))
            {
                // no eigenvalue of the window grows, and the wave is unstable all the same
                let unstable = |row| Standing::of(branch, row) == Standing::Unstable;
                if before == 0.0 && unstable(row - 1) {
                    let from = steps.last().map_or(x, |step: &Point| step.0);
                    beyond.extend([(from, 0.0), (x, 0.0), (f64::NAN, f64::NAN)]);
                }
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
        if !beyond.is_empty() {
            let pen = Pen::solid(VERMILLION, 4.5);
            layers.push(Layer::Line(beyond, pen));
            let words = "in the lower panel: grows at high frequency only";
            picture.legend = picture.legend.with("", [(Key::Line(pen), words)]);
        }
        let panel = Panel::new(view.axis(tables), y, layers);
        picture.panels.push(panel.high(COUNT_HEIGHT));
    }
    Ok(picture)
}

/// A stretch of the parameter with the waves of one sequence.
struct SequenceBand<'a> {
    signature: &'a str,
    ends: [f64; 2],
}

/// The bands from left to right, one for each sequence of regimes; none where the branch turns back, for they
/// would lie on top of each other.
fn bands<'a>(stretches: &[DrawnSegment<'a>]) -> Vec<SequenceBand<'a>> {
    let places = |one: &DrawnSegment<'_>| -> Vec<f64> { one.points.iter().map(|p| p.0).collect() };
    let lines: Vec<Vec<f64>> = stretches.iter().map(places).collect();
    if !one_way(&lines) {
        return Vec::new();
    }
    let groups = stretches.chunk_by(|one, next| one.signature == next.signature);
    let band = |group: &[DrawnSegment<'a>]| {
        let (from, to) = ends(group.iter().flat_map(places))?;
        let signature = group[0].signature;
        let ends = [from, to];
        (from < to && !signature.is_empty()).then_some(SequenceBand { signature, ends })
    };
    let mut all: Vec<SequenceBand<'_>> = groups.filter_map(band).collect();
    all.sort_by(|one, other| one.ends[0].total_cmp(&other.ends[0]));
    // the legs of a branch that is followed both ways meet within a band
    all.dedup_by(|next, one| {
        let on = next.signature == one.signature && next.ends[0] <= one.ends[1];
        if on {
            one.ends[1] = next.ends[1];
        }
        on
    });
    all
}

/// Pale bands behind the curve with their names above them.
fn named_bands(
    bands: &[SequenceBand<'_>],
    signatures: &[&str],
    codes: &Codes,
    colour: &dyn Fn(&str) -> RGBColor,
) -> Vec<Layer> {
    if bands.is_empty() {
        return Vec::new();
    }
    let cell = |band: &SequenceBand<'_>| {
        let colour = mix(WHITE, colour(band.signature), BAND);
        ColourCell::upright(band.ends[0], band.ends[1], colour)
    };
    let heading = |band: &SequenceBand<'_>| {
        let short = codes.name(&short_signature(band.signature));
        let names = [band.signature.to_owned(), short];
        let names = names.map(|name| numbered(band.signature, signatures, name));
        let number = numeral(band.signature, signatures);
        Heading {
            ends: band.ends,
            names: names.into_iter().chain(number).collect(),
        }
    };
    let cells = bands.iter().map(cell).collect();
    let headings = bands.iter().map(heading).collect();
    vec![Layer::Cells(cells), Layer::Headings(headings)]
}

/// The number of a sequence in the legend, by which narrow bands go.
fn numeral(signature: &str, signatures: &[&str]) -> Option<String> {
    let place = signatures.iter().position(|known| *known == signature)?;
    (signatures.len() > 1 && place < MOST_NAMED).then(|| (place + 1).to_string())
}

/// The name of a sequence after its number.
fn numbered(signature: &str, signatures: &[&str], name: String) -> String {
    match numeral(signature, signatures) {
        Some(number) => format!("{number} {name}"),
        None => name,
    }
}

/// The picture of a column of `branch.csv`.
pub(super) fn picture(tables: &Tables, view: &View) -> Result<Picture, StoreError> {
    let view = &view.decided(tables);
    let column = view.column.as_str();
    tables.check_column(column)?;
    let (stretches, marks) = shown(tables, view);
    let bands = bands(&stretches);
    let banded = !bands.is_empty();
    let mut signatures = signatures(&stretches);
    if banded {
        // those that the legend names are numbered from left to right
        let named = signatures.len().min(MOST_NAMED);
        let place = |name: &&str| bands.iter().position(|band| band.signature == *name);
        signatures[..named].sort_by_key(|name| place(name).unwrap_or(usize::MAX));
    }
    let colour = |signature: &str| colour_of(signature, &signatures);
    let short: Vec<String> = signatures.iter().map(|one| short_signature(one)).collect();
    let codes = Codes::of(short.iter().map(String::as_str));
    let mut layers = named_bands(&bands, &signatures, &codes, &colour);
    for stretch in &stretches {
        let pen = stretch.standing.pen(colour(stretch.signature));
        let points = stretch.points.clone();
        layers.push(match points.len() {
            // A branch of one point is a dot, unless an event marks it anyway.
            1 => Layer::Marks(points, Mark::new(MarkShape::Disc, 3.4, pen.colour)),
            _ => Layer::Line(points, pen),
        });
    }
    for (kind, points) in &marks {
        layers.push(Layer::Marks(points.clone(), event_mark(*kind)));
    }
    if stretches.is_empty() && marks.is_empty() {
        let none = tables.branch.is_empty();
        let remark = if none { NONE } else { "no values" };
        layers = vec![Layer::Remark(remark.to_owned())];
    }

    let size = extent(stretches.iter().flat_map(|one| &one.points));
    let drawn = |standing: Standing| {
        let mut all = stretches.iter();
        all.any(|one| one.standing == standing && one.extends() && one.is_seen(size))
    };
    let kinds = EventType::ALL.into_iter();
    let present = kinds.filter(|kind| marks.iter().any(|mark| mark.0 == *kind));
    // one sequence is named above its band
    let coloured = sequence_keys(&signatures, &codes, banded);
    let coloured = coloured
        .into_iter()
        .filter(|_| signatures.len() > 1 || !banded);
    let legend = Legend::default()
        .with("", standing_keys(drawn))
        .with(
            "",
            present.map(|kind| {
                (
                    Key::Mark(event_mark(kind)),
                    format!("{kind} {}", event(kind)),
                )
            }),
        )
        .with("", coloured)
        .with("", codes.key().into_iter().map(|words| (Key::Word, words)));
    let x = view.axis(tables);
    let height = match view.logarithmic_height {
        true => Extent::Logarithmic(0.05),
        false => Extent::Data(0.05),
    };
    let y = Axis::new(tables.quantity(column), height);
    Ok(Picture::new(vec![Panel::new(x, y, layers)], legend))
}

/// The sequences that the legend names, numbered where they have bands, and how many others there are.
fn sequence_keys(signatures: &[&str], codes: &Codes, banded: bool) -> Vec<(Key, String)> {
    let named = signatures.iter().take(MOST_NAMED).map(|signature| {
        let colour = colour_of(signature, signatures);
        let name = codes.name(&short_signature(signature));
        let name = match banded {
            true => numbered(signature, signatures, name),
            false => name,
        };
        (Key::Line(Pen::solid(colour, CURVE + 0.6)), name)
    });
    let others = format!("and {} others", signatures.len().saturating_sub(MOST_NAMED));
    let others = (Key::Line(Pen::solid(GREY, CURVE)), others);
    let others = (signatures.len() > MOST_NAMED).then_some(others);
    named.chain(others).collect()
}

/// The segments of the curve and the events that a view shows.
fn shown<'a>(
    tables: &'a Tables,
    view: &'a View,
) -> (Vec<DrawnSegment<'a>>, Vec<(EventType, Vec<Point>)>) {
    let column = view.column.as_str();
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
    (stretches, marks)
}

/// The colour of a sequence among those of the diagram, the ones that the legend names first.
fn colour_of(signature: &str, signatures: &[&str]) -> RGBColor {
    match signature {
        "" => BLACK,
        // those that the legend does not name
        other if signatures.iter().skip(MOST_NAMED).any(|one| *one == other) => GREY,
        // modes of a user's own have no colour of their own
        of_modes if sequence(of_modes).contains(&None) => {
            let place = signatures.iter().position(|known| *known == of_modes);
            distinct(place.unwrap_or(0))
        }
        of_regimes => signature_colour(of_regimes),
    }
}

/// Signatures in the order of their length along the branch, when there are more than the legend names;
/// otherwise in the order of appearance.
fn signatures<'a>(stretches: &[DrawnSegment<'a>]) -> Vec<&'a str> {
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
    let changes = kind(branch, row).is_some_and(EventType::of_regimes);
    if changes || branch.text(row, "regimes").is_empty() {
        branch.text(row + 1, "regimes")
    } else {
        branch.text(row, "regimes")
    }
}

/// Whether two neighbouring rows belong to the same leg of the branch.
pub(super) fn same_leg(branch: &Table, row: usize) -> bool {
    row + 1 < branch.len() && branch.text(row, "leg") == branch.text(row + 1, "leg")
}

/// Stability of the waves between two neighbouring rows.
fn standing_between(branch: &Table, row: usize) -> Standing {
    use EventType::{BP, HB, LP};
    let [first, second] = [row, row + 1].map(|row| Standing::of(branch, row));
    let [starts, ends] = [row, row + 1].map(|row| {
        let kind = kind(branch, row);
        matches!(kind, Some(LP | HB | BP)) || kind.is_some_and(EventType::of_regimes)
    });
    // On the boundary itself the sign is chance.
    let first_tells = ends || first == Standing::Unknown;
    if first_tells && !starts {
        first
    } else {
        second
    }
}

/// How the line between two neighbouring rows is drawn.
pub(super) fn pattern_between(branch: &Table, row: usize) -> Pattern {
    standing_between(branch, row).pattern()
}

/// Cuts the branch where its look changes, where a value is missing and between legs.
fn stretches<'a>(branch: &'a Table, parameter: &str, column: &str) -> Vec<DrawnSegment<'a>> {
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
        .map(|((signature, standing), points)| DrawnSegment {
            signature,
            standing,
            points,
        })
        .collect()
}

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
