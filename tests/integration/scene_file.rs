//! Scene files: what is written is read back, what is wrong is named with line and key, and the document
//! that explains the keys tells the truth.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::DVec3;
use reliefscope::math::{LinearRgb, hash, unit_interval};
use reliefscope::render::Snapshot;
use reliefscope::scene::file::{SaveError, SceneView, apply_overrides, read_scene, write_scene};
use reliefscope::scene::load::LoadOptions;
use reliefscope::scene::save_picture::write_png;
use reliefscope::scene::{
    Background, BentNormals, Camera, LoadError, LoadedScene, RenderSettings, SceneSource,
    ShadingModel, TextureFilter, View, open,
};
use reliefscope::shading::{Falloff, Light, LightKind, Material};
use reliefscope::surface::mapping::{Derivative, Lookup, Method, SearchSettings};
use reliefscope::texture::{Channel, FileAxis, MapRole, MapSlot, NormalAxes, NormalSpace, Wrap};
use tempfile::TempDir;

use super::support::{bits, picture};

const MODEL: &str = "mtllib plane.mtl
v -1 -1 0
v 1 -1 0
v 1 1 0
v -1 1 0
vt 0 0
vt 1 0
vt 1 1
vt 0 1
usemtl ground
f 1/1 2/2 3/3
usemtl rim
f 1/1 3/3 4/4
";

const LIBRARY: &str = "newmtl ground
Kd 0.5 0.5 0.5
map_Kd albedo.png
map_Bump -bm 0.03 height16.png
newmtl rim
Kd 0.1 0.2 0.3
";

/// A folder with a plane of two materials and the pictures that docs/scene.md speaks of.
pub struct Folder(TempDir);

impl Folder {
    pub fn new() -> Self {
        let folder = Self(TempDir::new().expect("a temporary folder"));
        folder.write("plane.obj", MODEL);
        folder.write("plane.mtl", LIBRARY);
        let gradient: Vec<[u8; 3]> = (0..64).map(|i| [i * 4; 3]).collect();
        let up: Vec<[u8; 3]> = (0..64).map(|i| [128 + i % 8, 128 + i / 8, 250]).collect();
        for name in ["albedo.png", "height16.png"] {
            write_png(&folder.path(name), [8, 8], &gradient).expect("a picture is written");
        }
        write_png(&folder.path("normal.png"), [8, 8], &up).expect("a picture is written");
        folder
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub fn write(&self, name: &str, text: &str) -> PathBuf {
        let path = self.path(name);
        fs::write(&path, text).expect("a file is written");
        path
    }

    fn open(&self, name: &str) -> LoadedScene {
        open(&self.path(name), &LoadOptions::default()).expect("opens")
    }

    fn read(&self, text: &str) -> LoadedScene {
        let path = self.write("scene.toml", text);
        match read_scene(&path, &LoadOptions::default()) {
            Ok(loaded) => loaded,
            Err(error) => panic!("{error}\nin\n{text}"),
        }
    }

    /// Line and message of the fault that a text has.
    fn fault(&self, text: &str) -> (usize, String) {
        let path = self.write("bad.toml", text);
        match read_scene(&path, &LoadOptions::default()) {
            Err(LoadError::Invalid {
                path: file,
                line: Some(line),
                message,
            }) => {
                assert_eq!(file, path);
                assert!(!message.contains('\n'), "one line: {message}");
                (line, message)
            }
            other => panic!("{:?} is not a fault with a line\nin\n{text}", other.err()),
        }
    }
}

/// Random numbers with a fixed beginning.
struct Random(u32);

impl Random {
    fn bits(&mut self) -> u32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9);
        hash(self.0)
    }
    fn unit(&mut self) -> f32 {
        unit_interval(self.bits())
    }
    fn flag(&mut self) -> bool {
        self.bits() & 1 == 1
    }
    fn below(&mut self, n: u32) -> u32 {
        self.bits() % n
    }
    fn of<T: Copy>(&mut self, all: &[T]) -> T {
        all[self.below(all.len() as u32) as usize]
    }
    /// Positive singles of all sizes, 0 among them.
    fn size(&mut self) -> f32 {
        let exponent = self.unit() * 60.0 - 30.0;
        if self.below(8) == 0 {
            0.0
        } else {
            (0.5 + self.unit()) * 10_f32.powf(exponent)
        }
    }
    fn number(&mut self) -> f32 {
        if self.flag() {
            self.size()
        } else {
            -self.size()
        }
    }
    /// Doubles with all their digits.
    fn wide(&mut self) -> f64 {
        f64::from(self.number()) * (1.0 + f64::from(self.bits()) * f64::EPSILON)
    }
    fn point(&mut self) -> DVec3 {
        DVec3::new(self.wide(), self.wide(), self.wide())
    }
    fn direction(&mut self) -> DVec3 {
        DVec3::new(self.wide(), 1.0 + self.wide().abs(), self.wide())
    }
    fn color(&mut self) -> LinearRgb {
        LinearRgb::new(self.size(), self.size(), self.size())
    }
    fn maybe<T>(&mut self, make: impl FnOnce(&mut Self) -> T) -> Option<T> {
        self.flag().then(|| make(self))
    }
    fn text(&mut self) -> String {
        let odd = [
            "",
            "plain",
            "a \"quoted\" name",
            "back\\slash",
            "two\nlines",
            "späť ×",
            "# no = comment",
        ];
        self.of(&odd).to_owned()
    }

    fn light(&mut self) -> Light {
        let kind = if self.flag() {
            LightKind::Point {
                position: self.point(),
                falloff: self.of(&[Falloff::None, Falloff::InverseSquare]),
            }
        } else {
            LightKind::Directional {
                direction: self.direction(),
            }
        };
        Light {
            name: self.text(),
            enabled: self.flag(),
            kind,
            color: self.color(),
            intensity: self.size(),
        }
    }

    fn slot(&mut self, images: usize) -> MapSlot {
        let role = self.of(&MapRole::ALL);
        let holds_slopes = matches!(role, MapRole::Normal | MapRole::Slope);
        MapSlot {
            enabled: self.flag(),
            channel: self.of(&Channel::ALL),
            invert: self.flag(),
            flip_green: self.flag(),
            space: self.of(&NormalSpace::ALL),
            destair: self.flag(),
            flip_v: self.flag(),
            wrap: self.of(&Wrap::ALL),
            uv_scale: [self.number(), self.number()],
            uv_offset: [self.number(), self.number()],
            gain: self.number(),
            bias: self.number(),
            // The loader gives every such map one; others have none.
            baked_amplitude: holds_slopes.then(|| f64::from(self.size()) + 1e-3),
            note: self.text(),
            ..MapSlot::new(self.below(images as u32) as usize, role)
        }
    }

    fn material(&mut self, material: &mut Material, images: usize) {
        material.kd = self.color();
        material.ks = self.color();
        material.shininess = self.size();
        material.reflectivity = self.unit();
        material.amplitude = self.maybe(|r| r.wide().abs());
        material.midlevel = self.maybe(Self::number);
        material.default_amplitude = self.wide().abs();
        let count = self.below(4);
        material.maps = (0..count).map(|_| self.slot(images)).collect();
    }

    /// Changes everything that a panel can change.
    fn change(&mut self, loaded: &mut LoadedScene) {
        let images = loaded.scene.images.len();
        let settings = &mut loaded.settings;
        settings.camera = Camera {
            eye: self.point(),
            target: self.point() + DVec3::ONE,
            up: self.direction(),
            vfov: f64::from(1 + self.below(1799))
                .mul_add(0.1, 0.0)
                .to_radians(),
        };
        let count = self.below(4);
        settings.lights = (0..count).map(|_| self.light()).collect();
        if self.flag() {
            settings
                .lights
                .push(Light::new(self.text(), LightKind::Ambient, self.size()));
        }
        settings.shading.model = self.of(&ShadingModel::ALL);
        settings.shading.bent_normals = self.of(&BentNormals::ALL);
        settings.shading.filter = self.of(&TextureFilter::ALL);
        settings.shading.specular_antialiasing = self.flag();
        settings.shading.shadows = self.flag();
        settings.shading.max_bounces = self.below(65);
        let top = self.color();
        settings.shading.background = Background {
            top,
            bottom: if self.flag() { top } else { self.color() },
        };
        let mapping = &mut settings.mapping;
        mapping.method = self.of(&Method::ALL);
        mapping.lookup = self.of(&Lookup::ALL);
        mapping.derivative = self.of(&Derivative::ALL);
        mapping.amplitude = self.maybe(|r| r.wide().abs());
        mapping.midlevel = self.number();
        mapping.use_height = self.flag();
        mapping.use_normal = self.flag();
        mapping.use_parallax = self.flag();
        mapping.cut_at_border = self.flag();
        mapping.weld_seams = self.flag();
        mapping.displacement_memory = self.below(1 << 20);
        mapping.search = SearchSettings {
            layers: 1 + self.below(4096),
            min_layers: 1 + self.below(4096),
            bisections: self.below(33),
            iterations: 1 + self.below(64),
            self_shadow: self.flag(),
        };
        settings.samples = 1 + self.below(1000);
        for material in &mut settings.materials {
            self.material(material, images);
        }
        loaded.display.exposure_ev = self.unit() * 64.0 - 32.0;
        loaded.display.view = View::ALL[self.below(View::ALL.len() as u32) as usize];
        loaded.size = self.maybe(|r| [1 + r.below(4000), 1 + r.below(4000)]);
        loaded.settings.shading.smooth_terminator = self.flag();
    }
}

fn same_settings(read: &LoadedScene, written: &LoadedScene, seed: u32) {
    let text = || format!("seed {seed}");
    assert_eq!(read.settings, written.settings, "{}", text());
    assert_eq!(read.display, written.display, "{}", text());
    assert_eq!(read.size, written.size, "{}", text());
}

#[test]
fn random_settings_come_back_bit_for_bit() {
    let folder = Folder::new();
    let path = folder.path("saved.toml");
    for seed in 0..120 {
        let mut scene = folder.open("plane.obj");
        Random(seed * 7919).change(&mut scene);
        write_scene(&path, &SceneView::from(&scene)).expect("is written");
        let read = read_scene(&path, &LoadOptions::default()).unwrap_or_else(|e| {
            let text = fs::read_to_string(&path).unwrap_or_default();
            panic!("seed {seed}: {e}\n{text}")
        });
        same_settings(&read, &scene, seed);
        assert_eq!(read.scene.source, SceneSource::SceneFile(path.clone()));
    }
}

#[test]
fn a_built_in_scene_comes_back_with_its_generated_pictures() {
    let folder = Folder::new();
    let scene = open(Path::new("plane"), &LoadOptions::default()).expect("is built in");
    let path = folder.path("saved.toml");
    write_scene(&path, &SceneView::from(&scene)).expect("is written");
    let text = fs::read_to_string(&path).expect("is there");
    assert!(text.contains("built_in = \"plane\""), "{text}");
    let read = read_scene(&path, &LoadOptions::default()).expect("is read");
    same_settings(&read, &scene, 0);
    assert_eq!(read.scene.images.len(), scene.scene.images.len());
    assert_eq!(read.scene.source, SceneSource::BuiltIn("plane".to_owned()));
    // And once more, from what was read.
    write_scene(&path, &SceneView::from(&read)).expect("is written again");
    assert_eq!(fs::read_to_string(&path).expect("is there"), text);
}

/// Wherever a built-in scene was put, with edits or without, normalised or not.
#[test]
fn a_placed_scene_comes_back_with_the_same_picture() {
    let folder = Folder::new();
    let path = folder.path("placed.toml");
    for (name, normalize) in [
        ("extremes@1e6,1e4", true),
        ("extremes@1e-12", true),
        ("extremes@1e3,1e2", false),
        ("plane@1e15,1e6", true),
        ("wall@2.5e-1,3e0", true),
    ] {
        let options = LoadOptions {
            normalize,
            ..LoadOptions::default()
        };
        let mut placed = open(Path::new(name), &options).expect("it is built in");
        placed.settings.materials[0].kd = LinearRgb::new(0.9, 0.2, 0.1);
        placed.settings.lights[1].intensity *= 1.25;
        write_scene(&path, &SceneView::from(&placed)).expect("written");
        let read = open(&path, &LoadOptions::default()).expect("read");
        assert_eq!(read.scene.source, SceneSource::BuiltIn(name.to_owned()));
        assert_eq!(read.scene.normalization, placed.scene.normalization);
        let seen = |loaded: &LoadedScene| {
            picture(&Snapshot {
                scene: Arc::clone(&loaded.scene),
                settings: Arc::new(RenderSettings {
                    samples: 1,
                    ..loaded.settings.clone()
                }),
                size: [48, 32],
            })
        };
        let (before, after) = (seen(&placed), seen(&read));
        assert_eq!(bits(&before), bits(&after), "{name}");
        let lit = before.pixels.iter().filter(|p| p.g > 0.02).count();
        assert!(lit > 500, "{name}: {lit} pixels show something");
    }
}

#[test]
fn normalisation_is_kept_and_can_be_turned_off() {
    let folder = Folder::new();
    let off = LoadOptions {
        normalize: false,
        ..LoadOptions::default()
    };
    let world = open(&folder.path("plane.obj"), &off).expect("opens");
    let path = folder.path("saved.toml");
    write_scene(&path, &SceneView::from(&world)).expect("is written");
    let read = folder.open("saved.toml");
    assert_eq!(read.scene.normalization, world.scene.normalization);
    folder.write("plane.obj", &MODEL.replace("v 1 1 0", "v 31 1 0"));
    let on = folder.read("model = \"plane.obj\"");
    assert_ne!(on.scene.normalization, world.scene.normalization);
    let off = folder.read("model = \"plane.obj\"\nnormalize = false");
    assert_eq!(off.scene.normalization, world.scene.normalization);
}

#[test]
fn entries_override_materials_in_file_order() {
    let folder = Folder::new();
    let loaded = folder.read(
        r#"model = "plane.obj"
[mapping]
amplitude = 0.06
[[material]]
name = "*"
kd = [1, 1, 1]
albedo_map = "albedo.png"
normal_map = "normal.png"
normal_y = "down"
[[material]]
name = "rim"
kd = [0.25, 0.5, 0.75]
albedo_map = ""
normal_amplitude = 0.5
[[material]]
name = "rin"
ks = [1, 1, 1]
"#,
    );
    let [ground, rim] = &loaded.settings.materials[..] else {
        panic!("two materials")
    };
    assert_eq!(ground.kd, LinearRgb::WHITE);
    assert_eq!(rim.kd, LinearRgb::new(0.25, 0.5, 0.75));
    let amplitude = ground.default_amplitude;
    assert!(
        (amplitude - 0.03).abs() < 1e-8,
        "the library's, not {amplitude}"
    );
    assert!(
        ground.map(MapRole::Height).is_some(),
        "kept from the library"
    );
    assert!(rim.map(MapRole::Albedo).is_none(), "taken away");
    for material in [ground, rim] {
        let normal = material.map(MapRole::Normal).expect("given to every one");
        assert!(normal.flip_green);
        assert_eq!(loaded.scene.images[normal.image].name, "normal.png");
    }
    let baked = |m: &Material| m.map(MapRole::Normal).and_then(|s| s.baked_amplitude);
    assert_eq!(baked(rim), Some(0.5));
    assert!(baked(ground).is_some_and(|a| a > 0.0), "never left open");
    // The library's picture is not decoded a second time.
    assert_eq!(loaded.scene.images.len(), 3);
    let note = loaded.warnings.iter().find(|w| w.message.contains("rin"));
    let note = note.expect("an unknown material is noted");
    assert_eq!(note.line, Some(16));
    assert!(note.message.contains("\"rim\""), "the nearest: {note}");
}

#[test]
fn a_map_is_baked_for_the_amplitude_in_force() {
    let folder = Folder::new();
    let loaded = folder.read(
        "model = \"plane.obj\"\n[mapping]\namplitude = 0.06\n\
         [[material]]\nname = \"rim\"\nnormal_map = \"normal.png\"\n",
    );
    let rim = &loaded.settings.materials[1];
    assert_eq!(
        rim.map(MapRole::Normal).and_then(|s| s.baked_amplitude),
        Some(0.06)
    );
    assert_eq!(rim.amplitude, None);
}

#[test]
fn what_a_file_leaves_out_stays_as_the_model_brings_it() {
    let folder = Folder::new();
    let model = folder.open("plane.obj");
    let bare = folder.read("model = \"plane.obj\"");
    assert_eq!(bare.settings, model.settings);
    assert_eq!(bare.display, model.display);
    let partial = folder.read("model = \"plane.obj\"\n[camera]\nvfov_deg = 20");
    let mut wanted = model.settings.clone();
    wanted.camera.vfov = 20_f64.to_radians();
    assert_eq!(partial.settings, wanted);
    let dark = folder.read("model = \"plane.obj\"\nlight = []");
    assert!(dark.settings.lights.is_empty());
}

/// A file with every key of every table.
fn full_text(folder: &Folder) -> String {
    let mut scene = folder.open("plane.obj");
    let mut random = Random(5);
    random.change(&mut scene);
    let settings = &mut scene.settings;
    settings.lights = vec![
        Light::new("sky", LightKind::Ambient, 0.5),
        Light::new(
            "lamp",
            LightKind::Point {
                position: DVec3::ONE,
                falloff: Falloff::None,
            },
            1.0,
        ),
        Light::new(
            "sun",
            LightKind::Directional {
                direction: DVec3::NEG_Z,
            },
            1.0,
        ),
    ];
    settings.materials[1].name = "*".to_owned();
    settings.materials[0].maps = vec![MapSlot {
        enabled: false,
        channel: Channel::Alpha,
        invert: true,
        flip_green: true,
        space: NormalSpace::Object,
        axes: NormalAxes::FILE.with(1, FileAxis::ALL[5]),
        destair: true,
        flip_v: true,
        wrap: Wrap::Mirror,
        uv_scale: [2.0, 3.0],
        uv_offset: [0.5, 0.25],
        gain: 2.0,
        bias: 0.5,
        strength: 3.0,
        baked_amplitude: Some(0.1),
        note: "note".to_owned(),
        ..MapSlot::new(0, MapRole::Normal)
    }];
    scene.size = Some([4, 3]);
    let path = folder.path("full.toml");
    write_scene(&path, &SceneView::from(&scene)).expect("is written");
    fs::read_to_string(&path).expect("is there")
}

/// Each `key = value` line of a text with its number, from 1.
fn keys(text: &str) -> Vec<(usize, &str)> {
    let lines = text.lines().enumerate();
    lines
        .filter(|(_, line)| !line.starts_with(['#', '[']))
        .filter_map(|(i, line)| Some((i + 1, line.split_once(" = ")?.0)))
        .collect()
}

fn with_line(text: &str, number: usize, line: &str) -> String {
    let lines = text.lines().enumerate();
    let lines = lines.map(|(i, old)| if i + 1 == number { line } else { old });
    lines.collect::<Vec<_>>().join("\n")
}

#[test]
fn every_key_of_the_wrong_type_is_named_with_its_line() {
    let folder = Folder::new();
    let text = full_text(&folder);
    let keys = keys(&text);
    assert!(keys.len() > 60, "{}", keys.len());
    for (number, key) in keys {
        for wrong in ["{ wrong = 1 }", "1979-05-27", "[[true]]"] {
            let (line, message) =
                folder.fault(&with_line(&text, number, &format!("{key} = {wrong}")));
            assert_eq!(line, number, "{key}: {message}");
            assert!(message.contains(key), "{key}: {message}");
        }
    }
}

#[test]
fn unknown_keys_are_named_with_line_and_nearest_key() {
    let folder = Folder::new();
    let text = full_text(&folder);
    for (number, key) in keys(&text) {
        let misspelt = format!("{key}x");
        let line = text.lines().nth(number - 1).expect("is there");
        // The right line stays, so that nothing else is missing.
        let bad = with_line(&text, number, &format!("{line}\n{misspelt} = 1"));
        let (found, message) = folder.fault(&bad);
        assert_eq!(found, number + 1, "{message}");
        assert!(message.contains(&misspelt), "{message}");
        assert!(
            message.contains(&format!("`{key}`?")),
            "{misspelt}: {message}"
        );
    }
    let (line, message) = folder.fault("model = \"plane.obj\"\n[camera]\nzoom = 2\n");
    assert_eq!(line, 3);
    assert!(message.contains("eye, target, up, vfov_deg"), "{message}");
}

#[test]
fn values_out_of_range_are_named_with_line_and_key() {
    let folder = Folder::new();
    let cases = [
        ("[camera]", "vfov_deg", "0"),
        ("[camera]", "vfov_deg", "180.0"),
        ("[camera]", "vfov_deg", "nan"),
        ("[camera]", "eye", "[0, inf, 0]"),
        ("[camera]", "eye", "[0, 1]"),
        ("[camera]", "up", "[0, 0, 0]"),
        ("[shading]", "max_bounces", "65"),
        ("[shading]", "max_bounces", "1.5"),
        ("[shading]", "model", "\"phong\""),
        ("[shading]", "background", "[0, 0, -1]"),
        ("[shading]", "background", "{ top = [0, 0, 0] }"),
        ("[mapping]", "amplitude", "-0.1"),
        ("[mapping]", "amplitude", "\"big\""),
        ("[mapping]", "amplitude", "1e999"),
        ("[mapping]", "midlevel", "1e39"),
        ("[mapping]", "method", "\"bumb\""),
        ("[render]", "samples", "0"),
        ("[render]", "samples", "-3"),
        ("[render]", "size", "[0, 1]"),
        ("[render]", "size", "[65537, 1]"),
        ("[render]", "size", "[65536, 65536]"),
        ("[display]", "exposure_ev", "33"),
        ("[display]", "view", "\"colour\""),
        ("[[light]]\nkind = \"ambient\"", "intensity", "-1"),
        ("[[light]]\nkind = \"ambient\"", "color", "[1, -1, 1]"),
        ("[[light]]\nkind = \"ambient\"", "position", "[1, 1, 1]"),
        (
            "[[light]]\nkind = \"directional\"",
            "direction",
            "[0, 0, 0]",
        ),
        ("[[light]]\nkind = \"directional\"", "falloff", "\"none\""),
        ("[[light]]", "kind", "\"spot\""),
        ("[[material]]\nname = \"*\"", "reflectivity", "1.1"),
        ("[[material]]\nname = \"*\"", "shininess", "-1"),
        ("[[material]]\nname = \"*\"", "amplitude", "-1"),
        ("[[material]]\nname = \"*\"", "normal_amplitude", "0"),
        ("[[material]]\nname = \"*\"", "normal_y", "\"left\""),
        (
            "[[material]]\nname = \"*\"",
            "height_map",
            "\"nowhere.png\"",
        ),
        ("[[material]]\nname = \"*\"", "height_map", "\"plane.obj\""),
    ];
    for (table, key, value) in cases {
        let text = format!("model = \"plane.obj\"\n{table}\n{key} = {value}\n");
        let wanted = text.lines().count();
        let (line, message) = folder.fault(&text);
        assert_eq!(line, wanted, "{key} = {value}: {message}");
        assert!(message.contains(key), "{key} = {value}: {message}");
    }
}

#[test]
fn what_is_missing_or_contradicts_is_named() {
    let folder = Folder::new();
    let model = "model = \"plane.obj\"\n";
    let cases = [
        ("[camera]\n".to_owned(), 1, "model"),
        (format!("{model}built_in = \"wall\"\n"), 2, "built_in"),
        ("built_in = \"wal\"\n".to_owned(), 1, "wall"),
        ("\n\nmodel = \"nowhere.obj\"\n".to_owned(), 3, "nowhere.obj"),
        (format!("{model}[[light]]\nintensity = 1\n"), 2, "kind"),
        (
            format!("{model}[[light]]\nkind = \"point\"\n"),
            2,
            "position",
        ),
        (
            format!("{model}[[light]]\nkind = \"directional\"\n"),
            2,
            "direction",
        ),
        (
            format!("{model}[[light]]\nkind = \"ambient\"\n[[light]]\nkind = \"ambient\"\n"),
            4,
            "light.1",
        ),
        (format!("{model}[[material]]\nkd = [1, 1, 1]\n"), 2, "name"),
        (
            format!("{model}[[material]]\nname = \"*\"\n[[material.map]]\nrole = \"height\"\n"),
            4,
            "image",
        ),
        (
            format!("{model}[camera]\neye = [1, 1, 1]\ntarget = [1, 1, 1]\n"),
            4,
            "camera.target",
        ),
    ];
    for (text, wanted, word) in cases {
        let (line, message) = folder.fault(&text);
        assert_eq!(line, wanted, "{message}\nin\n{text}");
        assert!(message.contains(word), "{word}: {message}");
    }
}

#[test]
fn text_that_is_not_toml_is_refused_with_its_line() {
    let folder = Folder::new();
    let cases = [
        ("model = \"plane.obj\"\neye = [1,\n", 2..=3),
        ("model = plane.obj\n", 1..=1),
        ("model = \"plane.obj\"\nmodel = \"plane.obj\"\n", 2..=2),
        ("model = \"plane.obj\"\n[camera\n", 2..=2),
        ("model = \"plane.obj\"\n\n\u{1}\n", 3..=3),
    ];
    for (text, lines) in cases {
        let (line, message) = folder.fault(text);
        assert!(lines.contains(&line), "line {line}: {message}\nin\n{text}");
    }
    let path = folder.path("latin.toml");
    fs::write(&path, b"# caf\xe9\nmodel = \"plane.obj\"\n").expect("is written");
    let error = read_scene(&path, &LoadOptions::default()).expect_err("is not UTF-8");
    assert!(error.to_string().contains("latin.toml:1: "), "{error}");
    // Deep nesting must not overflow the stack.
    let deep = format!("model = {}", "[".repeat(100_000));
    folder.fault(&deep);
    // A byte order mark is no part of the first key.
    folder.read("\u{feff}model = \"plane.obj\"\n");
}

#[test]
fn files_appear_whole_or_not_at_all() {
    let folder = Folder::new();
    let mut scene = folder.open("plane.obj");
    let path = folder.write("saved.toml", "old");
    scene.settings.lights[0].intensity = f32::NAN;
    let error = write_scene(&path, &SceneView::from(&scene)).expect_err("NaN has no meaning");
    assert!(
        matches!(&error, SaveError::NotFinite(key) if key == "light.0.intensity"),
        "{error}"
    );
    assert_eq!(fs::read_to_string(&path).expect("is there"), "old");
    scene.settings.lights[0].intensity = 1.0;
    let nowhere = folder.path("no/such/folder.toml");
    assert!(write_scene(&nowhere, &SceneView::from(&scene)).is_err());
    write_scene(&path, &SceneView::from(&scene)).expect("is written");
    let files = fs::read_dir(folder.0.path()).expect("can be listed");
    let names = files.map(|f| f.expect("has a name").file_name());
    let strange: Vec<_> = names
        .filter(|name| name.to_string_lossy().contains("reliefscope"))
        .collect();
    assert!(strange.is_empty(), "left behind: {strange:?}");
}

/// More than would be read back is not written, and what was there stays.
#[test]
fn no_longer_file_is_written_than_is_read() {
    let folder = Folder::new();
    let mut scene = folder.open("plane.obj");
    let path = folder.write("saved.toml", "old");
    let mut name = |bytes: usize| {
        scene.settings.lights[0].name = "x".repeat(bytes);
        write_scene(&path, &SceneView::from(&scene))
    };
    let error = name(4 << 20).expect_err("longer than four MiB");
    assert!(
        matches!(&error, SaveError::TooLong { length, .. } if *length > 4 << 20),
        "{error}"
    );
    assert!(error.to_string().contains("saved.toml"), "{error}");
    assert_eq!(fs::read_to_string(&path).expect("is there"), "old");
    // Up to the last byte it is written, and read.
    name(1).expect("is written");
    let rest = fs::metadata(&path).expect("is there").len() as usize - 1;
    name((4 << 20) - rest).expect("as long as can be");
    assert_eq!(fs::metadata(&path).expect("is there").len(), 4 << 20);
    read_scene(&path, &LoadOptions::default()).expect("is read");
    assert!(name((4 << 20) - rest + 1).is_err());
}

#[test]
fn paths_are_relative_to_the_scene_file() {
    let folder = Folder::new();
    let scene = folder.open("plane.obj");
    fs::create_dir(folder.path("scenes")).expect("is made");
    let path = folder.path("scenes/saved.toml");
    write_scene(&path, &SceneView::from(&scene)).expect("is written");
    let text = fs::read_to_string(&path).expect("is there");
    assert!(text.contains("model = \"../plane.obj\""), "{text}");
    assert!(text.contains("image = \"../albedo.png\""), "{text}");
    let read = read_scene(&path, &LoadOptions::default()).expect("is read");
    same_settings(&read, &scene, 0);
}

fn set(loaded: &mut LoadedScene, all: &[(&str, &str)]) -> Result<(), String> {
    let all: Vec<(String, String)> = all
        .iter()
        .map(|&(k, v)| (k.to_owned(), v.to_owned()))
        .collect();
    apply_overrides(loaded, &all).map_err(|e| e.to_string())
}

#[test]
fn overrides_set_any_key() {
    let folder = Folder::new();
    let mut loaded = folder.open("plane.obj");
    loaded.settings.lights = vec![
        Light::new("sky", LightKind::Ambient, 1.0),
        Light::new(
            "sun",
            LightKind::Directional {
                direction: DVec3::NEG_Z,
            },
            1.0,
        ),
    ];
    let before = loaded.clone();
    set(&mut loaded, &[]).expect("nothing to do");
    assert_eq!(loaded.settings, before.settings);
    drop(before);
    let normal = folder.path("normal.png").display().to_string();
    set(
        &mut loaded,
        &[
            ("camera.vfov_deg", "30"),
            ("camera.eye.2", "9.5"),
            ("light.0.intensity", "3"),
            ("light.sun.color", "[1, 0.5, 0.25]"),
            ("material.*.shininess", "7"),
            ("material.rim.ks", "[0.2,0.2,0.2]"),
            ("material.1.normal_map", &normal),
            ("material.ground.map.height.gain", "2"),
            ("mapping.method", "parallax"),
            ("shading.background", "{ top = [1,1,1], bottom = [0,0,0] }"),
            ("render.size", "[64, 48]"),
            ("render.samples", "5"),
            ("display.exposure_ev", "-1.5"),
            ("display.view", "invalid-normals"),
        ],
    )
    .expect("all keys exist");
    let settings = &loaded.settings;
    assert_eq!(settings.camera.vfov, 30_f64.to_radians());
    assert_eq!(settings.camera.eye.z, 9.5);
    assert_eq!(settings.lights[0].intensity, 3.0);
    assert_eq!(settings.lights[1].color, LinearRgb::new(1.0, 0.5, 0.25));
    assert!(settings.materials.iter().all(|m| m.shininess == 7.0));
    assert_eq!(settings.materials[1].ks, LinearRgb::gray(0.2));
    let normal = settings.materials[1].map(MapRole::Normal).expect("was set");
    assert_eq!(loaded.scene.images[normal.image].name, "normal.png");
    let height = settings.materials[0].map(MapRole::Height).expect("has one");
    assert_eq!(height.gain, 2.0);
    assert_eq!(settings.mapping.method, Method::Parallax);
    assert_eq!(settings.shading.background.top, LinearRgb::WHITE);
    assert_eq!(settings.samples, 5);
    assert_eq!(loaded.size, Some([64, 48]));
    assert_eq!(loaded.display.exposure_ev, -1.5);
    assert_eq!(loaded.display.view, View::InvalidNormals);
}

#[test]
fn overrides_that_cannot_be_done_name_the_key() {
    let folder = Folder::new();
    let cases = [
        ("camera.vfov_deg", "300", "camera.vfov_deg"),
        ("camera.vfow_deg", "30", "vfov_deg"),
        ("camera.eye", "[1, 2]", "camera.eye"),
        ("cameras.eye", "[1, 2, 3]", "did you mean `camera`"),
        ("light.99.intensity", "1", "light.99.intensity"),
        ("light.0.intensity", "-1", "light.0.intensity"),
        ("material.grund.ks", "[1,1,1]", "ground"),
        ("material.ground.ks", "red", "material.0.ks"),
        ("material.ground.height_map", "nowhere.png", "height_map"),
        ("mapping.method", "bumb", "bump"),
        ("model", "other.obj", "INPUT"),
        ("normalize", "false", "--no-normalize"),
        ("", "1", "empty"),
        ("camera.vfov_deg.x", "1", "camera.vfov_deg.x"),
        ("zzz", "1", "zzz"),
    ];
    let mut loaded = folder.open("plane.obj");
    for (key, value, word) in cases {
        let message = set(&mut loaded, &[(key, value)]).expect_err("cannot be done");
        assert!(message.contains(&format!("{key}={value}")), "{message}");
        assert!(message.contains(word), "{word}: {message}");
        assert!(!message.contains('\n'), "one line: {message}");
    }
}

#[test]
fn overrides_with_a_doubtful_effect_are_warnings() {
    let folder = Folder::new();
    let mut loaded = folder.open("plane.obj");
    let known = loaded.warnings.len();
    set(&mut loaded, &[("material.rim.normal_y", "down")]).expect("is harmless");
    let [new] = &loaded.warnings[known..] else {
        panic!("{:?}", loaded.warnings)
    };
    assert!(new.message.contains("normal_y"), "{new}");
}

#[test]
fn overrides_do_not_add_pictures_to_a_shared_scene() {
    let folder = Folder::new();
    let mut loaded = folder.open("plane.obj");
    let _elsewhere = Arc::clone(&loaded.scene);
    let normal = folder.path("normal.png").display().to_string();
    let message = set(&mut loaded, &[("material.rim.normal_map", &normal)]);
    assert!(message.is_err_and(|m| m.contains("in use")));
}

const DOCUMENT: &str = include_str!("../../docs/scene.md");

#[test]
fn the_examples_of_the_document_open() {
    let folder = Folder::new();
    let blocks: Vec<&str> = DOCUMENT
        .split("```toml\n")
        .skip(1)
        .filter_map(|rest| rest.split("```").next())
        .collect();
    assert!(blocks.len() >= 8, "{}", blocks.len());
    for block in blocks {
        folder.read(block);
    }
}

#[test]
fn the_document_names_every_key() {
    let folder = Folder::new();
    let text = full_text(&folder);
    for (_, key) in keys(&text) {
        let rows = [format!("| `{key}` |"), format!("`{key} = []`")];
        assert!(rows.iter().any(|row| DOCUMENT.contains(row)), "{key}");
    }
    for role in MapRole::ALL {
        assert!(DOCUMENT.contains(&format!("| `{}_map` |", role.name())));
    }
    for method in Method::ALL {
        assert!(DOCUMENT.contains(&format!("`\"{}\"`", method.name())));
    }
}
