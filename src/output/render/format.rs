//! File formats of pictures.

use std::path::Path;

use super::picture::Picture;
#[cfg(feature = "raster")]
use super::raster;
use super::surface::RenderError;

/// File format of the pictures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Format {
    Svg,
    /// Pixels, about 460 per inch at the width of a column.
    Png,
    /// One page of the width of a column.
    Pdf,
    /// The same as source for pdfLaTeX with pgfplots.
    Tex,
}

impl Format {
    const ALL: [Format; 4] = [Format::Svg, Format::Png, Format::Pdf, Format::Tex];

    /// Extension of the file name.
    pub(crate) fn extension(self) -> &'static str {
        match self {
            Format::Svg => "svg",
            Format::Png => "png",
            Format::Pdf => "pdf",
            Format::Tex => "tex",
        }
    }

    /// The format itself, if this build can write it.
    ///
    /// # Errors
    /// When it was left out.
    pub(crate) fn available(self) -> Result<Format, RenderError> {
        if matches!(self, Format::Png | Format::Pdf) && cfg!(not(feature = "raster")) {
            return Err(RenderError::FormatMissing(self.extension()));
        }
        Ok(self)
    }

    /// The format with this extension.
    pub(crate) fn named(extension: &str) -> Option<Format> {
        let mut all = Format::ALL.into_iter();
        all.find(|format| format.extension() == extension)
    }

    /// The format of a file by its extension.
    pub(crate) fn of(path: &Path) -> Option<Format> {
        Format::named(&path.extension()?.to_str()?.to_ascii_lowercase())
    }
}

impl Picture {
    /// The bytes of the picture's file.
    ///
    /// # Errors
    /// When the format was left out of this build or a library refuses.
    pub(crate) fn file(&self, format: Format) -> Result<Vec<u8>, RenderError> {
        match format.available()? {
            Format::Svg => Ok(self.svg()?.into_bytes()),
            Format::Tex => Ok(self.tex()?.into_bytes()),
            #[cfg(feature = "raster")]
            Format::Png => raster::png(&self.svg()?),
            #[cfg(feature = "raster")]
            Format::Pdf => raster::pdf(&self.svg()?),
            #[cfg(not(feature = "raster"))]
            Format::Png | Format::Pdf => Err(RenderError::FormatMissing(format.extension())),
        }
    }
}
