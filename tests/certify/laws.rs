//! Laws of intervals: what is enclosed is true, against 200 decimal digits.

use brakewave::interval::{Decimal, Interval, Normed, Number, TaylorModel};
use dashu_float::FBig;
use dashu_float::round::mode::HalfEven;
use proptest::prelude::*;

type Real = FBig<HalfEven, 2>;

/// 200 decimal digits.
const DIGITS: usize = 665;

fn real(value: f64) -> Real {
    Real::try_from(value)
        .unwrap()
        .with_precision(DIGITS)
        .value()
}

/// Whether a number lies in an interval, its own error of 2⁻⁶⁴⁰ relative left out of account: no number here
/// is that close to a double without being one.
fn has(interval: Interval, value: &Real) -> bool {
    (interval.low == f64::NEG_INFINITY || real(interval.low) <= *value)
        && (interval.high == f64::INFINITY || *value <= real(interval.high))
}

/// Doubles of both signs and all sizes that occur, with zero and one among them.
fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        8 => (any::<bool>(), 1.0..2.0_f64, -60..60_i32)
            .prop_map(|(minus, x, n)| if minus { -x } else { x } * 2.0_f64.powi(n)),
        1 => (any::<bool>(), 1.0..2.0_f64, -1000..1000_i32)
            .prop_map(|(minus, x, n)| if minus { -x } else { x } * 2.0_f64.powi(n)),
        1 => prop_oneof![Just(0.0), Just(1.0), Just(-1.0), Just(f64::MIN_POSITIVE)],
    ]
}

fn interval() -> impl Strategy<Value = Interval> {
    (number(), number()).prop_map(|(a, b)| Interval::new(a.min(b), a.max(b)))
}

/// A member: an end, or between them.
fn member(interval: Interval, share: f64) -> f64 {
    (interval.low + share * (interval.high - interval.low)).clamp(interval.low, interval.high)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(500))]

    /// f⁵g⁹ + f/3 of straight lines: of degree 14, so that terms are left out.
    #[test]
    fn taylor_models_enclose(f in [-2.0..2.0_f64, -2.0..2.0], g in [-2.0..2.0_f64, -2.0..2.0], t in -1.0..=1.0_f64) {
        let third = Interval::ONE / Interval::point(3.0);
        let models = [f, g].map(|[start, slope]| TaylorModel::line(start, slope));
        let power = |x: TaylorModel, n: usize| (1..n).fold(x, |power, _| power * x);
        let model = power(models[0], 5) * power(models[1], 9) + models[0].scaled(third);
        let at = |[start, slope]: [f64; 2]| real(start) + real(slope) * real(t);
        let power = |x: &Real, n: usize| (1..n).fold(x.clone(), |power, _| &power * x);
        let (one, other) = (at(f), at(g));
        let value = power(&one, 5) * power(&other, 9) + &one / real(3.0);
        prop_assert!(has(Interval::around(model.at(t)[0], model.blur()), &value));
        prop_assert!(has(model.value(), &value));
        prop_assert!(value <= real(model.norm()) && -value <= real(model.norm()));
    }
}

/// exp is enclosed to a few units of the last place, or of the smallest double, and not rounded correctly.
fn near(exp: Interval) -> Interval {
    let few = 4.0 * f64::from_bits(1);
    exp * Interval::new(1.0 - 1e-14, 1.0 + 1e-14) + Interval::new(-few, few)
}

/// Where eˣ has less than its digits as a double, and below the smallest of them.
#[test]
fn exp_is_monotone_down_to_zero() {
    let places = (0..4000).map(|n| -1024.0 + 0.1 * f64::from(n));
    let values: Vec<_> = places.map(|x| Interval::point(x).exp()).collect();
    assert!(
        values.is_sorted_by(|low, high| low.high <= near(*high).high && near(*low).low <= high.low)
    );
    for (x, value) in [
        (-1024.0, values[0]),
        (-745.0, Interval::point(-745.0).exp()),
    ] {
        assert!(has(value, &real(x).exp()), "{x}: {value:?}");
        assert!(value.width() <= 4.0 * f64::from_bits(1), "{x}: {value:?}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn arithmetic_encloses(x in interval(), y in interval(), s in 0.0..=1.0_f64, t in 0.0..=1.0_f64) {
        let (a, b) = (member(x, s), member(y, t));
        let (p, q) = (real(a), real(b));
        prop_assert!(has(x + y, &(&p + &q)));
        prop_assert!(has(x - y, &(&p - &q)));
        prop_assert!(has(x * y, &(&p * &q)));
        if b != 0.0 {
            prop_assert!(has(x / y, &(&p / &q)));
        }
        if a >= 0.0 {
            prop_assert!(has(x.sqrt(), &p.sqrt()));
        }
        prop_assert!(has(x.square(), &(&p * &p)));
    }

    /// An operation on points is rounded to neighbours at most: what is exact stays a point.
    #[test]
    fn arithmetic_is_sharp(a in number(), b in number()) {
        let (x, y) = (Interval::point(a), Interval::point(b));
        for result in [x + y, x - y, x * y] {
            prop_assert!(result.high <= result.low.next_up().next_up());
        }
        let whole = (a.abs() < 1e15 && b.abs() < 1e15).then_some((a.trunc(), b.trunc()));
        if let Some((a, b)) = whole {
            let sum = Interval::point(a) + Interval::point(b);
            prop_assert_eq!(sum, Interval::point(a + b));
        }
    }

    #[test]
    fn operations_are_monotone(x in interval(), y in interval(), s in 0.0..=1.0_f64, t in 0.0..=1.0_f64) {
        let (a, b) = (member(x, s), member(x, t));
        let inner = Interval::new(a.min(b), a.max(b));
        prop_assert!(inner.within(x));
        prop_assert!((inner + y).within(x + y));
        prop_assert!((inner * y).within(x * y));
        prop_assert!((inner / y).within(x / y));
        prop_assert!((y / inner).within(y / x));
        prop_assert!(inner.exp().within(near(x.exp())));
        prop_assert!(inner.sqrt().within(x.sqrt()));
        prop_assert!(inner.intersection(y).within(inner.hull(y)));
    }

    #[test]
    fn functions_enclose(a in -700.0..700.0_f64, tiny in -1e-3..1e-3_f64, large in 1e-300..1e300_f64) {
        for x in [a, tiny] {
            let point = Interval::point(x);
            prop_assert!(has(point.exp(), &real(x).exp()));
            prop_assert!(has(point.sin(), &real(x).sin()));
            prop_assert!(has(point.cos(), &real(x).cos()));
            // tight: a few units of the last place of the largest number that enters
            prop_assert!(point.exp().width() <= 1e-14 * point.exp().high);
            prop_assert!(point.sin().width() <= 2e-15 && point.cos().width() <= 2e-15);
        }
        let logarithm = Interval::point(large).ln();
        prop_assert!(has(logarithm, &real(large).ln()));
        prop_assert!(logarithm.width() <= 1e-14 * (1.0 + logarithm.magnitude()));
    }

    #[test]
    fn circular_functions_enclose_over_intervals(a in -20.0..20.0_f64, length in 0.0..7.0_f64, s in 0.0..=1.0_f64) {
        let x = Interval::new(a, a + length);
        let inside = real(member(x, s));
        prop_assert!(has(x.sin(), &inside.sin()));
        prop_assert!(has(x.cos(), &inside.cos()));
    }

    /// A decimal of up to 17 digits lies in its interval, which has no room but for the two doubles next to it.
    #[test]
    fn decimals_enclose(digits in 1_u64..100_000_000_000_000_000, places in 0_u32..20) {
        let text = format!("{digits}e-{places}");
        let interval = Decimal::try_from(text).unwrap().interval();
        let exact = real(digits as f64) / real(10.0).powi(places.into());
        // integers beyond 2⁵³ are no doubles: those are put together from two halves
        let halves = real((digits >> 20) as f64) * real(1_048_576.0) + real((digits & 0xf_ffff) as f64);
        let exact = if digits >> 53 == 0 { exact } else { halves / real(10.0).powi(places.into()) };
        prop_assert!(has(interval, &exact), "{digits}e-{places}");
        prop_assert!(interval.high <= interval.low.next_up().next_up());
    }
}

#[test]
fn division_by_what_has_zero() {
    let x = Interval::new(1.0, 2.0);
    assert_eq!(x / Interval::new(-1.0, 1.0), Interval::ENTIRE);
    assert_eq!(x / Interval::ZERO, Interval::EMPTY);
    assert_eq!(
        x / Interval::new(0.0, 4.0),
        Interval::new(0.25, f64::INFINITY)
    );
    assert_eq!(
        x / Interval::new(-4.0, 0.0),
        Interval::new(f64::NEG_INFINITY, -0.25)
    );
    assert_eq!(
        -x / Interval::new(0.0, 4.0),
        Interval::new(f64::NEG_INFINITY, -0.25)
    );
    assert_eq!(
        Interval::new(-1.0, 1.0) / Interval::new(0.0, 1.0),
        Interval::ENTIRE
    );
}

#[test]
fn empty_and_infinite_ends() {
    let half = Interval::new(0.0, f64::INFINITY);
    let empty = Interval::EMPTY;
    assert!(empty.is_empty() && !half.is_empty());
    for result in [
        empty + half,
        empty - half,
        half * empty,
        empty / half,
        half / empty,
        empty.sqrt(),
        empty.exp(),
        empty.ln(),
        empty.sin(),
        Interval::new(-2.0, -1.0).sqrt(),
        Interval::new(-2.0, 0.0).ln(),
        Interval::new(1.0, 2.0).intersection(Interval::new(3.0, 4.0)),
    ] {
        assert!(result.is_empty(), "{result:?}");
    }
    assert!(empty.within(Interval::ONE));
    assert_eq!(half - half, Interval::ENTIRE);
    assert_eq!(half * Interval::ZERO, Interval::ZERO);
    assert_eq!(half * -Interval::ONE, Interval::new(f64::NEG_INFINITY, 0.0));
    assert_eq!(
        Interval::ONE / Interval::new(1.0, f64::INFINITY),
        Interval::new(0.0, 1.0)
    );
    assert_eq!(half.sqrt(), half);
    assert_eq!(half.exp(), Interval::new(1.0, f64::INFINITY));
    assert_eq!(half.ln(), Interval::ENTIRE);
    assert_eq!(half.sin(), Interval::new(-1.0, 1.0));
    // beyond the largest double there is something, but not a double
    let large = Interval::point(f64::MAX) * Interval::point(2.0);
    assert_eq!(large, Interval::new(f64::MAX, f64::INFINITY));
    // and below the smallest, above zero
    let small = Interval::point(f64::MIN_POSITIVE) * Interval::point(f64::MIN_POSITIVE);
    assert!(small.low <= 0.0 && small.high > 0.0);
}

#[test]
fn decimals_are_not_doubles() {
    let tenth = Decimal::try_from("0.1".to_owned()).unwrap().interval();
    assert!(tenth.low < tenth.high && tenth.contains(0.1));
    for exact in ["0.5", "1.25", "2e3", "-0.375", "0.0", "1_000.5"] {
        let interval = Decimal::try_from(exact.to_owned()).unwrap().interval();
        assert_eq!(interval.low, interval.high, "{exact}");
    }
    for text in ["", "one", "inf", "nan", "1e400", "0x10"] {
        assert!(Decimal::try_from(text.to_owned()).is_err(), "{text}");
    }
}

/// The middle of an interval is a number of it, and of none no number; it is asked for of whatever a certificate says.
#[test]
fn the_middle_of_what_is_no_interval() {
    let ends = |low, high| Interval { low, high };
    assert!(ends(f64::NAN, f64::NAN).middle().is_nan());
    assert_eq!(ends(1.0, 3.0).middle(), 2.0);
    assert_eq!(ends(3.0, 1.0).middle(), 2.0);
    let next = 1.0_f64.next_up();
    assert!([1.0, next].contains(&ends(1.0, next).middle()));
    assert_eq!(ends(f64::MAX, f64::MAX).middle(), f64::MAX);
}
