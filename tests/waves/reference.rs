//! Figures computed by an independent program: Newton systems in double precision, solved again
//! with 40 digits, closure confirmed by a Runge–Kutta integration with its own event location.
//! Parameters and speeds carry 16 digits, zone lengths (duration times |c|, from release) 12.

use brakewave::branch::EventType::{self, CO, GR, LP, RV, ST};
use brakewave::branch::first_wave::first_wave;
use brakewave::branch::orbit::Found;
use brakewave::linalg::Vector;
use brakewave::tube::model::{Model, Parameter};
use brakewave::tube::wave::Wave;
use brakewave::tube::wave::start::Which;

use crate::waves::branches::{
    Case, STEPS, fast_in_friction, fast_in_mismatch, lengths, regimes, slow_in_mismatch, speed,
    tube,
};
use crate::waves::observed;

/// An event: type, parameter, speed, regimes before and after, zone lengths.
type Event = (
    EventType,
    f64,
    f64,
    &'static str,
    &'static str,
    &'static [f64],
);
/// A wave at a parameter value: speed, regimes, zone lengths.
type Spot = (f64, f64, &'static str, &'static [f64]);

/// Half a unit of the last of `digits` significant digits.
fn half_unit(value: f64, digits: i32) -> f64 {
    if value == 0.0 {
        return 0.0;
    }
    let leading = value.abs().log10().floor() as i32;
    0.5 * 10.0_f64.powi(leading + 1 - digits)
}

/// Error that Newton's method leaves in a zone length: a fold is located with the slope of the
/// parameter along the arc at 1e-13, so that lengths of order one may be wrong by as much times
/// the scale of the arclength; user points and changes of regime are exact to rounding times the
/// condition of the equations, some hundred.
const LENGTH_ERROR: f64 = 1e-12;

struct Worst {
    parameter: f64,
    speed: f64,
    length: f64,
}

impl Worst {
    fn new() -> Worst {
        Worst {
            parameter: 0.0,
            speed: 0.0,
            length: 0.0,
        }
    }

    fn compare(&mut self, found: &Found, speed_expected: f64, zones: &[f64]) {
        let error = (speed(found) - speed_expected).abs();
        self.speed = self.speed.max(error);
        assert!(
            error < 1e-12 + half_unit(speed_expected, 16),
            "speed {} for {speed_expected}",
            speed(found)
        );
        let lengths = lengths(&found.orbit, &found.node.point);
        assert_eq!(lengths.len(), zones.len());
        for (length, expected) in lengths.iter().zip(zones) {
            let error = (length - expected).abs();
            let printed = half_unit(*expected, 12);
            self.length = self.length.max(error - printed);
            assert!(
                error <= printed + LENGTH_ERROR,
                "length {length} for {expected} at {}",
                found.parameter
            );
        }
    }

    fn show(&self, name: &str) {
        observed(&format!("{name}: parameter of events"), self.parameter);
        observed(&format!("{name}: speed"), self.speed);
        observed(&format!("{name}: length beyond its digits"), self.length);
    }
}

fn check(name: &str, case: &Case, events: &[Event], spots: &[Spot]) {
    let mut stop_at: Vec<f64> = spots.iter().map(|spot| spot.0).collect();
    stop_at.dedup();
    let run = case.follow(&stop_at);
    let mut worst = Worst::new();
    let found = run.events();
    let kinds: Vec<EventType> = found.iter().filter_map(|found| found.kind()).collect();
    let expected: Vec<EventType> = events.iter().map(|event| event.0).collect();
    assert_eq!(kinds, expected);
    for (found, (kind, value, speed, before, after, zones)) in found.into_iter().zip(events) {
        let error = (found.parameter - value).abs();
        worst.parameter = worst.parameter.max(error / value);
        assert!(
            error <= 1e-12 * value,
            "{kind} at {} for {value}",
            found.parameter
        );
        // the error bound that the program states covers the difference
        assert!(
            error <= found.uncertainty + half_unit(*value, 16),
            "{kind} at {value}: error {error:e}, stated {:e}",
            found.uncertainty
        );
        assert_eq!(
            regimes(found),
            ((*before).to_string(), (*after).to_string()),
            "{kind} at {value}"
        );
        worst.compare(found, *speed, zones);
    }
    for value in stop_at {
        let start = &run.points[0];
        let passes: Vec<&Found> = if (start.parameter / value - 1.0).abs() < 1e-15 {
            vec![start]
        } else {
            run.user_points(value)
        };
        let expected: Vec<&Spot> = spots.iter().filter(|spot| spot.0 == value).collect();
        assert!(passes.len() >= expected.len(), "passes of {value}");
        for (found, (_, speed, before, zones)) in passes.into_iter().zip(expected) {
            assert_eq!(regimes(found).0, *before, "at {value}");
            worst.compare(found, *speed, zones);
        }
    }
    worst.show(name);
}

const SS: &str = "slip-stick";
const SRS: &str = "slip-reverse-stick";
const SPSRS: &str = "slip-separation-slip-reverse-stick";
const SPRS: &str = "slip-separation-reverse-stick";
const SPSS: &str = "slip-separation-slip-stick";
const SP: &str = "slip-separation";

#[test]
fn fast_branch_in_the_mismatch() {
    check(
        "fast, δ",
        &fast_in_mismatch(),
        &[
            (
                RV,
                0.09681408171599355,
                -1.242700800630082,
                SS,
                SRS,
                &[1.22092540483, 0.349870921961],
            ),
            (
                GR,
                0.05022841036275642,
                -1.247346361588719,
                SRS,
                SPSRS,
                &[1.2374999394, 0.220104456497, 0.113191930895],
            ),
            (
                CO,
                0.02348078272152996,
                -1.250230672587828,
                SPSRS,
                SPRS,
                &[
                    0.481593461853,
                    0.852770689535,
                    0.0,
                    0.159646301817,
                    0.0767858735902,
                ],
            ),
            (
                CO,
                0.003810637594310301,
                -1.261910578601672,
                SPRS,
                SPSS,
                &[0.383706912514, 1.1064049032, 0.0, 0.0806845110781],
            ),
            (
                ST,
                0.0005044760768328024,
                -1.263007784004346,
                SPSS,
                SP,
                &[0.36552057089, 1.14323348283, 0.0620422730791, 0.0],
            ),
        ],
        &[
            (
                0.2,
                -1.242700800630082,
                SS,
                &[1.22092540483, 0.349870921961],
            ),
            (
                0.08,
                -1.242963703241321,
                SRS,
                &[1.22186695292, 0.0861353831349, 0.262793990738],
            ),
            (
                0.045,
                -1.246306672093151,
                SPSRS,
                &[
                    0.630452607792,
                    0.409996647428,
                    0.201407271523,
                    0.24412026667,
                    0.084819533382,
                ],
            ),
            (
                0.02,
                -1.253060437162417,
                SPRS,
                &[
                    0.465449207571,
                    0.90332703664,
                    0.138687794092,
                    0.0633322884924,
                ],
            ),
            (
                0.004,
                -1.26182855710314,
                SPRS,
                &[
                    0.384717899645,
                    1.10423496289,
                    0.00372258767185,
                    0.0781208765847,
                ],
            ),
            (
                0.001,
                -1.262906823801011,
                SPSS,
                &[
                    0.368333111608,
                    1.13788495265,
                    0.033645869185,
                    0.0309323933516,
                ],
            ),
        ],
    );
}

#[test]
fn slow_branch_in_the_mismatch() {
    check(
        "slow, δ",
        &slow_in_mismatch(),
        &[
            (
                GR,
                0.7596640793486009,
                -1.047988020675271,
                SS,
                SPSS,
                &[0.192228841311, 1.37856748548],
            ),
            (
                CO,
                0.6537831264648296,
                -1.047740634384199,
                SPSS,
                SPRS,
                &[0.120531714787, 0.0753083977401, 0.0, 1.37495621427],
            ),
            (
                LP,
                0.6537309315891844,
                -1.047733565823334,
                SPRS,
                SPRS,
                &[
                    0.120291549944,
                    0.075638525196,
                    0.00103057944974,
                    1.37383567221,
                ],
            ),
            (
                CO,
                5.405491621353477,
                -1.04390387248899,
                SPRS,
                SPSS,
                &[0.0404441110285, 0.090022642643, 0.0, 1.44032957312],
            ),
            (
                LP,
                5.430509345490274,
                -1.043891072264797,
                SPSS,
                SPSS,
                &[
                    0.0400027902788,
                    0.0898088217502,
                    0.00134391207027,
                    1.4396408027,
                ],
            ),
            (
                GR,
                0.9752066442305001,
                -1.043963132195445,
                SPSS,
                "slip-separation-slip-separation-slip-stick",
                &[
                    0.0319650416371,
                    0.0939993989382,
                    0.0851948385776,
                    1.35963704764,
                ],
            ),
        ],
        &[
            (
                0.7,
                -1.048015223145183,
                SPSS,
                &[
                    0.137159930127,
                    0.0444442137792,
                    0.0132384916599,
                    1.37595369123,
                ],
            ),
            (
                0.7,
                -1.047301458721592,
                SPRS,
                &[
                    0.11021066446,
                    0.0866424609167,
                    0.0179273228995,
                    1.35601587852,
                ],
            ),
            (
                1.0,
                -1.04609790071647,
                SPRS,
                &[
                    0.0874269015833,
                    0.0995035477888,
                    0.0152725537416,
                    1.36859332368,
                ],
            ),
            (
                2.0,
                -1.044878654035839,
                SPRS,
                &[
                    0.0640962501883,
                    0.0999574453467,
                    0.00765950229809,
                    1.39908312896,
                ],
            ),
            (
                5.0,
                -1.044000527466485,
                SPRS,
                &[
                    0.0434701644336,
                    0.0915716433735,
                    0.0010774038615,
                    1.43467711513,
                ],
            ),
        ],
    );
}

#[test]
fn fast_branch_in_friction() {
    check(
        "fast, f",
        &fast_in_friction(),
        &[
            (
                LP,
                1.09151842035911,
                -1.121901058375943,
                SS,
                SS,
                &[0.687292652195, 0.883503674599],
            ),
            (
                GR,
                1.041478997531129,
                -1.092249834850394,
                SS,
                SPSS,
                &[0.543076606191, 1.0277197206],
            ),
            (
                LP,
                0.9944192801072622,
                -1.081449550476252,
                SPSS,
                SPSS,
                &[
                    0.290396475138,
                    0.192300297948,
                    0.015432224259,
                    1.07266732945,
                ],
            ),
            (
                CO,
                1.002777817991802,
                -1.078810980470606,
                SPSS,
                SPRS,
                &[0.267575891313, 0.222305648086, 0.0, 1.0809147874],
            ),
        ],
        &[
            (
                0.3,
                -1.258426837733223,
                SS,
                &[1.32436032139, 0.246436005408],
            ),
            (
                0.5,
                -1.242700800630082,
                SS,
                &[1.22092540483, 0.349870921961],
            ),
            (
                0.8,
                -1.207479552577549,
                SS,
                &[1.04972649646, 0.521069830334],
            ),
        ],
    );
}

/// The wave of mode 8 at these parameters.
fn mode8(model: &Model) -> (Wave, Vector) {
    first_wave(model, Parameter::Mismatch, 8, Which::Fast, 0.01, STEPS).expect("the wave exists")
}

/// Reverse slip from θ = 0.62 to 0.73 of 0.785: both ends, and the speed, are as exact as the
/// printed digits of f and δ allow, which the derivatives of each in f and δ tell.
fn check_mode8(nu: f64, friction: (f64, i32), mismatch: (f64, i32), expected_speed: f64) {
    let figures = |friction: f64, mismatch: f64| {
        let (wave, point) = mode8(&tube(nu, 1.25, friction, mismatch));
        assert_eq!(wave.signature.to_string(), SRS);
        let zones = lengths(&wave, &point);
        [zones[0], zones[0] + zones[1], wave.speed_at(&point)]
    };
    let here = figures(friction.0, mismatch.0);
    let step = 1e-6;
    let moved = [
        figures(friction.0 * (1.0 + step), mismatch.0),
        figures(friction.0, mismatch.0 * (1.0 + step)),
    ];
    let digits = [
        half_unit(friction.0, friction.1) / friction.0,
        half_unit(mismatch.0, mismatch.1) / mismatch.0,
    ];
    for (index, expected) in [0.62, 0.73, expected_speed].into_iter().enumerate() {
        let spread: f64 = (0..2)
            .map(|j| (moved[j][index] - here[index]).abs() / step * digits[j])
            .sum();
        let printed = if index == 2 {
            half_unit(expected, 14)
        } else {
            0.0
        };
        let error = (here[index] - expected).abs();
        observed(&format!("mode 8, ν = {nu}, figure {index}"), error);
        assert!(
            error <= spread + printed + 1e-13,
            "{} for {expected}: allowed {spread:e}",
            here[index]
        );
    }
}

#[test]
fn mode_eight_with_reverse_slip() {
    check_mode8(
        0.25,
        (0.44610776254161, 14),
        (0.026773139826513, 14),
        -1.2006413956628,
    );
    check_mode8(
        0.3,
        (1.59804869939, 12),
        (0.0063053409825085, 14),
        -1.2480020849115,
    );
}
