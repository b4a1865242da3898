//! Choosing a scene or a camera by index or by name.

use std::convert::Infallible;
use std::fmt;
use std::str::FromStr;

use thiserror::Error;

/// An index or a name, as a user writes it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Selector {
    /// Position in the list, from 0.
    Index(usize),
    /// Exact name; the first of that name wins.
    Name(String),
}

impl FromStr for Selector {
    type Err = Infallible;

    /// Digits are an index, anything else is a name.
    fn from_str(text: &str) -> Result<Self, Self::Err> {
        Ok(match text.parse() {
            Ok(index) => Self::Index(index),
            Err(_) => Self::Name(text.to_owned()),
        })
    }
}

impl fmt::Display for Selector {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Index(index) => write!(f, "{index}"),
            Self::Name(name) => write!(f, "{name:?}"),
        }
    }
}

/// No object answers to a [`Selector`].
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("there is no {kind} {wanted}; {}", list_choices(.kind, .names))]
pub struct SelectError {
    /// What was looked for: "scene" or "camera".
    pub kind: &'static str,
    /// What the user asked for.
    pub wanted: Selector,
    /// The names that exist, in order; unnamed objects are empty.
    pub names: Vec<String>,
}

impl Selector {
    /// Index of the selected object among those called `names`.
    ///
    /// # Errors
    /// [`SelectError`] that lists the names, when none matches.
    pub fn find<S: AsRef<str>>(
        &self,
        kind: &'static str,
        names: &[S],
    ) -> Result<usize, SelectError> {
        let found = match self {
            Self::Index(index) => (*index < names.len()).then_some(*index),
            Self::Name(wanted) => names.iter().position(|name| name.as_ref() == wanted),
        };
        found.ok_or_else(|| SelectError {
            kind,
            wanted: self.clone(),
            names: names.iter().map(|name| name.as_ref().to_owned()).collect(),
        })
    }
}

/// "choose one of 0 "front", 1 "side"", at most twenty of them.
fn list_choices(kind: &str, names: &[String]) -> String {
    const SHOWN: usize = 20;
    if names.is_empty() {
        return format!("the file has no {kind}");
    }
    let mut shown: Vec<String> = names
        .iter()
        .enumerate()
        .take(SHOWN)
        .map(|(index, name)| format!("{index} {name:?}"))
        .collect();
    if names.len() > SHOWN {
        shown.push(format!("{} more", names.len() - SHOWN));
    }
    format!("choose one of {}", shown.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_are_an_index_and_the_rest_a_name() {
        assert_eq!("7".parse(), Ok(Selector::Index(7)));
        assert_eq!("7a".parse(), Ok(Selector::Name("7a".into())));
    }

    #[test]
    fn an_unknown_name_lists_the_known_ones() {
        let error = Selector::Name("top".into())
            .find("camera", &["front", ""])
            .expect_err("there is no top");
        assert_eq!(
            error.to_string(),
            "there is no camera \"top\"; choose one of 0 \"front\", 1 \"\""
        );
    }
}
