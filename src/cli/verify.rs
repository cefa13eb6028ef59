//! `brakewave certify --verify`: a stored certificate is proven again, without continuation, and compared with what stands beside it.
//!
//! What is found is formed as data, a [`Verification`]; its `Display` is what the verb says.

use std::fmt::{self, Display, Formatter};
use std::path::Path;

use super::failure::{VerbExit, VerbFailure};
use super::options::read_any;
use super::print;
use super::progress::each;
use crate::certify::{
    self, ArcOutcome, Certificate, CertifiedPoint, Counted, ProofOutcome, Provable, RefusedProof,
    RequestedWaves, equilibrium, orbit,
};
use crate::orbit::EventType;
use crate::output::certify::{
    CertificateFolder, Certified, Read, read, table_agrees, theorems_agree,
};
use crate::output::layout::CERTIFICATES;
use crate::output::store::{SOURCE, StoreError, VERSION};
use crate::problem::Any;

/// Whether a stored point, and the arc that leads to it, is what it says.
enum PointVerdict {
    /// All that is stated is proven again.
    Verified,
    /// A statement on the point does not hold, or its problem file says otherwise.
    Refused(RefusedProof),
    /// The arc before it is stated otherwise than it is proven.
    RefusedArc,
    /// The certificate has no proof of it, for this reason.
    NotProven(String),
    /// The certificate has no proof of the arc before it, for this reason.
    ArcNotProven(String),
    /// The certificate has no count of what grows there, for this reason.
    NotCounted(String),
}

/// A comparison that could not be made.
enum NotCompared {
    /// With the problem file, which is not beside the certificate.
    Problem,
    /// With the table, which is not beside the certificate.
    Table,
    /// Of the theorems, which are not those of this version: the certificate names another one.
    Theorems(String),
    /// Of the units of states and time, with what the branch begins with.
    Units,
    /// Of the numbers that are those of an earlier run, with which the branch begins.
    Numbers,
}

/// Why a certificate is refused as a whole.
#[derive(Debug, thiserror::Error)]
enum RefusedCertificate {
    #[error("nothing is stated")]
    Empty,
    #[error("it is not that of the problem file")]
    OtherProblem,
    #[error("its labels do not ascend")]
    Labels,
    #[error("{0}")]
    Units(RefusedProof),
}

/// What is found of a certificate that is not refused as a whole.
struct Verification {
    /// Label and type of every point, with what is found of it.
    points: Vec<(usize, EventType, PointVerdict)>,
    /// Files that say something else than the certificate.
    contradicting: Vec<&'static str>,
    not_compared: Vec<NotCompared>,
}

impl Verification {
    /// Whether all that is stated holds, and was compared with all that it should agree with.
    fn is_complete(&self) -> bool {
        let is_verified = |(_, _, verdict): &(_, _, PointVerdict)| match verdict {
            PointVerdict::Verified => true,
            PointVerdict::Refused(_)
            | PointVerdict::RefusedArc
            | PointVerdict::NotProven(_)
            | PointVerdict::ArcNotProven(_)
            | PointVerdict::NotCounted(_) => false,
        };
        // a theorem has the numbers of its certificate: those of an earlier run are missing in no file
        let is_missing = |one: &NotCompared| !matches!(one, NotCompared::Numbers);
        self.points.iter().all(is_verified)
            && self.contradicting.is_empty()
            && !self.not_compared.iter().any(is_missing)
    }
}

impl Display for PointVerdict {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            PointVerdict::Verified => write!(f, "verified"),
            PointVerdict::Refused(reason) => write!(f, "refused: {reason}"),
            PointVerdict::RefusedArc => {
                write!(
                    f,
                    "refused: the arc before it is said otherwise than what is proven"
                )
            }
            PointVerdict::NotProven(reason) => write!(f, "not proven: {reason}"),
            PointVerdict::ArcNotProven(reason) => write!(f, "before it not proven: {reason}"),
            PointVerdict::NotCounted(reason) => {
                write!(f, "growing eigenvalues not counted: {reason}")
            }
        }
    }
}

impl Display for NotCompared {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            NotCompared::Problem => write!(
                f,
                "{SOURCE}: not compared: it is not there, so that nothing says of what problem the equations, numbers, units and \
                 values are"
            ),
            NotCompared::Table => write!(f, "{CERTIFICATES}: not compared: it is not there"),
            NotCompared::Theorems(version) => write!(
                f,
                "{}: not compared: it is of version {version:?}, whose words are not known here",
                CertificateFolder::THEOREMS
            ),
            NotCompared::Units => write!(
                f,
                "units: not compared: what the branch begins with is not proven first"
            ),
            NotCompared::Numbers => write!(
                f,
                "numbers: not compared: the branch begins with an earlier run, whose numbers and units do not stand in {SOURCE}: nothing \
                 says whether those of the certificate are they"
            ),
        }
    }
}

impl Display for Verification {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        for (label, kind, verdict) in &self.points {
            writeln!(f, "{label} {kind}: {verdict}")?;
        }
        for file in &self.contradicting {
            writeln!(
                f,
                "{file}: refused: it says something else than the certificate"
            )?;
        }
        for comparison in &self.not_compared {
            writeln!(f, "{comparison}")?;
        }
        Ok(())
    }
}

/// Checks a stored certificate, with the table and the problem file beside it.
pub(super) fn verify(path: &Path, quiet: bool) -> Result<VerbExit, VerbFailure> {
    let file = match path.is_dir() {
        true => path.join(CertificateFolder::FILE),
        false => path.to_owned(),
    };
    let source = file.with_file_name(SOURCE);
    let problem = source.is_file().then(|| read_any(&source)).transpose()?;
    let certificate = read(&file)?;
    let verified = match &certificate {
        read if read.is_empty() => Err(RefusedCertificate::Empty),
        read if !belongs(read, problem.as_ref()) => Err(RefusedCertificate::OtherProblem),
        read => verified(&file, read, problem.as_ref(), quiet)?,
    };
    let (report, is_complete) = match &verified {
        Ok(verification) => (verification.to_string(), verification.is_complete()),
        Err(reason) => (format!("certificate: refused: {reason}\n"), false),
    };
    if !quiet {
        print(&report)?;
    }
    Ok(match is_complete {
        true => VerbExit::Done,
        false => VerbExit::Unmet,
    })
}

/// Whether a certificate states what a branch of this problem may have.
fn belongs(read: &Read, problem: Option<&(Any, String)>) -> bool {
    match (read, problem) {
        (_, None) => true,
        (Read::Waves(_), Some((Any::Tube(problem), _))) => problem.continuation.is_some(),
        (Read::Waves(_), _) | (_, Some((Any::Tube(_), _))) => false,
        (read, Some((Any::System(problem), _))) => {
            problem.continuation.is_some()
                && !(problem.orbit.is_none() && problem.equilibrium.is_none())
                && matches!(read, Read::Equilibria(_)) == problem.equilibrium.is_some()
        }
    }
}

/// A certificate of any kind, verified, with the problem that it belongs to.
fn verified(
    file: &Path,
    read: &Read,
    problem: Option<&(Any, String)>,
    quiet: bool,
) -> Result<Result<Verification, RefusedCertificate>, VerbFailure> {
    let of_tube = match problem {
        Some((Any::Tube(problem), text)) => Some((problem, text)),
        _ => None,
    };
    let of_system = match problem {
        Some((Any::System(problem), text)) => Some((problem, text)),
        _ => None,
    };
    match read {
        Read::Waves(certificate) => Verifier {
            requested: of_tube.and_then(|(problem, text)| RequestedWaves::new(problem, text)),
            is_restarted: RequestedWaves::is_restarted,
            check_units: |_, _| Ok(true),
            check: RequestedWaves::check,
            proven_again: certify::proven_again,
        }
        .verify(file, certificate, quiet),
        Read::Orbits(certificate) => Verifier {
            requested: of_system
                .and_then(|(problem, text)| orbit::RequestedOrbits::new(problem, text)),
            is_restarted: orbit::RequestedOrbits::is_restarted,
            check_units: orbit::RequestedOrbits::check_units,
            check: orbit::RequestedOrbits::check,
            proven_again: orbit::proven_again,
        }
        .verify(file, certificate, quiet),
        Read::Equilibria(certificate) => Verifier {
            requested: of_system
                .and_then(|(problem, text)| equilibrium::RequestedEquilibria::new(problem, text)),
            is_restarted: equilibrium::RequestedEquilibria::is_restarted,
            check_units: equilibrium::RequestedEquilibria::check_units,
            check: equilibrium::RequestedEquilibria::check,
            proven_again: equilibrium::proven_again,
        }
        .verify(file, certificate, quiet),
    }
}

/// What statements of one kind are verified with.
struct Verifier<P: Provable, R> {
    /// What the problem file says of its branch; `None` where it is not beside the certificate.
    requested: Option<R>,
    /// Whether the branch begins with an earlier run, whose numbers do not stand in the file.
    is_restarted: fn(&R) -> bool,
    /// Whether the units of all points are those of the branch; `false` where nothing tells.
    check_units: fn(&R, &[CertifiedPoint<P>]) -> Result<bool, RefusedProof>,
    /// Whether a point is one of the branch.
    check: fn(&R, &CertifiedPoint<P>, &P) -> Result<(), RefusedProof>,
    /// Proves a point again.
    proven_again: fn(&CertifiedPoint<P>, &P) -> Result<P, RefusedProof>,
}

impl<P: Certified + Send + Sync, R: Sync> Verifier<P, R>
where
    CertifiedPoint<P>: Send + Sync,
{
    /// What is found of a certificate, or why it is refused as a whole.
    fn verify(
        &self,
        file: &Path,
        certificate: &Certificate<P>,
        quiet: bool,
    ) -> Result<Result<Verification, RefusedCertificate>, VerbFailure> {
        let points = &certificate.points;
        if !points.is_sorted_by(|before, point| before.label < point.label) {
            return Ok(Err(RefusedCertificate::Labels));
        }
        let units = self.requested.as_ref();
        let units = units.map(|requested| (self.check_units)(requested, points));
        let mut not_compared = match units {
            None => vec![NotCompared::Problem],
            Some(Err(reason)) => return Ok(Err(RefusedCertificate::Units(reason))),
            Some(Ok(true)) => Vec::new(),
            Some(Ok(false)) => vec![NotCompared::Units],
        };
        if self.requested.as_ref().is_some_and(self.is_restarted) {
            not_compared.push(NotCompared::Numbers);
        }
        let repeated = certify::repeated(points);
        let indices: Vec<usize> = (0..points.len()).collect();
        let verdicts: Vec<(PointVerdict, CertifiedPoint<P>)> =
            each(quiet, &indices, "points", |&index| {
                let before = index.checked_sub(1).map(|before| &points[before]);
                self.verdict(&points[index], before, &repeated)
            });
        let (verdicts, again): (Vec<PointVerdict>, Vec<CertifiedPoint<P>>) =
            verdicts.into_iter().unzip();
        let contradicting = contradicting(file, certificate, &again, &mut not_compared)?;
        let points = points.iter().zip(verdicts);
        let points = points.map(|(point, verdict)| (point.label, point.kind, verdict));
        Ok(Ok(Verification {
            points: points.collect(),
            contradicting,
            not_compared,
        }))
    }

    /// Whether a stored point, and the arc that leads to it, is what it says; with the point, whose intervals are no wider than
    /// they are proven.
    fn verdict(
        &self,
        point: &CertifiedPoint<P>,
        before: Option<&CertifiedPoint<P>>,
        repeated: &[usize],
    ) -> (PointVerdict, CertifiedPoint<P>) {
        let mut again = point.clone();
        let proven = match &point.outcome {
            ProofOutcome::Proven(proof) => self.point_again(point, proof, repeated),
            ProofOutcome::Open(_)
                if point.growth.is_some() || point.arc == Some(ArcOutcome::Proven) =>
            {
                Err(RefusedProof::Statement(
                    "what follows from a point that is not proven",
                ))
            }
            ProofOutcome::Open(reason) => return (PointVerdict::NotProven(reason.clone()), again),
        };
        let verdict = match (proven, &point.arc) {
            (Err(reason), _) => PointVerdict::Refused(reason),
            (Ok(_), Some(ArcOutcome::Open(reason))) => PointVerdict::ArcNotProven(reason.clone()),
            (Ok(_), arc)
                if arc.is_some() && before.and_then(|before| point.stretch(before)) != *arc =>
            {
                PointVerdict::RefusedArc
            }
            (Ok(proof), _) => {
                again.outcome = ProofOutcome::Proven(Box::new(proof));
                match &point.growth {
                    Some(Counted::Open(reason)) => PointVerdict::NotCounted(reason.clone()),
                    _ => PointVerdict::Verified,
                }
            }
        };
        (verdict, again)
    }

    /// Proves a point again that is no earlier one, and one of the branch of the problem file where that is known.
    fn point_again(
        &self,
        point: &CertifiedPoint<P>,
        proof: &P,
        repeated: &[usize],
    ) -> Result<P, RefusedProof> {
        if repeated.contains(&point.label) {
            return Err(RefusedProof::Statement("that it is not an earlier point"));
        }
        if let Some(requested) = &self.requested {
            (self.check)(requested, point, proof)?;
        }
        (self.proven_again)(point, proof)
    }
}

/// The files beside a certificate that say something else than its points, as these are proven again. Where they are not compared,
/// this is added to what is not.
fn contradicting<P: Certified>(
    file: &Path,
    certificate: &Certificate<P>,
    again: &[CertifiedPoint<P>],
    not_compared: &mut Vec<NotCompared>,
) -> Result<Vec<&'static str>, StoreError> {
    let mut contradicting = Vec::new();
    match table_agrees(&file.with_file_name(CERTIFICATES), again)? {
        None => not_compared.push(NotCompared::Table),
        Some(true) => {}
        Some(false) => contradicting.push(CERTIFICATES),
    }
    // what version a certificate names proves nothing: words that are not those of this one are not taken for its own
    let is_other = certificate.version != VERSION;
    match theorems_agree(file, certificate)? {
        true => {}
        false if is_other => not_compared.push(NotCompared::Theorems(certificate.version.clone())),
        false => contradicting.push(CertificateFolder::THEOREMS),
    }
    Ok(contradicting)
}
