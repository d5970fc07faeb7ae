//! Every control once, found by role and name, with a look at what it did.

use std::path::Path;

use egui::accesskit::Role;
use egui::{Pos2, Rect, vec2};
use glam::DVec3;
use reliefscope::scene::load::LoadOptions;
use reliefscope::scene::{ShadingModel, TextureFilter, open};
use reliefscope::shading::{Falloff, LightKind};
use reliefscope::surface::mapping::{Derivative, Lookup, Method};
use reliefscope::texture::{Channel, MapRole, NormalSpace, Wrap};
use reliefscope::viewer::document::Document;

use super::driver::Driver;

/// With a section opened by its title.
fn with_section(title: &str) -> Driver {
    let mut driver = Driver::reference();
    driver.section(title);
    driver
}

#[test]
fn every_method_by_click() {
    let mut driver = Driver::reference();
    for method in Method::ALL.into_iter().rev() {
        driver.button(method.info().label);
        assert_eq!(driver.settings().mapping.method, method);
    }
}

#[test]
fn the_method_section() {
    let mut driver = Driver::reference();
    driver.number("Amplitude", 0.5);
    assert_eq!(driver.settings().mapping.amplitude, Some(0.5));
    driver.button("Reset Amplitude");
    assert_eq!(driver.settings().mapping.amplitude, Some(0.06));
    let before = driver.settings().mapping.amplitude;
    driver.slider("Amplitude slider", 0.01);
    assert_ne!(driver.settings().mapping.amplitude, before);
    driver.check("Each material its own amplitude");
    assert_eq!(driver.settings().mapping.amplitude, None);
    driver.check("Each material its own amplitude");
    assert!(driver.settings().mapping.amplitude.is_some());
    driver.number("Midlevel", 0.25);
    assert_eq!(driver.settings().mapping.midlevel, 0.25);
    driver.slider("Midlevel slider", 0.75);
    assert_eq!(driver.settings().mapping.midlevel, 0.75);
    driver.check("Height");
    driver.check("Normal");
    driver.check("Parallax");
    let mapping = driver.settings().mapping;
    assert!(!mapping.use_height && !mapping.use_normal && !mapping.use_parallax);
    driver.choose("Derivative", "central");
    assert_eq!(driver.settings().mapping.derivative, Derivative::Central);
    driver.key(egui::Key::Num5);
    driver.choose("Lookup", "normal");
    assert_eq!(driver.settings().mapping.lookup, Lookup::Normal);
    driver.settle();
}

#[test]
fn the_lights_section() {
    let mut driver = with_section("Lights");
    let count = driver.settings().lights.len();
    driver.button("Ambient");
    driver.button("Point");
    driver.button("Directional");
    let names: Vec<_> = driver.settings().lights[count..]
        .iter()
        .map(|l| l.name.clone())
        .collect();
    assert_eq!(names.len(), 3);
    let light = |driver: &Driver, i: usize| driver.settings().lights[count + i].clone();
    assert_eq!(light(&driver, 0).kind, LightKind::Ambient);
    driver.check(&format!("{} on", names[0]));
    assert!(!light(&driver, 0).enabled);
    driver.number(&format!("{} intensity", names[1]), 7.5);
    assert_eq!(light(&driver, 1).intensity, 7.5);
    driver.number(&format!("{} position y", names[1]), -3.0);
    driver.choose(&format!("{} falloff", names[1]), "none");
    let LightKind::Point { position, falloff } = light(&driver, 1).kind else {
        panic!("a point light");
    };
    assert_eq!((position.y, falloff), (-3.0, Falloff::None));
    driver.number(&format!("{} direction x", names[2]), 0.125);
    let LightKind::Directional { direction } = light(&driver, 2).kind else {
        panic!("a directional light");
    };
    assert_eq!(direction.x, 0.125);
    driver.settle();
    driver.button(&format!("{} remove", names[1]));
    assert_eq!(driver.settings().lights.len(), count + 2);
    assert!(driver.settings().lights.iter().all(|l| l.name != names[1]));
}

/// A number that is none differs from itself: what is shown would never be what was asked for.
#[test]
fn no_edit_leaves_a_number_that_is_none() {
    let mut driver = with_section("Lights");
    driver.button("Directional");
    let lights = &driver.settings().lights;
    let (last, name) = (lights.len() - 1, lights[lights.len() - 1].name.clone());
    let before = lights[last].kind;
    // Its length is more than a number can tell.
    driver.number(&format!("{name} direction x"), 1e300);
    assert_eq!(driver.settings().lights[last].kind, before);
    assert!(!driver.doc().has_nan());
    driver.settle();
    let loaded = open(Path::new("extremes"), &LoadOptions::default()).expect("is built in");
    let mut doc = Document::new(loaded);
    assert!(!doc.has_nan());
    doc.settings.lights[0].intensity = f32::NAN;
    assert!(doc.has_nan());
    doc.settings.lights[0].intensity = 1.0;
    doc.display.exposure_ev = f32::NAN;
    assert!(doc.has_nan());
}

#[test]
fn a_direction_never_becomes_zero() {
    let mut driver = with_section("Lights");
    driver.button("Directional");
    let name = driver
        .settings()
        .lights
        .last()
        .expect("a light")
        .name
        .clone();
    for axis in ["x", "y", "z"] {
        driver.number(&format!("{name} direction {axis}"), 0.0);
    }
    let LightKind::Directional { direction } = driver.settings().lights.last().expect("it").kind
    else {
        panic!("a directional light");
    };
    assert_ne!(direction, DVec3::ZERO);
}

#[test]
fn the_materials_section() {
    let mut driver = with_section("Materials");
    let name = driver.settings().materials[0].name.clone();
    driver.button(&format!("Material {name}"));
    assert_eq!(driver.app().state().material, 0);
    driver.number("Shininess", 321.0);
    driver.number("Reflectivity", 0.5);
    driver.slider("Reflectivity slider", 0.25);
    driver.check("Own amplitude");
    driver.number("Material amplitude", 0.125);
    driver.check("Own midlevel");
    driver.number("Material midlevel", 0.5);
    let material = &driver.settings().materials[0];
    assert_eq!(material.shininess, 321.0);
    assert_eq!(material.reflectivity, 0.25);
    assert_eq!(material.amplitude, Some(0.125));
    assert_eq!(material.midlevel, Some(0.5));
    driver.button("Reset Shininess");
    driver.button("Reset Reflectivity");
    let original = &driver.doc().original.materials[0];
    assert_eq!(driver.settings().materials[0].shininess, original.shininess);
    for color in ["kd", "ks"] {
        assert!(driver.has(color), "a colour button named {color}");
    }
    driver.settle();
}

#[test]
fn the_map_slots() {
    let mut driver = with_section("Materials");
    let slot_of = |driver: &Driver, role: MapRole| {
        let maps = &driver.settings().materials[0].maps;
        maps.iter()
            .position(|slot| slot.role == role)
            .expect("a slot")
    };
    let height = slot_of(&driver, MapRole::Height);
    let normal = slot_of(&driver, MapRole::Normal);
    let label = |slot: usize, what: &str| format!("Map {} {what}", slot + 1);
    driver.check(&label(height, "invert"));
    driver.check(&label(height, "flip V"));
    driver.choose(&label(height, "channel"), "g");
    driver.check(&label(normal, "flip green"));
    driver.choose(&label(normal, "space"), "mikktspace");
    driver.number(&label(normal, "baked amplitude"), 0.5);
    driver.section(&label(height, "addressing"));
    driver.choose(&label(height, "wrap"), "clamp");
    driver.number(&label(height, "scale u"), 3.0);
    driver.number(&label(height, "offset v"), 0.5);
    driver.number(&label(height, "gain"), 0.5);
    driver.number(&label(height, "bias"), 0.25);
    let maps = driver.settings().materials[0].maps.clone();
    let slot = &maps[height];
    assert!(slot.invert && slot.flip_v);
    assert_eq!((slot.channel, slot.wrap), (Channel::G, Wrap::Clamp));
    assert_eq!((slot.uv_scale, slot.uv_offset), ([3.0, 1.0], [0.0, 0.5]));
    assert_eq!((slot.gain, slot.bias), (0.5, 0.25));
    assert!(maps[normal].flip_green);
    assert_eq!(maps[normal].space, NormalSpace::MikkTSpace);
    assert_eq!(maps[normal].baked_amplitude, Some(0.5));
    driver.check(&label(height, "on"));
    assert!(!driver.settings().materials[0].maps[height].enabled);
    driver.choose(&label(height, "as"), "opacity");
    assert_eq!(
        driver.settings().materials[0].maps[height].role,
        MapRole::Opacity
    );
    driver.settle();
    driver.button(&label(height, "remove"));
    assert_eq!(driver.settings().materials[0].maps.len(), maps.len() - 1);
}

/// The reference's albedo has 8 bits: read as heights it tells its levels and offers the filter; its 16-bit
/// height map does neither.
#[test]
fn few_levels_are_told() {
    let mut driver = with_section("Materials");
    let maps = driver.settings().materials[0].maps.clone();
    let slot_of = |role| maps.iter().position(|s| s.role == role).expect("a slot");
    let label = |role, what: &str| format!("Map {} {what}", slot_of(role) + 1);
    assert!(!driver.has(&label(MapRole::Height, "de-stair")));
    driver.choose(&label(MapRole::Albedo, "as"), "height");
    driver.choose(&label(MapRole::Albedo, "channel"), "r");
    driver.settle();
    let image = &driver.doc().scene.images[maps[slot_of(MapRole::Albedo)].image];
    let levels = image.heights(Channel::R).levels().count;
    assert!(driver.has(&format!("Your map has {levels} levels")));
    driver.check(&label(MapRole::Albedo, "de-stair"));
    assert!(driver.settings().materials[0].maps[slot_of(MapRole::Albedo)].destair);
    driver.settle();
}

#[test]
fn the_shading_section() {
    let mut driver = with_section("Shading");
    driver.choose("Shading model", "report");
    driver.choose("Texture filter", "mip");
    assert_eq!(driver.settings().shading.filter, TextureFilter::Mip);
    driver.check("Specular antialiasing");
    assert!(driver.settings().shading.specular_antialiasing);
    driver.check("Smooth terminator");
    assert!(driver.settings().shading.smooth_terminator);
    driver.check("Shadows");
    driver.number("Mirror bounces", 5.0);
    let shading = driver.settings().shading;
    assert_eq!(shading.model, ShadingModel::Report);
    assert_eq!((shading.shadows, shading.max_bounces), (false, 5));
    driver.button("Reset Mirror bounces");
    assert_eq!(
        driver.settings().shading.max_bounces,
        driver.doc().original.shading.max_bounces
    );
    for color in ["Background top", "Background bottom"] {
        assert!(driver.has(color), "a colour button named {color}");
    }
    driver.settle();
}

#[test]
fn a_colour_is_picked() {
    let mut driver = with_section("Shading");
    driver.click(Role::ColorWell, "Background top");
    driver.number("Background top green", 0.5);
    assert_eq!(driver.settings().shading.background.top.g, 0.5);
    driver.click(Role::Slider, "Background top hue");
    let top = driver.settings().shading.background.top;
    assert!(
        top.b > top.r && top.g > top.r,
        "the middle of the track is cyan: {top:?}"
    );
    driver.click(Role::Slider, "Background top saturation");
    driver.click(Role::Slider, "Background top brightness");
    assert_ne!(driver.settings().shading.background.top, top);
}

#[test]
fn the_render_section() {
    let mut driver = with_section("Render");
    driver.number("Samples", 3.0);
    assert_eq!(driver.settings().samples, 3);
    driver.check("Full resolution while moving");
    driver.check("Pause refining");
    assert!(!driver.app().state().paused, "the driver had paused");
    driver.number("Threads", 2.0);
    assert_eq!(driver.app().state().threads, 2);
    driver.check("Probe pixels");
    assert!(driver.app().state().probe);
    driver.settle();
}

#[test]
fn the_display_section() {
    let mut driver = with_section("Display");
    driver.number("Exposure", 2.0);
    assert_eq!(driver.doc().display.exposure_ev, 2.0);
    driver.slider("Exposure slider", -1.0);
    assert_eq!(driver.doc().display.exposure_ev, -1.0);
    driver.button("Reset Exposure");
    assert_eq!(driver.doc().display.exposure_ev, 0.0);
}

#[test]
fn the_menu_runs_commands() {
    let mut driver = Driver::reference();
    driver.button("Menu");
    driver.click(Role::Button, "Darker Shift+E");
    assert!(driver.doc().display.exposure_ev < 0.0);
    driver.button("Menu");
    driver.button("Method");
    driver.click(Role::Button, "Slope map 3");
    assert_eq!(driver.settings().mapping.method, Method::Slope);
}

#[test]
fn the_menu_fits_the_window() {
    let mut driver = Driver::reference();
    let size = vec2(1280.0, 720.0);
    driver.harness.set_size(size);
    driver.button("Menu");
    driver.button("Method");
    driver.harness.run_steps(4);
    let window = Rect::from_min_size(Pos2::ZERO, size);
    for (role, label) in [
        (Role::Button, "Open… Ctrl+O"),
        (Role::Button, "Keys and mouse F1, ?"),
        (Role::Button, "None 1"),
        (Role::Button, "Displacement Backslash"),
    ] {
        let row = driver.node(role, label).rect();
        assert!(window.contains_rect(row), "{label}: {row:?}");
    }
}
