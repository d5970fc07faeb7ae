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
#[test]
fn zz_probe() {
    use reliefscope::scene::load::{fill_default_amplitudes};
    use reliefscope::geometry::*;
    let set = load("sponza.mtl").unwrap();
    for m in &set.materials { for s in &m.maps { if s.role==MapRole::Normal {println!("{} {:?} en={} flip={} {}", m.name, s.role, s.enabled, s.flip_green, s.note); }} }
    let mut text=String::new();
    for n in ["bricks","cobble","hammered","medallion","rivets","terrain","waves"] { for b in [8,16] { text+=&format!("newmtl {n}{b}\nbump /work/shared/models/maps/{n}_height{b}.png\nnorm /work/shared/models/maps/{n}_normal.png\n"); } }
    std::fs::write("/tmp/zz.mtl", text).unwrap();
    let mut mesh=TriangleMesh::default();
    let mut used=vec![];
    for n in ["bricks","cobble","hammered","medallion","rivets","terrain","waves"] { for b in [8,16] { used.push((format!("{n}{b}").into_bytes(),1)); } }
    for i in 0..used.len() { mesh.indices.push([0,1,2]); mesh.attributes.push(TriangleAttributes{material:i as u16,has_uv:true,smooth:false}); }
    mesh.positions=vec![glam::Vec3::ZERO,glam::Vec3::X,glam::Vec3::Y]; mesh.uvs=mesh.positions.iter().map(|p|p.truncate()).collect();
    let mut set=load_materials(&[LibraryRef{name:b"/tmp/zz.mtl".to_vec(),model:"/tmp/x.obj".into(),line:1}],&used,&LoadOptions::default()).unwrap();
    fill_default_amplitudes(&mut set.materials,&set.images,&mesh,&Normalization::IDENTITY);
    for m in &set.materials { println!("{} {}", m.name, m.map(MapRole::Normal).unwrap().note); }
    for w in &set.warnings { println!("{w}"); }
}
