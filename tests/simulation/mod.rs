//! Claims about the simulation in time: laws kept at every node and step, balances, orders, and the
//! waves and eigenvalues that other parts of the crate compute in other ways.

mod annulus;
mod growth_rates;
mod landing;
mod laws;
mod material;
mod steady;
mod verb;
mod waves;
mod whole_circle;

use std::path::PathBuf;
use std::process::Command;
use std::sync::OnceLock;

use brakewave::simulation::growth::SimulatedEigenvalue;
use brakewave::simulation::profile::Profile;
use brakewave::simulation::ring::{Order, Ring, RingLaw, RingSetup};
use brakewave::tube::model::coefficients::Geometry;
use brakewave::tube::model::{Constants, Impact};
use tempfile::TempDir;

/// The tube of all tests here.
pub const GEOMETRY: Geometry = Geometry {
    nu: 0.3,
    xi: 1.5,
    gamma: 1.0,
};

/// Its parameters at f = 0.5.
pub fn parameters(mismatch: f64, mass_damping: f64) -> Constants {
    Constants {
        coefficients: GEOMETRY.coefficients(),
        friction: 0.5,
        mismatch,
        mass_damping,
        stiffness_damping: 0.0,
        smoothing: 0.0,
    }
}

/// A ring under Coulomb's law, without an account of work.
fn setup(points: usize, angle: f64, order: Order, time_step: f64) -> RingSetup {
    RingSetup {
        points,
        angle,
        order,
        time_step,
        law: RingLaw::Coulomb,
        impact: Impact::Frictionless,
        watched: false,
    }
}

/// One ring of three stretches, on one thread and on two, in blocks and step by step: the same bits.
fn cutting_and_threads_change_nothing(ring: impl Fn() -> Ring + Sync) {
    let run = |threads: usize, parts: &[u64]| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .expect("threads");
        pool.install(|| {
            let mut ring = ring();
            for steps in parts {
                ring.advance(*steps);
            }
            ring.nodes().clone()
        })
    };
    let one = run(1, &[160]);
    assert!(one == run(2, &[160]));
    assert!(one == run(2, &[1, 2, 3, 50, 1, 48, 49, 6]));
}

/// Runs a problem with the binary, once for all tests; the folder of its results.
fn results(problem: &str, cell: &'static OnceLock<(TempDir, PathBuf)>) -> &'static PathBuf {
    let (_, folder) = cell.get_or_init(|| {
        let bench = tempfile::tempdir().expect("a temporary folder");
        let file = bench.path().join("wave.ron");
        std::fs::write(&file, problem).expect("a file can be written");
        let folder = bench.path().join("wave");
        let status = Command::new(env!("CARGO_BIN_EXE_brakewave"))
            .args(["run", "--quiet", "--out"])
            .arg(&folder)
            .arg(&file)
            .status()
            .expect("the binary runs");
        assert!(status.success());
        (bench, folder)
    });
    folder
}

/// The wave of a result folder at a value of a column of `branch.csv`.
fn wave_at(folder: &std::path::Path, column: &str, value: f64) -> (Profile, usize) {
    let mut reader = csv::Reader::from_path(folder.join("branch.csv")).expect("a branch");
    let header = reader.headers().expect("a header").clone();
    let index = |name: &str| {
        header
            .iter()
            .position(|field| field == name)
            .expect("a column")
    };
    let (label, parameter, speed) = (index("label"), index(column), index("speed"));
    for row in reader.records() {
        let row = row.expect("a row");
        let here: f64 = row[parameter].parse().expect("a number");
        if !row[label].is_empty() && here == value {
            let number = row[label].parse().expect("a label");
            let path = folder.join("profiles").join(format!("{number}.csv"));
            let speed = row[speed].parse().expect("a speed");
            return (Profile::read(&path, speed).expect("a profile"), number);
        }
    }
    panic!("no label at {column} = {value}");
}

/// Mode-4 waves along the mismatch.
pub fn wave(mismatch: f64) -> Profile {
    static CELL: OnceLock<(TempDir, PathBuf)> = OnceLock::new();
    let folder = results(
        "(model: (coefficients: Geometry(nu: 0.3, xi: 1.5, gamma: 1.0), friction: 0.5, mismatch: 0.2),
          wave: (mode: 4, start: Fast),
          continuation: (parameter: Mismatch, range: (0.019, 0.2), toward: Down,
                         stop_at: [0.08, 0.045, 0.02]),
          output: (profiles: 1))",
        &CELL,
    );
    wave_at(folder, "mismatch", mismatch).0
}

/// The mode-4 wave with this mass damping: 0.3152 or more is stable on the whole circle.
pub fn damped_wave(mass_damping: f64) -> Profile {
    static CELL: OnceLock<(TempDir, PathBuf)> = OnceLock::new();
    let folder = results(
        "(model: (coefficients: Geometry(nu: 0.3, xi: 1.5, gamma: 1.0), friction: 0.5, mismatch: 0.2),
          wave: (mode: 4, start: Fast),
          continuation: (parameter: MassDamping, range: (0.0, 0.317), toward: Up,
                         stop_at: [0.2, 0.316]),
          output: (profiles: 1))",
        &CELL,
    );
    wave_at(folder, "mass_damping", mass_damping).0
}

/// A sequence of numbers in [−1, 1) that looks random and is always the same.
pub fn scramble(index: usize) -> f64 {
    let mut state = (index as u64)
        .wrapping_mul(0x9E37_79B9_7F4A_7C15)
        .wrapping_add(0x1234_5678);
    state ^= state >> 30;
    state = state.wrapping_mul(0xBF58_476D_1CE4_E5B9);
    state ^= state >> 27;
    (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
}

/// Compares eigenvalues of a coarse and a fine grid with those of the eigenfunction problem. Where errors fall at least like the spacing, that of the finer
/// grid is no larger than the difference of the two; to this come four standard errors of each.
#[track_caller]
pub fn compare_grids(sets: &[Vec<SimulatedEigenvalue>; 2], exact: &[[f64; 2]], most: f64) {
    for [re, im] in exact {
        let [coarse, fine] = [0, 1].map(|set: usize| {
            let off = |value: &SimulatedEigenvalue| (value.re - re).hypot(value.im - im);
            let nearest = sets[set]
                .iter()
                .min_by(|one, other| off(one).total_cmp(&off(other)));
            *nearest.expect("an eigenvalue")
        });
        let off = (fine.re - re).hypot(fine.im - im);
        let allowed = (fine.re - coarse.re).hypot(fine.im - coarse.im)
            + 4.0 * (fine.scatter + coarse.scatter)
            + fine.residual;
        println!("observed: {re} {im}: {coarse:?} {fine:?} {off:e} {allowed:e}");
        assert!(off <= allowed, "{re} {im}: {fine:?}, {off:e} {allowed:e}");
        assert!(allowed < most, "{re} {im}: decides nothing, {allowed:e}");
    }
}
