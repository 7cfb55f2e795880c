//! MTL: the diffuse colours of an OBJ's materials, and the images that these are multiplied by.

use std::collections::HashSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::Vec2;

use crate::geometry::lex::{HAS_ZEROS, Lines, Tokens, parse_f64, quoted, with_line_feeds};
use crate::geometry::mesh::{HALF, Material, Missing};
use crate::geometry::texture::{Absent, Texels, Texture, Wrap, with_opacity};
use crate::input::{Error, Limits, Loading, Result};

/// A material, and the images on it, which are not loaded yet.
#[derive(Debug, Default)]
pub struct Mapped {
    pub material: Material,
    /// Whether its file says its diffuse colour.
    has_color: bool,
    /// Its model of light has no highlight.
    is_matte: bool,
    /// Its opacity in [0, 1] by `d`, and the line that says so.
    opacity: Option<(f32, String)>,
    /// The same by `Tr`, which counts without `d` alone: some programs write `Tr` = `d`.
    unclear: Option<(f32, String)>,
    map: Option<Map>,
    mask: Option<Map>,
}

/// An image, and how texture coordinates lie in it: times the scale, and moved.
#[derive(Debug)]
struct Map {
    /// The line that says so.
    line: String,
    image: PathBuf,
    clamp: bool,
    scale: Vec2,
    offset: Vec2,
}

impl Mapped {
    /// Its diffuse colour is its image's.
    fn is_white(&self) -> bool {
        !self.has_color && self.map.is_some()
    }

    fn opacity(&self) -> Option<&(f32, String)> {
        self.opacity.as_ref().or(self.unclear.as_ref())
    }

    /// How texture coordinates lie in the image: times the scale, and moved.
    pub fn placement(&self) -> (Vec2, Vec2) {
        self.map.as_ref().or(self.mask.as_ref()).map_or((Vec2::ONE, Vec2::ZERO), |m| (m.scale, m.offset))
    }

    /// It has an alpha mask.
    pub fn is_masked(&self) -> bool {
        self.mask.is_some()
    }

    /// Its opacity for blending; `None`: it is opaque.
    pub fn blend(&self) -> Option<f32> {
        let opacity = self.opacity().map_or(1.0, |own| own.0);
        (opacity < 1.0 || self.is_masked()).then_some(opacity)
    }

    /// What is left out of it where it is not blended.
    pub fn unblended(&self) -> Option<Missing> {
        let (opacity, line) = self.opacity().filter(|own| own.0 < 1.0)?;
        let why = format!("{line}: its opacity is {opacity}; it is drawn opaque without blend = true");
        Some(Missing { what: format!("transparency of material {:?}", self.material.name), why })
    }

    /// The material if its images are not read. As in [`Mapped::with_images`], it is white if only an image colours it.
    pub fn without_images(&self, loading: &Loading) -> Material {
        let exists = |map: &Map| {
            loading.note(&map.image);
            map.image.is_file()
        };
        let is_white = self.is_white() && self.map.as_ref().is_some_and(exists);
        let diffuse = if is_white { [1.0; 3] } else { self.material.diffuse };
        Material { diffuse, ..self.material.clone() }
    }

    /// The material with its images, from `find_image`. Those for which it says why they are not there are added to `missing`.
    ///
    /// # Errors
    /// [`Error::Input`] naming the line: those of `find_image`; a mask with another `-s` or `-clamp` than the image.
    pub fn with_images(
        &self,
        mut find_image: impl FnMut(&Path) -> Result<std::result::Result<Arc<Texels>, Absent>>,
        missing: &mut Vec<Missing>,
        limits: Limits,
    ) -> Result<Material> {
        let mut find = |map: Option<&Map>, instead: &str| -> Result<Option<Arc<Texels>>> {
            let Some(map) = map else { return Ok(None) };
            let wrong = |e| Error::input(format!("{}: {e}; texture = false shows none", map.line));
            match find_image(&map.image).map_err(wrong)? {
                Ok(texels) => Ok(Some(texels)),
                Err(absent) => {
                    let why = format!("{}: {absent}; {instead}", map.line);
                    missing.push(Missing { what: map.image.display().to_string(), why });
                    Ok(None)
                }
            }
        };
        let colours = find(self.map.as_ref(), "the material's own colour is used")?;
        let opacity = find(self.mask.as_ref(), "nothing is masked")?;
        let mask = self.mask.as_ref().zip(opacity);
        let mut material = self.material.clone();
        if self.is_white() && colours.is_some() {
            material.diffuse = [1.0; 3];
        }
        let wrap = |map: &Map| [if map.clamp { Wrap::Clamp } else { Wrap::Repeat }; 2];
        let placed = self.map.as_ref().or(self.mask.as_ref());
        let Some(wrap_here) = placed.map(wrap) else { return Ok(material) };
        let cutoff = mask.is_some().then_some(HALF);
        let texels = match (colours, mask) {
            (colours, Some((mask, opacity))) => {
                let offset = match &self.map {
                    Some(map) if map.scale != mask.scale || map.clamp != mask.clamp => {
                        let line = &mask.line;
                        return Err(Error::input(format!("{line}: its -s and -clamp are not map_Kd's; give the same")));
                    }
                    Some(map) => mask.offset - map.offset,
                    None => Vec2::ZERO,
                };
                let opacity = Texture { wrap: wrap(mask), ..Texture::new(opacity) };
                with_opacity(
                    colours.map(|c| Texture { wrap: wrap_here, ..Texture::new(c) }),
                    opacity,
                    offset.as_dvec2(),
                    limits,
                )
                .map_err(|e| e.at(&mask.line))?
            }
            (Some(colours), None) => colours,
            (None, None) => return Ok(material),
        };
        material.texture = Some(Texture { wrap: wrap_here, cutoff, ..Texture::new(texels) });
        Ok(material)
    }
}

/// Reads the files in `folder` that `mtllib` lines name. A line names one file, whose name may contain spaces, or else several files. Files
/// that do not exist are skipped. A file that is named several times is read once, at the place of the last.
///
/// # Errors
/// [`Error::Input`] if a file cannot be read or is malformed.
pub(super) fn load(folder: &Path, libraries: &[&str], loading: &Loading) -> Result<Vec<Mapped>> {
    let find = |name: &str| -> Option<PathBuf> {
        let is_there = |path: &PathBuf| {
            loading.note(path);
            path.is_file()
        };
        [name.to_owned(), name.replace('\\', "/")].iter().map(|name| folder.join(name)).find(is_there)
    };
    let mut files = Vec::new();
    for library in libraries {
        match find(library) {
            Some(file) => files.push(file),
            None => files.extend(library.split_whitespace().filter_map(find)),
        }
    }
    let mut known = HashSet::new();
    let mut last: Vec<PathBuf> =
        files.into_iter().rev().filter(|f| known.insert(f.canonicalize().unwrap_or_else(|_| f.clone()))).collect();
    last.reverse();
    let mut materials = Vec::new();
    for file in last {
        let unreadable = |e| Error::unreadable(&file, e);
        let start = loading.prefix(&file).map_err(unreadable)?;
        if start.goes_on_after_zero() {
            return Err(Error::input(format!("{}: {HAS_ZEROS}", file.display())));
        }
        let text = start.read_all().map_err(unreadable)?;
        materials.extend(parse(&text, &file)?);
    }
    Ok(materials)
}

/// Parses MTL text: names; `Kd`, `Ks` and `Ke` as linear RGB, the first two clamped to [0, 1]; `Ns`, and `illum`, below 2 of which
/// nothing shines; `d`, or 1 - `Tr`, as opacity; `map_Kd`, by whose image that is multiplied, and `map_d`, where
/// there is no surface, with their options `-clamp`, `-o` and `-s`; images lie relative to the folder of `file`. Materials with an image
/// but no `Kd` are white, those with neither keep the default colour; a `Kd` given as a spectrum or in XYZ is skipped.
///
/// # Errors
/// [`Error::Input`] naming `file` and the line.
pub(super) fn parse(text: &[u8], file: &Path) -> Result<Vec<Mapped>> {
    let text = with_line_feeds(text.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(text));
    let mut materials: Vec<Mapped> = Vec::new();
    for (number, line) in Lines::new(&text) {
        let at = format!("{}:{}", file.display(), number + 1);
        let wrong = |message: String| Error::input(format!("{at}: {message}"));
        let mut tokens = Tokens::new(&line);
        match tokens.next().unwrap_or_default() {
            b"newmtl" => {
                // may be empty, as Blender writes it
                let name = tokens.name();
                materials.push(Mapped { material: Material { name, ..Material::default() }, ..Mapped::default() });
            }
            key @ (b"Kd" | b"Ks" | b"Ke" | b"Ns" | b"illum" | b"d" | b"Tr" | b"map_Kd" | b"map_d") => {
                let key = String::from_utf8_lossy(key);
                let Some(mapped) = materials.last_mut() else {
                    return Err(wrong(format!("{key} before the first newmtl; name the material first")));
                };
                let colour = |most| parse_colour(tokens.clone(), &key, most).map_err(wrong);
                let number = || parse_number(tokens.clone(), &key).map_err(wrong);
                let map = || {
                    let map = parse_map(tokens.clone(), &key).map_err(wrong)?;
                    let image = file.parent().unwrap_or(Path::new("")).join(map.image);
                    Ok(Some(Map { line: format!("{at}: {key}"), image, ..map }))
                };
                let material = &mut mapped.material;
                match &*key {
                    "Kd" => {
                        let color = colour(1.0)?;
                        mapped.has_color |= color.is_some();
                        material.diffuse = color.unwrap_or(material.diffuse);
                    }
                    "Ks" => material.specular = colour(1.0)?.unwrap_or(material.specular),
                    "Ke" => material.emissive = colour(f64::from(f32::MAX))?.unwrap_or(material.emissive),
                    // microfacets of alpha^2 = 2 / (Ns + 2) are about as wide as Phong's highlight (Walter et al. 2007)
                    "Ns" => material.roughness = (2.0 / (number()?.max(0.0) + 2.0)).powf(0.25) as f32,
                    "illum" => mapped.is_matte = number()? < 2.0,
                    "d" => mapped.opacity = Some((parse_opacity(tokens.clone()).map_err(wrong)?, at.clone())),
                    "Tr" => mapped.unclear = Some(((1.0 - number()?).clamp(0.0, 1.0) as f32, at.clone())),
                    "map_Kd" => mapped.map = map()?,
                    _ => mapped.mask = map()?,
                }
            }
            _ => {}
        }
    }
    materials.iter_mut().filter(|mapped| mapped.is_matte).for_each(|mapped| mapped.material.specular = [0.0; 3]);
    Ok(materials)
}

/// Options, and the rest of the line as the image's name.
fn parse_map(mut tokens: Tokens, key: &str) -> std::result::Result<Map, String> {
    let (line, image) = (String::new(), PathBuf::new());
    let mut map = Map { line, image, clamp: false, scale: Vec2::ONE, offset: Vec2::ZERO };
    loop {
        let mut ahead = tokens.clone();
        match ahead.next() {
            Some(option) if option.len() > 1 && option[0] == b'-' => {
                tokens = ahead;
                let count = match option {
                    b"-o" | b"-s" | b"-t" => {
                        let values = take_numbers(&mut tokens);
                        let both =
                            |plain: f32| Vec2::new(*values.first().unwrap_or(&plain), *values.get(1).unwrap_or(&plain));
                        match option {
                            b"-o" => map.offset = both(0.0),
                            b"-s" => map.scale = both(1.0),
                            _ => {}
                        }
                        0
                    }
                    b"-clamp" => {
                        map.clamp = tokens.next() == Some(b"on");
                        0
                    }
                    b"-mm" => 2,
                    _ => 1,
                };
                tokens.by_ref().take(count).for_each(drop);
            }
            Some(_) => break,
            None => return Err(format!("{key} without an image; name one")),
        }
    }
    map.image = tokens.name().replace('\\', "/").into();
    Ok(map)
}

/// Up to three numbers, as many as there are.
fn take_numbers(tokens: &mut Tokens) -> Vec<f32> {
    let mut values = Vec::new();
    while values.len() < 3 {
        let mut ahead = tokens.clone();
        match ahead.next().and_then(parse_f64).filter(|v| v.is_finite()) {
            Some(value) => values.push(value as f32),
            None => break,
        }
        *tokens = ahead;
    }
    values
}

/// The opacity of `d`, which may follow `-halo`.
fn parse_opacity(mut tokens: Tokens) -> std::result::Result<f32, String> {
    if tokens.clone().next() == Some(b"-halo") {
        tokens.next();
    }
    parse_number(tokens, "d").map(|opacity| opacity.clamp(0.0, 1.0) as f32)
}

fn parse_number(mut tokens: Tokens, key: &str) -> std::result::Result<f64, String> {
    let token = tokens.next().unwrap_or_default();
    let value = parse_f64(token).filter(|v| v.is_finite());
    value.ok_or_else(|| format!("{key} value {} is not a finite number", quoted(token)))
}

/// `r g b`, or `r` alone for a grey, from 0 to `most`.
fn parse_colour(tokens: Tokens, key: &str, most: f64) -> std::result::Result<Option<[f32; 3]>, String> {
    let mut values = Vec::new();
    for token in tokens.take(3) {
        if matches!(token, b"spectral" | b"xyz") {
            return Ok(None);
        }
        match parse_f64(token) {
            Some(value) if value.is_finite() => values.push(value.clamp(0.0, most) as f32),
            _ => return Err(format!("{key} value {} is not a finite number", quoted(token))),
        }
    }
    match values[..] {
        [grey] => Ok(Some([grey; 3])),
        [r, g, b] => Ok(Some([r, g, b])),
        _ => Err(format!("{key} has {} of 3 values; give r g b", values.len())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_and_names() {
        let text =
            b"# m\nnewmtl red wall \r\nKd 0.5 0.25 2\r\nmap_Kd a.png\nnewmtl g\nKd .5\nnewmtl s\nKd spectral a.rfl";
        let materials = parse(text, Path::new("a.mtl")).unwrap();
        let found: Vec<_> = materials.iter().map(|m| (m.material.name.as_str(), m.material.diffuse)).collect();
        assert_eq!(found, [("red wall", [0.5, 0.25, 1.0]), ("g", [0.5; 3]), ("s", [0.8; 3])]);
        // Blender writes a material without a name
        let unnamed = parse(b"newmtl\rKd 0.5 0.25 0\r", Path::new("a.mtl")).unwrap();
        assert_eq!((unnamed[0].material.name.as_str(), unnamed[0].material.diffuse), ("", [0.5, 0.25, 0.0]));
    }

    #[test]
    fn images_with_their_options() {
        let text = b"newmtl a\nmap_Kd -s 2 3 1 -clamp on -o 0.5 -mm 0 1 -blendu off my image.png\nnewmtl b\nKd 1 0 0\nmap_d m.png\nnewmtl c\nKd 0 1 0";
        let grey =
            |v: f32| Arc::new(Texels { width: 1, height: 1, rgba: vec![[v, v, v, 1.0].map(half::f16::from_f32)] });
        let read = parse(text, Path::new("in/a.mtl")).unwrap();
        let mut asked = Vec::new();
        let mut find = |image: &Path| {
            asked.push(image.to_owned());
            Ok(Ok(grey(0.25)))
        };
        let materials: Vec<_> =
            read.iter().map(|m| m.with_images(&mut find, &mut Vec::new(), Limits::default()).unwrap()).collect();
        assert_eq!(asked, [Path::new("in/my image.png"), Path::new("in/m.png")]);
        let [a, b, c] = &materials[..] else { panic!("three") };
        assert_eq!(read[0].placement(), (Vec2::new(2.0, 3.0), Vec2::new(0.5, 0.0)));
        assert_eq!(a.diffuse, [1.0; 3]);
        assert_eq!(a.texture, Some(Texture { wrap: [Wrap::Clamp; 2], ..Texture::new(grey(0.25)) }));
        let masked = b.texture.clone().unwrap();
        assert_eq!((masked.cutoff, masked.texels.rgba[0][0]), (Some(0.5), half::f16::ONE));
        // 0.25 of linear light is 0.537 in sRGB
        assert!((masked.texels.rgba[0][3].to_f64() - 0.537).abs() < 1e-3);
        assert_eq!(c.texture, None);
    }

    /// A mask finer than its image, moved by half of it: both keep what they show, and where.
    #[test]
    fn a_mask_lies_where_its_own_options_say() {
        let text = b"newmtl a\nmap_Kd c.png\nmap_d -o 0.5 0 m.png";
        let read = parse(text, Path::new("a.mtl")).unwrap();
        let row = |greys: &[f32]| {
            let rgba = greys.iter().map(|v| [*v, *v, *v, 1.0].map(half::f16::from_f32)).collect();
            Arc::new(Texels { width: greys.len() as u32, height: 1, rgba })
        };
        let image = |path: &Path| match path == Path::new("c.png") {
            true => Ok(Ok(row(&[0.25]))),
            false => Ok(Ok(row(&[0.0, 0.0, 1.0, 1.0]))),
        };
        let texels = read[0].with_images(image, &mut Vec::new(), Limits::default()).unwrap().texture.unwrap().texels;
        let seen: Vec<_> = texels.rgba.iter().map(|t| [t[0].to_f32(), t[3].to_f32()]).collect();
        assert_eq!(seen, [[0.25, 1.0], [0.25, 1.0], [0.25, 0.0], [0.25, 0.0]]);

        let other = parse(b"newmtl a\nmap_Kd c.png\nmap_d -s 2 2 m.png", Path::new("a.mtl")).unwrap();
        let message = other[0].with_images(image, &mut Vec::new(), Limits::default()).unwrap_err().to_string();
        assert_eq!(message, "a.mtl:3: map_d: its -s and -clamp are not map_Kd's; give the same");
    }

    #[test]
    fn a_missing_image_does_not_affect_the_other() {
        let text = b"newmtl a\nmap_Kd c.png\nmap_d m.png\nnewmtl b\nKd 1 0 0\nmap_Kd c.png";
        let read = parse(text, Path::new("a.mtl")).unwrap();
        let grey = || Arc::new(Texels { width: 1, height: 1, rgba: vec![[half::f16::from_f32(0.25); 4]] });
        let with = |material: usize, there: &[&str]| {
            let mut missing = Vec::new();
            let find = |image: &Path| Ok(there.iter().any(|t| image == Path::new(t)).then(grey).ok_or(Absent::NoFile));
            let material = read[material].with_images(find, &mut missing, Limits::default()).unwrap();
            let texture = material.texture.as_ref().map(|t| (t.texels.rgba[0].map(half::f16::to_f32), t.cutoff));
            (
                material.diffuse,
                texture,
                missing.into_iter().map(|m| format!("{}: {}", m.what, m.why)).collect::<Vec<_>>(),
            )
        };
        let no_colour = "c.png: a.mtl:2: map_Kd: the file does not exist; the material's own colour is used".to_owned();
        let no_mask = "m.png: a.mtl:3: map_d: the file does not exist; nothing is masked".to_owned();
        assert_eq!(with(0, &[]), ([0.8; 3], None, vec![no_colour.clone(), no_mask.clone()]));
        assert_eq!(with(0, &["c.png"]), ([1.0; 3], Some(([0.25; 4], None)), vec![no_mask]));
        assert_eq!(with(0, &["m.png"]), ([0.8; 3], Some(([1.0, 1.0, 1.0, 0.25], Some(HALF))), vec![no_colour]));
        let (diffuse, texture, missing) = with(1, &[]);
        assert_eq!((diffuse, texture, missing.len()), ([1.0, 0.0, 0.0], None, 1));
    }

    #[test]
    fn malformed_text_names_file_and_line() {
        for (text, expected) in [
            ("Kd 1 1 1", "a.mtl:1: Kd before"),
            ("newmtl a\n\nKd 1 1", "a.mtl:3: Kd has 2 of 3"),
            ("newmtl a\nKd 1 x 1", "a.mtl:2: Kd value \"x\" is not"),
            ("newmtl a\nKd 1 nan 1", "a.mtl:2: Kd value \"nan\" is not"),
            ("map_Kd a.png", "a.mtl:1: map_Kd before"),
            ("newmtl a\nmap_Kd -s 1 1", "a.mtl:2: map_Kd without an image"),
        ] {
            let message = parse(text.as_bytes(), Path::new("a.mtl")).unwrap_err().to_string();
            assert!(message.starts_with(expected), "{message}");
        }
        let read = parse(b"newmtl a\n\nmap_Kd a.png", Path::new("a.mtl")).unwrap();
        let message = read[0]
            .with_images(|_| Err(Error::input("gone")), &mut Vec::new(), Limits::default())
            .unwrap_err()
            .to_string();
        assert_eq!(message, "a.mtl:3: map_Kd: gone; texture = false shows none");
    }
}
