//! The built-in scenes are sound, and their closed shapes closed.

use crate::common::check;
use glam::DVec3;
use jerboa_scenes::builtin::Source;
use jerboa_scenes::{Mesh, Scene, builtin};
use std::collections::{HashMap, HashSet};

#[test]
fn the_gallery_says_what_is_hard_and_what_is_right() {
    let mut count = 0;
    for (builtin, hard) in builtin::gallery() {
        count += 1;
        let (name, reference) = (builtin.name, hard.reference);
        assert!(!hard.naive.is_empty() && hard.naive.len() <= 100, "{name}: {}", hard.naive);
        match reference.source {
            Source::ClosedForm => assert_eq!(reference.standard_error, 0.0, "{name}"),
            Source::Rendered { spp } => {
                assert!(spp >= 64 && reference.standard_error > 0.0, "{name}");
                assert!(reference.standard_error < 4e-3 * reference.mean, "{name}: it says too little");
            }
        }
    }
    assert!(count > 30, "{count}");
}

#[test]
fn every_builtin_is_valid() {
    for builtin in builtin::list() {
        let scene = Scene::load(format!("builtin:{}", builtin.name)).unwrap();
        check(&scene);
        assert_eq!(scene.name, builtin.name);
        assert_eq!(scene.cameras.len(), 1, "{}", builtin.name);
        assert!(scene.warnings.is_empty());
        assert!(!builtin.purpose.is_empty() && builtin.purpose.len() <= 80, "{}", builtin.purpose);
        if builtin.name != "empty" {
            let lacks = scene.all_warnings();
            assert!(lacks.is_empty(), "{}: {lacks:?}", builtin.name);
        }
    }
    let names: HashSet<_> = builtin::list().iter().map(|b| b.name).collect();
    assert_eq!(names.len(), builtin::list().len());
    assert_eq!(builtin::list()[0].name, "cornell-box");
}

/// Every edge is used once in each direction: no hole, one winding.
fn is_closed(mesh: &Mesh) -> bool {
    let mut edges = HashMap::new();
    for t in &mesh.triangles {
        for (a, b) in [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])] {
            *edges.entry((a, b)).or_insert(0) += 1;
        }
    }
    edges.iter().all(|(&(a, b), &n)| n == 1 && edges.get(&(b, a)) == Some(&1))
}

/// Positive where the fronts are outside (divergence theorem).
fn volume(mesh: &Mesh) -> f64 {
    let p = |i: u32| mesh.positions[i as usize].as_dvec3();
    mesh.triangles.iter().map(|t| p(t[0]).dot(p(t[1]).cross(p(t[2]))) / 6.0).sum()
}

#[test]
fn closed_shapes_are_closed_and_face_the_right_way() {
    let room = |name: &str| Scene::load(format!("builtin:{name}")).unwrap().meshes[0].clone();
    for name in ["furnace-sphere", "black-sphere"] {
        let sphere = room(name);
        assert!(is_closed(&sphere), "{name}");
        // An inscribed polyhedron: smaller than the ball, by under 20 % even at 80 triangles.
        let ball = 4.0 / 3.0 * std::f64::consts::PI;
        assert!(volume(&sphere) < -0.8 * ball && volume(&sphere) > -ball, "{name}: {}", volume(&sphere));
    }
    for name in ["closed-box-50", "closed-box-99", "white-box", "black-box"] {
        assert!(is_closed(&room(name)), "{name}");
        assert_eq!(volume(&room(name)), -8.0, "{name}");
    }
    let trap = room("glass-trap");
    assert!(is_closed(&trap));
    assert_eq!(volume(&trap), 8.0);
}

#[test]
fn normals_point_to_the_front() {
    let scene = Scene::load("builtin:material-balls").unwrap();
    for mesh in scene.meshes.iter().filter(|m| m.normals.is_some()) {
        assert_eq!(mesh.triangles.len(), 20 * 4usize.pow(5));
        let normals = mesh.normals.as_ref().unwrap();
        for t in &mesh.triangles {
            let [a, b, c] = t.map(|i| mesh.positions[i as usize]);
            let face = (b - a).cross(c - a).normalize();
            assert!(t.iter().all(|&i| normals[i as usize].dot(face) > 0.99));
        }
    }
}

#[test]
fn the_cornell_box_faces_its_inside() {
    let scene = Scene::load("builtin:cornell-box").unwrap();
    let centre = DVec3::new(0.0, 1.0, 0.0);
    for mesh in &scene.meshes[..6] {
        let [a, b, c] = mesh.triangles[0].map(|i| mesh.positions[i as usize].as_dvec3());
        assert!((b - a).cross(c - a).dot(centre - a) > 0.0, "{}", mesh.name);
    }
    for block in &scene.meshes[6..] {
        assert!(is_closed(block) && volume(block) > 0.0);
    }
    let camera = scene.camera_or_default();
    assert_eq!(camera.forward(), DVec3::NEG_Z);
    assert_eq!(camera.film_or_default(), (512, 512));
}

#[test]
fn far_away_is_the_cornell_box_moved() {
    let (near, far) = (Scene::load("builtin:cornell-box").unwrap(), Scene::load("builtin:far-away").unwrap());
    let offset = DVec3::splat(1e6);
    assert_eq!(near.meshes, far.meshes);
    for (a, b) in near.instances.iter().zip(&far.instances) {
        assert_eq!(a.to_world.translation + offset, b.to_world.translation);
    }
    assert_eq!(near.cameras[0].position() + offset, far.cameras[0].position());
}

#[test]
fn lights_shine_where_their_scenes_say() {
    let light = |name: &str| Scene::load(format!("builtin:{name}")).unwrap().lights[0].direction();
    assert!((light("spot") - DVec3::NEG_Y).length() < 1e-12);
    assert!((light("sun").y + 60f64.to_radians().sin()).abs() < 1e-12);
}

#[test]
fn the_sun_of_the_sky_is_where_the_mapping_puts_it() {
    let sky = Scene::load("builtin:environment").unwrap().environment.unwrap();
    let texel = |d: DVec3| {
        let u = 0.5 + d.x.atan2(-d.z) / std::f64::consts::TAU;
        let v = d.y.acos() / std::f64::consts::PI;
        let (x, y) = (u * f64::from(sky.width), v * f64::from(sky.height));
        sky.radiance[y as usize * sky.width as usize + x as usize][0]
    };
    let sun = DVec3::new(0.5, 0.7, 0.4).normalize();
    assert!(texel(sun) > 1000.0);
    assert!(texel(DVec3::new(-sun.x, sun.y, sun.z)) < 1.0 && texel(DVec3::new(sun.x, sun.y, -sun.z)) < 1.0);
}
