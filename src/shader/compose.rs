//! Follows `#include` lines: many files in, one text and its source map out.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use std::sync::Arc;

use super::diagnostic::{Diagnostic, Severity};
use super::include::{CommentDepth, Line, read_line};
use super::source_map::{ComposedLine, FileSpan, SourceFile, SourceMap};
use super::{ShaderError, ShaderLibrary, path};

/// Files that the host generates, as path -> text. They win over library files of the same path.
pub type VirtualFiles = BTreeMap<String, String>;

/// Composed texts are limited to this many bytes, which bounds the compiler's recursion.
const MAX_COMPOSED_BYTES: usize = 4 << 20;

/// A shader in one piece.
#[derive(Debug, Clone)]
pub struct Composed {
    /// The WGSL text; `#include` lines are left in it as comments.
    pub text: String,
    /// Where each line of it came from.
    pub source_map: SourceMap,
}

/// Puts `entry` and all that it includes into one text, each file once, at its first inclusion.
/// Inside a file lines and columns stay as they are. An include in a block comment does not count.
///
/// # Errors
/// [`ShaderError::Include`] with the position of a malformed include, a missing file, or a path
/// that is absolute, has `.` or `..`, or is spelt with `\`; of an unterminated block comment.
pub fn compose(
    library: &ShaderLibrary,
    virtuals: &VirtualFiles,
    entry: &str,
) -> Result<Composed, ShaderError> {
    let mut composer = Composer::new(library, virtuals);
    composer.open_entry(entry)?;
    while let Some(mut open) = composer.stack.pop() {
        composer.read_on(&mut open)?;
    }
    Ok(Composed {
        text: composer.text,
        source_map: SourceMap::new(composer.files, composer.lines),
    })
}

struct Composer<'a> {
    library: &'a ShaderLibrary,
    virtuals: &'a VirtualFiles,
    files: Vec<SourceFile>,
    seen: BTreeSet<String>,
    stack: Vec<OpenFile>,
    text: String,
    lines: Vec<ComposedLine>,
}

/// A file that has been read up to `next_line`.
struct OpenFile {
    file: usize,
    next_line: usize,
    comments: CommentDepth,
}

impl<'a> Composer<'a> {
    fn new(library: &'a ShaderLibrary, virtuals: &'a VirtualFiles) -> Self {
        Self {
            library,
            virtuals,
            files: Vec::new(),
            seen: BTreeSet::new(),
            stack: Vec::new(),
            text: String::new(),
            lines: Vec::new(),
        }
    }

    fn open_entry(&mut self, entry: &str) -> Result<(), ShaderError> {
        path::check(entry)
            .and_then(|()| self.open(entry).ok_or("there is no such file"))
            .map_err(|reason| ShaderError::Library {
                path: entry.to_owned(),
                library: self.library.describe(),
                reason: reason.to_owned(),
            })
    }

    /// Puts a file on the stack, if there is one of that path.
    fn open(&mut self, name: &str) -> Option<()> {
        let (shown, text) = match self.virtuals.get(name) {
            Some(text) => (format!("<generated>/{name}"), text.as_str()),
            None => (self.library.shown_path(name), self.library.get(name)?),
        };
        self.files
            .push(SourceFile::new(name.to_owned(), shown, text));
        self.seen.insert(name.to_owned());
        self.stack.push(OpenFile {
            file: self.files.len() - 1,
            next_line: 0,
            comments: CommentDepth::default(),
        });
        Some(())
    }

    /// Copies lines up to the next include of a new file, or to the end of the file.
    fn read_on(&mut self, open: &mut OpenFile) -> Result<(), ShaderError> {
        while open.next_line < self.files[open.file].line_count() {
            let number = open.next_line;
            open.next_line += 1;
            if let Some(path) = self.read_line(open, number)? {
                return self.enter(open, path);
            }
        }
        if open.comments.is_inside() {
            let start = open.comments.opened_at;
            let span = self.span(open.file, start..start + 2);
            return Err(self.error("this block comment is never closed", span, ""));
        }
        Ok(())
    }

    /// Copies one line; returns the path's place if it includes a file not yet seen.
    fn read_line(
        &mut self,
        open: &mut OpenFile,
        number: usize,
    ) -> Result<Option<Range<usize>>, ShaderError> {
        let range = self.files[open.file].line_range(number);
        let line = self.files[open.file].text[range.clone()].to_owned();
        let kind = if open.comments.is_inside() {
            Line::Text
        } else {
            read_line(&line)
        };
        let in_file = |r: Range<usize>| range.start + r.start..range.start + r.end;
        match kind {
            Line::Text => {
                open.comments.advance(&line, range.start);
                self.push_line(open.file, number, &line)?;
                Ok(None)
            }
            Line::Malformed(message, part) => {
                let span = self.span(open.file, in_file(part));
                Err(self.error(&message, span, ""))
            }
            Line::Include(part) => {
                let known = self.seen.contains(&line[part.clone()]);
                let suffix = if known { " (already included)" } else { "" };
                let comment = format!("// {}{suffix}", line.trim());
                self.push_line(open.file, number, &comment)?;
                Ok((!known).then(|| in_file(part)))
            }
        }
    }

    /// Opens the file that an include names, to go on with `open` afterwards.
    fn enter(&mut self, open: &mut OpenFile, path: Range<usize>) -> Result<(), ShaderError> {
        let name = self.files[open.file].text[path.clone()].to_owned();
        let span = self.span(open.file, path);
        if let Err(reason) = path::check(&name) {
            return Err(self.error(&format!("cannot include `{name}`: {reason}"), span, ""));
        }
        self.stack.push(OpenFile {
            comments: std::mem::take(&mut open.comments),
            ..*open
        });
        match self.open(&name) {
            Some(()) => Ok(()),
            None => Err(self.missing(&name, span)),
        }
    }

    fn push_line(&mut self, file: usize, line: usize, text: &str) -> Result<(), ShaderError> {
        self.lines.push(ComposedLine {
            start: self.text.len(),
            file,
            line,
        });
        self.text.push_str(text);
        self.text.push('\n');
        if self.text.len() > MAX_COMPOSED_BYTES {
            let start = self.files[file].line_range(line).start;
            let span = self.span(file, start..start);
            return Err(self.error("the composed shader is larger than 4 MiB", span, ""));
        }
        Ok(())
    }

    fn span(&self, file: usize, range: Range<usize>) -> FileSpan {
        FileSpan { file, range }
    }

    fn missing(&self, name: &str, span: FileSpan) -> ShaderError {
        let library = self.library.describe();
        let mut diagnostic = self
            .diagnostic(&format!("cannot include `{name}`: it is not in {library}"))
            .label(span, "no such file");
        if let Some(other) = self.same_name_elsewhere(name) {
            diagnostic = diagnostic.note(format!("there is `{other}`"));
        }
        if self.library.is_folder() {
            let advice = "a shader folder must be complete: \
                          `etendue shaders export DIR` writes the built-in files into a folder";
            diagnostic = diagnostic.note(advice);
        }
        ShaderError::Include(Box::new(diagnostic))
    }

    fn same_name_elsewhere(&self, name: &str) -> Option<String> {
        let last = |p: &str| p.rsplit('/').next().map(str::to_owned);
        let all = self
            .library
            .list()
            .into_iter()
            .chain(self.virtuals.keys().cloned());
        all.into_iter().find(|p| last(p) == last(name))
    }

    fn diagnostic(&self, message: &str) -> Diagnostic {
        Diagnostic::new(
            Severity::Error,
            message.to_owned(),
            Arc::new(self.files.clone()),
        )
    }

    fn error(&self, message: &str, span: FileSpan, label: &str) -> ShaderError {
        ShaderError::Include(Box::new(self.diagnostic(message).label(span, label)))
    }
}
