//! What the program says: results on stdout, errors and warnings on stderr.
//!
//! Nothing here panics when a stream is closed, as `println!` would.

use std::io::{self, ErrorKind, IsTerminal, Write};
use std::panic::PanicHookInfo;

use anyhow::Context;

use crate::render::RenderError;
use crate::shader::ShaderError;

/// Writes to stdout. A reader that has gone, as in `etendue info SCENE | head -1`, is no error.
///
/// # Errors
/// Any other failure to write.
pub fn print(text: &str) -> anyhow::Result<()> {
    let mut stdout = io::stdout().lock();
    let written = stdout
        .write_all(text.as_bytes())
        .and_then(|()| stdout.flush());
    match written {
        Err(e) if e.kind() != ErrorKind::BrokenPipe => Err(e).context("cannot write to stdout"),
        _ => Ok(()),
    }
}

/// Writes a line to stderr; if even that fails there is no one to tell.
pub fn note(line: &str) {
    let _ = writeln!(io::stderr(), "{line}");
}

/// One sentence, its causes joined by colons; shader errors with position, line and caret.
pub fn error(error: &anyhow::Error) {
    match error.chain().find_map(shader_error) {
        Some(shader) => note(shader_report(shader).trim_end()),
        None => note(&format!("error: {}", one_line(error))),
    }
}

/// The causes of an error joined by colons. A cause that the sentence before it quotes is left out.
pub fn one_line(error: &anyhow::Error) -> String {
    error
        .chain()
        .skip(1)
        .map(ToString::to_string)
        .fold(error.to_string(), |sentence, cause| {
            match sentence.contains(&cause) {
                true => sentence,
                false => format!("{sentence}: {cause}"),
            }
        })
}

fn shader_error<'a>(cause: &'a (dyn std::error::Error + 'static)) -> Option<&'a ShaderError> {
    match cause.downcast_ref::<RenderError>() {
        Some(RenderError::Shader(error)) => Some(error),
        _ => cause.downcast_ref::<ShaderError>(),
    }
}

fn shader_report(error: &ShaderError) -> String {
    let coloured = io::stderr().is_terminal() && std::env::var_os("NO_COLOR").is_none();
    match error.diagnostic() {
        Some(diagnostic) if coloured => diagnostic.to_ansi(),
        _ => error.report(),
    }
}

/// The panic hook: one line instead of a backtrace.
pub fn internal_error(info: &PanicHookInfo<'_>) {
    let place = info.location().map(|l| format!(" at {l}"));
    let payload = info.payload();
    let text = payload.downcast_ref::<&str>().copied();
    let text = text.or_else(|| payload.downcast_ref::<String>().map(String::as_str));
    let reason = text.unwrap_or("unknown reason");
    note(&format!(
        "error: internal error{}: {reason}; this is a bug of étendue, please report it with the scene and the command",
        place.unwrap_or_default()
    ));
}

/// Warnings: each a line on stderr at once, and all of them kept for the report.
#[derive(Debug, Default)]
pub struct Warnings {
    quiet: bool,
    list: Vec<String>,
}

impl Warnings {
    /// `quiet` keeps them off stderr.
    pub fn new(quiet: bool) -> Self {
        Self {
            quiet,
            list: Vec::new(),
        }
    }

    /// Adds one sentence.
    pub fn add(&mut self, text: impl Into<String>) {
        let text = text.into().replace('\n', " ");
        if !self.quiet {
            note(&format!("warning: {text}"));
        }
        self.list.push(text);
    }

    /// Adds several.
    pub fn add_all(&mut self, texts: &[String]) {
        texts.iter().for_each(|text| self.add(text));
    }

    /// All of them so far.
    pub fn list(&self) -> &[String] {
        &self.list
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn causes_are_joined_and_not_repeated() {
        let cause = io::Error::new(ErrorKind::NotFound, "no such file");
        let error = anyhow::Error::new(cause)
            .context("cannot open a: no such file")
            .context("scene");
        assert_eq!(one_line(&error), "scene: cannot open a: no such file");
    }
}
