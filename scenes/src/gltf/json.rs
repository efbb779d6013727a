//! A place in the JSON text: a value together with its path, so that every complaint can say where.

use super::schema::Word;
use crate::Error;
use serde_json::Value;
use std::path::Path;

/// A JSON value of a file, and the path that leads to it. `null` counts as absent.
#[derive(Clone)]
pub(super) struct Json<'a> {
    pub file: &'a Path,
    pub value: &'a Value,
    pub path: String,
}

impl<'a> Json<'a> {
    /// The whole document.
    pub fn root(file: &'a Path, value: &'a Value) -> Self {
        Json { file, value, path: String::new() }
    }

    /// A property, where there is one.
    pub fn get(&self, key: &str) -> Option<Json<'a>> {
        let value = self.value.get(key).filter(|v| !v.is_null())?;
        Some(Json { file: self.file, value, path: self.path_to(key) })
    }

    /// A property that must be there.
    pub fn need(&self, key: &str) -> Result<Json<'a>, Error> {
        self.get(key).ok_or_else(|| self.fault_at(self.path_to(key), "missing"))
    }

    /// An extension of this object. Of one that is no object itself, all would silently be read as its defaults.
    pub fn extension(&self, name: &str) -> Result<Option<Json<'a>>, Error> {
        match self.get("extensions").and_then(|all| all.get(name)) {
            Some(ext) if !ext.value.is_object() => Err(ext.fault("not an object")),
            found => Ok(found),
        }
    }

    /// Elements of an array property; none when it is absent.
    pub fn list(&self, key: &str) -> Result<Vec<Json<'a>>, Error> {
        let Some(list) = self.get(key) else {
            return Ok(Vec::new());
        };
        list.elements().ok_or_else(|| list.fault("not an array"))
    }

    /// Elements of this value, if it is an array.
    pub fn elements(&self) -> Option<Vec<Json<'a>>> {
        let elements = self.value.as_array()?;
        Some((0..elements.len()).map(|i| self.element(&elements[i], i)).collect())
    }

    /// Length of an array property; 0 when it is absent.
    pub fn len(&self, key: &str) -> usize {
        self.value.get(key).and_then(Value::as_array).map_or(0, Vec::len)
    }

    /// This value as an index into the root's array `list`, and the element there: `noun` names what it holds.
    pub fn refer(&self, root: &Json<'a>, list: &str, noun: &str) -> Result<(usize, Json<'a>), Error> {
        let index = self.integer()?;
        let elements = root.value.get(list).and_then(Value::as_array).map_or(&[][..], Vec::as_slice);
        let position = usize::try_from(index).ok().filter(|&i| i < elements.len());
        let Some(i) = position else {
            return Err(self.index_fault(index, format!("{} {noun}", elements.len())));
        };
        let list = Json { file: self.file, value: root.value, path: root.path_to(list) };
        Ok((i, list.element(&elements[i], i)))
    }

    /// A whole number, not negative. Accepts `3.0`, which some exporters write.
    pub fn integer(&self) -> Result<u64, Error> {
        let whole = |x: &f64| *x >= 0.0 && *x <= 9e15 && x.fract() == 0.0;
        let number = self.value.as_u64().or_else(|| self.value.as_f64().filter(whole).map(|x| x as u64));
        number.ok_or_else(|| self.fault("not a non-negative integer"))
    }

    /// A number, in double precision. JSON has no infinities; what leaves single precision's range is refused.
    pub fn number(&self) -> Result<f64, Error> {
        let x = self.value.as_f64().ok_or_else(|| self.fault("not a number"))?;
        if (x as f32).is_finite() { Ok(x) } else { Err(self.fault("beyond the range of single precision")) }
    }

    /// A string.
    pub fn text(&self) -> Result<&'a str, Error> {
        self.value.as_str().ok_or_else(|| self.fault("not a string"))
    }

    /// Exactly `N` numbers.
    pub fn numbers<const N: usize>(&self) -> Result<[f64; N], Error> {
        let elements = self.value.as_array().filter(|a| a.len() == N);
        let elements = elements.ok_or_else(|| self.fault(format!("not an array of {N} numbers")))?;
        let mut numbers = [0.0; N];
        for (i, x) in numbers.iter_mut().enumerate() {
            *x = self.element(&elements[i], i).number()?;
        }
        Ok(numbers)
    }

    /// An optional integer property.
    pub fn integer_or(&self, key: &str, default: u64) -> Result<u64, Error> {
        self.get(key).map_or(Ok(default), |v| v.integer())
    }

    /// An optional number property.
    pub fn number_or(&self, key: &str, default: f64) -> Result<f64, Error> {
        self.get(key).map_or(Ok(default), |v| v.number())
    }

    /// An optional array property of exactly `N` numbers.
    pub fn numbers_or<const N: usize>(&self, key: &str, default: [f64; N]) -> Result<[f64; N], Error> {
        self.get(key).map_or(Ok(default), |v| v.numbers())
    }

    /// An optional true or false.
    pub fn flag(&self, key: &str) -> Result<bool, Error> {
        let Some(flag) = self.get(key) else {
            return Ok(false);
        };
        flag.value.as_bool().ok_or_else(|| flag.fault("neither true nor false"))
    }

    /// One of the schema's words.
    pub fn word<T: Word>(&self) -> Result<T, Error> {
        let code = || self.integer().ok().and_then(|code| u32::try_from(code).ok());
        let plain = self.value.as_str().map(Value::from).or_else(|| code().map(Value::from));
        let fault = || self.fault(format!("{} is none of {:?}", shorten(&self.value.to_string()), T::ALL));
        plain.and_then(T::parse).ok_or_else(fault)
    }

    /// An optional property that is one of the schema's words.
    pub fn word_or<T: Word>(&self, key: &str, default: T) -> Result<T, Error> {
        self.get(key).map_or(Ok(default), |v| v.word())
    }

    /// The author's name for this object, or nothing.
    pub fn name(&self) -> String {
        self.value.get("name").and_then(Value::as_str).unwrap_or_default().to_string()
    }

    /// A complaint about this value.
    pub fn fault(&self, reason: impl Into<String>) -> Error {
        self.fault_at(self.path.clone(), reason)
    }

    /// A complaint about an index found here, or in the data that this describes.
    pub fn index_fault(&self, index: u64, of: String) -> Error {
        Error::Index { file: self.file.into(), path: self.path.clone(), index, of }
    }

    /// A complaint about a size found here.
    pub fn limit_fault(&self, what: String, limit: String) -> Error {
        Error::Limit { file: self.file.into(), path: self.path.clone(), what, limit }
    }

    /// A complaint about the URI here; `reason` is a predicate.
    pub fn uri_fault(&self, reason: String) -> Error {
        Error::Uri { file: self.file.into(), path: self.path.clone(), uri: self.shown(), reason }
    }

    /// The first characters of this string, for messages: a data: URI may have millions.
    pub fn shown(&self) -> String {
        shorten(self.value.as_str().unwrap_or_default())
    }

    fn fault_at(&self, path: String, reason: impl Into<String>) -> Error {
        Error::Value { file: self.file.into(), path, reason: reason.into() }
    }

    fn element(&self, value: &'a Value, i: usize) -> Json<'a> {
        Json { file: self.file, value, path: format!("{}[{i}]", self.path) }
    }

    fn path_to(&self, key: &str) -> String {
        if self.path.is_empty() { key.to_string() } else { format!("{}.{key}", self.path) }
    }
}

fn shorten(text: &str) -> String {
    const SHOWN: usize = 60;
    match text.char_indices().nth(SHOWN) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.to_string(),
    }
}
