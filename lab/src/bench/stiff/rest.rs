//! What optics make stiff.

use super::{Family, Source, cloud, obj};
use glam::DVec3;

pub fn families() -> Vec<Family> {
    vec![
        Family {
            name: "focus of a mirror",
            parameter: "size of what lies there",
            values: &[3e-1, 3e-2, 1e-3, 1e-5, 1e-7],
            scene: focus,
            rivals: &[],
        },
        Family {
            name: "border of total reflection",
            parameter: "degrees of it in the image",
            values: &[3e1, 3.0, 1e-1, 1e-3, 1e-5],
            scene: total_reflection,
            rivals: &[],
        },
    ]
}

fn optics(camera: &str, triangles: &[[DVec3; 3]]) -> Source {
    let head = "image = { width = 96, height = 96 }\n[[mesh]]\nfile = \"mesh.obj\"\n";
    Source::Files(vec![("scene.toml", format!("{head}{camera}\n")), ("mesh.obj", obj(triangles))])
}

/// A paraboloid that looks up collects parallel rays in its focus.
fn focus(k: f64) -> Source {
    let ball = cloud(21, 60, DVec3::new(0.0, 1.0, 0.0), DVec3::splat(k), k);
    let camera = "[camera]\nkind = \"reflection\"\n\
        eye = { kind = \"orthographic\", eye = [0, 4, 0], target = [0, 0, 0], up = [0, 0, 1], height = 2 }\n\
        mirror = { shape = \"quadric\", vertex = [0, 0, 0], axis = [0, 1, 0], curvature = 0.5, conic = -1, radius = 1.5 }";
    optics(camera, &ball)
}

/// A ball of air in glass: where rays begin to be reflected altogether.
fn total_reflection(k: f64) -> Source {
    let around = cloud(22, 400, DVec3::ZERO, DVec3::splat(5.0), 1.2);
    let outside: Vec<_> = around.into_iter().filter(|t| t.iter().all(|v| v.length() > 1.2)).collect();
    // sine of the angle of incidence 1 / 1.5: where an eye at distance 4 sees it
    let at = (1.0f64 / 1.5 / 4.0).asin();
    let target = [at.tan(), 0.0, 3.0];
    let camera = format!(
        "[camera]\nkind = \"refraction\"\nior = 0.6666666666666666\ndepth = 2\n\
        eye = {{ kind = \"pinhole\", eye = [0, 0, 4], target = {target:?}, vfov = {k:?} }}\n\
        lens = {{ shape = \"sphere\", center = [0, 0, 0], radius = 1 }}"
    );
    optics(&camera, &outside)
}
