//! Files to damage: those of `tests/data`, and small pictures of every format.

use std::fs;
use std::io::Cursor;
use std::path::Path;

use image::{DynamicImage, ImageBuffer, ImageFormat};

use crate::support::PICTURE_FORMATS;

/// What a file is read as.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    Obj,
    Mtl,
    Toml,
    /// With its ending.
    Picture(&'static str),
}

impl Format {
    /// Name of the file that is read.
    pub fn file(self) -> String {
        match self {
            Self::Obj => "case.obj".to_owned(),
            Self::Mtl => "case.mtl".to_owned(),
            Self::Toml => "case.toml".to_owned(),
            Self::Picture(ending) => format!("case.{ending}"),
        }
    }

    pub const fn is_text(self) -> bool {
        !matches!(self, Self::Picture(_))
    }
}

/// A sound file.
pub struct Entry {
    pub format: Format,
    pub bytes: Vec<u8>,
}

/// Uses every material of the libraries in the corpus.
const MODEL: &str = "mtllib case.mtl\n\
v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvn 0 0 1\n\
usemtl a\nf 1/1/1 2/2/1 3/3/1 4/4/1\nusemtl b\nf 1/1 3/3 4/4\nusemtl m\nf 2 3 4\n";

const LIBRARY: &str = "newmtl a\nKd 0.5 0.4 0.3\nKs 0.2 0.2 0.2\nNs 40\nmap_Kd map.png\n\
map_Bump -bm 0.5 -s 2 2 1 map.png\nnewmtl b\nillum 3\nKd 1 1 1\nnorm map.png\nd 0.5\n\
newmtl m\nKs 1 1 1\nNs 1e7\ndisp -mm 0.1 2 -o 0.5 0.5 map.png\nmap_d map.png\n";

const SCENE: &str = "model = \"model.obj\"\n[camera]\neye = [0.0, -2.0, 2.0]\ntarget = [0.0, 0.0, 0.0]\n\
up = [0.0, 0.0, 1.0]\nvfov_deg = 40.0\n[[light]]\nkind = \"point\"\nposition = [0.3, 0.2, 1.0]\n\
intensity = 3.0\n[[light]]\nkind = \"ambient\"\nintensity = 0.1\n[shading]\nmodel = \"report\"\n\
max_bounces = 2\n[mapping]\nmethod = \"relief\"\namplitude = 0.1\nlayers = 16\n\
[[material]]\nname = \"a\"\nkd = [0.1, 0.2, 0.3]\nshininess = 100.0\nreflectivity = 0.5\n";

/// What a scene file of the corpus is about, and what it is about here.
const BUILT_IN: &str = "built_in = \"torus-study\"";
const FILE: &str = "model = \"model.obj\"";

/// What cases refer to.
pub fn furnish(folder: &Path) {
    let write = |name: &str, bytes: &[u8]| fs::write(folder.join(name), bytes).expect("written");
    write("model.obj", MODEL.as_bytes());
    write("case.mtl", LIBRARY.as_bytes());
    write("map.png", &encoded(ImageFormat::Png));
}

/// Every sound file.
pub fn corpus() -> Vec<Entry> {
    let mut all = vec![
        text(Format::Obj, MODEL),
        text(Format::Mtl, LIBRARY),
        text(Format::Toml, SCENE),
    ];
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data");
    for folder in ["syntax", "reference"] {
        let entries = fs::read_dir(data.join(folder)).expect("a folder");
        let mut paths: Vec<_> = entries.map(|e| e.expect("an entry").path()).collect();
        // In one order everywhere: a case is a number.
        paths.sort();
        for path in paths {
            let format = match path.extension().and_then(|e| e.to_str()) {
                Some("obj") => Format::Obj,
                Some("mtl") => Format::Mtl,
                Some("toml") => Format::Toml,
                _ => continue,
            };
            let mut bytes = fs::read(&path).expect("read");
            if format == Format::Toml {
                // Generating a scene takes up to a second, and reads nothing.
                let text = String::from_utf8(bytes).expect("UTF-8");
                bytes = text.replace(BUILT_IN, FILE).into_bytes();
            }
            if bytes.len() < 20_000 {
                all.push(Entry { format, bytes });
            }
        }
    }
    for (ending, format) in PICTURE_FORMATS {
        let format_name = Format::Picture(ending);
        all.push(Entry {
            format: format_name,
            bytes: encoded(format),
        });
    }
    for (ending, bytes) in others() {
        all.push(Entry {
            format: Format::Picture(ending),
            bytes,
        });
    }
    all
}

fn text(format: Format, text: &str) -> Entry {
    Entry {
        format,
        bytes: text.as_bytes().to_vec(),
    }
}

fn write(picture: &DynamicImage, format: ImageFormat) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    picture.write_to(&mut bytes, format).expect("encoded");
    bytes.into_inner()
}

/// A small picture of colours, as floats where the format holds nothing else.
fn encoded(format: ImageFormat) -> Vec<u8> {
    let value = |x: u32, y: u32, c: u32| (x * 37 + y * 91 + c * 53) % 256;
    let picture = match format {
        ImageFormat::Hdr | ImageFormat::OpenExr => {
            let texel = |x, y| image::Rgb([0, 1, 2].map(|c| value(x, y, c) as f32 / 100.0));
            DynamicImage::ImageRgb32F(ImageBuffer::from_fn(11, 7, texel))
        }
        _ => {
            let texel = |x, y| image::Rgb([0, 1, 2].map(|c| value(x, y, c) as u8));
            DynamicImage::ImageRgb8(ImageBuffer::from_fn(11, 7, texel))
        }
    };
    write(&picture, format)
}

/// Other depths and channels.
fn others() -> Vec<(&'static str, Vec<u8>)> {
    let wide = ImageBuffer::from_fn(9, 5, |x, y| image::Luma([(x * 7000 + y * 900) as u16]));
    let wide = DynamicImage::ImageLuma16(wide);
    let alpha = ImageBuffer::from_fn(6, 6, |x, y| {
        image::Rgba([(x * 40) as u8, (y * 40) as u8, 9, 200])
    });
    let alpha = DynamicImage::ImageRgba8(alpha);
    vec![
        ("png", write(&wide, ImageFormat::Png)),
        ("tif", write(&wide, ImageFormat::Tiff)),
        ("png", write(&alpha, ImageFormat::Png)),
        ("tga", write(&alpha, ImageFormat::Tga)),
        ("webp", write(&alpha, ImageFormat::WebP)),
        ("gif", write(&alpha, ImageFormat::Gif)),
        ("bmp", write(&alpha, ImageFormat::Bmp)),
    ]
}
