//! A page in Markdown: its fenced blocks, the text around them, and the names of its headings.

use std::fs;
use std::path::{Path, PathBuf};

/// The root of the repository.
pub const ROOT: &str = env!("CARGO_MANIFEST_DIR");

/// A fenced block.
pub struct Block {
    /// Number of the line of its fence, from 1.
    pub line: usize,
    /// First word after the fence.
    pub language: String,
    /// What follows that word: the name of a file, or a mark.
    pub note: String,
    pub text: String,
}

/// A page of the documentation.
pub struct Page {
    pub path: PathBuf,
    pub blocks: Vec<Block>,
    /// All lines outside of blocks.
    pub prose: String,
}

impl Page {
    /// Reads a page by its path below the root.
    pub fn read(name: &str) -> Page {
        let path = Path::new(ROOT).join(name);
        let text = fs::read_to_string(&path).unwrap_or_else(|error| panic!("{name}: {error}"));
        let (mut blocks, mut prose) = (Vec::new(), String::new());
        let mut open: Option<Block> = None;
        for (index, line) in text.lines().enumerate() {
            let fence = line.strip_prefix("```");
            if let Some(mut block) = open.take() {
                if fence.is_some() {
                    blocks.push(block);
                } else {
                    block.text += &format!("{line}\n");
                    open = Some(block);
                }
            } else if let Some(information) = fence {
                let (language, note) = information.split_once(' ').unwrap_or((information, ""));
                open = Some(Block {
                    line: index + 1,
                    language: language.to_owned(),
                    note: note.trim().to_owned(),
                    text: String::new(),
                });
            } else {
                prose += &format!("{line}\n");
            }
        }
        assert!(open.is_none(), "{name}: a block has no end");
        Page {
            path,
            blocks,
            prose,
        }
    }

    /// What stands between single backquotes.
    pub fn code_spans(&self) -> impl Iterator<Item = &str> {
        self.prose
            .lines()
            .flat_map(|line| line.split('`').skip(1).step_by(2))
    }

    /// The addresses of its links and pictures.
    pub fn links(&self) -> impl Iterator<Item = &str> {
        let after = self.prose.split("](").skip(1);
        let addresses = after.filter_map(|text| text.split_once(')').map(|(address, _)| address));
        // an address has no blanks, a formula has
        addresses.filter(|address| !address.contains(' '))
    }

    /// Whether it has a heading with this name in the address bar.
    pub fn has_anchor(&self, anchor: &str) -> bool {
        let headings = self.prose.lines().filter(|line| line.starts_with('#'));
        headings
            .map(|line| slug(line.trim_start_matches('#')))
            .any(|name| name == anchor)
    }
}

/// The name that a heading has in an address: lower case, blanks as hyphens, without marks.
fn slug(heading: &str) -> String {
    let kept = |c: &char| c.is_alphanumeric() || matches!(c, '_' | '-' | ' ');
    let name: String = heading.trim().to_lowercase().chars().filter(kept).collect();
    name.replace(' ', "-")
}
