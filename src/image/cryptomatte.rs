//! Cryptomatte: the objects or materials in a pixel and their shares (Friedman and Jones 2015, specification 1.2.0).

use crate::image::frame::NO_ID;
use crate::input::{Error, Result};
use indexmap::IndexSet;
use std::collections::BTreeMap;

/// What a matte distinguishes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MatteKind {
    Objects,
    Materials,
}

impl MatteKind {
    /// Prefix of the EXR layers.
    fn layer(self) -> &'static str {
        match self {
            MatteKind::Objects => "CryptoObject",
            MatteKind::Materials => "CryptoMaterial",
        }
    }
}

/// Most names per pixel: two per layer.
const RANKS: usize = 6;

/// Sample counts per pixel and name.
#[derive(Debug)]
pub struct Matte {
    kind: MatteKind,
    names: Vec<String>,
    /// Index of each triangle's name.
    name_of: Vec<u32>,
    samples: u32,
    /// Per pixel: name indices and their sample counts.
    shares: Vec<Vec<(u32, u32)>>,
}

/// Named planes and attributes of an EXR.
pub struct Layers {
    pub planes: Vec<(String, Vec<f32>)>,
    pub attributes: Vec<(String, String)>,
}

impl Matte {
    /// `name_of` gives each triangle's index into `names`. With `optics`, triangle ids beyond `name_of` get the name [`OPTICS`].
    pub fn new(kind: MatteKind, names: Vec<String>, mut name_of: Vec<u32>, optics: bool) -> Matte {
        let mut once = IndexSet::new();
        let merged: Vec<u32> = names.into_iter().map(|name| once.insert_full(name).0 as u32).collect();
        name_of.iter_mut().for_each(|k| *k = merged[*k as usize]);
        let names = once.into_iter().chain(optics.then(|| OPTICS.into())).collect();
        Matte { kind, names, name_of, samples: 0, shares: Vec::new() }
    }

    /// Adds one sample of every pixel: triangle ids, row by row, [`NO_ID`] for a miss.
    pub fn add(&mut self, ids: &[u32]) {
        self.shares.resize(ids.len(), Vec::new());
        self.samples += 1;
        for (shares, &id) in self.shares.iter_mut().zip(ids).filter(|(_, id)| **id != NO_ID) {
            let name = self.name_of.get(id as usize).copied().unwrap_or(self.names.len() as u32 - 1);
            match shares.iter_mut().find(|(own, _)| *own == name) {
                Some((_, count)) => *count += 1,
                None => shares.push((name, 1)),
            }
        }
    }

    /// The layers, names ranked by their share, and the manifest attributes of the specification.
    pub fn layers(mut self) -> Result<Layers> {
        let hashes: Vec<u32> = self.names.iter().map(|name| hash(name)).collect::<Result<_>>()?;
        // of equal shares the smaller hash comes first
        self.shares
            .iter_mut()
            .for_each(|s| s.sort_unstable_by_key(|&(k, n)| (std::cmp::Reverse(n), hashes[k as usize])));
        let layer = self.kind.layer();
        let mut planes = Vec::new();
        for rank in 0..RANKS {
            let number = rank / 2;
            let [id, share] = if rank % 2 == 0 { ["R", "G"] } else { ["B", "A"] };
            let of = |f: fn(&(u32, u32), &[u32], u32) -> f32| -> Vec<f32> {
                let value = |s: &Vec<(u32, u32)>| s.get(rank).map_or(0.0, |share| f(share, &hashes, self.samples));
                self.shares.iter().map(value).collect()
            };
            planes.push((format!("{layer}{number:02}.{id}"), of(|h, hashes, _| f32::from_bits(hashes[h.0 as usize]))));
            planes.push((format!("{layer}{number:02}.{share}"), of(|h, _, samples| h.1 as f32 / samples as f32)));
        }
        let manifest: BTreeMap<&str, String> =
            self.names.iter().zip(&hashes).map(|(name, hash)| (name.as_str(), format!("{hash:08x}"))).collect();
        let manifest = serde_json::to_string(&manifest).map_err(|e| Error::work(format!("names as JSON: {e}")))?;
        let own = format!("cryptomatte/{}", &format!("{:08x}", hash(layer)?)[..7]);
        let attributes = [
            ("name", layer.to_owned()),
            ("hash", "MurmurHash3_32".into()),
            ("conversion", "uint32_to_float32".into()),
            ("manifest", manifest),
        ];
        let attributes = attributes.into_iter().map(|(key, text)| (format!("{own}/{key}"), text)).collect();
        Ok(Layers { planes, attributes })
    }
}

/// Name of the camera's mirror or lens, whose facets follow the scene's triangles.
pub const OPTICS: &str = "optics";

/// A name's id: 32-bit MurmurHash3, with the exponent changed where the float would not be a normal number.
fn hash(name: &str) -> Result<u32> {
    let hash = murmur3::murmur3_32(&mut name.as_bytes(), 0).map_err(|e| Error::work(format!("{name}: {e}")))?;
    let exponent = hash >> 23 & 255;
    Ok(if exponent == 0 || exponent == 255 { hash ^ 1 << 23 } else { hash })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hashes_are_the_specification_s() {
        // published values of MurmurHash3
        assert_eq!(hash("hello").unwrap(), 0x248b_fa47);
        assert_eq!(hash("hello, world").unwrap(), 0x149b_bb7f);
        // the hash of the empty name is 0, not a normal number
        assert_eq!(hash("").unwrap(), 1 << 23);
        for name in (0..20_000).map(|k| k.to_string()) {
            assert!(f32::from_bits(hash(&name).unwrap()).is_normal());
        }
    }

    #[test]
    fn shares_are_those_of_the_samples() {
        // two balls of 20 triangles, one after the other, and a mirror
        let names = vec!["left".into(), "icosphere".into()];
        let mut objects = Matte::new(MatteKind::Objects, names, [[0; 20], [1; 20]].concat(), true);
        let mut materials =
            Matte::new(MatteKind::Materials, vec!["default".into(); 2], [[0; 20], [1; 20]].concat(), true);
        for ids in [[3, 25, NO_ID, 40], [25, 25, NO_ID, 7], [26, 39, NO_ID, 7], [NO_ID, 0, NO_ID, 7]] {
            objects.add(&ids);
            materials.add(&ids);
        }
        let layers = objects.layers().unwrap();
        let plane = |name: &str| layers.planes.iter().find(|p| p.0 == name).unwrap().1.clone();
        let [left, right, optics] = ["left", "icosphere", OPTICS].map(|name| f32::from_bits(hash(name).unwrap()));
        assert_eq!(plane("CryptoObject00.R"), [right, right, 0.0, left]);
        assert_eq!(plane("CryptoObject00.G"), [0.5, 0.75, 0.0, 0.75]);
        assert_eq!(plane("CryptoObject00.B"), [left, left, 0.0, optics]);
        assert_eq!(plane("CryptoObject00.A"), [0.25, 0.25, 0.0, 0.25]);
        assert_eq!(layers.planes.len(), 12);
        assert!(layers.planes[4..].iter().all(|p| p.1 == [0.0; 4]));
        let layers = materials.layers().unwrap();
        assert_eq!(layers.planes[1], ("CryptoMaterial00.G".into(), vec![0.75, 1.0, 0.0, 0.75]));
        let manifest = &layers.attributes.iter().find(|a| a.0.ends_with("/manifest")).unwrap().1;
        assert!(manifest.contains(&format!("\"default\":\"{:08x}\"", hash("default").unwrap())), "{manifest}");
    }
}
