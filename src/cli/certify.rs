//! `brakewave certify`.

use crate::orbit::legs::Run;
use std::path::Path;

use clap::Args;

use super::equilibria::{self, PreparedEquilibrium};
use super::failure::{Usage, VerbExit, VerbFailure};
use super::options::{Task, read_any};
use super::prepare::{Prepared, PreparedSystem, early_end, follow, ready, ready_system};
use super::progress::each;
use super::{print, stopped};
use crate::branch::run::WaveItem;
use crate::certify::{
    self, ArcOutcome, Certificate, CertifiedPoint, Counted, ProofOutcome, Provable, RefusedProof,
    RequestedWaves, equilibrium, orbit,
};
use crate::hybrid;
use crate::hybrid::equilibrium::EquilibriumItem;
use crate::output::certify::{
    CertificateFolder, Certified, Read, read, table_agrees, theorems_agree,
};
use crate::output::layout::CERTIFICATES;
use crate::output::store::{FolderKind, SOURCE, VERSION};
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

pub(crate) fn certify(arguments: &CertifyArguments) -> Result<VerbExit, VerbFailure> {
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

fn orbits(arguments: &CertifyArguments, prepared: PreparedSystem) -> Result<VerbExit, VerbFailure> {
    let task = &arguments.task;
    if arguments.spectrum {
        return Err(Usage::OfWaves.into());
    }
    let out = task.folder("_certify");
    let store = task.open_system(&out, FolderKind::Certificate, &prepared.problem)?;
    let mut branch = prepared.begin()?;
    let folder = CertificateFolder::create::<orbit::OrbitProof>(store)?;
    let special = located(task.quiet, &mut branch, |item: &hybrid::OrbitItem| {
        item.event.is_some()
    })?;
    let proofs: Vec<_> = each(task.quiet, &special, "points", |item| {
        orbit::certify(item, prepared.source.text())
    });
    let mut points: Vec<CertifiedPoint<orbit::OrbitProof>> = proofs.into_iter().flatten().collect();
    if arguments.arcs {
        join(task.quiet, &mut points);
    }
    compare(&mut points);
    finish(task, &out, folder, points, &branch)
}

fn of_equilibria(
    arguments: &CertifyArguments,
    prepared: &PreparedEquilibrium,
) -> Result<VerbExit, VerbFailure> {
    let task = &arguments.task;
    if arguments.spectrum {
        return Err(Usage::OfWaves.into());
    }
    if arguments.arcs {
        return Err(Usage::OfOrbits.into());
    }
    let out = task.folder("_certify");
    let store = task.open_system(&out, FolderKind::Certificate, &prepared.problem)?;
    let mut branch = prepared.begin()?;
    let folder = CertificateFolder::create::<equilibrium::EquilibriumProof>(store)?;
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

/// Checks a stored certificate, with the table and the problem file beside it.
fn verify(path: &Path, quiet: bool) -> Result<VerbExit, VerbFailure> {
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
    let belongs = belongs(&read, problem.as_ref());
    match (read, &problem) {
        _ if is_empty => said_of_all("nothing is stated", quiet),
        _ if !belongs => said_of_all("it is not that of the problem file", quiet),
        (Read::Waves(certificate), problem) => {
            let requested = match problem {
                Some((Any::Tube(problem), text)) => RequestedWaves::new(problem, text),
                _ => None,
            };
            let rules = (
                |_: &RequestedWaves, _: &[_]| Ok(true),
                RequestedWaves::check,
            );
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
                Some((Any::System(problem), text)) => orbit::RequestedOrbits::new(problem, text),
                _ => None,
            };
            let rules = (
                orbit::RequestedOrbits::check_units,
                orbit::RequestedOrbits::check,
            );
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
                Some((Any::System(problem), text)) => {
                    equilibrium::RequestedEquilibria::new(problem, text)
                }
                _ => None,
            };
            let rules = (
                equilibrium::RequestedEquilibria::check_units,
                equilibrium::RequestedEquilibria::check,
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

/// Whether a certificate states what a branch of this problem may have.
fn belongs(read: &Read, problem: Option<&(Any, String)>) -> bool {
    match (read, problem) {
        (_, None) => true,
        (Read::Waves(_), Some((Any::Tube(problem), _))) => problem.continuation.is_some(),
        (Read::Waves(_), _) | (_, Some((Any::Tube(_), _))) => false,
        (read, Some((Any::System(problem), _))) => {
            problem.continuation.is_some()
                && !(problem.orbit.is_none() && problem.equilibrium.is_none())
                && matches!(read, Read::Equilibria(_)) == problem.equilibrium.is_some()
        }
    }
}

/// Says why a certificate as a whole is none.
fn said_of_all(reason: &str, quiet: bool) -> Result<VerbExit, VerbFailure> {
    if !quiet {
        print(&format!("certificate: refused: {reason}\n"))?;
    }
    Ok(VerbExit::Unmet)
}

/// Says of every stored point whether it holds: what its problem file asks of the units of all and of each point, where that is
/// known, and that it is proven again.
fn told<P: Certified + Send + Sync, R: Sync>(
    (file, certificate): (&Path, &Certificate<P>),
    quiet: bool,
    requested: Option<&R>,
    (check_units, check): (
        impl Fn(&R, &[CertifiedPoint<P>]) -> Result<bool, RefusedProof>,
        impl Fn(&R, &CertifiedPoint<P>, &P) -> Result<(), RefusedProof> + Sync,
    ),
    proven_again: impl Fn(&CertifiedPoint<P>, &P) -> Result<P, RefusedProof> + Sync,
) -> Result<VerbExit, VerbFailure>
where
    CertifiedPoint<P>: Send + Sync,
{
    let points = &certificate.points;
    if !points.is_sorted_by(|before, point| before.label < point.label) {
        return said_of_all("its labels do not ascend", quiet);
    }
    let units = requested.map(|requested| check_units(requested, points));
    let are_known = match units {
        Some(Err(reason)) => return said_of_all(&reason.to_string(), quiet),
        Some(Ok(are_known)) => are_known,
        None => true,
    };
    let again = certify::repeated(points);
    let verify = |point: &CertifiedPoint<P>, proof: &P| match again.contains(&point.label) {
        true => Err(RefusedProof::Statement("that it is not an earlier point")),
        false => {
            let request = requested.map(|requested| check(requested, point, proof));
            request.unwrap_or(Ok(()))?;
            proven_again(point, proof)
        }
    };
    let indices: Vec<usize> = (0..points.len()).collect();
    let verdicts: Vec<(String, CertifiedPoint<P>)> = each(quiet, &indices, "points", |&index| {
        let before = index.checked_sub(1).map(|before| &points[before]);
        verdict(&points[index], before, verify)
    });
    let (verdicts, again): (Vec<String>, Vec<CertifiedPoint<P>>) = verdicts.into_iter().unzip();
    let table = table_agrees(&file.with_file_name(CERTIFICATES), &again)?;
    // what version a certificate names proves nothing: words that are not those of this one are not taken for its own
    let theorems = theorems_agree(file, certificate)?;
    let is_other = certificate.version != VERSION;
    let beside = [
        (CERTIFICATES, table),
        (CertificateFolder::THEOREMS, theorems || is_other),
    ];
    let lines = points.iter().zip(&verdicts);
    let lines =
        lines.map(|(point, verdict)| format!("{} {}: {verdict}\n", point.label, point.kind));
    let mut report: String = lines.collect();
    for (name, _) in beside.iter().filter(|(_, agrees)| !agrees) {
        report.push_str(&format!(
            "{name}: refused: it says something else than the certificate\n"
        ));
    }
    if !theorems && is_other {
        let (file, version) = (CertificateFolder::THEOREMS, &certificate.version);
        report.push_str(&format!(
            "{file}: not compared: it is of version {version:?}, whose words are not known here\n"
        ));
    }
    if !are_known {
        report.push_str("units: not compared: what the branch begins with is not proven first\n");
    }
    if !quiet {
        print(&report)?;
    }
    // what differs is refused or not compared
    let all = are_known && table && theorems && verdicts.iter().all(|verdict| verdict == VERIFIED);
    Ok(if all { VerbExit::Done } else { VerbExit::Unmet })
}

/// What is said of a proof that holds.
const VERIFIED: &str = "verified";

/// Whether a stored point, and the arc that leads to it, is what it says; with the point, whose intervals are no wider than they are
/// proven.
fn verdict<P: Provable>(
    point: &CertifiedPoint<P>,
    before: Option<&CertifiedPoint<P>>,
    verify: impl Fn(&CertifiedPoint<P>, &P) -> Result<P, RefusedProof>,
) -> (String, CertifiedPoint<P>) {
    let mut again = point.clone();
    let verified = match &point.outcome {
        ProofOutcome::Proven(proof) => verify(point, proof),
        ProofOutcome::Open(_)
            if point.growth.is_some() || point.arc == Some(ArcOutcome::Proven) =>
        {
            Err(RefusedProof::Statement(
                "what follows from a point that is not proven",
            ))
        }
        ProofOutcome::Open(reason) => return (format!("not proven: {reason}"), again),
    };
    let said = match (verified, &point.arc) {
        (Err(refused), _) => format!("refused: {refused}"),
        (Ok(_), Some(ArcOutcome::Open(reason))) => format!("before it not proven: {reason}"),
        (Ok(_), arc)
            if arc.is_some() && before.and_then(|before| point.stretch(before)) != *arc =>
        {
            "refused: the arc before it is said otherwise than what is proven".to_owned()
        }
        (Ok(proof), _) => {
            again.outcome = ProofOutcome::Proven(Box::new(proof));
            match &point.growth {
                Some(Counted::Open(reason)) => format!("growing eigenvalues not counted: {reason}"),
                _ => VERIFIED.to_owned(),
            }
        }
    };
    (said, again)
}
