//! The semi-discrete wave against its own definition, its symmetries and the exact eigenvalues.

use faer::{Mat, c64};

use super::band::{Band, Fan};
use super::ring::Values;
use super::*;
use crate::tube::model::coefficients::Geometry;
use crate::tube::model::{CoefficientSource, Damping, Model};

fn model(mismatch: f64) -> Model {
    Model::tube(
        Geometry {
            nu: 0.3,
            xi: 1.5,
            gamma: 1.0,
        },
        0.5,
        mismatch,
    )
}

fn wave(points: usize, epsilon: f64) -> SemiDiscreteWave {
    damped(0.0, points, epsilon)
}

fn damped(beta: f64, points: usize, epsilon: f64) -> SemiDiscreteWave {
    let settings = RingSettings {
        points,
        epsilon,
        ..RingSettings::default()
    };
    let model = Model {
        damping: Damping {
            mass: 0.0,
            stiffness: beta,
        },
        ..model(0.2)
    };
    solve(&model, 4, &settings).unwrap()
}

fn nearest(values: &[c64], to: c64) -> f64 {
    values
        .iter()
        .map(|value| (value - to).norm())
        .fold(f64::INFINITY, f64::min)
}

/// Multipliers that do not belong to the nearly nilpotent part: rounding moves an eigenvalue
/// of a chain of m points by 1e-16 to the power 1/m, the others by its own order.
fn resolved(values: Vec<c64>) -> Vec<c64> {
    values.into_iter().filter(|mu| mu.norm() > 0.3).collect()
}

/// Both sets have the same size and every member of one has a partner in the other.
fn assert_same(one: &[c64], other: &[c64], bound: f64) {
    assert_eq!(one.len(), other.len());
    for value in one {
        let distance = nearest(other, *value);
        assert!(distance < bound, "{value}: {distance:e}");
    }
    for value in other {
        let distance = nearest(one, *value);
        assert!(distance < bound, "{value}: {distance:e}");
    }
}

/// Y maps ẏ(0) to ẏ(T) = Sẏ(0): one multiplier is 1, up to the error of the time steps.
#[test]
fn translation_is_neutral_in_sector_zero() {
    for (beta, epsilon) in [(0.0, 0.1), (0.0, 0.02), (0.005, 0.1), (0.005, 0.02)] {
        let wave = damped(beta, 32, epsilon);
        let distance = nearest(&wave.multipliers(0).unwrap(), c64::new(1.0, 0.0));
        assert!(distance < 1e-8, "{distance:e}");
    }
}

/// The values satisfy y_i(T) = y_{i+1}(0) when followed with time steps of their own. Two
/// sequences of steps that err by the tolerance in each of some ten steps differ by ten times it.
#[test]
fn the_wave_is_carried_on_by_one_point() {
    let wave = wave(40, 0.02);
    let fractions = wave
        .ring
        .fractions(&wave.values, wave.period(), 1e-12)
        .unwrap();
    let flow = wave
        .ring
        .flow(&wave.values, wave.period(), &fractions)
        .unwrap();
    for (index, end) in flow.end.iter().enumerate() {
        let next = wave.values[(index + 1) % 40];
        for (end, next) in end.iter().zip(next) {
            let error = (end - next).abs();
            assert!(error < 1e-8, "{index}: {error:e}");
        }
    }
}

/// Against differences of fourth order with the step h: their error is h⁴/30 times the fifth
/// derivative, about 16fPT/ε⁵, rounding over h, and what Newton's method leaves in the stages
/// (the square of its last correction over ε) over h: 1e-14, 1e-10 and 5e-9.
#[test]
fn fundamental_matrix_is_the_derivative_of_the_map() {
    const STEP: f64 = 1e-5;
    const BOUND: f64 = 1e-7;
    for beta in [0.0, 0.01] {
        derivatives_agree(&damped(beta, 16, 0.05), STEP, BOUND);
    }
}

fn derivatives_agree(wave: &SemiDiscreteWave, by: f64, bound: f64) {
    let (ring, period) = (wave.ring, wave.period());
    let fractions: Vec<f64> = wave.steps.iter().map(|step| step.step / period).collect();
    let map = |state: &Values, period| ring.flow(state, period, &fractions).unwrap();
    let derivative = |moved: &dyn Fn(f64) -> Values| -> Values {
        let ends = [-2.0, -1.0, 1.0, 2.0].map(|steps| moved(steps * by));
        (0..16)
            .map(|index| {
                [0, 1].map(|component| {
                    let [a, b, c, d] = [0, 1, 2, 3].map(|end| ends[end][index][component]);
                    (a - 8.0 * b + 8.0 * c - d) / (12.0 * by)
                })
            })
            .collect()
    };
    let mut matrix = vec![[0.0; 32]; 32];
    wave.band
        .shifted(0, |row, column, _, value| matrix[row][column] += value);
    for column in 0..32 {
        let differences = derivative(&|shift| {
            let mut state = wave.values.clone();
            state[column / 2][column % 2] += shift;
            map(&state, period).end
        });
        for (row, entries) in matrix.iter().enumerate() {
            let error = (entries[column] - differences[row / 2][row % 2]).abs();
            assert!(error < bound, "{row} {column}: {error:e}");
        }
    }
    let differences = derivative(&|shift| map(&wave.values, period + shift).end);
    let flow = map(&wave.values, period);
    for (value, difference) in flow.by_period.iter().zip(&differences) {
        for (value, difference) in value.iter().zip(difference) {
            let error = (value - difference).abs();
            assert!(error < bound, "{error:e}");
        }
    }
}

#[test]
fn sectors_and_their_complements_are_conjugate() {
    let wave = wave(24, 0.05);
    let one = resolved(wave.multipliers(1).unwrap());
    let three: Vec<c64> = resolved(wave.multipliers(3).unwrap())
        .iter()
        .map(c64::conj)
        .collect();
    assert!(one.len() > 10);
    assert_same(&one, &three, 1e-10);
}

/// All multipliers of the whole ring of kn points, computed without cells, sectors or windows. The work
/// grows like (kn)³.
fn whole_ring_multipliers(wave: &SemiDiscreteWave) -> Vec<c64> {
    let nodes = wave.values.len() * wave.mode as usize;
    let mut fan = Fan::new(0, nodes, 0, nodes, true);
    for step in &wave.steps {
        assert!(fan.advance(&wave.ring, step));
    }
    let direction = if wave.speed < 0.0 { 1 } else { -1 };
    let mut matrix = Mat::<f64>::zeros(2 * nodes, 2 * nodes);
    for row in 0..nodes {
        let shifted = (row as isize + direction).rem_euclid(nodes as isize) as usize;
        for component in 0..2 {
            for (column, value) in fan.row(row, component).iter().enumerate() {
                matrix[(2 * shifted + component, column)] = *value;
            }
        }
    }
    matrix.eigenvalues().unwrap()
}

/// The whole ring is computed without windows and without phases: this tests both.
#[test]
fn the_whole_ring_is_the_union_of_its_sectors() {
    for beta in [0.0, 0.01] {
        union_of_sectors(&damped(beta, 16, 0.1));
    }
}

fn union_of_sectors(wave: &SemiDiscreteWave) {
    let whole = whole_ring_multipliers(wave);
    assert_eq!(whole.len(), 128);
    let union: Vec<c64> = (0..4)
        .flat_map(|sector| wave.multipliers(sector).unwrap())
        .collect();
    assert_eq!(union.len(), 128);
    let (whole, union) = (resolved(whole), resolved(union));
    assert!(whole.len() > 40);
    assert_same(&whole, &union, 1e-10);
}

/// A window ten points longer on either side sees nothing more: neither beyond the reach nor, through
/// the ends of the window, within it. Diffusion numbers βaT/Δφ² of 0, 0.3 and 2.7.
#[test]
fn nothing_is_felt_beyond_the_reach() {
    let nearly_incompressible = Model {
        source: CoefficientSource::from(Geometry {
            nu: 0.45,
            xi: 1.25,
            gamma: 1.0,
        }),
        damping: Damping {
            mass: 0.0,
            stiffness: 0.045,
        },
        ..model(0.4)
    };
    let settings = RingSettings {
        points: 170,
        epsilon: 0.1,
        ..RingSettings::default()
    };
    for wave in [
        damped(0.0, 24, 0.1),
        damped(0.01, 50, 0.1),
        solve(&nearly_incompressible, 2, &settings).unwrap(),
    ] {
        let reach = wave.band.reach;
        let longer = Band::new(&wave.ring, &wave.steps, wave.values.len(), reach + 10).unwrap();
        let (width, wider) = (2 * reach + 1, 2 * reach + 21);
        for (index, response) in longer.values.iter().enumerate() {
            let (point, offset) = (index / wider, index % wider);
            let inside = offset
                .checked_sub(10)
                .filter(|offset| *offset < width)
                .map(|offset| wave.band.values[point * width + offset]);
            let known = inside.unwrap_or_default();
            for (one, other) in response.iter().flatten().zip(known.iter().flatten()) {
                // V̇ answers V by 1/T
                let error = (one - other).abs() * wave.period();
                assert!(error < 1e-15, "{point} {offset}: {error:e}");
            }
        }
    }
}

/// φ → −φ with D → −D is a symmetry of the model: c changes its sign, and the condition
/// N(λ)e^{−λT_w} = e^{2πij/k} does not change.
#[test]
fn mirror_image_has_the_same_sectors() {
    let original = model(0.2);
    let mut coefficients = original.constants().coefficients;
    coefficients.coupling = -coefficients.coupling;
    let mirrored = Model {
        source: CoefficientSource::from(coefficients),
        ..original
    };
    let settings = RingSettings {
        points: 24,
        epsilon: 0.1,
        ..RingSettings::default()
    };
    let (one, other) = (
        solve(&original, 4, &settings).unwrap(),
        solve(&mirrored, 4, &settings).unwrap(),
    );
    assert!((one.speed + other.speed).abs() < 1e-9);
    for sector in 0..4 {
        assert_same(
            &resolved(one.multipliers(sector).unwrap()),
            &resolved(other.multipliers(sector).unwrap()),
            1e-8,
        );
    }
}

/// Figures of an independent program for the semi-discrete system with 200 points, to the
/// digits given; and the exact eigenvalues of the sectors 1 and 2, which fix the sign of the
/// phases (the conjugate is 2.6 away in sector 1): with a quarter of the ε their errors fall at
/// least to a half.
#[test]
fn leading_pairs_at_two_hundred_points() {
    let exact = [
        c64::new(0.1279698868278, 1.319591652955),
        c64::new(0.107573000269, 0.8365151274592),
    ];
    let check = |wave: &SemiDiscreteWave, expected: c64| {
        for value in wave.eigenvalues(0, 12.0, 2).unwrap() {
            assert!((value.re - expected.re).abs() < 5e-5, "{value}");
            assert!((value.im.abs() - expected.im).abs() < 5e-4, "{value}");
        }
        [1, 2].map(|sector| {
            let leading = wave.eigenvalues(sector, 12.0, 2).unwrap();
            nearest(&leading, exact[sector as usize - 1])
        })
    };
    let wave = wave(200, 0.02);
    let before = check(&wave, c64::new(0.0297, 2.564));
    let wave = wave.with_epsilon(0.005).unwrap();
    let after = check(&wave, c64::new(0.0420, 2.552));
    for (after, before) in after.iter().zip(before) {
        assert!(*after < 0.5 * before, "{after:e} {before:e}");
        assert!(*after < 0.01, "{after:e}");
    }
}

/// At ε = 1e-5 the error is that of the spacing, of second order: from n and 2n it
/// extrapolates to the exact eigenvalues, to a tenth at least of what it is at 2n.
#[test]
fn extrapolation_in_the_spacing_meets_the_exact_eigenvalues() {
    let exact = [
        c64::new(0.04965063748184, 2.541566892289),
        c64::new(0.1279698868278, 1.319591652955),
    ];
    let [coarse, fine] = [64, 128].map(|points| {
        let wave = wave(points, 1e-5);
        [(0, exact[0]), (1, exact[1])].map(|(sector, exact)| {
            let distance = |value: &c64| (value - exact).norm();
            let values = wave.eigenvalues(sector, 12.0, 20).unwrap();
            values
                .into_iter()
                .min_by(|one, other| distance(one).total_cmp(&distance(other)))
                .unwrap()
        })
    });
    for ((coarse, fine), exact) in coarse.into_iter().zip(fine).zip(exact) {
        let extrapolated = fine + (fine - coarse) / 3.0;
        let error = (extrapolated - exact).norm();
        assert!(
            error < 0.1 * (fine - exact).norm(),
            "{extrapolated}: {error:e}"
        );
    }
}

/// With reverse slip nothing changes: the errors fall with n and ε at about first order.
#[test]
fn reverse_slip_converges_to_the_exact_eigenvalues() {
    let exact = [
        c64::new(0.028543473561, 2.554582046982),
        c64::new(0.1002644739858, 1.320228603567),
    ];
    let errors = [(50, 0.02), (100, 0.01), (200, 0.005)].map(|(points, epsilon)| {
        let settings = RingSettings {
            points,
            epsilon,
            ..RingSettings::default()
        };
        let wave = solve(&model(0.08), 4, &settings).unwrap();
        [(0, exact[0]), (1, exact[1])]
            .map(|(sector, exact)| nearest(&wave.eigenvalues(sector, 12.0, 20).unwrap(), exact))
    });
    for pair in errors.windows(2) {
        for (after, before) in pair[1].iter().zip(pair[0]) {
            assert!(*after < 0.7 * before, "{errors:?}");
        }
    }
    assert!(errors[2].iter().all(|error| *error < 0.012), "{errors:?}");
}

#[test]
fn refusals_carry_their_numbers() {
    let attempt = |mismatch, change: &dyn Fn(&mut RingSettings)| {
        let mut settings = RingSettings {
            points: 16,
            epsilon: 0.1,
            ..RingSettings::default()
        };
        change(&mut settings);
        solve(&model(mismatch), 4, &settings).err()
    };
    assert_eq!(
        attempt(0.2, &|settings| settings.points = 5),
        Some(Error::Points { points: 5 })
    );
    assert_eq!(
        attempt(0.2, &|settings| settings.epsilon = -1.0),
        Some(Error::Epsilon { epsilon: -1.0 })
    );
    assert_eq!(
        attempt(0.2, &|settings| settings.tolerance = 1.0),
        Some(Error::Tolerance { tolerance: 1.0 })
    );
    assert_eq!(
        attempt(0.045, &|_| {}),
        Some(Error::Separation {
            signature: "slip-separation-slip-reverse-stick".into()
        })
    );
    let wave = wave(16, 0.1);
    assert_eq!(
        wave.multipliers(4).err(),
        Some(Error::Sector { sector: 4, mode: 4 })
    );
    assert_eq!(
        wave.with_epsilon(f64::NAN)
            .err()
            .map(|error| error.to_string()),
        Some("ε = NaN is no width of a friction law; take a positive number such as 0.01".into())
    );
}
