//! Small pictures on the page, each beside its errors.

use base64::Engine as _;

use super::super::Record;
use super::super::record::Thumbnail;
use super::{escaped, heading, push};
use crate::math::srgb8_from_linear;
use crate::render::Picture;
use crate::scene::save_picture::png_bytes;

/// The pictures of a few views.
pub(super) fn pictures(html: &mut String, record: &Record) {
    if record.pictures.is_empty() {
        return;
    }
    heading(html, "pictures");
    push(
        html,
        "<p><small>Right of each picture its FLIP to the truth: black 0, red 1/3, yellow 2/3, white 1. \
         Below, the mean.</small></p>",
    );
    for view in &record.views {
        let of_view = |p: &&Thumbnail| p.view == view.index;
        let shown: Vec<_> = record.pictures.iter().filter(of_view).collect();
        if shown.is_empty() {
            continue;
        }
        push(
            html,
            &format!("<h3>{:.0}°</h3><div class=\"pictures\">", view.angle_deg),
        );
        for thumbnail in shown {
            push(html, &figure(record, thumbnail));
        }
        push(html, "</div>");
    }
}

fn figure(record: &Record, thumbnail: &Thumbnail) -> String {
    let label = escaped(&thumbnail.label);
    let image = |what: &str, data: &str| match data {
        "" => String::new(),
        _ => format!("<img alt=\"{what} of {label}\" src=\"data:image/png;base64,{data}\">"),
    };
    let bits = record.subject.map_bits;
    let cell = record.cells.iter().find(|c| {
        c.view == thumbnail.view && c.bits == bits && c.variant.label() == thumbnail.label
    });
    let flip = cell.map_or_else(String::new, |c| format!(" · FLIP {:.3}", c.picture.flip));
    format!(
        "<figure><div>{}{}</div><figcaption>{label}{flip}</figcaption></figure>",
        image("picture", &thumbnail.picture),
        image("errors", &thumbnail.error),
    )
}

/// A picture as the screen shows it, and its errors in false colours: PNGs in base64.
#[must_use]
pub fn thumbnail(picture: &Picture, errors: Option<&[f32]>) -> (Option<String>, Option<String>) {
    let size = [picture.width, picture.height];
    let shown: Vec<_> = picture
        .pixels
        .iter()
        .map(|&c| srgb8_from_linear(c))
        .collect();
    let colored = errors.map(|e| e.iter().map(|&e| heat(e)).collect::<Vec<_>>());
    let encoded = |pixels: &[[u8; 3]]| {
        let bytes = png_bytes(size, pixels)?;
        Some(base64::engine::general_purpose::STANDARD.encode(bytes))
    };
    (encoded(&shown), colored.and_then(|pixels| encoded(&pixels)))
}

/// From black by red and yellow to white.
fn heat(error: f32) -> [u8; 3] {
    let part = |start: f32| ((error * 3.0 - start).clamp(0.0, 1.0) * 255.0).round() as u8;
    [part(0.0), part(1.0), part(2.0)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::LinearRgb;

    #[test]
    fn heat_goes_from_black_to_white() {
        assert_eq!(heat(0.0), [0, 0, 0]);
        assert_eq!(heat(1.0 / 3.0), [255, 0, 0]);
        assert_eq!(heat(1.0), [255, 255, 255]);
        assert_eq!(heat(f32::NAN), [0, 0, 0]);
    }

    #[test]
    fn thumbnails_are_png() {
        let picture = Picture {
            width: 1,
            height: 1,
            pixels: vec![LinearRgb::gray(1.0)],
        };
        let (shown, error) = thumbnail(&picture, Some(&[0.5]));
        // The signature of PNG in base64.
        assert!(shown.is_some_and(|s| s.starts_with("iVBORw0KGgo")));
        assert!(error.is_some_and(|s| s.starts_with("iVBORw0KGgo")));
    }
}
