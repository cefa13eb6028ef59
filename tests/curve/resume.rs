//! A curve that goes on from saved steps takes the same steps as one that was never interrupted.

use brakewave::curve::{CurveHead, CurveRun, CurveStep};
use brakewave::problem::{Problem, parse};
use serde::de::DeserializeOwned;

use crate::curve::{start, tube};

fn problem(name: &str) -> Problem {
    let path = format!("{}/problems/{name}.ron", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(&path).unwrap();
    parse(&text, name).unwrap()
}

/// Written down and read again.
fn copied<T: serde::Serialize + DeserializeOwned>(value: &T) -> T {
    ron::from_str(&ron::to_string(value).unwrap()).unwrap()
}

/// A curve resumed before its first step, after every seventeenth, and after the last, takes the very next two, to the last
/// bit.
fn resumes_after_its_steps(problem: &Problem) {
    let start = start(problem).unwrap();
    let begin = || CurveRun::begin(&start.system, start.event, &start.point, start.limits);
    let mut run = begin().unwrap();
    let head: CurveHead = copied(run.head());
    assert_eq!(&head, run.head());
    let mut steps: Vec<CurveStep> = Vec::new();
    while let Some(step) = run.step().unwrap() {
        steps.push(step);
    }
    let whole = run.curve();
    assert!(steps.len() > 10, "{}", steps.len());
    let saved: Vec<CurveStep> = copied(&steps);
    let counts = 0..=steps.len();
    for count in counts.filter(|count| count % 17 == 0 || *count == steps.len()) {
        let mut run = CurveRun::resume(head.clone(), saved[..count].to_vec()).unwrap();
        for next in 0..2 {
            let expected = steps.get(count + next);
            assert_eq!(run.step().unwrap().as_ref(), expected, "{count} + {next}");
        }
        if count == steps.len() {
            assert_eq!(run.curve(), whole);
        }
    }
}

/// Take-off through several signatures and round a fold.
#[test]
fn a_curve_of_take_off_resumed_after_its_steps_takes_the_same_steps() {
    resumes_after_its_steps(&problem("mode4_curve"));
}

/// Folds round a cusp.
#[test]
fn a_curve_of_folds_resumed_after_its_steps_takes_the_same_steps() {
    let mut problem = problem("mode2_cusp");
    problem.curve.as_mut().unwrap().ds_max = 0.5;
    resumes_after_its_steps(&problem);
}

/// Hopf points.
#[test]
fn a_curve_of_hopf_points_resumed_after_its_steps_takes_the_same_steps() {
    resumes_after_its_steps(&tube(
        0.5,
        0.072,
        0.0,
        "continuation: (parameter: Mismatch, range: (0.06, 0.2), toward: Down), curve: (event: HB, \
         sector: 0, parameters: (Mismatch, Friction), range: ((0.06, 0.09), (0.4, 0.6)))",
    ));
}

/// What does not fit is refused, not gone on with.
#[test]
fn steps_that_do_not_fit_are_refused() {
    let start = start(&problem("mode4_curve")).unwrap();
    let mut run = CurveRun::begin(&start.system, start.event, &start.point, start.limits).unwrap();
    let head = run.head().clone();
    let step = run.step().unwrap().unwrap();
    let text = ron::to_string(&step).unwrap();
    for (list, damage) in [
        ("unknowns:[", "unknowns:[1.0,"),
        ("tangent:[", "tangent:[NaN,"),
    ] {
        assert!(text.contains(list));
        let damaged: CurveStep = ron::from_str(&text.replace(list, damage)).unwrap();
        assert!(
            CurveRun::resume(head.clone(), vec![damaged]).is_err(),
            "{list}"
        );
    }
    assert!(CurveRun::resume(head.clone(), vec![step]).is_ok());
    let text = ron::to_string(&head).unwrap();
    let short: CurveHead = ron::from_str(&text.replace("tangent:[", "tangent:[0.5,")).unwrap();
    assert!(CurveRun::resume(short, Vec::new()).is_err());
}
