//! Whether the program prints what a page says that it prints.

/// Stands for lines, or for words of a line, that a page leaves out.
const LEFT_OUT: &str = "…";

/// How far a printed number may be from that of the page, relative to its size: what the problem files allow their
/// expectations. Sums of vectors are taken in another order where a processor has wider registers, which changes the last
/// two or three of sixteen digits.
const NUMBER: f64 = 1e-11;

/// How far an error or a radius of one or two digits may be, as a factor: it is a power of ten rather than a number.
const ESTIMATE: f64 = 16.0;

/// The first line of `page` that is not where it should be in `printed`. Lines that follow one another on the page do so in
/// the output, unless a line `…` stands between them.
pub fn missing<'a>(page: &'a str, printed: &str) -> Option<&'a str> {
    let printed: Vec<&str> = printed.lines().collect();
    let lines: Vec<&str> = page.lines().collect();
    let mut begin = 0;
    for group in lines.split(|line| line.trim() == LEFT_OUT) {
        if group.is_empty() {
            continue;
        }
        let fits = |at: &usize| {
            let there = printed.get(*at..at + group.len());
            there.is_some_and(|there| {
                there
                    .iter()
                    .zip(group)
                    .all(|(line, wanted)| same_line(line, wanted))
            })
        };
        match (begin..printed.len()).find(fits) {
            Some(at) => begin = at + group.len(),
            None => return Some(group[0]),
        }
    }
    None
}

/// Whether two lines have the same words. `…` on the page stands for any words.
fn same_line(line: &str, wanted: &str) -> bool {
    let (line, wanted) = (words(line), words(wanted));
    let same = |some: &[&str], others: &[&str]| {
        some.iter()
            .zip(others)
            .all(|(one, other)| same_word(one, other))
    };
    let Some(gap) = wanted.iter().position(|word| *word == LEFT_OUT) else {
        return line.len() == wanted.len() && same(&line, &wanted);
    };
    let (head, tail) = (&wanted[..gap], &wanted[gap + 1..]);
    line.len() >= head.len() + tail.len()
        && same(&line, head)
        && same(&line[line.len() - tail.len()..], tail)
}

/// What blanks and commas separate: columns of CSV, too.
fn words(line: &str) -> Vec<&str> {
    let separates = |c: char| c.is_whitespace() || c == ',';
    line.split(separates)
        .filter(|word| !word.is_empty())
        .collect()
}

/// Whether two words are the same, or numbers in the same punctuation that agree.
fn same_word(word: &str, wanted: &str) -> bool {
    let punctuation = |c: char| matches!(c, ';' | ':' | '(' | ')' | '[' | ']');
    let bare = |word: &'_ str| word.trim_matches(punctuation).replace('−', "-");
    let (number, expected) = (bare(word), bare(wanted));
    let shape = |word: &str, number: &str| word.replace('−', "-").replacen(number, "0", 1);
    word == wanted || shape(word, &number) == shape(wanted, &expected) && agree(&number, &expected)
}

/// Whether two numbers agree as closely as the second one is printed.
fn agree(number: &str, expected: &str) -> bool {
    let (Ok(value), Ok(exact)) = (number.parse::<f64>(), expected.parse::<f64>()) else {
        return false;
    };
    let (mantissa, exponent) = expected.split_once('e').unwrap_or((expected, "0"));
    let digits = mantissa.chars().filter(char::is_ascii_digit).count();
    if expected.contains('e') && digits <= 2 {
        let ratio = value / exact;
        return ratio < ESTIMATE && ratio > 1.0 / ESTIMATE;
    }
    // counts are exact
    let Some((_, decimals)) = mantissa.split_once('.') else {
        return value == exact;
    };
    let place = exponent.parse::<i32>().unwrap_or(0) - decimals.len() as i32;
    (value - exact).abs() <= NUMBER * exact.abs() + 1.5 * 10f64.powi(place)
}

#[test]
fn numbers_are_compared_as_numbers_and_words_as_words() {
    let printed =
        "3 points\n  LP at A = 0.0999707536283141 ± 3e-15, T = 6.28; fold\nresults in x\n";
    let found = |page: &str| missing(page, printed).is_none();
    assert!(found(
        "3 points\n  LP at A = 0.0999707536283133 ± 1e-15, T = 6.28; fold\n"
    ));
    assert!(found("3 points\n…\nresults in x\n"));
    assert!(found("LP at A = … fold\n"));
    assert!(
        !found("3 points\nresults in x\n"),
        "a line is left out without a mark"
    );
    assert!(!found("results in x\n…\n3 points\n"), "the order differs");
    assert!(
        !found("LP at A = 0.0999712 ± 3e-15, T = 6.28; fold\n"),
        "a digit differs"
    );
    assert!(!found(
        "LP at A = 0.0999707536283141 ± 1e-12, T = 6.28; fold\n"
    ));
    assert!(!found("4 points\n"), "a count differs");
}
