//! Eigenvalues of waves from simulations of the ring, with their convergence in the number of points.
//!
//!     brakewave run problems/mode4_mismatch.ron
//!     cargo run --release --example ring_eigenvalues
//!
//! Takes every labelled wave of the result folder (or of another one, given as argument) at the
//! mismatches listed below, and prints, by sector and points per wavelength, what half differences
//! of pairs of runs give: growth rate, frequency, scatter over instants of the fronts between the
//! points, residual. Compare with `brakewave spectrum problems/mode4_mismatch.ron --at mismatch=0.2`.

use std::path::Path;

use brakewave::branch::run::WaveRunner;
use brakewave::output::run::Restart;
use brakewave::simulation::growth::{self, INSTANTS, Listing, Request};
use brakewave::simulation::profile::Profile;
use brakewave::simulation::ring::{Order, RingLaw, RingSetup};
use brakewave::tube::model::Impact;

/// Mismatch, sectors, amplitude of the perturbation, and up to which frequency eigenvalues are listed.
/// Where nothing lifts off the step is smooth in the state; landings need some averaging.
const WAVES: [(f64, &[usize], f64); 4] = [
    (0.2, &[0, 1, 2], 1e-6),
    (0.08, &[0], 1e-4),
    (0.045, &[0], 3e-4),
    (0.02, &[0], 3e-4),
];
const POINTS: [usize; 3] = [96, 192, 384];
const MODE: usize = 4;
const LISTING: Listing = Listing {
    resolved: 5e-3,
    highest: 12.0,
    real: 5e-3,
    most: 4,
};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let argument = std::env::args().nth(1);
    let folder = Path::new(argument.as_deref().unwrap_or("results/mode4_mismatch"));
    let restart = Restart::<WaveRunner>::read(folder)?;
    println!("| δ | sector | points | λ | scatter | residual |\n|---|---|---|---|---|---|");
    for (mismatch, sectors, amplitude) in WAVES {
        let Some(saved) = restart
            .labelled
            .iter()
            .find(|wave| wave.model.mismatch == mismatch)
        else {
            eprintln!("no label at mismatch {mismatch}");
            continue;
        };
        let path = folder.join("profiles").join(format!("{}.csv", saved.label));
        let profile = Profile::read(&path, saved.model.speed(saved.excess))?;
        let setup = RingSetup {
            points: POINTS[0],
            angle: profile.wavelength(),
            order: Order::Fourth,
            time_step: 1.0,
            law: RingLaw::Coulomb,
            impact: Impact::Frictionless,
            watched: false,
        };
        for &sector in sectors {
            for points in POINTS {
                let request = Request {
                    amplitude,
                    ..Request::of_sector(sector, MODE, points)
                };
                let parameters = saved.model.constants();
                let found = growth::averaged(
                    &parameters,
                    &setup,
                    &profile,
                    &request,
                    INSTANTS,
                    &mut || (),
                )?;
                for value in LISTING.of(&request, found) {
                    println!(
                        "| {mismatch} | {sector} | {points} | {:+.5} {:+.5}i | {:.0e} | {:.0e} |",
                        value.re, value.im, value.scatter, value.residual
                    );
                }
            }
        }
    }
    Ok(())
}
