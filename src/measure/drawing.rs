//! Flat drawings of lines, dots and words: one description, for files and for the window.

use std::fmt::Write as _;

/// What a drawing is made of. Coordinates are points, y down.
#[derive(Debug, Clone, PartialEq)]
pub enum Shape {
    /// Joined segments.
    Line {
        /// Corners.
        points: Vec<[f32; 2]>,
        /// Width in points.
        width: f32,
        /// Colour.
        color: [u8; 3],
        /// Whether it is broken into dashes.
        dashed: bool,
    },
    /// A filled area.
    Area {
        /// Corners; the last joins the first.
        points: Vec<[f32; 2]>,
        /// Colour.
        color: [u8; 3],
    },
    /// A filled circle.
    Dot {
        /// Middle.
        at: [f32; 2],
        /// Radius in points.
        radius: f32,
        /// Colour.
        color: [u8; 3],
    },
    /// One line of text.
    Text {
        /// Where its base line starts, ends, or has its middle.
        at: [f32; 2],
        /// Which of these.
        anchor: Anchor,
        /// Size in points.
        size: f32,
        /// Colour.
        color: [u8; 3],
        /// The words.
        text: String,
    },
}

/// Which part of a text lies at its place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Anchor {
    /// Its start.
    Start,
    /// Its middle.
    Middle,
    /// Its end.
    End,
}

/// Shapes on a sheet, the first at the bottom.
#[derive(Debug, Clone, PartialEq)]
pub struct Drawing {
    /// Width and height in points.
    pub size: [f32; 2],
    /// Colour of the sheet.
    pub paper: [u8; 3],
    /// What is on it.
    pub shapes: Vec<Shape>,
}

impl Drawing {
    /// The drawing as an SVG file.
    #[must_use]
    pub fn to_svg(&self) -> String {
        let [w, h] = self.size;
        let mut svg = String::new();
        // Writing to a string cannot fail.
        let _ = write!(
            svg,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{w}\" height=\"{h}\" viewBox=\"0 0 {w} {h}\" \
             font-family=\"system-ui, sans-serif\">\n<rect width=\"{w}\" height=\"{h}\" fill=\"{}\"/>\n",
            hex(self.paper)
        );
        for shape in &self.shapes {
            svg.push_str(&element(shape));
            svg.push('\n');
        }
        svg.push_str("</svg>\n");
        svg
    }
}

fn element(shape: &Shape) -> String {
    match shape {
        Shape::Line {
            points,
            width,
            color,
            dashed,
        } => {
            let dashes = if *dashed {
                " stroke-dasharray=\"5 4\""
            } else {
                ""
            };
            format!(
                "<polyline fill=\"none\" stroke=\"{}\" stroke-width=\"{width}\" \
                 stroke-linejoin=\"round\"{dashes} points=\"{}\"/>",
                hex(*color),
                list(points)
            )
        }
        Shape::Area { points, color } => {
            format!(
                "<polygon fill=\"{}\" points=\"{}\"/>",
                hex(*color),
                list(points)
            )
        }
        Shape::Dot { at, radius, color } => format!(
            "<circle cx=\"{:.2}\" cy=\"{:.2}\" r=\"{radius}\" fill=\"{}\"/>",
            at[0],
            at[1],
            hex(*color)
        ),
        Shape::Text {
            at,
            anchor,
            size,
            color,
            text,
        } => {
            let anchor = match anchor {
                Anchor::Start => "start",
                Anchor::Middle => "middle",
                Anchor::End => "end",
            };
            format!(
                "<text stroke=\"none\" x=\"{:.2}\" y=\"{:.2}\" font-size=\"{size}\" text-anchor=\"{anchor}\" \
                 fill=\"{}\">{}</text>",
                at[0],
                at[1],
                hex(*color),
                escaped(text)
            )
        }
    }
}

fn list(points: &[[f32; 2]]) -> String {
    let mut list = String::new();
    for [x, y] in points {
        let _ = write!(list, "{x:.2},{y:.2} ");
    }
    list
}

fn hex([r, g, b]: [u8; 3]) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_escaped_and_colours_written_in_hex() {
        let drawing = Drawing {
            size: [20.0, 10.0],
            paper: [255, 0, 16],
            shapes: vec![Shape::Text {
                at: [1.0, 2.0],
                anchor: Anchor::End,
                size: 9.0,
                color: [0, 0, 0],
                text: "a < b & c".to_owned(),
            }],
        };
        let svg = drawing.to_svg();
        assert!(svg.starts_with("<svg ") && svg.ends_with("</svg>\n"));
        assert!(svg.contains("#ff0010") && svg.contains(">a &lt; b &amp; c</text>"));
    }
}
