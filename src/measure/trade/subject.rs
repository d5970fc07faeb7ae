//! What is measured: a scene and the place on its relief that the middle of the picture sees.

use std::sync::Arc;

use glam::{DVec3, Vec3};

use super::depths::cut_to_eight_bits;
use super::orbit::orbited;
use super::sights::{Pinhole, Sight};
use super::slopes::add_slope_maps;
use super::{Truth, Variant, View};
use crate::render::{Frame, Snapshot, amplitude};
use crate::scene::{RenderSettings, Scene};
use crate::surface::mapping::MappingSettings;
use crate::texture::{MapImage, MapRole, MapSlot};

/// Places across and down the picture at which a relief is looked for.
const LOOKED_AT: [u32; 2] = [65, 37];

/// Why nothing can be measured.
#[derive(Debug, thiserror::Error)]
pub enum TradeError {
    /// There is no relief in the picture.
    #[error(
        "nothing to measure: no part of the picture shows a relief (a height map over texture coordinates, with an amplitude above 0, seen from its front)"
    )]
    NoRelief,
    /// Worker threads cannot be started.
    #[error("cannot start worker threads: {0}")]
    Threads(std::io::Error),
}

/// A scene made ready to be measured from many sides.
#[derive(Debug, Clone)]
pub struct Subject {
    snapshot: Snapshot,
    /// The scene with its height maps cut to 8 bits, if they have more.
    eight_bits: Option<Arc<Scene>>,
    truth: Truth,
    /// World place that is looked at.
    pivot: DVec3,
    /// Unit normal there, towards the eye.
    normal: DVec3,
    /// Index of the material there.
    material: usize,
    /// Angle at which the scene's own camera sees it, degrees.
    own_angle_deg: f64,
}

impl Subject {
    /// Finds the place to look at: what the middle of the picture sees, else the nearest place to the middle that
    /// shows a relief.
    ///
    /// # Errors
    /// [`TradeError::NoRelief`].
    pub fn new(snapshot: Snapshot, truth: Truth) -> Result<Self, TradeError> {
        let exact = with_mapping(&snapshot, truth.settings(&snapshot.settings.mapping));
        let frame = Frame::new(&exact);
        let sight = middle_sight(&frame, snapshot.size).ok_or(TradeError::NoRelief)?;
        let normalization = &snapshot.scene.normalization;
        let pivot = normalization.world_from_internal(Vec3::from(sight.surface.p));
        Ok(Self {
            pivot,
            normal: sight.facet.normal,
            material: sight.material,
            own_angle_deg: sight.angle_deg(),
            eight_bits: None,
            truth,
            snapshot,
        })
    }

    /// Gives materials whose normals are in a map their slopes, too, so that the method that reads them can be measured.
    /// Returns how many maps were made.
    pub fn prepare_slopes(&mut self) -> usize {
        let mut scene = (*self.snapshot.scene).clone();
        let mut settings = (*self.snapshot.settings).clone();
        let added = add_slope_maps(&mut scene, &mut settings.materials);
        if added > 0 {
            self.snapshot.scene = Arc::new(scene);
            self.snapshot.settings = Arc::new(settings);
        }
        added
    }

    /// Makes ready what views of 8 bits need.
    pub fn prepare_eight_bits(&mut self) {
        let used = self.height_images();
        self.eight_bits = cut_to_eight_bits(&self.snapshot.scene, &used).map(Arc::new);
    }

    /// What is true here.
    #[must_use]
    pub const fn truth(&self) -> Truth {
        self.truth
    }

    /// The scene as it was given.
    #[must_use]
    pub const fn snapshot(&self) -> &Snapshot {
        &self.snapshot
    }

    /// Angle at which the scene's own camera sees the place, degrees.
    #[must_use]
    pub const fn own_angle_deg(&self) -> f64 {
        self.own_angle_deg
    }

    /// Index of the material that is looked at.
    #[must_use]
    pub const fn material(&self) -> usize {
        self.material
    }

    /// The height slot of the material that is looked at.
    #[must_use]
    pub fn height_slot(&self) -> Option<&MapSlot> {
        let material = &self.snapshot.settings.materials[self.material];
        material.map(MapRole::Height)
    }

    /// Its height map.
    #[must_use]
    pub fn height_image(&self) -> Option<&MapImage> {
        self.image(MapRole::Height)
    }

    /// The picture that the material that is looked at has in this role.
    #[must_use]
    pub fn image(&self, role: MapRole) -> Option<&MapImage> {
        let slot = self.snapshot.settings.materials[self.material].map(role)?;
        self.snapshot.scene.images.get(slot.image)
    }

    /// Whether the material has a map in this role.
    #[must_use]
    pub fn has(&self, role: MapRole) -> bool {
        let material = &self.snapshot.settings.materials[self.material];
        material.map(role).is_some()
    }

    /// Its amplitude, world units.
    #[must_use]
    pub fn amplitude(&self) -> f64 {
        let settings = &self.snapshot.settings;
        amplitude(&settings.materials[self.material], &settings.mapping)
    }

    /// Bits of height that can be measured: the map's own first, then 8 if [`prepare_eight_bits`] found more.
    ///
    /// [`prepare_eight_bits`]: Self::prepare_eight_bits
    #[must_use]
    pub fn depths(&self) -> Vec<u8> {
        let own = self.height_image().map_or(8, |image| image.raw.bits());
        std::iter::once(own)
            .chain(self.eight_bits.is_some().then_some(8))
            .collect()
    }

    /// The settings of a view before any method is chosen.
    #[must_use]
    pub fn seen_from(&self, view: View) -> RenderSettings {
        let mut settings = (*self.snapshot.settings).clone();
        let angle = view.angle_deg.to_radians();
        settings.camera = orbited(&settings.camera, self.pivot, self.normal, angle);
        for i in 0..settings.materials.len() {
            let own = amplitude(&settings.materials[i], &settings.mapping);
            settings.materials[i].amplitude = Some(own * view.amplitude);
        }
        settings
    }

    /// The true picture of a view's settings.
    #[must_use]
    pub fn true_snapshot(&self, seen: &RenderSettings, size: [u32; 2]) -> Snapshot {
        let mapping = self.truth.settings(&seen.mapping);
        self.with(&self.snapshot.scene, seen, mapping, size)
    }

    /// A variant's picture of a view's settings, from heights of so many bits.
    #[must_use]
    pub fn variant_snapshot(
        &self,
        seen: &RenderSettings,
        (variant, bits): (&Variant, u8),
        size: [u32; 2],
    ) -> Snapshot {
        let scene = match &self.eight_bits {
            Some(cut) if bits == 8 => cut,
            _ => &self.snapshot.scene,
        };
        self.with(scene, seen, variant.applied(&seen.mapping), size)
    }

    fn with(
        &self,
        scene: &Arc<Scene>,
        seen: &RenderSettings,
        mapping: MappingSettings,
        size: [u32; 2],
    ) -> Snapshot {
        let mut settings = seen.clone();
        settings.mapping = mapping;
        Snapshot {
            scene: Arc::clone(scene),
            settings: Arc::new(settings),
            size,
        }
    }

    /// Indices of the pictures that serve as heights.
    fn height_images(&self) -> Vec<usize> {
        let materials = self.snapshot.settings.materials.iter();
        let images = materials.filter_map(|m| m.map(MapRole::Height).map(|slot| slot.image));
        images
            .filter(|&i| i < self.snapshot.scene.images.len())
            .collect()
    }
}

/// The same scene under other mapping settings.
pub(super) fn with_mapping(snapshot: &Snapshot, mapping: MappingSettings) -> Snapshot {
    let mut settings = (*snapshot.settings).clone();
    settings.mapping = mapping;
    Snapshot {
        settings: Arc::new(settings),
        ..snapshot.clone()
    }
}

/// The ray nearest to the middle of the picture that shows a relief.
fn middle_sight(frame: &Frame<'_>, size: [u32; 2]) -> Option<Sight> {
    let [columns, rows] = LOOKED_AT;
    let mut places: Vec<[f32; 2]> = (0..rows)
        .flat_map(|j| (0..columns).map(move |i| [i, j]))
        .map(|[i, j]| {
            [
                (i as f32 + 0.5) / columns as f32 * size[0] as f32,
                (j as f32 + 0.5) / rows as f32 * size[1] as f32,
            ]
        })
        .collect();
    let from_middle = |p: &[f32; 2]| {
        let [dx, dy] = [0, 1].map(|k| p[k] - size[k] as f32 * 0.5);
        dx.mul_add(dx, dy * dy)
    };
    places.sort_by(|a, b| from_middle(a).total_cmp(&from_middle(b)));
    let pinhole = Pinhole::of(frame);
    places.iter().find_map(|&place| pinhole.sight(place))
}
