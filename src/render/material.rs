//! A material made ready for tiles.

use glam::Vec2;

use crate::geometry::{Hit, TangentCell, TriangleMesh};
use crate::math::{LinearRgb, Real, V2};
use crate::scene::{Scene, ShadingSettings, TextureFilter};
use crate::shading::Material;
use crate::surface::mapping::relief::ReliefField;
use crate::surface::mapping::{
    BoundHeight, BoundNormal, MappingSettings, MaterialMapping, MaterialMaps,
};
use crate::surface::{BakedFrame, SurfaceInteraction, SurfaceParts};
use crate::texture::{
    Addressing, ColorMap, HeightMap, Heights, Look, MapRole, MapSlot, Mips, NormalSpace, Wrap,
};

/// An albedo map tied to its material.
#[derive(Debug, Clone, Copy)]
pub struct BoundColor<'a> {
    map: &'a ColorMap,
    addressing: Addressing,
    gain: f32,
    bias: f32,
    mips: Option<Mips<'a, ColorMap>>,
}

impl BoundColor<'_> {
    /// See [`Mips::prefetch`].
    #[inline(always)]
    pub fn prefetch<F: Real>(&self, uv: V2<F>) {
        let place = (self.addressing.st(uv), self.addressing.wrap);
        Mips::prefetch(self.map, self.mips.as_ref(), place);
    }

    /// Linear colour at `uv`, the mean over the footprint of a point.
    #[inline(always)]
    #[must_use]
    pub fn color<F: Real>(&self, uv: V2<F>, footprint: F) -> LinearRgb<F> {
        let look = ColorAt(self.addressing.st(uv), self.addressing.wrap);
        let [r, g, b] = Mips::look(self.map, self.mips.as_ref(), footprint, &look);
        if self.gain == 1.0 && self.bias == 0.0 {
            return LinearRgb { r, g, b };
        }
        LinearRgb {
            r: r * self.gain + self.bias,
            g: g * self.gain + self.bias,
            b: b * self.gain + self.bias,
        }
    }
}

/// Colours at a place.
struct ColorAt<F: Real>(V2<F>, Wrap);

impl<F: Real> Look<F, 3> for ColorAt<F> {
    type Map = ColorMap;
    #[inline(always)]
    fn at(&self, map: &ColorMap) -> [F; 3] {
        let LinearRgb { r, g, b } = map.sample(self.0, self.1);
        [r, g, b]
    }
}

/// A cut-out map tied to its material.
#[derive(Debug, Clone, Copy)]
pub struct BoundOpacity<'a> {
    map: &'a HeightMap,
    addressing: Addressing,
    scale: f32,
    offset: f32,
}

impl BoundOpacity<'_> {
    /// Whether there is surface at `uv`: opacity of one half or more.
    #[must_use]
    pub fn is_solid(&self, uv: V2) -> bool {
        self.map
            .sample(self.addressing.st(uv), self.addressing.wrap)
            * self.scale
            + self.offset
            >= 0.5
    }
}

/// One material with its maps found and its choices made.
#[derive(Debug, Clone, Copy)]
pub struct FrameMaterial<'a> {
    /// Diffuse colour, multiplies `albedo`.
    pub kd: LinearRgb,
    /// Specular colour.
    pub ks: LinearRgb,
    /// Whether a highlight is computed at all.
    pub is_glossy: bool,
    /// Whether the highlight widens where slopes differ.
    pub widens_highlights: bool,
    /// Phong exponent.
    pub shininess: f32,
    /// Mirror share.
    pub reflectivity: f32,
    /// Surface colour.
    pub albedo: Option<BoundColor<'a>>,
    /// Holes.
    pub opacity: Option<BoundOpacity<'a>>,
    /// What the maps do to the surface.
    pub mapping: MaterialMapping<'a>,
    /// The relief that is geometry of its own.
    pub relief: Option<ReliefField<'a>>,
    /// The slot that this is made of, and whether its heights are turned over.
    relief_slot: Option<(&'a Heights, Wrap, bool)>,
    /// How maps are read.
    pub filter: TextureFilter,
}

impl<'a> FrameMaterial<'a> {
    /// Resolves one material. Where shadow rays are traced it gets what spares some of them.
    #[must_use]
    pub fn new(
        material: &Material,
        scene: &'a Scene,
        (mapping, shading): (&MappingSettings, &ShadingSettings),
        has_shadows: bool,
    ) -> Self {
        let filter = shading.filter;
        let is_glossy = material.ks.max_channel() > 0.0;
        let widens_highlights =
            is_glossy && filter == TextureFilter::Mip && shading.specular_antialiasing;
        let internal_amplitude = scene
            .normalization
            .internal_length(amplitude(material, mapping));
        let midlevel = material.midlevel.unwrap_or(mapping.midlevel);
        let slot = |role| {
            material
                .map(role)
                .filter(|slot| slot.image < scene.images.len())
        };
        let moving = slot(MapRole::Height).filter(|_| internal_amplitude != 0.0);
        let heights = |s: &MapSlot| scene.images[s.image].heights_of(s);
        let is_turned_over = |s: &MapSlot| internal_amplitude * s.gain_and_bias().0 < 0.0;
        let horizons = |s: &MapSlot| heights(s).horizons(s.wrap, is_turned_over(s));
        // Only what the method can use is bound, so that a typed map nobody reads is never made.
        let reads = mapping.method.reads(mapping.lookup);
        let maps = MaterialMaps {
            height: slot(MapRole::Height).filter(|_| reads.height).map(|s| {
                let mut height = bind_height(s, scene, (internal_amplitude, midlevel), filter);
                height.moments = widens_highlights.then(|| Mips {
                    halved: scene.images[s.image].heights_of(s).moments(s.wrap),
                    rate: height.addressing.texels_per_uv(height.map.size()),
                });
                height
            }),
            normal: slot(MapRole::Normal)
                .filter(|_| reads.normal)
                .map(|s| bind_normal(s, scene, amplitude(material, mapping), filter)),
            slope: slot(MapRole::Slope).filter(|_| reads.slope).map(|s| {
                let mut slope = bind_normal(s, scene, amplitude(material, mapping), filter);
                slope.moments = widens_highlights.then(|| Mips {
                    halved: scene.images[s.image].slope_moments(),
                    rate: slope.addressing.texels_per_uv(slope.map.size()),
                });
                slope
            }),
            pyramid: moving
                .filter(|_| mapping.needs_pyramid())
                .map(|s| heights(s).pyramid(s.wrap)),
            horizons: moving
                .filter(|_| mapping.shadows_itself() && has_shadows)
                .and_then(horizons),
            cones: moving
                .filter(|_| mapping.needs_cones())
                .map(|s| heights(s).cones(s.wrap, is_turned_over(s))),
        };
        let relief = displaced(mapping, &maps);
        Self {
            kd: material.kd,
            ks: material.ks,
            is_glossy,
            widens_highlights,
            shininess: material.shininess.max(0.0),
            reflectivity: material.reflectivity.clamp(0.0, 1.0),
            albedo: slot(MapRole::Albedo).map(|s| bind_color(s, scene, filter)),
            opacity: slot(MapRole::Opacity).map(|s| bind_opacity(s, scene)),
            mapping: MaterialMapping::choose(mapping, &maps),
            relief,
            relief_slot: relief
                .and(slot(MapRole::Height))
                .map(|s| (heights(s), s.wrap, is_turned_over(s))),
            filter,
        }
    }

    /// Gives a point the frame of its baked normal map, if the material has one.
    pub fn place_baked_frame(
        &self,
        (mesh, tangents): (&TriangleMesh, &TangentCell),
        hit: &Hit,
        s: &mut SurfaceInteraction,
    ) {
        if self.mapping.needs_baked_frame() && mesh.attributes[hit.prim as usize].has_uv {
            let smooth = mesh.attributes[hit.prim as usize].smooth;
            let frame = BakedFrame::fetch((mesh, tangents.get(mesh)), hit.prim, smooth);
            frame.place((hit.u, hit.v), s);
        }
    }

    /// The relief that is geometry of its own, with horizons for rays that leave it. Makes them, if nobody has yet.
    #[must_use]
    pub fn relief_with_horizons(&self) -> Option<ReliefField<'a>> {
        let (heights, wrap, turned_over) = self.relief_slot?;
        let horizons = heights.horizons(wrap, turned_over);
        self.relief.map(|relief| relief.with_horizons(horizons))
    }

    /// The relief, whether it is searched for places that shadow each other or is geometry of its own.
    #[must_use]
    pub fn field(&self) -> Option<&ReliefField<'a>> {
        self.relief.as_ref().or_else(|| self.mapping.self_shadow())
    }

    /// What of a surface this material looks at, given that its triangle has texture coordinates or not.
    #[must_use]
    pub const fn parts(&self, has_uv: bool) -> SurfaceParts {
        // How much of a map a cone covers is told by the gradients.
        let has_cone = matches!(self.filter, TextureFilter::Mip);
        match (has_uv, self.mapping.is_active(), self.albedo.is_some()) {
            (true, true, _) => SurfaceParts::Gradients,
            (true, false, true) if has_cone => SurfaceParts::Gradients,
            (true, false, true) => SurfaceParts::Uv,
            _ => SurfaceParts::Plain,
        }
    }
}

/// The relief that is geometry of its own, if the method wants one.
fn displaced<'a>(mapping: &MappingSettings, maps: &MaterialMaps<'a>) -> Option<ReliefField<'a>> {
    if !mapping.displaces() {
        return None;
    }
    ReliefField::new(maps.height.filter(BoundHeight::moves)?, maps.pyramid?)
}

/// The amplitude in force, world units: the material's own, else the scene's, else the material's
/// default.
#[must_use]
pub fn amplitude(material: &Material, mapping: &MappingSettings) -> f64 {
    material
        .amplitude
        .or(mapping.amplitude)
        .unwrap_or(material.default_amplitude)
        .max(0.0)
}

/// A height map tied to its slot, with this amplitude (internal units) and the stored height that lies on the mesh.
#[must_use]
pub fn bind_height<'a>(
    slot: &MapSlot,
    scene: &'a Scene,
    (amplitude, midlevel): (f32, f32),
    filter: TextureFilter,
) -> BoundHeight<'a> {
    // Displacement A·(h − midlevel).
    let (gain, bias) = slot.gain_and_bias();
    let heights = scene.images[slot.image].heights_of(slot);
    let addressing = Addressing::from_slot(slot);
    BoundHeight {
        map: heights.map(),
        addressing,
        scale: amplitude * gain,
        offset: amplitude * (bias - midlevel),
        stored: heights.extremes(),
        moments: None,
        mips: (filter == TextureFilter::Mip).then(|| Mips {
            halved: heights.halvings(),
            rate: addressing.texels_per_uv(heights.map().size()),
        }),
    }
}

fn bind_normal<'a>(
    slot: &MapSlot,
    scene: &'a Scene,
    amplitude: f64,
    filter: TextureFilter,
) -> BoundNormal<'a> {
    let addressing = Addressing::from_slot(slot);
    let strength = match slot.baked_amplitude {
        Some(baked) if baked > 0.0 => (amplitude / baked) as f32,
        // Nothing is known about the map's own amplitude: it is taken as it is, and vanishes with the relief.
        _ => f32::from(u8::from(amplitude > 0.0)),
    };
    let green = if slot.flip_green { -1.0 } else { 1.0 };
    // A picture laid upside down or mirrored on the chart turns its slopes round with it.
    let space = match slot.role {
        MapRole::Normal => slot.space,
        _ => NormalSpace::Tangent,
    };
    let signs = match space {
        NormalSpace::Object => Vec2::new(1.0, green),
        NormalSpace::Tangent | NormalSpace::MikkTSpace => Vec2::new(
            1.0_f32.copysign(addressing.scale.x),
            -green * 1.0_f32.copysign(addressing.scale.y),
        ),
    };
    let image = &scene.images[slot.image];
    BoundNormal {
        map: image.normal(),
        addressing,
        strength,
        signs,
        space,
        axes: slot.axes,
        moments: None,
        mips: (filter == TextureFilter::Mip).then(|| Mips {
            halved: image.normal_halvings(slot.role),
            rate: addressing.texels_per_uv(image.normal().size()),
        }),
    }
}

fn bind_color<'a>(slot: &MapSlot, scene: &'a Scene, filter: TextureFilter) -> BoundColor<'a> {
    let image = &scene.images[slot.image];
    let addressing = Addressing::from_slot(slot);
    BoundColor {
        map: image.color(),
        addressing,
        gain: slot.gain,
        bias: slot.bias,
        mips: (filter == TextureFilter::Mip).then(|| Mips {
            halved: image.color_halvings(),
            rate: addressing.texels_per_uv(image.color().size()),
        }),
    }
}

fn bind_opacity<'a>(slot: &MapSlot, scene: &'a Scene) -> BoundOpacity<'a> {
    let (scale, offset) = slot.gain_and_bias();
    BoundOpacity {
        map: scene.images[slot.image].height(slot.channel),
        addressing: Addressing::from_slot(slot),
        scale,
        offset,
    }
}
