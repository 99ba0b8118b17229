//! Tests of the camera: what it sees, and what moves it.

use super::*;

const BOX: Bounds = Bounds { low: DVec3::new(-1.0, 2.0, 10.0), high: DVec3::new(3.0, 2.5, 11.0) };

fn cameras() -> impl Iterator<Item = Camera> {
    let projections = [Projection::Perspective, Projection::Orthographic];
    let ups = [UpAxis::Y, UpAxis::Z];
    let angles = [(0.0, 0.0), (1.0, 0.5), (4.0, -1.5), (2.0, FRAC_PI_2)];
    projections.into_iter().flat_map(move |projection| {
        ups.into_iter().flat_map(move |up| {
            angles.into_iter().map(move |(yaw_rad, pitch_rad)| Camera {
                yaw_rad,
                pitch_rad,
                projection,
                up,
                ..Camera::default()
            })
        })
    })
}

#[test]
fn fit_shows_the_whole_box_and_fills_the_picture() {
    for mut camera in cameras() {
        for aspect in [0.3, 1.0, 2.5] {
            camera.fit(&BOX, aspect);
            let places = BOX.corners().map(|c| camera.project(c, aspect).unwrap());
            let largest = places.iter().map(|p| p.abs().max_element()).fold(0.0, f64::max);
            assert!(largest <= 1.0 && largest > 0.85, "{largest} {camera:?}");
            let clip = camera.clip_from_view(aspect, &BOX);
            for (corner, place) in BOX.corners().into_iter().zip(places) {
                let seen = clip * camera.view_of(corner).extend(1.0);
                let seen = seen / seen.w;
                assert!((0.0..=1.0).contains(&seen.z), "depth {} {camera:?}", seen.z);
                assert!(DVec2::new(seen.x, seen.y).distance(place) < 1e-9);
            }
        }
    }
}

#[test]
fn orbit_keeps_the_distance_and_the_target_in_the_middle() {
    let mut camera = Camera::default();
    camera.fit(&BOX, 1.5);
    let distance = camera.eye().distance(camera.target);
    for step in 0..50 {
        camera.orbit(DVec2::new(0.03, 0.01 * f64::from(step % 7 - 3)));
        assert!((camera.eye().distance(camera.target) - distance).abs() < 1e-9 * distance);
        assert!(camera.project(camera.target, 1.5).unwrap().length() < 1e-12);
        let axes = camera.axes();
        assert!((axes.right.cross(axes.up) - axes.back).length() < 1e-12);
    }
}

#[test]
fn zoom_keeps_the_point_under_the_pointer() {
    for mut camera in cameras() {
        camera.fit(&BOX, 1.5);
        let at = DVec2::new(0.6, -0.4);
        let (axes, half) = (camera.axes(), camera.half_size(1.5));
        let point = camera.target + axes.right * (at.x * half.x) + axes.up * (at.y * half.y);
        camera.zoom(1.7, at, 1.5, BOX.radius());
        assert!(camera.project(point, 1.5).unwrap().distance(at) < 1e-9, "{camera:?}");
        camera.zoom(f64::NAN, at, 1.5, BOX.radius());
        camera.zoom(1e-300, at, 1.5, BOX.radius());
        assert!(camera.distance <= 1e6 * BOX.radius() && camera.target.is_finite());
    }
}

#[test]
fn pan_moves_what_is_seen_with_the_pointer() {
    for mut camera in cameras() {
        camera.fit(&BOX, 1.5);
        let before = camera.target;
        camera.pan(DVec2::new(0.2, -0.1), 1.5);
        let place = camera.project(before, 1.5).unwrap();
        assert!(place.distance(DVec2::new(0.2, -0.1)) < 1e-9);
    }
}

#[test]
fn opposite_views_look_the_other_way_and_a_direction_is_looked_against() {
    for mut camera in cameras() {
        let mut back = |view| {
            camera.look_from(view);
            camera.axes().back
        };
        for (view, opposite) in [
            (StandardView::Front, StandardView::Back),
            (StandardView::Side, StandardView::Left),
            (StandardView::Top, StandardView::Bottom),
        ] {
            assert!((back(view) + back(opposite)).length() < 1e-12);
        }
        for towards in [DVec3::new(2.0, -3.0, 6.0), DVec3::Z, DVec3::NEG_X, DVec3::NEG_Y] {
            camera.look_at(DVec3::ONE, towards);
            assert!((camera.axes().back - towards.normalize()).length() < 1e-9, "{camera:?}");
            assert_eq!(camera.target, DVec3::ONE);
        }
        let before = camera;
        camera.look_at(DVec3::ONE, DVec3::ZERO);
        assert_eq!(camera, before);
    }
}

#[test]
fn rays_go_through_what_is_projected() {
    for mut camera in cameras() {
        camera.fit(&BOX, 1.5);
        for corner in BOX.corners() {
            let ray = camera.ray(camera.project(corner, 1.5).unwrap(), 1.5, &BOX);
            let along = (corner - ray.origin).dot(ray.direction);
            assert!(along > 0.0);
            assert!((ray.origin + ray.direction * along).distance(corner) < 1e-9);
        }
    }
}

#[test]
fn boxes_without_size_and_panels_without_size_give_finite_cameras() {
    let point = Bounds { low: DVec3::splat(7.0), high: DVec3::splat(7.0) };
    let huge = Bounds { low: DVec3::splat(-1e300), high: DVec3::splat(1e300) };
    for bounds in [point, huge] {
        for aspect in [0.0, f64::NAN, f64::INFINITY, 1e-9] {
            let mut camera = Camera::default();
            camera.fit(&bounds, aspect);
            assert!(camera.distance > 0.0 && camera.distance.is_finite());
            assert!(camera.clip_from_view(aspect, &bounds).is_finite());
        }
    }
    assert_eq!(Bounds::around([DVec3::NAN]), None);
    let around = Bounds::around([DVec3::NAN, DVec3::ONE, DVec3::splat(f64::INFINITY)]);
    assert_eq!(around, Some(Bounds { low: DVec3::ONE, high: DVec3::ONE }));
}

#[test]
fn what_stands_on_the_xy_plane_points_up_along_z() {
    let at = |low: [f64; 3], high: [f64; 3]| {
        Bounds { low: DVec3::from(low), high: DVec3::from(high) }.up()
    };
    let of = |size: [f64; 3]| at([0.0; 3], size);
    assert_eq!(of([0.6, 0.6, 1.0]), UpAxis::Z); // a vase
    assert_eq!(at([-0.3, -0.299, 0.0], [0.302, 0.296, 1.0]), UpAxis::Z); // a simplified one
    assert_eq!(of([1.0, 1.0, 0.18]), UpAxis::Z); // a height field
    assert_eq!(of([1.0, 1.0, 1.0]), UpAxis::Y); // a cube
    assert_eq!(of([1.0, 1.0, 0.0]), UpAxis::Y); // a picture
    assert_eq!(of([0.6, 1.0, 0.6]), UpAxis::Y); // a vase that stands on xz
    // The Stanford bunny.
    let low = [-0.09469, 0.03299, -0.06187];
    assert_eq!(at(low, [0.06101, 0.18732, 0.05880]), UpAxis::Y);
}

#[test]
fn a_camera_is_carried_from_one_box_to_another_and_back() {
    let from = Bounds { low: DVec3::ZERO, high: DVec3::splat(2.0) };
    let to = Bounds { low: DVec3::splat(1e6), high: DVec3::splat(1e6 + 200.0) };
    let camera = Camera { target: DVec3::new(1.0, 2.0, 1.0), ..Camera::default() };
    let carried = camera.carried(&from, &to);
    let corner = |bounds: &Bounds, camera: &Camera| camera.project(bounds.high, 1.5).unwrap();
    assert!(corner(&from, &camera).distance(corner(&to, &carried)) < 1e-9);
    let back = carried.carried(&to, &from);
    assert!(back.target.distance(camera.target) < 1e-9 && back.distance == camera.distance);
}
