//! What the section `growth` of a simulation asks for: perturbations of a wave, sector by sector, on the
//! ring of the simulation and on one of half as many points.

use super::growth::{self, GrowthError, GrowthRow, Listing, Request};
use super::motion::{Motion, MotionError, angle};
use super::profile::Profile;
use super::ring::Setup;
use super::task::{Body, Circle, Simulation};
use crate::model::{Constants, Model, Sectors};

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

/// The perturbations of one sector.
pub struct Perturbations {
    setup: Setup,
    fine: Request,
    coarse: Request,
    /// Steps of nodes that they take.
    pub work: f64,
}

/// Why perturbations cannot be asked for.
#[derive(Debug, thiserror::Error)]
pub enum Refused {
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
) -> Result<Vec<Perturbations>, Refused> {
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
    let Motion::Ring(ring) = Motion::begin(section, model, mode, None)? else {
        return Ok(Vec::new());
    };
    let parameters = &model.constants();
    let setup = Setup {
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
        let rows = LISTING.of(&self.fine, fine).map(|eigenvalue| GrowthRow {
            sector: self.sector(),
            eigenvalue,
            grid: coarse
                .iter()
                .map(|other| (other.re - eigenvalue.re).hypot(other.im - eigenvalue.im))
                .fold(f64::INFINITY, f64::min),
        });
        Ok(rows.collect())
    }
}
