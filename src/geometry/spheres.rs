//! Spheres and capsules of a scene file: their places, sizes and colours; from lists, .npy arrays, point files and PLY files.

use super::mesh::{MAX_TRIANGLES, Material, Mesh, Missing, check_memory};
use super::ply;
use super::texture::{full_color, linear_color};
use crate::arrays::MapEach;
use crate::image::{read_npy_columns, read_npy_rows, read_text_points};
use crate::input::reader::{Field, Table};
use crate::input::{Error, Limits, Loading, Result};
use glam::DVec3;
use std::path::PathBuf;
use std::sync::Arc;

/// The source of spheres, or of the points that capsules join.
#[derive(Debug, Clone, PartialEq)]
pub struct SpheresSpec {
    pub source: SpheresSource,
    /// Of spheres whose source says none, before they are placed.
    pub radius: Option<f64>,
    pub colors: Option<ColorsSpec>,
    pub join: Option<Join>,
}

/// The points that capsules join. A capsule has the radius and the colour of the first point of the two.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Join {
    /// Each with the next one.
    Line,
    /// The first with the second, the third with the fourth, and so on.
    Pairs,
    /// As a line, in strands of so many points.
    Strands(u32),
}

/// A centre, and a radius if one is given.
type Given = (DVec3, Option<f64>);

#[derive(Debug, Clone, PartialEq)]
pub enum SpheresSource {
    Given(Arc<[Given]>),
    /// A .ply, .npy, .csv, .txt or .xyz file, already relative to the working directory.
    File(PathBuf),
}

/// A colour for each sphere, linear RGB in [0, 1].
#[derive(Debug, Clone, PartialEq)]
pub enum ColorsSpec {
    Given(Arc<[[f32; 3]]>),
    /// An .npy file.
    File(PathBuf),
}

/// Centres, and what else a source says of each: all of them or none.
#[derive(Debug, Clone, Default)]
pub struct Points {
    pub centres: Vec<DVec3>,
    pub radii: Option<Vec<f64>>,
    /// Linear RGB in [0, 1].
    pub colors: Option<Vec<[f32; 3]>>,
    /// What the source says and the spheres do not have.
    pub missing: Vec<Missing>,
}

/// The keys of spheres that those of meshes do not have.
pub(super) const KEYS: [&str; 5] = ["file", "centers", "radius", "colors", "join"];

/// The keys of a table that say which spheres there are.
pub(super) fn read(table: &Table) -> Result<SpheresSpec> {
    let source = match (table.get("file"), table.get("centers")) {
        (Some(_), Some(centers)) => {
            return Err(centers.error("spheres have either a file or centers; remove one of the two"));
        }
        (Some(file), None) => SpheresSource::File(file.path()?),
        (None, Some(centers)) => SpheresSource::Given(read_centers(&centers)?),
        (None, None) => {
            return Err(table.error("spheres need file = \"NAME.ply\" or centers = [[x, y, z], ...]"));
        }
    };
    let colors = |field: &Field| match field.is_list() {
        true => {
            let colors = field.items("a list of colours, as [[r, g, b], ...]")?.map(|c| c.color());
            Ok(ColorsSpec::Given(colors.collect::<Result<_>>()?))
        }
        false => Ok(ColorsSpec::File(field.path()?)),
    };
    let radius = table.optional("radius", Field::above_zero)?;
    let join = table.optional("join", read_join)?;
    Ok(SpheresSpec { source, radius, colors: table.optional("colors", colors)?, join })
}

fn read_join(field: &Field) -> Result<Join> {
    if let Ok(text) = field.text() {
        return match text {
            "line" => Ok(Join::Line),
            "pairs" => Ok(Join::Pairs),
            _ => {
                Err(field
                    .error(format_args!("unknown join {text:?}; use \"line\", \"pairs\" or the points of a strand")))
            }
        };
    }
    Ok(Join::Strands(field.integer(2, MAX_TRIANGLES as u64)? as u32))
}

impl Join {
    /// The points of each capsule: its two ends, the second one twice.
    fn capsules(self, points: usize) -> std::result::Result<Vec<[u32; 3]>, String> {
        let (each, step) = match self {
            Join::Line => (points, 1),
            Join::Pairs => (2, 2),
            Join::Strands(count) => (count as usize, 1),
        };
        if !points.is_multiple_of(each) {
            return Err(format!("{points} points cannot be joined {each} by {each}"));
        }
        let ends = |strand: usize| (strand..strand + each.saturating_sub(1)).step_by(step);
        let strands = (0..points).step_by(each.max(1));
        Ok(strands.flat_map(ends).map(|k| [k as u32, k as u32 + 1, k as u32 + 1]).collect())
    }
}

fn read_centers(field: &Field) -> Result<Arc<[Given]>> {
    let one = |item: Field| {
        let expected = "a centre, as [x, y, z], or a centre and a radius, as [x, y, z, r]";
        let numbers: Vec<Field> = item.items(expected)?.collect();
        match numbers.as_slice() {
            [x, y, z] => Ok((DVec3::new(x.number()?, y.number()?, z.number()?), None)),
            [x, y, z, r] => Ok((DVec3::new(x.number()?, y.number()?, z.number()?), Some(r.above_zero()?))),
            _ => Err(item.error(format_args!("expected {expected}, found {} numbers", numbers.len()))),
        }
    };
    field.items("a list of centres, as [[x, y, z], ...]")?.map(one).collect()
}

impl SpheresSpec {
    /// The spheres as a mesh; `called` names them in errors.
    ///
    /// # Errors
    /// [`Error::Missing`] or [`Error::Read`] for a file that cannot be read; [`Error::Input`] for one of another kind or shape, for spheres
    /// without a radius, a radius that is not above 0, numbers that are not finite, and colours of another number.
    pub(super) fn load(&self, called: &str, loading: &Loading) -> Result<Mesh> {
        let mut points = match &self.source {
            SpheresSource::Given(list) => given(list, self.radius)?,
            SpheresSource::File(path) => load_points(path, loading)?,
        };
        let count = points.centres.len();
        let default = self.radius;
        let radii = points.radii.take().or_else(|| default.map(|radius| vec![radius; count]));
        let radii = radii.ok_or_else(|| {
            Error::input(format!("spheres {called}: there are no radii in the file; add radius = 0.1, or any other"))
        })?;
        let colors = match &self.colors {
            None => points.colors.take(),
            Some(ColorsSpec::Given(colors)) => Some(colors.to_vec()),
            Some(ColorsSpec::File(path)) => {
                Some(read_npy_rows::<3>(path, loading)?.into_iter().map(|c| c.map_each(|x| x as f32)).collect())
            }
        };
        let mesh = round_of(points.centres, radii, colors, self.join, loading.limits())
            .map_err(|why| Error::input(format!("spheres {called}: {why}")))?;
        Ok(Mesh { missing: points.missing, ..mesh })
    }

    /// The file's name without folder and extension.
    pub(super) fn name(&self) -> String {
        match &self.source {
            SpheresSource::Given(_) => "spheres".into(),
            SpheresSource::File(path) => path.file_stem().unwrap_or_default().to_string_lossy().into_owned(),
        }
    }
}

/// Of a list all have a radius of their own, or the default.
fn given(list: &[Given], default: Option<f64>) -> Result<Points> {
    let radius = |(k, (_, own)): (usize, &Given)| {
        own.or(default).ok_or_else(|| {
            Error::input(format!("spheres: center {k} has no radius; add radius = 0.1, or a fourth number"))
        })
    };
    let radii = list.iter().enumerate().map(radius).collect::<Result<_>>()?;
    Ok(Points { centres: list.iter().map(|(centre, _)| *centre).collect(), radii: Some(radii), ..Points::default() })
}

fn load_points(path: &std::path::Path, loading: &Loading) -> Result<Points> {
    let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_lowercase();
    match extension.as_str() {
        "ply" => ply::load_points(path, loading),
        "npy" => {
            let (columns, numbers) =
                read_npy_columns(path, &[3, 4], |rows| check_count(rows, loading.limits()), loading)?;
            let rows = || numbers.chunks_exact(columns);
            Ok(Points {
                centres: rows().map(|row| DVec3::new(row[0], row[1], row[2])).collect(),
                radii: (columns == 4).then(|| rows().map(|row| row[3]).collect()),
                ..Points::default()
            })
        }
        "csv" | "txt" | "xyz" => {
            let text = read_text_points(path, loading)?;
            let colors = text.triples.as_deref().and_then(linear_colors);
            let left_out = (text.has_more() && colors.is_none()).then(|| Missing {
                what: format!("columns of {}", path.display()),
                why: "behind x y z they are no colours, which are from 0 to 1 or whole numbers to 255".into(),
            });
            Ok(Points { centres: text.points, radii: None, colors, missing: left_out.into_iter().collect() })
        }
        _ => {
            let name = path.display();
            Err(Error::input(format!("{name}: unknown kind of file for spheres; use .ply, .npy, .csv, .txt or .xyz")))
        }
    }
}

/// Linear light of sRGB colours from 0 to 1, or from 0 to 255 where all numbers are whole and one is above 1; `None` if they are no colours.
fn linear_colors(srgb: &[[f64; 3]]) -> Option<Vec<[f32; 3]>> {
    let full = full_color(srgb.iter().flatten());
    let is_color = !srgb.is_empty() && srgb.iter().flatten().all(|c| (0.0..=full).contains(c));
    is_color.then(|| srgb.iter().map(|rgb| linear_color(*rgb, full)).collect())
}

/// Radii that are numbers in f32 too.
fn is_radius(radius: f64) -> bool {
    (f64::from(f32::MIN_POSITIVE)..=f64::from(f32::MAX)).contains(&radius)
}

/// # Errors
/// More than 2^28 spheres, or too little memory for them.
fn check_count(count: u64, limits: Limits) -> std::result::Result<(), String> {
    if count > MAX_TRIANGLES as u64 {
        return Err(format!("{count} spheres, at most 2^28 are possible; use fewer"));
    }
    check_memory(limits, (count, count), format_args!("{count} spheres"), "use fewer").map_err(|e| e.to_string())
}

/// [`round_of`] without capsules.
///
/// # Errors
/// As those of [`round_of`].
#[cfg(any(test, feature = "internals"))]
pub fn spheres_of(
    centres: Vec<DVec3>,
    radii: Vec<f64>,
    colors: Option<Vec<[f32; 3]>>,
    limits: Limits,
) -> std::result::Result<Mesh, String> {
    round_of(centres, radii, colors, None, limits)
}

/// A mesh of spheres, or of the capsules that join their centres, of one two-sided matte material: light grey, or white where there are colours.
///
/// # Errors
/// What is wrong: counts that differ, more than 2^28 spheres, a centre that is not finite, a radius that is not above 0, a colour outside
/// [0, 1], points that are no whole pairs or strands; or too little memory.
pub fn round_of(
    centres: Vec<DVec3>,
    radii: Vec<f64>,
    colors: Option<Vec<[f32; 3]>>,
    join: Option<Join>,
    limits: Limits,
) -> std::result::Result<Mesh, String> {
    let count = centres.len();
    check_count(count as u64, limits)?;
    for (given, what) in [(radii.len(), "radii"), (colors.as_ref().map_or(count, Vec::len), "colours")] {
        if given != count {
            return Err(format!("{given} {what} for {count} spheres; give one for each"));
        }
    }
    if let Some(k) = centres.iter().position(|c| !c.is_finite()) {
        return Err(format!("sphere {k} lies at {}; use finite numbers", centres[k]));
    }
    check_radii(&radii)?;
    if let Some((k, c)) = colors.iter().flatten().enumerate().find(|(_, c)| !c.iter().all(|x| (0.0..=1.0).contains(x)))
    {
        return Err(format!("colour {k} is {c:?}; use linear RGB from 0 to 1"));
    }
    let triangles = match join {
        None => (0..count as u32).map(|k| [k; 3]).collect(),
        Some(join) => join.capsules(count)?,
    };
    let of_first = |ends: &[u32; 3]| radii[ends[0] as usize];
    let diffuse = if colors.is_some() { [1.0; 3] } else { Material::default().diffuse };
    Ok(Mesh {
        positions: centres,
        corner_colors: match &colors {
            Some(_) => triangles.iter().map(|ends| [ends[0]; 3]).collect(),
            None => Vec::new(),
        },
        colors: colors.unwrap_or_default(),
        radii: triangles.iter().map(of_first).collect(),
        has_capsules: join.is_some(),
        material_of: vec![0; triangles.len()],
        triangles,
        materials: vec![Material { diffuse, ..Material::default() }],
        ..Mesh::default()
    })
}

/// # Errors
/// Which sphere has a radius that is not above 0, or not finite.
pub(super) fn check_radii(radii: &[f64]) -> std::result::Result<(), String> {
    match radii.iter().position(|radius| !is_radius(*radius)) {
        Some(k) => Err(format!("sphere {k} has the radius {}; use a number above 0, from 1e-37 to 1e38", radii[k])),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spheres_are_triangles_of_one_corner_with_a_radius() {
        let centres = vec![DVec3::X, DVec3::new(0.0, -4.0, 0.5)];
        let mesh =
            spheres_of(centres.clone(), vec![2.0, 0.25], Some(vec![[0.5; 3], [0.0, 1.0, 0.0]]), Limits::default())
                .unwrap();
        assert_eq!((mesh.triangles.clone(), mesh.radius(1), mesh.radius(2)), (vec![[0; 3], [1; 3]], Some(0.25), None));
        assert_eq!((mesh.colors_of(1), mesh.materials[0].diffuse), ([[0.0, 1.0, 0.0]; 3], [1.0; 3]));
        assert_eq!(mesh.bounds(), Some((DVec3::new(-1.0, -4.25, -2.0), DVec3::new(3.0, 2.0, 2.0))));
        assert!(spheres_of(Vec::new(), Vec::new(), None, Limits::default()).unwrap().bounds().is_none());
    }

    #[test]
    fn text_has_colours_from_the_fourth_column_on() {
        let of = |text: &str| {
            let dir = tempfile::tempdir().unwrap();
            let file = dir.path().join("p.xyz");
            std::fs::write(&file, text).unwrap();
            let spec = SpheresSpec { source: SpheresSource::File(file), radius: Some(1.0), colors: None, join: None };
            spec.load("p", &Loading::default()).unwrap()
        };
        let bytes = of("1 2 3 255 0 0\n1 2 4 0 255 0\n");
        assert_eq!((bytes.colors, bytes.missing.len()), (vec![[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], 0));
        // normals
        let normals = of("1 2 3 0 0 -1\n");
        assert_eq!((normals.colors.len(), normals.missing.len()), (0, 1));
        assert!(normals.missing[0].why.contains("no colours"));
    }

    #[test]
    fn points_are_joined_in_lines_pairs_and_strands() {
        let firsts =
            |join: Join, points| join.capsules(points).map(|all| all.iter().map(|ends| ends[0]).collect::<Vec<_>>());
        assert_eq!(firsts(Join::Line, 4), Ok(vec![0, 1, 2]));
        assert_eq!(firsts(Join::Pairs, 4), Ok(vec![0, 2]));
        assert_eq!(firsts(Join::Strands(3), 6), Ok(vec![0, 1, 3, 4]));
        assert_eq!([firsts(Join::Line, 0), firsts(Join::Line, 1)], [Ok(Vec::new()), Ok(Vec::new())]);
        assert_eq!(Join::Pairs.capsules(2), Ok(vec![[0, 1, 1]]));
        for (join, each) in [(Join::Pairs, 2), (Join::Strands(4), 4)] {
            assert_eq!(firsts(join, 3), Err(format!("3 points cannot be joined {each} by {each}")));
        }
    }

    #[test]
    fn wrong_spheres_are_refused() {
        let refused = |centre: DVec3, radii: &[f64], color: f32| {
            spheres_of(vec![centre], radii.to_vec(), Some(vec![[color; 3]]), Limits::default()).unwrap_err()
        };
        for radius in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-300] {
            assert!(refused(DVec3::X, &[radius], 0.5).contains("sphere 0 has the radius"), "{radius}");
        }
        assert!(refused(DVec3::NAN, &[1.0], 0.5).contains("use finite numbers"));
        assert!(refused(DVec3::X, &[1.0, 2.0], 0.5).contains("2 radii for 1 spheres"));
        assert!(refused(DVec3::X, &[1.0], 1.5).contains("linear RGB from 0 to 1"));
    }
}
