//! What is open: the scene, its settings, and what undo remembers of them.

use std::path::PathBuf;
use std::sync::Arc;

use egui::util::undoer::{Settings, Undoer};
use glam::DVec3;

use super::comparison::Comparison;
use crate::scene::built_in::Placement;
use crate::scene::{
    Camera, DisplaySettings, LoadWarning, LoadedScene, RenderSettings, Scene, SceneSource,
    ShadingSettings,
};
use crate::shading::{Falloff, Light, LightKind, Material};
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

/// The way from one placement of a built-in scene to another.
struct Shift {
    from: DVec3,
    to: DVec3,
    /// Of all lengths.
    ratio: f64,
}

impl Shift {
    /// `None` if the two are not the same built-in scene.
    fn between(from: &Document, to: &Document) -> Option<Self> {
        let (name, before) = Placement::of(&from.scene.source)?;
        let (other, after) = Placement::of(&to.scene.source)?;
        let middle = |doc: &Document| doc.bounds().iter().sum::<DVec3>() * 0.5;
        (name == other).then(|| Self {
            from: middle(from),
            to: middle(to),
            ratio: after.scale / before.scale,
        })
    }

    fn place(&self, p: DVec3) -> DVec3 {
        (p - self.from) * self.ratio + self.to
    }

    fn light(&self, light: &Light) -> Light {
        let mut light = light.clone();
        if let LightKind::Point { position, falloff } = &mut light.kind {
            *position = self.place(*position);
            if *falloff == Falloff::InverseSquare {
                // The same irradiance from a lamp that is `ratio` times as far away.
                let intensity = f64::from(light.intensity) * self.ratio * self.ratio;
                light.intensity = intensity.min(f64::from(f32::MAX)) as f32;
            }
        }
        light
    }

    fn material(&self, material: &Material) -> Material {
        let mut material = material.clone();
        material.default_amplitude *= self.ratio;
        material.amplitude = material.amplitude.map(|a| a * self.ratio);
        for slot in &mut material.maps {
            slot.baked_amplitude = slot.baked_amplitude.map(|baked| baked * self.ratio);
        }
        material
    }
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

    /// The same scene put elsewhere: everything that was set stays, and what has a place or a length goes along.
    #[must_use]
    pub fn put_to(self, loaded: LoadedScene) -> Self {
        let mut placed = Self::new(loaded);
        let Some(shift) = Shift::between(&self, &placed) else {
            return placed;
        };
        let before = self.settings;
        placed.settings = RenderSettings {
            camera: Camera {
                eye: shift.place(before.camera.eye),
                target: shift.place(before.camera.target),
                ..before.camera
            },
            lights: before.lights.iter().map(|l| shift.light(l)).collect(),
            materials: before.materials.iter().map(|m| shift.material(m)).collect(),
            mapping: MappingSettings {
                amplitude: before.mapping.amplitude.map(|a| a * shift.ratio),
                ..before.mapping
            },
            ..before
        };
        if let Some(scene) = Arc::get_mut(&mut placed.scene) {
            // Pictures that were added in the window, and what has been made of any.
            scene.images.clone_from(&self.scene.images);
        }
        placed.display = self.display;
        placed.comparison = self.comparison;
        placed
    }

    /// Whether an edit made a number that is none. Nothing else differs from itself.
    #[must_use]
    pub fn has_nan(&self) -> bool {
        let (settings, display, original) = (&self.settings, self.display, &self.original);
        let is_edited = *original == self.original;
        is_edited && (*settings != self.settings || display != self.display)
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
