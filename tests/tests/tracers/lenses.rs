//! T13 for cameras: what they show is what pinholes show, sorted anew.
//!
//! A fisheye sees what a pinhole sees, by other distances from the middle. A thin lens sees what pinholes at all of its points see,
//! each moved by as much as brings the plane in focus to one place. So the references are made by the camera that has no formula
//! but a projection. Light is direct only: paths behind the first hit know nothing of the camera.

use glam::DVec3;
use jerboa_lib_render::host::generate::TracerKind;
use jerboa_lib_render::host::image_io::Image;
use jerboa_lib_render::host::renderer::Renderer;
use jerboa_lib_render::host::tables::Choices;
use jerboa_scenes::{Camera, Lens};

use crate::agreement::{fault, grey, mean_and_variance, side};
use crate::{image, load, renderer};

/// Renders of a lens, and of the pinhole that a fisheye is compared with.
const RENDERS: u32 = 16;

/// A renderer of the cornell box by the kind of this camera.
fn of(camera: &Camera) -> Renderer {
    let mut scene = load("cornell-box");
    scene.cameras = vec![camera.clone()];
    renderer(&scene, TracerKind::Path, Choices { max_depth: Some(2), ..Choices::default() })
}

/// A camera in the opening of the box with this lens.
fn with(lens: Lens) -> Camera {
    Camera { lens, ..Camera::look_at("near", DVec3::new(0.1, 1.05, 2.4), DVec3::new(0.0, 1.0, 0.0), 1.0) }
}

/// Grey renders of one sample under seeds from this one on.
fn renders(renderer: &Renderer, camera: &Camera, side: u32, seeds: std::ops::Range<u32>) -> Vec<Image> {
    seeds.map(|seed| grey(image(renderer, camera, [side; 2], 1, seed))).collect()
}

/// A square image of a pinhole of half the height `half` at distance 1, as a fisheye of half the angle `angle` shows it: each pixel
/// goes where its middle goes, and counts by the area that it has there.
fn bent(seen: &Image, half: f64, angle: f64, side: u32) -> Image {
    let mut sums = vec![[0.0; 2]; (side * side) as usize];
    let middle = |i: u32| 2.0 * (f64::from(i) + 0.5) / f64::from(seen.width) - 1.0;
    for (x, y) in (0..seen.width).flat_map(|x| (0..seen.height).map(move |y| (x, y))) {
        let across = [middle(x) * half, middle(y) * half];
        let tan = across[0].hypot(across[1]);
        let theta = tan.atan();
        let place = across.map(|p| (p / tan * theta / angle + 1.0) / 2.0 * f64::from(side));
        if place.iter().all(|p| (0.0..f64::from(side)).contains(p)) {
            // A pixel takes cos³ θ of solid angle, and a solid angle θ / sin θ of the film.
            let area = theta.cos().powi(3) * theta / theta.sin();
            let value = f64::from(seen.pixels[(y * seen.width + x) as usize][0]);
            let sum = &mut sums[(place[1] as u32 * side + place[0] as u32) as usize];
            *sum = [sum[0] + area * value, sum[1] + area];
        }
    }
    Image::from_fn(side, side, |x, y| {
        let [value, area] = sums[(y * side + x) as usize];
        assert!(area > 0.0, "a pixel of the pinhole falls on each of the fisheye");
        [(value / area) as f32; 3]
    })
}

#[test]
fn a_fisheye_shows_what_a_pinhole_does() {
    let (angle, half) = (1.2_f64, 0.9_f64);
    let (fisheye, pinhole) = (with(Lens::Fisheye { angle }), with(Lens::Pinhole { yfov: 2.0 * half.atan() }));
    // Pixels of the pinhole are 0.62 of the fisheye's at most, so that one falls on each.
    let fine = side() * 12 / 5;
    let seen = renders(&of(&pinhole), &pinhole, fine, 1000..1000 + RENDERS);
    let expected: Vec<Image> = seen.iter().map(|image| bent(image, half, angle / 2.0, side())).collect();
    let found = renders(&of(&fisheye), &fisheye, side(), 1..1 + RENDERS);
    assert_eq!(fault("fisheye", &found, &mean_and_variance(&expected)), None);
}

/// Pixels by which a point at infinity is out of focus.
const BLUR: i32 = 4;

/// In pixels from the middle of the lens, its points: 49, whose mean square is 0.98 of that of the disk.
fn points() -> impl Iterator<Item = [i32; 2]> {
    let all = (-BLUR..=BLUR).flat_map(|x| (-BLUR..=BLUR).map(move |y| [x, y]));
    all.filter(|[x, y]| x * x + y * y <= BLUR * BLUR)
}

#[test]
fn a_thin_lens_shows_what_pinholes_on_it_do() {
    let (half, focus) = (0.35_f64, 2.0);
    // Between middles of pixels on the plane in focus.
    let step = 2.0 * half / f64::from(side()) * focus;
    let lens = Lens::Thin { yfov: 2.0 * half.atan(), aperture: 2.0 * f64::from(BLUR) * step, focus };
    let thin = with(lens);
    let wide = side() + 2 * BLUR as u32;
    let yfov = 2.0 * (half * f64::from(wide) / f64::from(side())).atan();
    let pinhole = with(Lens::Pinhole { yfov });
    let renderer = of(&pinhole);
    let through = |(number, [x, y]): (usize, [i32; 2])| {
        let mut camera = pinhole.clone();
        camera.to_world.translation += (f64::from(x) * camera.right() + f64::from(y) * camera.up()) * step;
        let seed = 1000 + number as u32;
        let seen = renders(&renderer, &camera, wide, seed..seed + 1).remove(0);
        Image::from_fn(side(), side(), |i, j| {
            let [i, j] = [i as i32 - x + BLUR, j as i32 + y + BLUR];
            seen.pixels[(j as u32 * wide + i as u32) as usize]
        })
    };
    // All of its points have their turn; the spread among them is taken for noise, which lowers z by a little.
    let expected: Vec<Image> = points().enumerate().map(through).collect();
    let found = renders(&of(&thin), &thin, side(), 1..1 + RENDERS);
    assert_eq!(fault("thin lens", &found, &mean_and_variance(&expected)), None);
}

/// T22, and the limits: whatever the size of a lens and the depth in focus, all is finite. What is in focus infinitely far away does not
/// depend on how far, a lens without a size is a pinhole, and a tiny one shows the same at any size.
#[test]
fn lenses_of_any_size_show_their_limits() {
    let lens = |[aperture, focus]: [f64; 2]| with(Lens::Thin { yfov: 1.0, aperture, focus });
    let seen = |renderer: &Renderer, camera: &Camera| image(renderer, camera, [24; 2], 4, 22);
    let renderer = of(&lens([1.0; 2]));
    let thin = |numbers: [f64; 2]| seen(&renderer, &lens(numbers));
    let two = |k: i32| 2.0_f64.powi(k);
    let pinhole = with(Lens::Pinhole { yfov: 1.0 });
    let pinhole = seen(&of(&pinhole), &pinhole);
    let far = thin([0.1, two(60)]);
    let tiny = thin([two(-44), two(-40)]);
    assert!(far != pinhole && tiny != pinhole && tiny != far);
    for k in [63, 64, 66, 100, 127] {
        assert!(thin([0.1, two(k)]) == far, "in focus at 2^{k}");
        assert!(thin([two(-k), 2.0]) == pinhole, "a lens of 2^-{k}");
        assert!(thin([two(-k), two(k)]) == pinhole, "a lens of 2^-{k} in focus at 2^{k}");
        assert!(thin([two(-k - 4), two(-k)]) == tiny, "a lens of 2^{} in focus at 2^-{k}", -k - 4);
    }
    let sizes =
        [f32::from_bits(1), f32::MIN_POSITIVE, 1e-30, 1e-20, 1e-6, 1.0, 1e6, 1e20, 1e30, f32::MAX].map(f64::from);
    for numbers in sizes.iter().flat_map(|aperture| sizes.map(|focus| [*aperture, focus])) {
        let bad = thin(numbers).pixels.iter().flatten().filter(|c| !c.is_finite() || **c < 0.0).count();
        assert_eq!(bad, 0, "aperture and focus {numbers:?}");
    }
}
