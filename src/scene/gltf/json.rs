//! A checked view of the file's JSON: every read says which object it concerns when it fails.

use std::path::Path;

use serde_json::{Map, Value};

use super::error::LoadError;

/// Longest piece of the file's own text that a message repeats, in characters.
const QUOTED: usize = 60;

/// A JSON object of the file, with the words that name it in messages.
#[derive(Debug, Clone)]
pub(super) struct Item<'a> {
    file: &'a Path,
    map: &'a Map<String, Value>,
    label: String,
}

impl<'a> Item<'a> {
    /// The outermost object of `file`.
    pub fn root(file: &'a Path, value: &'a Value) -> Result<Self, LoadError> {
        let label = "the file".to_owned();
        let map = value.as_object().ok_or_else(|| LoadError::Invalid {
            path: file.to_owned(),
            object: label.clone(),
            problem: format!("expected a JSON object, found {}", describe(value)),
        })?;
        Ok(Self { file, map, label })
    }

    /// Index and name of the object, as in `mesh 2 "teapot", primitive 0`.
    pub fn label(&self) -> &str {
        &self.label
    }

    /// The scene file, for messages and for what lies beside it.
    pub fn file(&self) -> &'a Path {
        self.file
    }

    /// The object's `name`, or nothing.
    pub fn name(&self) -> &'a str {
        self.map.get("name").and_then(Value::as_str).unwrap_or("")
    }

    /// An error about this object.
    pub fn fault(&self, problem: impl Into<String>) -> LoadError {
        LoadError::Invalid {
            path: self.file.to_owned(),
            object: self.label.clone(),
            problem: problem.into(),
        }
    }

    fn mismatch(&self, key: &str, expected: &str, value: &Value) -> LoadError {
        self.fault(format!(
            "`{key}` must be {expected}, found {}",
            describe(value)
        ))
    }

    /// The value of `key`; null counts as absent.
    pub fn value(&self, key: &str) -> Option<&'a Value> {
        self.map.get(key).filter(|value| !value.is_null())
    }

    /// The array `key`, empty if absent.
    pub fn array(&self, key: &str) -> Result<&'a [Value], LoadError> {
        match self.value(key) {
            None => Ok(&[]),
            Some(Value::Array(values)) => Ok(values),
            Some(value) => Err(self.mismatch(key, "an array", value)),
        }
    }

    /// The objects of the array `key`, each called `noun` and its index; below the root, this
    /// object's own label goes before.
    pub fn items(&self, key: &str, noun: &str) -> Result<Vec<Item<'a>>, LoadError> {
        let values = self.array(key)?.iter().enumerate();
        values
            .map(|(index, value)| self.child(value, format!("{noun} {index}")))
            .collect()
    }

    /// The object `key`, if present; `noun` names it after this object's own label.
    pub fn object(&self, key: &str, noun: &str) -> Result<Option<Item<'a>>, LoadError> {
        let value = self.value(key);
        value
            .map(|value| self.child(value, noun.to_owned()))
            .transpose()
    }

    fn child(&self, value: &'a Value, noun: String) -> Result<Item<'a>, LoadError> {
        let mut label = noun;
        if self.label != "the file" {
            label = format!("{}, {label}", self.label);
        }
        if let Some(name) = value.get("name").and_then(Value::as_str) {
            label.push_str(&format!(" {:?}", shorten(name)));
        }
        match value {
            Value::Object(map) => Ok(Item {
                file: self.file,
                map,
                label,
            }),
            _ => Err(LoadError::Invalid {
                path: self.file.to_owned(),
                object: label,
                problem: format!("expected a JSON object, found {}", describe(value)),
            }),
        }
    }

    /// The extension `name` of this object, if present.
    pub fn extension(&self, name: &str) -> Result<Option<Item<'a>>, LoadError> {
        let Some(extensions) = self.object("extensions", "extensions")? else {
            return Ok(None);
        };
        let Some(mut item) = extensions.object(name, name)? else {
            return Ok(None);
        };
        item.label = match self.label.as_str() {
            "the file" => name.to_owned(),
            label => format!("{label}, {name}"),
        };
        Ok(Some(item))
    }

    /// The string `key`, if present.
    pub fn text(&self, key: &str) -> Result<Option<&'a str>, LoadError> {
        match self.value(key) {
            None => Ok(None),
            Some(Value::String(text)) => Ok(Some(text)),
            Some(value) => Err(self.mismatch(key, "a string", value)),
        }
    }

    /// The boolean `key`, false if absent.
    pub fn flag(&self, key: &str) -> Result<bool, LoadError> {
        match self.value(key) {
            None => Ok(false),
            Some(Value::Bool(flag)) => Ok(*flag),
            Some(value) => Err(self.mismatch(key, "true or false", value)),
        }
    }

    /// The number `key`, if present; finite.
    pub fn number(&self, key: &str) -> Result<Option<f64>, LoadError> {
        let Some(value) = self.value(key) else {
            return Ok(None);
        };
        let number = value.as_f64().filter(|number| number.is_finite());
        number
            .map(Some)
            .ok_or_else(|| self.mismatch(key, "a finite number", value))
    }

    /// The number `key` rounded to f32, if present; finite.
    pub fn float(&self, key: &str) -> Result<Option<f32>, LoadError> {
        let Some(number) = self.number(key)? else {
            return Ok(None);
        };
        self.narrow(key, number).map(Some)
    }

    /// Exactly `N` finite numbers under `key`, if present.
    pub fn numbers<const N: usize>(&self, key: &str) -> Result<Option<[f64; N]>, LoadError> {
        let Some(value) = self.value(key) else {
            return Ok(None);
        };
        let wrong = || self.mismatch(key, &format!("an array of {N} finite numbers"), value);
        let values = value.as_array().filter(|values| values.len() == N);
        let values = values.ok_or_else(wrong)?;
        let mut numbers = [0.0; N];
        for (number, value) in numbers.iter_mut().zip(values) {
            let finite = value.as_f64().filter(|number| number.is_finite());
            *number = finite.ok_or_else(wrong)?;
        }
        Ok(Some(numbers))
    }

    /// Exactly `N` numbers under `key` rounded to f32, if present; finite.
    pub fn floats<const N: usize>(&self, key: &str) -> Result<Option<[f32; N]>, LoadError> {
        let Some(numbers) = self.numbers::<N>(key)? else {
            return Ok(None);
        };
        let mut floats = [0.0; N];
        for (float, number) in floats.iter_mut().zip(numbers) {
            *float = self.narrow(key, number)?;
        }
        Ok(Some(floats))
    }

    /// Any number of finite numbers under `key`, if present.
    pub fn number_list(&self, key: &str) -> Result<Option<Vec<f64>>, LoadError> {
        let Some(value) = self.value(key) else {
            return Ok(None);
        };
        let number = |value: &Value| value.as_f64().filter(|number| number.is_finite());
        let numbers = self.array(key)?.iter().map(number).collect::<Option<_>>();
        numbers
            .map(Some)
            .ok_or_else(|| self.mismatch(key, "an array of finite numbers", value))
    }

    fn narrow(&self, key: &str, number: f64) -> Result<f32, LoadError> {
        let float = number as f32;
        let problem = || format!("`{key}` is {number:e}, beyond the largest 32-bit float");
        float
            .is_finite()
            .then_some(float)
            .ok_or_else(|| self.fault(problem()))
    }

    /// The non-negative integer `key`, if present.
    pub fn count(&self, key: &str) -> Result<Option<usize>, LoadError> {
        let Some(value) = self.value(key) else {
            return Ok(None);
        };
        integer(value)
            .map(Some)
            .ok_or_else(|| self.mismatch(key, "a non-negative integer", value))
    }

    /// The non-negative integer `key`, which must be there.
    pub fn required_count(&self, key: &str) -> Result<usize, LoadError> {
        self.count(key)?
            .ok_or_else(|| self.fault(format!("`{key}` is missing")))
    }

    /// The index `key` into a list of `len` objects called `noun`, if present.
    pub fn index(&self, key: &str, noun: &str, len: usize) -> Result<Option<usize>, LoadError> {
        let Some(index) = self.count(key)? else {
            return Ok(None);
        };
        self.check_index(key, index, noun, len).map(Some)
    }

    /// The indices in the array `key` into a list of `len` objects called `noun`.
    pub fn indices(&self, key: &str, noun: &str, len: usize) -> Result<Vec<usize>, LoadError> {
        let values = self.array(key)?.iter();
        values
            .map(|value| self.element(key, value, noun, len))
            .collect()
    }

    /// `value`, an element of the array `key`, as an index into a list of `len` objects called `noun`.
    pub fn element(
        &self,
        key: &str,
        value: &Value,
        noun: &str,
        len: usize,
    ) -> Result<usize, LoadError> {
        let index = integer(value)
            .ok_or_else(|| self.mismatch(key, "an array of non-negative integers", value))?;
        self.check_index(key, index, noun, len)
    }

    fn check_index(
        &self,
        key: &str,
        index: usize,
        noun: &str,
        len: usize,
    ) -> Result<usize, LoadError> {
        if index < len {
            return Ok(index);
        }
        Err(self.fault(format!(
            "`{key}` refers to {noun} {index}, but the file has {}",
            counted(len, noun)
        )))
    }
}

/// The value as a non-negative integer; `3.0` is one.
fn integer(value: &Value) -> Option<usize> {
    /// Largest integer up to which every f64 is exact.
    const EXACT: f64 = 9_007_199_254_740_992.0;
    let float = || {
        value
            .as_f64()
            .filter(|x| x.fract() == 0.0 && (0.0..EXACT).contains(x))
    };
    let whole = value.as_u64().or_else(|| float().map(|x| x as u64))?;
    usize::try_from(whole).ok()
}

/// "1 texture", "3 textures", "no texture".
pub(super) fn counted(count: usize, noun: &str) -> String {
    match count {
        0 => format!("no {noun}"),
        1 => format!("1 {noun}"),
        _ => format!("{count} {noun}s"),
    }
}

/// A text of the file, short enough for a message.
pub(super) fn shorten(text: &str) -> String {
    match text.char_indices().nth(QUOTED) {
        None => text.to_owned(),
        Some((end, _)) => format!("{}…", &text[..end]),
    }
}

/// A few words that say what a JSON value is.
fn describe(value: &Value) -> String {
    match value {
        Value::Null => "null".to_owned(),
        Value::Bool(flag) => flag.to_string(),
        Value::Number(number) => number.to_string(),
        Value::String(text) => format!("the string {:?}", shorten(text)),
        Value::Array(values) => format!("an array of {}", counted(values.len(), "value")),
        Value::Object(_) => "an object".to_owned(),
    }
}
