//! PNG and PDF from SVG, with a font of our own: machines that compute often have none.

use std::error::Error;
use std::sync::Arc;

use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{Options, Tree, fontdb};
use svg2pdf::{ConversionOptions, PageOptions};

use super::surface::{RenderError, WIDTH};

/// Pixels of the PNG per pixel of the sheet.
const SCALE: f32 = 3.0;

/// Width of the page in millimetres: a column.
const COLUMN: f64 = 85.0;

pub(super) fn png(svg: &str) -> Result<Vec<u8>, RenderError> {
    let tree = tree(svg, "PNG")?;
    let size = tree.size();
    let (width, height) = (
        (size.width() * SCALE).ceil() as u32,
        (size.height() * SCALE).ceil() as u32,
    );
    let mut pixels = Pixmap::new(width, height)
        .ok_or_else(|| fault("PNG", format!("no room for {width} × {height} pixels")))?;
    resvg::render(
        &tree,
        Transform::from_scale(SCALE, SCALE),
        &mut pixels.as_mut(),
    );
    pixels.encode_png().map_err(|error| fault("PNG", error))
}

/// The picture as a page of PDF.
pub(super) fn pdf(svg: &str) -> Result<Vec<u8>, RenderError> {
    let tree = tree(svg, "PDF")?;
    let page = PageOptions {
        dpi: (WIDTH / (COLUMN / 25.4)) as f32,
    };
    svg2pdf::to_pdf(&tree, ConversionOptions::default(), page)
        .map_err(|error| fault("PDF", error.to_string()))
}

/// Reads the SVG with the fonts at hand.
fn tree(svg: &str, format: &'static str) -> Result<Tree, RenderError> {
    let mut fonts = fontdb::Database::new();
    fonts.load_font_data(dejavu::sans_condensed::regular().to_vec());
    let family = fonts
        .faces()
        .next()
        .and_then(|face| face.families.first())
        .map(|(name, _)| name.clone())
        .ok_or_else(|| fault(format, "the built-in font cannot be read"))?;
    fonts.set_sans_serif_family(family.clone());
    let options = Options {
        font_family: family,
        fontdb: Arc::new(fonts),
        ..Options::default()
    };
    Tree::from_str(svg, &options).map_err(|error| fault(format, error))
}

fn fault(format: &'static str, source: impl Into<Box<dyn Error + Send + Sync>>) -> RenderError {
    let source = source.into();
    RenderError::Convert { format, source }
}

#[cfg(test)]
mod tests {
    use super::png;

    #[test]
    fn png_shows_text_without_fonts_of_the_machine() {
        let dark = |text: &str| {
            let svg = format!(
                "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"510\" height=\"40\">\
                 <text x=\"9\" y=\"30\" font-size=\"20\" \
                 font-family=\"Helvetica, Arial, sans-serif\">{text}</text></svg>"
            );
            png(&svg).unwrap()
        };
        // Every symbol has a glyph of its own, unlike a character that no font has.
        let missing = dark("\u{10fffd}");
        for symbol in "δνξαβγλθ−×±¹²³⁴⁵⁶⁷⁸⁹⁰⁻…".chars() {
            assert_ne!(dark(&symbol.to_string()), missing, "{symbol}");
        }
        assert_ne!(dark("V\u{307}"), dark("V"));
    }
}
