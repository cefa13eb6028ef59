//! The work of a run is counted in eigenvalues: a spectrum costs as many as it has in all sectors, and
//! once they are used up no more is taken.

use brakewave::continuation::Node;
use brakewave::tube::stability::spectrum::Spectrum;
use brakewave::tube::stability::track::Tracker;
use brakewave::tube::wave::start::Which;

use crate::stability::waves::{STEPS, mode4, request, wave};

#[test]
fn a_spectrum_costs_its_eigenvalues_and_none_is_taken_without() {
    let (wave, point) = wave(&mode4(0.2), 4, Which::Fast);
    let node = Node {
        tangent: point.clone(),
        point,
        newton: 0,
        residual: 0.0,
    };
    let size = |spectrum: &Spectrum| -> usize {
        let sectors = spectrum.sectors.iter();
        sectors.map(|sector| sector.eigenvalues.len()).sum()
    };
    let tracker = |allowance| Tracker::new(request(4), None, STEPS.tolerance, allowance);
    let plenty = tracker(10_000);
    let first = plenty.at(&wave, &node).expect("a spectrum");
    let cost = size(&first);
    assert!(cost > 10, "{cost} eigenvalues");
    assert_eq!(plenty.allowance(), 10_000 - cost);
    // the last one may exceed what is left; there is none after it
    let scarce = tracker(cost + 1);
    for left in [1, 0] {
        assert_eq!(scarce.at(&wave, &node).as_ref(), Some(&first));
        assert_eq!(scarce.allowance(), left);
    }
    assert_eq!(scarce.at(&wave, &node), None);
}
