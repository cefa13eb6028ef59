//! `brakewave certify`.

use crate::orbit::legs::Run;
use std::path::Path;

use clap::Args;

use super::equilibria::{self, PreparedEquilibrium};
use super::failure::{Exit, Failure, Usage};
use super::options::{Task, read_any};
use super::prepare::{Prepared, PreparedSystem, early_end, follow, ready, ready_system};
use super::progress::each;
use super::{print, stopped};
use crate::branch::run::Item;
use crate::certify::{
    self, Certificate, Counted, Outcome, Point, Provable, Refused, Requested, Stretch, equilibrium,
    orbit,
};
use crate::hybrid;
use crate::hybrid::equilibrium::EquilibriumItem;
use crate::output::certify::{
    CertificateFolder, Certified, Read, read, table_agrees, theorems_agree,
};
use crate::output::layout::CERTIFICATES;
use crate::output::store::{Kind, SOURCE};
use crate::problem::{Any, StabilitySection};

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

pub(crate) fn certify(arguments: &CertifyArguments) -> Result<Exit, Failure> {
    let task = &arguments.task;
    if arguments.verify {
        return verify(&task.problem, task.quiet);
    }
    let (problem, text) = read_any(&task.problem)?;
    match problem {
        Any::Tube(problem) => waves(arguments, ready(*problem, text, &task.problem)?),
        Any::System(problem) if problem.equilibrium.is_some() => {
            let prepared = equilibria::ready(*problem, text, &task.problem)?;
            of_equilibria(arguments, &prepared)
        }
        Any::System(problem) => orbits(arguments, ready_system(*problem, text, &task.problem)?),
    }
}

fn waves(arguments: &CertifyArguments, prepared: Prepared) -> Result<Exit, Failure> {
    let task = &arguments.task;
    let out = task.folder("_certify");
    let store = task.open(&out, Kind::Certificate, &prepared.problem)?;
    let mut branch = prepared.begin(task.quiet)?;
    let folder = CertificateFolder::create::<certify::Proof>(store)?;
    let special = located(task.quiet, &mut branch, |item: &Item| item.event.is_some())?;
    let quiet = task.quiet;
    let proofs: Vec<_> = each(quiet, &special, "points", |item| {
        certify::certify(item, prepared.source.text())
    });
    let mut points: Vec<Point> = proofs.into_iter().flatten().collect();
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

fn orbits(arguments: &CertifyArguments, prepared: PreparedSystem) -> Result<Exit, Failure> {
    let task = &arguments.task;
    if arguments.spectrum {
        return Err(Usage::OfWaves.into());
    }
    let out = task.folder("_certify");
    let store = task.open_system(&out, Kind::Certificate, &prepared.problem)?;
    let mut branch = prepared.begin()?;
    let folder = CertificateFolder::create::<orbit::Proof>(store)?;
    let special = located(task.quiet, &mut branch, |item: &hybrid::Item| {
        item.event.is_some()
    })?;
    let proofs: Vec<_> = each(task.quiet, &special, "points", |item| {
        orbit::certify(item, prepared.source.text())
    });
    let mut points: Vec<Point<orbit::Proof>> = proofs.into_iter().flatten().collect();
    if arguments.arcs {
        join(task.quiet, &mut points);
    }
    compare(&mut points);
    finish(task, &out, folder, points, &branch)
}

fn of_equilibria(
    arguments: &CertifyArguments,
    prepared: &PreparedEquilibrium,
) -> Result<Exit, Failure> {
    let task = &arguments.task;
    if arguments.spectrum {
        return Err(Usage::OfWaves.into());
    }
    if arguments.arcs {
        return Err(Usage::OfOrbits.into());
    }
    let out = task.folder("_certify");
    let store = task.open_system(&out, Kind::Certificate, &prepared.problem)?;
    let mut branch = prepared.begin()?;
    let folder = CertificateFolder::create::<equilibrium::Proof>(store)?;
    let special = located(task.quiet, &mut branch, |item: &EquilibriumItem| {
        item.event.is_some()
    })?;
    let proofs: Vec<_> = each(task.quiet, &special, "points", |item| {
        equilibrium::certify(item, prepared.text())
    });
    let points = proofs.into_iter().flatten().collect();
    finish(task, &out, folder, points, &branch)
}

/// Proves what lies between every two points.
fn join<P: Provable + Sync>(quiet: bool, points: &mut [Point<P>])
where
    Point<P>: Sync,
{
    let pairs: Vec<_> = points.windows(2).collect();
    let arcs: Vec<_> = each(quiet, &pairs, "arcs", |both| both[1].stretch(&both[0]));
    for (point, arc) in points.iter_mut().skip(1).zip(arcs) {
        point.arc = arc;
    }
}

/// Takes back the arcs on which the number of what grows changes without an event that makes it change.
fn compare<P: Provable>(points: &mut [Point<P>]) {
    for (index, reason) in certify::miscounted(points) {
        if let Some(arc @ Stretch::Proven) = &mut points[index].arc {
            *arc = Stretch::Open(reason.to_string());
        }
    }
}

/// Follows a branch, and keeps its special points.
fn located<R: Run>(
    quiet: bool,
    branch: &mut R,
    is_special: impl Fn(&R::Item) -> bool,
) -> Result<Vec<R::Item>, Failure> {
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
    points: Vec<Point<P>>,
    branch: &impl Run,
) -> Result<Exit, Failure> {
    for point in &points {
        folder.write(point)?;
    }
    let report: String = points.iter().map(P::sentence).collect();
    let complete = |point: &Point<P>| {
        point.is_proven()
            && !matches!(point.arc, Some(Stretch::Open(_)))
            && !matches!(point.growth, Some(Counted::Open(_)))
    };
    let all = points.iter().all(complete);
    folder.finish(&Certificate::new(points))?;
    task.say(&report, "certificate", out)?;
    if let Some(why) = early_end(branch) {
        return stopped(&why);
    }
    Ok(if all { Exit::Done } else { Exit::Unmet })
}

/// Checks a stored certificate, with the table and the problem file beside it.
fn verify(path: &Path, quiet: bool) -> Result<Exit, Failure> {
    let file = match path.is_dir() {
        true => path.join(CertificateFolder::FILE),
        false => path.to_owned(),
    };
    let source = file.with_file_name(SOURCE);
    let problem = source.is_file().then(|| read_any(&source)).transpose()?;
    let read = read(&file)?;
    let is_empty = match &read {
        Read::Waves(certificate) => certificate.points.is_empty(),
        Read::Orbits(certificate) => certificate.points.is_empty(),
        Read::Equilibria(certificate) => certificate.points.is_empty(),
    };
    let belongs = match (&read, &problem) {
        (_, None) => true,
        (Read::Waves(_), Some((Any::Tube(problem), _))) => problem.continuation.is_some(),
        (Read::Waves(_), _) | (_, Some((Any::Tube(_), _))) => false,
        (read, Some((Any::System(problem), _))) => {
            problem.continuation.is_some()
                && !(problem.orbit.is_none() && problem.equilibrium.is_none())
                && matches!(read, Read::Equilibria(_)) == problem.equilibrium.is_some()
        }
    };
    match (read, &problem) {
        _ if is_empty => said_of_all("nothing is stated", quiet),
        _ if !belongs => said_of_all("it is not that of the problem file", quiet),
        (Read::Waves(certificate), problem) => {
            let requested = match problem {
                Some((Any::Tube(problem), text)) => Requested::new(problem, text),
                _ => None,
            };
            let rules = (|_: &Requested, _: &[_]| Ok(()), Requested::check);
            told(
                (&file, &certificate),
                quiet,
                requested.as_ref(),
                rules,
                certify::proven_again,
            )
        }
        (Read::Orbits(certificate), problem) => {
            let requested = match problem {
                Some((Any::System(problem), text)) => orbit::Requested::new(problem, text),
                _ => None,
            };
            let rules = (orbit::Requested::check_units, orbit::Requested::check);
            told(
                (&file, &certificate),
                quiet,
                requested.as_ref(),
                rules,
                orbit::proven_again,
            )
        }
        (Read::Equilibria(certificate), problem) => {
            let requested = match problem {
                Some((Any::System(problem), text)) => equilibrium::Requested::new(problem, text),
                _ => None,
            };
            let rules = (
                equilibrium::Requested::check_units,
                equilibrium::Requested::check,
            );
            told(
                (&file, &certificate),
                quiet,
                requested.as_ref(),
                rules,
                equilibrium::proven_again,
            )
        }
    }
}

/// Says why a certificate as a whole is none.
fn said_of_all(reason: &str, quiet: bool) -> Result<Exit, Failure> {
    if !quiet {
        print(&format!("certificate: refused: {reason}\n"))?;
    }
    Ok(Exit::Unmet)
}

/// Says of every stored point whether it holds: what its problem file asks of the units of all and of each point, where that is
/// known, and that it is proven again.
fn told<P: Certified + Send + Sync, R: Sync>(
    (file, certificate): (&Path, &Certificate<P>),
    quiet: bool,
    requested: Option<&R>,
    (check_units, check): (
        impl Fn(&R, &[Point<P>]) -> Result<(), Refused>,
        impl Fn(&R, &Point<P>, &P) -> Result<(), Refused> + Sync,
    ),
    proven_again: impl Fn(&Point<P>, &P) -> Result<P, Refused> + Sync,
) -> Result<Exit, Failure>
where
    Point<P>: Send + Sync,
{
    let points = &certificate.points;
    if !points.is_sorted_by(|before, point| before.label < point.label) {
        return said_of_all("its labels do not ascend", quiet);
    }
    let units = requested.map(|requested| check_units(requested, points));
    if let Some(Err(reason)) = units {
        return said_of_all(&reason.to_string(), quiet);
    }
    let again = certify::repeated(points);
    let verify = |point: &Point<P>, proof: &P| match again.contains(&point.label) {
        true => Err(Refused::Statement("that it is not an earlier point")),
        false => {
            let request = requested.map(|requested| check(requested, point, proof));
            request.unwrap_or(Ok(()))?;
            proven_again(point, proof)
        }
    };
    let indices: Vec<usize> = (0..points.len()).collect();
    let verdicts: Vec<(String, Point<P>)> = each(quiet, &indices, "points", |&index| {
        let before = index.checked_sub(1).map(|before| &points[before]);
        verdict(&points[index], before, verify)
    });
    let (verdicts, again): (Vec<String>, Vec<Point<P>>) = verdicts.into_iter().unzip();
    let table = table_agrees(&file.with_file_name(CERTIFICATES), &again)?;
    let theorems = theorems_agree(file, certificate)?;
    let beside = [
        (CERTIFICATES, table),
        (CertificateFolder::THEOREMS, theorems),
    ];
    let others = beside.iter().filter(|(_, agrees)| !agrees);
    let others: Vec<&str> = others.map(|(name, _)| *name).collect();
    let lines = points.iter().zip(&verdicts);
    let lines =
        lines.map(|(point, verdict)| format!("{} {}: {verdict}\n", point.label, point.kind));
    let mut report: String = lines.collect();
    for name in &others {
        report.push_str(&format!(
            "{name}: refused: it says something else than the certificate\n"
        ));
    }
    if !quiet {
        print(&report)?;
    }
    let all = others.is_empty() && verdicts.iter().all(|verdict| verdict == VERIFIED);
    Ok(if all { Exit::Done } else { Exit::Unmet })
}

/// What is said of a proof that holds.
const VERIFIED: &str = "verified";

/// Whether a stored point, and the arc that leads to it, is what it says; with the point, whose intervals are no wider than they are
/// proven.
fn verdict<P: Provable>(
    point: &Point<P>,
    before: Option<&Point<P>>,
    verify: impl Fn(&Point<P>, &P) -> Result<P, Refused>,
) -> (String, Point<P>) {
    let mut again = point.clone();
    let verified = match &point.outcome {
        Outcome::Proven(proof) => verify(point, proof),
        Outcome::Open(_) if point.growth.is_some() || point.arc == Some(Stretch::Proven) => Err(
            Refused::Statement("what follows from a point that is not proven"),
        ),
        Outcome::Open(reason) => return (format!("not proven: {reason}"), again),
    };
    let said = match (verified, &point.arc) {
        (Err(refused), _) => format!("refused: {refused}"),
        (Ok(_), Some(Stretch::Open(reason))) => format!("before it not proven: {reason}"),
        (Ok(_), arc)
            if arc.is_some() && before.and_then(|before| point.stretch(before)) != *arc =>
        {
            "refused: the arc before it is said otherwise than what is proven".to_owned()
        }
        (Ok(proof), _) => {
            again.outcome = Outcome::Proven(Box::new(proof));
            match &point.growth {
                Some(Counted::Open(reason)) => format!("growing eigenvalues not counted: {reason}"),
                _ => VERIFIED.to_owned(),
            }
        }
    };
    (said, again)
}
