//! URIs: data URIs, and files beside the scene.
//!
//! A scene may come from anywhere, so it may name only files in its own folder or below.

use std::borrow::Cow;
use std::path::{Component, Path, PathBuf};

use base64::Engine;
use base64::alphabet::STANDARD;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};
use percent_encoding::percent_decode_str;

use super::error::LoadError;
use super::json::{Item, shorten};

/// Standard base64, with or without padding.
const BASE64: GeneralPurpose = GeneralPurpose::new(
    &STANDARD,
    GeneralPurposeConfig::new()
        .with_decode_padding_mode(DecodePaddingMode::Indifferent)
        .with_decode_allow_trailing_bits(true),
);

/// Where a URI leads.
#[derive(Debug)]
pub(super) enum Target {
    /// The bytes that the URI itself holds.
    Data(Vec<u8>),
    /// An existing regular file, canonical, inside the scene's folder.
    File(PathBuf),
}

/// Find what the `uri` of `item` refers to.
pub(super) fn resolve(item: &Item, uri: &str) -> Result<Target, LoadError> {
    let refuse = |problem: String| LoadError::Uri {
        path: item.file().to_owned(),
        object: item.label().to_owned(),
        uri: shorten(uri),
        problem,
    };
    if let Some(rest) = strip_scheme(uri, "data:") {
        return decode_data(rest).map(Target::Data).map_err(refuse);
    }
    if has_scheme(uri) {
        return Err(refuse(
            "has a scheme that is not supported; only `data:` and files beside the scene are read"
                .to_owned(),
        ));
    }
    let relative = relative_path(uri).map_err(refuse)?;
    locate(item, uri, &relative).map(Target::File)
}

fn strip_scheme<'a>(uri: &'a str, scheme: &str) -> Option<&'a str> {
    let head = uri.get(..scheme.len())?;
    head.eq_ignore_ascii_case(scheme)
        .then(|| &uri[scheme.len()..])
}

/// RFC 3986, section 3.1: a letter, then letters, digits, `+`, `-`, `.`, up to a colon.
fn has_scheme(uri: &str) -> bool {
    let Some((scheme, _)) = uri.split_once(':') else {
        return false;
    };
    scheme.starts_with(|c: char| c.is_ascii_alphabetic())
        && scheme
            .chars()
            .all(|c| c.is_ascii_alphanumeric() || "+-.".contains(c))
}

/// RFC 2397: `[mediatype][;base64],data`.
fn decode_data(rest: &str) -> Result<Vec<u8>, String> {
    let (head, data) = rest.split_once(',').ok_or("has no comma before its data")?;
    let data: Cow<[u8]> = match data.contains('%') {
        true => percent_decode_str(data).collect::<Vec<u8>>().into(),
        false => data.as_bytes().into(),
    };
    if !head.to_ascii_lowercase().ends_with(";base64") {
        return Ok(data.into_owned());
    }
    BASE64
        .decode(&data)
        .map_err(|error| format!("is not valid base64: {error}"))
}

/// The path that a URI spells, normalised, without `.` and `..`; or why it is refused.
fn relative_path(uri: &str) -> Result<PathBuf, String> {
    let decoded = percent_decode_str(uri)
        .decode_utf8()
        .map_err(|_| "does not decode to UTF-8 text".to_owned())?;
    if decoded.contains('\0') {
        return Err("contains a zero byte".to_owned());
    }
    // Windows exporters write backslashes.
    let decoded = decoded.replace('\\', "/");
    let mut path = PathBuf::new();
    for component in Path::new(&decoded).components() {
        match component {
            Component::Normal(name) => path.push(name),
            Component::CurDir => {}
            Component::ParentDir if path.pop() => {}
            Component::ParentDir => return Err(outside()),
            Component::RootDir | Component::Prefix(_) => {
                return Err("is an absolute path; name a file beside the scene".to_owned());
            }
        }
    }
    match path.as_os_str().is_empty() {
        true => Err("names no file".to_owned()),
        false => Ok(path),
    }
}

fn outside() -> String {
    "leaves the scene's folder; move the file beside the scene".to_owned()
}

/// The canonical path of an existing regular file in the scene's folder.
fn locate(item: &Item, uri: &str, relative: &Path) -> Result<PathBuf, LoadError> {
    let object = || format!("{} (file {:?})", item.label(), shorten(uri));
    let read_error = |source| LoadError::Read {
        path: item.file().to_owned(),
        object: object(),
        source,
    };
    let refuse = |problem: String| LoadError::Uri {
        path: item.file().to_owned(),
        object: item.label().to_owned(),
        uri: shorten(uri),
        problem,
    };
    let folder = match item.file().parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    let folder = folder.canonicalize().map_err(read_error)?;
    let path = folder.join(relative).canonicalize().map_err(read_error)?;
    if !path.starts_with(&folder) {
        return Err(refuse(outside()));
    }
    // A pipe or a device could block or never end.
    let is_file = path.metadata().map_err(read_error)?.is_file();
    is_file
        .then_some(path)
        .ok_or_else(|| refuse("does not name a regular file".to_owned()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_stay_inside_the_folder() {
        let path = |uri| relative_path(uri);
        assert_eq!(path("a%20b/./c.bin"), Ok(PathBuf::from("a b/c.bin")));
        assert_eq!(path("a/../c.bin"), Ok(PathBuf::from("c.bin")));
        assert_eq!(path("textures\\c.png"), Ok(PathBuf::from("textures/c.png")));
        for refused in [
            "../c.bin",
            "a/../../c.bin",
            "%2e%2e/c",
            "/etc/passwd",
            "%2Fetc",
            "\\\\host\\c",
            "",
            ".",
            "a%00b",
            "%FF",
        ] {
            assert!(path(refused).is_err(), "{refused}");
        }
    }

    #[test]
    fn data_uris_decode() {
        assert_eq!(decode_data("text/plain,a%20b"), Ok(b"a b".to_vec()));
        assert_eq!(
            decode_data("application/octet-stream;base64,AQID"),
            Ok(vec![1, 2, 3])
        );
        assert_eq!(decode_data(";base64,AQI"), Ok(vec![1, 2]));
        assert!(decode_data(";base64,A!").is_err());
        assert!(decode_data("nothing").is_err());
    }

    #[test]
    fn schemes_are_recognised() {
        assert!(has_scheme("http://x/y.bin") && has_scheme("file:///x") && has_scheme("C:\\x.bin"));
        assert!(!has_scheme("a/b:c.bin") && !has_scheme("x.bin") && !has_scheme("1:2"));
    }
}
