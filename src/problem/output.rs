//! The section `output`: plots and tables beside those of the branch.

use serde::{Deserialize, Serialize};

use super::outline::Outline;
use crate::tube::model::Parameter;

/// What to write besides the tables of the branch.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
#[serde(bound(deserialize = "P: Deserialize<'de>"))]
pub struct Output<P = Plot> {
    /// Plots to draw.
    pub plots: Vec<P>,
    /// Labels of the waves in pictures of waves; without them one of each sequence of regimes, user points
    /// and some in between, nine at most.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub labels: Vec<usize>,
    /// Number of wave profiles to tabulate, at most [`MAX_PROFILES`](super::MAX_PROFILES); 9 in a file that does not say so and has a plot
    /// of them, 0 else.
    pub profiles: usize,
    /// Whether to give the condition number and the expected error of every point.
    pub conditioning: bool,
    /// Angular velocity Ω of the shaft in rad/s, Ω > 0: with it tables have frequencies in hertz.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rotation: Option<f64>,
}

impl<P> Default for Output<P> {
    fn default() -> Self {
        Output {
            plots: Vec::new(),
            labels: Vec::new(),
            profiles: 0,
            conditioning: false,
            rotation: None,
        }
    }
}

/// Profiles where a plot shows them and the file does not say how many.
const USUAL_PROFILES: usize = 9;

impl<P> Output<P> {
    /// Asks for profiles where a plot shows them and the text does not say how many.
    pub(super) fn with_profiles(&mut self, outline: &Outline, shows: impl Fn(&P) -> bool) {
        if !outline.has("output.profiles") && self.plots.iter().any(shows) {
            self.profiles = USUAL_PROFILES;
        }
    }
}

impl Output {
    /// |ω|Ω/2π in hertz for an angular frequency ω in units of Ω, where Ω is given; k crests that run round
    /// with speed c are heard with ω = kc.
    pub fn hertz(&self, omega: f64) -> Option<f64> {
        let rotation = self.rotation?;
        Some(omega.abs() * rotation / std::f64::consts::TAU)
    }
}

/// Columns of `branch.csv` of which a curve can be drawn, in their order.
pub(crate) fn drawable_columns() -> Vec<String> {
    let later = |wanted: bool| {
        let of_table = move |parameter: &Parameter| parameter.is_later() == wanted;
        let listed = Parameter::ALL.into_iter().filter(of_table);
        listed.map(Parameter::column)
    };
    let wave = "speed switches min_pressure max_gap amplitude unstable lead_re lead_im lead_sector newton \
                residual leg";
    let names = ["point", "label"].into_iter().chain(later(false));
    let names = names.chain(wave.split_whitespace()).chain(later(true));
    let names = names.chain(["condition", "expected_error", "hertz"]);
    names.map(str::to_owned).collect()
}

/// A kind of plot.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Plot {
    /// Branch diagram: wave speed over the parameter.
    Diagram,
    /// Contact pressure over a wavelength.
    Pressure,
    /// Radial displacement over a wavelength, wave above wave.
    Displacement,
    /// Tangential and radial displacement over a wavelength.
    Wave,
    /// Eigenvalues in the complex plane.
    Spectrum,
    /// Floquet multipliers of the first labelled wave, with the unit circle.
    Multipliers,
    /// Velocities over displacements.
    PhasePlane,
    /// Friction force and relative velocity over a wavelength.
    Friction,
    /// Branch diagram of the named column of `branch.csv`.
    Column(String),
}

impl Plot {
    /// Whether it shows waves as tabulated in profiles.
    pub(crate) fn shows_profiles(&self) -> bool {
        use Plot::{Displacement, Friction, PhasePlane, Pressure, Wave};
        matches!(self, Pressure | Displacement | Wave | PhasePlane | Friction)
    }
}
