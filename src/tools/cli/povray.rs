//! A scene for POV-Ray 3.7, a ray tracer of others' making: each pixel's ray against the same triangles, each triangle in
//! a colour that is its id (the comparison of Yu et al. 2009, 4.4).
//!
//! POV-Ray's `mesh_camera` takes any rays: that of pixel k starts in the centre of face k and goes along its normal. The
//! corners and normals of its meshes are in single precision but their transforms are in double; so one face, with its
//! centre at 0 and the normal +z to the last bit, is placed anew for each pixel, moved to P and rotated to D. (Distribution 1
//! counts faces through all meshes.) P is then exact, and D as good as a unit vector in double. The scene's triangles are
//! single objects, which are in double too, where a mesh's are not.
//!
//! Found in POV-Ray 3.7 and worked around: row j of its picture shows the faces of row j - 1, so the picture is one row
//! higher than the image; the normal of a face is that of the reversed winding; what is nearer than 1e-4 or farther than 1e7
//! is never hit, so the world is scaled by a power of two that leaves every distance just below [`REACH`]; bounding boxes
//! are in single precision, so the command in the file does without them; and it counts through the faces before a pixel's
//! own, so large images take a time of the square of their pixels (800 x 600: a minute or two on two cores, and 1.5 GB).

mod faces;
mod rays;

use crate::arrays::MapEach;
use crate::camera::{Camera, Ray};
use crate::image::write_lines;
use crate::input::{Error, Result};
use crate::scene::Scene;
use faces::Face;
use glam::DVec3;
use std::io::{self, Write};
use std::path::Path;

/// The largest distance that a ray goes to a hit, POV-Ray's units: under the 1e7 that are its farthest, and so large that the
/// 1e-4 that are its nearest are 5e-11 of the scene's reach at most.
const REACH: f64 = (1 << 22) as f64;

/// An id is three bytes of a colour; white is no id.
const IDS_MAX: usize = (1 << 24) - 1;

/// Writes the scene as its camera sees it, a ray per pixel, for POV-Ray 3.7 to render.
///
/// # Errors
/// [`Error::Input`] for cameras that POV-Ray cannot express: curves, several layers, optics, a `t_range` that starts at
/// -inf or ends some rays sooner than others, composites with `master` or `feather`, spheres, alpha masks, things that move while the frame is
/// taken, more triangles than a colour has values; [`Error::Write`] naming `path`.
pub fn write(path: &Path, scene: &Scene, camera: &Camera) -> Result<()> {
    let refuse = |why: String| Error::input(format!("--export-povray: {why}"));
    if scene.mesh.base().has_spheres() {
        return Err(refuse("only triangles are written; leave out [[spheres]]".into()));
    }
    if scene.steps.is_some() {
        return Err(refuse("things move while the frame is taken; make shutter and line_time 0".into()));
    }
    if scene.mesh.base().has_alpha_masks() {
        return Err(refuse("the colour of a triangle is its id, so that alpha masks are lost; remove them".into()));
    }
    if camera.layered().is_some() {
        return Err(refuse("a composite with master or feather has several rays per pixel; use another camera".into()));
    }
    let triangles = scene.mesh.triangle_count();
    if triangles > IDS_MAX {
        return Err(refuse(format!("{triangles} triangles; a colour names {IDS_MAX} at most")));
    }
    scene.mesh.check_copies(scene.limits)?;
    let faces = faces::of(&scene.mesh);
    let rays = rays::of(camera, scene.bounds()).map_err(refuse)?;
    if rays.length.is_some() && faces.iter().any(Face::is_one_sided) {
        let why = "POV-Ray forgets where t_range ends behind the unseen side of a triangle; use two_sided = true";
        return Err(refuse(why.into()));
    }
    let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    write_lines(path, |out| {
        head(out, &name, camera)?;
        write_camera(out, &rays)?;
        faces.iter().try_for_each(|face| write_face(out, face, rays.scale))
    })
}

fn head(out: &mut dyn Write, name: &str, camera: &Camera) -> io::Result<()> {
    let (kind, width, height, more) = (camera.kind, camera.width, camera.height, camera.height + 1);
    let picture = Path::new(name).with_extension("png");
    writeln!(out, "// The rays of a {kind} camera of {width}x{height} pixels, for POV-Ray 3.7:")?;
    writeln!(out, "// povray +I{name:?} +O{picture:?} +FN8 +W{width} +H{more} -A -D -MB File_Gamma=1")?;
    writeln!(
        out,
        "// Row 0 of that picture is no row of the image. A pixel's triangle is R + 256 G + 65536 B; white: none."
    )?;
    writeln!(out, "#version 3.7;")?;
    writeln!(out, "global_settings {{ assumed_gamma 1 max_trace_level 256 }}")?;
    writeln!(out, "#default {{ finish {{ ambient 0 diffuse 0 emission 1 }} }}")?;
    writeln!(out, "background {{ rgb 1 }}")
}

/// A face for each pixel: the rows of its matrix are two vectors across the ray, the ray's direction and its start.
fn write_camera(out: &mut dyn Write, rays: &rays::Rays) -> io::Result<()> {
    writeln!(
        out,
        "#declare F = mesh2 {{ vertex_vectors {{ 3, <1,0,0>, <0,1,0>, <-1,-1,0> }} face_indices {{ 1, <0,2,1> }} }}"
    )?;
    write!(out, "camera {{ mesh_camera {{ 1 1")?;
    if let Some(length) = rays.length {
        write!(out, " {:e}", rays.scale * length)?;
    }
    writeln!(out)?;
    for Ray { origin, direction } in &rays.each {
        let (x, y) = direction.any_orthonormal_pair();
        let [x, y, z, p] = [x, y, *direction, rays.scale * origin].map_each(numbers);
        writeln!(out, "mesh {{ F matrix <{x},{y},{z},{p}> }}")?;
    }
    writeln!(out, "}} }}")
}

fn write_face(out: &mut dyn Write, face: &Face, scale: f64) -> io::Result<()> {
    let [a, b, c] = face.corners.map_each(|corner| numbers(scale * corner));
    // POV-Ray's outside is our back
    let (outside, inside) = (colour(face.back), colour(face.front));
    write!(out, "triangle {{ <{a}>, <{b}>, <{c}> texture {{ pigment {{ {outside} }} }}")?;
    if face.is_one_sided() || face.front != face.back {
        write!(out, " interior_texture {{ pigment {{ {inside} }} }}")?;
    }
    writeln!(out, " }}")
}

/// Three numbers, as many digits as bring back their bits.
fn numbers(DVec3 { x, y, z }: DVec3) -> String {
    format!("{x:e},{y:e},{z:e}")
}

/// A colour that shows an id; clear as glass without one.
fn colour(id: Option<u32>) -> String {
    match id.map(u32::to_le_bytes) {
        Some([r, g, b, _]) => format!("rgb <{r},{g},{b}>/255"),
        None => "rgbt 1".into(),
    }
}
