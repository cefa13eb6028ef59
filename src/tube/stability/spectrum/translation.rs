//! The translation mode λ = 0 of sector 0, and the eigenvalue that comes to it at a fold.

use super::{C64, ON_AXIS, WaveEigenvalue};
use crate::tube::stability::characteristic::Characteristic;

/// The zero of sector 0 nearest to λ = 0 is the translation mode if it is nearer than this, in units of
/// 1/T: rounding leaves 1e-15 to 1e-9 of a simple zero, 1e-7 of a double one.
const TRANSLATION: f64 = 1e-2;

/// Two zeros closer to λ = 0 than this, in units of 1/T, disturb one another by more than 1e-13.
pub(super) const DOUBLE: f64 = 1e-3;

/// Takes the translation mode out of the zeros of sector 0 and returns its distance from 0. At a fold
/// another one comes to zero, which is then found by itself.
pub(super) fn remove_translation(
    characteristic: &Characteristic,
    eigenvalues: &mut Vec<WaveEigenvalue>,
) -> Option<f64> {
    let rate = characteristic.period.recip();
    let distance = |one: &WaveEigenvalue| one.value().norm();
    let index = (0..eigenvalues.len()).min_by(|one, other| {
        distance(&eigenvalues[*one]).total_cmp(&distance(&eigenvalues[*other]))
    })?;
    let defect = distance(&eigenvalues[index]);
    if defect.is_nan() || defect > TRANSLATION * rate {
        return None;
    }
    if eigenvalues[index].multiplicity > 1 {
        eigenvalues[index].multiplicity -= 1;
    } else {
        eigenvalues.remove(index);
    }
    let mut near = eigenvalues
        .iter_mut()
        .filter(|one| distance(one) < DOUBLE * rate);
    if let (Some(one), None) = (near.next(), near.next())
        && one.multiplicity == 1
        && let Some(re) = beside_translation(characteristic, one.re, 2.0 * DOUBLE)
    {
        (one.re, one.im) = (re, 0.0);
    }
    Some(defect)
}

/// The real eigenvalue of sector 0 beside the translation mode, from a value nearby: the zero μ of the
/// mean of F₀′ between 0 and μ. F₀ has a double zero where μ = 0, this mean a simple one. `None` where
/// |μ| is beyond `within`, in units of 1/T.
pub(in crate::tube::stability) fn beside_translation(
    characteristic: &Characteristic,
    start: f64,
    within: f64,
) -> Option<f64> {
    /// Nodes and weights of the Gauss rule of eight points on (−1, 1): exact to rounding, as long as
    /// the longest delay turns by less than a radian.
    const GAUSS: [(f64, f64); 4] = [
        (0.183_434_642_495_649_8, 0.362_683_783_378_362),
        (0.525_532_409_916_329, 0.313_706_645_877_887_27),
        (0.796_666_477_413_626_7, 0.222_381_034_453_374_48),
        (0.960_289_856_497_536_3, 0.101_228_536_290_376_26),
    ];
    /// Two steps of the secant rule within this of each other are one value, in units of 1/T.
    const SAME: f64 = 1e-15;
    let rate = characteristic.period.recip();
    let slope = |re: f64| {
        let value = characteristic.evaluate(C64::from(re));
        let (_, by) = value.sector(C64::from(1.0));
        by.re * (value.top() + value.offset).exp()
    };
    let mean = |re: f64| -> f64 {
        let pair = |(node, weight): (f64, f64)| {
            let [low, high] = [-node, node].map(|node| slope(0.5 * re * (1.0 + node)));
            0.5 * weight * (low + high)
        };
        GAUSS.into_iter().map(pair).sum()
    };
    let longest = within * rate;
    let mut last = (0.0, slope(0.0));
    let mut re = if start.abs() > ON_AXIS * rate {
        start
    } else {
        0.5 * DOUBLE * rate
    };
    for _ in 0..30 {
        let here = (re, mean(re));
        let step = here.1 * (here.0 - last.0) / (here.1 - last.1);
        if !step.is_finite() {
            // both are on the zero to rounding
            return (here.1 == last.1 && here.1 == 0.0).then_some(re);
        }
        re -= step;
        if re.abs() > longest {
            return None;
        }
        if step.abs() <= SAME * rate + 4.0 * f64::EPSILON * re.abs() {
            return Some(re);
        }
        last = here;
    }
    None
}
