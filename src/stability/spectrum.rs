//! Every eigenvalue of a window, counted and found.
//!
//! The number of zeros of F_j in a box is the number of turns of F_j along its edge. One walk along
//! the upper half of the edge serves all sectors, since t and d do not depend on the sector and
//! F_j(λ̄) is the conjugate of F_{k−j}(λ). The walk is refined until, for every sector, the cubic
//! through the values and derivatives of F at two samples keeps away from zero by more than F may
//! differ from it. t and d are entire functions of exponential type τ, the longest delay, which
//! bounds their fourth derivative by τ⁴ of their size and the difference by (hτ)⁴/384 (Bernstein).
//! On the right edge |t| + |d| < 1, and F turns by what its ends say. Zeros are then found by
//! Newton's method from a grid or from the zeros of a neighbouring wave, until as many are found as
//! were counted.
//!
//! (γ, δ, α, β) → (s²γ, sδ, α/s, sβ) divides every λ by s and changes nothing else: every threshold
//! here is relative, most of them to 1/T.

use std::f64::consts::TAU;

use nalgebra::Complex;
use serde::{Deserialize, Serialize};

use super::asymptotic::HighFrequency;
use super::characteristic::{Characteristic, Value};
use crate::branch::{Reason, Stability};

type C64 = Complex<f64>;

/// What to compute.
#[derive(Clone, Debug, PartialEq)]
pub struct Request {
    /// Bloch sectors 0 ≤ j ≤ k/2.
    pub sectors: Vec<usize>,
    /// Eigenvalues wanted in each sector.
    pub eigenvalues: usize,
    /// Largest |Im λ| that counts.
    pub max_frequency: f64,
}

/// Eigenvalues are followed beyond the largest frequency that counts, by this part of it but no more than
/// about a grid spacing, in units of 1/T: those that enter the window through its upper edge between two
/// points are then known at both.
const MARGIN: (f64, f64) = (1.0 / 24.0, 0.65);

/// How far beyond the largest frequency that counts eigenvalues are followed.
pub(super) fn margin(request: &Request, characteristic: &Characteristic) -> f64 {
    (MARGIN.0 * request.max_frequency).min(MARGIN.1 / characteristic.period)
}

/// An eigenvalue.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Eigenvalue {
    /// Re λ.
    pub re: f64,
    /// Im λ.
    pub im: f64,
    /// Estimate of its error: last Newton correction and rounding of F over |F′|.
    pub error: f64,
    /// Multiplicity of the zero.
    pub multiplicity: usize,
}

impl Eigenvalue {
    /// λ.
    pub fn value(&self) -> C64 {
        C64::new(self.re, self.im)
    }
}

/// The eigenvalues of one sector in the window, the translation mode left out, by falling Re λ.
/// In sectors 0 and k/2 conjugate pairs appear with both members.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Sector {
    /// Bloch sector.
    pub sector: usize,
    /// All zeros found.
    pub eigenvalues: Vec<Eigenvalue>,
}

/// The spectrum of a wave in a window.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Spectrum {
    /// One entry per sector asked for, in order.
    pub sectors: Vec<Sector>,
    /// Left edge of the window.
    pub left: f64,
    /// Right edge of the window: no zero lies beyond it.
    pub right: f64,
    /// Upper edge of the window.
    #[serde(default = "unknown")]
    pub top: f64,
    /// Eigenvalues with |Re λ| up to this are on the imaginary axis, see [`ON_AXIS`].
    #[serde(default)]
    pub axis: f64,
    /// Whether as many zeros were found as counted in every sector.
    pub complete: bool,
    /// |λ₀| of the translation mode, where sector 0 was asked for.
    pub translation_defect: Option<f64>,
    /// Limit of Re λ at high frequency.
    pub limit: f64,
    /// Verdict.
    pub stable: Stability,
    /// What the verdict and the count rest on, where that is not plain.
    #[serde(default)]
    pub reasons: Vec<Reason>,
    /// Unstable eigenvalues of each sector by the argument principle, where the list is incomplete
    /// and they could be counted.
    #[serde(default)]
    pub counted: Option<Vec<usize>>,
    /// Mode k.
    pub mode: u32,
    /// Largest |Im λ| that counts.
    pub max_frequency: f64,
}

/// Upper edge of a window saved without it.
fn unknown() -> f64 {
    f64::INFINITY
}

/// In units of 1/T: an eigenvalue with a smaller |Re λ| cannot be told from one on the imaginary axis,
/// and counts neither as growing nor as decaying. It is the default tolerance of a wave, whose rounding
/// leaves 1e-15 to 1e-12.
pub const ON_AXIS: f64 = 1e-10;

/// An edge walk closer to a zero than this fraction of the window is given up and moved.
const SHORTEST_STEP: f64 = 1e-7;

/// Most samples of one walk.
const MOST_SAMPLES: usize = 200_000;

/// Two zeros closer than this fraction of the grid are one.
const SAME_ZERO: f64 = 1.5e-7;

/// Whether a sector of a wave of mode k is its own conjugate: 0 and k/2.
pub fn symmetric(sector: usize, mode: u32) -> bool {
    sector == 0 || 2 * sector == mode as usize
}

impl Spectrum {
    /// Unstable eigenvalues of one sector with |Im λ| up to the largest frequency that counts: counted,
    /// or else listed.
    pub fn unstable_in(&self, sector: &Sector) -> usize {
        let place = self
            .sectors
            .iter()
            .position(|one| one.sector == sector.sector);
        match (&self.counted, place) {
            (Some(counted), Some(place)) => counted[place],
            _ => self.listed_unstable(sector),
        }
    }

    fn listed_unstable(&self, sector: &Sector) -> usize {
        sector
            .eigenvalues
            .iter()
            .filter(|eigenvalue| eigenvalue.re > self.axis)
            .filter(|eigenvalue| eigenvalue.im.abs() <= self.max_frequency)
            .map(|eigenvalue| eigenvalue.multiplicity)
            .sum()
    }

    /// A number of every sector, added up over the full circle: a sector j and its conjugate k − j
    /// count both.
    fn on_circle(&self, number: impl Fn(&Sector) -> usize) -> usize {
        self.sectors
            .iter()
            .map(|sector| {
                let twice = if self.symmetric(sector.sector) { 1 } else { 2 };
                twice * number(sector)
            })
            .sum()
    }

    /// Number of unstable eigenvalues on the full circle.
    pub fn unstable(&self) -> usize {
        self.on_circle(|sector| self.unstable_in(sector))
    }

    /// See [`symmetric`].
    pub fn symmetric(&self, sector: usize) -> bool {
        symmetric(sector, self.mode)
    }

    /// The eigenvalues of a sector as tables list them: up to the largest frequency that counts,
    /// and of conjugate pairs in a symmetric sector only the member with Im λ ≥ 0.
    pub fn listed<'a>(&'a self, sector: &'a Sector) -> impl Iterator<Item = &'a Eigenvalue> {
        let symmetric = self.symmetric(sector.sector);
        sector
            .eigenvalues
            .iter()
            .filter(move |eigenvalue| !symmetric || eigenvalue.im >= 0.0)
            .filter(|eigenvalue| eigenvalue.im.abs() <= self.max_frequency)
    }

    /// The eigenvalue of largest real part, with its sector.
    pub fn lead(&self) -> Option<(Eigenvalue, usize)> {
        self.sectors
            .iter()
            .flat_map(|sector| {
                self.listed(sector)
                    .map(|eigenvalue| (*eigenvalue, sector.sector))
            })
            .max_by(|one, other| one.0.re.total_cmp(&other.0.re))
    }
}

/// A box symmetric about the real axis, |Im λ| < top, or with bottom > 0 a band of its upper half.
#[derive(Clone, Copy, Debug)]
struct Window {
    left: f64,
    right: f64,
    bottom: f64,
    top: f64,
}

impl Window {
    fn symmetric(left: f64, right: f64, top: f64) -> Window {
        Window {
            left,
            right,
            bottom: 0.0,
            top,
        }
    }

    /// Whether an upper half zero lies inside; zeros on the real axis may come out just below it.
    fn contains(&self, zero: &Eigenvalue) -> bool {
        let low = if self.bottom > 0.0 {
            self.bottom
        } else {
            -self.top
        };
        zero.re > self.left && zero.re < self.right && zero.im > low && zero.im < self.top
    }
}

/// Bands are this many spacings of the longest delay's zeros high: a window with thousands of
/// zeros is counted and searched band by band, so that effort grows with their number.
const BAND: f64 = 16.0;

/// Most zeros expected in a window, over all sectors. Where c² → a one delay grows without bound
/// and zeros lie that dense; beyond this number the window is cut and the answer left open.
const MOST_ZEROS: f64 = 20_000.0;

/// F_j at a sample, with the exponent that was taken out of it.
#[derive(Clone, Copy)]
struct Sample {
    f: C64,
    by: C64,
}

/// Samples of all multipliers at one λ.
struct Row {
    lambda: C64,
    top: f64,
    /// |t| + |d|, or (|t′| + |d′|)/τ if that is more, on the scale of the samples.
    size: f64,
    samples: Vec<Sample>,
}

/// The search for the zeros of one wave.
struct Search<'a> {
    characteristic: &'a Characteristic,
    /// Longest delay: zeros follow one another in Im λ at 2π over it, or farther apart.
    delay: f64,
    /// Spacing of the first grid: about two points from zero to zero.
    spacing: f64,
    /// 1/T.
    rate: f64,
    /// Sectors whose upper halves are needed: those asked for and their conjugates.
    halves: Vec<usize>,
    multipliers: Vec<C64>,
    /// The line on which |t| + |d| < 1 is known, if any.
    edge: Option<Edge>,
}

/// The line Re λ = right, |Im λ| ≤ top.
#[derive(Clone, Copy)]
struct Edge {
    right: f64,
    top: f64,
}

/// Between samples F may differ from the cubic by this fraction of what the trapezoidal rule
/// misses, h³F‴/12: the estimate from F itself, for h⁴F⁗/384 ≤ (hτ/32)·h³F‴/12.
const MISSED: f64 = 0.25;

/// The a-priori bound (hτ)⁴/384 of the size of t and d is taken with their size at the samples, times
/// this: paths that interfere there need not do so between.
const INTERFERENCE: f64 = 2.0;

impl Search<'_> {
    fn row(&self, lambda: C64) -> Row {
        let value = self.characteristic.evaluate(lambda);
        Row {
            lambda,
            top: value.top() + value.offset,
            size: value.scaled_size(self.delay),
            samples: self.samples(&value),
        }
    }

    fn samples(&self, value: &Value) -> Vec<Sample> {
        self.multipliers
            .iter()
            .map(|z| {
                let (f, by) = value.sector(*z);
                Sample { f, by }
            })
            .collect()
    }

    /// Whether a step of the walk is safe in every sector.
    fn safe(&self, one: &Row, other: &Row) -> bool {
        let h = other.lambda - one.lambda;
        // on the scale of `one`
        let factor = (other.top - one.top).exp();
        if self.characteristic.beta > 0.0 {
            // not of exponential type: F moves by less than its own size and as predicted
            return one.samples.iter().zip(&other.samples).all(|(a, b)| {
                let (fa, fb) = (a.f, b.f * factor);
                let least = fa.norm().min(fb.norm());
                let moved = (fb - fa).norm();
                let predicted = (a.by + b.by * factor) * h * 0.5;
                moved <= 0.8 * least && (fa + predicted - fb).norm() <= 0.2 * least
            });
        }
        let square = h.norm_sqr() * self.delay * self.delay;
        let size = one.size.max(other.size * factor);
        let bound = square * square / 384.0 * INTERFERENCE * size;
        one.samples.iter().zip(&other.samples).all(|(a, b)| {
            let (fa, fb) = (a.f, b.f * factor);
            let (da, db) = (a.by * h, b.by * h * factor);
            let missed = (fa + (da + db) * 0.5 - fb).norm_sqr().sqrt();
            // control points of the cubic on the bisector of its ends: it lies in their hull
            let middle = fa * fb.norm_sqr().sqrt() + fb * fa.norm_sqr().sqrt();
            let along = |x: C64| x.re * middle.re + x.im * middle.im;
            let least = along(fa)
                .min(along(fb))
                .min(along(fa + da / 3.0))
                .min(along(fb - db / 3.0));
            least > (MISSED * missed + bound) * middle.norm_sqr().sqrt()
        })
    }

    /// Turns of every F along the upper half of the edge of a symmetric box, or round a band, in
    /// radians; `None` if a zero is too near.
    fn walk(&self, window: &Window) -> Option<Vec<f64>> {
        let mut corners = vec![
            C64::new(window.right, window.bottom),
            C64::new(window.right, window.top),
            C64::new(window.left, window.top),
            C64::new(window.left, window.bottom),
        ];
        if window.bottom > 0.0 {
            corners.push(corners[0]);
        }
        let mut turns = vec![0.0; self.halves.len()];
        let shortest = SHORTEST_STEP * (window.top - window.bottom + window.right - window.left);
        let first = self.spacing;
        let mut last = self.row(corners[0]);
        let mut used = 0;
        if let Some(edge) = self.edge
            && edge.right == window.right
            && window.bottom < edge.top
        {
            // |F − 1| < 1 so far
            let next = self.row(C64::new(edge.right, edge.top.min(window.top)));
            for (turn, (a, b)) in turns.iter_mut().zip(last.samples.iter().zip(&next.samples)) {
                *turn += (b.f / a.f).arg();
            }
            corners[0] = next.lambda;
            last = next;
        }
        for pair in corners.windows(2) {
            if pair[0] == pair[1] {
                continue;
            }
            let length = (pair[1] - pair[0]).norm();
            let pieces = (length / first).ceil().max(1.0) as usize;
            let mut waiting: Vec<Row> = Vec::new();
            for piece in 1..=pieces {
                let share = piece as f64 / pieces as f64;
                waiting.push(self.row(pair[0] + (pair[1] - pair[0]) * share));
                while let Some(next) = waiting.pop() {
                    used += 1;
                    if used > MOST_SAMPLES {
                        return None;
                    }
                    if self.safe(&last, &next) {
                        for (turn, (a, b)) in
                            turns.iter_mut().zip(last.samples.iter().zip(&next.samples))
                        {
                            *turn += (b.f / a.f).arg();
                        }
                        last = next;
                    } else {
                        let step = next.lambda - last.lambda;
                        if step.norm().is_nan() || step.norm() < shortest {
                            return None;
                        }
                        let middle = self.row(last.lambda + step * 0.5);
                        waiting.push(next);
                        waiting.push(middle);
                    }
                }
            }
        }
        Some(turns)
    }

    fn conjugate(&self, sector: usize) -> usize {
        let mode = self.characteristic.mode as usize;
        (mode - sector % mode) % mode
    }

    fn index(&self, sector: usize) -> Option<usize> {
        self.halves.iter().position(|half| *half == sector)
    }

    /// Number of zeros of F_j in the whole box; `None` if the turns are not whole.
    fn count(&self, turns: &[f64], sector: usize) -> Option<usize> {
        whole(turns[self.index(sector)?] + turns[self.index(self.conjugate(sector))?])
    }

    /// Newton's method on F_j.
    fn polish(&self, half: usize, seed: C64) -> Option<Eigenvalue> {
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
                let rounding = f64::EPSILON * (4.0 + lambda.norm() * self.delay) / by.norm();
                if !quadratic || arrived || correction < CONTRACTION * size {
                    lambda -= last;
                    return Some(Eigenvalue {
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
        window: &Window,
        spacing: f64,
        seeds: &[Vec<C64>],
        wanted: &[bool],
        found: &mut [Vec<Eigenvalue>],
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
    fn unite(&self, found: &[Vec<Eigenvalue>], sector: usize) -> Vec<Eigenvalue> {
        let same = SAME_ZERO * self.spacing;
        let of = |sector: usize| self.index(sector).map_or(&[][..], |index| &found[index]);
        let mut zeros: Vec<Eigenvalue> = of(sector).to_vec();
        for zero in of(self.conjugate(sector)) {
            let mirrored = Eigenvalue {
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
    fn zeros(
        &self,
        window: &Window,
        sectors: &[usize],
        seeds: &[Vec<C64>],
    ) -> Option<(Vec<Vec<Eigenvalue>>, bool)> {
        let height = BAND * TAU / self.delay;
        if window.top <= 1.5 * height {
            return self.lowest(window, sectors, seeds);
        }
        let within = |band: &Window| -> Vec<Vec<C64>> {
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
        let mut band = Window {
            top: height,
            ..*window
        };
        let (mut united, mut complete) =
            self.moved(&mut band, |band| self.lowest(band, sectors, &within(band)))?;
        while band.top < window.top {
            let bottom = band.top;
            let rest = window.top - bottom;
            band = Window {
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
                zeros.extend(mirrored.iter().map(|zero| Eigenvalue {
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

    /// A search of a band; where a zero sits on its upper edge, the edge is moved.
    fn moved<T>(&self, band: &mut Window, search: impl Fn(&Window) -> Option<T>) -> Option<T> {
        const MOVES: usize = 6;
        for _ in 0..MOVES {
            if let Some(found) = search(band) {
                return Some(found);
            }
            band.top += 0.137 * self.spacing;
        }
        None
    }

    /// All zeros of a band of the upper half, half by half.
    fn upper(&self, band: &Window, seeds: &[Vec<C64>]) -> Option<(Vec<Vec<Eigenvalue>>, bool)> {
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
        window: &Window,
        sectors: &[usize],
        seeds: &[Vec<C64>],
    ) -> Option<(Vec<Vec<Eigenvalue>>, bool)> {
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

    /// Zeros right of the imaginary axis up to the largest frequency that counts, sector by sector,
    /// counted without being found; `None` where they are too many, or one is too near an edge. At
    /// low frequency the axis itself holds the translation mode: beside it the list serves.
    fn growing(&self, spectrum: &Spectrum) -> Option<Vec<usize>> {
        /// Most bands: a walk round each takes about a millisecond.
        const MOST_BANDS: f64 = 1000.0;
        let (right, top) = (spectrum.right, spectrum.max_frequency);
        let height = BAND * TAU / self.delay;
        if top > MOST_BANDS * height {
            return None;
        }
        let beside = 0.01 * self.spacing;
        let mut band = Window::symmetric(beside, right, top.min(height));
        let turns = self.moved(&mut band, |band| self.walk(band))?;
        let mut counts = Vec::with_capacity(spectrum.sectors.len());
        for sector in &spectrum.sectors {
            let listed = |one: &&Eigenvalue| {
                one.re > spectrum.axis && one.re <= beside && one.im.abs() < band.top
            };
            let near = sector.eigenvalues.iter().filter(listed);
            let near: usize = near.map(|one| one.multiplicity).sum();
            counts.push(near + self.count(&turns, sector.sector)?);
        }
        while band.top < top {
            band = Window {
                left: 0.0,
                right,
                bottom: band.top,
                top: top.min(band.top + height),
            };
            let turns = if band.top < top {
                self.moved(&mut band, |band| self.walk(band))?
            } else {
                self.walk(&band)?
            };
            for (count, sector) in counts.iter_mut().zip(&spectrum.sectors) {
                for half in [sector.sector, self.conjugate(sector.sector)] {
                    *count += whole(turns[self.index(half)?])?;
                }
            }
        }
        Some(counts)
    }

    /// Puts the two zeros of sector 0 at a fold into its list: Newton's method does not come near them.
    fn at_origin(&self, zeros: &mut Vec<Eigenvalue>) {
        let near = DOUBLE * self.rate;
        let Some(beside) = beside_translation(self.characteristic, 0.0, DOUBLE) else {
            return;
        };
        zeros.retain(|zero| zero.value().norm() > near);
        zeros.extend([0.0, beside].map(|re| Eigenvalue {
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
        window: &Window,
        counts: &[usize],
        halves: &[usize],
        seeds: &[Vec<C64>],
        set: impl Fn(&[Vec<Eigenvalue>], usize) -> Vec<Eigenvalue>,
    ) -> (Vec<Vec<Eigenvalue>>, bool) {
        let mut spacing = if seeds.is_empty() { self.spacing } else { 0.0 };
        let mut seeds = seeds;
        let mut found = vec![Vec::new(); self.halves.len()];
        let mut wanted = vec![true; self.halves.len()];
        let mut best: Vec<Vec<Eigenvalue>> = Vec::new();
        let whole = |zeros: &[Eigenvalue], count: usize| {
            zeros.iter().map(|zero| zero.multiplicity).sum::<usize>() == count
        };
        for _ in 0..GRIDS {
            self.find(window, spacing, seeds, &wanted, &mut found);
            seeds = &[];
            best = halves.iter().map(|half| set(&found, *half)).collect();
            let missing = |sets: &[Vec<Eigenvalue>]| {
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

/// Newton's method has arrived with a step below this fraction of the grid which is below
/// `CONTRACTION` of the step before: corrections that fall like squares are then 1e-5, 1e-10, 1e-20.
const NEARLY: f64 = 1e-5;
const CONTRACTION: f64 = 1e-2;

/// Or else with a step below this, in units of 1/T: one more makes it 1e-18.
const ARRIVED: f64 = 1e-9;

/// A start that moves away by more than this many spacings of the grid is not near a zero, or near
/// one that other starts lead to.
const FARTHEST: f64 = 2.0;

/// Turns as a number of zeros; `None` if they are not whole.
fn whole(turn: f64) -> Option<usize> {
    let zeros = turn / TAU;
    ((zeros - zeros.round()).abs() < 1e-6 && zeros > -0.5).then(|| zeros.round() as usize)
}

/// Zeros within this fraction of the grid of one another count as one multiple zero where a zero
/// is missing.
const MULTIPLE: f64 = 2e-3;

/// Grids tried before a window is declared incomplete.
const GRIDS: usize = 5;

/// Most Newton starts from grids in one sector: a window with more zeros is declared incomplete.
const MOST_STARTS: usize = 2000;

/// Newton starts closer than this fraction of the grid are one.
const SAME_START: f64 = 0.2;

/// The spectrum of a linearised wave. `seeds` is that of a neighbouring wave, if known.
pub fn spectrum(
    characteristic: &Characteristic,
    request: &Request,
    seeds: Option<&Spectrum>,
) -> Spectrum {
    let mode = characteristic.mode as usize;
    let mut halves: Vec<usize> = request.sectors.clone();
    for sector in &request.sectors {
        let conjugate = (mode - sector % mode) % mode;
        if !halves.contains(&conjugate) {
            halves.push(conjugate);
        }
    }
    let high = HighFrequency::new(characteristic);
    // about two grid points from zero to zero, also where c² → a makes one delay long
    let delay = high.longest_delay().max(characteristic.period);
    let spacing = (0.6 / characteristic.period).min(3.0 / delay);
    let mut search = Search {
        characteristic,
        delay,
        spacing,
        rate: characteristic.period.recip(),
        multipliers: halves
            .iter()
            .map(|sector| characteristic.multiplier(*sector))
            .collect(),
        halves,
        edge: None,
    };
    let wanted = request.max_frequency + margin(request, characteristic);
    let expected = wanted * delay / std::f64::consts::PI * request.sectors.len() as f64;
    let cut = (MOST_ZEROS / expected).min(1.0);
    let (right, clear) = right_edge(&search, &high, cut * wanted);
    if clear && characteristic.beta == 0.0 {
        search.edge = Some(Edge {
            right,
            top: cut * wanted,
        });
    }
    let mut window = Window::symmetric(
        seeds.map_or(-search.spacing, |seeds| seeds.left),
        right,
        cut * wanted,
    );
    let guesses = seeds.map_or_else(Vec::new, |seeds| starts(&search, seeds));
    let mut result = None;
    let mut lefts = 0;
    for attempt in 0..24 {
        let guesses: &[Vec<C64>] = if attempt == 0 { &guesses } else { &[] };
        let Some((mut found, complete)) = search.zeros(&window, &request.sectors, guesses) else {
            // a zero sits on the edge
            window.left *= 1.037;
            window.top *= 1.0 + 1.3e-4;
            continue;
        };
        // in a sector that is its own conjugate a zero that is one with its mirror image is real
        let axis = SAME_ZERO * search.spacing;
        for (zeros, sector) in found.iter_mut().zip(&request.sectors) {
            let symmetric = symmetric(*sector, characteristic.mode);
            for zero in zeros.iter_mut().filter(|_| symmetric) {
                if zero.im.abs() < axis {
                    zero.im = 0.0;
                }
            }
        }
        let few = found.iter().zip(&request.sectors).any(|(zeros, sector)| {
            let symmetric = symmetric(*sector, characteristic.mode);
            let listed = zeros
                .iter()
                .filter(|zero| !symmetric || zero.im >= 0.0)
                .count();
            // one more for the translation mode
            listed < request.eigenvalues + 1
        });
        result = Some((found, complete, window));
        let deep = window.left * characteristic.period < -DEEPEST;
        if !few || lefts == DEEPENINGS || cut < 1.0 || deep {
            break;
        }
        lefts += 1;
        window.left *= 1.5;
    }
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
        reasons: vec![Reason::NoWindow],
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
    if !spectrum.complete {
        spectrum.counted = search.growing(&spectrum);
    }
    (spectrum.stable, spectrum.reasons) = verdict(&search, &spectrum, request, &high);
    spectrum
}

/// How often the window is deepened to find as many eigenvalues as were asked for, and how deep in
/// units of 1/T: what decays by e⁶ within a period is of no interest, and from point to point of a
/// branch the window would grow without end where a sector has fewer eigenvalues.
const DEEPENINGS: usize = 8;
const DEEPEST: f64 = 6.0;

/// Zeros of a neighbouring wave as starts, half by half, the translation mode with them.
fn starts(search: &Search, seeds: &Spectrum) -> Vec<Vec<C64>> {
    // zeros near the real axis may come out just below it
    let upper = |value: &C64| value.im > -1e-3 * search.rate;
    search
        .halves
        .iter()
        .map(|half| {
            let mut starts = Vec::new();
            for sector in &seeds.sectors {
                let values = sector.eigenvalues.iter().map(Eigenvalue::value);
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

/// The zero of sector 0 nearest to λ = 0 is the translation mode if it is nearer than this, in units of
/// 1/T: rounding leaves 1e-15 to 1e-9 of a simple zero, 1e-7 of a double one.
const TRANSLATION: f64 = 1e-2;

/// Two zeros closer to λ = 0 than this, in units of 1/T, disturb one another by more than 1e-13.
const DOUBLE: f64 = 1e-3;

/// Takes the translation mode out of the zeros of sector 0 and returns its distance from 0. At a fold
/// another one comes to zero, which is then found by itself.
fn remove_translation(
    characteristic: &Characteristic,
    eigenvalues: &mut Vec<Eigenvalue>,
) -> Option<f64> {
    let rate = characteristic.period.recip();
    let distance = |one: &Eigenvalue| one.value().norm();
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
pub(super) fn beside_translation(
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

/// A right edge beyond which |t| + |d| < 1: no zero lies there. False if it was not found.
fn right_edge(search: &Search, high: &HighFrequency, top: f64) -> (f64, bool) {
    let characteristic = search.characteristic;
    // in the limit, room for samples at about twice 1/τ
    let room = 1.5 / search.delay;
    let beyond = |rho: f64| high.size(rho) + room * high.slope(rho) < EDGE;
    let mut right = 0.4 / characteristic.period;
    while right > 0.5 * search.spacing && beyond(right / 1.5) {
        right /= 1.5;
    }
    for _ in 0..60 {
        let clear = beyond(right)
            && if characteristic.beta > 0.0 {
                // six samples for a turn of the longest delay
                let samples = (top * search.delay).ceil().max(8.0) as usize;
                (0..=samples).all(|index| {
                    let im = top * index as f64 / samples as f64;
                    characteristic.evaluate(C64::new(right, im)).size() < EDGE
                })
            } else {
                clear_line(search, right, top)
            };
        if clear {
            return (right, true);
        }
        right *= 1.5;
    }
    (right, false)
}

/// Whether |t| + |d| stays below 1 on the line Re λ = right up to a height: every sample says so for
/// as far as |t′| + |d′| and the second derivatives cannot bring it to `EDGE`, and these reaches cover
/// the line. Of functions of exponential type τ that stay below 1, the latter are below τ²
/// (Bernstein).
fn clear_line(search: &Search, right: f64, top: f64) -> bool {
    /// A line whose samples reach less far than this fraction of 1/τ is given up.
    const LEAST: f64 = 0.02;
    let delay = search.delay;
    let reach = |im: f64| {
        let value = search.characteristic.evaluate(C64::new(right, im));
        // of |t| + |d| + (|t′| + |d′|)r + (τr)²/2 = EDGE
        let slope = value.slope() / delay;
        ((slope * slope + 2.0 * (EDGE - value.size())).sqrt() - slope) / delay
    };
    let enough = |reach: f64| reach > LEAST / delay;
    let mut covered = reach(0.0);
    if !enough(covered) {
        return false;
    }
    let mut step = covered;
    while covered < top {
        let at = (covered + step).min(top);
        let here = reach(at);
        if !enough(here) {
            return false;
        }
        if at - here <= covered {
            covered = at + here;
            step = here.min(2.0 / delay);
        } else {
            step *= 0.5;
        }
    }
    true
}

/// |t| + |d| stays below this on the right edge.
const EDGE: f64 = 0.95;

/// The strips of a verdict are at least and at most this high, in units of 1/T.
const STRIPS: (f64, f64) = (15.0, 600.0);

/// Stability from the window and the limit at high frequency, and what it rests on.
fn verdict(
    search: &Search,
    spectrum: &Spectrum,
    request: &Request,
    high: &HighFrequency,
) -> (Stability, Vec<Reason>) {
    let mut reasons = Vec::new();
    if !spectrum.complete {
        reasons.push(Reason::Incomplete {
            listed: spectrum.on_circle(|sector| spectrum.listed_unstable(sector)),
            counted: spectrum.counted.is_some().then(|| spectrum.unstable()),
        });
    }
    if spectrum.unstable() > 0 {
        return (Stability::No, reasons);
    }
    let beyond = |one: &Eigenvalue| one.im.abs() > request.max_frequency;
    // the fastest growth in lists, sector by sector, beyond the frequencies that count
    let fastest = |lists: &[&[Eigenvalue]]| {
        let lists = lists.iter().zip(&request.sectors);
        lists
            .flat_map(|(list, sector)| list.iter().map(|one| (*sector, one)))
            .filter(|(_, one)| one.re > spectrum.axis && beyond(one))
            .max_by(|one, other| one.1.re.total_cmp(&other.1.re))
            .map(|(sector, one)| Reason::BeyondWindow {
                re: one.re,
                im: one.im,
                sector,
            })
    };
    let sectors = spectrum.sectors.iter();
    let lists: Vec<&[Eigenvalue]> = sectors.map(|one| one.eigenvalues.as_slice()).collect();
    if let Some(reason) = fastest(&lists) {
        reasons.push(reason);
        return (Stability::No, reasons);
    }
    let limit = spectrum.limit;
    // with stick the limit is attained; without, it is a bound only
    if limit > spectrum.axis && search.characteristic.stick {
        reasons.push(Reason::HighFrequency(limit));
        return (Stability::No, reasons);
    }
    let on_axis = |one: &Eigenvalue| one.re.abs() <= spectrum.axis && !beyond(one);
    if lists.iter().copied().flatten().any(on_axis) {
        reasons.push(Reason::OnAxis);
    }
    let asked = |sector: usize| request.sectors.contains(&sector);
    let left_out: Vec<usize> = (0..=spectrum.mode as usize / 2)
        .filter(|&sector| !asked(sector) && !asked(search.conjugate(sector)))
        .collect();
    if !left_out.is_empty() {
        reasons.push(Reason::Sectors(left_out));
    }
    if !spectrum.complete {
        return (Stability::Undecided, reasons);
    }
    let unsettled = Reason::Unsettled(limit);
    if limit.is_nan() || limit > spectrum.axis {
        reasons.push(unsettled);
        return (Stability::Undecided, reasons);
    }
    // between the window and the frequencies where the limit holds
    let mut top = request.max_frequency.max(STRIPS.0 * search.rate);
    while top < STRIPS.1 * search.rate && 2.0 * top * search.delay < MOST_TURNS {
        top *= 2.0;
        let strip = Window::symmetric(-0.1 * search.spacing, spectrum.right, top);
        let Some((found, complete)) = search.zeros(&strip, &request.sectors, &[]) else {
            continue;
        };
        let lists: Vec<&[Eigenvalue]> = found.iter().map(Vec::as_slice).collect();
        if let Some(reason) = fastest(&lists) {
            return (Stability::No, vec![reason]);
        }
        if complete && settled(search.characteristic, high, top) {
            let proven = reasons.is_empty();
            let verdicts = [Stability::Undecided, Stability::Yes];
            return (verdicts[usize::from(proven)], reasons);
        }
    }
    reasons.push(unsettled);
    (Stability::Undecided, reasons)
}

/// Most radians that the longest delay may turn in the strip of a verdict.
const MOST_TURNS: f64 = 1e5;

/// Whether the limit is reached at a frequency: its error, which falls like 1/ω, cannot bring
/// |t| + |d| to 1 beyond it.
fn settled(characteristic: &Characteristic, high: &HighFrequency, top: f64) -> bool {
    /// The error is estimated over the upper third of the window; twice that is allowed for.
    const SAFETY: f64 = 2.0;
    const SAMPLES: usize = 200;
    if characteristic.beta > 0.0 {
        return quiet(characteristic, high, top);
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
