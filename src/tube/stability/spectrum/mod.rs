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

mod count;
mod find;
mod search;
mod translation;
mod verdict;

pub use search::spectrum;
pub(super) use translation::beside_translation;

use serde::{Deserialize, Serialize};

use super::C64;
use super::characteristic::Characteristic;
use crate::orbit::Stability;
use crate::tube::stability::verdict::VerdictReason;

/// Which eigenvalues to compute.
#[derive(Clone, Debug, PartialEq)]
pub struct SpectrumRequest {
    /// Bloch sectors 0 ≤ j ≤ k/2.
    pub sectors: Vec<usize>,
    /// Eigenvalues wanted in each sector.
    pub eigenvalues: usize,
    /// Largest |Im λ| that counts, in units of Ω.
    pub max_frequency: f64,
}

/// Eigenvalues are followed beyond the largest frequency that counts, by this part of it but no more than
/// about a grid spacing, in units of 1/T: those that enter the window through its upper edge between two
/// points are then known at both.
const MARGIN: (f64, f64) = (1.0 / 24.0, 0.65);

/// How far beyond the largest frequency that counts eigenvalues are followed.
pub(super) fn margin(request: &SpectrumRequest, characteristic: &Characteristic) -> f64 {
    (MARGIN.0 * request.max_frequency).min(MARGIN.1 / characteristic.period)
}

/// An eigenvalue λ: a perturbation of the wave in its own frame goes like e^{λt}.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct WaveEigenvalue {
    /// Re λ, the growth rate, in units of Ω.
    pub re: f64,
    /// Im λ, the angular frequency in the frame of the wave, in units of Ω.
    pub im: f64,
    /// Estimate of its error: last Newton correction and rounding of F over |F′|.
    pub error: f64,
    /// Multiplicity of the zero of F_j: 1 for a simple eigenvalue.
    pub multiplicity: usize,
}

impl WaveEigenvalue {
    /// λ as a complex number.
    pub fn value(&self) -> C64 {
        C64::new(self.re, self.im)
    }
}

/// The eigenvalues of one sector in the window, the translation mode left out, by falling Re λ.
/// In sectors 0 and k/2 conjugate pairs appear with both members.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Sector {
    /// Bloch sector j, 0 ≤ j ≤ k/2.
    pub sector: usize,
    /// All zeros found but the translation mode, by falling Re λ.
    pub eigenvalues: Vec<WaveEigenvalue>,
}

/// The spectrum of a wave in a window.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Spectrum {
    /// One entry per sector asked for, in order.
    pub sectors: Vec<Sector>,
    /// Left edge of the window, a value of Re λ.
    pub left: f64,
    /// Right edge of the window: no zero lies beyond it.
    pub right: f64,
    /// Upper edge of the window, a value of Im λ.
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
    /// Whether the wave is stable.
    pub stable: Stability,
    /// What the verdict and the count rest on, where that is not plain.
    #[serde(default)]
    pub reasons: Vec<VerdictReason>,
    /// Unstable eigenvalues of each sector by the argument principle, where the list is incomplete
    /// and they could be counted.
    #[serde(default)]
    pub counted: Option<Vec<usize>>,
    /// Mode k of the wave.
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
pub(crate) const ON_AXIS: f64 = 1e-10;

/// Whether a sector of a wave of mode k is its own conjugate: 0 and k/2.
pub(crate) fn symmetric(sector: usize, mode: u32) -> bool {
    sector == 0 || 2 * sector == mode as usize
}

impl Spectrum {
    /// Unstable eigenvalues of one sector with |Im λ| up to the largest frequency that counts: counted,
    /// or else listed.
    pub(crate) fn unstable_in(&self, sector: &Sector) -> usize {
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

    /// The spectrum at a located crossing of a sector at iω: the eigenvalue there is on the imaginary axis, from which the error
    /// of the parameter moves it.
    pub(crate) fn with_crossing(mut self, sector: usize, omega: f64) -> Spectrum {
        /// Times [`ON_AXIS`]: beside a zone without length growth changes with the parameter like a square root.
        const NEAR: f64 = 1e4;
        let near = NEAR * self.axis;
        let conjugate = self.symmetric(sector).then_some(-omega);
        let grew = self.unstable() > 0;
        let own = self.sectors.iter_mut().find(|one| one.sector == sector);
        if let Some(own) = own {
            for omega in [omega].into_iter().chain(conjugate) {
                let far = |one: &WaveEigenvalue| (one.value() - C64::new(0.0, omega)).norm();
                let eigenvalues = own.eigenvalues.iter_mut();
                let nearest = eigenvalues.min_by(|one, other| far(one).total_cmp(&far(other)));
                if let Some(one) = nearest.filter(|one| far(one) <= near) {
                    one.re = 0.0;
                }
            }
        }
        if grew && self.unstable() == 0 {
            self.stable = Stability::Undecided;
            self.reasons.push(VerdictReason::OnAxis);
        }
        self
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

    /// Whether a sector is its own conjugate: 0 and k/2.
    pub fn symmetric(&self, sector: usize) -> bool {
        symmetric(sector, self.mode)
    }

    /// The eigenvalues of a sector as tables list them: up to the largest frequency that counts,
    /// and of conjugate pairs in a symmetric sector only the member with Im λ ≥ 0.
    pub fn listed<'a>(&'a self, sector: &'a Sector) -> impl Iterator<Item = &'a WaveEigenvalue> {
        let symmetric = self.symmetric(sector.sector);
        sector
            .eigenvalues
            .iter()
            .filter(move |eigenvalue| !symmetric || eigenvalue.im >= 0.0)
            .filter(|eigenvalue| eigenvalue.im.abs() <= self.max_frequency)
    }

    /// The first eigenvalues of every sector that are listed, with their sectors.
    pub fn leading(&self, most: usize) -> impl Iterator<Item = (usize, &WaveEigenvalue)> {
        self.sectors.iter().flat_map(move |sector| {
            let listed = self.listed(sector).take(most);
            listed.map(|eigenvalue| (sector.sector, eigenvalue))
        })
    }

    /// The eigenvalue of largest real part, with its sector.
    pub fn lead(&self) -> Option<(WaveEigenvalue, usize)> {
        self.sectors
            .iter()
            .flat_map(|sector| {
                self.listed(sector)
                    .map(|eigenvalue| (*eigenvalue, sector.sector))
            })
            .max_by(|one, other| one.0.re.total_cmp(&other.0.re))
    }
}
