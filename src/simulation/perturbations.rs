//! What the section `growth` of a simulation asks for: perturbations of a wave, sector by sector, on the
//! ring of the simulation and on one of half as many points.

use serde::Serialize;

use super::growth::{self, GrowthError, Listing, Request, SimulatedEigenvalue};
use super::motion::{MotionError, SimulatedMotion, angle};
use super::profile::Profile;
use super::ring::RingSetup;
use super::task::{Body, Circle, Simulation};
use crate::tube::model::{Constants, Model, Sectors};

/// Eigenvalues listed per sector, as those of `spectrum` are. |Im λ| below `real` is rounding of a
/// logarithm over the time of a pair.
const LISTING: Listing = Listing {
    resolved: 1e-2,
    highest: 12.0,
    real: 1e-6,
    most: 6,
};

/// Share of the work on the finer ring: half the points take a quarter of the steps of nodes.
const FINE: f64 = 0.8;

/// Whether a perturbation grows, as far as the error of its eigenvalue lets one say.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Grows {
    /// Re λ > 0 by more than the error.
    Yes,
    /// Re λ < 0 by more than the error.
    No,
    /// The error is larger than |Re λ|.
    #[default]
    Undecided,
}

/// A row of `growth.csv`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct GrowthRow {
    /// Bloch sector.
    pub sector: usize,
    /// The eigenvalue.
    pub eigenvalue: SimulatedEigenvalue,
    /// Its difference from that of a coarser grid.
    pub grid: f64,
    /// Estimate of |λ − exact|.
    pub error: f64,
    /// The sign of the growth rate.
    pub grows: Grows,
}

/// What the difference of two grids, one twice as fine as the other, is multiplied with. The error of the finer
/// one is this difference where it falls like the spacing, less where it falls faster, and 1/(2^p − 1) times it
/// where it falls like the power p: 4 covers p ≥ 0.32. At landings whose impulse is arrested at V̇ = 1 the error
/// falls that slowly on grids of 100 to 800 points.
const SLOWEST: f64 = 4.0;

impl GrowthRow {
    /// Eigenvalues beside those of a ring of half as many points. Where fronts come late the frequencies are off
    /// in proportion: no difference counts less than the median relative one of all, for another eigenvalue of the
    /// coarse ring may be near by accident.
    pub fn list(
        sector: usize,
        fine: Vec<SimulatedEigenvalue>,
        coarse: &[SimulatedEigenvalue],
    ) -> Vec<GrowthRow> {
        let nearest = |eigenvalue: &SimulatedEigenvalue| {
            let distances = coarse
                .iter()
                .map(|other| (eigenvalue.distance(other), other.scatter));
            distances
                .min_by(|one, other| one.0.total_cmp(&other.0))
                .unwrap_or((f64::INFINITY, 0.0))
        };
        let relative = |value: &SimulatedEigenvalue| nearest(value).0 / value.re.hypot(value.im);
        let mut ratios: Vec<f64> = fine.iter().map(relative).collect();
        ratios.sort_by(f64::total_cmp);
        let median = ratios.get(ratios.len().saturating_sub(1) / 2).copied();
        let row = |eigenvalue: SimulatedEigenvalue| {
            let (grid, rough) = nearest(&eigenvalue);
            let least = median.unwrap_or(0.0) * eigenvalue.re.hypot(eigenvalue.im);
            let error =
                SLOWEST * (grid.max(least) + eigenvalue.scatter + rough) + eigenvalue.residual;
            let grows = match eigenvalue.re {
                re if re > error => Grows::Yes,
                re if re < -error => Grows::No,
                _ => Grows::Undecided,
            };
            GrowthRow {
                sector,
                eigenvalue,
                grid,
                error,
                grows,
            }
        };
        fine.into_iter().map(row).collect()
    }
}

/// The perturbations of one sector.
pub struct Perturbations {
    setup: RingSetup,
    fine: Request,
    coarse: Request,
    /// Steps of nodes that they take.
    pub work: f64,
}

/// Why perturbations cannot be asked for.
#[derive(Debug, thiserror::Error)]
pub enum RefusedPerturbations {
    /// The ring of one wavelength cannot be set up.
    #[error("{0}")]
    Motion(#[from] MotionError),
    /// A ring of perturbations cannot be set up.
    #[error("{0}")]
    Growth(#[from] GrowthError),
}

/// What a section asks for, with every ring known to be one.
///
/// # Errors
/// When one is none.
pub fn perturbations(
    section: &Simulation,
    model: &Model,
    mode: u32,
    wave: Option<&Profile>,
) -> Result<Vec<Perturbations>, RefusedPerturbations> {
    let (Some(growth), Body::Ring { points, .. }, Some(wave)) =
        (&section.growth, section.body, wave)
    else {
        return Ok(Vec::new());
    };
    let waves = mode as usize;
    let points = match section.circle {
        Circle::Whole => points / waves,
        Circle::Wavelength => points,
    };
    let sectors = match &growth.sectors {
        Sectors::All => (0..=waves / 2).collect(),
        Sectors::Only(list) => list.clone(),
    };
    let SimulatedMotion::Ring(ring) = SimulatedMotion::begin(section, model, mode, None)? else {
        return Ok(Vec::new());
    };
    let parameters = &model.constants();
    let setup = RingSetup {
        angle: angle(section, mode),
        ..*ring.setup()
    };
    sectors
        .into_iter()
        .map(|sector| {
            let request = |points: usize| Request {
                courant: section.courant,
                amplitude: growth.amplitude,
                pairs: growth.pairs,
                ..Request::of_sector(sector, waves, points)
            };
            let (fine, coarse) = (request(points), request(points / 2));
            let work = |request| growth::work(parameters, &setup, wave, request, growth::INSTANTS);
            Ok(Perturbations {
                work: work(&fine)? + work(&coarse)?,
                setup,
                fine,
                coarse,
            })
        })
        .collect()
}

impl Perturbations {
    /// Bloch sector.
    pub fn sector(&self) -> usize {
        self.fine.sector
    }

    /// Growth of perturbations of the wave, with the difference from the ring of half as many points.
    /// `tick` is told the work of every pair of runs.
    ///
    /// # Errors
    /// When the eigenvalues do not converge.
    pub fn growth(
        &self,
        parameters: &Constants,
        wave: &Profile,
        tick: &mut dyn FnMut(f64),
    ) -> Result<Vec<GrowthRow>, GrowthError> {
        let instants = growth::INSTANTS;
        let count = (self.fine.pairs * instants) as f64;
        let mut on = |request: &Request, share: f64| {
            let mut tick = || tick(share * self.work / count);
            growth::averaged(parameters, &self.setup, wave, request, instants, &mut tick)
        };
        let fine = on(&self.fine, FINE)?;
        let coarse = on(&self.coarse, 1.0 - FINE)?;
        let listed = LISTING.of(&self.fine, fine).collect();
        Ok(GrowthRow::list(self.sector(), listed, &coarse))
    }
}
