//! `anamorph info FILE`: the counts and bounds of a model, a scene or a volume, and a camera that sees all of it.

use super::lens;
use crate::arrays::MapEach;
use crate::geometry::heights;
use crate::geometry::heights::{Grid, HeightSpec};
use crate::geometry::load::load_mesh;
use crate::geometry::scene_mesh::SceneMesh;
use crate::geometry::spec::{MeshSource, MeshSpec};
use crate::geometry::texture::Images;
use crate::input::{Error, Limits, Loading, Result};
use crate::scene::Scene;
use crate::scene::volume::load::{DESCRIBED, Numbers, read_described};
use crate::tools::cli::say::print;
use glam::DVec3;
use serde::Serialize;
use std::fmt;
use std::path::Path;

#[derive(Serialize)]
struct Contents {
    file: String,
    /// "model" or "scene".
    kind: &'static str,
    triangles: usize,
    spheres: usize,
    #[serde(skip_serializing_if = "is_zero")]
    capsules: usize,
    /// Centres of spheres and ends of capsules too.
    vertices: usize,
    /// Those that no triangle has; the bounds are without them.
    #[serde(skip_serializing_if = "is_zero")]
    unused_vertices: usize,
    /// Objects of a scene; 1 for a model.
    meshes: usize,
    materials: usize,
    /// At least one triangle has normals.
    normals: bool,
    /// At least one triangle has texture coordinates.
    texture_coordinates: bool,
    /// At least one triangle has vertex colours.
    vertex_colors: bool,
    /// The kind of a scene's camera.
    #[serde(skip_serializing_if = "Option::is_none")]
    camera: Option<&'static str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    heights: Option<Heights>,
    /// `None` if there are no vertices.
    bounds: Option<Bounds>,
}

fn is_zero(count: &usize) -> bool {
    *count == 0
}

/// The box around all triangles and spheres, in world units.
#[derive(Serialize)]
struct Bounds {
    low: [f64; 3],
    high: [f64; 3],
    centre: [f64; 3],
    extent: [f64; 3],
    fitting_camera: Fitting,
}

/// A pinhole that sees the whole box, if the image is at least as wide as high.
#[derive(Serialize)]
struct Fitting {
    kind: &'static str,
    eye: [f64; 3],
    target: [f64; 3],
    vfov: f64,
}

/// A file of numbers in a grid.
#[derive(Serialize)]
struct VolumeContents {
    file: String,
    /// "volume".
    kind: &'static str,
    /// Numbers along z, y and x.
    shape: [u64; 3],
    values: Values,
    /// From the first to the last node; `None` if the file does not say where they lie.
    bounds: Option<Bounds>,
}

/// Its numbers, by size; those that are none are left out.
#[derive(Serialize)]
struct Values {
    least: f32,
    /// A hundredth is below it.
    percentile_1: f32,
    median: f32,
    /// A hundredth is above it.
    percentile_99: f32,
    most: f32,
}

/// The samples of a height image.
#[derive(Serialize)]
struct Heights {
    columns: usize,
    rows: usize,
    without_data: usize,
    /// Easting and northing of the centre of the grid, which is at x = z = 0 in the scene.
    #[serde(skip_serializing_if = "Option::is_none")]
    middle: Option<[f64; 2]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    cell: Option<[f64; 2]>,
    /// The size of a cell in metres, if `cell` is or may be in degrees.
    #[serde(skip_serializing_if = "Option::is_none")]
    cell_in_metres: Option<[f64; 2]>,
}

pub fn run(path: &Path, json: bool, limits: Limits) -> Result<()> {
    let loading = Loading::new(limits);
    if DESCRIBED.contains(&extension(path).as_str()) {
        return show(&VolumeContents::read(path, &loading)?, json);
    }
    if lens::is_calibration(path, &loading) {
        return show(&lens::read(path, &loading)?, json);
    }
    show(&read(path, &loading)?, json)
}

pub fn show(contents: &(impl Serialize + fmt::Display), json: bool) -> Result<()> {
    if !json {
        return print(&contents.to_string());
    }
    let text = serde_json::to_string_pretty(contents).map_err(|e| Error::work(format!("info as JSON: {e}")))?;
    print(&(text + "\n"))
}

fn extension(path: &Path) -> String {
    path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase()
}

fn read(path: &Path, loading: &Loading) -> Result<Contents> {
    if matches!(extension(path).as_str(), "toml" | "json") {
        let scene = Scene::load(path, &[], 0.0, loading)?;
        let kind = scene.camera.kind.name;
        return Ok(Contents { camera: Some(kind), ..Contents::of(path, "scene", scene.objects.len(), &scene.mesh) });
    }
    if heights::is_height_image(path) {
        let grid = heights::read(path, loading)?;
        // a GeoTIFF in degrees has no size in world units: its mesh is described in degrees
        let cell = grid.georeference.filter(|g| g.in_degrees).map(|g| g.cell);
        let spec = HeightSpec { file: path.into(), height_scale: 1.0, cell };
        let mesh = heights::mesh(&grid, &spec, loading.limits())?;
        return Ok(Contents { heights: Some(Heights::of(&grid)), ..Contents::of(path, "model", 1, &mesh.into()) });
    }
    let mesh = load_mesh(&MeshSpec::of(MeshSource::File(path.into())), &mut Images::left_out(), loading)?;
    Ok(Contents::of(path, "model", 1, &mesh.into()))
}

impl Contents {
    fn of(path: &Path, kind: &'static str, meshes: usize, all: &SceneMesh) -> Contents {
        let mesh = all.base();
        let [spheres, capsules] = mesh.round_counts();
        Contents {
            file: path.display().to_string(),
            kind,
            triangles: all.triangle_count() - spheres - capsules,
            spheres,
            capsules,
            vertices: all.vertex_count(),
            unused_vertices: all.unused_vertices(),
            meshes,
            materials: mesh.materials.len(),
            normals: !mesh.corner_normals.is_empty(),
            texture_coordinates: !mesh.corner_uvs.is_empty(),
            vertex_colors: !mesh.corner_colors.is_empty(),
            camera: None,
            heights: None,
            bounds: all.drawn_bounds().map(|(low, high)| Bounds::of(low, high)),
        }
    }
}

impl VolumeContents {
    fn read(path: &Path, loading: &Loading) -> Result<VolumeContents> {
        let Numbers { shape, mut values, placement } = read_described(path, loading)?;
        values.retain(|value| !value.is_nan());
        values.sort_unstable_by(f32::total_cmp);
        let at = |share: f64| values.get((share * (values.len().max(1) - 1) as f64) as usize).copied();
        let [Some(least), Some(percentile_1), Some(median), Some(percentile_99), Some(most)] =
            [0.0, 0.01, 0.5, 0.99, 1.0].map(at)
        else {
            return Err(Error::input(format!("{}: all of its numbers are NaN", path.display())));
        };
        let bounds = placement.map(|placement| {
            let [low, high] = placement.ends(shape);
            Bounds::of(low, high)
        });
        let values = Values { least, percentile_1, median, percentile_99, most };
        Ok(VolumeContents { file: path.display().to_string(), kind: "volume", shape, values, bounds })
    }
}

impl Heights {
    fn of(grid: &Grid) -> Heights {
        Heights {
            columns: grid.columns,
            rows: grid.rows,
            without_data: grid.samples.iter().filter(|h| h.is_nan()).count(),
            middle: grid.georeference.map(|g| g.middle.to_array()),
            cell: grid.georeference.map(|g| g.cell.to_array()),
            cell_in_metres: grid.georeference.filter(|g| g.may_be_degrees()).map(|g| g.cell_in_metres().to_array()),
        }
    }
}

/// Vertical field of view in degrees.
const VFOV: f64 = 40.0;
/// Direction from the centre to the eye: in front, a little to the right and above.
const TO_EYE: DVec3 = DVec3::new(0.4, 0.3, 1.0);
/// The eye is this much farther than where the sphere around the box touches the image's border. Rounding to four digits moves
/// eye and target by less than a thousandth of their distance.
const MARGIN: f64 = 1.05;

impl Bounds {
    fn of(low: DVec3, high: DVec3) -> Bounds {
        // halved first, as the sum may overflow
        let (centre, extent) = (low / 2.0 + high / 2.0, high - low);
        let radius = extent.length() / 2.0;
        let distance = if radius > 0.0 { MARGIN * radius / (VFOV.to_radians() / 2.0).sin() } else { 1.0 };
        // the decimals of a number rounded to four digits of the distance
        let decimals = (3 - distance.log10().floor() as i32).max(0) as usize;
        let rounded = |v: DVec3| v.to_array().map_each(|x| format!("{x:.decimals$}").parse().unwrap_or(x) + 0.0);
        let eye = centre + distance * TO_EYE.normalize();
        Bounds {
            low: low.to_array(),
            high: high.to_array(),
            centre: centre.to_array(),
            extent: extent.to_array(),
            fitting_camera: Fitting { kind: "pinhole", eye: rounded(eye), target: rounded(centre), vfov: VFOV },
        }
    }
}

impl fmt::Display for Contents {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let yes = |there: bool| if there { "yes" } else { "no" };
        writeln!(f, "{} ({})", self.file, self.kind)?;
        writeln!(f, "  triangles            {}", self.triangles)?;
        if self.spheres > 0 {
            writeln!(f, "  spheres              {}", self.spheres)?;
        }
        if self.capsules > 0 {
            writeln!(f, "  capsules             {}", self.capsules)?;
        }
        let unused = match self.unused_vertices {
            0 => String::new(),
            count => format!(", {count} of them in no triangle: the bounds are without them"),
        };
        writeln!(f, "  vertices             {}{unused}", self.vertices)?;
        writeln!(f, "  meshes               {}", self.meshes)?;
        writeln!(f, "  materials            {}", self.materials)?;
        writeln!(f, "  normals              {}", yes(self.normals))?;
        writeln!(f, "  texture coordinates  {}", yes(self.texture_coordinates))?;
        writeln!(f, "  vertex colours       {}", yes(self.vertex_colors))?;
        if let Some(camera) = self.camera {
            writeln!(f, "  camera               {camera}")?;
        }
        if let Some(heights) = &self.heights {
            heights.fmt(f)?;
        }
        match &self.bounds {
            Some(bounds) => bounds.fmt(f),
            None => writeln!(f, "  bounds               none: there are no vertices"),
        }
    }
}

impl fmt::Display for VolumeContents {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let [z, y, x] = self.shape;
        let Values { least, percentile_1, median, percentile_99, most } = self.values;
        writeln!(f, "{} ({})", self.file, self.kind)?;
        writeln!(f, "  numbers              {x} x {y} x {z} along x, y and z")?;
        writeln!(f, "  values               {least} to {most}")?;
        writeln!(f, "  1 %, half, 99 %      are at most {percentile_1}, {median}, {percentile_99}")?;
        match &self.bounds {
            Some(bounds) => bounds.fmt(f),
            None => writeln!(f, "  bounds               the file does not say them: [volume] needs min and max"),
        }
    }
}

impl fmt::Display for Heights {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        writeln!(f, "  heights              {} x {}, {} without data", self.columns, self.rows, self.without_data)?;
        if let (Some([dx, dy]), Some([x, y])) = (self.cell, self.middle) {
            writeln!(f, "  cell                 {dx} x {dy} in the file")?;
            if let Some([mx, mz]) = self.cell_in_metres {
                writeln!(f, "  if it is in degrees  use cell = [{mx:.3}, {mz:.3}] for metres")?;
            }
            writeln!(f, "  centre of the grid   easting {x}, northing {y}; it is at x = z = 0 in a scene")?;
        }
        Ok(())
    }
}

impl fmt::Display for Bounds {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        writeln!(f, "  low                  {:?}", self.low)?;
        writeln!(f, "  high                 {:?}", self.high)?;
        writeln!(f, "  centre               {:?}", self.centre)?;
        writeln!(f, "  extent               {:?}", self.extent)?;
        let Fitting { kind, eye, target, vfov } = &self.fitting_camera;
        writeln!(f, "\n[camera]\nkind = {kind:?}\neye = {eye:?}\ntarget = {target:?}\nvfov = {vfov}")
    }
}
