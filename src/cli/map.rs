//! `brakewave map` and `brakewave map merge`.

use std::fs;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use clap::{Args, Subcommand};

use super::failure::{Exit, Failure, Usage};
use super::options::{Task, Threads, cores, picture};
use super::print;
use super::progress::{Progress, each};
use crate::map;
use crate::output::map::{MapFolder, of_shard};
use crate::output::origin::Origin;
use crate::output::pictures::{self, PlotError};
use crate::output::render::Format;
use crate::output::store::{Existing, Kind, SOURCE, Store};
use crate::problem::Problem;

#[derive(Debug, Args)]
#[command(args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
pub(crate) struct MapArguments {
    #[command(subcommand)]
    verb: Option<MapVerb>,
    /// Its problem file has a section `map`
    #[command(flatten)]
    task: Option<Task>,
    #[command(flatten)]
    threads: Threads,
    /// Compute only every Nth row, from the Ith: I/N with 1 ≤ I ≤ N; `map merge` joins the shards
    #[arg(long, value_name = "I/N")]
    shard: Option<Shard>,
    /// Draw the regions of the plane here too: FILE.svg, .png, .pdf or .tex
    #[arg(long, value_name = "FILE", conflicts_with = "shard")]
    plot: Option<PathBuf>,
}

#[derive(Debug, Subcommand)]
enum MapVerb {
    /// Join the shards of a map to one table, the same as that of a map computed at once
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
    /// Replace an earlier map
    #[arg(long)]
    force: bool,
    /// Print nothing but errors
    #[arg(long)]
    quiet: bool,
    /// Draw the regions of the plane here too: FILE.svg, .png, .pdf or .tex
    #[arg(long, value_name = "FILE")]
    plot: Option<PathBuf>,
}

/// Which rows of a map: those with index ≡ i − 1 modulo n.
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

pub(crate) fn map(arguments: &MapArguments) -> Result<Exit, Failure> {
    match (&arguments.verb, &arguments.task) {
        (Some(MapVerb::Merge(arguments)), _) => merge(arguments),
        (None, Some(task)) => run(arguments, task),
        (None, None) => Err(Usage::NoProblem.into()),
    }
}

fn run(arguments: &MapArguments, task: &Task) -> Result<Exit, Failure> {
    let (problem, text, name) = task.read()?;
    let section = problem.map(&text, &name)?;
    let mut out = task.folder("_map");
    let picture = picture(arguments.plot.as_deref(), &task.inputs(&problem))?;
    let shard = arguments.shard.unwrap_or(Shard { number: 1, of: 1 });
    let mut kind = Kind::Map;
    if shard.of > 1 {
        kind = Kind::MapShard;
        if task.out.is_none() {
            out.push(format!("shard-{}-of-{}", shard.number, shard.of));
        }
    }
    let store = task.open(&out, kind, &problem)?;
    let folder = MapFolder::new(store, Origin::of(&problem))?;
    let finished = folder.finished()?;
    let rows: Vec<usize> = (shard.number - 1..folder.rows())
        .step_by(shard.of)
        .filter(|row| finished.binary_search(row).is_err())
        .collect();
    let most = rows.len().min(MOST_THREADS);
    arguments.threads.install(cores(), most, || {
        if rows.is_empty() {
            return Ok(());
        }
        let progress = Progress::new(task.quiet);
        let mut watch = |waves: usize| {
            progress.show(
                f64::NAN,
                format!("{waves} waves on lines through the plane"),
            );
        };
        let map = map::Rows::new(&problem, section, &mut watch)?;
        drop(progress);
        let written: Result<(), Failure> = each(task.quiet, &rows, "rows", |&row| {
            let cells = map.row(row)?;
            // the first row that is there replaces an earlier map
            folder.begin(&rows)?;
            folder.write(row, &cells)?;
            Ok::<(), Failure>(())
        });
        written
    })?;
    folder.begin(&rows)?;
    let what = if shard.of > 1 { "shard" } else { "map" };
    if shard.of == 1 {
        folder.join(std::slice::from_ref(&out))?;
        draw(picture, folder.store(), &problem)?;
    }
    task.say("", what, &out)?;
    Ok(Exit::Done)
}

fn merge(arguments: &MergeArguments) -> Result<Exit, Failure> {
    let picture = picture(arguments.plot.as_deref(), &[])?;
    let (first, others) = arguments.shards.split_first().ok_or(Usage::NoProblem)?;
    let origin = of_shard(first)?;
    for shard in others {
        if of_shard(shard)? != origin {
            return Err(Usage::OtherMap(first.clone(), shard.clone()).into());
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
    let store = Store::open(&arguments.out, Kind::Map, &problem, existing, &inputs)?;
    let folder = MapFolder::new(store, origin)?;
    folder.join(&arguments.shards)?;
    draw(picture, folder.store(), &problem)?;
    if !arguments.quiet {
        print(&format!("map in {}\n", arguments.out.display()))?;
    }
    Ok(Exit::Done)
}

/// The picture in the folder, and the one asked for besides.
fn draw(picture: Option<(&Path, Format)>, store: &Store, problem: &Problem) -> Result<(), Failure> {
    pictures::draw(store, Some(problem), Format::Svg)?;
    if let (Some(file), Some(section)) = (picture, &problem.map) {
        let drawn = pictures::map::picture(store.path(), section);
        pictures::save(file, problem, drawn.map_err(PlotError::from)?)?;
    }
    Ok(())
}
