//! What holds for every filter: any mesh, at any settings, gives a mesh that is well formed or an
//! error that is no bug, and a cancel is heard.

use mve_core::testing::Trial;
use mve_core::{CancelToken, Module, ModuleError};
use mve_modules::data::{Domain, Layer, LayerValues, NO_VALUE, TriMesh};
use mve_modules::geometry::generate::{VaseOptions, vase};
use mve_modules::mesh::fixtures::mesh_of;
use mve_modules::registry;
use proptest::prelude::*;

use crate::contracts::{ends, trial};

fn filters() -> Vec<&'static Module> {
    let registry = registry();
    let filters = registry.modules().iter().filter(|info| info.category == "filters");
    filters.map(|info| info.module).collect()
}

/// Few vertices, so that faces are doubled, turned, degenerate and not manifold; coordinates that
/// are not finite; layers with missing values.
fn any_mesh() -> impl Strategy<Value = TriMesh> {
    let number = prop_oneof![
        8 => (-2..3_i32).prop_map(f64::from),
        3 => -1.0..1.0_f64,
        1 => prop_oneof![Just(f64::NAN), Just(f64::INFINITY), Just(1e200), Just(1e-200)],
    ];
    let positions = prop::collection::vec(prop::array::uniform3(number), 1..9);
    let mesh = positions.prop_flat_map(|positions| {
        let corner = 0..positions.len() as u32;
        let faces = prop::collection::vec(prop::array::uniform3(corner), 0..16);
        (Just(positions), faces)
    });
    mesh.prop_map(|(positions, faces)| {
        let mut mesh = mesh_of(&positions, &faces);
        for (name, domain) in
            [(Layer::NORMAL, Domain::Corner), (Layer::COLOR, Domain::Vertex), ("f", Domain::Face)]
        {
            let values = LayerValues::Vec3(vec![glam::DVec3::X, glam::DVec3::Y]);
            let value = |i: usize| [0, NO_VALUE, 1, 1, 0][i % 5];
            let index = (0..mesh.n_elements(domain)).map(value).collect();
            mesh.set_layer(Layer { name: name.to_owned(), domain, values, index });
        }
        mesh
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    #[test]
    fn any_mesh_through_any_filter_is_well_formed(mesh in any_mesh(), choice in any::<usize>()) {
        let folder = tempfile::tempdir().expect("a temporary folder");
        for module in filters() {
            let mut trial = trial(module, &mesh, folder.path());
            for (place, spec) in module.params.iter().enumerate() {
                // Each at its default, or at one of the ends of what it allows.
                let ends = ends(spec, folder.path());
                let pick = choice.rotate_right(5 * place as u32) % (ends.len() + 2);
                if let Some(value) = ends.get(pick) {
                    trial = trial.set(spec.name, value.clone());
                }
            }
            match trial.run() {
                Err(ModuleError::Bug(bug)) => prop_assert!(false, "{}: {bug}", module.id),
                Err(_) => {}
                Ok(outputs) => {
                    for (name, value) in outputs {
                        let fault = value.get::<TriMesh>().map_or(Ok(()), |mesh| mesh.check());
                        prop_assert_eq!(fault, Ok(()), "{}.{}", module.id, name);
                    }
                }
            }
        }
    }
}

#[test]
fn every_filter_hears_a_cancel() {
    let mesh = vase(&VaseOptions::DEFAULT);
    let folder = tempfile::tempdir().expect("a temporary folder");
    let cancel = CancelToken::new();
    cancel.cancel();
    for module in filters() {
        let trial: Trial = trial(module, &mesh, folder.path());
        let ended = trial.run_until(&cancel);
        assert!(matches!(ended, Err(ModuleError::Cancelled)), "{}", module.id);
    }
}
