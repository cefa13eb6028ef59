//! The zeros themselves: Newton's method from grids or from the zeros of a neighbouring wave, until as
//! many are found as were counted.

use std::f64::consts::TAU;

use super::count::{BAND, SearchWindow, ZeroSearch, whole};
use super::translation::{DOUBLE, beside_translation};
use super::{C64, WaveEigenvalue};

/// Two zeros closer than this fraction of the grid are one.
pub(super) const SAME_ZERO: f64 = 1.5e-7;

/// Newton's method has arrived with a step below this fraction of the grid which is below
/// `CONTRACTION` of the step before: corrections that fall like squares are then 1e-5, 1e-10, 1e-20.
const NEARLY: f64 = 1e-5;
const CONTRACTION: f64 = 1e-2;

/// Or else with a step below this, in units of 1/T: one more makes it 1e-18.
const ARRIVED: f64 = 1e-9;

/// A start that moves away by more than this many spacings of the grid is not near a zero, or near
/// one that other starts lead to.
const FARTHEST: f64 = 2.0;

/// Zeros within this fraction of the grid of one another count as one multiple zero where a zero
/// is missing.
const MULTIPLE: f64 = 2e-3;

/// Grids tried before a window is declared incomplete.
const GRIDS: usize = 5;

/// Most Newton starts from grids in one sector: a window with more zeros is declared incomplete.
const MOST_STARTS: usize = 2000;

/// Newton starts closer than this fraction of the grid are one.
const SAME_START: f64 = 0.2;

impl ZeroSearch<'_> {
    fn polish(&self, half: usize, seed: C64) -> Option<WaveEigenvalue> {
        let z = self.multipliers[half];
        let longest = self.spacing;
        let mut lambda = seed;
        let mut before = f64::INFINITY;
        for _ in 0..20 {
            let (f, by) = self.characteristic.evaluate(lambda).sector(z);
            let mut step = f / by;
            let size = step.norm();
            if !size.is_finite() {
                return None;
            }
            if size > longest {
                step *= longest / size;
            }
            lambda -= step;
            if (lambda - seed).norm_sqr() > (FARTHEST * longest).powi(2) {
                return None;
            }
            let quadratic = size < NEARLY * longest && size < CONTRACTION * before;
            let arrived = size < ARRIVED * self.rate;
            if quadratic || arrived || size <= 1e-13 * (self.rate + lambda.norm()) {
                let (f, by) = self.characteristic.evaluate(lambda).sector(z);
                let last = f / by;
                let correction = last.norm();
                // the correction after the last one: size, correction, correction³/size²
                let next = correction * (correction / size).powi(2);
                // of F, and of a wave without a closed form what its method misses
                let unit = f64::EPSILON + self.characteristic.defect;
                let rounding = unit * (4.0 + lambda.norm() * self.delay) / by.norm();
                if !quadratic || arrived || correction < CONTRACTION * size {
                    lambda -= last;
                    return Some(WaveEigenvalue {
                        re: lambda.re,
                        im: lambda.im,
                        error: rounding + if quadratic { next } else { correction },
                        multiplicity: 1,
                    });
                }
            }
            before = size;
        }
        None
    }

    /// Adds the zeros of the halves wanted that lie near the seeds, or with a spacing > 0 near the
    /// grid.
    fn find(
        &self,
        window: &SearchWindow,
        spacing: f64,
        seeds: &[Vec<C64>],
        wanted: &[bool],
        found: &mut [Vec<WaveEigenvalue>],
    ) {
        let mut starts: Vec<Vec<C64>> = seeds.to_vec();
        starts.resize(self.halves.len(), Vec::new());
        if spacing > 0.0 {
            let near = SAME_START * spacing.max(0.25 * self.spacing);
            let columns = ((window.right - window.left) / spacing).ceil() as usize;
            let rows = ((window.top - window.bottom) / spacing).ceil() as usize;
            for row in 0..=rows {
                for column in 0..=columns {
                    let lambda = C64::new(
                        window.left + column as f64 * spacing,
                        (window.bottom + row as f64 * spacing).min(window.top),
                    );
                    let at = self.row(lambda);
                    for (half, sample) in at.samples.iter().enumerate() {
                        let step = sample.f / sample.by;
                        let guess = lambda - step;
                        let taken = |known: C64| (known - guess).norm_sqr() < near * near;
                        if wanted[half]
                            && starts[half].len() < MOST_STARTS
                            && step.norm_sqr() < (1.6 * spacing).powi(2)
                            && !starts[half].iter().any(|known| taken(*known))
                            && !found[half].iter().any(|known| taken(known.value()))
                        {
                            starts[half].push(guess);
                        }
                    }
                }
            }
        }
        let same = SAME_ZERO * self.spacing;
        for (half, guesses) in starts.iter().enumerate() {
            if !wanted[half] {
                continue;
            }
            for guess in guesses {
                let Some(zero) = self.polish(half, *guess) else {
                    continue;
                };
                if window.contains(&zero)
                    && !found[half]
                        .iter()
                        .any(|known| (known.value() - zero.value()).norm() < same)
                {
                    found[half].push(zero);
                }
            }
        }
    }

    /// The zeros of F_j in the whole box, from the halves.
    fn unite(&self, found: &[Vec<WaveEigenvalue>], sector: usize) -> Vec<WaveEigenvalue> {
        let same = SAME_ZERO * self.spacing;
        let of = |sector: usize| self.index(sector).map_or(&[][..], |index| &found[index]);
        let mut zeros: Vec<WaveEigenvalue> = of(sector).to_vec();
        for zero in of(self.conjugate(sector)) {
            let mirrored = WaveEigenvalue {
                im: -zero.im,
                ..*zero
            };
            if !zeros
                .iter()
                .any(|known| (known.value() - mirrored.value()).norm() < same)
            {
                zeros.push(mirrored);
            }
        }
        zeros
    }

    /// Turns of F_j round a small circle: the number of zeros in it.
    fn multiplicity(&self, half: usize, centre: C64, radius: f64) -> usize {
        const SAMPLES: usize = 48;
        let z = self.multipliers[half];
        let at = |index: usize| {
            let angle = TAU * index as f64 / SAMPLES as f64;
            let lambda = centre + C64::from_polar(radius, angle);
            self.characteristic.evaluate(lambda).sector(z).0
        };
        let mut last = at(0);
        let mut turn = 0.0;
        for index in 1..=SAMPLES {
            let next = at(index % SAMPLES);
            turn += (next / last).arg();
            last = next;
        }
        (turn / TAU).round().max(0.0) as usize
    }

    /// All zeros of a symmetric box, sector by sector; false where fewer were found than counted.
    /// `None` if a zero is too near its edge.
    pub(super) fn zeros(
        &self,
        window: &SearchWindow,
        sectors: &[usize],
        seeds: &[Vec<C64>],
    ) -> Option<(Vec<Vec<WaveEigenvalue>>, bool)> {
        let height = BAND * TAU / self.delay;
        if window.top <= 1.5 * height {
            return self.lowest(window, sectors, seeds);
        }
        let within = |band: &SearchWindow| -> Vec<Vec<C64>> {
            seeds
                .iter()
                .map(|starts| {
                    let near = |start: &&C64| {
                        start.im > band.bottom - self.spacing && start.im < band.top + self.spacing
                    };
                    starts.iter().filter(near).copied().collect()
                })
                .collect()
        };
        let mut band = SearchWindow {
            top: height,
            ..*window
        };
        let (mut united, mut complete) =
            self.moved(&mut band, |band| self.lowest(band, sectors, &within(band)))?;
        while band.top < window.top {
            let bottom = band.top;
            let rest = window.top - bottom;
            band = SearchWindow {
                bottom,
                top: if rest > 1.5 * height {
                    bottom + height
                } else {
                    window.top
                },
                ..*window
            };
            let last = band.top == window.top;
            let (found, whole) = self.moved(&mut band, |band| self.upper(band, &within(band)))?;
            complete &= whole;
            for (zeros, &sector) in united.iter_mut().zip(sectors) {
                zeros.extend(&found[self.index(sector)?]);
                let mirrored = &found[self.index(self.conjugate(sector))?];
                zeros.extend(mirrored.iter().map(|zero| WaveEigenvalue {
                    im: -zero.im,
                    ..*zero
                }));
            }
            if last {
                break;
            }
        }
        Some((united, complete))
    }

    /// All zeros of a band of the upper half, half by half.
    fn upper(
        &self,
        band: &SearchWindow,
        seeds: &[Vec<C64>],
    ) -> Option<(Vec<Vec<WaveEigenvalue>>, bool)> {
        let turns = self.walk(band)?;
        let counts: Option<Vec<usize>> = turns.iter().map(|turn| whole(*turn)).collect();
        let halves: Vec<usize> = (0..self.halves.len()).collect();
        Some(
            self.complete(band, &counts?, &halves, seeds, |found, half| {
                found[half].clone()
            }),
        )
    }

    /// All zeros of a symmetric box of moderate height, sector by sector.
    fn lowest(
        &self,
        window: &SearchWindow,
        sectors: &[usize],
        seeds: &[Vec<C64>],
    ) -> Option<(Vec<Vec<WaveEigenvalue>>, bool)> {
        let turns = self.walk(window)?;
        let counts: Option<Vec<usize>> = sectors
            .iter()
            .map(|sector| self.count(&turns, *sector))
            .collect();
        let halves: Option<Vec<usize>> = sectors.iter().map(|one| self.index(*one)).collect();
        Some(
            self.complete(window, &counts?, &halves?, seeds, |found, half| {
                self.unite(found, self.halves[half])
            }),
        )
    }

    /// Puts the two zeros of sector 0 at a fold into its list: Newton's method does not come near them.
    fn at_origin(&self, zeros: &mut Vec<WaveEigenvalue>) {
        let near = DOUBLE * self.rate;
        let Some(beside) = beside_translation(self.characteristic, 0.0, DOUBLE) else {
            return;
        };
        zeros.retain(|zero| zero.value().norm() > near);
        zeros.extend([0.0, beside].map(|re| WaveEigenvalue {
            re,
            im: 0.0,
            error: f64::EPSILON * self.rate,
            multiplicity: 1,
        }));
    }

    /// Finds zeros on finer and finer grids until each set has as many as were counted; false
    /// where it never has. `set` makes the set of one half from the zeros of all.
    fn complete(
        &self,
        window: &SearchWindow,
        counts: &[usize],
        halves: &[usize],
        seeds: &[Vec<C64>],
        set: impl Fn(&[Vec<WaveEigenvalue>], usize) -> Vec<WaveEigenvalue>,
    ) -> (Vec<Vec<WaveEigenvalue>>, bool) {
        let mut spacing = if seeds.is_empty() { self.spacing } else { 0.0 };
        let mut seeds = seeds;
        let mut found = vec![Vec::new(); self.halves.len()];
        let mut wanted = vec![true; self.halves.len()];
        let mut best: Vec<Vec<WaveEigenvalue>> = Vec::new();
        let whole = |zeros: &[WaveEigenvalue], count: usize| {
            zeros.iter().map(|zero| zero.multiplicity).sum::<usize>() == count
        };
        for _ in 0..GRIDS {
            self.find(window, spacing, seeds, &wanted, &mut found);
            seeds = &[];
            best = halves.iter().map(|half| set(&found, *half)).collect();
            let missing = |sets: &[Vec<WaveEigenvalue>]| {
                sets.iter()
                    .zip(counts)
                    .any(|(zeros, count)| !whole(zeros, *count))
            };
            if !missing(&best) {
                return (best, true);
            }
            if window.bottom == 0.0 {
                for (index, half) in halves.iter().enumerate() {
                    if self.halves[*half] == 0 && !whole(&best[index], counts[index]) {
                        self.at_origin(&mut best[index]);
                    }
                }
            }
            if !missing(&best) {
                return (best, true);
            }
            // a multiple zero is found once
            for (index, half) in halves.iter().enumerate() {
                if best[index].len() < counts[index] {
                    for zero in &mut best[index] {
                        let radius = MULTIPLE * self.spacing;
                        zero.multiplicity = self.multiplicity(*half, zero.value(), radius).max(1);
                    }
                }
            }
            if !missing(&best) {
                return (best, true);
            }
            // of what is complete nothing more is looked for
            for (half, wanted) in wanted.iter_mut().enumerate() {
                let conjugate = self.index(self.conjugate(self.halves[half]));
                *wanted = halves.iter().enumerate().any(|(index, of)| {
                    (*of == half || Some(*of) == conjugate) && !whole(&best[index], counts[index])
                });
            }
            spacing = if spacing == 0.0 {
                self.spacing
            } else {
                0.5 * spacing
            };
        }
        (best, false)
    }
}
