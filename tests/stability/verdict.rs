//! A wave is called stable only when that is proven.

use brakewave::branch::Stability;
use brakewave::model::Model;
use brakewave::problem::{Impact, StabilitySection};
use brakewave::stability::characteristic::{Characteristic, NotLinearised};
use brakewave::wave::start::Which;

use crate::waves::{damped, follow, linearised, mode4, problem, wave, window};

/// Above α = 0.3151 no eigenvalue grows, and the limit at high frequency is negative.
#[test]
fn damped_wave_is_stable_at_last() {
    let spectrum = window(&linearised(&damped(0.317), 4, Which::Fast));
    assert!(spectrum.complete && spectrum.limit < 0.0);
    assert_eq!(spectrum.unstable(), 0);
    assert_eq!(spectrum.stable, Stability::Yes);
    for damping in [0.0, 0.1, 0.2, 0.3] {
        let spectrum = window(&linearised(&damped(damping), 4, Which::Fast));
        assert_eq!(spectrum.stable, Stability::No, "α = {damping}");
        assert!(spectrum.unstable() > 0);
    }
}

/// Undamped waves have growing eigenvalues at high frequency, also where the window has none.
#[test]
fn undamped_wave_is_unstable_beyond_the_window() {
    let mut quiet = 0;
    for mismatch in [0.2, 0.08, 0.045, 0.0225, 0.02, 0.012, 0.004, 0.001] {
        let spectrum = window(&linearised(&mode4(mismatch), 4, Which::Fast));
        let verdict = spectrum.stable;
        println!(
            "observed: δ = {mismatch}: {} unstable in the window, limit {:.4}, {verdict:?}",
            spectrum.unstable(),
            spectrum.limit
        );
        if spectrum.unstable() > 0 || spectrum.limit > 1e-7 {
            assert_ne!(verdict, Stability::Yes, "δ = {mismatch}");
        }
        quiet += usize::from(spectrum.unstable() == 0);
    }
    assert!(quiet > 0, "some windows are empty");
}

#[test]
fn coulomb_impact_is_undecided() {
    let model = Model {
        impact: Impact::Coulomb,
        ..mode4(0.045)
    };
    let (wave, point) = wave(&model, 4, Which::Fast);
    assert!(wave.signature.to_string().contains("separation"));
    assert_eq!(
        Characteristic::new(&wave, &point).err(),
        Some(NotLinearised::CoulombImpact)
    );
    // without separation there is no impact
    let (wave, point) = crate::waves::wave(&mode4(0.2), 4, Which::Fast);
    assert!(Characteristic::new(&wave, &point).is_ok());

    let (mut problem, text) = problem("mode4_mismatch.ron");
    problem.model.impact = Impact::Coulomb;
    problem.stability = Some(StabilitySection::default());
    let continuation = problem.continuation.as_mut().expect("there is a branch");
    continuation.range = (0.04, 0.06);
    continuation.stop_at = Vec::new();
    problem.model.mismatch = 0.06;
    let rows = follow(&problem, &text);
    let mut separated = 0;
    for item in &rows.items {
        let stable = item.point.stable.expect("stability is asked for");
        if item.point.regimes.contains("separation") {
            separated += 1;
            assert_eq!(stable, Stability::Undecided, "{:?}", item.point.parameters);
            assert_eq!(item.point.unstable, None);
        } else {
            assert!(item.point.unstable.is_some());
        }
    }
    assert!(separated > 2, "the branch separates");
}
