//! The folder of a certificate: a table of what is proven, and all that it takes to check it.

use std::path::Path;

use serde::Serialize;

use super::layout::CERTIFICATES as TABLE;
use super::store::{self, Growing, Store, StoreError, VERSION, damaged, decode};
use super::theorem::{Stated, enclosing, theorems, written};
use crate::certify::{
    Certificate, Counted, Eigenvalue, Growth, Outcome, Point, Proof, Provable, Stretch, Verdict,
    equilibrium, orbit,
};
use crate::interval::Interval;
use crate::table;

/// What is proven of a kind of orbits, as a table and in words.
pub(crate) trait Certified: Stated {
    /// A row of the table.
    type Row: Serialize + Default;

    /// The row of a point.
    fn row(point: &Point<Self>) -> Self::Row;

    /// What is proven of a point, in lines.
    fn sentence(point: &Point<Self>) -> String;
}

/// What a point is, in every table.
#[derive(Clone, Debug, Default, Serialize)]
pub(crate) struct Head {
    label: usize,
    r#type: String,
    parameter: String,
    low: Option<f64>,
    high: Option<f64>,
}

/// What is said of its orbit, in every table.
#[derive(Clone, Debug, Default, Serialize)]
pub(crate) struct Said {
    unique: Option<f64>,
    inequalities: Option<usize>,
    proven: &'static str,
    why: String,
}

/// What is said of the branch before it, in every table.
#[derive(Clone, Debug, Default, Serialize)]
pub(crate) struct Arc {
    arc: &'static str,
    arc_why: String,
}

impl Head {
    fn new<P: Provable>(point: &Point<P>, parameter: &str, value: Option<Interval>) -> Head {
        let (low, high) = ends(value);
        Head {
            label: point.label,
            r#type: point.kind.to_string(),
            parameter: parameter.to_owned(),
            low,
            high,
        }
    }
}

impl Said {
    fn new<P: Provable>(point: &Point<P>, of: impl Fn(&P) -> (f64, usize)) -> Said {
        let (said, why) = match &point.outcome {
            Outcome::Proven(proof) => (Some(of(proof)), ""),
            Outcome::Open(reason) => (None, &**reason),
        };
        Said {
            unique: said.map(|(unique, _)| unique),
            inequalities: said.map(|(_, inequalities)| inequalities),
            proven: if said.is_some() { "yes" } else { "no" },
            why: why.to_owned(),
        }
    }
}

impl Arc {
    fn new<P: Provable>(point: &Point<P>) -> Arc {
        let (arc, why) = match &point.arc {
            None => ("", ""),
            Some(Stretch::Proven) => ("yes", ""),
            Some(Stretch::Open(reason)) => ("no", &**reason),
        };
        Arc {
            arc,
            arc_why: why.to_owned(),
        }
    }
}

/// What is said of the branch before a point, in a line; `others` are events that are not looked for on it.
fn before<P: Provable>(point: &Point<P>, others: &str) -> String {
    match &point.arc {
        None => String::new(),
        Some(Stretch::Proven) => format!("  no other event but {others} before it: proven\n"),
        Some(Stretch::Open(reason)) => {
            format!("  no other event before it: not proven; {reason}\n")
        }
    }
}

/// The ends of an interval as they are written.
fn ends(interval: Option<Interval>) -> (Option<f64>, Option<f64>) {
    let interval = interval.map(enclosing);
    (
        interval.map(|interval| interval.low),
        interval.map(|interval| interval.high),
    )
}

/// A row of the table of an orbit of a system.
#[derive(Clone, Debug, Default, Serialize)]
pub(crate) struct OrbitRow {
    head: Head,
    period_low: Option<f64>,
    period_high: Option<f64>,
    said: Said,
    outside: Option<usize>,
    angle_low: Option<f64>,
    angle_high: Option<f64>,
    arc: Arc,
}

impl Certified for orbit::Proof {
    type Row = OrbitRow;

    fn row(point: &Point<orbit::Proof>) -> OrbitRow {
        let said = point.proof().map(|proof| &proof.statement);
        let (period_low, period_high) = ends(said.map(|said| said.period));
        let (angle_low, angle_high) = ends(said.and_then(|said| said.angle));
        OrbitRow {
            head: Head::new(point, &point.parameter, said.map(|said| said.parameter)),
            period_low,
            period_high,
            said: Said::new(point, |proof| {
                (proof.statement.unique, proof.statement.inequalities)
            }),
            outside: said.and_then(|said| said.outside),
            angle_low,
            angle_high,
            arc: Arc::new(point),
        }
    }

    fn sentence(point: &Point<orbit::Proof>) -> String {
        let (kind, before) = (point.kind, before(point, "PD and NS"));
        let said = match &point.outcome {
            Outcome::Proven(proof) => &proof.statement,
            Outcome::Open(reason) => return format!("{before}{kind}: not proven; {reason}\n"),
        };
        let angle = said
            .angle
            .map(|angle| format!("; angle in {}", written(angle)));
        let outside = said.outside.map(|outside| match outside {
            0 => "; stable".to_owned(),
            _ => format!("; {outside} multipliers outside the unit circle"),
        });
        format!(
            "{before}{kind}: proven; {} in {}, unique within {:.0e}; period in {}{}{}; {} inequalities proven\n",
            point.parameter,
            written(said.parameter),
            said.unique,
            written(said.period),
            angle.unwrap_or_default(),
            outside.unwrap_or_default(),
            said.inequalities,
        )
    }
}

/// A row of the table of an equilibrium of a system.
#[derive(Clone, Debug, Default, Serialize)]
pub(crate) struct EquilibriumRow {
    head: Head,
    said: Said,
    growing: Option<usize>,
    omega_low: Option<f64>,
    omega_high: Option<f64>,
    lyapunov_low: Option<f64>,
    lyapunov_high: Option<f64>,
    beyond: String,
    persists: &'static str,
    arc: Arc,
}

impl Certified for equilibrium::Proof {
    type Row = EquilibriumRow;

    fn row(point: &Point<equilibrium::Proof>) -> EquilibriumRow {
        let said = point.proof().map(|proof| &proof.statement);
        let (omega_low, omega_high) = ends(said.and_then(|said| said.omega));
        let lyapunov = said.and_then(|said| said.lyapunov);
        let (lyapunov_low, lyapunov_high) = ends(lyapunov.map(|lyapunov| match lyapunov {
            equilibrium::Lyapunov::Within(interval) => interval,
            equilibrium::Lyapunov::Vertical => Interval::ZERO,
        }));
        let beyond = point.proof().and_then(|proof| proof.beyond.as_ref());
        EquilibriumRow {
            head: Head::new(point, &point.parameter, said.map(|said| said.parameter)),
            said: Said::new(point, |proof| {
                (proof.statement.unique, proof.statement.inequalities)
            }),
            growing: said.and_then(|said| said.growing),
            omega_low,
            omega_high,
            lyapunov_low,
            lyapunov_high,
            beyond: beyond.map(|one| one.mode.clone()).unwrap_or_default(),
            persists: beyond.map_or("", |one| if one.persists { "yes" } else { "no" }),
            arc: Arc::new(point),
        }
    }

    fn sentence(point: &Point<equilibrium::Proof>) -> String {
        let (kind, before) = (point.kind, before(point, "HB"));
        let (said, beyond) = match &point.outcome {
            Outcome::Proven(proof) => (&proof.statement, &proof.beyond),
            Outcome::Open(reason) => return format!("{before}{kind}: not proven; {reason}\n"),
        };
        let beyond = beyond.as_ref().map(|beyond| match beyond.persists {
            true => format!("; persistence, beyond it `{}`", beyond.mode),
            false => format!("; a nonsmooth fold with `{}`", beyond.mode),
        });
        let omega = said.omega.map(|omega| format!("; ω in {}", written(omega)));
        let lyapunov = said.lyapunov.map(|lyapunov| match lyapunov {
            equilibrium::Lyapunov::Within(interval) => format!("; l₁ in {}", written(interval)),
            equilibrium::Lyapunov::Vertical => "; a vertical family".to_owned(),
        });
        let growing = said.growing.map(|growing| match growing {
            1 => "; 1 eigenvalue grows".to_owned(),
            _ => format!("; {growing} eigenvalues grow"),
        });
        format!(
            "{before}{kind}: proven; {} in {}, unique within {:.0e}{}{}{}{}; {} inequalities proven\n",
            point.parameter,
            written(said.parameter),
            said.unique,
            beyond.unwrap_or_default(),
            omega.unwrap_or_default(),
            lyapunov.unwrap_or_default(),
            growing.unwrap_or_default(),
            said.inequalities,
        )
    }
}

/// A row of the table of a wave.
#[derive(Clone, Debug, Default, Serialize)]
pub(crate) struct Row {
    head: Head,
    speed_low: Option<f64>,
    speed_high: Option<f64>,
    said: Said,
    unstable: &'static str,
    arc: Arc,
    growing: Option<usize>,
    stable: &'static str,
    stable_why: String,
}

impl Certified for Proof {
    type Row = Row;

    fn row(point: &Point) -> Row {
        let proof = point.proof();
        let said = proof.map(|proof| &proof.statement);
        let (speed_low, speed_high) = ends(said.map(|said| said.speed));
        let unstable = proof.is_some_and(Proof::is_unstable);
        let (growing, stable, stable_why) = match &point.growth {
            None => (None, "", String::new()),
            Some(Counted::Open(reason)) => (None, "", reason.clone()),
            Some(Counted::Proven(growth)) => {
                let stable = match growth.verdict {
                    Verdict::Stable { .. } => "yes",
                    Verdict::Unstable => "no",
                    Verdict::Neutral | Verdict::HighFrequency => "",
                };
                let why = undecided(growth.verdict).unwrap_or("").to_owned();
                (Some(growth.on_circle()), stable, why)
            }
        };
        let name = point.parameter.column();
        Row {
            head: Head::new(point, name, said.map(|said| said.parameter)),
            speed_low,
            speed_high,
            said: Said::new(point, |proof| {
                (proof.statement.unique, proof.statement.inequalities)
            }),
            unstable: if unstable { "yes" } else { "" },
            arc: Arc::new(point),
            growing,
            stable,
            stable_why,
        }
    }

    /// Further lines are for its eigenvalues and for the branch before it.
    fn sentence(point: &Point) -> String {
        let symbol = point.parameter.symbol();
        let mut lines = before(point, "HB and BP");
        match &point.outcome {
            Outcome::Proven(proof) => {
                let said = &proof.statement;
                let omega = said.omega.map(|omega| format!("; ω in {}", written(omega)));
                lines.push_str(&format!(
                    "{}: proven; {symbol} in {}, unique within {:.0e}; c in {}{}; {} inequalities proven\n",
                    point.kind,
                    written(said.parameter),
                    said.unique,
                    written(said.speed),
                    omega.unwrap_or_default(),
                    said.inequalities
                ));
                for eigenvalue in &proof.eigenvalues {
                    let Eigenvalue {
                        sector,
                        growth,
                        omega,
                        ..
                    } = eigenvalue;
                    let unstable = if growth.is_positive() {
                        ": the wave is unstable"
                    } else {
                        ""
                    };
                    lines.push_str(&format!(
                        "  eigenvalue in sector {sector}: Re λ in {}, Im λ in {}{unstable}\n",
                        written(*growth),
                        written(*omega),
                    ));
                }
            }
            Outcome::Open(reason) => {
                lines.push_str(&format!("{}: not proven; {reason}\n", point.kind))
            }
        }
        match &point.growth {
            Some(Counted::Proven(growth)) => lines.push_str(&growing(growth)),
            Some(Counted::Open(reason)) => {
                lines.push_str(&format!("  growing eigenvalues not counted; {reason}\n"));
            }
            None => {}
        }
        lines
    }
}

/// Why stability is undecided where no eigenvalue grows in the window.
fn undecided(verdict: Verdict) -> Option<&'static str> {
    match verdict {
        Verdict::Stable { .. } | Verdict::Unstable => None,
        Verdict::Neutral => Some("undecided: an eigenvalue is on the imaginary axis"),
        Verdict::HighFrequency => Some("undecided: growth beyond the window is not excluded"),
    }
}

/// The eigenvalues that grow, in a line.
fn growing(growth: &Growth) -> String {
    let Growth {
        window,
        counts,
        leading,
        verdict,
        ..
    } = growth;
    let sectors: Vec<String> = counts.iter().map(usize::to_string).collect();
    let leads: Vec<String> = leading.iter().map(|one| one.sector.to_string()).collect();
    let leads = match leads.is_empty() {
        true => String::new(),
        false => format!("; the eigenvalues of sectors {} lead", leads.join(" ")),
    };
    let follows = match verdict {
        Verdict::Stable { beyond } => {
            format!("none beyond, by a bound from |λ| = {beyond:.4} on: the wave is stable")
        }
        Verdict::Unstable => "the wave is unstable".to_owned(),
        verdict => undecided(*verdict).unwrap_or("").to_owned(),
    };
    format!(
        "  growing with |Im λ| up to {window}: {}, in sectors from 0 on {}{leads}; {follows}\n",
        growth.on_circle(),
        sectors.join(" "),
    )
}

#[derive(Debug)]
pub(crate) struct CertificateFolder {
    store: Store,
    table: Growing,
}

impl CertificateFolder {
    pub(crate) const FILE: &'static str = "certificate.ron";
    pub(crate) const THEOREMS: &'static str = "theorem.md";

    /// Begins in place of an earlier one.
    ///
    /// # Errors
    /// When a file cannot be written, like all that follow.
    pub(crate) fn create<P: Certified>(store: Store) -> Result<CertificateFolder, StoreError> {
        store.begin(&[TABLE, Self::FILE, Self::THEOREMS], Vec::new(), None)?;
        let table = store.table(TABLE, &table::header::<P::Row>(), None)?;
        Ok(CertificateFolder { store, table })
    }

    pub(crate) fn write<P: Certified>(&mut self, point: &Point<P>) -> Result<(), StoreError> {
        self.table.row(&P::row(point))
    }

    pub(crate) fn finish<P: Certified>(
        &self,
        certificate: &Certificate<P>,
    ) -> Result<(), StoreError> {
        let theorems = theorems(&certificate.points, certificate.system.as_ref());
        self.store.replace(Self::THEOREMS, theorems.as_bytes())?;
        let path = self.store.path().join(Self::FILE);
        let text = ron::ser::to_string_pretty(
            certificate as &dyn erased_serde::Serialize,
            ron::ser::PrettyConfig::default(),
        );
        let text = text.map_err(|error| damaged(&path, error.to_string()))?;
        self.store.replace(Self::FILE, text.as_bytes())
    }
}

/// Whether the theorems beside a certificate, if there are any, are those of its points. Another version may word them otherwise.
///
/// # Errors
/// When they cannot be read.
pub(crate) fn theorems_agree<P: Certified>(
    path: &Path,
    certificate: &Certificate<P>,
) -> Result<bool, StoreError> {
    let path = path.with_file_name(CertificateFolder::THEOREMS);
    if certificate.version != VERSION || !path.is_file() {
        return Ok(true);
    }
    let expected = theorems(&certificate.points, certificate.system.as_ref());
    Ok(store::read(&path)?.lines().eq(expected.lines()))
}

/// Whether a table beside a certificate, if there is one, has the rows of its points: the same cells, but for ends of intervals
/// that may lie farther out.
///
/// # Errors
/// When it cannot be read.
pub(crate) fn table_agrees<P: Certified>(
    path: &Path,
    points: &[Point<P>],
) -> Result<bool, StoreError> {
    if !path.is_file() {
        return Ok(true);
    }
    let expected = table::table(points.iter().map(P::row));
    let expected = table::Table::parse(expected.as_bytes());
    let expected = expected.map_err(|error| damaged(path, error.to_string()))?;
    let bytes = store::bytes(path)?;
    let stored = table::Table::parse(&bytes);
    let stored = stored.map_err(|error| damaged(path, error.to_string()))?;
    // cells without a column, or a line without an end, are read by none but stand there
    let width = stored.columns().count();
    let is_whole = |row: usize| stored.row(row).count() == width;
    let is_whole = bytes.ends_with(b"\n") && (0..stored.len()).all(is_whole);
    let agrees = |row: usize, column: &str| {
        let ends: [Option<f64>; 2] = [&stored, &expected].map(|table| table.field(row, column));
        match ends {
            [Some(stored), None] if stored.is_infinite() => expected.text(row, column).is_empty(),
            [Some(stored), Some(expected)] if column.ends_with("low") => stored <= expected,
            [Some(stored), Some(expected)] if column.ends_with("high") => stored >= expected,
            // a number may be written otherwise
            [Some(stored), Some(expected)] => stored == expected,
            _ => stored.text(row, column) == expected.text(row, column),
        }
    };
    Ok(is_whole
        && stored.columns().eq(expected.columns())
        && stored.len() == expected.len()
        && (0..stored.len()).all(|row| expected.columns().all(|column| agrees(row, column))))
}

/// A certificate of any kind.
pub(crate) enum Read {
    Waves(Certificate),
    Orbits(Certificate<orbit::Proof>),
    Equilibria(Certificate<equilibrium::Proof>),
}

/// Reads a certificate.
///
/// # Errors
/// When it cannot be read, or is none.
pub(crate) fn read(path: &Path) -> Result<Read, StoreError> {
    if let Ok(certificate) = decode(path) {
        return Ok(Read::Orbits(Certificate::spread(certificate)));
    }
    if let Ok(certificate) = decode(path) {
        return Ok(Read::Equilibria(Certificate::spread(certificate)));
    }
    // that of waves says what is wrong with one of no kind
    Ok(Read::Waves(decode(path)?))
}
