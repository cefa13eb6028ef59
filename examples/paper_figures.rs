//! Counterparts of the figures of the 2008 paper, drawn by the program's own verbs.
//!
//!     cargo build --release && cargo run --release --example paper_figures [DIR]
//!
//! Writes to DIR (default `figures`) the problem of each figure, runs it with the binary beside this example,
//! and gathers each picture, a table of it, and `captions.md`. The paper prints no parameters, so those here
//! are chosen; for its figures 6 and 7 they are fitted to the zone that it shows. docs/theory.md compares.

use std::error::Error;
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// What computes a figure.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Source {
    /// `brakewave run`.
    Branch,
    /// `brakewave simulate`, after a run where the motion begins with a wave.
    Motion,
    /// `brakewave spectrum` with these options.
    Spectrum(&'static [&'static str]),
}

/// A picture to gather.
pub struct Figure {
    /// Name of the file without extension.
    pub name: &'static str,
    /// Problem file, in `problems`.
    pub problem: &'static str,
    /// What is changed in it.
    pub changes: &'static [(&'static str, &'static str)],
    pub source: Source,
    /// Picture in the folder of results, without extension.
    pub picture: &'static str,
    /// Table it is drawn from.
    pub table: &'static str,
    pub caption: &'static str,
}

const TUBE: &str = "ν = 0.3, ξ = 1.5, γ = 1, f = 0.5";

/// The waves of figures 2, 4 and 5 as they stand in the problem file.
const RANGE: &str = "range: (0.0003, 0.2)";
const STOPS: &str = "stop_at: [0.08, 0.045, 0.02, 0.004, 0.001]";
const PLOTS: &str = "plots: [Diagram, Column(\"switches\"), Column(\"amplitude\"), Pressure, Displacement, PhasePlane, Friction]";

pub const FIGURES: [Figure; 10] = [
    Figure {
        name: "figure_2_waves",
        problem: "mode4_mismatch",
        changes: &[(PLOTS, "plots: [Wave], labels: [1, 18]")],
        source: Source::Branch,
        picture: "wave",
        table: "profiles/18.csv",
        caption: "V and U of a slip-stick wave, δ = 0.2, and of a wave with separation, δ = 0.001, whose sequence is \
slip, separation, slip, stick. The table is that of the second.",
    },
    Figure {
        name: "figure_3_stick_slip",
        problem: "annulus_stick_slip",
        changes: &[],
        source: Source::Motion,
        picture: "profiles",
        table: "end.csv",
        caption: "U, V̇ and pressure of the whole tube by finite elements, 132 nodes on the contact line: a stick-slip \
wave of mode 4 that has grown from steady sliding. δ = 1, α = 0.5.",
    },
    Figure {
        name: "figure_3_separation",
        problem: "annulus_separation",
        changes: &[],
        source: Source::Motion,
        picture: "profiles",
        table: "end.csv",
        caption: "The same at δ = 0.2: stick, slip and separation.",
    },
    Figure {
        name: "figure_4_pressure",
        problem: "mode4_mismatch",
        changes: &[
            (RANGE, "range: (0.04, 0.2)"),
            (STOPS, "stop_at: [0.16, 0.12, 0.08, 0.06, 0.05]"),
            (PLOTS, "plots: [Pressure]"),
        ],
        source: Source::Branch,
        picture: "pressure",
        table: "branch.csv",
        caption: "Pressure over a wavelength as the mismatch falls: it touches zero at δ = 0.05023, and below that \
the surfaces part.",
    },
    Figure {
        name: "figure_5_displacement",
        problem: "mode4_mismatch",
        changes: &[
            (RANGE, "range: (0.014, 0.2)"),
            (STOPS, "stop_at: [0.048, 0.04, 0.032, 0.026, 0.018]"),
            (PLOTS, "plots: [Displacement]"),
        ],
        source: Source::Branch,
        picture: "displacement",
        table: "branch.csv",
        caption: "U − δ, wave above wave as the mismatch grows, with the switching points: the slip zone right of \
separation vanishes at δ = 0.02348.",
    },
    Figure {
        name: "figure_6_phase_plane",
        problem: "mode8_reverse",
        changes: &[(
            "plots: [Diagram, Column(\"switches\"), Friction, PhasePlane]",
            "plots: [PhasePlane], labels: [6]",
        )],
        source: Source::Branch,
        picture: "phase_plane",
        table: "profiles/6.csv",
        caption: "V and V̇ of the wave of figure 7: before stick the tube is faster than the shaft.",
    },
    Figure {
        name: "figure_7_reverse",
        problem: "mode8_reverse",
        changes: &[],
        source: Source::Branch,
        picture: "friction",
        table: "profiles/6.csv",
        caption: "Counterpart of figure 7: mode 8 with reverse slip before stick. ν = 0.25, ξ = 1.25, γ = 1; \
f = 0.446 and δ = 0.02677 are where the reverse zone lies from 0.62 to 0.73 of the wavelength 0.785, as read off \
that figure. What agrees is the place of the zone.",
    },
    Figure {
        name: "figure_8_multipliers",
        problem: "mode4_discretised",
        changes: &[],
        source: Source::Spectrum(&["--discretised", "100", "--epsilon", "0.01"]),
        picture: "multipliers",
        table: "stdout",
        caption: "Multipliers from one point to the next of a ring with 100 points per wavelength and friction \
tanh((1 − V̇)/0.01), all sectors, and the leading ones of the eigenfunction problem over them; δ = 0.2.",
    },
    Figure {
        name: "figure_9_velocity",
        problem: "ring_mode4_circle",
        changes: &[
            ("every: 0.02", "every: 0.005"),
            ("snapshots: 4", "snapshots: 24"),
        ],
        source: Source::Motion,
        picture: "velocity",
        table: "end.csv",
        caption: "V̇ round the circle as time goes on, a ring of 768 points, from the unstable mode-4 wave at δ = 0.2 \
perturbed by 0.001 in mode 1.",
    },
    Figure {
        name: "figure_9_phase_plane",
        problem: "ring_mode4_circle",
        changes: &[
            ("every: 0.02", "every: 0.005"),
            ("snapshots: 4", "snapshots: 24"),
        ],
        source: Source::Motion,
        picture: "phase_plane",
        table: "series.csv",
        caption: "The same motion in the phase plane of a point, t from 108 to 120, 200 samples in a unit of time.",
    },
];

impl Figure {
    /// The problem of the figure.
    pub fn text(&self) -> Result<String, Box<dyn Error>> {
        let root = Path::new(env!("CARGO_MANIFEST_DIR"));
        let path = root.join("problems").join(format!("{}.ron", self.problem));
        let mut text = fs::read_to_string(path)?;
        for (from, to) in self.changes {
            if !text.contains(from) {
                return Err(format!("{} has no `{from}`", self.problem).into());
            }
            text = text.replacen(from, to, 1);
        }
        Ok(text)
    }

    /// Computes the figure with the binary, in a folder; the paths of picture and table there.
    pub fn compute(&self, program: &Path, out: &Path) -> Result<[PathBuf; 2], Box<dyn Error>> {
        fs::create_dir_all(out.join("problems"))?;
        let file = format!("problems/{}.ron", self.problem);
        fs::write(out.join(&file), self.text()?)?;
        let folder = format!("results/{}", self.name);
        let brakewave = |arguments: &[&str]| -> Result<String, Box<dyn Error>> {
            let mut command = Command::new(program);
            let output = command.args(arguments).current_dir(out).output()?;
            if output.status.success() {
                return Ok(String::from_utf8(output.stdout)?);
            }
            let said = String::from_utf8_lossy(&output.stderr);
            Err(format!("brakewave {}: {said}", arguments.join(" ")).into())
        };
        let verb = |verb: &str, folder: &str| {
            brakewave(&[verb, &file, "--out", folder, "--force", "--quiet"])
        };
        let picture = out.join(format!("{}.svg", self.name));
        let table = out.join(format!("{}.csv", self.name));
        match self.source {
            Source::Spectrum(options) => {
                let plot = format!("{}.svg", self.name);
                let arguments = [&["spectrum", &file, "--plot", &plot], options].concat();
                fs::write(&table, brakewave(&arguments)?)?;
                return Ok([picture, table]);
            }
            Source::Branch => verb("run", &folder)?,
            Source::Motion => {
                // what moves from steady sliding has no branch
                let wave = format!("results/{}", self.problem);
                if self.text()?.contains("start: Wave(") && !out.join(&wave).exists() {
                    verb("run", &wave)?;
                }
                verb("simulate", &folder)?
            }
        };
        let from = out.join(folder);
        fs::copy(from.join(format!("{}.svg", self.picture)), &picture)?;
        fs::copy(from.join(self.table), &table)?;
        Ok([picture, table])
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let out = PathBuf::from(std::env::args().nth(1).unwrap_or("figures".to_owned()));
    let program = std::env::current_exe()?
        .parent()
        .and_then(Path::parent)
        .map(|folder| folder.join(format!("brakewave{}", std::env::consts::EXE_SUFFIX)))
        .filter(|program| program.exists())
        .ok_or("build the binary first: cargo build --release")?;
    let mut captions =
        format!("# Figures\n\nUnless the caption says otherwise: {TUBE}, no damping.\n\n");
    for figure in &FIGURES {
        let [picture, _] = figure.compute(&program, &out)?;
        let name = figure.name;
        writeln!(
            captions,
            "![{name}]({name}.svg)\n\n**{name}.** {} Data: [{name}.csv]({name}.csv); problem: `{}.ron`.\n",
            figure.caption, figure.problem
        )?;
        println!("{}", picture.display());
    }
    fs::write(out.join("captions.md"), captions)?;
    Ok(())
}
