//! `brakewave certify`.

use std::path::{Path, PathBuf};

use clap::Args;

use super::failure::{Exit, Failure};
use super::options::Task;
use super::prepare::{Prepared, begin, prepare};
use super::print;
use super::progress::drive;
use super::warn;
use crate::branch::run::End;
use crate::certify::{self, Certificate, Outcome, Point};
use crate::output::certify::{CertificateFolder, read, sentence};
use crate::output::store::Kind;

#[derive(Debug, Args)]
pub(crate) struct CertifyArguments {
    #[command(flatten)]
    task: Task,
    /// PROBLEM is a certificate, or the folder of one: check it without continuation
    #[arg(long, conflicts_with_all = ["out", "resume", "force"])]
    verify: bool,
}

pub(crate) fn certify(arguments: &CertifyArguments) -> Result<Exit, Failure> {
    let task = &arguments.task;
    if arguments.verify {
        return verify(&task.problem, task.quiet);
    }
    let Prepared {
        problem,
        continuation,
        restart,
        source,
    } = prepare(&task.problem)?;
    let out = task.folder("_certify");
    let store = task.open(&out, Kind::Certificate, &problem)?;
    let mut branch = begin(task.quiet, &problem, &continuation, restart.as_ref())
        .map_err(|error| source.place(error))?;
    let mut folder = CertificateFolder::create(store)?;
    let mut points = Vec::new();
    drive(task.quiet, || {
        if branch.progress().end.is_some() {
            return Ok(None);
        }
        for item in branch.step() {
            if let Some(point) = certify::certify(&item, source.text()) {
                folder.write(&point)?;
                points.push(point);
            }
        }
        let words = format!(
            "{} points, {} to prove",
            branch.progress().points,
            points.len()
        );
        Ok(Some((branch.position(), words)))
    })?;
    let report: String = points.iter().map(sentence).collect();
    let all = points.iter().all(Point::is_proven);
    folder.finish(&Certificate::new(points))?;
    if !task.quiet {
        print(&report)?;
        print(&format!("certificate in {}\n", out.display()))?;
    }
    if let Some(End::Failed(reason)) = &branch.progress().end {
        warn(&format!("the branch ended before its range: {reason}"));
        return Ok(Exit::Numerical);
    }
    Ok(if all { Exit::Done } else { Exit::Unmet })
}

/// Checks a stored certificate.
fn verify(path: &Path, quiet: bool) -> Result<Exit, Failure> {
    let file: PathBuf = if path.is_dir() {
        path.join(CertificateFolder::FILE)
    } else {
        path.to_owned()
    };
    let certificate = read(&file)?;
    let mut report = String::new();
    let mut exit = Exit::Done;
    for point in &certificate.points {
        let verdict = match &point.outcome {
            Outcome::Proven(proof) => match certify::verify(point, proof) {
                Ok(()) => "verified".to_owned(),
                Err(refused) => format!("refused: {refused}"),
            },
            Outcome::Open(reason) => format!("not proven: {reason}"),
        };
        if verdict != "verified" {
            exit = Exit::Unmet;
        }
        report.push_str(&format!("{} {}: {verdict}\n", point.label, point.kind));
    }
    if !quiet {
        print(&report)?;
    }
    Ok(exit)
}
