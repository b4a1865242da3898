//! The `#include "path"` line, and the block comments in which it does not count.

use std::ops::Range;

/// What a line of a shader file is to the composer.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Line {
    /// WGSL, passed through.
    Text,
    /// An include, with the byte range of the path inside the line.
    Include(Range<usize>),
    /// A line that begins with `#` and is no include: what is wrong, and where in the line.
    Malformed(String, Range<usize>),
}

/// Reads a line that does not begin inside a block comment.
pub(super) fn read_line(line: &str) -> Line {
    let start = line.len() - line.trim_start().len();
    let directive = &line[start..];
    if !directive.starts_with('#') {
        return Line::Text;
    }
    let whole = start..start + directive.trim_end().len();
    let Some(rest) = directive.strip_prefix("#include") else {
        let message = "the only directive is `#include \"path.wgsl\"`";
        return Line::Malformed(message.to_owned(), whole);
    };
    read_path(line, line.len() - rest.len())
        .unwrap_or_else(|m| Line::Malformed(m.to_owned(), whole))
}

/// Reads `"path"`, and at most a comment behind it, from byte `start` of the line on.
fn read_path(line: &str, start: usize) -> Result<Line, &'static str> {
    let rest = &line[start..];
    let quoted = rest.trim_start().strip_prefix('"');
    let quoted = quoted.ok_or("`#include` is followed by a path in double quotes")?;
    let (path, tail) = quoted
        .split_once('"')
        .ok_or("the path's closing quote is missing")?;
    if !is_blank_or_comment(tail) {
        return Err("an `#include` stands alone on its line");
    }
    let begin = line.len() - quoted.len();
    Ok(Line::Include(begin..begin + path.len()))
}

fn is_blank_or_comment(tail: &str) -> bool {
    let tail = tail.trim();
    let block = tail.strip_prefix("/*").and_then(|t| t.strip_suffix("*/"));
    tail.is_empty() || tail.starts_with("//") || block.is_some_and(|t| !t.contains("*/"))
}

/// How deep in (nesting) block comments the text is.
#[derive(Debug, Clone, Default)]
pub(super) struct CommentDepth {
    depth: usize,
    /// Byte in the file where the outermost open comment begins.
    pub(super) opened_at: usize,
}

impl CommentDepth {
    pub(super) fn is_inside(&self) -> bool {
        self.depth > 0
    }

    /// Reads a line that begins at byte `offset` of its file.
    pub(super) fn advance(&mut self, line: &str, offset: usize) {
        let mut rest = line;
        while let Some(at) = self.next_mark(rest) {
            let mark = &rest[at..];
            if mark.starts_with("//") {
                rest = mark.trim_start_matches(|c| !is_line_break(c));
                continue;
            }
            self.step(mark, offset + line.len() - mark.len());
            rest = &mark[2..];
        }
    }

    /// Finds the next `/*`, or `*/` (inside a comment), or `//` (outside).
    fn next_mark(&self, rest: &str) -> Option<usize> {
        let pairs = rest.as_bytes().windows(2);
        let inside = self.is_inside();
        let is_mark = |p: &[u8]| p == b"/*" || p == if inside { b"*/" } else { b"//" };
        pairs.into_iter().position(is_mark)
    }

    fn step(&mut self, mark: &str, position: usize) {
        if mark.starts_with("*/") {
            self.depth -= 1;
            return;
        }
        if self.depth == 0 {
            self.opened_at = position;
        }
        self.depth += 1;
    }
}

/// The characters that end a `//` comment in WGSL.
fn is_line_break(c: char) -> bool {
    matches!(c, '\n'..='\r' | '\u{85}' | '\u{2028}' | '\u{2029}')
}

#[cfg(test)]
mod tests {
    use super::*;

    fn path_of(line: &str) -> Option<&str> {
        match read_line(line) {
            Line::Include(range) => Some(&line[range]),
            _ => None,
        }
    }

    #[test]
    fn includes_with_blanks_and_comments() {
        for line in [
            "#include \"a/b.wgsl\"",
            "  \t#include   \"a/b.wgsl\"  ",
            "#include\"a/b.wgsl\" // why",
            "#include \"a/b.wgsl\" /* why */\r",
        ] {
            assert_eq!(path_of(line), Some("a/b.wgsl"), "{line}");
        }
    }

    #[test]
    fn malformed_includes() {
        for line in [
            "#include a.wgsl",
            "#include <a.wgsl>",
            "#include \"a.wgsl",
            "#include \"a.wgsl\" fn f() {}",
            "#include \"a.wgsl\" /* c */ fn f() {} /* d */",
            "#includes",
            "#define X",
            "# include \"a.wgsl\"",
        ] {
            assert!(matches!(read_line(line), Line::Malformed(..)), "{line}");
        }
    }

    #[test]
    fn other_lines_are_text() {
        for line in [
            "",
            "fn f() {}",
            "// #include \"a\"",
            "let a = 1; #include \"a\"",
        ] {
            assert_eq!(read_line(line), Line::Text, "{line}");
        }
    }

    #[test]
    fn block_comments_nest_and_line_comments_hide_them() {
        let depth = |text: &str| {
            let mut comment = CommentDepth::default();
            comment.advance(text, 10);
            (comment.depth, comment.opened_at)
        };
        assert_eq!(depth("a /* b"), (1, 12));
        assert_eq!(depth("/* /* */"), (1, 10));
        assert_eq!(depth("/* // */"), (0, 10));
        assert_eq!(depth("// /* b"), (0, 0));
        assert_eq!(depth("// b\r/* c"), (1, 15));
        assert_eq!(depth("/*/"), (1, 10));
        assert_eq!(depth("é /* é"), (1, 13));
    }
}
