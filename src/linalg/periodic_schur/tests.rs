//! Planted eigenvalues of products.

use super::product::Number;
use super::*;
use crate::linalg::Matrix;

/// Numbers between −1 and 1, the same every time.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    fn matrix(&mut self, n: usize) -> Matrix {
        Matrix::from_fn(n, n, |_, _| self.next())
    }

    fn orthogonal(&mut self, n: usize) -> Matrix {
        self.matrix(n).qr().q()
    }
}

fn factors(matrices: Vec<Matrix>) -> Vec<Factor> {
    let factor = |matrix: Matrix| Factor {
        size: matrix.norm(),
        matrix,
        lost: 0,
        error: f64::EPSILON,
    };
    matrices.into_iter().map(factor).collect()
}

/// Triangular factors, with blocks of two where a pair is wanted, in other orthonormal coordinates.
fn planted(triangular: &[Matrix], numbers: &mut Numbers) -> Vec<Matrix> {
    let n = triangular[0].nrows();
    let bases: Vec<Matrix> = triangular.iter().map(|_| numbers.orthogonal(n)).collect();
    let turned = triangular.iter().enumerate().map(|(k, one)| {
        let next = &bases[(k + 1) % bases.len()];
        next * one * bases[k].transpose()
    });
    turned.collect()
}

/// Every eigenvalue is one of those expected, by logarithm of its modulus and by its argument, within its own error and
/// within `allowed` of its size.
fn compare(found: &[ProductEigenvalue], expected: &[(f64, f64)], allowed: f64) {
    assert_eq!(found.len(), expected.len());
    let mut left = expected.to_vec();
    for one in found {
        let off = |(log, argument): &(f64, f64)| {
            let ratio = Number::from_polar(
                (log - one.log_modulus()).exp(),
                argument - one.mantissa.arg(),
            );
            (ratio - 1.0).norm()
        };
        let nearest = (0..left.len()).min_by(|a, b| off(&left[*a]).total_cmp(&off(&left[*b])));
        let truth = left.swap_remove(nearest.unwrap());
        let error = off(&truth);
        let own = (one.log_error - one.log_modulus()).exp();
        assert!(error <= own, "{one:?}: off by {error:e}, told {own:e}");
        assert!(own <= allowed, "{one:?}: told {own:e}");
    }
}

/// Diagonals that grow and shrink in turn by 1e3: in the product, whose eigenvalues are of order one, they would be
/// lost in 1e-16 times the norms
/// of all eight factors, 1e24.
#[test]
fn eigenvalues_of_a_product_whose_factors_grow_and_shrink() {
    let mut numbers = Numbers(1);
    for n in 1..=6 {
        let count = 8;
        let mut logs = vec![0.0; n];
        let triangular: Vec<Matrix> = (0..count)
            .map(|k| {
                let mut one = numbers.matrix(n).upper_triangle() * 1e-3;
                for j in 0..n {
                    let size = if (j + k) % 2 == 0 { 1e3 } else { 1e-3 };
                    // moduli that differ by a third at least
                    one[(j, j)] = size * if k == 0 { 1.0 + 0.4 * j as f64 } else { 1.0 };
                    logs[j] += f64::ln(one[(j, j)]);
                }
                one
            })
            .collect();
        let found = eigenvalues(&factors(planted(&triangular, &mut numbers)));
        let expected: Vec<(f64, f64)> = logs.into_iter().map(|log| (log, 0.0)).collect();
        // some hundred turns leave 4e-14 of its norm in a factor, 1e3, beside whose least diagonal, 1e-3, that is 4e-8;
        // eight factors, and vectors of lengths of a few
        compare(&found, &expected, 1e-5);
    }
}

/// Multipliers from e⁻²⁰⁰⁰ to e²⁰⁰⁰, which are no numbers, beside some of order one.
#[test]
fn a_long_product_leaves_the_range_of_numbers() {
    let mut numbers = Numbers(2);
    let (n, count) = (5, 200);
    let rates = [10.0, 0.004, -0.002, -0.9, -10.0_f64];
    let triangular: Vec<Matrix> = (0..count)
        .map(|_| {
            let mut one = numbers.matrix(n).upper_triangle();
            one.set_diagonal(&crate::linalg::Vector::from_iterator(
                n,
                rates.iter().map(|rate| rate.exp()),
            ));
            for i in 0..n {
                for j in i + 1..n {
                    one[(i, j)] *= rates[j].exp();
                }
            }
            one
        })
        .collect();
    let found = eigenvalues(&factors(planted(&triangular, &mut numbers)));
    assert_eq!(found.len(), n);
    for (one, rate) in found.iter().zip(rates) {
        let log = count as f64 * rate;
        let off = one.log_modulus() - log;
        assert!(one.mantissa.im == 0.0 && one.mantissa.re > 0.0);
        // a factor of size e¹⁰ is known to 1e-16 of that: what it shrinks by more is rounding
        if rate >= -0.002 {
            assert!(off.abs() <= (one.log_error - log).exp(), "{off:e}");
            assert!((one.log_error - log).exp() < 1e-4);
        } else {
            assert!(one.log_error < -0.8 * 200.0, "{one:?}");
        }
    }
}

/// Two pairs of one modulus, and −0.5 twice beside 0.5: what pairs eigenvalues by their modulus mixes them up.
#[test]
fn equal_moduli_stay_apart() {
    let mut numbers = Numbers(3);
    for (n, allowed) in [(4, 1e-12), (7, 1e-12)] {
        let count = 6;
        let mut first = Matrix::zeros(n, n);
        for (place, angle) in [(0, 0.3_f64), (2, 2.1)] {
            let turn = [angle.cos(), angle.sin(), -angle.sin(), angle.cos()].map(|x| 0.8 * x);
            for (index, entry) in turn.into_iter().enumerate() {
                first[(place + index % 2, place + index / 2)] = entry;
            }
        }
        let mut expected: Vec<(f64, f64)> = [0.3, -0.3, 2.1, -2.1]
            .map(|angle| (0.8_f64.ln(), angle))
            .to_vec();
        for (place, value) in [0.8_f64, -0.8, -0.8].into_iter().enumerate() {
            if 4 + place < n {
                first[(4 + place, 4 + place)] = value;
                let argument = if value < 0.0 {
                    std::f64::consts::PI
                } else {
                    0.0
                };
                expected.push((0.8_f64.ln(), argument));
            }
        }
        let mut triangular = vec![Matrix::identity(n, n); count];
        triangular[0] = first;
        let found = eigenvalues(&factors(planted(&triangular, &mut numbers)));
        compare(&found, &expected, allowed);
        let real = found.iter().filter(|one| one.mantissa.im == 0.0).count();
        assert_eq!(real, n - 4);
    }
}

/// How many times an error of the factors relative to their norms is at most in an eigenvalue λ of their product P: with
/// Px = λx, y*P = λy*, y*x = 1 this is ∑ ‖Aₖ‖‖Aₖ₋₁⋯A₁x‖‖y*A_K⋯Aₖ₊₁‖.
fn condition(all: &[Matrix], value: Number) -> f64 {
    let all: Vec<_> = all
        .iter()
        .map(|one| one.map(|x| Number::new(x, 0.0)))
        .collect();
    let n = all[0].nrows();
    let identity = || nalgebra::DMatrix::<Number>::identity(n, n);
    let product = all.iter().fold(identity(), |product, one| one * product);
    // inverse iteration beside it
    let shifted = product - identity() * (value * (1.0 + 1e-9));
    let vector = |matrix: nalgebra::DMatrix<Number>| {
        let factors = matrix.lu();
        let mut vector = nalgebra::DVector::from_element(n, Number::new(1.0, 0.0));
        for _ in 0..3 {
            vector = factors.solve(&vector).unwrap().normalize();
        }
        vector
    };
    let (mut right, left) = (vector(shifted.clone()), vector(shifted.adjoint()));
    let mut lefts = vec![left.unscale(left.dotc(&right).norm())];
    for one in all.iter().skip(1).rev() {
        let next = one.adjoint() * &lefts[lefts.len() - 1];
        lefts.push(next);
    }
    let mut sum = 0.0;
    for (one, left) in all.iter().zip(lefts.iter().rev()) {
        sum += one.norm() * right.norm() * left.norm();
        right = one * right;
    }
    sum
}

/// In units that differ by up to 1e18 a product has the same eigenvalues within their bounds. These are no larger than
/// what turns, of 2ε in every factor each, make of the condition: of four dimensions six turns reduce a product, and some
/// four sweeps of five do the rest. Powers of two bring the units back to within two in each of two states, so that norms
/// are up to four times as large, and products of left and right vectors, too; what goes one way becomes small at most.
#[test]
fn balancing_undoes_bad_units() {
    const LEFT: f64 = 4.0;
    const TURNS: f64 = 40.0;
    let mut numbers = Numbers(4);
    let n = 4;
    let all: Vec<Matrix> = (0..6).map(|_| numbers.matrix(n)).collect();
    let compare_in_units = |all: &[Matrix], truth: &[ProductEigenvalue], units: [f64; 4]| {
        let other: Vec<Matrix> = all
            .iter()
            .map(|one| Matrix::from_fn(n, n, |i, j| one[(i, j)] * units[j] / units[i]))
            .collect();
        let scales = balance(&other.iter().collect::<Vec<_>>());
        let found = eigenvalues(&factors(balanced(&other, &scales)));
        for (one, other) in found.iter().zip(truth) {
            let off = (one.value() - other.value()).norm();
            assert!(off <= one.error() + other.error(), "{units:?}: {off:e}");
            let allowed = 2.0 * TURNS * f64::EPSILON * condition(all, other.value());
            assert!(other.error() <= allowed, "{other:?}, {allowed:e}");
            let allowed = LEFT * LEFT * allowed;
            assert!(one.error() <= allowed, "{units:?}: {one:?}, {allowed:e}");
        }
        scales
    };
    let truth = eigenvalues(&factors(all.clone()));
    for k in -9..=9 {
        let unit = 10.0_f64.powi(k);
        let units = [1.0, unit, 1.0, unit.recip()];
        let scales = compare_in_units(&all, &truth, units);
        let left = || scales.iter().zip(units).map(|(scale, unit)| scale * unit);
        let [least, most] = [
            left().fold(f64::INFINITY, f64::min),
            left().fold(0.0, f64::max),
        ];
        assert!(most <= LEFT * least, "{units:?}: {scales:?}");
        // a state that acts on the others and on which none acts, or the other way round
        for transposed in [false, true] {
            let one_way = |one: &Matrix| {
                let mut one = one.clone();
                (0..n).filter(|j| *j != 1).for_each(|j| one[(1, j)] = 0.0);
                if transposed { one.transpose() } else { one }
            };
            let all: Vec<Matrix> = all.iter().map(one_way).collect();
            let truth = eigenvalues(&factors(all.clone()));
            compare_in_units(&all, &truth, [1.0, unit, 1.0, 1.0]);
        }
    }
}

fn balanced(all: &[Matrix], scales: &[f64]) -> Vec<Matrix> {
    let one = |one: &Matrix| {
        Matrix::from_fn(one.nrows(), one.ncols(), |i, j| {
            one[(i, j)] * scales[j] / scales[i]
        })
    };
    all.iter().map(one).collect()
}

/// One state is 1e10 times as large in the middle of a product as at its ends. In the units of its ends its rounding would be
/// 1e-6 of the rest; in units of its own the product is one of factors of order one, and the bounds are theirs.
#[test]
fn what_grows_and_shrinks_again_leaves_no_rounding() {
    let mut numbers = Numbers(8);
    let n = 3;
    let all: Vec<Matrix> = (0..2).map(|_| numbers.matrix(n)).collect();
    let truth = eigenvalues(&factors(all.clone()));
    let large = |i: usize| if i == 1 { 1e10 } else { 1.0 };
    let first = Matrix::from_fn(n, n, |i, j| all[0][(i, j)] * large(i));
    let second = Matrix::from_fn(n, n, |i, j| all[1][(i, j)] / large(j));
    let steep = [&first, &second];
    let units = units_along(&steep);
    let in_units: Vec<Matrix> = (0..2)
        .map(|k| {
            let (begin, end) = (&units[k], &units[(k + 1) % 2]);
            Matrix::from_fn(n, n, |i, j| steep[k][(i, j)] * begin[j] / end[i])
        })
        .collect();
    for (one, other) in eigenvalues(&factors(in_units)).iter().zip(&truth) {
        let off = (one.value() - other.value()).norm();
        assert!(off <= one.error() + other.error(), "{off:e}");
        assert!(one.error() <= 1e2 * other.error(), "{one:?}, {other:?}");
    }
    assert_eq!(units_along(&[&all[0], &all[1]]), vec![vec![1.0; n]; 2]);
}

/// A projection along what another one leaves takes a second dimension away, one along the same direction does not;
/// what is left is exact.
#[test]
fn what_singular_factors_take_away_is_exactly_zero() {
    let mut numbers = Numbers(5);
    let n = 4;
    let project = |normal: usize, along: &Matrix| {
        let mut one = Matrix::identity(n, n);
        for i in 0..n {
            one[(i, normal)] -= along[(i, 0)] / along[(normal, 0)];
        }
        one
    };
    let along = numbers.matrix(n).columns(0, 1).into_owned();
    let flow = numbers.matrix(n);
    let of = |matrices: Vec<(Matrix, usize)>| {
        let all = matrices.into_iter().map(|(matrix, lost)| Factor {
            size: matrix.norm(),
            matrix,
            lost,
            error: f64::EPSILON,
        });
        let (left, zeros) = regular_part(all.collect());
        (eigenvalues(&left), zeros)
    };
    let once = of(vec![(project(0, &along), 1), (flow.clone(), 0)]);
    assert_eq!((once.1, once.0.len()), (1, 3));
    let twice = of(vec![
        (project(0, &along), 1),
        (Matrix::identity(n, n), 0),
        (project(0, &along), 1),
        (flow.clone(), 0),
    ]);
    assert_eq!(twice.1, 1);
    for (one, other) in once.0.iter().zip(&twice.0) {
        assert!((one.value() - other.value()).norm() <= one.error() + other.error());
    }
    // a direction in what the first one leaves
    let other = &flow * project(0, &along) * numbers.matrix(n).columns(0, 1);
    let both = of(vec![
        (project(0, &along), 1),
        (flow.clone(), 0),
        (project(1, &other), 1),
    ]);
    assert_eq!((both.1, both.0.len()), (2, 2));
    // the trace of the product is the sum of what is left
    let product = project(1, &other) * &flow * project(0, &along);
    let sum: Number = both.0.iter().map(ProductEigenvalue::value).sum();
    assert!((sum.re - product.trace()).abs() < 1e-13 && sum.im == 0.0);
}

/// A Jordan block is known to the square root of rounding, and says so.
#[test]
fn a_defective_eigenvalue_tells_its_error() {
    let mut numbers = Numbers(6);
    let block = Matrix::from_row_slice(2, 2, &[-1.0, 1.0, 0.0, -1.0]);
    let triangular = [block, Matrix::identity(2, 2), Matrix::identity(2, 2)];
    let found = eigenvalues(&factors(planted(&triangular, &mut numbers)));
    for one in found {
        let off = (one.value() + 1.0).norm();
        assert!(
            off <= one.error() && one.error() < 1e-5 && one.error() > 1e-9,
            "{one:?}"
        );
    }
}

/// Factors that shrink by more than rounding say no more than that.
#[test]
fn what_vanishes_is_small_and_no_error_of_order_one() {
    let mut numbers = Numbers(7);
    let n = 3;
    let mut one = numbers.matrix(n).upper_triangle();
    one.set_diagonal(&crate::linalg::Vector::from_vec(vec![0.5, 1e-19, 1e-20]));
    let triangular = vec![one; 4];
    let found = eigenvalues(&factors(planted(&triangular, &mut numbers)));
    assert!((found[0].value() - 0.0625).norm() <= found[0].error() && found[0].error() < 1e-12);
    for one in &found[1..] {
        assert!(one.value().norm() + one.error() < 1e-6, "{one:?}");
    }
}

/// The same with sweeps in complex arithmetic alone.
fn by_complex_sweeps(factors: &[Factor]) -> Vec<ProductEigenvalue> {
    let factors: Vec<&Factor> = factors.iter().collect();
    let mut real = Chain::of(&factors, factors[0].matrix.nrows());
    real.reduce();
    let mut chain = real.complex();
    let left_out = chain.triangularise();
    of_diagonals(&chain, &factors, &[], left_out)
}

/// Whether every disc of some eigenvalues meets one of others, each another one.
fn meet(some: &[ProductEigenvalue], others: &[ProductEigenvalue]) -> bool {
    let meets = |one: &ProductEigenvalue, other: &ProductEigenvalue| {
        let sizes = [one, other].map(|each| each.log_modulus().max(each.log_error));
        let unit = (sizes[0].max(sizes[1]) / std::f64::consts::LN_2).floor();
        if !unit.is_finite() {
            return unit.is_infinite();
        }
        let unit = unit as i64;
        let off = (one.value_over(unit) - other.value_over(unit)).norm();
        off <= one.error_over(unit) + other.error_over(unit)
    };
    fn found(
        one: usize,
        meets: &impl Fn(usize, usize) -> bool,
        seen: &mut [bool],
        owners: &mut [Option<usize>],
    ) -> bool {
        for other in 0..owners.len() {
            if !seen[other] && meets(one, other) {
                seen[other] = true;
                if owners[other].is_none_or(|owner| found(owner, meets, seen, owners)) {
                    owners[other] = Some(one);
                    return true;
                }
            }
        }
        false
    }
    let meets = |one: usize, other: usize| meets(&some[one], &others[other]);
    let mut owners = vec![None; others.len()];
    some.len() == others.len()
        && (0..some.len())
            .all(|one| found(one, &meets, &mut vec![false; others.len()], &mut owners))
}

/// Sweeps with two real shifts and those in complex arithmetic find the same eigenvalues within their bounds: of random products, of
/// those whose factors grow and shrink, of nearly defective pairs, and where factors are singular.
#[test]
fn real_and_complex_sweeps_find_the_same() {
    let mut numbers = Numbers(9);
    for (n, count) in (2..=24).zip([1, 2, 3, 5, 12, 40].into_iter().cycle()) {
        let random: Vec<Matrix> = (0..count).map(|_| numbers.matrix(n)).collect();
        let scaled = |numbers: &mut Numbers| {
            let mut one = numbers.matrix(n);
            for mut row in one.row_iter_mut() {
                row *= 10.0_f64.powf(3.0 * numbers.next());
            }
            one
        };
        let steep: Vec<Matrix> = (0..count).map(|_| scaled(&mut numbers)).collect();
        let near = |k: usize, numbers: &mut Numbers| {
            let mut one = numbers.matrix(n).upper_triangle();
            for j in 0..n {
                // two at a time differ by 1e-9
                let value = 1.0 + (j / 2) as f64 + 1e-9 * (j % 2) as f64;
                one[(j, j)] = if k == 0 { value } else { 1.0 };
            }
            one
        };
        let near: Vec<Matrix> = (0..count).map(|k| near(k, &mut numbers)).collect();
        let mut singular: Vec<Matrix> = random.iter().map(Matrix::upper_triangle).collect();
        for (k, one) in singular.iter_mut().enumerate().skip(1).step_by(2) {
            one[(k % n, k % n)] = 0.0;
        }
        singular[0] = random[0].clone();
        let without_column = |one: &Matrix| {
            let mut one = one.clone();
            one.column_mut(n / 2).fill(0.0);
            one
        };
        let without: Vec<Matrix> = random.iter().map(without_column).collect();
        let flat = planted(&near, &mut numbers);
        let orthogonal: Vec<Matrix> = (0..count).map(|_| numbers.orthogonal(n)).collect();
        for matrices in [random, steep, flat, singular, without, orthogonal] {
            let factors = factors(matrices);
            let (found, other) = (eigenvalues(&factors), by_complex_sweeps(&factors));
            assert!(meet(&found, &other), "{n}, {count}: {found:?}, {other:?}");
        }
    }
}

/// Permutations are orthogonal and have roots of one, at which sweeps with shifts from the product itself may stand still: those
/// of all cycles of their product.
#[test]
fn products_of_permutations_have_roots_of_one() {
    let mut numbers = Numbers(10);
    for n in 2..=20 {
        for count in [1, 2, 7] {
            let mut images: Vec<usize> = (0..n).collect();
            let mut all = Vec::new();
            for k in 0..count {
                let mut one: Vec<usize> = (0..n).collect();
                match count {
                    1 => one.rotate_left(1),
                    _ => one.sort_by_cached_key(|_| (1e15 * numbers.next()) as i64),
                }
                let sign = if k == 0 { 2.0 } else { 0.5 };
                all.push(Matrix::from_fn(
                    n,
                    n,
                    |i, j| {
                        if one[j] == i { sign } else { 0.0 }
                    },
                ));
                images = images.iter().map(|j| one[*j]).collect();
            }
            let log = 2.0_f64.ln() * (2.0 - count as f64);
            let mut seen = vec![false; n];
            let mut expected = Vec::new();
            for begin in 0..n {
                let (mut j, mut long) = (begin, 0);
                while !seen[j] {
                    (seen[j], j, long) = (true, images[j], long + 1);
                }
                let part = |k: usize| std::f64::consts::TAU * k as f64 / long as f64;
                expected.extend((0..long).map(|k| (log, part(k))));
            }
            // some sixty sweeps of twenty turns leave 1e-12
            compare(&eigenvalues(&factors(all)), &expected, 1e-10);
        }
    }
}

/// Orthogonal factors stay orthogonal, but for what the turns leave that are counted. A product of them is the hardest to take
/// apart: all its eigenvalues have the same modulus.
#[test]
fn turns_leave_no_more_than_they_are_counted_for() {
    let mut numbers = Numbers(11);
    for (n, count) in [(2, 3), (3, 4), (5, 1), (8, 12), (20, 10), (24, 40)] {
        let matrices: Vec<Matrix> = (0..count).map(|_| numbers.orthogonal(n)).collect();
        let off = |one: &Matrix| (one.tr_mul(one) - Matrix::identity(n, n)).norm();
        let before: Vec<f64> = matrices.iter().map(off).collect();
        let factors = factors(matrices);
        let mut real = Chain::of(&factors.iter().collect::<Vec<_>>(), n);
        real.reduce();
        let pairs = real.take_apart();
        let mut chain = real.complex();
        assert_eq!(chain.triangularise(), 0.0);
        assert!(chain.turns >= n * (n - 1) / 2 && pairs.len() <= n / 2);
        // QᵀQ − 1 is twice the error of Q, which has the norm √n
        let left = 2.0 * TURN * chain.turns as f64 * (n as f64).sqrt();
        for (entries, before) in chain.entries.chunks_exact(n * n).zip(before) {
            let one = nalgebra::DMatrix::from_column_slice(n, n, entries);
            let off = (one.ad_mul(&one) - nalgebra::DMatrix::identity(n, n)).norm();
            assert!(off <= before + left, "{n}, {count}: {off:e}, {left:e}");
        }
    }
}
