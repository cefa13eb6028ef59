//! Waves with material damping β > 0, confirmed without their equations of third order.
//!
//!     cargo run --release --example material_damping
//!     cargo run --release --example material_damping -- results/x
//!
//! First the discretised ring at β = 0.005 (mode 4, ν = 0.3, ξ = 1.5, γ = 1, f = 0.5, δ = 0.4): its speed and
//! the eigenvalues next to the exact ones, by points per wavelength n and width ε of the friction law.
//! Then, for every labelled wave with β > 0 of a result folder with profiles, what the simulated ring says:
//! growth rates and frequencies by sector and points per wavelength.

use std::path::Path;

use brakewave::branch::run::WaveRunner;
use brakewave::discretised::{RingSettings, solve};
use brakewave::output::run::Restart;
use brakewave::simulation::growth::{self, Listing, Request};
use brakewave::simulation::profile::Profile;
use brakewave::simulation::ring::{Order, RingLaw, RingSetup};
use brakewave::tube::model::coefficients::Geometry;
use brakewave::tube::model::{Damping, Impact, Model};
use faer::c64;

const MODEL: Model = Model {
    damping: Damping {
        mass: 0.0,
        stiffness: 0.005,
    },
    ..Model::tube(
        Geometry {
            nu: 0.3,
            xi: 1.5,
            gamma: 1.0,
        },
        0.5,
        0.4,
    )
};
const MODE: u32 = 4;
/// Of the boundary-value problem and the eigenfunction problem: `brakewave spectrum`.
const SPEED: f64 = -1.261_254_202_768_949;
const EXACT: [(u32, c64); 4] = [
    (0, c64::new(-0.13443754360655616, 2.5264162621025754)),
    (1, c64::new(0.01795743841199849, -0.4043702749985958)),
    (1, c64::new(-0.0037914385605972035, 1.4034596197826414)),
    (2, c64::new(0.04747830426871439, 0.8515475024256878)),
];
const GRIDS: [(usize, f64); 8] = [
    (50, 0.02),
    (100, 0.01),
    (200, 0.005),
    (400, 0.0025),
    (50, 1e-5),
    (100, 1e-5),
    (200, 1e-5),
    (400, 1e-5),
];
const HIGHEST: f64 = 12.0;

const POINTS: [usize; 3] = [48, 96, 192];
const PAIRS: usize = 40;
const INSTANTS: usize = 2;
const LISTING: Listing = Listing {
    resolved: 1e-3,
    highest: HIGHEST,
    real: 1e-3,
    most: 4,
};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    discretised()?;
    if let Some(folder) = std::env::args_os().nth(1) {
        simulated(Path::new(&folder))?;
    }
    Ok(())
}

fn discretised() -> Result<(), Box<dyn std::error::Error>> {
    println!("| n | ε | c | error c | sector 0 | error 0 | error 1a | error 1b | error 2 |");
    println!("|---|---|---|---|---|---|---|---|---|");
    let mut before: Option<(f64, Vec<c64>)> = None;
    for (points, epsilon) in GRIDS {
        let settings = RingSettings {
            points,
            epsilon,
            ..RingSettings::default()
        };
        let wave = solve(&MODEL, MODE, &settings)?;
        let mut found = Vec::new();
        for (sector, exact) in EXACT {
            let values = wave.eigenvalues(sector, HIGHEST, usize::MAX)?;
            let distance = |value: &c64| (value - exact).norm();
            let nearest = values
                .into_iter()
                .min_by(|one, other| distance(one).total_cmp(&distance(other)));
            found.push(nearest.ok_or("a sector without eigenvalues")?);
        }
        row(&format!("{points} | {epsilon}"), wave.speed, &found);
        if let Some((speed, coarse)) = before.take().filter(|_| points == 400) {
            let beyond: Vec<c64> = found
                .iter()
                .zip(&coarse)
                .map(|(fine, coarse)| fine + (fine - coarse) / 3.0)
                .collect();
            let speed = wave.speed + (wave.speed - speed) / 3.0;
            row(
                &format!("200, 400 extrapolated | {epsilon}"),
                speed,
                &beyond,
            );
        }
        if points == 200 && epsilon == 1e-5 {
            before = Some((wave.speed, found));
        }
    }
    Ok(())
}

fn row(name: &str, speed: f64, found: &[c64]) {
    let errors: Vec<String> = found
        .iter()
        .zip(EXACT)
        .map(|(found, (_, exact))| format!("{:.1e}", (found - exact).norm()))
        .collect();
    println!(
        "| {name} | {speed:.7} | {:.1e} | {:.6} {:+.6}i | {} |",
        (speed - SPEED).abs(),
        found[0].re,
        found[0].im,
        errors.join(" | ")
    );
}

fn simulated(folder: &Path) -> Result<(), Box<dyn std::error::Error>> {
    println!("\n| label | β | sector | points | λ | scatter |\n|---|---|---|---|---|---|");
    for saved in Restart::<WaveRunner>::read(folder)?.labelled {
        let parameters = saved.model.constants();
        let path = folder.join("profiles").join(format!("{}.csv", saved.label));
        if parameters.stiffness_damping == 0.0 || !path.exists() {
            continue;
        }
        let profile = Profile::read(&path, saved.model.speed(saved.excess))?;
        let mode = (std::f64::consts::TAU / profile.wavelength()).round() as usize;
        let setup = RingSetup {
            points: POINTS[0],
            angle: profile.wavelength(),
            order: Order::Fourth,
            time_step: 1.0,
            law: RingLaw::Coulomb,
            impact: Impact::Frictionless,
            watched: false,
        };
        for sector in 0..=mode / 2 {
            for points in POINTS {
                let request = Request {
                    courant: 0.4,
                    pairs: PAIRS,
                    ..Request::of_sector(sector, mode, points)
                };
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
                        "| {} | {} | {sector} | {points} | {:+.6} {:+.6}i | {:.0e} |",
                        saved.label,
                        parameters.stiffness_damping,
                        value.re,
                        value.im,
                        value.scatter
                    );
                }
            }
        }
    }
    Ok(())
}
