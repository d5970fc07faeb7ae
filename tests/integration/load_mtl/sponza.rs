//! A real model's library, where the environment says where models are.

use std::path::PathBuf;

use reliefscope::scene::load::{LibraryRef, LoadOptions, MaterialSet, load_materials};
use reliefscope::texture::MapRole;

const NAMES: [&str; 26] = [
    "leaf",
    "vase_round",
    "Material__57",
    "Material__298",
    "16___Default",
    "bricks",
    "arch",
    "ceiling",
    "column_a",
    "floor",
    "column_c",
    "details",
    "column_b",
    "Material__47",
    "flagpole",
    "fabric_e",
    "fabric_d",
    "fabric_a",
    "fabric_g",
    "fabric_c",
    "fabric_f",
    "chain",
    "vase_hanging",
    "vase",
    "Material__25",
    "roof",
];

fn load(library: &str) -> Option<MaterialSet> {
    let models = PathBuf::from(std::env::var_os("RELIEFSCOPE_MODELS")?);
    let library = LibraryRef {
        name: library.as_bytes().to_vec(),
        model: models.join("sponza/sponza.obj"),
        line: 1,
    };
    let used: Vec<_> = NAMES.iter().map(|n| (n.as_bytes().to_vec(), 1)).collect();
    Some(load_materials(&[library], &used, &LoadOptions::default()).expect("not cancelled"))
}

#[test]
fn every_map_is_found_and_recognised() {
    let Some(set) = load("sponza.mtl") else {
        return;
    };
    assert_eq!(set.materials.len(), 26);
    let lost: Vec<_> = set
        .warnings
        .iter()
        .filter(|w| !w.message.contains("green grows downwards"))
        .collect();
    assert!(lost.is_empty(), "{lost:#?}");
    let (mut pairs, mut normals) = (0, 0);
    for material in &set.materials {
        let (height, normal) = (material.map(MapRole::Height), material.map(MapRole::Normal));
        for slot in &material.maps {
            let name = &set.images[slot.image].name;
            let role = match () {
                () if name.contains("_ddn") => MapRole::Normal,
                () if name.contains("_bump") => MapRole::Height,
                () if name.contains("_mask") => MapRole::Opacity,
                () => MapRole::Albedo,
            };
            assert_eq!(slot.role, role, "{name}");
        }
        normals += usize::from(normal.is_some());
        if let (Some(height), Some(normal)) = (height, normal) {
            pairs += 1;
            assert!(normal.flip_green, "{}: {}", material.name, normal.note);
            assert!(height.enabled && material.default_amplitude == 1.0);
        }
    }
    assert!(
        pairs >= 10 && normals >= 20,
        "{pairs} pairs, {normals} normal maps"
    );
}
