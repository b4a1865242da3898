//! naga's errors as [`Diagnostic`]s in the files that people edit.

use std::error::Error;
use std::ops::Range;

use naga::front::wgsl::ParseError;
use naga::{Span, WithSpan};

use super::compose::Composed;
use super::diagnostic::{Diagnostic, Severity};
use super::source_map::FileSpan;

/// Makes diagnostics for one composed shader.
#[derive(Clone, Copy)]
pub(super) struct Reporter<'a> {
    composed: &'a Composed,
}

impl<'a> Reporter<'a> {
    pub(super) fn new(composed: &'a Composed) -> Self {
        Self { composed }
    }

    /// A diagnostic without a place.
    pub(super) fn plain(&self, severity: Severity, message: impl Into<String>) -> Diagnostic {
        let sources = self.composed.source_map.shared_files();
        Diagnostic::new(severity, message.into(), sources)
    }

    /// An error at a place of the composed text.
    pub(super) fn at(&self, message: impl Into<String>, range: Range<usize>) -> Diagnostic {
        self.plain(Severity::Error, message)
            .label(self.place(range), "")
    }

    pub(super) fn place(&self, range: Range<usize>) -> FileSpan {
        self.composed.source_map.span(range)
    }

    pub(super) fn text(&self) -> &'a str {
        &self.composed.text
    }

    /// Where `keyword name` stands in the text, if it does: the place of `name`.
    pub(super) fn find_declaration(&self, keyword: &str, name: &str) -> Option<Range<usize>> {
        let text = self.text();
        let places = words(text, name);
        places
            .into_iter()
            .find(|r| text[..r.start].trim_end().ends_with(keyword))
    }

    pub(super) fn parse_error(&self, error: &ParseError) -> Diagnostic {
        let mut diagnostic = self.plain(Severity::Error, error.message());
        let first = error.labels().find_map(|(span, _)| span.to_range());
        let previous = first.and_then(|range| self.end_of_previous_file(range.start));
        if let Some((span, false)) = &previous {
            let message = "this file ends with something unfinished";
            diagnostic = diagnostic.label(span.clone(), message);
        }
        for (span, message) in error.labels() {
            if let Some(range) = span.to_range() {
                diagnostic = diagnostic.label(self.place(range), message);
            }
        }
        if let Some((span, true)) = previous {
            let message = "the file before ends here: is a `}` missing?";
            diagnostic = diagnostic.label(span, message);
        }
        for note in error.notes() {
            diagnostic = diagnostic.note(note);
        }
        self.placed(diagnostic)
    }

    /// If `byte` begins a file's first text, or its first behind an include: the end of the text
    /// before it, which is another file's and may be what is wrong; and whether that looks finished.
    fn end_of_previous_file(&self, byte: usize) -> Option<(FileSpan, bool)> {
        let before = self.text().get(..byte)?.trim_end_matches('@');
        let mut lines = before.split_inclusive('\n').rev();
        let mut end = before.len();
        let line = lines.find(|line| {
            let code = line.trim();
            let skip = code.is_empty() || code.starts_with("//");
            end -= if skip { line.len() } else { 0 };
            !skip
        })?;
        let last = end - line.len() + line.trim_end().len();
        let width = line
            .trim_end()
            .chars()
            .next_back()
            .map_or(0, char::len_utf8);
        let span = self.place(last - width..last);
        let finished = line.trim_end().ends_with(['}', ';']);
        (span.file != self.place(byte..byte).file).then_some((span, finished))
    }

    /// The place to look at is the first that naga says something about, else the narrowest: it
    /// lists the enclosing function first, and a call's arguments with the call.
    pub(super) fn span_error<E: Error>(&self, error: &WithSpan<E>) -> Diagnostic {
        let (message, notes) = flatten(error.as_inner());
        let mut diagnostic = self.plain(Severity::Error, message);
        let mut spans: Vec<_> = error.spans().collect();
        let width = |span: &Span| span.to_range().map_or(usize::MAX, |r| r.len());
        spans.sort_by_key(|(span, label)| (label.starts_with("naga::"), width(span)));
        for (span, label) in spans {
            if let Some(range) = span.to_range() {
                diagnostic = diagnostic.label(self.place(range), readable_label(label));
            }
        }
        if diagnostic.message.contains("`return` expression None") {
            diagnostic = diagnostic.note("a way through the function ends without `return VALUE;`");
        }
        for note in notes {
            diagnostic = diagnostic.note(note);
        }
        self.placed(diagnostic)
    }

    /// An error without spans.
    pub(super) fn chain_error(&self, error: &dyn Error) -> Diagnostic {
        let (message, notes) = flatten(error);
        let diagnostic = self.plain(Severity::Error, message);
        let diagnostic = notes.into_iter().fold(diagnostic, Diagnostic::note);
        self.placed(diagnostic)
    }

    /// Gives a diagnostic without a place the best that its message allows: the declaration of
    /// something that it names in quotes, else the beginning of the entry file.
    fn placed(&self, diagnostic: Diagnostic) -> Diagnostic {
        if !diagnostic.labels.is_empty() {
            return diagnostic;
        }
        let names = quoted(&diagnostic.message);
        let keywords = ["fn", "struct", "const", "override", "var", ">", "alias"];
        let place = names.iter().find_map(|name| {
            let found = keywords.iter().find_map(|k| self.find_declaration(k, name));
            found.or_else(|| words(self.text(), name).into_iter().next())
        });
        let note = "the shader compiler gave no position";
        let range = place.unwrap_or(0..0);
        diagnostic.label(self.place(range), "").note(note)
    }
}

/// "what is invalid: why", and what stands between the two.
fn flatten(error: &dyn Error) -> (String, Vec<String>) {
    let mut chain = vec![wgsl_types(&error.to_string())];
    let mut next = error.source();
    while let Some(source) = next {
        chain.push(wgsl_types(&source.to_string()));
        next = source.source();
    }
    chain.dedup();
    let first = chain.remove(0);
    match chain.pop() {
        Some(last) => (format!("{}: {last}", without_handle(&first)), chain),
        None => (without_handle(&first), chain),
    }
}

/// Writes the types in a message of naga's as WGSL has them.
fn wgsl_types(message: &str) -> String {
    let kinds = [
        ("Float", "f32"),
        ("Uint", "u32"),
        ("Sint", "i32"),
        ("Bool", "bool"),
    ];
    let mut message = message.to_owned();
    for (kind, name) in kinds {
        let width = if kind == "Bool" { 1 } else { 4 };
        let scalar = format!("Scalar {{ kind: {kind}, width: {width} }}");
        for (size, count) in [("Bi", 2), ("Tri", 3), ("Quad", 4)] {
            let vector = format!("Vector {{ size: {size}, scalar: {scalar} }}");
            message = message.replace(&vector, &format!("vec{count}<{name}>"));
        }
        message = message.replace(&format!("Scalar({scalar})"), name);
        message = message.replace(&scalar, name);
    }
    message
}

/// Drops naga's arena index from the thing that an error is about: "Function [3] 'f' is invalid".
fn without_handle(message: &str) -> String {
    let Some((before, rest)) = message.split_once(" [") else {
        return message.to_owned();
    };
    match rest.split_once("] '") {
        Some((index, after)) if index.bytes().all(|b| b.is_ascii_digit()) => {
            format!("{before} '{after}")
        }
        _ => message.to_owned(),
    }
}

/// naga labels a handle's span with its Rust type and index: of use only to those who wrote naga,
/// but for the index of an expression, by which other messages name it.
fn readable_label(label: &str) -> String {
    let Some((path, index)) = label.rsplit_once(' ') else {
        return label.to_owned();
    };
    if !path.starts_with("naga::") {
        return label.to_owned();
    }
    match path.rsplit("::").next().unwrap_or_default() {
        "Expression" => format!("expression {index}"),
        "Function" => "in this function".to_owned(),
        "GlobalVariable" => "this variable".to_owned(),
        "Type" => "this type".to_owned(),
        other => format!("this {}", other.to_lowercase()),
    }
}

/// The parts of a message between single or back quotes, and words behind "Entry point".
fn quoted(message: &str) -> Vec<String> {
    let marks = message.split(['\'', '`']).skip(1).step_by(2);
    let entry = message
        .strip_prefix("Entry point ")
        .and_then(|m| m.split(' ').next());
    let names = entry.into_iter().chain(marks);
    names.filter(|n| is_name(n)).map(str::to_owned).collect()
}

fn is_name(text: &str) -> bool {
    !text.is_empty() && text.chars().all(is_name_char)
}

fn is_name_char(c: char) -> bool {
    c == '_' || c.is_alphanumeric()
}

/// Every place where `name` stands as a whole word, outside line comments.
pub(super) fn words(text: &str, name: &str) -> Vec<Range<usize>> {
    let whole = |&(at, _): &(usize, &str)| {
        let before = text[..at]
            .chars()
            .next_back()
            .is_none_or(|c| !is_name_char(c));
        let after = text[at + name.len()..]
            .chars()
            .next()
            .is_none_or(|c| !is_name_char(c));
        let line = text[..at].rsplit('\n').next().unwrap_or_default();
        before && after && !line.contains("//")
    };
    let places = text.match_indices(name).filter(whole);
    places.map(|(at, _)| at..at + name.len()).collect()
}
