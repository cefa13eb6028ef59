//! Texts of a picture: how wide they are, and what of them may be written.

/// Generous estimate of a text's width; the font of the reader is not known, DejaVu Sans is a wide one.
pub(super) fn width(text: &str, size: f64) -> f64 {
    let ems = text.chars().map(|c| match c {
        '\u{300}'..='\u{36f}' => 0.0,
        'i' | 'j' | 'l' | '.' | ',' | '\'' | '|' | 'I' => 0.3,
        'f' | 't' | 'r' | ' ' | '(' | ')' | '-' | '[' | ']' => 0.39,
        '⁰' | '¹' | '²' | '³' | '⁴'..='⁹' | '⁻' => 0.42,
        '0'..='9' => 0.64,
        'm' | 'w' | 'M' | 'W' => 0.92,
        '\u{2212}' | '×' | '+' | '=' | '±' => 0.84,
        c if c.is_uppercase() => 0.72,
        _ => 0.62,
    });
    ems.sum::<f64>() * size
}

/// The text cut to a width, with an ellipsis in place of what is lost.
pub(super) fn cut(text: &str, size: f64, room: f64) -> String {
    if width(text, size) <= room {
        return text.to_owned();
    }
    let mut kept = String::new();
    for c in text.chars() {
        kept.push(c);
        if width(&kept, size) + size > room {
            break;
        }
    }
    format!("{}…", kept.trim_end())
}

/// The text without characters that XML 1.0 does not allow, which would spoil the file as a whole, and
/// without those that are not seen.
pub(super) fn clean(text: &str) -> String {
    let allowed = |c: &char| !c.is_control() && !matches!(c, '\u{fffe}' | '\u{ffff}');
    text.chars().filter(allowed).collect()
}
