//! Stability from the window and from the limit at high frequency.

use super::count::{EDGE, SearchWindow, ZeroSearch};
use super::{C64, Spectrum, SpectrumRequest, WaveEigenvalue};
use crate::orbit::Stability;
use crate::tube::stability::asymptotic::HighFrequency;
use crate::tube::stability::characteristic::Characteristic;
use crate::tube::stability::verdict::VerdictReason;

/// The strips of a verdict are at least and at most this high, in units of 1/T.
const STRIPS: (f64, f64) = (15.0, 600.0);

/// Stability from the window and the limit at high frequency, and what it rests on.
pub(super) fn verdict(
    search: &ZeroSearch,
    spectrum: &Spectrum,
    request: &SpectrumRequest,
    high: &HighFrequency,
) -> (Stability, Vec<VerdictReason>) {
    let mut reasons = Vec::new();
    if !spectrum.complete {
        reasons.push(VerdictReason::Incomplete {
            listed: spectrum.on_circle(|sector| spectrum.listed_unstable(sector)),
            counted: spectrum.counted.is_some().then(|| spectrum.unstable()),
        });
    }
    if spectrum.unstable() > 0 {
        return (Stability::No, reasons);
    }
    let beyond = |one: &WaveEigenvalue| one.im.abs() > request.max_frequency;
    let sectors = spectrum.sectors.iter();
    let lists: Vec<&[WaveEigenvalue]> = sectors.map(|one| one.eigenvalues.as_slice()).collect();
    if let Some(reason) = fastest(&lists, spectrum.axis, request) {
        reasons.push(reason);
        return (Stability::No, reasons);
    }
    let limit = spectrum.limit;
    // with stick the limit is attained; without, it is a bound only
    if limit > spectrum.axis && search.characteristic.stick {
        reasons.push(VerdictReason::HighFrequency(limit));
        return (Stability::No, reasons);
    }
    let on_axis = |one: &WaveEigenvalue| one.re.abs() <= spectrum.axis && !beyond(one);
    if lists.iter().copied().flatten().any(on_axis) {
        reasons.push(VerdictReason::OnAxis);
    }
    let left_out = left_out(search, spectrum, request);
    if !left_out.is_empty() {
        reasons.push(VerdictReason::Sectors(left_out));
    }
    if !spectrum.complete {
        return (Stability::Undecided, reasons);
    }
    let unsettled = VerdictReason::Unsettled(limit);
    if limit.is_nan() || limit > spectrum.axis {
        reasons.push(unsettled);
        return (Stability::Undecided, reasons);
    }
    match beyond_window(search, spectrum, request, high) {
        HighStrip::Grows(reason) => return (Stability::No, vec![reason]),
        HighStrip::Settled if reasons.is_empty() => return (Stability::Yes, reasons),
        HighStrip::Settled => {}
        HighStrip::Unsettled => reasons.push(unsettled),
    }
    (Stability::Undecided, reasons)
}

/// What strips above the window show.
enum HighStrip {
    /// A perturbation grows there.
    Grows(VerdictReason),
    /// Nothing grows up to where the limit at high frequency holds.
    Settled,
    /// The limit is not reached.
    Unsettled,
}

/// Looks between the window and the frequencies where the limit holds, in strips of twice the height each.
fn beyond_window(
    search: &ZeroSearch,
    spectrum: &Spectrum,
    request: &SpectrumRequest,
    high: &HighFrequency,
) -> HighStrip {
    let mut top = request.max_frequency.max(STRIPS.0 * search.rate);
    let most = if search.characteristic.varies() {
        MOST_TURNS_ALONG
    } else {
        MOST_TURNS
    };
    while top < STRIPS.1 * search.rate && 2.0 * top * search.delay < most {
        top *= 2.0;
        let strip = SearchWindow::symmetric(-0.1 * search.spacing, spectrum.right, top);
        let Some((found, complete)) = search.zeros(&strip, &request.sectors, &[]) else {
            continue;
        };
        let lists: Vec<&[WaveEigenvalue]> = found.iter().map(Vec::as_slice).collect();
        if let Some(reason) = fastest(&lists, spectrum.axis, request) {
            return HighStrip::Grows(reason);
        }
        if complete && settled(search.characteristic, high, top) {
            return HighStrip::Settled;
        }
    }
    HighStrip::Unsettled
}

/// Sectors of which neither they nor their conjugates are asked for.
fn left_out(search: &ZeroSearch, spectrum: &Spectrum, request: &SpectrumRequest) -> Vec<usize> {
    let asked = |sector: usize| request.sectors.contains(&sector);
    (0..=spectrum.mode as usize / 2)
        .filter(|&sector| !asked(sector) && !asked(search.conjugate(sector)))
        .collect()
}

/// The fastest growth in lists, sector by sector, beyond the frequencies that count.
fn fastest(
    lists: &[&[WaveEigenvalue]],
    axis: f64,
    request: &SpectrumRequest,
) -> Option<VerdictReason> {
    let lists = lists.iter().zip(&request.sectors);
    lists
        .flat_map(|(list, sector)| list.iter().map(|one| (*sector, one)))
        .filter(|(_, one)| one.re > axis && one.im.abs() > request.max_frequency)
        .max_by(|one, other| one.1.re.total_cmp(&other.1.re))
        .map(|(sector, one)| VerdictReason::BeyondWindow {
            re: one.re,
            im: one.im,
            sector,
        })
}

/// Most radians that the longest delay may turn in the strip of a verdict, and where friction varies along
/// the wave, which takes a hundred times as long.
const MOST_TURNS: f64 = 1e5;
const MOST_TURNS_ALONG: f64 = 600.0;

/// Whether the limit is reached at a frequency: its error, which falls like 1/ω, cannot bring
/// |t| + |d| to 1 beyond it.
fn settled(characteristic: &Characteristic, high: &HighFrequency, top: f64) -> bool {
    /// The error is estimated over the upper third of the window; twice that is allowed for.
    const SAFETY: f64 = 2.0;
    const SAMPLES: usize = 200;
    if characteristic.beta > 0.0 {
        return quiet(characteristic, high, top);
    }
    // what friction damps faster than the wave turns is not yet in the limit
    if top < characteristic.steepest() {
        return false;
    }
    let error = (0..=SAMPLES)
        .map(|index| {
            let lambda = C64::new(0.0, top * (2.0 + index as f64 / SAMPLES as f64) / 3.0);
            let exact = characteristic.evaluate(lambda).trace.number();
            (exact - high.trace_at(lambda)).norm() * lambda.im / top
        })
        .fold(0.0, f64::max);
    high.size(0.0) + SAFETY * error < 1.0
}

/// With material damping: whether |N| stays below 1 on the imaginary axis beyond a frequency. It falls
/// there, once the damping of a period, which grows like βω², has won; samples follow its oscillation
/// from the top of the window to twice that, and its fall from there to where the limit is reached.
fn quiet(characteristic: &Characteristic, high: &HighFrequency, top: f64) -> bool {
    /// Samples to a radian of the longest delay.
    const DENSITY: f64 = 4.0;
    /// Ratio of sampled frequencies in the fall.
    const RATIO: f64 = 1.01;
    /// In units of 1/β: there the exponents are within a per cent of their limits.
    const REACHED: f64 = 1e4;
    let below = |omega: f64| {
        let size = characteristic.evaluate(C64::new(0.0, omega)).size();
        size < EDGE * EDGE
    };
    let count = (top * high.longest_delay() * DENSITY).ceil().max(200.0) as usize;
    if !(0..=count).all(|index| below(top * (1.0 + index as f64 / count as f64))) {
        return false;
    }
    let mut omega = 2.0 * top;
    let end = REACHED / characteristic.beta;
    while omega < end {
        if !below(omega) {
            return false;
        }
        omega *= RATIO;
    }
    high.size(0.0) < EDGE * EDGE
}
