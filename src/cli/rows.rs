//! `brakewave map` and `brakewave scan`: tables that are computed row by row, and `merge` of both.

use std::fs;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use clap::{Args, Subcommand};

use super::failure::{Usage, VerbExit, VerbFailure};
use super::options::{Task, Threads, cores, picture, read_any};
use super::progress::{ProgressLine, WorkTally, tallied};
use super::{interrupt, print, stopped};
use crate::hybrid::scan::{ScannedMotion, Scanner};
use crate::map::{self, Attractors, Cell, CellRow, Draws, MotionOutcome, Motions};
use crate::messages::AWAY;
use crate::output::attractors;
use crate::output::layout::{self, SCAN};
use crate::output::origin::ProblemOrigin;
use crate::output::pictures;
use crate::output::render::{Format, Picture};
use crate::output::rows::{Mapped, Rowed, RowsFolder, of_shard};
use crate::output::scan::{last, lines};
use crate::output::store::{self, Existing, SOURCE, Store, StoreError};
use crate::problem::{self, Any, Problem, SystemMap, SystemProblem, refuse_at};
use crate::table;

#[derive(Debug, Args)]
#[command(args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
pub(crate) struct RowsArguments {
    #[command(subcommand)]
    verb: Option<RowsVerb>,
    /// Its problem file has a section of the name of the verb
    #[command(flatten)]
    task: Option<Task>,
    #[command(flatten)]
    threads: Threads,
    /// Compute only every Nth row of a map or sweep of a scan, from the Ith: I/N with 1 ≤ I ≤ N; `merge` joins the
    /// shards
    #[arg(long, value_name = "I/N")]
    shard: Option<Shard>,
    /// Draw the picture here too: FILE.svg, .png, .pdf or .tex
    #[arg(long, value_name = "FILE", conflicts_with = "shard")]
    plot: Option<PathBuf>,
}

#[derive(Debug, Subcommand)]
enum RowsVerb {
    /// Join shards to one table, the same as that of what is computed at once
    Merge(MergeArguments),
}

#[derive(Debug, Args)]
struct MergeArguments {
    /// Folders of the shards
    #[arg(required = true)]
    shards: Vec<PathBuf>,
    /// Folder for the joined table
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Replace an earlier one
    #[arg(long)]
    force: bool,
    /// Print nothing but errors
    #[arg(short, long)]
    quiet: bool,
    /// Draw the picture here too: FILE.svg, .png, .pdf or .tex
    #[arg(long, value_name = "FILE")]
    plot: Option<PathBuf>,
}

/// Which rows of a map, or sweeps of a scan: those with index ≡ i − 1 modulo n.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Shard {
    number: usize,
    of: usize,
}

impl FromStr for Shard {
    type Err = Usage;

    fn from_str(text: &str) -> Result<Shard, Usage> {
        let numbers = text
            .split_once('/')
            .and_then(|(number, of)| Some((number.parse().ok()?, of.parse().ok()?)));
        match numbers {
            Some((number, of)) if 1 <= number && number <= of => Ok(Shard { number, of }),
            _ => Err(Usage::Shard),
        }
    }
}

/// More threads than this are not started, nor more than there are rows: they would only wait.
const MOST_THREADS: usize = 256;

/// Computes the text of a row. What comes before it in its sweep is there where it is not the first.
type Work<'a> = Box<dyn Fn(usize, Option<&str>) -> Result<String, VerbFailure> + Sync + 'a>;

/// A verb that computes a table row by row.
pub(crate) trait RowVerb: Rowed + Sync {
    /// Ending of the default folder.
    const ENDING: &'static str;

    /// The problem of a file, with its section.
    fn read(task: &Task) -> Result<Self, VerbFailure>;
    /// What the results are computed from.
    fn inputs(&self, task: &Task) -> Vec<PathBuf>;
    /// Rows that are computed one after the other, each from the one before.
    fn sweeps(&self) -> Vec<Range<usize>> {
        (0..self.rows()).map(|row| row..row + 1).collect()
    }

    /// What computes a row.
    fn work(&self, quiet: bool) -> Result<Work<'_>, VerbFailure>;
    /// Joins the rows of folders, and makes what follows from all of them.
    fn join(&self, folder: &RowsFolder<Self>, from: &[PathBuf]) -> Result<(), VerbFailure> {
        Ok(folder.join(from, &mut |_, cells| Ok(cells))?)
    }

    /// The picture of the table in a folder.
    fn picture(&self, folder: &Path) -> Result<Picture, StoreError>;
    /// How the verb ends, after all rows were joined.
    fn end(&self, _: &RowsFolder<Self>) -> Result<VerbExit, VerbFailure> {
        Ok(VerbExit::Done)
    }
}

/// Draws the picture in the folder, and the one asked for besides.
fn draw<P: RowVerb>(
    problem: &P,
    store: &Store,
    asked: Option<(&Path, Format)>,
) -> Result<(), VerbFailure> {
    let picture = problem.picture(store.path())?;
    if let Some((path, format)) = asked {
        let bytes = picture.file(format).map_err(pictures::PlotError::from)?;
        fs::write(path, bytes).map_err(store::io_error("write it", path))?;
    }
    let named = [(P::FILES.kind.name().to_owned(), Ok(picture))];
    pictures::put(store, None, Format::Svg, named)?;
    Ok(())
}

/// `brakewave map`, of waves or of a system.
pub(crate) fn map(arguments: &RowsArguments) -> Result<VerbExit, VerbFailure> {
    let of_system = match (&arguments.verb, &arguments.task) {
        (Some(RowsVerb::Merge(arguments)), _) => {
            let mut shards = arguments.shards.iter();
            // each kind lacks what the other has
            shards.any(|shard| of_shard::<Mapped<SystemProblem>>(shard).is_ok())
        }
        (None, Some(task)) => matches!(problem::read_any(&task.problem)?.0, Any::System(_)),
        (None, None) => false,
    };
    match of_system {
        true => rows::<Mapped<SystemProblem>>(arguments),
        false => rows::<Mapped<Problem>>(arguments),
    }
}

pub(crate) fn rows<P: RowVerb>(arguments: &RowsArguments) -> Result<VerbExit, VerbFailure> {
    match (&arguments.verb, &arguments.task) {
        (Some(RowsVerb::Merge(arguments)), _) => merge::<P>(arguments),
        (None, Some(task)) => run::<P>(arguments, task),
        (None, None) => Err(Usage::NoProblem.into()),
    }
}

fn run<P: RowVerb>(arguments: &RowsArguments, task: &Task) -> Result<VerbExit, VerbFailure> {
    let problem = P::read(task)?;
    let mut out = task.folder(P::ENDING);
    let inputs = problem.inputs(task);
    let picture = picture(arguments.plot.as_deref(), &inputs)?;
    let shard = arguments.shard.unwrap_or(Shard { number: 1, of: 1 });
    let kind = if shard.of > 1 {
        P::FILES.shard
    } else {
        P::FILES.kind
    };
    if shard.of > 1 && task.out.is_none() {
        out.push(format!("shard-{}-of-{}", shard.number, shard.of));
    }
    let existing = Existing::of(task.resume, task.force);
    let store = Store::open(&out, kind, &problem, existing, &inputs)?;
    let folder = RowsFolder::new(store, ProblemOrigin::of(&problem))?;
    let finished = folder.finished()?;
    let is_open = |row: &usize| finished.binary_search(row).is_err();
    let sweeps = problem.sweeps().into_iter().skip(shard.number - 1);
    let own: Vec<Range<usize>> = sweeps.step_by(shard.of).collect();
    let all = own.iter().map(ExactSizeIterator::len).sum();
    let sweeps: Vec<Range<usize>> = own
        .into_iter()
        .filter(|rows| rows.clone().any(|row| is_open(&row)))
        .collect();
    let rows: Vec<usize> = sweeps.iter().cloned().flatten().filter(is_open).collect();
    if task.resume && !finished.is_empty() {
        interrupt::progress_is_kept();
    }
    let most = sweeps.len().min(MOST_THREADS);
    arguments.threads.install(cores(), most, || {
        if rows.is_empty() {
            return Ok(());
        }
        let work = problem.work(task.quiet)?;
        let tally = WorkTally {
            before: all - rows.len(),
            all,
            what: "rows",
        };
        tallied(task.quiet, &sweeps, tally, |sweep, done| {
            let mut before = None;
            for row in sweep.clone() {
                if !is_open(&row) {
                    before = None;
                    continue;
                }
                if before.is_none() && row > sweep.start {
                    before = Some(folder.row(row - 1)?);
                }
                let cells = work(row, before.as_deref())?;
                // the first row that is there replaces earlier results
                folder.begin(&rows)?;
                folder.write(row, &cells)?;
                interrupt::progress_is_kept();
                before = Some(cells);
                done();
            }
            Ok::<(), VerbFailure>(())
        })
    })?;
    folder.begin(&rows)?;
    let (what, exit) = match shard.of {
        1 => {
            problem.join(&folder, std::slice::from_ref(&out))?;
            draw(&problem, folder.store(), picture)?;
            (P::FILES.kind.name(), problem.end(&folder)?)
        }
        _ => ("shard", VerbExit::Done),
    };
    task.say("", what, &out)?;
    Ok(exit)
}

fn merge<P: RowVerb>(arguments: &MergeArguments) -> Result<VerbExit, VerbFailure> {
    let picture = picture(arguments.plot.as_deref(), &[])?;
    let (first, others) = arguments.shards.split_first().ok_or(Usage::NoProblem)?;
    let origin = of_shard::<P>(first)?;
    for shard in others {
        if of_shard::<P>(shard)? != origin {
            return Err(Usage::OtherShards(first.clone(), shard.clone()).into());
        }
    }
    let canonical = |path: &PathBuf| fs::canonicalize(path).ok();
    let out = canonical(&arguments.out);
    let own = out.is_some() && arguments.shards.iter().any(|shard| canonical(shard) == out);
    // a shard may be joined in its own folder, whose rows stay then
    let existing = Existing::of(own, arguments.force);
    let problem = origin.problem.clone();
    // the problem file as it was written goes along
    let source = (!own).then(|| first.join(SOURCE));
    let inputs: Vec<PathBuf> = source.into_iter().collect();
    let store = Store::open(&arguments.out, P::FILES.kind, &problem, existing, &inputs)?;
    let folder = RowsFolder::new(store, origin)?;
    problem.join(&folder, &arguments.shards)?;
    draw(&problem, folder.store(), picture)?;
    let exit = problem.end(&folder)?;
    if !arguments.quiet {
        let what = P::FILES.kind.name();
        print(&format!("{what} in {}\n", arguments.out.display()))?;
    }
    Ok(exit)
}

const MAP: &str = "_map";

impl RowVerb for Mapped<Problem> {
    const ENDING: &'static str = MAP;

    fn read(task: &Task) -> Result<Mapped<Problem>, VerbFailure> {
        let (problem, text, name) = task.read()?;
        problem.map(&text, &name)?;
        Ok(Mapped(problem))
    }

    fn inputs(&self, task: &Task) -> Vec<PathBuf> {
        task.inputs(&self.0)
    }

    fn work(&self, quiet: bool) -> Result<Work<'_>, VerbFailure> {
        let Some(section) = &self.0.map else {
            return Err(Usage::NoProblem.into());
        };
        let progress = ProgressLine::new(quiet);
        let mut watch = |waves: usize| {
            progress.show(
                f64::NAN,
                format!("{waves} waves on lines through the plane"),
            );
        };
        let map = map::Rows::new(&self.0, section, &mut watch)?;
        Ok(Box::new(move |row, _| {
            let cells: Vec<Cell> = map.row(row)?;
            Ok(cells
                .iter()
                .map(|cell| table::line(&CellRow::new(cell)))
                .collect())
        }))
    }

    fn picture(&self, folder: &Path) -> Result<Picture, StoreError> {
        let picture = pictures::map::picture(folder, &self.0)?;
        Ok(pictures::of_problem(&self.0, picture))
    }
}

impl Mapped<SystemProblem> {
    /// Rows of the plane: those of shares come after them.
    fn plane_rows(&self) -> usize {
        let map = self.0.map.as_ref();
        map.map_or(0, |map| map::MapPlane::new(map).rows())
    }
}

impl RowVerb for Mapped<SystemProblem> {
    const ENDING: &'static str = MAP;

    fn read(task: &Task) -> Result<Mapped<SystemProblem>, VerbFailure> {
        let (problem, text, name) = of_system(task)?;
        problem.map(&text, &name)?;
        Ok(Mapped(problem))
    }

    fn inputs(&self, task: &Task) -> Vec<PathBuf> {
        vec![task.problem.clone()]
    }

    fn work(&self, _: bool) -> Result<Work<'_>, VerbFailure> {
        let motions = Motions::new(&self.0).ok_or(Usage::NoBeginning)?;
        let draws = Draws::new(&self.0);
        let plane = self.plane_rows();
        Ok(Box::new(move |row, _| {
            let drawn = draws.as_ref().zip(row.checked_sub(plane));
            let cells: Vec<MotionOutcome> = match drawn {
                Some((draws, value)) => draws.row(value),
                None => motions.row(row),
            };
            let basin = self.0.map.as_ref().is_some_and(SystemMap::is_basin);
            let line = |cell: &MotionOutcome| {
                let row = CellRow::settled(&self.0.system, cell);
                match basin || drawn.is_some() {
                    true => table::line(&CellRow::of_basin(row, cell.mark.as_ref())),
                    false => table::line(&row),
                }
            };
            Ok(cells.iter().map(line).collect())
        }))
    }

    fn join(&self, folder: &RowsFolder<Self>, from: &[PathBuf]) -> Result<(), VerbFailure> {
        let basin = self.0.map.as_ref().is_some_and(SystemMap::is_basin);
        let motions = Motions::new(&self.0).ok_or(Usage::NoBeginning)?;
        let draws = Draws::new(&self.0);
        let mut known = Attractors::new(&motions, &self.0.system);
        let path = folder.path().join(layout::MAP);
        let columns = CellRow::of_basin(CellRow::columns(&self.0.system.source), None);
        let header = table::line_of(&table::columns(&columns));
        let place = (path.as_path(), header.as_str());
        let mut shares = attractors::header_of_shares(&self.0);
        let plane = self.plane_rows();
        folder.join(
            from,
            &mut |row, cells| match draws.as_ref().zip(row.checked_sub(plane)) {
                Some((draws, value)) => {
                    let mut own = draws.attractors(value);
                    let at = self.first(row).unwrap_or(f64::NAN);
                    shares.push_str(&attractors::shares(&mut own, at, place, &cells)?);
                    Ok(String::new())
                }
                None if basin => attractors::number(&mut known, place, &cells),
                None => Ok(cells),
            },
        )?;
        if basin {
            attractors::write(folder.store(), &self.0, &known)?;
        }
        if draws.is_some() {
            attractors::write_shares(folder.store(), &shares)?;
            let picture = pictures::shares::picture(folder.path(), &self.0);
            let named = [(layout::SHARES_PICTURE.to_owned(), picture)];
            pictures::put(folder.store(), None, Format::Svg, named)?;
        }
        Ok(())
    }

    fn picture(&self, folder: &Path) -> Result<Picture, StoreError> {
        pictures::map::of_system(folder, &self.0)
    }
}

/// The problem of a file with a system, its text and its name for messages.
fn of_system(task: &Task) -> Result<(SystemProblem, String, String), VerbFailure> {
    let (problem, text) = read_any(&task.problem)?;
    let name = task.name();
    match problem {
        Any::System(problem) => Ok((*problem, text, name)),
        Any::Tube(_) => {
            let message =
                "this is a problem with waves of a tube, and `scan` is for systems of one's own";
            let help =
                "take a problem with `system` and `orbit`; `brakewave new --for scan` prints one";
            Err(refuse_at(&text, &name, "wave", message, help).into())
        }
    }
}

impl RowVerb for SystemProblem {
    const ENDING: &'static str = "_scan";

    fn read(task: &Task) -> Result<SystemProblem, VerbFailure> {
        let (problem, text, name) = of_system(task)?;
        problem.scan(&text, &name)?;
        Ok(problem)
    }

    fn inputs(&self, task: &Task) -> Vec<PathBuf> {
        let earlier = self.earlier_run().cloned();
        std::iter::once(task.problem.clone())
            .chain(earlier)
            .collect()
    }

    fn sweeps(&self) -> Vec<Range<usize>> {
        self.scan.as_ref().map_or(Vec::new(), |scan| scan.sweeps())
    }

    fn work(&self, _: bool) -> Result<Work<'_>, VerbFailure> {
        let scanner = self.scan.as_ref().and_then(|scan| Scanner::new(self, scan));
        let scanner = scanner.ok_or(Usage::NoBeginning)?;
        Ok(Box::new(move |row, before| {
            let before = before.and_then(|rows| last(self, &scanner, rows));
            let settled: Vec<ScannedMotion> = scanner.piece(row, before);
            Ok(lines(&scanner.system, &settled))
        }))
    }

    fn picture(&self, folder: &Path) -> Result<Picture, StoreError> {
        pictures::scan::picture(folder, self, None, None)
    }

    /// A motion that ends early is told; what there is of it is kept. One that stays away from the section is no failure.
    fn end(&self, folder: &RowsFolder<SystemProblem>) -> Result<VerbExit, VerbFailure> {
        let table = store::table(&folder.path().join(SCAN))?;
        let lacking = (0..table.len()).filter(|row| {
            let why = table.text(*row, "why");
            !why.is_empty() && !why.starts_with(AWAY)
        });
        let lacking: Vec<usize> = lacking.collect();
        let Some(&first) = lacking.first() else {
            return Ok(VerbExit::Done);
        };
        let name = self.scan.as_ref().map_or("", |scan| &scan.parameter);
        let value: f64 = table.field(first, "value").unwrap_or(f64::NAN);
        stopped(&format!(
            "{} of the motions have fewer samples than asked for, the first at {name} = {value}: {}",
            lacking.len(),
            table.text(first, "why")
        ))
    }
}
