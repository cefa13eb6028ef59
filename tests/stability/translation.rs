//! A shifted wave is a wave: λ = 0 is an eigenvalue of sector 0, whatever the signature.
//!
//! 1 − t(0) + d(0) = 0. Where a zone has no length, its switch may be 0/0: at the event itself a
//! nascent zone is neither there nor not.

use std::collections::BTreeMap;

use brakewave::branch::EventType;
use brakewave::tube::stability::characteristic::{Characteristic, NotLinearised};

use crate::stability::observed;
use crate::stability::waves::{C64, follow, problem, problems};

/// t(0) comes from a product over all zones; durations and switches carry the residual of the wave.
const BOUND: f64 = 1e-11;

/// On the slow branch the slip zones grow by up to e¹³, and so does the rounding of the state they
/// are entered with: there the defect is measured as an eigenvalue, |F(0)/F′(0)|.
const STIFF: &str = "mode4_slow.ron";

/// Whether a row is a change of regime, where a zone has no length, or a fold, where λ = 0 is a
/// double zero and |F/F′| means nothing.
fn at_change(kind: Option<EventType>) -> bool {
    matches!(
        kind,
        Some(EventType::RV | EventType::GR | EventType::CO | EventType::ST | EventType::LP)
    )
}

#[test]
fn zero_is_an_eigenvalue_of_every_wave() {
    let mut worst: BTreeMap<String, (f64, usize)> = BTreeMap::new();
    let mut changes = (0, 0, 0.0_f64);
    let mut stiff = 0.0_f64;
    for name in problems() {
        let (mut problem, text) = problem(&name);
        problem.stability = None;
        for item in follow(&problem, &text).items {
            let (wave, point) = item.wave();
            let characteristic = match Characteristic::new(wave, point) {
                Ok(characteristic) => characteristic,
                // a regularised law of small ε, which changes within it
                Err(NotLinearised::Sharp) => continue,
                Err(error) => panic!("{error}"),
            };
            let value = characteristic.evaluate(C64::new(0.0, 0.0));
            let [trace, determinant] = value.numbers();
            let mut defect = (1.0 - trace + determinant).norm();
            if name == STIFF {
                let (f, by) = value.sector(C64::new(1.0, 0.0));
                stiff = stiff.max(defect);
                defect = (f / by).norm();
            }
            if at_change(item.point.kind) {
                changes.0 += 1;
                if defect < BOUND {
                    changes.1 += 1;
                    changes.2 = changes.2.max(defect);
                }
                continue;
            }
            let entry = worst.entry(item.point.regimes.clone()).or_default();
            entry.0 = entry.0.max(defect);
            entry.1 += 1;
            assert!(
                defect < BOUND,
                "{name}, point {} ({:?}), {}: {defect:e}",
                item.point.point,
                item.point.model,
                item.point.regimes
            );
        }
    }
    observed("|N(0) − 1| on the slow branch, not bounded", stiff);
    for (regimes, (defect, count)) in &worst {
        observed(
            &format!("translation mode, {count} points of {regimes}"),
            *defect,
        );
    }
    let (count, fine, defect) = changes;
    observed(
        &format!("translation mode, {fine} of {count} changes of regime"),
        defect,
    );
    // slip-stick and its successors, a wave without stick, and one that touches
    let all: Vec<&str> = worst.keys().map(String::as_str).collect();
    for regimes in ["slip-stick", "slip-reverse-stick", "slip-separation"] {
        assert!(all.contains(&regimes), "{regimes} is not among {all:?}");
    }
}
