//! The table of the modes of steady sliding.

use serde::Serialize;

use super::{Full, SteadyMode, SteadyWave};

/// A row: the reduced model, then the tube.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct ModeRow {
    mode: u32,
    growth: f64,
    omega: f64,
    speed: f64,
    direction: &'static str,
    hopf_friction: Option<f64>,
    hopf_omega: Option<f64>,
    first: &'static str,
    tube: TubeRow,
    /// `omega` and `full_omega`, where the rotation of the shaft is given.
    #[serde(skip_serializing_if = "Option::is_none")]
    hertz: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    full_hertz: Option<f64>,
}

/// What the full radial problem says: its fundamental family, the family that leads, convergence.
/// Empty where only the coefficients of the reduced model are known.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
struct TubeRow {
    full_growth: Option<f64>,
    full_omega: Option<f64>,
    full_speed: Option<f64>,
    full_direction: &'static str,
    full_hopf_friction: Option<f64>,
    full_hopf_omega: Option<f64>,
    field_error: Option<f64>,
    lead_family: Option<usize>,
    lead_growth: Option<f64>,
    lead_omega: Option<f64>,
    lead_speed: Option<f64>,
    lead_direction: &'static str,
    lead_hopf_family: Option<usize>,
    lead_hopf_friction: Option<f64>,
    lead_hopf_omega: Option<f64>,
    lead_first: &'static str,
    radial_order: Option<usize>,
    radial_error: Option<f64>,
}

impl ModeRow {
    /// A mode; `first` where it is the first to grow in the reduced model, `tube_first` in the tube;
    /// `hertz` of an angular frequency.
    pub(crate) fn new(
        mode: &SteadyMode,
        first: bool,
        tube_first: bool,
        hertz: impl Fn(f64) -> Option<f64>,
    ) -> ModeRow {
        let full = mode.full.as_ref().map(|full| full.fundamental.wave.omega);
        let (wave, hopf) = (mode.reduced.wave, mode.reduced.hopf);
        let tube = mode.full.as_ref();
        ModeRow {
            mode: mode.mode,
            growth: wave.growth,
            omega: wave.omega,
            speed: wave.speed,
            direction: direction(&wave),
            hopf_friction: hopf.map(|point| point.friction),
            hopf_omega: hopf.map(|point| point.omega),
            first: mark(first),
            tube: tube.map_or_else(TubeRow::default, |full| TubeRow::new(full, tube_first)),
            hertz: hertz(wave.omega),
            full_hertz: full.and_then(hertz),
        }
    }
}

impl TubeRow {
    fn new(full: &Full, first: bool) -> TubeRow {
        let (wave, hopf) = (full.fundamental.wave, full.fundamental.hopf);
        let (family, lead_hopf) = full.first.unzip();
        TubeRow {
            full_growth: Some(wave.growth),
            full_omega: Some(wave.omega),
            full_speed: Some(wave.speed),
            full_direction: direction(&wave),
            full_hopf_friction: hopf.map(|point| point.friction),
            full_hopf_omega: hopf.map(|point| point.omega),
            field_error: Some(full.field_error),
            lead_family: Some(full.lead),
            lead_growth: Some(full.lead_wave.growth),
            lead_omega: Some(full.lead_wave.omega),
            lead_speed: Some(full.lead_wave.speed),
            lead_direction: direction(&full.lead_wave),
            lead_hopf_family: family,
            lead_hopf_friction: lead_hopf.map(|point| point.friction),
            lead_hopf_omega: lead_hopf.map(|point| point.omega),
            lead_first: mark(first),
            radial_order: Some(full.order),
            radial_error: Some(full.error),
        }
    }
}

fn mark(first: bool) -> &'static str {
    if first { "yes" } else { "" }
}

/// Whether a wave runs with the shaft or against it.
fn direction(wave: &SteadyWave) -> &'static str {
    match wave.speed {
        speed if speed > 0.0 => "with",
        speed if speed < 0.0 => "against",
        _ => "",
    }
}
