//! The spectrum of a wave: from the window to the list and the verdict.

use super::count::{Edge, SearchWindow, ZeroSearch, right_edge};
use super::find::SAME_ZERO;
use super::translation::remove_translation;
use super::verdict::verdict;
use super::{C64, ON_AXIS, Sector, Spectrum, SpectrumRequest, WaveEigenvalue, margin, symmetric};
use crate::orbit::Stability;
use crate::tube::stability::asymptotic::HighFrequency;
use crate::tube::stability::characteristic::Characteristic;
use crate::tube::stability::verdict::VerdictReason;

/// Most zeros expected in a window, over all sectors. Where c² → a one delay grows without bound
/// and zeros lie that dense; beyond this number the window is cut and the answer left open.
const MOST_ZEROS: f64 = 20_000.0;

/// The same where friction varies along the wave, so that each value takes a hundred times as long.
const MOST_ZEROS_ALONG: f64 = 400.0;

/// How often the window is deepened to find as many eigenvalues as were asked for, and how deep in
/// units of 1/T: what decays by e⁶ within a period is of no interest, and from point to point of a
/// branch the window would grow without end where a sector has fewer eigenvalues.
const DEEPENINGS: usize = 8;
const DEEPEST: f64 = 6.0;

/// The spectrum of a linearised wave. `seeds` is that of a neighbouring wave, if known.
pub fn spectrum(
    characteristic: &Characteristic,
    request: &SpectrumRequest,
    seeds: Option<&Spectrum>,
) -> Spectrum {
    characteristic.expand();
    let high = HighFrequency::new(characteristic);
    let mut search = zero_search(characteristic, &high, request);
    let wanted = request.max_frequency + margin(request, characteristic);
    let expected = wanted * search.delay / std::f64::consts::PI * request.sectors.len() as f64;
    let along = characteristic.varies();
    let most = if along { MOST_ZEROS_ALONG } else { MOST_ZEROS };
    let cut = (most / expected).min(1.0);
    let (right, clear) = right_edge(&search, &high, cut * wanted);
    if clear && characteristic.beta == 0.0 {
        search.edge = Some(Edge {
            right,
            top: cut * wanted,
        });
    }
    let mut window = SearchWindow::symmetric(
        seeds.map_or(-search.spacing, |seeds| seeds.left),
        right,
        cut * wanted,
    );
    let guesses = seeds.map_or_else(Vec::new, |seeds| starts(&search, seeds));
    let result = listed(&search, request, &mut window, &guesses, cut < 1.0);
    let mut spectrum = Spectrum {
        sectors: Vec::new(),
        left: window.left,
        right,
        top: window.top,
        axis: ON_AXIS * search.rate,
        complete: false,
        translation_defect: None,
        limit: high.limit(),
        stable: Stability::Undecided,
        reasons: vec![VerdictReason::NoWindow],
        counted: None,
        mode: characteristic.mode,
        max_frequency: request.max_frequency,
    };
    let Some((found, complete, window)) = result else {
        return spectrum;
    };
    (spectrum.left, spectrum.top) = (window.left, window.top);
    spectrum.complete = complete && cut == 1.0;
    for (&sector, mut eigenvalues) in request.sectors.iter().zip(found) {
        if sector == 0 {
            spectrum.translation_defect = remove_translation(characteristic, &mut eigenvalues);
        }
        eigenvalues.sort_by(|one, other| {
            other
                .re
                .total_cmp(&one.re)
                .then(other.im.total_cmp(&one.im))
        });
        spectrum.sectors.push(Sector {
            sector,
            eigenvalues,
        });
    }
    if !(spectrum.complete || along && cut < 1.0) {
        spectrum.counted = search.growing(&spectrum);
    }
    (spectrum.stable, spectrum.reasons) = verdict(&search, &spectrum, request, &high);
    spectrum
}

/// The search for zeros in the sectors that are asked for and their conjugates.
fn zero_search<'a>(
    characteristic: &'a Characteristic,
    high: &HighFrequency,
    request: &SpectrumRequest,
) -> ZeroSearch<'a> {
    let halves = halves(characteristic.mode as usize, request);
    // about two grid points from zero to zero, also where c² → a makes one delay long
    let delay = high.longest_delay().max(characteristic.period);
    ZeroSearch {
        characteristic,
        delay,
        spacing: (0.6 / characteristic.period).min(3.0 / delay),
        rate: characteristic.period.recip(),
        multipliers: halves
            .iter()
            .map(|sector| characteristic.multiplier(*sector))
            .collect(),
        halves,
        edge: None,
    }
}

/// The sectors that are asked for and, of those that have one, their conjugates.
fn halves(mode: usize, request: &SpectrumRequest) -> Vec<usize> {
    let mut halves: Vec<usize> = request.sectors.clone();
    for sector in &request.sectors {
        let conjugate = (mode - sector % mode) % mode;
        if !halves.contains(&conjugate) {
            halves.push(conjugate);
        }
    }
    halves
}

/// The zeros of every sector that is asked for, and whether these are all in the window: that moves from zeros on its edge, and
/// goes deeper until it has as many as are asked for, unless it `is_cut`.
fn listed(
    search: &ZeroSearch,
    request: &SpectrumRequest,
    window: &mut SearchWindow,
    guesses: &[Vec<C64>],
    is_cut: bool,
) -> Option<(Vec<Vec<WaveEigenvalue>>, bool, SearchWindow)> {
    let mut result = None;
    let mut lefts = 0;
    for attempt in 0..24 {
        let guesses: &[Vec<C64>] = if attempt == 0 { guesses } else { &[] };
        let Some((mut found, complete)) = search.zeros(window, &request.sectors, guesses) else {
            // a zero sits on the edge
            window.left *= 1.037;
            window.top *= 1.0 + 1.3e-4;
            continue;
        };
        // in a sector that is its own conjugate a zero that is one with its mirror image is real
        let axis = SAME_ZERO * search.spacing;
        for (zeros, sector) in found.iter_mut().zip(&request.sectors) {
            let symmetric = symmetric(*sector, search.characteristic.mode);
            for zero in zeros.iter_mut().filter(|_| symmetric) {
                if zero.im.abs() < axis {
                    zero.im = 0.0;
                }
            }
        }
        let few = found.iter().zip(&request.sectors).any(|(zeros, sector)| {
            let symmetric = symmetric(*sector, search.characteristic.mode);
            let listed = zeros
                .iter()
                .filter(|zero| !symmetric || zero.im >= 0.0)
                .count();
            // one more is wanted, for the translation mode
            listed <= request.eigenvalues
        });
        result = Some((found, complete, *window));
        let deep = window.left * search.characteristic.period < -DEEPEST;
        if !few || lefts == DEEPENINGS || is_cut || deep {
            break;
        }
        lefts += 1;
        window.left *= 1.5;
    }
    result
}

/// Zeros of a neighbouring wave as starts, half by half, the translation mode with them.
fn starts(search: &ZeroSearch, seeds: &Spectrum) -> Vec<Vec<C64>> {
    // zeros near the real axis may come out just below it
    let upper = |value: &C64| value.im > -1e-3 * search.rate;
    search
        .halves
        .iter()
        .map(|half| {
            let mut starts = Vec::new();
            for sector in &seeds.sectors {
                let values = sector.eigenvalues.iter().map(WaveEigenvalue::value);
                if sector.sector == *half {
                    starts.extend(values.filter(upper));
                } else if search.conjugate(sector.sector) == *half {
                    starts.extend(values.map(|value| value.conj()).filter(upper));
                }
            }
            if *half == 0 {
                starts.push(C64::new(0.0, 0.0));
            }
            starts
        })
        .collect()
}
