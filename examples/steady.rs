//! What the displacement field of the reduced model costs: steady sliding of the tube itself against
//! the reduced model over Poisson's ratio and the ratio of the radii, as Markdown.
//!
//! `cargo run --release --example steady`

use brakewave::tube::model::coefficients::Geometry;
use brakewave::tube::model::{Damping, FrictionLaw};
use brakewave::tube::steady::radial::Radial;
use brakewave::tube::steady::{SteadySettings, mode};

const RATIOS: [f64; 6] = [1.02, 1.1, 1.25, 1.5, 2.0, 3.0];
const POISSON: [f64; 6] = [0.0, 0.15, 0.3, 0.4, 0.45, 0.49];
const FRICTION: f64 = 0.5;
/// Damping for the Hopf points: to mass alone, so that their ratio does not depend on its size
/// while it is small.
const DAMPING: Damping = Damping {
    mass: 1e-3,
    stiffness: 0.0,
};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    for k in [1, 4, 8] {
        println!("### Mode {k}\n");
        print!("| ν |");
        RATIOS.iter().for_each(|xi| print!(" ξ = {xi} |"));
        println!("\n|---|{}", "---|".repeat(RATIOS.len()));
        for nu in POISSON {
            print!("| {nu} |");
            for xi in RATIOS {
                print!(" {} |", cell(Geometry { nu, xi, gamma: 1.0 }, k)?);
            }
            println!();
        }
        println!();
    }
    println!("### Convergence in the radial order\n");
    println!(
        "Relative error of κ of the fundamental family against order 60, ν = 0.3, f = {FRICTION}.\n"
    );
    let cases = [(1.5, 1), (1.5, 4), (1.5, 16), (1.02, 4), (3.0, 4), (5.0, 8)];
    print!("| order |");
    cases
        .iter()
        .for_each(|(xi, k)| print!(" ξ = {xi}, k = {k} |"));
    println!("\n|---|{}", "---|".repeat(cases.len()));
    for order in [1, 2, 3, 4, 6, 8, 12, 16, 24, 32] {
        print!("| {order} |");
        for (xi, k) in cases {
            let tube = Geometry {
                nu: 0.3,
                xi,
                gamma: 1.0,
            };
            let kappa = |order| -> Result<_, Box<dyn std::error::Error>> {
                Ok(Radial::new(&tube, k, order).lowest(FRICTION, 1)?[0].kappa)
            };
            let (here, exact) = (kappa(order)?, kappa(60)?);
            print!(" {:.0e} |", (here - exact).norm() / exact.norm());
        }
        println!();
    }
    Ok(())
}

/// Error of ω, ratios of growth rate and Hopf friction (reduced to full), error of the field; a
/// star where the growing waves run in opposite directions.
fn cell(tube: Geometry, k: u32) -> Result<String, Box<dyn std::error::Error>> {
    let coefficients = tube.coefficients();
    let solve = |damping| {
        let settings = SteadySettings {
            friction: FRICTION,
            law: FrictionLaw::Coulomb,
            mismatch: 0.2,
            damping,
            families: 1,
            order: None,
        };
        mode(&coefficients, Some(&tube), k, &settings)
    };
    let undamped = solve(Damping::default())?;
    let damped = solve(DAMPING)?;
    let (Some(full), Some(damped_full)) = (undamped.full, damped.full) else {
        return Err("the tube has no full model".into());
    };
    let (one, other) = (undamped.reduced.wave, full.fundamental.wave);
    let hopf = match (damped.reduced.hopf, damped_full.fundamental.hopf) {
        (Some(reduced), Some(full)) => format!("{:.2}", reduced.friction / full.friction),
        _ => "–".into(),
    };
    let star = if one.speed * other.speed < 0.0 {
        " \\*"
    } else {
        ""
    };
    Ok(format!(
        "{:+.0} %, {:.2}, {hopf}, {:.2}{star}",
        100.0 * (one.omega.abs() / other.omega.abs() - 1.0),
        one.growth / other.growth,
        full.field_error,
    ))
}
