//! From a byte of the composed text back to the file and line that a person edited.

use std::fmt;
use std::ops::Range;
use std::sync::Arc;

/// One file of a composed shader.
#[derive(Debug, Clone)]
pub struct SourceFile {
    /// Path from the shader root.
    pub path: String,
    /// How messages name the file: with the folder on disk where there is one.
    pub shown: String,
    /// The whole text, without a byte order mark.
    pub text: String,
    line_starts: Vec<usize>,
}

/// Bytes of one file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FileSpan {
    /// Index into [`SourceMap::files`].
    pub file: usize,
    /// Byte range in that file's text, on character boundaries.
    pub range: Range<usize>,
}

/// A position that an editor understands.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Location {
    /// Path from the shader root.
    pub file: String,
    /// Line, from 1.
    pub line: usize,
    /// Column in characters, from 1; a tab counts as one.
    pub column: usize,
}

impl fmt::Display for Location {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}:{}", self.file, self.line, self.column)
    }
}

/// Which file and line each line of a composed text came from.
#[derive(Debug, Clone)]
pub struct SourceMap {
    files: Arc<Vec<SourceFile>>,
    lines: Vec<ComposedLine>,
}

/// One line of the composed text; its bytes are the file's, column for column.
#[derive(Debug, Clone, Copy)]
pub(super) struct ComposedLine {
    pub(super) start: usize,
    pub(super) file: usize,
    /// From 0.
    pub(super) line: usize,
}

impl SourceFile {
    pub(super) fn new(path: String, shown: String, text: &str) -> Self {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text).to_owned();
        let breaks = text.bytes().enumerate().filter(|(_, b)| *b == b'\n');
        let line_starts = std::iter::once(0)
            .chain(breaks.map(|(i, _)| i + 1))
            .collect();
        Self {
            path,
            shown,
            text,
            line_starts,
        }
    }

    /// Number of lines; a final line break does not begin another.
    pub fn line_count(&self) -> usize {
        let open_end = !self.text.ends_with('\n') && !self.text.is_empty();
        self.line_starts.len() - usize::from(!open_end)
    }

    /// Byte range of a line, from 0, without its line break.
    pub fn line_range(&self, line: usize) -> Range<usize> {
        let start = self
            .line_starts
            .get(line)
            .copied()
            .unwrap_or(self.text.len());
        let end = match self.line_starts.get(line + 1) {
            Some(next) => next - 1,
            None => self.text.len(),
        };
        start..end
    }

    /// The text of a line, from 0.
    pub fn line(&self, line: usize) -> &str {
        &self.text[self.line_range(line)]
    }

    /// The line, from 0, that holds a byte.
    pub(super) fn line_of(&self, byte: usize) -> usize {
        self.line_starts
            .partition_point(|s| *s <= byte)
            .saturating_sub(1)
    }

    /// Line and column of a byte.
    pub fn location(&self, byte: usize) -> Location {
        let byte = floor_char(&self.text, byte);
        let line = self.line_of(byte);
        let start = self.line_range(line).start;
        Location {
            file: self.path.clone(),
            line: line + 1,
            column: self.text[start..byte].chars().count() + 1,
        }
    }
}

/// The last character boundary at or before `byte`, inside the text.
pub(super) fn floor_char(text: &str, byte: usize) -> usize {
    let byte = byte.min(text.len());
    let before = (0..=byte).rev();
    before
        .take(4)
        .find(|i| text.is_char_boundary(*i))
        .unwrap_or(0)
}

impl SourceMap {
    pub(super) fn new(files: Vec<SourceFile>, lines: Vec<ComposedLine>) -> Self {
        Self {
            files: Arc::new(files),
            lines,
        }
    }

    /// The files, in the order of their first inclusion; the first is the entry.
    pub fn files(&self) -> &[SourceFile] {
        &self.files
    }

    pub(super) fn shared_files(&self) -> Arc<Vec<SourceFile>> {
        Arc::clone(&self.files)
    }

    /// File, line and column of a byte of the composed text.
    pub fn locate(&self, byte: usize) -> Location {
        let (file, byte) = self.place(byte);
        self.files[file].location(byte)
    }

    /// The bytes of one file that a range of the composed text covers. A range that crosses files
    /// ends with the last byte that lies in the file where it begins.
    pub fn span(&self, range: Range<usize>) -> FileSpan {
        let (file, start) = self.place(range.start);
        let mut end = start;
        if range.end > range.start {
            let (first, last) = (self.line_index(range.start), self.line_index(range.end - 1));
            let own = (first..=last).rev().find(|i| self.lines[*i].file == file);
            let last_byte = own.map_or(range.start, |i| self.line_end(i).min(range.end));
            end = self
                .place_in_line(own.unwrap_or(first), last_byte)
                .max(start);
        }
        FileSpan {
            file,
            range: start..end,
        }
    }

    fn line_end(&self, index: usize) -> usize {
        self.lines
            .get(index + 1)
            .map_or(usize::MAX, |next| next.start - 1)
    }

    fn line_index(&self, byte: usize) -> usize {
        self.lines
            .partition_point(|l| l.start <= byte)
            .saturating_sub(1)
    }

    fn place(&self, byte: usize) -> (usize, usize) {
        let index = self.line_index(byte);
        let file = self.lines.get(index).map_or(0, |l| l.file);
        (file, self.place_in_line(index, byte))
    }

    fn place_in_line(&self, index: usize, byte: usize) -> usize {
        let Some(line) = self.lines.get(index) else {
            return 0;
        };
        let file = &self.files[line.file];
        let range = file.line_range(line.line);
        let place = range.start + byte.saturating_sub(line.start);
        floor_char(&file.text, place.min(range.end))
    }
}
