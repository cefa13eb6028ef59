//! Waves and branches that the claims are about.

use brakewave::orbit::legs::Run as _;
use std::path::PathBuf;

use brakewave::branch::SavedWave;
use brakewave::branch::first_wave::first_wave;
use brakewave::branch::run::{End, WaveItem, WaveRunner};
use brakewave::branch::special::WaveNote;
use brakewave::continuation;
use brakewave::linalg::Vector;
use brakewave::problem::{self, Any, Problem};
use brakewave::tube::model::coefficients::Geometry;
use brakewave::tube::model::{Damping, Impact, Model, Parameter};
use brakewave::tube::stability::characteristic::Characteristic;
use brakewave::tube::stability::spectrum::{Spectrum, SpectrumRequest, spectrum};
use brakewave::tube::wave::Wave;
use brakewave::tube::wave::start::Which;
use nalgebra::Complex;

pub type C64 = Complex<f64>;

/// Steps of the default problem.
pub const STEPS: continuation::Steps = continuation::Steps {
    ds: 0.005,
    ds_min: 1e-12,
    ds_max: 0.01,
    tolerance: 1e-10,
};

/// An undamped tube with γ = 1 and frictionless impact.
pub fn tube(nu: f64, xi: f64, friction: f64, mismatch: f64) -> Model {
    Model::tube(Geometry { nu, xi, gamma: 1.0 }, friction, mismatch)
}

/// The tube of the mode-4 branches.
pub fn mode4(mismatch: f64) -> Model {
    tube(0.3, 1.5, 0.5, mismatch)
}

/// The same tube, where landing is a Coulomb impact.
pub fn with_coulomb_impact(mismatch: f64) -> Model {
    Model {
        impact: Impact::Coulomb,
        ..mode4(mismatch)
    }
}

/// The same tube with mass-proportional damping, where the wave is slip-stick.
pub fn damped(damping: f64) -> Model {
    Model {
        damping: Damping {
            mass: damping,
            stiffness: 0.0,
        },
        ..mode4(0.2)
    }
}

/// A first wave, posed in the mismatch.
pub fn wave(model: &Model, mode: u32, which: Which) -> (Wave, Vector) {
    first_wave(model, Parameter::Mismatch, mode, which, 1.0, STEPS).expect("there is a first wave")
}

/// The same, linearised.
pub fn linearised(model: &Model, mode: u32, which: Which) -> Characteristic {
    let (wave, point) = wave(model, mode, which);
    Characteristic::new(&wave, &point).expect("the wave can be linearised")
}

/// What the problems ask for: sectors 0 to k/2, |Im λ| up to 12.
pub fn request(mode: u32) -> SpectrumRequest {
    SpectrumRequest {
        sectors: (0..=mode as usize / 2).collect(),
        eigenvalues: 6,
        max_frequency: 12.0,
    }
}

/// The spectrum of a linearised wave in the default window.
pub fn window(characteristic: &Characteristic) -> Spectrum {
    spectrum(characteristic, &request(characteristic.mode), None)
}

/// The folder of the problem files.
fn folder() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("problems")
}

/// A problem file.
pub fn problem(name: &str) -> (Problem, String) {
    problem::read(&folder().join(name)).expect("a valid problem")
}

/// Names of all problem files with a branch.
pub fn problems() -> Vec<String> {
    let mut names: Vec<String> = std::fs::read_dir(folder())
        .expect("there are problems")
        .filter_map(|entry| entry.ok()?.file_name().into_string().ok())
        .filter(|name| name.ends_with(".ron"))
        .filter(|name| match problem::read_any(&folder().join(name)) {
            Ok((Any::Tube(problem), _)) => problem.continuation.is_some(),
            Ok((Any::System(_), _)) => false,
            Err(error) => panic!("{error}"),
        })
        .collect();
    names.sort();
    names
}

/// Rows of a branch, each with the spectrum at the point its step reached.
pub struct Rows {
    /// Rows, step by step.
    pub items: Vec<WaveItem>,
    /// Spectrum at the end of the step of each row.
    pub spectra: Vec<Option<Spectrum>>,
    /// What could not be settled.
    pub notes: Vec<WaveNote>,
}

/// Follows the branch of a problem to its end.
pub fn follow(problem: &Problem, text: &str) -> Rows {
    follow_from(problem, text, None)
}

/// The same from a labelled wave.
pub fn follow_from(problem: &Problem, text: &str, first: Option<&SavedWave>) -> Rows {
    let continuation = problem
        .continuation(text, "problem")
        .expect("there is a branch");
    let mut branch = WaveRunner::begin(problem, continuation, first).expect("the branch begins");
    let mut rows = Rows {
        items: Vec::new(),
        spectra: Vec::new(),
        notes: Vec::new(),
    };
    while branch.progress().end.is_none() {
        let items = branch.step();
        rows.spectra
            .extend(items.iter().map(|_| branch.spectrum().cloned()));
        rows.items.extend(items);
    }
    assert_eq!(branch.progress().end, Some(End::Finished));
    rows.notes = branch.notes().to_vec();
    rows
}
