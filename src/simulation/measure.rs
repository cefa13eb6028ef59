//! What a simulation has shown: speed, regimes, growth, each with an error.
//!
//! Errors are those of the motion in time: a window is cut into blocks, and the standard error of
//! the mean of the blocks is given. It holds what the motion does not repeat; the error of the grid
//! is another matter, seen by simulating with other numbers of points.

use serde::{Deserialize, Serialize};

use super::esprit::exponentials;
use super::line::LineRegime;
use super::motion::SimulatedMotion;

/// A row of the time series.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TimeSample {
    /// Time.
    pub time: f64,
    /// Energy.
    pub energy: f64,
    /// Energy less that at the start and less all work since.
    pub imbalance: f64,
    /// Share of the line in separation.
    pub separation: f64,
    /// Share in slip.
    pub slip: f64,
    /// Share in stick.
    pub stick: f64,
    /// Share in reverse slip.
    pub reverse: f64,
    /// Least pressure on what is in contact; 0 where something is in the air.
    #[serde(rename = "min_pressure")]
    pub least_pressure: f64,
    /// Largest U − δ.
    #[serde(rename = "max_gap")]
    pub largest_gap: f64,
    /// Real part of the amplitude of the mode watched.
    pub harmonic_re: f64,
    /// Imaginary part of it.
    pub harmonic_im: f64,
    /// How unlike the waves round the circle are.
    pub asymmetry: f64,
    /// V of the first point.
    #[serde(rename = "V")]
    pub tangential: f64,
    /// V̇ of the first point.
    #[serde(rename = "V_dot")]
    pub tangential_rate: f64,
}

impl TimeSample {
    /// The state of a motion. `mode` is watched; the circle is compared in `waves` parts; `start` is
    /// the energy at the beginning.
    pub fn of(
        motion: &SimulatedMotion,
        mode: u32,
        waves: usize,
        mismatch: f64,
        start: f64,
    ) -> TimeSample {
        let line = motion.line();
        let (energy, work) = motion.energy();
        let fold = |values: &[f64], with: fn(f64, f64) -> f64, from: f64| {
            values.iter().copied().fold(from, with)
        };
        let [separation, slip, stick, reverse] = line.fractions();
        let [harmonic_re, harmonic_im] = line.harmonic(mode);
        TimeSample {
            time: motion.time(),
            energy,
            imbalance: energy - start - work.iter().sum::<f64>(),
            separation,
            slip,
            stick,
            reverse,
            least_pressure: fold(&line.pressure, f64::min, f64::INFINITY),
            largest_gap: fold(&line.radial, f64::max, f64::NEG_INFINITY) - mismatch,
            harmonic_re,
            harmonic_im,
            asymmetry: line.asymmetry(waves).unwrap_or(0.0),
            tangential: line.tangential[0],
            tangential_rate: line.tangential_rate[0],
        }
    }

    /// Share of the line in a regime.
    fn share(&self, regime: LineRegime) -> f64 {
        match regime {
            LineRegime::Separation => self.separation,
            LineRegime::Slip => self.slip,
            LineRegime::Stick => self.stick,
            LineRegime::Reverse => self.reverse,
        }
    }
}

/// A number with its error.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Measure {
    /// Name for tables.
    pub name: &'static str,
    /// Value.
    pub value: f64,
    /// Standard error.
    pub error: f64,
    /// Begin of the window of time it comes from.
    pub from: f64,
    /// End of the window.
    pub to: f64,
}

/// Blocks that a window is cut into.
const BLOCKS: usize = 8;

/// Fewest samples of a block.
const LEAST: usize = 4;

/// Slope of a straight line through the points by least squares.
fn slope(times: &[f64], values: &[f64]) -> f64 {
    let count = times.len() as f64;
    let (t_mean, v_mean) = (
        times.iter().sum::<f64>() / count,
        values.iter().sum::<f64>() / count,
    );
    let (mut product, mut square) = (0.0, 0.0);
    for (t, v) in times.iter().zip(values) {
        product += (t - t_mean) * (v - v_mean);
        square += (t - t_mean) * (t - t_mean);
    }
    product / square
}

/// Value of a statistic over all, and the standard error from blocks. None for too few samples.
fn blocked(count: usize, statistic: impl Fn(std::ops::Range<usize>) -> f64) -> Option<(f64, f64)> {
    if count < BLOCKS * LEAST {
        return None;
    }
    let parts: Vec<f64> = (0..BLOCKS)
        .map(|block| statistic(block * count / BLOCKS..(block + 1) * count / BLOCKS))
        .collect();
    let mean = parts.iter().sum::<f64>() / BLOCKS as f64;
    let variance =
        parts.iter().map(|part| (part - mean).powi(2)).sum::<f64>() / (BLOCKS - 1) as f64;
    Some((statistic(0..count), (variance / BLOCKS as f64).sqrt()))
}

/// The phase of the mode watched without jumps. Right as long as it turns by less than half a turn
/// from sample to sample.
fn phases(samples: &[TimeSample]) -> Vec<f64> {
    let mut turns = 0.0;
    let mut last = None;
    samples
        .iter()
        .map(|sample| {
            let phase = sample.harmonic_im.atan2(sample.harmonic_re);
            if let Some(last) = last {
                let jump: f64 = phase - last;
                turns -= (jump / std::f64::consts::TAU).round();
            }
            last = Some(phase);
            phase + turns * std::f64::consts::TAU
        })
        .collect()
}

/// Speed of the mode watched, its amplitude, the shares of the regimes and the asymmetry, over the
/// second half of the samples.
pub fn steady_state(samples: &[TimeSample], mode: u32) -> Vec<Measure> {
    let half = &samples[samples.len() / 2..];
    let Some(last) = half.last() else {
        return Vec::new();
    };
    let (from, to) = (half[0].time, last.time);
    let times: Vec<f64> = half.iter().map(|sample| sample.time).collect();
    let mut measures = Vec::new();
    let mut add = |name, found: Option<(f64, f64)>| {
        if let Some((value, error)) = found.filter(|found| found.0.is_finite()) {
            measures.push(Measure {
                name,
                value,
                error,
                from,
                to,
            });
        }
    };
    if mode > 0 {
        let phases = phases(half);
        let speed = blocked(half.len(), |range| {
            -slope(&times[range.clone()], &phases[range]) / f64::from(mode)
        });
        add("speed", speed);
    }
    let mean = |value: &dyn Fn(&TimeSample) -> f64| {
        blocked(half.len(), |range| {
            let count = range.len() as f64;
            half[range].iter().map(value).sum::<f64>() / count
        })
    };
    add(
        "amplitude",
        mean(&|sample| sample.harmonic_re.hypot(sample.harmonic_im)),
    );
    for regime in LineRegime::ALL {
        add(regime.name(), mean(&|sample| sample.share(regime)));
    }
    add("asymmetry", mean(&|sample| sample.asymmetry));
    add("energy", mean(&|sample| sample.energy));
    measures
}

/// Most samples of a signal that is decomposed; more are thinned out.
const SIGNAL: usize = 600;

/// Growth rate and frequency of the mode watched while everything slips: of the exponential of its
/// complex amplitude that is largest at the end of this time. The error is the difference from what
/// the last three quarters of the time give.
pub fn linear_growth(samples: &[TimeSample]) -> Vec<Measure> {
    let all_slip = |sample: &&TimeSample| sample.slip == 1.0;
    let slipping = samples.iter().take_while(all_slip).count();
    let thinning = slipping.div_ceil(SIGNAL).max(1);
    let kept: Vec<&TimeSample> = samples[..slipping].iter().step_by(thinning).collect();
    if kept.len() < BLOCKS * LEAST {
        return Vec::new();
    }
    let last = kept.len() - 1;
    let step = (kept[last].time - kept[0].time) / last as f64;
    let signal: Vec<[f64; 2]> = kept
        .iter()
        .map(|sample| [sample.harmonic_re, sample.harmonic_im])
        .collect();
    let all = exponentials(&signal, step);
    let later = exponentials(&signal[signal.len() / 4..], step);
    let (Some(leading), Some(other)) = (all.first(), later.first()) else {
        return Vec::new();
    };
    [("growth", 0), ("frequency", 1)]
        .into_iter()
        .map(|(name, part)| Measure {
            name,
            value: leading.exponent[part],
            error: (leading.exponent[part] - other.exponent[part]).abs(),
            from: kept[0].time,
            to: kept[last].time,
        })
        .collect()
}
