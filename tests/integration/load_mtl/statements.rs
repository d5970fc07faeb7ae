//! What each statement of a library does to a material.

use reliefscope::math::{LinearRgb, linear_from_srgb};
use reliefscope::scene::LoadError;
use reliefscope::scene::load::{LibraryRef, LoadOptions, load_materials};
use reliefscope::texture::{Channel, MapRole, Wrap};

use super::fixture::{Fixture, assert_one_warning, warnings};

const NONE: [&str; 0] = [];

#[test]
fn colours_and_numbers() {
    let fixture = Fixture::with_library(
        "newmtl one\nKd 0.5\nKs 0.1 0.2 0.3\nNs 5\nnewmtl huge\nillum 2.0\nNs 1e9\nKs 1\n\
         newmtl matte\nillum 1\nKs 1 1 1\nnewmtl mirror\nillum 3\nKs 0.2 1.5 0.1\n",
    );
    let set = fixture.load(&["one", "huge", "matte", "mirror"]);
    assert_eq!(warnings(&set), NONE);
    let [one, huge, matte, mirror] = &set.materials[..] else {
        panic!("four materials");
    };
    assert_eq!(one.kd, LinearRgb::gray(linear_from_srgb(0.5)));
    assert_eq!(one.ks, LinearRgb::new(0.1, 0.2, 0.3));
    assert_eq!((one.shininess, one.reflectivity), (5.0, 0.0));
    assert_eq!(huge.shininess, 1e7);
    assert_eq!(huge.ks, LinearRgb::WHITE);
    assert_eq!(huge.kd, LinearRgb::gray(0.8));
    assert_eq!(matte.ks, LinearRgb::BLACK);
    assert_eq!(mirror.reflectivity, 1.0);
}

#[test]
fn forms_that_are_not_read_leave_the_rest_alone() {
    let fixture = Fixture::with_library(
        "newmtl m\nKd spectral file.rfl 1\nKs xyz 0.1 0.2 0.3\nNs 5\nillum 12\nNi 0\n",
    );
    let set = fixture.load(&["m"]);
    assert_eq!(set.materials[0].shininess, 5.0);
    assert_eq!(set.materials[0].ks, LinearRgb::BLACK);
    let said = warnings(&set);
    assert_eq!(said.len(), 3, "{said:?}");
    assert!(said[0].starts_with("m.mtl:2 ") && said[0].contains("spectral"));
    assert!(said[1].starts_with("m.mtl:3 ") && said[1].contains("xyz"));
    assert!(said[2].contains("illum 12"));
}

#[test]
fn names() {
    let fixture =
        Fixture::with_library("newmtl red brick wall\nKd 1 0 0\nnewmtl Material #25\nKd 0 1 0\n");
    let set = fixture.load(&[
        "red brick wall",
        " Material #25",
        "Material",
        "RED BRICK WALL",
    ]);
    assert_eq!(set.materials[0].kd, LinearRgb::new(1.0, 0.0, 0.0));
    assert_eq!(set.materials[0].name, "red brick wall");
    let green = LinearRgb::new(0.0, 1.0, 0.0);
    assert_eq!([set.materials[1].kd, set.materials[2].kd], [green; 2]);
    assert_eq!(set.materials[3].kd, set.materials[0].kd);
    assert_one_warning(&set, &["model.obj:13", "red brick wall"]);
}

#[test]
fn names_need_not_be_utf8() {
    let fixture = Fixture::with_library("");
    fixture.write("m.mtl", b"newmtl gr\xFCn\nKd 0 1 0\n");
    let library = LibraryRef {
        name: b"m.mtl".to_vec(),
        model: fixture.path("model.obj"),
        line: 1,
    };
    let used = [(b"gr\xFCn".to_vec(), 2)];
    let set = load_materials(&[library], &used, &LoadOptions::default()).expect("not cancelled");
    assert_eq!(set.materials[0].name, "grün");
    assert_eq!(set.materials[0].kd, LinearRgb::new(0.0, 1.0, 0.0));
    assert_eq!(warnings(&set), NONE);
}

#[test]
fn undefined_and_unnamed_materials() {
    let fixture = Fixture::with_library("newmtl m\n");
    let set = fixture.load(&["ghost"]);
    assert_eq!(set.materials[0].kd, LinearRgb::gray(0.8));
    assert_eq!(set.materials[0].name, "ghost");
    assert_one_warning(&set, &["model.obj:10", "ghost", "not defined"]);

    assert_one_warning(&fixture.load(&[""]), &["names no material"]);

    let unsaid = [(Vec::new(), 0)];
    let set = load_materials(&[], &unsaid, &LoadOptions::default()).expect("not cancelled");
    assert_eq!(set.materials[0].name, "default");
    assert_eq!(warnings(&set), NONE);
}

#[test]
fn the_first_definition_counts() {
    let fixture = Fixture::with_library("newmtl m\nKd 1 0 0\nnewmtl m\nKd 0 1 0\n");
    let set = fixture.load(&["m"]);
    assert_eq!(set.materials[0].kd, LinearRgb::new(1.0, 0.0, 0.0));
    assert_one_warning(&set, &["m.mtl:3", "again", "line 1"]);

    let fixture = Fixture::with_library("newmtl m\nKd 1 0 0\n");
    fixture.write("b.mtl", b"newmtl m\nKd 0 0 1\nnewmtl n\nKd 0 1 0\n");
    let set = fixture.load_from(&["m.mtl b.mtl"], &["m", "n"]);
    assert_eq!(set.materials[0].kd, LinearRgb::new(1.0, 0.0, 0.0));
    assert_eq!(set.materials[1].kd, LinearRgb::new(0.0, 1.0, 0.0));
    assert_one_warning(&set, &["b.mtl:1", "already"]);

    let set = fixture.load_from(&["m.mtl", "./m.mtl"], &["m"]);
    assert_eq!(warnings(&set), NONE, "one file named twice");
}

#[test]
fn libraries_are_found_like_pictures() {
    let fixture = Fixture::with_library("newmtl m\n");
    fixture.write("my lib.mtl", b"newmtl n\n");
    let set = fixture.load_from(&["\"my lib.mtl\"", ".\\my lib.mtl"], &["n"]);
    assert_eq!(warnings(&set), NONE);
    let set = fixture.load_from(&["C:\\models\\M.MTL"], &["m"]);
    assert_one_warning(&set, &["model.obj:1", "not where its path says"]);
    let set = fixture.load_from(&["gone.mtl", "m.mtl"], &["m"]);
    assert_one_warning(&set, &["gone.mtl", "not found", "looked in"]);
}

#[test]
fn what_is_not_used_is_said_once() {
    let fixture = Fixture::with_library(
        "Kd 1 0 0\nmap_Kd x.png\nnewmtl m\nPr 0.4\nmap_Pr x.png\nKe 2 2 2\nmap_Ke x.png\nTf 1 1 1\n\
         sharpness 60\nmap_Ka a.png\nnewmtl n\nmap_Ka b.png\nd 0.5\nfrobnicate\n",
    );
    let said = warnings(&fixture.load(&["m"]));
    let expected = [
        "1 2 statement",
        "4 Pr is",
        "5 map_Pr is",
        "6 Ke is",
        "7 map_Ke is",
        "10 map_Ka is not used (2 times)",
        "11 d or Tr asks 1",
        "14 frobnicate is",
    ];
    assert_eq!(said.len(), expected.len(), "{said:#?}");
    for (said, expected) in said.iter().zip(expected) {
        assert!(said.starts_with(&format!("m.mtl:{expected}")), "{said}");
    }
}

#[test]
fn map_options_reach_the_slot() {
    let fixture = Fixture::with_library(
        "newmtl m\nmap_Kd -blendu on -s 2 3 1 -o 0.5 0.25 0 -mm 0.1 0.9 -clamp on a.png\n\
         bump a b.png -imfchan g -bm 1.5 # walls\n",
    );
    fixture.grey("a.png").grey("a b.png");
    let set = fixture.load(&["m"]);
    assert_eq!(warnings(&set), NONE);
    let material = &set.materials[0];
    assert_eq!(material.kd, LinearRgb::WHITE);
    let albedo = material.map(MapRole::Albedo).expect("an albedo map");
    assert_eq!(albedo.wrap, Wrap::Clamp);
    assert_eq!(
        (albedo.uv_scale, albedo.uv_offset),
        ([2.0, 3.0], [0.5, 0.25])
    );
    assert_eq!((albedo.gain, albedo.bias), (0.9, 0.1));
    let height = material.map(MapRole::Height).expect("a height map");
    assert_eq!((height.channel, height.wrap), (Channel::G, Wrap::Repeat));
    assert_eq!(material.default_amplitude, 1.5);
    assert_eq!(set.images[height.image].name, "a b.png");
    assert!(
        height.note.contains("8-bit grey, 8×4, 8 levels"),
        "{}",
        height.note
    );
}

#[test]
fn pictures_are_found_in_odd_places() {
    let cases = [
        ("..\\maps\\a.png", "../maps/a.png", None),
        ("\"a b.png\"", "a b.png", None),
        ("a b.png", "a b.png", None),
        ("Sub/A.PNG", "sub/a.png", Some("in other letter case")),
        ("C:\\Users\\me\\tex\\a.png", "tex/a.png", Some("not where")),
        ("/nowhere/a.png", "a.png", Some("not where")),
        ("D:\\x\\a.png", "Textures/a.png", Some("not where")),
        ("maps/a.png", "../maps/a.png", None),
        ("maps/a.png", "../other/a.png", Some("not found; looked in")),
    ];
    for (name, place, warning) in cases {
        let fixture = Fixture::with_library("");
        fixture.write("lib/m.mtl", format!("newmtl m\nmap_Kd {name}\n").as_bytes());
        fixture.grey(&format!("lib/{place}"));
        let set = fixture.load_from(&["lib/m.mtl"], &["m"]);
        match warning {
            None => assert_eq!(warnings(&set), NONE, "{name}"),
            Some(text) => assert_one_warning(&set, &["m.mtl:2", text]),
        }
        let found = !warning.is_some_and(|w| w.contains("not found"));
        assert_eq!(set.images.len(), usize::from(found), "{name}");
    }
}

/// A line of damage, read as a path of many parts, once took the square of their number.
#[test]
fn a_name_that_no_system_opens_is_not_looked_for() {
    for (parts, found) in [(100, true), (1_000_000, false)] {
        let name = "1/".repeat(parts);
        let fixture = Fixture::with_library(&format!("newmtl m\nmap_Kd {name}a.png\n"));
        fixture.grey("a.png");
        let set = fixture.load(&["m"]);
        let text = if found { "not where" } else { "not found" };
        assert_one_warning(&set, &["m.mtl:2", text]);
        assert_eq!(set.images.len(), usize::from(found), "{parts} parts");
    }
}

#[test]
fn broken_and_missing_pictures_leave_the_colour() {
    let fixture = Fixture::with_library(
        "newmtl m\nKd 1 0 0\nmap_Kd\nmap_Bump \nnorm -bm 2\nmap_Kd nope.png\ndisp bad.png\nmap_d bad.png\n",
    );
    fixture.write("bad.png", b"\x89PNG\r\n\x1a\nthis is no picture");
    let set = fixture.load(&["m"]);
    assert_eq!(set.materials[0].kd, LinearRgb::new(1.0, 0.0, 0.0));
    assert_eq!(set.materials[0].maps, []);
    let said = warnings(&set);
    let lines: Vec<&str> = said.iter().filter_map(|w| w.split(' ').next()).collect();
    assert_eq!(
        lines,
        [
            "m.mtl:3", "m.mtl:4", "m.mtl:5", "m.mtl:6", "m.mtl:7", "m.mtl:8"
        ],
        "{said:#?}"
    );
}

#[test]
fn keywords_in_any_case_and_repeats() {
    let fixture = Fixture::with_library(
        "newmtl m\nMAP_KD a.png\nMap_bump a.png\nBump a.png\nDisp a.png\nmap_disp a.png\n\
         newmtl n\nmap_Kd a.png\nmap_Kd b.png\nbump a.png\ndisp -mm 0 0.1 a.png\n",
    );
    fixture.grey("a.png").grey("b.png");
    let set = fixture.load(&["m", "n"]);
    let roles: Vec<_> = set.materials[0].maps.iter().map(|s| s.role).collect();
    assert_eq!(roles, [MapRole::Albedo, MapRole::Height]);
    let second = &set.materials[1];
    let albedo = second.map(MapRole::Albedo).expect("an albedo map");
    assert_eq!(set.images[albedo.image].name, "b.png", "the later one");
    let heights: Vec<_> = second
        .maps
        .iter()
        .filter(|s| s.role == MapRole::Height)
        .map(|s| (s.enabled, s.gain))
        .collect();
    assert_eq!(heights, [(true, 1.0), (false, 0.1)]);
    assert_eq!(warnings(&set).len(), 2, "one per slot switched off");
    assert_eq!(set.images.len(), 2, "one picture per file");
}

#[test]
fn strengths_of_zero_and_below() {
    let fixture =
        Fixture::with_library("newmtl flat\nbump -bm 0 a.png\nnewmtl deep\nbump -bm -2 a.png\n");
    fixture.grey("a.png");
    let set = fixture.load(&["flat", "deep"]);
    assert_eq!(set.materials[0].amplitude, Some(0.0));
    let deep = &set.materials[1];
    assert_eq!((deep.amplitude, deep.default_amplitude), (None, 2.0));
    assert!(deep.maps[0].invert);
}

#[test]
fn of_equal_statements_the_later_strength_counts() {
    let fixture = Fixture::with_library(
        "newmtl m\nmap_bump -bm 1 a.png\nbump -bm 2 a.png\ndisp -bm 3 a.png\n\
         newmtl n\nmap_bump c.png\nbump c.png\n",
    );
    fixture.grey("a.png");
    fixture.rgb("c.png", |x, y| [180, (60 + (x * 5 + y) % 50) as u8, 40]);
    let set = fixture.load(&["m", "n"]);
    assert_eq!(set.materials[0].maps.len(), 1);
    assert_eq!(set.materials[0].default_amplitude, 2.0);
    assert_one_warning(&set, &["colour picture"]);
}

#[test]
fn a_cancelled_load_stops() {
    let fixture = Fixture::with_library("newmtl m\nmap_Kd a.png\n");
    fixture.grey("a.png");
    let library = LibraryRef {
        name: b"m.mtl".to_vec(),
        model: fixture.path("model.obj"),
        line: 1,
    };
    let options = LoadOptions::default();
    options.monitor.cancel();
    let result = load_materials(&[library], &[(b"m".to_vec(), 1)], &options);
    assert!(matches!(result, Err(LoadError::Cancelled)));
}
