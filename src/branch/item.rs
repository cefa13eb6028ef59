//! A point of a run: its row, and the wave behind it.

use std::sync::Arc;

use super::orbit::Found;
use super::row::EigenvalueRow;
use super::saved::SavedWave;
use super::special::{OfWaves, Special};
use super::{BranchPoint, Event, LeadingEigenvalue, ProfileSample, Stability, VerdictReason};
use crate::linalg::Vector;
use crate::tube::flow::FlowError;
use crate::tube::model::Model;
use crate::tube::stability::characteristic::Characteristic;
use crate::tube::stability::spectrum::Spectrum;
use crate::tube::wave::{Wave, profile};

/// A row of the branch, with the wave behind it.
#[derive(Clone, Debug)]
pub struct WaveItem {
    /// The row.
    pub point: BranchPoint,
    /// Leg it belongs to.
    pub leg: usize,
    /// The event, at special points.
    pub event: Option<Event>,
    /// What makes the point special.
    pub special: Option<Special>,
    /// The wave in physical numbers, at labelled points.
    pub saved: Option<SavedWave>,
    /// Leading eigenvalues by sector at labelled points.
    pub eigenvalues: Vec<EigenvalueRow>,
    pub(super) wave: Arc<Wave>,
    pub(super) unknowns: Vector,
}

impl WaveItem {
    /// The wave as a boundary-value problem and its solution in scaled unknowns.
    pub fn wave(&self) -> (&Wave, &Vector) {
        (&self.wave, &self.unknowns)
    }

    /// Samples of the wave over one wavelength.
    pub fn profile(&self, resolution: usize) -> Result<Vec<ProfileSample>, FlowError> {
        profile::sample(&self.wave, &self.unknowns, resolution)
    }
}

/// The row of a point found, its numbers still to be given.
pub(super) fn row(found: &Found, model: &Model) -> BranchPoint {
    let Found {
        orbit: wave,
        node,
        examination,
        ..
    } = found;
    let (low, high) = examination.tangential;
    BranchPoint {
        point: 0,
        label: None,
        kind: found.kind(),
        regimes: wave.signature.to_string(),
        model: *model,
        speed: wave.speed_at(&node.point),
        switches: profile::switches(wave, &node.point),
        min_pressure: examination.least_pressure,
        max_gap: examination.largest_gap,
        amplitude: 0.5 * (high - low),
        stable: None,
        unstable: None,
        lead: None,
        why: Vec::new(),
        newton: node.newton,
        residual: node.residual,
        conditioning: None,
    }
}

/// Writes the stability of a wave into its point; `None` where its spectrum is not known.
pub fn answer(
    point: &mut BranchPoint,
    spectrum: Option<&Spectrum>,
    wave: &Wave,
    unknowns: &Vector,
) {
    let spectrum = spectrum.filter(|spectrum| !spectrum.sectors.is_empty());
    let lead = spectrum.and_then(Spectrum::lead);
    point.stable = Some(spectrum.map_or(Stability::Undecided, |spectrum| spectrum.stable));
    point.unstable = spectrum.map(Spectrum::unstable);
    point.lead = lead.map(|(eigenvalue, sector)| LeadingEigenvalue {
        re: eigenvalue.re,
        im: eigenvalue.im,
        sector,
    });
    point.why = match spectrum {
        Some(spectrum) => spectrum.reasons.clone(),
        None => vec![match Characteristic::new(wave, unknowns) {
            Err(error) => VerdictReason::NotLinearised(error.to_string()),
            Ok(_) => VerdictReason::NoWindow,
        }],
    };
}

/// The row of an event at a point.
pub(super) fn event(point: &BranchPoint, special: &Special, found: &Found) -> Event {
    let (sector, omega) = match special {
        Special::Own(OfWaves::Crossing { sector, omega, .. }) => (Some(*sector), *omega),
        _ => (None, None),
    };
    let after = special.after();
    Event {
        label: point.label.unwrap_or_default(),
        kind: special.kind(),
        model: point.model,
        speed: point.speed,
        sector,
        omega,
        regimes_before: point.regimes.clone(),
        regimes_after: after.map_or_else(|| point.regimes.clone(), |after| after.to_string()),
        uncertainty: found.known_to(),
        what: special.to_string(),
    }
}
