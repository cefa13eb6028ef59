//! `brakewave check`: does the branch still have the events it is expected to have?

use std::fmt::Write;
use std::path::{Path, PathBuf};

use clap::Args;

use super::failure::{VerbExit, VerbFailure};
use super::junit::{self, CaseVerdict, Suite};
use super::options::{read_any, spare, write};
use super::prepare::{early_end, follow, ready, ready_equilibrium, ready_system};
use super::{print, warn};
use crate::branch::Event;
use crate::branch::run::WaveItem;
use crate::certify::{CertifiedPoint, certify, equilibrium, orbit};
use crate::hybrid::equilibrium::{EquilibriumEvent, EquilibriumItem};
use crate::hybrid::{OrbitEvent, OrbitItem};
use crate::messages::figures;
use crate::orbit::legs::Run;
use crate::output::certify::Certified;
use crate::output::store::Offers;
use crate::problem::compare::{Compared, Comparison, Occurrence, compare};
use crate::problem::{self, Any, Expectation, Problem, SystemProblem};

#[derive(Debug, Args)]
pub(crate) struct CheckArguments {
    /// Problem files; - reads standard input
    #[arg(required = true)]
    problems: Vec<PathBuf>,
    /// Also write the outcome as JUnit XML
    #[arg(long, value_name = "FILE")]
    junit: Option<PathBuf>,
}

/// One expectation: what it was compared with, its numbers, and what else is wrong.
struct CheckedExpectation {
    title: String,
    lines: Vec<String>,
    wrong: Option<String>,
    met: bool,
}

/// Outcome of one problem file.
struct CheckOutcome {
    file: String,
    found: Vec<CheckedExpectation>,
    exit: VerbExit,
    trouble: Option<String>,
}

impl CheckOutcome {
    /// Whether nothing was compared, and nothing went wrong: this is no success.
    fn skipped(&self) -> bool {
        self.found.is_empty() && self.trouble.is_none()
    }
}

const SKIPPED: &str = "nothing expected: the list `expect` is empty";

pub(crate) fn check(arguments: &CheckArguments) -> Result<VerbExit, VerbFailure> {
    if let Some(path) = &arguments.junit {
        spare(path, &arguments.problems)?;
    }
    let mut outcomes = Vec::with_capacity(arguments.problems.len());
    for file in &arguments.problems {
        let outcome = check_file(file).unwrap_or_else(|failure| CheckOutcome {
            file: problem::name_of(file),
            found: Vec::new(),
            exit: failure.exit(),
            trouble: Some(format!("{failure}{}", failure.cure(Offers::default()))),
        });
        print(&text(&outcome))?;
        outcomes.push(outcome);
    }
    let skipped = outcomes.iter().filter(|outcome| outcome.skipped()).count();
    let with = |exit: VerbExit| outcomes.iter().filter(move |outcome| outcome.exit == exit);
    let (passed, compared) = (
        with(VerbExit::Done).count() - skipped,
        outcomes.len() - skipped,
    );
    print(&format!(
        "{passed} of {compared} problem files as expected\n"
    ))?;
    if skipped > 0 {
        warn(&format!(
            "{skipped} of {} problem files expect nothing: no figure of theirs was compared",
            outcomes.len()
        ));
    }
    if let Some(path) = &arguments.junit {
        let suites: Vec<Suite> = outcomes.iter().map(suite).collect();
        write(path, &junit::report(&suites))?;
    }
    // bad input outranks damaged input, then a numerical failure, then an expectation not met
    let ranks = [
        VerbExit::BadInput,
        VerbExit::InputOutput,
        VerbExit::Numerical,
        VerbExit::Unmet,
    ];
    let worst = ranks.into_iter().find(|exit| with(*exit).next().is_some());
    Ok(worst.unwrap_or(VerbExit::Done))
}

/// A file that only simulates has no branch to run, and nothing to compare.
fn simulates_only(problem: &Problem) -> bool {
    problem.simulation.is_some() && problem.continuation.is_none() && problem.expect.is_empty()
}

fn check_file(path: &Path) -> Result<CheckOutcome, VerbFailure> {
    let file = problem::name_of(path);
    let (problem, text) = match read_any(path)? {
        (Any::Tube(problem), text) => (*problem, text),
        (Any::System(problem), text) => return check_system(path, *problem, text),
    };
    if simulates_only(&problem) {
        return Ok(skipped(file));
    }
    let prepared = ready(problem, text, path)?;
    let (problem, parameter) = (&prepared.problem, prepared.continuation.parameter);
    let occurrence = |item: &WaveItem| item.event.as_ref().map(Event::occurrence);
    let prove = |item: &WaveItem| certify(item, prepared.source.text());
    checked(
        file,
        prepared.begin(false)?,
        (&problem.expect, parameter.column()),
        occurrence,
        problem.certify.then_some(prove),
    )
}

/// The same of a problem with a system of one's own.
fn check_system(
    path: &Path,
    problem: SystemProblem,
    text: String,
) -> Result<CheckOutcome, VerbFailure> {
    let file = problem::name_of(path);
    if problem.continuation.is_none() && problem.expect.is_empty() {
        return Ok(skipped(file));
    }
    if problem.equilibrium.is_some() {
        let prepared = ready_equilibrium(problem, text, path)?;
        let occurrence = |item: &EquilibriumItem| {
            let event = item.event.as_ref();
            event.map(EquilibriumEvent::occurrence)
        };
        let prove = |item: &EquilibriumItem| equilibrium::certify(item, prepared.source.text());
        return checked(
            file,
            prepared.begin()?,
            prepared.expected(),
            occurrence,
            prepared.problem.certify.then_some(prove),
        );
    }
    let prepared = ready_system(problem, text, path)?;
    let occurrence = |item: &OrbitItem| item.event.as_ref().map(OrbitEvent::occurrence);
    let prove = |item: &OrbitItem| orbit::certify(item, prepared.source.text());
    checked(
        file,
        prepared.begin()?,
        prepared.expected(),
        occurrence,
        prepared.problem.certify.then_some(prove),
    )
}

/// Follows a branch to its end, compares its events with what is expected of a branch in this parameter, and proves them where that is
/// asked for.
fn checked<R: Run, P: Certified>(
    file: String,
    mut branch: R,
    (expect, parameter): (&[Expectation], &str),
    occurrence: impl Fn(&R::Item) -> Option<Occurrence>,
    prove: Option<impl Fn(&R::Item) -> Option<CertifiedPoint<P>>>,
) -> Result<CheckOutcome, VerbFailure> {
    let (mut events, mut certified) = (Vec::new(), Vec::new());
    follow(false, &mut branch, |items, branch| {
        for item in &items {
            certified.extend(prove.as_ref().and_then(|prove| prove(item)));
            events.extend(occurrence(item));
        }
        let (points, events) = (branch.progress().points, events.len());
        Ok(format!("{file}: {points} points, {events} events"))
    })?;
    let compared = compare(expect, &events);
    let compared = compared.iter().map(|one| found(one, parameter));
    let found = compared.chain(certified.iter().map(proven)).collect();
    Ok(CheckOutcome::of(file, found, &branch))
}

/// Of a file that has no branch to run, and nothing to compare.
fn skipped(file: String) -> CheckOutcome {
    CheckOutcome {
        file,
        found: Vec::new(),
        exit: VerbExit::Done,
        trouble: None,
    }
}

impl CheckOutcome {
    /// What was compared along a branch.
    fn of(file: String, found: Vec<CheckedExpectation>, branch: &impl Run) -> CheckOutcome {
        let trouble = early_end(branch);
        CheckOutcome {
            file,
            exit: match &trouble {
                _ if found.iter().any(|one| !one.met) => VerbExit::Unmet,
                Some(_) => VerbExit::Numerical,
                None => VerbExit::Done,
            },
            found,
            trouble,
        }
    }
}

/// A special point to be proven, in words.
fn proven<P: Certified>(point: &CertifiedPoint<P>) -> CheckedExpectation {
    let met = point.is_proven();
    let line = P::sentence(point).trim_end().to_owned();
    CheckedExpectation {
        title: format!("{} at label {}", point.kind, point.label),
        lines: if met {
            vec![format!("ok   {line}")]
        } else {
            Vec::new()
        },
        wrong: (!met).then_some(line),
        met,
    }
}

/// An expectation in words.
fn found(compared: &Compared, column: &str) -> CheckedExpectation {
    let expectation = compared.expectation;
    let mut title = expectation.event.to_string();
    // writing to a string does not fail
    if let Some(sector) = expectation.sector {
        let _ = write!(title, " sector {sector}");
    }
    let wrong = match compared.event {
        None => Some(format!(
            "no {title} was found on the branch that is not matched"
        )),
        Some(event) => {
            let value = event.number(column).unwrap_or(f64::NAN);
            let value = figures::significant(value, figures::PLACE);
            let _ = write!(title, " at {column} = {value}");
            compared.regimes.as_ref().map(ToString::to_string)
        }
    };
    CheckedExpectation {
        title,
        lines: compared.numbers.iter().map(line).collect(),
        wrong,
        met: compared.met(),
    }
}

fn line(one: &Comparison) -> String {
    let verdict = if one.met() { "ok  " } else { "FAIL" };
    let expected = format!("{verdict} {:<10} expected {:+.16e}", one.name, one.expected);
    match one.found {
        Some(found) => format!(
            "{expected}  found {found:+.16e}  difference {:.1e}  tolerance {:.0e}",
            one.difference(),
            one.tolerance
        ),
        None => format!("{expected}  not found"),
    }
}

fn text(outcome: &CheckOutcome) -> String {
    let mut text = format!("{}\n", outcome.file);
    // writing to a string does not fail
    for one in &outcome.found {
        let _ = writeln!(text, "  {}", one.title);
        for line in &one.lines {
            let _ = writeln!(text, "    {line}");
        }
        if let Some(wrong) = &one.wrong {
            let _ = writeln!(text, "    FAIL {wrong}");
        }
    }
    if outcome.skipped() {
        let _ = writeln!(text, "  {SKIPPED}");
    }
    if let Some(trouble) = &outcome.trouble {
        let _ = writeln!(text, "  FAIL {trouble}");
    }
    text
}

fn suite(outcome: &CheckOutcome) -> Suite {
    let compared = outcome.found.iter().map(|one| {
        let lines: Vec<String> = one.lines.iter().chain(&one.wrong).cloned().collect();
        let verdict = match one.met {
            true => CaseVerdict::Passed,
            false => CaseVerdict::Failed(lines.join("\n")),
        };
        (one.title.clone(), verdict)
    });
    let skipped = outcome.skipped().then(|| {
        let verdict = CaseVerdict::Skipped(SKIPPED.to_owned());
        ("expect".to_owned(), verdict)
    });
    let trouble = outcome.trouble.iter();
    let trouble = trouble.map(|trouble| ("branch".to_owned(), CaseVerdict::Error(trouble.clone())));
    Suite {
        name: outcome.file.clone(),
        cases: compared.chain(skipped).chain(trouble).collect(),
    }
}
