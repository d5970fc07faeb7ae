//! From material libraries to materials and pictures.

use std::path::{Path, PathBuf};

use super::super::LoadWarning;
use super::LoadOptions;
use super::library::{Definition, Definitions, Match};
use super::lookup::{describe_folders, find_file, text_from_bytes};
use super::map_statement::{MapKind, MapStatement};
use super::mtl::MtlMaterial;
use super::picture::PictureStore;
use super::slots::{PlacedMap, SlotSet, slots_of};
use crate::math::{LinearRgb, linear_from_srgb};
use crate::scene::LoadError;
use crate::shading::Material;
use crate::texture::MapImage;

/// A library as a model names it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LibraryRef {
    /// The name as written, without quotes trimmed or slashes changed. Not UTF-8 in old files.
    pub name: Vec<u8>,
    /// The model's file.
    pub model: PathBuf,
    /// Line of the statement in the model.
    pub line: usize,
}

/// Materials in the order of the names asked for, the pictures they use, and notes.
#[derive(Debug, Default)]
pub struct MaterialSet {
    /// One per name asked for.
    pub materials: Vec<Material>,
    /// Pictures that the materials' slots index.
    pub images: Vec<MapImage>,
    /// Doubtful input.
    pub warnings: Vec<LoadWarning>,
}

/// Name of the material of faces without one.
const DEFAULT_NAME: &str = "default";
/// Diffuse colour (linear) where nothing says otherwise.
const DEFAULT_KD: LinearRgb = LinearRgb::gray(0.8);
/// Largest Phong exponent: beyond it a highlight is narrower than single precision can tell.
const MAX_SHININESS: f32 = 1e7;
/// Colours beyond this are something else than colours; light times them must stay finite.
const MAX_COLOR: f32 = 1e6;

/// A colour's number as far as one is believed.
fn within(channel: f32) -> f32 {
    channel.clamp(-MAX_COLOR, MAX_COLOR)
}

/// Reads the libraries and finds a material for every used name (bytes as written in `usemtl`, with the
/// line of its first use; line 0 for faces before any `usemtl`, which get the default without a warning).
///
/// A name that is defined twice keeps its first definition, in one library as among several: the format
/// searches libraries in the order in which they are named. Names that differ only in letter case or by a
/// comment are taken where there is no exact one. An unknown name gets the default: matte, linear 0.8 grey.
/// Pictures of materials that are not used are not opened. Warnings about names are about the model's
/// file; it is empty if there is no library that could tell it.
///
/// Colours: `Kd` is decoded from sRGB and multiplies `map_Kd`; a material with `map_Kd` and no or black
/// `Kd` is white. `Ks` is linear; `illum` 0 and 1 switch it off, and 3 to 9 (the ray-traced ones) make its
/// largest channel, up to 1, the reflectivity. `Ns` is limited to 0…10⁷. Surfaces are opaque except for
/// holes by `map_d`.
///
/// # Errors
/// Only [`LoadError::Cancelled`]; anything else becomes a warning and a default material.
pub fn load_materials(
    libraries: &[LibraryRef],
    used: &[(Vec<u8>, usize)],
    options: &LoadOptions,
) -> Result<MaterialSet, LoadError> {
    let mut warnings = Vec::new();
    let definitions = Definitions::read(libraries, &mut warnings);
    let mut loader = Loader {
        definitions,
        model: libraries
            .first()
            .map_or_else(PathBuf::new, |l| l.model.clone()),
        options,
        store: PictureStore::default(),
        warnings,
    };
    let mut materials = Vec::with_capacity(used.len());
    for (name, line) in used {
        materials.push(loader.material(name, *line)?);
    }
    Ok(MaterialSet {
        materials,
        images: loader.store.images,
        warnings: loader.warnings,
    })
}

struct Loader<'a> {
    definitions: Definitions,
    model: PathBuf,
    options: &'a LoadOptions,
    store: PictureStore,
    warnings: Vec<LoadWarning>,
}

impl Loader<'_> {
    fn material(&mut self, name: &[u8], line: usize) -> Result<Material, LoadError> {
        let name = name.trim_ascii();
        // Taken out and put back: reading pictures needs the rest of the loader.
        let definitions = std::mem::take(&mut self.definitions);
        let material = match definitions.find(name) {
            Some((definition, how)) => {
                if how == Match::OtherCase {
                    let found = text_from_bytes(&definition.material.name);
                    let message = format!(
                        "material \"{}\" found as \"{found}\"",
                        text_from_bytes(name)
                    );
                    self.warn_model(line, message);
                }
                self.defined(name, definition)
            }
            None => Ok(self.default_material(name, line)),
        };
        self.definitions = definitions;
        material
    }

    fn default_material(&mut self, name: &[u8], line: usize) -> Material {
        let shown = text_from_bytes(name);
        match (name.is_empty(), line) {
            (true, 0) => {}
            (true, _) => self.warn_model(line, "usemtl names no material: default grey".to_owned()),
            (false, _) => {
                let message = format!("material \"{shown}\" is not defined: default grey");
                self.warn_model(line, message);
            }
        }
        let shown = if shown.is_empty() {
            DEFAULT_NAME.to_owned()
        } else {
            shown
        };
        Material::matte(shown, DEFAULT_KD)
    }

    fn defined(&mut self, name: &[u8], definition: &Definition) -> Result<Material, LoadError> {
        let MtlMaterial { maps, .. } = &definition.material;
        let mut placed = Vec::with_capacity(maps.len());
        for statement in maps {
            // Looking and decoding take the time here; where the load stands is the caller's to say.
            self.options.monitor.check()?;
            if let Some(image) = self.picture(statement, &definition.library) {
                placed.push(PlacedMap { statement, image });
            }
        }
        let SlotSet {
            slots,
            amplitude,
            remarks,
        } = slots_of(&placed, &self.store.images);
        for (line, message) in remarks {
            self.warn(&definition.library, line, message);
        }
        let mut material = self.shading(&definition.material, &definition.library);
        material.name = text_from_bytes(name);
        material.maps = slots;
        // Zero means "not given" to whoever fills in defaults, so a given zero is the material's own.
        match amplitude {
            Some(0.0) => material.amplitude = Some(0.0),
            Some(given) => material.default_amplitude = given,
            None => {}
        }
        Ok(material)
    }

    /// Numbers of a material; see [`load_materials`] for the rules.
    fn shading(&mut self, mtl: &MtlMaterial, library: &Path) -> Material {
        let has_albedo = mtl.maps.iter().any(|m| m.kind == MapKind::Albedo);
        let kd = match mtl.kd {
            Some([0.0, 0.0, 0.0]) if has_albedo => {
                let message = "Kd 0 would blacken map_Kd; white instead".to_owned();
                self.warn(library, mtl.line, message);
                LinearRgb::WHITE
            }
            Some(kd) => LinearRgb::from(kd).map(within).map(linear_from_srgb),
            None if has_albedo => LinearRgb::WHITE,
            None => DEFAULT_KD,
        };
        let mut material = Material::matte("", kd);
        let ks = mtl
            .ks
            .map_or(LinearRgb::BLACK, |ks| LinearRgb::from(ks).map(within));
        match mtl.illum {
            Some(0 | 1) => {}
            None | Some(2 | 10) => material.ks = ks,
            Some(3..=9) => {
                material.ks = ks;
                material.reflectivity = ks.max_channel().min(1.0);
            }
            Some(unknown) => {
                let message = format!("illum {unknown} is unknown; 2 instead");
                self.warn(library, mtl.line, message);
                material.ks = ks;
            }
        }
        if let Some(ns) = mtl.ns {
            material.shininess = ns.clamp(0.0, MAX_SHININESS);
        }
        material
    }

    /// Finds and decodes one picture; on failure warns and returns `None`.
    fn picture(&mut self, statement: &MapStatement, library: &Path) -> Option<usize> {
        let MapStatement {
            line,
            keyword,
            file,
            ..
        } = statement;
        let shown = text_from_bytes(file);
        let beside_library = library.parent().unwrap_or(Path::new(""));
        let beside_model = self.model.parent().unwrap_or(Path::new(""));
        let mut folders = vec![beside_library];
        if beside_model != beside_library {
            folders.push(beside_model);
        }
        let Some(found) = find_file(file, &folders) else {
            let looked = describe_folders(&folders);
            let message = format!("{keyword}: \"{shown}\" not found; looked in {looked}");
            self.warn(library, *line, message);
            return None;
        };
        let path = found.path;
        if let Some(how) = found.fallback {
            let message = format!("{keyword}: \"{shown}\" found {how}: {}", path.display());
            self.warn(library, *line, message);
        }
        match self.store.load(&path) {
            Ok((image, remark)) => {
                if let Some(remark) = remark {
                    self.warn(library, *line, format!("{keyword}: {shown}: {remark}"));
                }
                Some(image)
            }
            Err(cause) => {
                let message = format!("{keyword}: \"{shown}\" not read: {cause}");
                self.warn(library, *line, message);
                None
            }
        }
    }

    fn warn(&mut self, file: &Path, line: usize, message: String) {
        self.warnings.push(LoadWarning {
            file: file.to_path_buf(),
            line: Some(line),
            message,
        });
    }

    fn warn_model(&mut self, line: usize, message: String) {
        let model = self.model.clone();
        self.warn(&model, line, message);
    }
}
