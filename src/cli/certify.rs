//! `brakewave certify`.

use std::path::Path;

use clap::Args;

use super::failure::{Usage, VerbExit, VerbFailure};
use super::options::{Task, read_any};
use super::prepare::{Prepared, early_end, follow, ready, ready_equilibrium, ready_system};
use super::progress::each;
use super::{stopped, verify};
use crate::branch::run::WaveItem;
use crate::certify::{
    self, ArcOutcome, Certificate, CertifiedPoint, Counted, Provable, equilibrium, orbit,
};
use crate::hybrid::runner::{SystemItem, SystemOrbit, SystemRunner};
use crate::orbit::legs::Run;
use crate::output::certify::{CertificateFolder, Certified};
use crate::output::store::FolderKind;
use crate::problem::{Any, StabilitySection, SystemProblem};

#[derive(Debug, Args)]
#[command(mut_arg("resume", |one| one.help("Compute what was interrupted once more, from its beginning")))]
pub(crate) struct CertifyArguments {
    #[command(flatten)]
    task: Task,
    /// PROBLEM is a certificate, or the folder of one: check it without continuation
    #[arg(long, conflicts_with_all = ["out", "resume", "force"])]
    verify: bool,
    /// Prove also that between the special points there is no other
    #[arg(long, conflicts_with = "verify")]
    arcs: bool,
    /// Prove also how many eigenvalues grow in the window of the `stability` section, and stability where damping
    /// allows
    #[arg(long, conflicts_with = "verify")]
    spectrum: bool,
}

pub(crate) fn certify(arguments: &CertifyArguments) -> Result<VerbExit, VerbFailure> {
    let task = &arguments.task;
    if arguments.verify {
        return verify::verify(&task.problem, task.quiet);
    }
    let (problem, text) = read_any(&task.problem)?;
    match problem {
        Any::Tube(problem) => waves(arguments, ready(*problem, text, &task.problem)?),
        Any::System(problem) if problem.equilibrium.is_some() => {
            if arguments.arcs {
                return Err(Usage::OfOrbits.into());
            }
            let prepared = ready_equilibrium(*problem, text, &task.problem)?;
            let begin = || prepared.begin();
            of_system(arguments, &prepared.problem, begin, |item| {
                equilibrium::certify(item, prepared.source.text())
            })
        }
        Any::System(problem) => {
            let prepared = ready_system(*problem, text, &task.problem)?;
            let begin = || prepared.begin();
            of_system(arguments, &prepared.problem, begin, |item| {
                orbit::certify(item, prepared.source.text())
            })
        }
    }
}

fn waves(arguments: &CertifyArguments, prepared: Prepared) -> Result<VerbExit, VerbFailure> {
    let task = &arguments.task;
    let out = task.folder("_certify");
    let store = task.open(&out, FolderKind::Certificate, &prepared.problem)?;
    let mut branch = prepared.begin(task.quiet)?;
    let folder = CertificateFolder::create::<certify::WaveProof>(store)?;
    let special = located(task.quiet, &mut branch, |item: &WaveItem| {
        item.event.is_some()
    })?;
    let quiet = task.quiet;
    let proofs: Vec<_> = each(quiet, &special, "points", |item| {
        certify::certify(item, prepared.source.text())
    });
    let mut points: Vec<CertifiedPoint> = proofs.into_iter().flatten().collect();
    if arguments.arcs {
        join(quiet, &mut points);
    }
    if arguments.spectrum {
        let problem = &prepared.problem;
        let section = problem.stability.clone();
        let section = section.unwrap_or_else(|| StabilitySection::of(&problem.model));
        let window = section.max_frequency;
        let counts: Vec<_> = each(quiet, &points, "spectra", |point| point.counted(window));
        for (point, count) in points.iter_mut().zip(counts) {
            point.growth = count;
        }
    }
    compare(&mut points);
    finish(task, &out, folder, points, &branch)
}

/// A branch of a user's system, each of whose special points `prove` proves.
fn of_system<O: SystemOrbit, P: Certified + Sync>(
    arguments: &CertifyArguments,
    problem: &SystemProblem,
    begin: impl FnOnce() -> Result<SystemRunner<O>, VerbFailure>,
    prove: impl Fn(&SystemItem<O>) -> Option<CertifiedPoint<P>> + Sync,
) -> Result<VerbExit, VerbFailure>
where
    SystemItem<O>: Sync,
    CertifiedPoint<P>: Send + Sync,
{
    let task = &arguments.task;
    if arguments.spectrum {
        return Err(Usage::OfWaves.into());
    }
    let out = task.folder("_certify");
    let store = task.open_system(&out, FolderKind::Certificate, problem)?;
    let mut branch = begin()?;
    let folder = CertificateFolder::create::<P>(store)?;
    let special = located(task.quiet, &mut branch, |item: &SystemItem<O>| {
        item.event.is_some()
    })?;
    let proofs: Vec<_> = each(task.quiet, &special, "points", prove);
    let mut points: Vec<CertifiedPoint<P>> = proofs.into_iter().flatten().collect();
    if arguments.arcs {
        join(task.quiet, &mut points);
    }
    compare(&mut points);
    finish(task, &out, folder, points, &branch)
}

/// Proves what lies between every two points.
fn join<P: Provable + Sync>(quiet: bool, points: &mut [CertifiedPoint<P>])
where
    CertifiedPoint<P>: Sync,
{
    let pairs: Vec<_> = points.windows(2).collect();
    let arcs: Vec<_> = each(quiet, &pairs, "arcs", |both| both[1].stretch(&both[0]));
    for (point, arc) in points.iter_mut().skip(1).zip(arcs) {
        point.arc = arc;
    }
}

/// Takes back the arcs on which the number of what grows changes without an event that makes it change.
fn compare<P: Provable>(points: &mut [CertifiedPoint<P>]) {
    for (index, reason) in certify::miscounted(points) {
        if let Some(arc @ ArcOutcome::Proven) = &mut points[index].arc {
            *arc = ArcOutcome::Open(reason.to_string());
        }
    }
}

/// Follows a branch, and keeps its special points.
fn located<R: Run>(
    quiet: bool,
    branch: &mut R,
    is_special: impl Fn(&R::Item) -> bool,
) -> Result<Vec<R::Item>, VerbFailure> {
    let mut special = Vec::new();
    follow(quiet, branch, |items, branch| {
        special.extend(items.into_iter().filter(&is_special));
        let (points, events) = (branch.progress().points, special.len());
        Ok(format!("{points} points, {events} to prove"))
    })?;
    Ok(special)
}

/// Writes what is proven, and says it.
fn finish<P: Certified>(
    task: &Task,
    out: &Path,
    mut folder: CertificateFolder,
    points: Vec<CertifiedPoint<P>>,
    branch: &impl Run,
) -> Result<VerbExit, VerbFailure> {
    for point in &points {
        folder.write(point)?;
    }
    let report: String = points.iter().map(P::sentence).collect();
    let complete = |point: &CertifiedPoint<P>| {
        point.is_proven()
            && !matches!(point.arc, Some(ArcOutcome::Open(_)))
            && !matches!(point.growth, Some(Counted::Open(_)))
    };
    let all = points.iter().all(complete);
    folder.finish(&Certificate::new(points))?;
    task.say(&report, "certificate", out)?;
    if let Some(why) = early_end(branch) {
        return stopped(&why);
    }
    Ok(if all { VerbExit::Done } else { VerbExit::Unmet })
}
