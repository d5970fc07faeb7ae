//! Opening, saving and dropping files in the window.

use egui::Key;
use egui::accesskit::Role;
use reliefscope::scene::built_in::SCENES;
use reliefscope::scene::load::LoadOptions;
use reliefscope::scene::{SceneSource, open};
use reliefscope::texture::MapRole;
use reliefscope::viewer::status::Progress;

use super::driver::{Driver, reference};

/// Types into the path field.
pub fn type_path(driver: &mut Driver, field: &str, path: &std::path::Path) {
    let text = path.to_str().expect("UTF-8").to_owned();
    driver
        .node(Role::TextInput, field)
        .set_text_value_accesskit(&text);
    driver.harness.run_steps(2);
}

#[test]
fn a_path_is_opened() {
    let mut driver = Driver::reference();
    type_path(&mut driver, "Path", &reference("plane.obj"));
    driver.button("Open path");
    driver.wait_until(|app| {
        let source = app.document().map(|doc| &doc.scene.source);
        matches!(source, Some(SceneSource::Model(_)))
    });
    driver.settle();
}

#[test]
fn a_built_in_scene_is_opened_from_the_menu() {
    let mut driver = Driver::reference();
    let scene = &SCENES[1];
    driver.button("Built-in scenes");
    driver.button(scene.label);
    driver.wait_until(|app| {
        let source = app.document().map(|doc| &doc.scene.source);
        source == Some(&SceneSource::BuiltIn(scene.name.to_owned()))
    });
    driver.settle();
}

#[test]
fn a_broken_path_keeps_the_scene_and_says_why() {
    let mut driver = Driver::reference();
    let before = driver.doc().scene.name.clone();
    type_path(
        &mut driver,
        "Path",
        std::path::Path::new("missing/model.obj"),
    );
    driver.button("Open path");
    driver.wait_until(|app| {
        app.messages()
            .any(|text| text.contains("missing/model.obj"))
    });
    assert_eq!(driver.doc().scene.name, before);
    let is_it = |text: &&str| text.contains("missing/model.obj");
    let dismiss = driver
        .app()
        .messages()
        .find(is_it)
        .map(|text| format!("Dismiss: {text}"));
    driver.button(&dismiss.expect("a message"));
    assert_eq!(driver.app().messages().find(is_it), None);
}

#[test]
fn a_scene_is_saved_and_read_back() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("saved.toml");
    let mut driver = Driver::reference();
    driver.number("Amplitude", 0.03125);
    driver.key(Key::Num6);
    type_path(&mut driver, "Path", &path);
    driver.button("Save to path");
    let loaded = open(&path, &LoadOptions::default()).expect("it can be read");
    assert_eq!(loaded.settings.mapping, driver.settings().mapping);
    assert_eq!(loaded.settings.lights, driver.settings().lights);
}

#[test]
fn a_picture_is_saved() {
    let folder = tempfile::tempdir().expect("a folder");
    for ending in ["png", "exr"] {
        let path = folder.path().join("picture").with_extension(ending);
        let mut driver = Driver::reference();
        type_path(&mut driver, "Path", &path);
        driver.button("Save to path");
        driver.wait_until(|app| app.messages().any(|text| text.starts_with("Saved")));
        assert!(path.metadata().expect("a file").len() > 100);
    }
}

#[test]
fn a_picture_is_added_to_the_material_and_replaced() {
    let mut driver = Driver::reference();
    driver.section("Materials");
    let count = driver.settings().materials[0].maps.len();
    // Known to the scene already: no second copy is kept.
    type_path(&mut driver, "Picture path", &reference("normal.png"));
    driver.button("Add picture");
    driver.wait_until(|app| {
        let maps = app
            .document()
            .map(|doc| doc.settings.materials[0].maps.len());
        maps == Some(count + 1)
    });
    let slot = driver.settings().materials[0].maps[count].clone();
    assert_eq!(slot.role, MapRole::Normal);
    assert!(slot.baked_amplitude.is_some());
    driver.settle();
}

#[test]
fn a_broken_picture_is_refused_with_its_name() {
    let mut driver = Driver::reference();
    driver.section("Materials");
    type_path(&mut driver, "Picture path", &reference("plane.obj"));
    driver.button("Add picture");
    driver.wait_until(|app| app.messages().any(|text| text.contains("plane.obj")));
}

#[test]
fn a_window_without_input_opens_the_first_scene() {
    let mut driver = Driver::open(SCENES[0].name);
    assert_eq!(
        driver.doc().scene.source,
        SceneSource::BuiltIn(SCENES[0].name.to_owned())
    );
    let shown = driver.app().progress();
    assert!(
        !matches!(shown, Progress::Converged(_)),
        "nothing has converged: {shown:?}"
    );
    driver.settle();
}

#[test]
fn a_first_input_that_fails_leaves_a_working_window() {
    let driver = Driver::open("missing/model.obj");
    assert!(
        driver
            .app()
            .messages()
            .any(|text| text.contains("missing/model.obj"))
    );
    assert_eq!(
        driver.doc().scene.source,
        SceneSource::BuiltIn(SCENES[0].name.to_owned())
    );
}

/// A pipe that nobody writes to is a file that loads forever.
#[cfg(unix)]
#[test]
fn a_load_is_cancelled_and_the_scene_stays() {
    let folder = tempfile::tempdir().expect("a folder");
    let pipe = folder.path().join("endless.obj");
    let made = std::process::Command::new("mkfifo").arg(&pipe).status();
    assert!(made.expect("mkfifo runs").success());
    let mut driver = Driver::reference();
    let before = driver.doc().scene.name.clone();
    type_path(&mut driver, "Path", &pipe);
    driver.button("Open path");
    driver.wait_until(|app| app.is_loading());
    assert!(driver.has("Loading endless.obj"));
    // The window is alive meanwhile.
    driver.number("Amplitude", 0.0625);
    driver.button("Cancel loading");
    driver.wait_until(|app| !app.is_loading());
    assert!(driver.app().messages().any(|m| m.contains("cancelled")));
    assert_eq!(driver.doc().scene.name, before);
    assert!(!driver.has("Loading endless.obj"));
    // Lets the thread that still waits for the pipe go.
    drop(std::fs::OpenOptions::new().write(true).open(&pipe));
}
