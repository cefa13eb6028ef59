//! Events that lie closer together than any step: two of one margin, and two of different margins.

use brakewave::branch::EventType::{GR, LP, RV, UZ};
use brakewave::branch::special::{Close, WaveMargin};
use brakewave::continuation::walk::End;
use brakewave::tube::model::signature::Regime;
use brakewave::tube::model::{Model, Parameter};
use brakewave::tube::wave::admissibility::WaveWatch;
use brakewave::tube::wave::start::{Which, least_mismatch, slip_stick};

use crate::waves::branches::{Case, Run, fast_in_mismatch, regimes, tube};
use crate::waves::down_and_up::{back, same};
use crate::waves::observed;

/// The tube whose onset of reverse slip is least in between, mode 3.
fn model(friction: f64, mismatch: f64) -> Model {
    tube(0.27, 1.43, friction, mismatch)
}

/// δ at which reverse slip begins, in closed form.
fn onset(friction: f64) -> f64 {
    let model = model(friction, 1.0);
    let wave = slip_stick(&model, 3, Which::Fast).expect("a wave");
    least_mismatch(&model, &wave)
}

/// The friction coefficient at which the onset of reverse slip is least, by thirds.
fn least_onset() -> f64 {
    let (mut low, mut high) = (0.8, 1.0);
    while high - low > 1e-9 {
        let third = (high - low) / 3.0;
        if onset(low + third) < onset(high - third) {
            high -= third;
        } else {
            low += third;
        }
    }
    0.5 * (low + high)
}

/// The branch in f at a mismatch, from reverse slip to reverse slip.
fn beside_the_least_onset(mismatch: f64) -> Case {
    Case {
        model: model(0.7, mismatch),
        parameter: Parameter::Friction,
        mode: 3,
        range: (0.7, 1.05),
        up: true,
        ..fast_in_mismatch()
    }
}

fn kinds(run: &Run) -> Vec<brakewave::EventType> {
    run.points.iter().filter_map(|found| found.kind()).collect()
}

/// Above the least onset by ε reverse slip is lost between two values of f that lie √ε apart: both are found,
/// there and back, where the closed form has them. A user point between them is slip-stick.
#[test]
fn two_zeros_of_one_margin() {
    let least = least_onset();
    let mut worst = 0.0_f64;
    for above in [1e-5, 1e-8, 1e-11, 1e-12] {
        let case = beside_the_least_onset(onset(least) + above);
        let run = case.follow(&[least]);
        assert_eq!(run.end, Some(End::Edge));
        let events = run.events();
        assert_eq!(events.len(), 2, "{above:e}: {:?}", kinds(&run));
        let between = run.points.iter().find(|found| found.kind() == Some(UZ));
        let between = between.expect("the user point");
        assert_eq!(between.orbit.signature.to_string(), "slip-stick");
        assert!(events[0].parameter < least && least < events[1].parameter);
        assert!(events[1].parameter - events[0].parameter < 100.0 * above.sqrt());
        for found in &events {
            assert_eq!(found.kind(), Some(RV));
            let error = (onset(found.parameter) - case.model.mismatch).abs();
            worst = worst.max(error);
            assert!(error < 4e-16, "{error:e}");
        }
        assert_eq!(regimes(events[0]).1, "slip-stick");
        assert!(run.points.iter().all(|found| found.close.is_none()));
        let last = run.points.last().expect("points");
        let returned = back(last, &case);
        let mut again = returned.events();
        again.reverse();
        assert_eq!(again.len(), 2);
        for (found, there) in again.iter().zip(&events) {
            let (before, after) = regimes(found);
            assert_eq!((after, before), regimes(there));
            let error = (onset(found.parameter) - case.model.mismatch).abs();
            worst = worst.max(error);
            assert!(error < 4e-16, "{error:e}");
        }
    }
    observed("pairs of RV against the closed form", worst);
}

/// Below the least onset there is no event. At it, to rounding, the program says that it cannot tell.
#[test]
fn a_margin_that_only_touches_zero() {
    let least = least_onset();
    let run = beside_the_least_onset(onset(least) - 1e-11).follow(&[]);
    assert!(run.events().is_empty());
    assert!(run.points.iter().all(|found| found.close.is_none()));
    let run = beside_the_least_onset(onset(least)).follow(&[]);
    assert!(run.events().is_empty());
    let close: Vec<Close> = run.points.iter().filter_map(|found| found.close).collect();
    assert_eq!(
        close,
        [Close::Margin(WaveMargin {
            regime: Regime::Reverse,
            watch: WaveWatch::Duration
        })]
    );
}

/// Reverse slip and separation begin at nearly, and at exactly, the same δ: both events are found, and the
/// branch goes on in the wave that has both; so it does on the way back, unless they are closer than 1e-10.
#[test]
fn two_margins_that_vanish_together() {
    /// Friction coefficient at which both begin at one δ.
    const MEETING: f64 = 1.3247083068705587;
    let expected = |first, second| [Some(first), Some(second), Some(LP), Some(LP)];
    for beside in [
        0.0, 3e-16, -3e-16, 1e-14, -1e-14, 1e-11, -1e-11, 1e-9, -1e-9,
    ] {
        let case = Case {
            model: model(MEETING + beside, 0.224242),
            mode: 3,
            range: (0.1009, 0.224242),
            ..fast_in_mismatch()
        };
        let run = case.follow(&[]);
        assert_eq!(run.end, Some(End::Edge), "{beside:e}");
        let events = run.events();
        let kinds: Vec<_> = events.iter().map(|found| found.kind()).collect();
        let either = [expected(RV, GR), expected(GR, RV)];
        assert!(
            either.iter().any(|order| kinds == order),
            "{beside:e}: {kinds:?}"
        );
        let apart = (events[0].parameter - events[1].parameter).abs();
        assert!(apart < 0.5 * beside.abs() + 1e-14, "{beside:e}: {apart:e}");
        assert_eq!(regimes(events[1]).1, "slip-separation-slip-reverse-stick");
        // the way back through the closing separation is found where the events are 1e-10 apart in δ; closer
        // together the branch may end there
        if apart > 1e-10 {
            let returned = back(run.points.last().expect("points"), &case);
            let mut again = returned.events();
            again.reverse();
            same(&events, &again, true);
        }
    }
}
