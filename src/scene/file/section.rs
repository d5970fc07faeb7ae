//! Reads one table of a scene file: every key once, with its line, type and range. What is left over is
//! unknown.

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::fault::{Fault, Read, nearest};
use crate::math::LinearRgb;

/// What a number may be. Nothing but finite numbers ever is.
#[derive(Debug, Clone, Copy)]
pub(super) enum Limits {
    /// Any finite number.
    Finite,
    /// This or more.
    AtLeast(f64),
    /// More than this.
    Above(f64),
    /// From the first to the second, both included.
    Within(f64, f64),
    /// Between the two, both excluded.
    Between(f64, f64),
}

impl Limits {
    fn holds(self, x: f64) -> bool {
        x.is_finite()
            && match self {
                Self::Finite => true,
                Self::AtLeast(low) => x >= low,
                Self::Above(low) => x > low,
                Self::Within(low, high) => x >= low && x <= high,
                Self::Between(low, high) => x > low && x < high,
            }
    }

    fn words(self) -> String {
        match self {
            Self::Finite => "a finite number".to_owned(),
            Self::AtLeast(low) => format!("at least {low}"),
            Self::Above(low) => format!("above {low}"),
            Self::Within(low, high) => format!("from {low} to {high}"),
            Self::Between(low, high) => format!("between {low} and {high}"),
        }
    }
}

/// One table, its place, and the keys that were asked for.
pub(super) struct Section<'a> {
    /// `camera`, `light.0`; empty for the file itself.
    name: String,
    at: usize,
    entries: &'a DeTable<'a>,
    known: Vec<&'static str>,
}

impl<'a> Section<'a> {
    /// The file itself.
    pub fn root(entries: &'a DeTable<'a>) -> Self {
        Self {
            name: String::new(),
            at: 0,
            entries,
            known: Vec::new(),
        }
    }

    /// The value of a key, if the table has it.
    pub fn item(&mut self, key: &'static str) -> Option<Item<'a>> {
        self.known.push(key);
        let (spanned, value) = self.entries.get_key_value(key)?;
        Some(Item {
            name: self.full(key),
            at: spanned.span().start,
            value,
        })
    }

    /// The value of a key, read by `read`.
    pub fn read<T>(
        &mut self,
        key: &'static str,
        read: impl FnOnce(&Item<'a>) -> Read<T>,
    ) -> Read<Option<T>> {
        self.item(key).as_ref().map(read).transpose()
    }

    /// The tables of an array of tables, or `None` without the key.
    pub fn sections(&mut self, key: &'static str) -> Read<Option<Vec<Self>>> {
        let Some(item) = self.item(key) else {
            return Ok(None);
        };
        let parts = item.parts("an array of tables")?;
        parts
            .iter()
            .map(Item::section)
            .collect::<Read<_>>()
            .map(Some)
    }

    /// A table, or an empty one without the key.
    pub fn section(&mut self, key: &'static str) -> Read<Option<Self>> {
        self.read(key, Item::section)
    }

    /// A fault of the table as a whole.
    pub fn fault(&self, message: impl Into<String>) -> Fault {
        Fault::new(self.at, message)
    }

    /// Where the table begins.
    pub const fn at(&self) -> usize {
        self.at
    }

    /// How messages call the table.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Refuses keys that nobody asked for.
    pub fn finish(self) -> Read<()> {
        let unknown = self
            .entries
            .keys()
            .filter(|key| !self.known.contains(&key.get_ref().as_ref()))
            .min_by_key(|key| key.span().start);
        let Some(key) = unknown else { return Ok(()) };
        let word = key.get_ref().as_ref();
        let advice = nearest(word, self.known.iter().copied()).map_or_else(
            || format!("known here: {}", self.known.join(", ")),
            |name| format!("did you mean `{name}`?"),
        );
        Err(Fault::new(
            key.span().start,
            format!("unknown key `{}`; {advice}", self.full(word)),
        ))
    }

    fn full(&self, key: &str) -> String {
        if self.name.is_empty() {
            key.to_owned()
        } else {
            format!("{}.{key}", self.name)
        }
    }
}

/// One value, its key in full and its place.
pub(super) struct Item<'a> {
    name: String,
    at: usize,
    value: &'a Spanned<DeValue<'a>>,
}

impl<'a> Item<'a> {
    /// A fault of this value; `message` follows the key.
    pub fn fault(&self, message: impl AsRef<str>) -> Fault {
        Fault::new(self.at, format!("`{}` {}", self.name, message.as_ref()))
    }

    /// Where the key stands.
    pub const fn at(&self) -> usize {
        self.at
    }

    /// How messages call the key.
    pub fn name(&self) -> &str {
        &self.name
    }

    fn wrong_type(&self, wanted: &str) -> Fault {
        let found = match self.value.get_ref() {
            DeValue::String(s) => format!("the string \"{s}\""),
            DeValue::Integer(n) => n.to_string(),
            DeValue::Float(x) => x.to_string(),
            DeValue::Boolean(b) => format!("{b}"),
            DeValue::Datetime(_) => "a date".to_owned(),
            DeValue::Array(a) => format!("an array of {}", a.len()),
            DeValue::Table(_) => "a table".to_owned(),
        };
        self.fault(format!("must be {wanted}, not {found}"))
    }

    /// `true` or `false`.
    pub fn boolean(&self) -> Read<bool> {
        match self.value.get_ref() {
            DeValue::Boolean(b) => Ok(*b),
            _ => Err(self.wrong_type("true or false")),
        }
    }

    /// A string.
    pub fn text(&self) -> Read<String> {
        match self.value.get_ref() {
            DeValue::String(s) => Ok(s.clone().into_owned()),
            _ => Err(self.wrong_type("a string")),
        }
    }

    /// The string, if it is one.
    pub fn as_str(&self) -> Option<&str> {
        self.value.get_ref().as_str()
    }

    /// One of `all` by its name.
    pub fn choice<T: Copy>(&self, all: &[T], name: impl Fn(T) -> &'static str) -> Read<T> {
        let names: Vec<&str> = all.iter().map(|&x| name(x)).collect();
        let list = names
            .iter()
            .map(|n| format!("\"{n}\""))
            .collect::<Vec<_>>()
            .join(", ");
        let found = self
            .value
            .get_ref()
            .as_str()
            .ok_or_else(|| self.wrong_type(&format!("one of {list}")))?;
        let position = names.iter().position(|&n| n == found);
        position.map(|i| all[i]).ok_or_else(|| {
            let advice = nearest(found, names.iter().copied())
                .map_or_else(String::new, |n| format!("; did you mean \"{n}\"?"));
            self.fault(format!("must be one of {list}, not \"{found}\"{advice}"))
        })
    }

    /// A number.
    pub fn number(&self, limits: Limits) -> Read<f64> {
        let x = match self.value.get_ref() {
            DeValue::Float(x) => x.as_str().parse::<f64>().ok(),
            DeValue::Integer(n) => i128::from_str_radix(n.as_str(), n.radix())
                .ok()
                .map(|n| n as f64),
            _ => return Err(self.wrong_type("a number")),
        };
        x.filter(|&x| limits.holds(x))
            .ok_or_else(|| self.wrong_type(&limits.words()))
    }

    /// A number in single precision.
    pub fn single(&self, limits: Limits) -> Read<f32> {
        let x = self.number(limits)? as f32;
        if x.is_finite() {
            Ok(x)
        } else {
            Err(self.wrong_type("less than 3.4e38 in size"))
        }
    }

    /// A whole number from `low` to `high`.
    pub fn integer(&self, low: u32, high: u32) -> Read<u32> {
        let wanted = format!("a whole number from {low} to {high}");
        match self.value.get_ref() {
            DeValue::Integer(n) => i128::from_str_radix(n.as_str(), n.radix())
                .ok()
                .and_then(|n| u32::try_from(n).ok())
                .filter(|n| (low..=high).contains(n))
                .ok_or_else(|| self.wrong_type(&wanted)),
            _ => Err(self.wrong_type(&wanted)),
        }
    }

    /// An array of exactly `N` values, each read by `read`.
    pub fn array<const N: usize, T: Copy + Default>(
        &self,
        read: impl Fn(&Self) -> Read<T>,
    ) -> Read<[T; N]> {
        let wanted = format!("an array of {N} numbers");
        let parts = self.parts(&wanted)?;
        if parts.len() != N {
            return Err(self.wrong_type(&wanted));
        }
        let mut values = [T::default(); N];
        for (value, part) in values.iter_mut().zip(&parts) {
            *value = read(part)?;
        }
        Ok(values)
    }

    /// Three numbers.
    pub fn vector(&self) -> Read<glam::DVec3> {
        self.array(|x| x.number(Limits::Finite))
            .map(glam::DVec3::from_array)
    }

    /// Three numbers that are not all zero.
    pub fn direction(&self) -> Read<glam::DVec3> {
        let v = self.vector()?;
        if v == glam::DVec3::ZERO {
            return Err(self.fault("must not be zero"));
        }
        Ok(v)
    }

    /// Linear red, green and blue, none negative.
    pub fn color(&self) -> Read<LinearRgb> {
        self.array(|x| x.single(Limits::AtLeast(0.0)))
            .map(|[r, g, b]| LinearRgb::new(r, g, b))
    }

    /// Whether the value is a table.
    pub fn is_table(&self) -> bool {
        self.value.get_ref().is_table()
    }

    /// The value as a table.
    pub fn section(&self) -> Read<Section<'a>> {
        match self.value.get_ref() {
            DeValue::Table(entries) => Ok(Section {
                name: self.name.clone(),
                at: self.at,
                entries,
                known: Vec::new(),
            }),
            _ => Err(self.wrong_type("a table")),
        }
    }

    /// The elements of an array; `light.0` names the first light.
    fn parts(&self, wanted: &str) -> Read<Vec<Self>> {
        let DeValue::Array(array) = self.value.get_ref() else {
            return Err(self.wrong_type(wanted));
        };
        let parts = array.iter().enumerate().map(|(i, value)| Self {
            name: format!("{}.{i}", self.name),
            at: value.span().start,
            value,
        });
        Ok(parts.collect())
    }
}
