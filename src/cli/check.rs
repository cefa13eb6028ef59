//! `brakewave check`: does the branch still have the events it is expected to have?

use std::fmt::Write;
use std::path::{Path, PathBuf};

use clap::Args;
use quick_junit::{NonSuccessKind, Report as JunitReport, TestCase, TestCaseStatus, TestSuite};

use super::progress::Progress;
use super::run::{Prepared, ready};
use super::{BAD_INPUT, Failure, INPUT_OUTPUT, NUMERICAL, UNMET, print, spare, warn, write};
use crate::branch::Event;
use crate::branch::run::{End, Runner};
use crate::model::Parameter;
use crate::problem::{self, Expectation, Problem};

#[derive(Debug, Args)]
pub struct CheckArguments {
    /// Problem files
    #[arg(required = true)]
    problems: Vec<PathBuf>,
    /// Also write the outcome as JUnit XML
    #[arg(long, value_name = "FILE")]
    junit: Option<PathBuf>,
}

/// One number of one expectation, compared.
struct Comparison {
    name: String,
    expected: f64,
    found: Option<f64>,
    tolerance: f64,
    met: bool,
}

/// Outcome of one problem file.
struct Outcome {
    file: PathBuf,
    comparisons: Vec<(String, Vec<Comparison>, Option<String>)>,
    code: u8,
    trouble: Option<String>,
}

impl Outcome {
    /// Whether nothing was compared, and nothing went wrong: this is no success.
    fn skipped(&self) -> bool {
        self.comparisons.is_empty() && self.trouble.is_none()
    }
}

const SKIPPED: &str = "nothing expected: the list `expect` is empty";

pub fn check(arguments: &CheckArguments) -> Result<u8, Failure> {
    if let Some(path) = &arguments.junit {
        spare(path, &arguments.problems)?;
    }
    let mut outcomes = Vec::with_capacity(arguments.problems.len());
    for file in &arguments.problems {
        let outcome = match check_file(file) {
            Ok(outcome) => outcome,
            Err(failure) => Outcome {
                file: file.clone(),
                comparisons: Vec::new(),
                code: failure.code(),
                trouble: Some(failure.to_string()),
            },
        };
        print(&text(&outcome))?;
        outcomes.push(outcome);
    }
    let skipped = outcomes.iter().filter(|outcome| outcome.skipped()).count();
    let passed = outcomes.iter().filter(|outcome| outcome.code == 0).count() - skipped;
    let compared = outcomes.len() - skipped;
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
        write_junit(path, &outcomes)?;
    }
    // bad input outranks damaged input, then a numerical failure, then an expectation not met
    let codes = |code: u8| outcomes.iter().any(|outcome| outcome.code == code);
    Ok([BAD_INPUT, INPUT_OUTPUT, NUMERICAL, UNMET]
        .into_iter()
        .find(|code| codes(*code))
        .unwrap_or(0))
}

/// A file that only simulates has no branch to run, and nothing to compare.
fn simulates_only(problem: &Problem) -> bool {
    problem.simulation.is_some() && problem.continuation.is_none() && problem.expect.is_empty()
}

fn check_file(file: &Path) -> Result<Outcome, Failure> {
    let (problem, text) = problem::read(file)?;
    if simulates_only(&problem) {
        return Ok(Outcome {
            file: file.to_path_buf(),
            comparisons: Vec::new(),
            code: 0,
            trouble: None,
        });
    }
    let Prepared {
        problem,
        continuation,
        restart,
        source,
    } = ready(problem, text, file)?;
    let mut branch = Runner::begin(&problem, &continuation, restart.as_ref())
        .map_err(|error| source.place(error))?;
    let mut events = Vec::new();
    let mut progress = Progress::new(false);
    while branch.progress().end.is_none() {
        events.extend(branch.step().into_iter().filter_map(|item| item.event));
        progress.show(branch.position(), || {
            let points = branch.progress().points;
            format!(
                "{}: {points} points, {} events",
                file.display(),
                events.len()
            )
        });
    }
    drop(progress);
    let comparisons = compare(&problem.expect, &events, continuation.parameter);
    let met = comparisons
        .iter()
        .all(|(_, numbers, missing)| missing.is_none() && numbers.iter().all(|one| one.met));
    let trouble = match &branch.progress().end {
        Some(End::Failed(reason)) => Some(format!("the branch ended before its range: {reason}")),
        _ => None,
    };
    Ok(Outcome {
        file: file.to_path_buf(),
        comparisons,
        code: match (met, &trouble) {
            (false, _) => UNMET,
            (true, Some(_)) => NUMERICAL,
            (true, None) => 0,
        },
        trouble,
    })
}

fn column(event: &Event, name: &str) -> Option<f64> {
    match name {
        "speed" => Some(event.speed),
        "omega" => event.omega,
        name => event.model.value(Parameter::from_column(name)?),
    }
}

/// Difference in the sense of the tolerance: relative, absolute where zero is expected.
fn difference(expected: f64, found: f64) -> f64 {
    if expected == 0.0 {
        found.abs()
    } else {
        ((found - expected) / expected).abs()
    }
}

/// How an event fits an expectation: its worst difference, in units of the tolerance.
struct Fit {
    event: usize,
    met: bool,
    distance: f64,
}

/// The events that an expectation may mean, the nearest first.
fn fits(expectation: &Expectation, events: &[Event]) -> Vec<Fit> {
    let mut fits: Vec<Fit> = events
        .iter()
        .enumerate()
        .filter(|(_, event)| {
            event.kind == expectation.event
                && expectation
                    .sector
                    .is_none_or(|sector| event.sector == Some(sector))
                && expectation.label.is_none_or(|label| event.label == label)
        })
        .map(|(index, event)| {
            let numbers = compared(expectation, Some(event));
            let off = |one: &Comparison| {
                one.found
                    .map_or(f64::INFINITY, |found| difference(one.expected, found))
            };
            Fit {
                event: index,
                met: numbers.iter().all(|one| one.met) && regimes(expectation, event).is_none(),
                distance: numbers.iter().map(off).fold(0.0, f64::max),
            }
        })
        .collect();
    fits.sort_by(|one, other| one.distance.total_cmp(&other.distance));
    fits
}

/// Which event each expectation is compared with; no event serves two.
///
/// As many expectations as possible are met: an expectation gives way to another one if it finds an
/// event elsewhere (augmenting paths in a bipartite graph). Those that are left are shown with the
/// nearest event that is left.
fn assign(fits: &[Vec<Fit>], events: usize) -> Vec<Option<usize>> {
    /// Finds an event for an expectation, moving others if need be.
    fn augment(
        one: usize,
        fits: &[Vec<Fit>],
        seen: &mut [bool],
        taken: &mut [Option<usize>],
    ) -> bool {
        for fit in fits[one].iter().filter(|fit| fit.met) {
            if std::mem::replace(&mut seen[fit.event], true) {
                continue;
            }
            if taken[fit.event].is_none_or(|other| augment(other, fits, seen, taken)) {
                taken[fit.event] = Some(one);
                return true;
            }
        }
        false
    }
    let mut taken: Vec<Option<usize>> = vec![None; events];
    for one in 0..fits.len() {
        augment(one, fits, &mut vec![false; events], &mut taken);
    }
    let mut assigned = vec![None; fits.len()];
    for (event, one) in taken.iter().enumerate() {
        if let Some(one) = *one {
            assigned[one] = Some(event);
        }
    }
    let mut rest: Vec<(usize, &Fit)> = (0..fits.len())
        .filter(|one| assigned[*one].is_none())
        .flat_map(|one| fits[one].iter().map(move |fit| (one, fit)))
        .collect();
    rest.sort_by(|(_, one), (_, other)| one.distance.total_cmp(&other.distance));
    for (one, fit) in rest {
        if assigned[one].is_none() && taken[fit.event].is_none() {
            assigned[one] = Some(fit.event);
            taken[fit.event] = Some(one);
        }
    }
    assigned
}

/// The numbers of an expectation beside those of an event.
fn compared(expectation: &Expectation, event: Option<&Event>) -> Vec<Comparison> {
    let tolerance = expectation.tolerance;
    expectation
        .numbers()
        .into_iter()
        .map(|(name, expected)| {
            let found = event.and_then(|event| column(event, name));
            Comparison {
                name: name.to_string(),
                expected,
                found,
                tolerance,
                met: found.is_some_and(|found| difference(expected, found) <= tolerance),
            }
        })
        .collect()
}

/// The regimes that are not as expected, in words.
fn regimes(expectation: &Expectation, event: &Event) -> Option<String> {
    [
        (&expectation.regimes_before, &event.regimes_before, "before"),
        (&expectation.regimes_after, &event.regimes_after, "after"),
    ]
    .into_iter()
    .find_map(|(expected, found, side)| {
        let expected = expected.as_ref()?;
        (expected != found).then(|| format!("regimes {side}: expected {expected}, found {found}"))
    })
}

/// Every expectation with the event it is compared with.
fn compare(
    expectations: &[Expectation],
    events: &[Event],
    parameter: Parameter,
) -> Vec<(String, Vec<Comparison>, Option<String>)> {
    let all: Vec<Vec<Fit>> = expectations.iter().map(|one| fits(one, events)).collect();
    let assigned = assign(&all, events.len());
    expectations
        .iter()
        .zip(assigned)
        .map(|(expectation, index)| {
            let mut title = expectation.event.to_string();
            if let Some(sector) = expectation.sector {
                let _ = write!(title, " sector {sector}");
            }
            let Some(event) = index.map(|index| &events[index]) else {
                let missing = format!("no {title} was found on the branch that is not matched");
                return (title, compared(expectation, None), Some(missing));
            };
            let _ = write!(
                title,
                " at {} = {:.12}",
                parameter.column(),
                column(event, parameter.column()).unwrap_or(f64::NAN)
            );
            (
                title,
                compared(expectation, Some(event)),
                regimes(expectation, event),
            )
        })
        .collect()
}

fn line(comparison: &Comparison) -> String {
    let verdict = if comparison.met { "ok  " } else { "FAIL" };
    match comparison.found {
        Some(found) => format!(
            "{verdict} {:<10} expected {:+.16e}  found {:+.16e}  difference {:.1e}  tolerance {:.0e}",
            comparison.name,
            comparison.expected,
            found,
            difference(comparison.expected, found),
            comparison.tolerance
        ),
        None => format!(
            "{verdict} {:<10} expected {:+.16e}  not found",
            comparison.name, comparison.expected
        ),
    }
}

fn text(outcome: &Outcome) -> String {
    let mut text = format!("{}\n", outcome.file.display());
    for (title, numbers, wrong) in &outcome.comparisons {
        let _ = writeln!(text, "  {title}");
        for comparison in numbers {
            let _ = writeln!(text, "    {}", line(comparison));
        }
        if let Some(wrong) = wrong {
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

fn write_junit(path: &Path, outcomes: &[Outcome]) -> Result<(), Failure> {
    let mut report = JunitReport::new("brakewave check");
    for outcome in outcomes {
        let name = outcome.file.display().to_string();
        let mut suite = TestSuite::new(&name);
        for (title, numbers, wrong) in &outcome.comparisons {
            let failed = wrong.is_some() || numbers.iter().any(|one| !one.met);
            let status = if failed {
                let mut status = TestCaseStatus::non_success(NonSuccessKind::Failure);
                let lines: Vec<String> = numbers
                    .iter()
                    .map(line)
                    .chain(wrong.iter().cloned())
                    .collect();
                status.set_message(lines.join("\n"));
                status
            } else {
                TestCaseStatus::success()
            };
            let mut case = TestCase::new(title, status);
            case.set_classname(&name);
            suite.add_test_case(case);
        }
        if outcome.skipped() {
            let mut status = TestCaseStatus::skipped();
            status.set_message(SKIPPED);
            let mut case = TestCase::new("expect", status);
            case.set_classname(&name);
            suite.add_test_case(case);
        }
        if let Some(trouble) = &outcome.trouble {
            let mut status = TestCaseStatus::non_success(NonSuccessKind::Error);
            status.set_message(trouble);
            let mut case = TestCase::new("branch", status);
            case.set_classname(&name);
            suite.add_test_case(case);
        }
        report.add_test_suite(suite);
    }
    let xml = report
        .to_string()
        .map_err(|error| Failure::Usage(format!("JUnit report: {error}")))?;
    write(path, &xml)
}
