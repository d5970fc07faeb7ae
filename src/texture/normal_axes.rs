//! Which axes the channels of an object-space normal map tell.

use std::fmt;

use crate::math::{Real, V3};

/// A direction along an axis of the model's file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FileAxis {
    /// 0, 1 or 2 for x, y and z.
    index: usize,
    negative: bool,
}

impl FileAxis {
    /// All six, for menus.
    pub const ALL: [Self; 6] = [
        Self::new(0, false),
        Self::new(0, true),
        Self::new(1, false),
        Self::new(1, true),
        Self::new(2, false),
        Self::new(2, true),
    ];

    const fn new(index: usize, negative: bool) -> Self {
        Self { index, negative }
    }

    /// As scene files and menus write it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match (self.index, self.negative) {
            (0, false) => "+x",
            (0, true) => "-x",
            (1, false) => "+y",
            (1, true) => "-y",
            (_, false) => "+z",
            (_, true) => "-z",
        }
    }
}

/// The axes of the model's file that red, green and blue tell, each axis once: bakers have up and forward of their own,
/// exporters turn the model to others.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct NormalAxes([FileAxis; 3]);

impl NormalAxes {
    /// Red tells x, green y and blue z.
    pub const FILE: Self = Self([
        FileAxis::new(0, false),
        FileAxis::new(1, false),
        FileAxis::new(2, false),
    ]);

    /// From three axes with or without signs, such as `+x -z +y`; case and spaces mean nothing. `None` unless each of x,
    /// y and z is there once.
    #[must_use]
    pub fn parse(text: &str) -> Option<Self> {
        let mut axes = Vec::new();
        let mut sign = None;
        for letter in text.chars().filter(|c| !c.is_whitespace()) {
            match letter {
                '+' | '-' if sign.is_none() => sign = Some(letter == '-'),
                _ => {
                    let index = "xyz".find(letter.to_ascii_lowercase())?;
                    axes.push(FileAxis::new(index, sign.take().unwrap_or(false)));
                }
            }
        }
        let axes: [FileAxis; 3] = axes.try_into().ok()?;
        let each_once = (0..3).all(|index| axes.iter().any(|axis| axis.index == index));
        (each_once && sign.is_none()).then_some(Self(axes))
    }

    /// What red, green and blue tell.
    #[must_use]
    pub const fn channels(self) -> [FileAxis; 3] {
        self.0
    }

    /// The same, but for a channel (0 red, 1 green, 2 blue) that tells another axis. The channel that told it takes what
    /// this one told.
    ///
    /// # Panics
    /// If there is no such channel.
    #[must_use]
    pub fn with(mut self, channel: usize, axis: FileAxis) -> Self {
        let before = self.0[channel];
        for other in &mut self.0 {
            if other.index == axis.index {
                *other = before;
            }
        }
        self.0[channel] = axis;
        self
    }

    /// A stored vector in the axes of the file.
    #[inline(always)]
    #[must_use]
    pub fn in_file<F: Real>(self, stored: V3<F>) -> V3<F> {
        let zero = stored.x.splat(0.0);
        let mut told = [zero; 3];
        for (value, axis) in [stored.x, stored.y, stored.z].into_iter().zip(self.0) {
            told[axis.index] = if axis.negative { -value } else { value };
        }
        let [x, y, z] = told;
        V3::new(x, y, z)
    }
}

impl fmt::Display for NormalAxes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [red, green, blue] = self.0.map(FileAxis::name);
        write!(f, "{red} {green} {blue}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_are_read_as_they_are_written() {
        for text in ["+x +y +z", "+x -z +y", "-z -x -y"] {
            let axes = NormalAxes::parse(text).map(|axes| axes.to_string());
            assert_eq!(axes.as_deref(), Some(text));
        }
        assert_eq!(NormalAxes::parse(" XZ-Y"), NormalAxes::parse("+x+z-y"));
        for text in [
            "",
            "+x +y",
            "+x +x +z",
            "+x +y +z +",
            "x y z x",
            "--x y z",
            "x y w",
        ] {
            assert_eq!(NormalAxes::parse(text), None, "{text}");
        }
    }

    #[test]
    fn no_axis_is_told_twice_or_not_at_all() {
        for channel in 0..3 {
            for axis in FileAxis::ALL {
                let axes = NormalAxes::FILE.with(channel, axis);
                assert_eq!(axes.channels()[channel], axis);
                assert_eq!(NormalAxes::parse(&axes.to_string()), Some(axes));
            }
        }
    }

    #[test]
    fn vectors_are_turned_into_the_axes_of_the_file() {
        // Blender's z is up, an exported file's y: what Blender calls y looks against the file's z.
        let axes = NormalAxes::parse("+x -z +y").expect("all three");
        let V3 { x, y, z } = axes.in_file(V3::new(0.1_f32, 0.2, 0.3));
        assert_eq!([x, y, z], [0.1, 0.3, -0.2]);
    }
}
