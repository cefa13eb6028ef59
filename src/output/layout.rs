//! Names of the files of result folders, their pictures included.

use super::render::Format;
use super::store::FolderKind;
use crate::problem::{Plot, Problem, SystemPlot, SystemProblem};
use crate::simulation::task::Body;

pub(crate) const BRANCH: &str = "branch.csv";
pub(crate) const EVENTS: &str = "events.csv";
/// Eigenvalues at the labels of a branch.
pub(crate) const SPECTRUM: &str = "spectrum.csv";
/// Floquet multipliers at the labels of a branch of orbits.
pub(crate) const MULTIPLIERS: &str = "multipliers.csv";
/// Eigenvalues at the labels of a branch of equilibria.
pub(crate) const EIGENVALUES: &str = "eigenvalues.csv";
/// Folder of the waves at the labels of a branch.
pub(crate) const PROFILES: &str = "profiles";

/// The wave at a label.
pub(crate) fn profile_file(label: usize) -> String {
    format!("{PROFILES}/{label}.csv")
}

pub(crate) const MAP: &str = "map.csv";
/// What attracts the motions of a basin, and its orbits to restart from.
pub(crate) const ATTRACTORS: &str = "attractors.csv";
/// How large a share of motions comes to which attractor along a parameter, and its picture without extension.
pub(crate) const SHARES: &str = "shares.csv";
pub(crate) const SHARES_PICTURE: &str = "shares";
pub(crate) const ATTRACTORS_SAVED: &str = "attractors.ron";
/// The problem of a map.
pub(crate) const MAP_ORIGIN: &str = "map.ron";
pub(crate) const SCAN: &str = "scan.csv";
/// The problem of a scan.
pub(crate) const SCAN_ORIGIN: &str = "scan.ron";
pub(crate) const CURVE: &str = "curve.csv";
/// Errors and run times of methods.
pub(crate) const ACCURACY: &str = "accuracy.csv";
pub(crate) const CERTIFICATES: &str = "certificates.csv";
pub(crate) const STEADY: &str = "steady.csv";

/// Time series of a simulation.
pub(crate) const SERIES: &str = "series.csv";
/// Switches of a motion of a system.
pub(crate) const SWITCHES: &str = "switches.csv";
/// States of a motion of a system at every period of its forcing.
pub(crate) const SECTION: &str = "section.csv";
/// Regimes over place and time.
pub(crate) const REGIMES: &str = "regimes.npy";
/// Contact line at the beginning.
pub(crate) const START: &str = "start.csv";
/// Contact line at the end.
pub(crate) const END: &str = "end.csv";
/// What was measured of a simulation.
pub(crate) const MEASURES: &str = "measures.csv";
pub(crate) const GROWTH: &str = "growth.csv";
pub(super) const SNAPSHOTS: &str = "snapshots";

/// A snapshot, counted from 1.
pub(crate) fn snapshot_file(number: usize, body: &Body) -> String {
    let extension = match body {
        Body::Ring { .. } => "npy",
        Body::Annulus { .. } => "vtk",
    };
    format!("{SNAPSHOTS}/{number:04}.{extension}")
}

/// Pictures of a simulation, without extension.
pub(super) const MOTION: [&str; 4] = ["space_time", "velocity", "phase_plane", "profiles"];
/// Picture of one view of a branch, without extension.
pub(super) const VIEW: &str = "view";

/// Files of the pictures in a folder of this kind.
pub(crate) fn pictures(kind: FolderKind, problem: &Problem, format: Format) -> Vec<String> {
    let names = match kind {
        FolderKind::Run => problem.output.plots.iter().map(plot).collect(),
        FolderKind::Simulation => MOTION.map(str::to_owned).to_vec(),
        FolderKind::Curve | FolderKind::Accuracy | FolderKind::Steady => {
            vec![kind.name().to_owned()]
        }
        FolderKind::Map
        | FolderKind::MapShard
        | FolderKind::Scan
        | FolderKind::ScanShard
        | FolderKind::Certificate => Vec::new(),
    };
    names.iter().map(|name| picture(name, format)).collect()
}

/// Files of the pictures of a branch of orbits.
pub(crate) fn pictures_of_orbits(problem: &SystemProblem, format: Format) -> Vec<String> {
    let plots = problem.output.plots.iter();
    plots
        .map(|plot| picture(&orbit_plot(plot), format))
        .collect()
}

/// The picture of a scan, and that with a branch over it, without extension.
pub(super) const SCANNED: [&str; 2] = ["scan", "scan_over"];
/// Pictures of a motion of a system, without extension.
pub(super) const OF_MOTION: [&str; 2] = ["time_series", "phase_plane"];

/// Name of a picture of a branch of orbits.
pub(super) fn orbit_plot(plot: &SystemPlot) -> String {
    match plot {
        SystemPlot::Diagram => "diagram".to_owned(),
        SystemPlot::Phase(one, other) => format!("phase_{}_{}", safe(one), safe(other)),
        SystemPlot::Time(state) => format!("time_{}", safe(state)),
        SystemPlot::Multipliers => "multipliers".to_owned(),
        SystemPlot::Column(name) => format!("column_{}", safe(name)),
    }
}

/// A name that comes from a file and must not lead out of the folder.
fn safe(name: &str) -> String {
    let safe = |c: char| {
        if c.is_alphanumeric() || c == '-' {
            c
        } else {
            '_'
        }
    };
    name.chars().map(safe).collect()
}

/// The file of a picture.
pub(super) fn picture(name: &str, format: Format) -> String {
    format!("{name}.{}", format.extension())
}

/// Name of a picture of a branch.
pub(super) fn plot(plot: &Plot) -> String {
    let name = match plot {
        Plot::Diagram => "diagram",
        Plot::Pressure => "pressure",
        Plot::Displacement => "displacement",
        Plot::Wave => "wave",
        Plot::PhasePlane => "phase_plane",
        Plot::Friction => "friction",
        Plot::Spectrum => "spectrum",
        Plot::Multipliers => "multipliers",
        Plot::Column(name) => &format!("column_{}", safe(name)),
    };
    name.to_owned()
}
