//! Paths inside a shader library: relative, '/' separated, one spelling for each file.

/// Says what is wrong with an include path, if anything.
pub(super) fn check(path: &str) -> Result<(), &'static str> {
    if path.is_empty() {
        return Err("the path is empty");
    }
    if path.contains('\\') || path.contains(':') {
        return Err("a path is separated by `/` and has neither `\\` nor `:`");
    }
    if path.chars().any(char::is_control) {
        return Err("a path has no control characters");
    }
    if path.starts_with('/') {
        return Err("a path is relative to the shader root, it does not begin with `/`");
    }
    check_parts(path)
}

fn check_parts(path: &str) -> Result<(), &'static str> {
    for part in path.split('/') {
        match part {
            ".." | "." => {
                return Err("a path is relative to the shader root, `.` and `..` are not allowed");
            }
            "" => return Err("a part of the path is empty"),
            _ => {}
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::check;

    #[test]
    fn plain_paths_pass() {
        for path in ["a.wgsl", "bsdf/ggx.wgsl", "a b/ü.wgsl", "..a/b..wgsl"] {
            assert_eq!(check(path), Ok(()), "{path}");
        }
    }

    #[test]
    fn escapes_and_second_spellings_are_refused() {
        let bad = [
            "",
            "/etc/passwd",
            "../x",
            "a/../b",
            "a/..",
            "./a",
            "a//b",
            "a/",
            "a\\b",
            "C:/x",
        ];
        for path in bad {
            assert!(check(path).is_err(), "{path}");
        }
    }
}
