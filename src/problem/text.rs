//! Reading the text of a problem: from a file, or from the standard input.

use std::fs::File;
use std::io::Read as _;
use std::path::Path;
use std::sync::OnceLock;

use super::error::{Flaw, ProblemError};
use super::{MAX_BYTES, too_large};

/// The path that stands for the standard input.
pub const STANDARD_INPUT: &str = "-";

/// What came from the standard input, which can be read but once, or why nothing did.
static GIVEN: OnceLock<Result<Vec<u8>, String>> = OnceLock::new();

/// What messages call a problem file.
pub fn name_of(path: &Path) -> String {
    match path == Path::new(STANDARD_INPUT) {
        true => "standard input".to_owned(),
        false => path.display().to_string(),
    }
}

/// The text of a problem file as its author wrote it, where it can be read.
#[cfg(feature = "cli")]
pub(crate) fn as_written(path: &Path) -> Option<String> {
    text_of(path).ok().map(|(_, text)| text)
}

/// The bytes of the standard input, one more than a problem may have at most.
fn given() -> &'static Result<Vec<u8>, String> {
    GIVEN.get_or_init(|| {
        let mut bytes = Vec::new();
        let input = std::io::stdin().lock();
        let read = input.take(MAX_BYTES as u64 + 1).read_to_end(&mut bytes);
        read.map(|_| bytes).map_err(|error| error.to_string())
    })
}

/// The name of a problem file for messages, and its text.
pub(super) fn text_of(path: &Path) -> Result<(String, String), ProblemError> {
    let name = name_of(path);
    let refuse = |reason: &str| {
        ProblemError::in_file(
            &name,
            format!("cannot read the problem file: {reason}"),
            "give the path of a problem file that exists and may be read; \
             `brakewave new` prints one to start from",
        )
    };
    let failed = |error: std::io::Error| {
        let reason = error.to_string();
        refuse(reason.split(" (os error").next().unwrap_or_default())
    };
    let mut bytes = Vec::new();
    if path == Path::new(STANDARD_INPUT) {
        bytes.clone_from(given().as_ref().map_err(|reason| refuse(reason))?);
    } else {
        // asked before it is opened, which waits for ever at a pipe without a writer
        let about = std::fs::metadata(path).map_err(failed)?;
        if about.is_dir() {
            return Err(refuse("it is a folder"));
        }
        if !about.is_file() {
            return Err(refuse(
                "it is a pipe or a device, not a file; `-` reads standard input",
            ));
        }
        // files that the system makes up tell no length, hence the limit on what is read
        File::open(path)
            .and_then(|file| file.take(MAX_BYTES as u64 + 1).read_to_end(&mut bytes))
            .map_err(failed)?;
    }
    if bytes.len() > MAX_BYTES {
        return Err(too_large(&name));
    }
    let text = String::from_utf8(bytes).map_err(|error| {
        let valid = error.utf8_error().valid_up_to();
        let byte = error.as_bytes()[valid];
        let lossy = String::from_utf8_lossy(error.as_bytes());
        let flaw = Flaw::new(
            valid..valid + '\u{FFFD}'.len_utf8(),
            format!("the file is not UTF-8 text: unexpected byte 0x{byte:02X}"),
            "save the file as plain text in the encoding UTF-8",
        );
        ProblemError::in_text(&name, &lossy, flaw)
    })?;
    Ok((name, text))
}
