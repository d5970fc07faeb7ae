//! What is open: the scene, its settings, and what undo remembers of them.

use std::path::PathBuf;
use std::sync::Arc;

use egui::util::undoer::{Settings, Undoer};
use glam::DVec3;

use super::comparison::Comparison;
use crate::scene::{
    Camera, DisplaySettings, LoadWarning, LoadedScene, RenderSettings, Scene, SceneSource,
    ShadingSettings,
};
use crate::shading::{Light, Material};
use crate::surface::mapping::MappingSettings;

/// An open scene. Panels edit `settings` and `display` in place.
pub struct Document {
    /// Geometry and maps.
    pub scene: Arc<Scene>,
    /// Render again.
    pub settings: RenderSettings,
    /// Encode again.
    pub display: DisplaySettings,
    /// The second method beside the first; not saved, and not undone.
    pub comparison: Comparison,
    /// The settings as opened, for the reset buttons.
    pub original: RenderSettings,
    /// Doubtful input.
    pub warnings: Vec<LoadWarning>,
    undo: Undoer<Edit>,
}

/// What an undo step brings back. The camera is not in it: nobody wants to lose a view to undo a colour.
#[derive(Clone, PartialEq)]
struct Edit {
    lights: Vec<Light>,
    materials: Vec<Material>,
    shading: ShadingSettings,
    mapping: MappingSettings,
    samples: u32,
    display: DisplaySettings,
}

impl Document {
    /// Takes over what the loader returned.
    #[must_use]
    pub fn new(loaded: LoadedScene) -> Self {
        let undo = Undoer::with_settings(Settings {
            stable_time: 0.4,
            ..Settings::default()
        });
        Self {
            scene: loaded.scene,
            original: loaded.settings.clone(),
            settings: loaded.settings,
            display: loaded.display,
            comparison: Comparison::default(),
            warnings: loaded.warnings,
            undo,
        }
    }

    /// The same scene put elsewhere: mapping, shading, samples and what is shown stay, and the camera goes along.
    /// Lights and materials are those of the scene.
    #[must_use]
    pub fn put_to(self, loaded: LoadedScene) -> Self {
        let ([min, max], extent) = (self.bounds(), self.extent());
        let mut placed = Self::new(loaded);
        let ([to_min, to_max], ratio) = (placed.bounds(), placed.extent() / extent);
        let put = |p: DVec3| (p - (min + max) * 0.5) * ratio + (to_min + to_max) * 0.5;
        let settings = &mut placed.settings;
        settings.camera = Camera {
            eye: put(self.settings.camera.eye),
            target: put(self.settings.camera.target),
            ..self.settings.camera
        };
        settings.mapping = self.settings.mapping;
        settings.mapping.amplitude = self.settings.mapping.amplitude.map(|a| a * ratio);
        settings.shading = self.settings.shading;
        settings.samples = self.settings.samples;
        placed.display = self.display;
        placed.comparison = self.comparison;
        placed
    }

    /// The scene file that it was read from, where saving goes without asking.
    #[must_use]
    pub fn scene_file(&self) -> Option<&PathBuf> {
        match &self.scene.source {
            SceneSource::SceneFile(path) => Some(path),
            SceneSource::BuiltIn(_) | SceneSource::Model(_) => None,
        }
    }

    /// Corners of the model; a unit cube where there is none.
    #[must_use]
    pub fn bounds(&self) -> [DVec3; 2] {
        let unit = [DVec3::splat(-0.5), DVec3::splat(0.5)];
        self.scene.facts.bounds.unwrap_or(unit)
    }

    /// Largest extent of the model, world units; 1 where it has none.
    #[must_use]
    pub fn extent(&self) -> f64 {
        let [min, max] = self.bounds();
        let extent = (max - min).max_element();
        if extent > 0.0 && extent.is_finite() {
            extent
        } else {
            1.0
        }
    }

    /// Notes the state after a frame's edits; returns whether a change still waits to become an undo step.
    pub fn remember(&mut self, time: f64) -> bool {
        let now = self.edit();
        self.undo.feed_state(time, &now);
        self.undo.is_in_flux()
    }

    /// Takes the last edit back; `false` if there is none.
    pub fn undo(&mut self) -> bool {
        let now = self.edit();
        let before = self.undo.undo(&now).cloned();
        self.restore(before)
    }

    /// Does it again; `false` if nothing was undone.
    pub fn redo(&mut self) -> bool {
        let now = self.edit();
        let after = self.undo.redo(&now).cloned();
        self.restore(after)
    }

    fn edit(&self) -> Edit {
        Edit {
            lights: self.settings.lights.clone(),
            materials: self.settings.materials.clone(),
            shading: self.settings.shading,
            mapping: self.settings.mapping,
            samples: self.settings.samples,
            display: self.display,
        }
    }

    fn restore(&mut self, edit: Option<Edit>) -> bool {
        let Some(edit) = edit else { return false };
        self.settings.lights = edit.lights;
        self.settings.materials = edit.materials;
        self.settings.shading = edit.shading;
        self.settings.mapping = edit.mapping;
        self.settings.samples = edit.samples;
        self.display = edit.display;
        true
    }
}
