//! Decoding and encoding of pictures.

use std::io::Cursor;
use std::path::{Path, PathBuf};

use image::{DynamicImage, ImageBuffer, ImageFormat, Luma, LumaA, Rgb, Rgba};
use reliefscope::scene::load::{PictureLimits, PictureStore, decode_picture};
use reliefscope::scene::save_picture::{write_exr, write_png};
use reliefscope::texture::{RawImage, Samples};
use tempfile::TempDir;

fn folder() -> TempDir {
    tempfile::tempdir().expect("a temporary folder")
}

fn write(folder: &TempDir, name: &str, bytes: &[u8]) -> PathBuf {
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).expect("a file");
    path
}

fn encoded(picture: &DynamicImage, format: ImageFormat) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    picture.write_to(&mut bytes, format).expect("encoded");
    bytes.into_inner()
}

fn decoded(path: &Path) -> RawImage {
    decode_picture(path, &PictureLimits::default())
        .unwrap_or_else(|e| panic!("{}: {e}", path.display()))
        .image
}

fn rgb8() -> DynamicImage {
    DynamicImage::ImageRgb8(ImageBuffer::from_fn(5, 3, |x, y| {
        Rgb([x as u8 * 50, y as u8 * 80, 7])
    }))
}

fn bytes_of(picture: &DynamicImage) -> Samples {
    Samples::U8(picture.as_bytes().to_vec())
}

#[test]
fn lossless_byte_formats_round_trip_under_any_name() {
    let folder = folder();
    let picture = rgb8();
    let formats = [
        (ImageFormat::Png, "a.png"),
        (ImageFormat::Png, "wrong.jpg"),
        (ImageFormat::Png, "none"),
        (ImageFormat::Bmp, "a.bmp"),
        (ImageFormat::Tiff, "a.tif"),
        (ImageFormat::Tga, "a.tga"),
        (ImageFormat::WebP, "a.webp"),
    ];
    for (format, name) in formats {
        let image = decoded(&write(&folder, name, &encoded(&picture, format)));
        assert_eq!((image.width, image.height), (5, 3), "{name}");
        assert_eq!(image.channels, 3, "{name}");
        assert_eq!(image.samples, bytes_of(&picture), "{name}");
    }
    let mut tga = encoded(&picture, ImageFormat::Tga);
    assert!(decode_picture(&write(&folder, "tga.png", &tga), &PictureLimits::default()).is_err());
    tga.extend_from_slice(&[0; 8]);
    tga.extend_from_slice(b"TRUEVISION-XFILE.\0");
    let image = decoded(&write(&folder, "tga.png", &tga));
    assert_eq!(image.samples, bytes_of(&picture), "told by its footer");
}

#[test]
fn lossy_and_animated_formats_come_close() {
    let folder = folder();
    let picture = DynamicImage::ImageRgb8(ImageBuffer::from_pixel(16, 16, Rgb([200, 100, 50])));
    for (format, name) in [(ImageFormat::Jpeg, "a.jpg"), (ImageFormat::Gif, "a.gif")] {
        let image = decoded(&write(&folder, name, &encoded(&picture, format)));
        assert_eq!((image.width, image.height), (16, 16));
        for (channel, expected) in [(0, 200.0), (1, 100.0), (2, 50.0)] {
            let got = image.fraction(8, 8, channel) * 255.0;
            assert!((got - expected).abs() < 4.0, "{name}: {got} for {expected}");
        }
    }
}

#[test]
fn sixteen_bits_stay_sixteen() {
    let folder = folder();
    let grey = ImageBuffer::from_fn(4, 4, |x, y| Luma([(x * 4 + y) as u16 * 4001 + 1]));
    let samples = Samples::U16(grey.as_raw().clone());
    let grey = DynamicImage::ImageLuma16(grey);
    for (format, name) in [(ImageFormat::Png, "g.png"), (ImageFormat::Tiff, "g.tiff")] {
        let image = decoded(&write(&folder, name, &encoded(&grey, format)));
        assert_eq!((image.channels, image.bits()), (1, 16), "{name}");
        assert_eq!(image.samples, samples, "{name}");
    }
    let alpha = DynamicImage::ImageLumaA16(ImageBuffer::from_pixel(2, 2, LumaA([515, 1])));
    let image = decoded(&write(
        &folder,
        "ga.png",
        &encoded(&alpha, ImageFormat::Png),
    ));
    assert_eq!(image.samples, Samples::U16([515, 1].repeat(4)));
}

#[test]
fn floats_stay_floats_and_finite() {
    let folder = folder();
    let values = [0.5, -2.0, 1e6, f32::NAN, 0.25, f32::INFINITY];
    let picture = ImageBuffer::from_raw(2, 1, values.to_vec()).expect("two pixels");
    let picture = DynamicImage::ImageRgb32F(picture);
    for (format, name) in [
        (ImageFormat::OpenExr, "a.exr"),
        (ImageFormat::Tiff, "a.tif"),
    ] {
        let path = write(&folder, name, &encoded(&picture, format));
        let result = decode_picture(&path, &PictureLimits::default()).expect("a picture");
        assert_eq!(result.replaced, 2, "{name}");
        let expected = Samples::F32(vec![0.5, -2.0, 1e6, 0.0, 0.25, 0.0]);
        assert_eq!(result.image.samples, expected, "{name}");
    }
    let powers = ImageBuffer::from_pixel(3, 2, Rgb([0.5_f32, 2.0, 64.0]));
    let bytes = encoded(&DynamicImage::ImageRgb32F(powers), ImageFormat::Hdr);
    let image = decoded(&write(&folder, "a.hdr", &bytes));
    assert_eq!(image.bits(), 32);
    assert!((image.fraction(1, 1, 2) - 64.0).abs() < 0.5);
}

#[test]
fn one_channel_floats_are_read() {
    use exr::prelude::*;

    let folder = folder();
    let values = [236.5, f32::NAN, 1076.25, -3.0, 0.0, 7.0];
    let expected = Samples::F32(vec![236.5, 0.0, 1076.25, -3.0, 0.0, 7.0]);

    let path = folder.path().join("height.exr");
    let channel = AnyChannel::new("Y", FlatSamples::F32(values.to_vec()));
    let layer = Layer::new(
        (3, 2),
        LayerAttributes::named("relief"),
        Encoding::FAST_LOSSLESS,
        AnyChannels::sort([channel].into_iter().collect()),
    );
    Image::from_layer(layer)
        .write()
        .to_file(&path)
        .expect("written");
    let result = decode_picture(&path, &PictureLimits::default()).expect("a picture");
    assert_eq!((result.image.width, result.image.height), (3, 2));
    assert_eq!((result.image.channels, result.replaced), (1, 1));
    assert_eq!(result.image.samples, expected);
    let tight = PictureLimits {
        max_side: 2,
        ..PictureLimits::default()
    };
    assert!(decode_picture(&path, &tight).is_err());

    let path = folder.path().join("height.tif");
    let file = std::fs::File::create(&path).expect("a file");
    tiff::encoder::TiffEncoder::new(file)
        .expect("a header")
        .write_image::<tiff::encoder::colortype::Gray32Float>(3, 2, &values)
        .expect("written");
    let result = decode_picture(&path, &PictureLimits::default()).expect("a picture");
    assert_eq!(result.image.samples, expected);
    assert!(decode_picture(&path, &tight).is_err());
}

#[test]
fn alpha_is_kept() {
    let folder = folder();
    let picture = DynamicImage::ImageRgba8(ImageBuffer::from_pixel(2, 2, Rgba([1, 2, 3, 4])));
    let image = decoded(&write(
        &folder,
        "a.png",
        &encoded(&picture, ImageFormat::Png),
    ));
    assert_eq!(image.alpha_channel(), Some(3));
    assert_eq!(image.samples, Samples::U8([1, 2, 3, 4].repeat(4)));
}

/// A PNG of the given size whose pixels are missing.
fn hollow_png(width: u32, height: u32) -> Vec<u8> {
    let mut header = b"IHDR".to_vec();
    header.extend_from_slice(&width.to_be_bytes());
    header.extend_from_slice(&height.to_be_bytes());
    header.extend_from_slice(&[16, 6, 0, 0, 0]);
    let crc = crc32(&header);
    let mut bytes = b"\x89PNG\r\n\x1a\n\0\0\0\x0D".to_vec();
    bytes.extend_from_slice(&header);
    bytes.extend_from_slice(&crc.to_be_bytes());
    // Some image data, so that the header is accepted.
    bytes.extend_from_slice(b"\0\0\0\0IDAT\x35\xAF\x06\x1E");
    bytes
}

fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0, |crc: u32, &byte| {
        (0..8).fold(crc ^ u32::from(byte), |c, _| {
            (c >> 1) ^ (0xEDB8_8320 * (c & 1))
        })
    })
}

#[test]
fn limits_refuse_by_the_header() {
    let folder = folder();
    let refusal = |width, height, limits: &PictureLimits| {
        let path = write(&folder, "big.png", &hollow_png(width, height));
        decode_picture(&path, limits)
            .expect_err("refused")
            .to_string()
    };
    let limits = PictureLimits::default();
    let message = refusal(20_000, 4, &limits);
    assert!(
        message.contains("20000×4 pixels; at most 16384"),
        "{message}"
    );
    // Far too much for any machine: it must be refused before it is asked for.
    refusal(2_000_000_000, 2_000_000_000, &limits);
    let tight = PictureLimits {
        max_bytes: 100,
        ..limits
    };
    refusal(8, 8, &tight);

    let mut bmp = encoded(&rgb8(), ImageFormat::Bmp);
    bmp[18..22].copy_from_slice(&20_000_u32.to_le_bytes());
    let path = write(&folder, "big.bmp", &bmp);
    let message = decode_picture(&path, &limits).expect_err("refused");
    assert!(message.to_string().contains("20000"), "{message}");
    let path = write(&folder, "small.bmp", &encoded(&rgb8(), ImageFormat::Bmp));
    assert!(decode_picture(&path, &limits).is_ok());
    let tight = PictureLimits {
        max_bytes: 44,
        ..limits
    };
    let message = decode_picture(&path, &tight)
        .expect_err("45 bytes")
        .to_string();
    assert!(message.contains("45 bytes; at most 44"), "{message}");
}

#[test]
fn damaged_files_are_errors() {
    let folder = folder();
    let formats = [
        (ImageFormat::Png, "a.png"),
        (ImageFormat::Bmp, "a.bmp"),
        (ImageFormat::Tiff, "a.tif"),
        (ImageFormat::Tga, "a.tga"),
        (ImageFormat::WebP, "a.webp"),
        (ImageFormat::Gif, "a.gif"),
    ];
    for (format, name) in formats {
        let whole = encoded(&rgb8(), format);
        let path = write(&folder, name, &whole[..whole.len() / 3]);
        assert!(
            decode_picture(&path, &PictureLimits::default()).is_err(),
            "{name}"
        );
        // Any byte may be wrong: an error or some picture, but an answer.
        for at in 0..whole.len() {
            let mut bytes = whole.clone();
            bytes[at] ^= 0xFF;
            let path = write(&folder, name, &bytes);
            let _ = decode_picture(&path, &PictureLimits::default());
        }
    }
    let nothing = write(&folder, "empty.tga", b"");
    assert!(decode_picture(&nothing, &PictureLimits::default()).is_err());
    let text = write(&folder, "readme", b"hello, this is text");
    let message = decode_picture(&text, &PictureLimits::default()).expect_err("no picture");
    assert!(message.to_string().contains("known format"));
    assert!(decode_picture(&folder.path().join("gone.png"), &PictureLimits::default()).is_err());
    assert!(decode_picture(folder.path(), &PictureLimits::default()).is_err());
}

#[test]
fn a_store_decodes_each_file_once() {
    let folder = folder();
    let path = write(&folder, "a.png", &encoded(&rgb8(), ImageFormat::Png));
    std::fs::create_dir(folder.path().join("sub")).expect("a folder");
    let detour = folder.path().join("sub/../a.png");
    let mut store = PictureStore::default();
    assert_eq!(store.load(&path), Ok((0, None)));
    assert_eq!(store.load(&detour), Ok((0, None)));
    let broken = write(&folder, "b.png", b"no");
    assert!(store.load(&broken).is_err() && store.load(&broken).is_err());
    assert_eq!(store.images.len(), 1);
    assert_eq!(store.images[0].name, "a.png");
    let mut next = PictureStore::with_images(store.images);
    assert_eq!(next.load(&detour), Ok((0, None)));
}

#[test]
fn saved_pictures_read_back() {
    let folder = folder();
    let png = folder.path().join("out.png");
    std::fs::write(&png, "old").expect("a file to replace");
    write_png(&png, [2, 1], &[[1, 2, 3], [4, 5, 6]]).expect("written");
    assert_eq!(decoded(&png).samples, Samples::U8(vec![1, 2, 3, 4, 5, 6]));

    let exr = folder.path().join("out.exr");
    write_exr(&exr, [1, 2], &[[0.5, 2.0, -1.0], [1e-8, 3.0, 7.25]]).expect("written");
    let samples = vec![0.5, 2.0, -1.0, 1e-8, 3.0, 7.25];
    assert_eq!(decoded(&exr).samples, Samples::F32(samples));

    let left: Vec<_> = std::fs::read_dir(folder.path()).expect("listed").collect();
    assert_eq!(left.len(), 2, "no temporary file stays");
}

#[test]
fn saving_fails_with_the_path_and_leaves_the_old_file() {
    let folder = folder();
    let path = folder.path().join("no/such/folder.png");
    let error = write_png(&path, [1, 1], &[[0; 3]]).expect_err("no folder");
    assert!(error.to_string().contains("folder.png"), "{error}");
    let path = write(&folder, "kept.png", b"kept");
    let error = write_png(&path, [2, 2], &[[0; 3]]).expect_err("too few pixels");
    assert!(error.to_string().contains("2×2"), "{error}");
    assert_eq!(std::fs::read(&path).expect("still there"), b"kept");
}
