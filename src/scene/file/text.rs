//! Writes TOML that reads well and gives every number back bit for bit.

use std::fmt::{Display, Write as _};

use glam::DVec3;

use super::write::SaveError;
use crate::math::LinearRgb;

/// The text so far and the table that keys go to.
pub(super) struct Text {
    text: String,
    /// For messages: `light.0.`.
    prefix: String,
    /// Name and number of the last array table, for tables inside it.
    parent: (String, usize),
}

impl Text {
    /// Opens with a comment.
    pub fn new(comment: &str) -> Self {
        let lines = comment.lines().map(|line| format!("# {line}\n"));
        Self {
            text: lines.chain(["\n".to_owned()]).collect(),
            prefix: String::new(),
            parent: (String::new(), 0),
        }
    }

    /// The whole text.
    pub fn finish(self) -> String {
        self.text
    }

    /// Starts `[name]`.
    pub fn table(&mut self, name: &str) {
        self.header(&format!("\n[{name}]"));
        self.prefix = format!("{name}.");
    }

    /// Starts entry `index` of `[[name]]`.
    pub fn array_table(&mut self, name: &str, index: usize) {
        self.header(&format!("\n[[{name}]]"));
        self.prefix = format!("{name}.{index}.");
        self.parent = (name.to_owned(), index);
    }

    /// Starts entry `index` of `[[parent.name]]` inside the last array table.
    pub fn sub_array_table(&mut self, name: &str, index: usize) {
        let (parent, number) = &self.parent;
        self.prefix = format!("{parent}.{number}.{name}.{index}.");
        let header = format!("[[{parent}.{name}]]");
        self.header(&header);
    }

    fn header(&mut self, header: &str) {
        self.text.push_str(header);
        self.text.push('\n');
    }

    /// A key with a value that is TOML already.
    pub fn raw(&mut self, key: &str, value: impl Display) {
        // Writing to a string cannot fail.
        let _ = writeln!(self.text, "{key} = {value}");
    }

    /// A string.
    pub fn string(&mut self, key: &str, value: &str) {
        self.raw(key, toml::Value::String(value.to_owned()));
    }

    /// A number in double precision.
    pub fn double(&mut self, key: &str, value: f64) -> Result<(), SaveError> {
        let value = self.finite(key, value)?;
        self.raw(key, double_text(value));
        Ok(())
    }

    /// A number in single precision.
    pub fn single(&mut self, key: &str, value: f32) -> Result<(), SaveError> {
        self.finite(key, f64::from(value))?;
        self.raw(key, single_text(value));
        Ok(())
    }

    /// Numbers in single precision.
    pub fn singles(&mut self, key: &str, values: &[f32]) -> Result<(), SaveError> {
        let list = self.list(key, values)?;
        self.raw(key, list);
        Ok(())
    }

    /// A number, or "default" for none.
    pub fn or_default<T: Into<f64> + Copy + Number>(
        &mut self,
        key: &str,
        value: Option<T>,
    ) -> Result<(), SaveError> {
        match value {
            None => self.string(key, "default"),
            Some(value) => {
                self.finite(key, value.into())?;
                self.raw(key, value.text());
            }
        }
        Ok(())
    }

    /// Three numbers.
    pub fn vector(&mut self, key: &str, v: DVec3) -> Result<(), SaveError> {
        for x in v.to_array() {
            self.finite(key, x)?;
        }
        let [x, y, z] = v.to_array().map(double_text);
        self.raw(key, format!("[{x}, {y}, {z}]"));
        Ok(())
    }

    /// Linear red, green, blue.
    pub fn color(&mut self, key: &str, color: LinearRgb) -> Result<(), SaveError> {
        self.singles(key, &color.to_array())
    }

    /// A colour for use inside another value.
    pub fn color_text(&self, key: &str, color: LinearRgb) -> Result<String, SaveError> {
        self.list(key, &color.to_array())
    }

    fn list(&self, key: &str, values: &[f32]) -> Result<String, SaveError> {
        for &value in values {
            self.finite(key, f64::from(value))?;
        }
        let values: Vec<String> = values.iter().copied().map(single_text).collect();
        Ok(format!("[{}]", values.join(", ")))
    }

    fn finite(&self, key: &str, value: f64) -> Result<f64, SaveError> {
        if value.is_finite() {
            Ok(value)
        } else {
            Err(SaveError::NotFinite(format!("{}{key}", self.prefix)))
        }
    }
}

/// A number that can be written.
pub(super) trait Number {
    /// TOML that reads back to the same bits.
    fn text(self) -> String;
}

impl Number for f64 {
    fn text(self) -> String {
        double_text(self)
    }
}

impl Number for f32 {
    fn text(self) -> String {
        single_text(self)
    }
}

/// The shortest decimal that reads back to the same double; always with a point or an exponent.
fn double_text(x: f64) -> String {
    format!("{x:?}")
}

/// The shortest decimal that reads back to the same single by way of a double, as TOML numbers are read.
fn single_text(x: f32) -> String {
    let short = format!("{x:?}");
    // Rounding twice can miss where the decimal lies next to the middle between two singles.
    if short.parse::<f64>().is_ok_and(|wide| wide as f32 == x) {
        short
    } else {
        double_text(f64::from(x))
    }
}

/// Degrees that convert back to `radians` exactly, with as few decimals as do; the nearest where none does.
pub(super) fn degrees(radians: f64) -> f64 {
    let plain = radians.to_degrees();
    (0..=15)
        .filter_map(|decimals| format!("{plain:.decimals$}").parse::<f64>().ok())
        .chain([plain, plain.next_up(), plain.next_down()])
        .find(|degrees| degrees.to_radians() == radians)
        .unwrap_or(plain)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn singles_survive_the_way_through_doubles() {
        let mut bits = 1_u32;
        for _ in 0..20_000 {
            bits = crate::math::hash(bits);
            let x = f32::from_bits(bits);
            if x.is_finite() {
                let back = single_text(x).parse::<f64>().expect("a number") as f32;
                assert_eq!(back.to_bits(), x.to_bits(), "{x:?}");
            }
        }
    }

    #[test]
    fn degrees_are_short_and_exact() {
        for i in 1..1800 {
            let wanted = f64::from(i) / 10.0;
            assert_eq!(degrees(wanted.to_radians()), wanted);
        }
    }
}
