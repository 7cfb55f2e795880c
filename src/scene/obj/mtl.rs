//! MTL: the diffuse colours of an OBJ's materials, and the images that these are multiplied by.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::Vec2;

use super::lex::{Lines, Words, parse_f64, quoted};
use crate::error::{Error, Result};
use crate::scene::mesh::Material;
use crate::scene::texture::{Images, Texels, Texture, Wrap, with_opacity};

/// A material, and how its texture coordinates lie in its image: times the scale, and moved.
pub struct Mapped {
    pub material: Material,
    pub scale: Vec2,
    pub offset: Vec2,
}

/// Reads what a `mtllib` line names in `folder`: one file whose name may have blanks in it, or else several
/// files. `None` where none of them exists.
///
/// # Errors
/// [`Error::Input`] if a file cannot be read or is malformed.
pub(super) fn load(folder: &Path, library: &str, images: &mut Images) -> Result<Option<Vec<Mapped>>> {
    let find = |name: &str| -> Option<PathBuf> {
        [name.to_owned(), name.replace('\\', "/")].iter().map(|name| folder.join(name)).find(|path| path.is_file())
    };
    let files: Vec<PathBuf> = match find(library) {
        Some(file) => vec![file],
        None => library.split_whitespace().filter_map(find).collect(),
    };
    if files.is_empty() {
        return Ok(None);
    }
    let mut materials = Vec::new();
    for file in files {
        let name = file.display().to_string();
        let text = std::fs::read(&file).map_err(|e| Error::input(format!("{name}: cannot be read: {e}")))?;
        let folder = file.parent().unwrap_or(Path::new(""));
        materials.extend(parse(&text, &name, |image| match images.are_left_out() {
            true => Ok(None),
            false => images.load(&folder.join(image.replace('\\', "/"))).map(Some),
        })?);
    }
    Ok(Some(materials))
}

/// Parses MTL text: names; `Kd`, `Ks` and `Ke` as linear RGB, the first two clamped to [0, 1]; `Ns`, and `illum`, below 2 of which
/// nothing shines; `map_Kd`, by whose image that is multiplied, and `map_d`, where
/// there is no surface, with their options `-clamp`, `-o` and `-s`. `load_image` is asked for each image by its name, and
/// answers `None` where images are left out. Materials with an image but no `Kd` are white, those with neither keep the default
/// colour; a `Kd` given as a spectrum or in XYZ is skipped.
///
/// # Errors
/// [`Error::Input`] naming `name` and the line.
pub(super) fn parse(
    text: &[u8],
    name: &str,
    mut load_image: impl FnMut(&str) -> Result<Option<Arc<Texels>>>,
) -> Result<Vec<Mapped>> {
    let text = text.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(text);
    let mut materials: Vec<Reading> = Vec::new();
    for (number, line) in Lines::new(text) {
        let wrong = |message: String| Error::input(format!("{name}:{}: {message}", number + 1));
        let mut words = Words::new(&line);
        match words.next().unwrap_or_default() {
            b"newmtl" => {
                let name = words.name();
                if name.is_empty() {
                    return Err(wrong("newmtl without a name; give one".into()));
                }
                materials.push(Reading { name, ..Reading::default() });
            }
            key @ (b"Kd" | b"Ks" | b"Ke" | b"Ns" | b"illum" | b"map_Kd" | b"map_d") => {
                let key = String::from_utf8_lossy(key);
                let Some(material) = materials.last_mut() else {
                    return Err(wrong(format!("{key} before the first newmtl; name the material first")));
                };
                let colour = |most| parse_colour(words.clone(), &key, most).map_err(wrong);
                let number = || parse_number(words.clone(), &key).map_err(wrong);
                match &*key {
                    "Kd" => material.diffuse = colour(1.0)?.or(material.diffuse),
                    "Ks" => material.specular = colour(1.0)?.unwrap_or(material.specular),
                    "Ke" => material.emissive = colour(f64::INFINITY)?.unwrap_or(material.emissive),
                    "Ns" => material.exponent = number()?,
                    "illum" => material.is_matte = number()? < 2.0,
                    _ => {}
                }
                if !key.starts_with("map") {
                    continue;
                }
                let map = parse_map(words, &key).map_err(&wrong)?;
                let image = load_image(&map.image).map_err(|e| wrong(format!("{key}: {e}")))?;
                let to = if key == "map_d" { &mut material.mask } else { &mut material.map };
                *to = image.map(|image| (map, image));
            }
            _ => {}
        }
    }
    Ok(materials.into_iter().map(Reading::finish).collect())
}

/// A material as far as it has been read.
#[derive(Default)]
struct Reading {
    name: String,
    diffuse: Option<[f32; 3]>,
    specular: [f32; 3],
    emissive: [f32; 3],
    /// Of Phong's highlight.
    exponent: f64,
    /// Its model of light has no highlight.
    is_matte: bool,
    map: Option<(Map, Arc<Texels>)>,
    mask: Option<(Map, Arc<Texels>)>,
}

/// What an image's line says.
struct Map {
    image: String,
    clamp: bool,
    scale: Vec2,
    offset: Vec2,
}

/// The least opacity at which a material with a mask is there.
const CUTOFF: f32 = 0.5;

impl Reading {
    fn finish(self) -> Mapped {
        let colours = self.map.as_ref().map(|(_, texels)| texels.clone());
        let cutoff = self.mask.as_ref().map(|_| CUTOFF);
        let texels = match (&colours, &self.mask) {
            (Some(colours), Some((_, mask))) => Some(Arc::new(with_opacity(colours, mask))),
            // as many texels as the mask, all white
            (None, Some((_, mask))) => {
                let rgba = vec![[half::f16::ONE; 4]; mask.rgba.len()];
                let white = Texels { width: mask.width, height: mask.height, rgba };
                Some(Arc::new(with_opacity(&white, mask)))
            }
            (colours, None) => colours.clone(),
        };
        let map = self.map.as_ref().or(self.mask.as_ref()).map(|(map, _)| map);
        let wrap = if map.is_some_and(|m| m.clamp) { Wrap::Clamp } else { Wrap::Repeat };
        let plain = if colours.is_some() { [1.0; 3] } else { Material::default().diffuse };
        let material = Material {
            name: self.name,
            diffuse: self.diffuse.unwrap_or(plain),
            specular: if self.is_matte { [0.0; 3] } else { self.specular },
            // microfacets of alpha^2 = 2 / (Ns + 2) are about as wide as Phong's highlight (Walter et al. 2007)
            roughness: (2.0 / (self.exponent.max(0.0) + 2.0)).powf(0.25) as f32,
            emissive: self.emissive,
            texture: texels.map(|texels| Texture { texels, wrap: [wrap; 2], cutoff }),
            ..Material::default()
        };
        let (scale, offset) = map.map_or((Vec2::ONE, Vec2::ZERO), |m| (m.scale, m.offset));
        Mapped { material, scale, offset }
    }
}

/// Options, and the rest of the line as the image's name.
fn parse_map(mut words: Words, key: &str) -> std::result::Result<Map, String> {
    let mut map = Map { image: String::new(), clamp: false, scale: Vec2::ONE, offset: Vec2::ZERO };
    loop {
        let mut ahead = words.clone();
        match ahead.next() {
            Some(option) if option.len() > 1 && option[0] == b'-' => {
                words = ahead;
                let count = match option {
                    b"-o" | b"-s" | b"-t" => {
                        let values = take_numbers(&mut words);
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
                        map.clamp = words.next() == Some(b"on");
                        0
                    }
                    b"-mm" => 2,
                    _ => 1,
                };
                words.by_ref().take(count).for_each(drop);
            }
            Some(_) => break,
            None => return Err(format!("{key} without an image; name one")),
        }
    }
    map.image = words.name();
    Ok(map)
}

/// Up to three numbers, as many as there are.
fn take_numbers(words: &mut Words) -> Vec<f32> {
    let mut values = Vec::new();
    while values.len() < 3 {
        let mut ahead = words.clone();
        match ahead.next().and_then(parse_f64).filter(|v| v.is_finite()) {
            Some(value) => values.push(value as f32),
            None => break,
        }
        *words = ahead;
    }
    values
}

fn parse_number(mut words: Words, key: &str) -> std::result::Result<f64, String> {
    let word = words.next().unwrap_or_default();
    let value = parse_f64(word).filter(|v| v.is_finite());
    value.ok_or_else(|| format!("{key} value {} is not a finite number", quoted(word)))
}

/// `r g b`, or `r` alone for a grey, from 0 to `most`.
fn parse_colour(words: Words, key: &str, most: f64) -> std::result::Result<Option<[f32; 3]>, String> {
    let mut values = Vec::new();
    for word in words.take(3) {
        if matches!(word, b"spectral" | b"xyz") {
            return Ok(None);
        }
        match parse_f64(word) {
            Some(value) if value.is_finite() => values.push(value.clamp(0.0, most) as f32),
            _ => return Err(format!("{key} value {} is not a finite number", quoted(word))),
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
        let materials = parse(text, "a.mtl", |_| Ok(None)).unwrap();
        let found: Vec<_> = materials.iter().map(|m| (m.material.name.as_str(), m.material.diffuse)).collect();
        assert_eq!(found, [("red wall", [0.5, 0.25, 1.0]), ("g", [0.5; 3]), ("s", [0.8; 3])]);
    }

    #[test]
    fn images_with_their_options() {
        let text = b"newmtl a\nmap_Kd -s 2 3 1 -clamp on -o 0.5 -mm 0 1 -blendu off my image.png\nnewmtl b\nKd 1 0 0\nmap_d m.png\nnewmtl c\nKd 0 1 0";
        let mut asked = Vec::new();
        let grey =
            |v: f32| Arc::new(Texels { width: 1, height: 1, rgba: vec![[v, v, v, 1.0].map(half::f16::from_f32)] });
        let materials = parse(text, "a.mtl", |image| {
            asked.push(image.to_owned());
            Ok(Some(grey(0.25)))
        })
        .unwrap();
        assert_eq!(asked, ["my image.png", "m.png"]);
        let [a, b, c] = &materials[..] else { panic!("three") };
        let texture = |m: &Mapped| m.material.texture.clone();
        assert_eq!((a.scale, a.offset), (Vec2::new(2.0, 3.0), Vec2::new(0.5, 0.0)));
        assert_eq!(a.material.diffuse, [1.0; 3]);
        assert_eq!(texture(a), Some(Texture { wrap: [Wrap::Clamp; 2], ..Texture::new(grey(0.25)) }));
        let cut = texture(b).unwrap();
        assert_eq!((cut.cutoff, cut.texels.rgba[0][0]), (Some(0.5), half::f16::ONE));
        // 0.25 of linear light is 0.537 in sRGB
        assert!((cut.texels.rgba[0][3].to_f64() - 0.537).abs() < 1e-3);
        assert_eq!(texture(c), None);
    }

    #[test]
    fn malformed_text_names_file_and_line() {
        for (text, expected) in [
            ("Kd 1 1 1", "a.mtl:1: Kd before"),
            ("newmtl\n", "a.mtl:1: newmtl without"),
            ("newmtl a\n\nKd 1 1", "a.mtl:3: Kd has 2 of 3"),
            ("newmtl a\nKd 1 x 1", "a.mtl:2: Kd value \"x\" is not"),
            ("newmtl a\nKd 1 nan 1", "a.mtl:2: Kd value \"nan\" is not"),
            ("map_Kd a.png", "a.mtl:1: map_Kd before"),
            ("newmtl a\nmap_Kd -s 1 1", "a.mtl:2: map_Kd without an image"),
            ("newmtl a\n\nmap_Kd a.png", "a.mtl:3: map_Kd: gone"),
        ] {
            let parsed = parse(text.as_bytes(), "a.mtl", |_| Err(Error::input("gone")));
            let message = parsed.err().unwrap().to_string();
            assert!(message.starts_with(expected), "{message}");
        }
    }
}
