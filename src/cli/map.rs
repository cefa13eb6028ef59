//! `brakewave map` and `brakewave map merge`.

use std::fs;
use std::io::{IsTerminal, stderr};
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

use clap::{Args, Subcommand};
use indicatif::{ProgressBar, ProgressStyle};
use rayon::prelude::{IntoParallelRefIterator, ParallelIterator};

use super::progress::{Ticker, duration};
use super::{Failure, default_folder, inputs, picture, print};
use crate::map;
use crate::output::map_folder::{Description, MapFolder};
use crate::output::pictures;
use crate::output::render::Format;
use crate::output::store::{Existing, Kind};
use crate::problem::{self, Problem};

#[derive(Debug, Args)]
#[command(args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
pub struct MapArguments {
    #[command(subcommand)]
    verb: Option<MapVerb>,
    /// Problem file with a section `map`
    #[arg(required = true)]
    problem: Option<PathBuf>,
    /// Folder of the map [default: results/<name of the problem file>_map, and in it shard-I-of-N]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Compute only every Nth row, from the Ith: I/N with 1 ≤ I ≤ N; `map merge` joins the shards
    #[arg(long, value_name = "I/N")]
    shard: Option<Shard>,
    /// Go on with an interrupted map
    #[arg(long, conflicts_with = "force")]
    resume: bool,
    /// Replace an earlier map
    #[arg(long)]
    force: bool,
    /// Print nothing but errors
    #[arg(long)]
    quiet: bool,
    /// Threads [default: one per core]; the results do not depend on it
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    threads: Option<u16>,
    /// Draw the regions of the plane: FILE.svg, .png or .pdf
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
    /// Draw the regions of the plane: FILE.svg, .png or .pdf
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
    type Err = String;

    fn from_str(text: &str) -> Result<Shard, String> {
        let numbers = text
            .split_once('/')
            .and_then(|(number, of)| Some((number.parse().ok()?, of.parse().ok()?)));
        match numbers {
            Some((number, of)) if 1 <= number && number <= of => Ok(Shard { number, of }),
            _ => Err("write I/N with 1 ≤ I ≤ N, for example 2/4".into()),
        }
    }
}

pub fn map(arguments: &MapArguments) -> Result<u8, Failure> {
    match (&arguments.verb, &arguments.problem) {
        (Some(MapVerb::Merge(arguments)), _) => merge(arguments),
        (None, Some(problem)) => run(arguments, problem),
        (None, None) => Err(Failure::Usage("name a problem file".into())),
    }
}

/// More threads than this are not started, nor more than there are rows: they would only wait.
const MOST_THREADS: usize = 256;

fn run(arguments: &MapArguments, path: &Path) -> Result<u8, Failure> {
    let (problem, text) = problem::read(path)?;
    let section = problem.map(&text, &path.display().to_string())?;
    let out = folder(arguments, path);
    let inputs = inputs(path, &problem);
    let picture = picture(arguments.plot.as_deref(), &inputs)?;
    let shard = arguments.shard.unwrap_or(Shard { number: 1, of: 1 });
    let kind = match shard.of {
        1 => Kind::Map,
        _ => Kind::MapShard,
    };
    let existing = Existing::of(arguments.resume, arguments.force);
    let description = Description::new(&problem);
    let folder = MapFolder::open(&out, description.clone(), kind, existing, &inputs)?;
    let finished = folder.finished()?;
    let rows: Vec<usize> = (shard.number - 1..description.rows())
        .step_by(shard.of)
        .filter(|row| finished.binary_search(row).is_err())
        .collect();
    let threads = rayon::ThreadPoolBuilder::new()
        .num_threads(arguments.threads.map_or(0, |threads| {
            usize::from(threads).min(rows.len()).clamp(1, MOST_THREADS)
        }))
        .build()
        .map_err(|error| Failure::Usage(format!("cannot start threads: {error}")))?;
    let meter = Meter::new(rows.len(), arguments.quiet);
    threads.install(|| {
        rows.par_iter().try_for_each(|&row| -> Result<(), Failure> {
            let cells = map::row(&problem, section, row)?;
            // the first row that is there replaces an earlier map
            folder.begin(&rows)?;
            folder.write(row, &cells)?;
            meter.tick();
            Ok(())
        })
    })?;
    meter.finish();
    folder.begin(&rows)?;
    if shard.of > 1 {
        return summary(arguments.quiet, &format!("shard in {}\n", out.display()));
    }
    folder.join(std::slice::from_ref(&out))?;
    draw(picture, &out, &problem)?;
    summary(arguments.quiet, &format!("map in {}\n", out.display()))
}

fn merge(arguments: &MergeArguments) -> Result<u8, Failure> {
    let picture = picture(arguments.plot.as_deref(), &[])?;
    let mut description: Option<(Description, &PathBuf)> = None;
    for shard in &arguments.shards {
        let found = Description::read(shard)?;
        match &description {
            Some((known, first)) if *known != found => {
                return Err(Failure::Usage(format!(
                    "{} and {} are shards of different maps",
                    first.display(),
                    shard.display()
                )));
            }
            _ => description = Some((found, shard)),
        }
    }
    let Some((description, _)) = description else {
        return Err(Failure::Usage("name the folders of the shards".into()));
    };
    let canonical = |path: &PathBuf| fs::canonicalize(path).ok();
    let out = canonical(&arguments.out);
    let own = out.is_some() && arguments.shards.iter().any(|shard| canonical(shard) == out);
    // a shard may be joined in its own folder, whose rows stay then
    let existing = Existing::of(own, arguments.force);
    let folder = MapFolder::open(&arguments.out, description, Kind::Map, existing, &[])?;
    folder.join(&arguments.shards)?;
    draw(picture, &arguments.out, folder.problem())?;
    let text = format!("map in {}\n", arguments.out.display());
    summary(arguments.quiet, &text)
}

fn summary(quiet: bool, text: &str) -> Result<u8, Failure> {
    if !quiet {
        print(text)?;
    }
    Ok(0)
}

/// Where the map goes.
fn folder(arguments: &MapArguments, problem: &Path) -> PathBuf {
    if let Some(out) = &arguments.out {
        return out.clone();
    }
    let mut name = default_folder(problem).into_os_string();
    name.push("_map");
    let folder = PathBuf::from(name);
    match arguments.shard {
        Some(Shard { number, of }) if of > 1 => folder.join(format!("shard-{number}-of-{of}")),
        _ => folder,
    }
}

fn draw(picture: Option<(&Path, Format)>, folder: &Path, problem: &Problem) -> Result<(), Failure> {
    if let (Some((path, format)), Some(section)) = (picture, &problem.map) {
        let drawn = pictures::map::picture(folder, section)?;
        let titled = drawn.titled(problem.title.as_deref());
        pictures::save(path, format, &titled)?;
    }
    Ok(())
}

/// Rows done and the time that is left: a bar on a terminal, a line now and then in a log.
struct Meter {
    bar: Option<ProgressBar>,
    done: Arc<AtomicUsize>,
    _ticker: Ticker,
}

impl Meter {
    fn new(rows: usize, quiet: bool) -> Meter {
        let bar = (!quiet && stderr().is_terminal()).then(|| {
            let bar = ProgressBar::new(rows as u64);
            let template = "{spinner} [{bar:40}] {pos} of {len} rows, {eta} left ({elapsed})";
            // the template is constant and valid
            if let Ok(style) = ProgressStyle::with_template(template) {
                bar.set_style(style.progress_chars("=> "));
            }
            bar
        });
        let done = Arc::new(AtomicUsize::new(0));
        let (begun, counted) = (Instant::now(), done.clone());
        let words = move || {
            let done = counted.load(Ordering::Relaxed);
            let left = begun.elapsed().as_secs_f64() * (rows as f64 / done as f64 - 1.0);
            match done {
                0 => format!("0 of {rows} rows"),
                _ => format!("{done} of {rows} rows, about {} left", duration(left)),
            }
        };
        Meter {
            bar,
            done,
            _ticker: Ticker::new(quiet, words),
        }
    }

    fn tick(&self) {
        self.done.fetch_add(1, Ordering::Relaxed);
        if let Some(bar) = &self.bar {
            bar.inc(1);
        }
    }

    fn finish(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}
