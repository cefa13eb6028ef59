//! Waves with material damping: layers of any thickness.

use brakewave::certify::{
    self, ArcOutcome, CertifiedPoint, OpenPoint, UnprovenWave, WaveCondition, WaveProof,
};
use brakewave::interval::Decimal;
use brakewave::orbit::EventType;
use brakewave::tube::wave::admissibility::WaveWatch;

use crate::certify::waves::{event, figure, points_of, points_of_text, proof};

/// A branch of waves of mode 4 that begins in contact.
fn branch(model: &str, start: &str, continuation: &str) -> Vec<CertifiedPoint> {
    let text = format!(
        "(model: (coefficients: Geometry(nu: 0.3, xi: 1.5, gamma: 1.0), friction: 0.5, {model}),
        wave: (mode: 4, start: {start}), continuation: ({continuation}))"
    );
    points_of_text(&text, "layers", None)
}

fn in_mismatch() -> Vec<CertifiedPoint> {
    branch(
        "mismatch: 0.2, damping: (stiffness: 0.005)",
        "Fast",
        "parameter: Mismatch, range: (0.0432, 0.2), toward: Down",
    )
}

/// Solved with 70 digits in another program, by third-order equations and their exponents.
#[test]
fn figures_of_many_digits_lie_in_the_intervals() {
    let thin = points_of("mode4_material", &[]);
    let lifted = branch(
        "mismatch: 0.0432, damping: (stiffness: 0.005)",
        "Fast",
        "parameter: Mismatch, range: (0.043153, 0.0432), toward: Down, stop_after: [(event: GR, count: 1)]",
    );
    let opened = branch(
        "mismatch: 0.2, damping: (stiffness: 0.01)",
        "Fast",
        "parameter: MassDamping, range: (0, 2), toward: Up",
    );
    let folded = branch(
        "mismatch: 3.0",
        "Slow",
        "parameter: StiffnessDamping, range: (0, 1e-3), toward: Up, stop_after: [(event: LP, count: 1)]",
    );
    let mismatch = in_mismatch();
    for (proof, value, speed) in [
        (
            event(&thin, EventType::UZ, 0),
            "1e-8",
            "-1.242700847809936668750182",
        ),
        (
            event(&thin, EventType::UZ, 1),
            "1e-6",
            "-1.242705518375186240521778",
        ),
        (
            event(&thin, EventType::UZ, 3),
            "1e-3",
            "-1.247186780638300420011391",
        ),
        (
            event(&thin, EventType::EP, 1),
            "0.012",
            "-1.273685074194976879052503",
        ),
        (
            event(&mismatch, EventType::RV, 0),
            "0.05491493401922113114655815",
            "-1.261254202768948889840298",
        ),
        (
            event(&lifted, EventType::GR, 0),
            "0.04315351451192876322600441",
            "-1.261282839751760657707813",
        ),
        (
            event(&opened, EventType::ST, 0),
            "0.05984899422680399857687290",
            "-1.273323351509028058296611",
        ),
        (
            event(&folded, EventType::LP, 0),
            "7.176506951510195962701027e-5",
            "-1.046542438863374906369133",
        ),
    ] {
        let said = &proof.statement;
        assert!(figure(value).within(said.parameter), "{value}: {said:?}");
        assert!(figure(speed).within(said.speed), "{speed}: {said:?}");
        assert!(said.speed.width() <= 1e-12 && said.inequalities >= 9);
    }
}

/// At an event and beyond it the wave is there, but not as one of its signature.
#[test]
fn what_fails_beyond_an_event_is_not_proven() {
    let points = in_mismatch();
    let at = |proof: &WaveProof, value: f64| {
        let value = WaveCondition::Value(Decimal::of(value));
        certify::prove(proof.posed.clone(), proof.near.clone(), value, None)
    };
    let turned = event(&points, EventType::RV, 0);
    let value = turned.near.parameter;
    assert!(at(turned, value * (1.0 + 1e-9)).is_ok());
    let lower = UnprovenWave::Switch(1, WaveWatch::LowerForce);
    assert_eq!(
        at(turned, value * (1.0 - 1e-9)).err(),
        Some(OpenPoint::Inequality(lower))
    );
    // the layer is an unknown, without which there are no equations
    let bare = certify::NearWave {
        layers: Vec::new(),
        ..turned.near.clone()
    };
    let posed = turned.posed.clone();
    let open = certify::prove(posed, bare, turned.condition.clone(), None);
    assert_eq!(open.err(), Some(OpenPoint::NotEnclosed));
    // between two points of one signature nothing else happens
    let first = &points[0];
    let second = points
        .iter()
        .find(|point| point.kind == EventType::RV)
        .unwrap();
    assert!(matches!(second.stretch(first), Some(ArcOutcome::Proven)));
    assert_eq!(certify::verify(second, proof(second)), Ok(()));
}
