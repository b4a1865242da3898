//! A report about a shader: message, position, the line and a caret.

use std::fmt;
use std::ops::Range;
use std::sync::Arc;

use codespan_reporting::diagnostic as codespan;
use codespan_reporting::files::{Error as FilesError, Files};
use codespan_reporting::term::{Chars, Config, emit_to_io_write, emit_to_write_style, termcolor};

use super::source_map::{FileSpan, Location, SourceFile, floor_char};

/// How bad it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Severity {
    /// Nothing was compiled.
    Error,
    /// It was compiled, and may not do what its author thinks.
    Warning,
}

/// A place and what to say about it.
#[derive(Debug, Clone)]
pub struct Label {
    /// The place.
    pub span: FileSpan,
    /// What to say; may be empty.
    pub message: String,
}

/// An error or a warning about a shader; its `Display` is the whole report in plain text:
/// `error: message`, `  --> file:line:column`, the line and a caret.
#[derive(Debug, Clone)]
pub struct Diagnostic {
    /// Error or warning.
    pub severity: Severity,
    /// One sentence.
    pub message: String,
    /// The places: the first is the one to look at, the others help to understand.
    pub labels: Vec<Label>,
    /// Further sentences.
    pub notes: Vec<String>,
    sources: Arc<Vec<SourceFile>>,
}

impl Diagnostic {
    pub(super) fn new(severity: Severity, message: String, sources: Arc<Vec<SourceFile>>) -> Self {
        Self {
            severity,
            message,
            labels: Vec::new(),
            notes: Vec::new(),
            sources,
        }
    }

    /// Adds a place, cut to its first line.
    pub(super) fn label(mut self, span: FileSpan, message: impl Into<String>) -> Self {
        let range = match self.sources.get(span.file) {
            Some(file) => first_line(file, span.range),
            None => return self,
        };
        self.labels.push(Label {
            span: FileSpan { range, ..span },
            message: message.into(),
        });
        self
    }

    pub(super) fn note(mut self, note: impl Into<String>) -> Self {
        self.notes.push(note.into());
        self
    }

    /// File, line and column of the first place.
    pub fn location(&self) -> Option<Location> {
        let span = &self.labels.first()?.span;
        Some(self.sources.get(span.file)?.location(span.range.start))
    }

    /// The report with the terminal's colours.
    pub fn to_ansi(&self) -> String {
        let mut writer = termcolor::Ansi::new(Vec::new());
        let written = emit_to_write_style(&mut writer, &config(), &self.view(), &self.codespan());
        let bytes = writer.into_inner();
        match (written, String::from_utf8(bytes)) {
            (Ok(()), Ok(text)) => text,
            _ => self.plain(),
        }
    }

    fn view(&self) -> View<'_> {
        let used = |i: usize| self.labels.iter().any(|l| l.span.file == i);
        let files = self.sources.iter().enumerate();
        let texts = files.map(|(i, f)| {
            if used(i) {
                printable(&f.text)
            } else {
                String::new()
            }
        });
        View {
            files: &self.sources,
            texts: texts.collect(),
        }
    }

    fn codespan(&self) -> codespan::Diagnostic<usize> {
        let severity = match self.severity {
            Severity::Error => codespan::Severity::Error,
            Severity::Warning => codespan::Severity::Warning,
        };
        let labels = self.labels.iter().enumerate().map(|(i, label)| {
            let style = if i == 0 {
                codespan::LabelStyle::Primary
            } else {
                codespan::LabelStyle::Secondary
            };
            codespan::Label::new(style, label.span.file, label.span.range.clone())
                .with_message(printable(&label.message))
        });
        codespan::Diagnostic::new(severity)
            .with_message(printable(&self.message))
            .with_labels(labels.collect())
            .with_notes(self.notes.iter().map(|n| printable(n)).collect())
    }

    /// The report without its lines, should the renderer fail.
    fn plain(&self) -> String {
        let place = self
            .location()
            .map(|l| format!("\n  --> {l}"))
            .unwrap_or_default();
        format!("error: {}{place}\n", self.message)
    }
}

impl fmt::Display for Diagnostic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut bytes = Vec::new();
        let written = emit_to_io_write(&mut bytes, &config(), &self.view(), &self.codespan());
        match (written, String::from_utf8(bytes)) {
            (Ok(()), Ok(text)) => f.write_str(text.trim_end_matches('\n')),
            _ => f.write_str(&self.plain()),
        }
    }
}

fn config() -> Config {
    Config {
        chars: Chars::ascii(),
        ..Config::default()
    }
}

/// Cuts a range to its first line that is not blank.
fn first_line(file: &SourceFile, range: Range<usize>) -> Range<usize> {
    let end = floor_char(&file.text, range.end);
    let start = floor_char(&file.text, range.start.min(end));
    let covered = &file.text[start..end];
    let blank = if covered.trim().is_empty() {
        0
    } else {
        covered.len() - covered.trim_start().len()
    };
    let start = start + blank;
    let line_end = file.line_range(file.line_of(start)).end;
    let shown = &file.text[start..end.min(line_end).max(start)];
    start..start + shown.trim_end().len()
}

/// Replaces what could disturb a terminal (control and text-direction characters) by as many
/// bytes, so that positions stay.
fn printable(text: &str) -> String {
    let replace = |(i, c): (usize, char)| match c {
        '\n' | '\t' => c,
        '\r' if text[i + 1..].starts_with('\n') => c,
        '\0'..='\x1f' | '\x7f' => '?',
        '\u{80}'..='\u{9f}' => '¿',
        '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}' => '\u{fffd}',
        _ => c,
    };
    text.char_indices().map(replace).collect()
}

/// The files as codespan wants them.
struct View<'a> {
    files: &'a [SourceFile],
    texts: Vec<String>,
}

impl<'a> Files<'a> for View<'_> {
    type FileId = usize;
    type Name = &'a str;
    type Source = &'a str;

    fn name(&'a self, id: usize) -> Result<&'a str, FilesError> {
        self.files
            .get(id)
            .map(|f| f.shown.as_str())
            .ok_or(FilesError::FileMissing)
    }

    fn source(&'a self, id: usize) -> Result<&'a str, FilesError> {
        self.texts
            .get(id)
            .map(String::as_str)
            .ok_or(FilesError::FileMissing)
    }

    fn line_index(&'a self, id: usize, byte: usize) -> Result<usize, FilesError> {
        let file = self.files.get(id).ok_or(FilesError::FileMissing)?;
        Ok(file.line_of(byte))
    }

    fn line_range(&'a self, id: usize, line: usize) -> Result<Range<usize>, FilesError> {
        let file = self.files.get(id).ok_or(FilesError::FileMissing)?;
        let range = file.line_range(line);
        Ok(range.start..(range.end + 1).min(file.text.len()))
    }
}
