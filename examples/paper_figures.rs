//! Counterparts of figures of the 2008 paper, drawn by the program's own verbs.
//!
//!     cargo build --release && cargo run --release --example paper_figures [DIR]
//!
//! Runs the problems named below with the binary beside this example, and gathers in DIR (default
//! `figures`) each picture, a table of it, and `captions.md`: what is shown, with which parameters, and
//! what can be compared. The paper prints no parameters, so those here are chosen; for its figure 7 they
//! are fitted to the zone that it shows. Figures 7, 8 and 9 are named by their numbers, the others by
//! their subject: what the paper's other figures treat, without a claim that curves agree.

use std::error::Error;
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// A picture to gather.
pub struct Figure {
    /// Name of the file without extension.
    pub name: &'static str,
    /// Problem file, in `problems`.
    pub problem: &'static str,
    /// Whether the motion in time is wanted, too.
    pub simulated: bool,
    /// Picture in the folder of results, without extension.
    pub picture: &'static str,
    /// Table it is drawn from.
    pub table: &'static str,
    pub caption: &'static str,
}

pub const FIGURES: [Figure; 10] = [
    Figure {
        name: "annulus_stick_slip",
        problem: "annulus_stick_slip",
        simulated: true,
        picture: "profiles",
        table: "end.csv",
        caption: "Whole tube by finite elements, 132 × 8: a stick-slip wave of mode 4 that has grown \
from steady sliding; tangential velocity and pressure on the contact line. ν = 0.3, ξ = 1.5, γ = 1, f = 0.5, δ = 1, \
α = 0.5. A counterpart of the paper's finite-element calculation, whose parameters are not printed.",
    },
    Figure {
        name: "annulus_separation",
        problem: "annulus_separation",
        simulated: true,
        picture: "profiles",
        table: "end.csv",
        caption: "The same at δ = 0.2: stick, slip and separation.",
    },
    Figure {
        name: "phase_plane",
        problem: "mode4_mismatch",
        simulated: false,
        picture: "phase_plane",
        table: "profiles/1.csv",
        caption: "Mode-4 waves in the phase plane (V, V̇) as the mismatch falls from 0.2; ν = 0.3, ξ = 1.5, \
γ = 1, f = 0.5. The table is that of δ = 0.2: slip-stick, closed by the straight line V̇ = 1.",
    },
    Figure {
        name: "pressure",
        problem: "mode4_mismatch",
        simulated: false,
        picture: "pressure",
        table: "profiles/1.csv",
        caption: "Pressure of the same waves over a wavelength: constant in stick, zero in separation.",
    },
    Figure {
        name: "speed",
        problem: "mode4_mismatch",
        simulated: false,
        picture: "diagram",
        table: "branch.csv",
        caption: "Speed of the same waves. It does not depend on the mismatch while they slip and stick; the \
sequence of regimes changes at the marked events: reverse slip opens, then separation.",
    },
    Figure {
        name: "figure_7_reverse",
        problem: "mode8_reverse",
        simulated: false,
        picture: "friction",
        table: "profiles/6.csv",
        caption: "Counterpart of figure 7: mode 8 with reverse slip before stick. ν = 0.25, ξ = 1.25, γ = 1; \
f = 0.446 and δ = 0.02677 are where the reverse zone lies from 0.62 to 0.73 of the wavelength 0.785, as read off \
that figure. What agrees is the place of the zone.",
    },
    Figure {
        name: "eigenvalues",
        problem: "mode4_stability",
        simulated: false,
        picture: "spectrum",
        table: "spectrum.csv",
        caption: "Eigenvalues of the mode-4 waves in all sectors. Undamped slip-stick waves are unstable.",
    },
    Figure {
        name: "figure_8_multipliers",
        problem: "mode4_stability",
        simulated: false,
        picture: "multipliers",
        table: "spectrum.csv",
        caption: "Counterpart of figure 8: Floquet multipliers e^{λT} with the unit circle and an enlarged view near 1, \
here of the first wave of the branch from the eigenfunction problem, in all sectors. The paper's are those of a discretised \
ring; `brakewave spectrum --discretised` has these, and docs/discretised.md their convergence.",
    },
    Figure {
        name: "figure_9_irregular",
        problem: "ring_mode4_circle",
        simulated: true,
        picture: "space_time",
        table: "series.csv",
        caption: "Counterpart of figure 9: regimes over place and time, on the whole circle of a ring with 768 \
points, from the unstable mode-4 wave at δ = 0.2 (parameters as above) perturbed by 0.001 in mode 1. As there, an \
irregular motion develops.",
    },
    Figure {
        name: "figure_9_regular",
        problem: "ring_damped_circle",
        simulated: true,
        picture: "space_time",
        table: "series.csv",
        caption: "The same with α = 0.316, where the wave is stable on the whole circle: it forgets the \
perturbation. The paper's waves have no damping.",
    },
];

fn main() -> Result<(), Box<dyn Error>> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let out = PathBuf::from(std::env::args().nth(1).unwrap_or("figures".to_owned()));
    let program = std::env::current_exe()?
        .parent()
        .and_then(Path::parent)
        .map(|folder| folder.join(format!("brakewave{}", std::env::consts::EXE_SUFFIX)))
        .filter(|program| program.exists())
        .ok_or("build the binary first: cargo build --release")?;
    fs::create_dir_all(&out)?;
    let verb = |verb: &str, problem: &str| -> Result<(), Box<dyn Error>> {
        let status = Command::new(&program)
            .arg(verb)
            .arg(root.join("problems").join(format!("{problem}.ron")))
            .args(["--force", "--quiet"])
            .current_dir(&out)
            .status()?;
        if status.success() {
            Ok(())
        } else {
            Err(format!("brakewave {verb} {problem}: {status}").into())
        }
    };
    let mut done: Vec<(&str, &str)> = Vec::new();
    let mut captions = String::from("# Figures\n\n");
    for figure in &FIGURES {
        let mut wanted = Vec::new();
        // what only moves in time has no branch
        if !figure.problem.starts_with("annulus") {
            wanted.push("run");
        }
        if figure.simulated {
            wanted.push("simulate");
        }
        for name in wanted {
            if !done.contains(&(name, figure.problem)) {
                verb(name, figure.problem)?;
                done.push((name, figure.problem));
            }
        }
        let end = if figure.simulated { "_simulation" } else { "" };
        let folder = out.join("results").join(format!("{}{end}", figure.problem));
        let picture = format!("{}.svg", figure.name);
        let table = format!("{}.csv", figure.name);
        fs::copy(
            folder.join(format!("{}.svg", figure.picture)),
            out.join(&picture),
        )?;
        fs::copy(folder.join(figure.table), out.join(&table))?;
        writeln!(
            captions,
            "![{}]({picture})\n\n**{}.** {} Data: [{table}]({table}); problem: `{}.ron`.\n",
            figure.name, figure.name, figure.caption, figure.problem
        )?;
        println!("{}", out.join(picture).display());
    }
    fs::write(out.join("captions.md"), captions)?;
    Ok(())
}
