//! Pages: where the images on a scene's triangles lie in the layers of one texture, so that a kernel binds one however many there are.
//!
//! An image takes a block of a page: its first level, and the others in a row below it, or in a column right of it where it is
//! higher than wide.

use crate::arrays::MapEach;
use crate::geometry::mesh::Material;
use crate::geometry::texture::{Texels, Texture};
use crate::gpu::layout;
use crate::input::{Error, Result};
use std::collections::HashMap;
use std::sync::Arc;

/// An image in its place.
#[derive(Debug, Clone)]
pub struct Placed {
    pub texels: Arc<Texels>,
    /// It is an alpha mask: its opacity counts, and colours are stored times it.
    pub is_masked: bool,
    pub page: u32,
    /// Of its first level, texels.
    pub origin: [u32; 2],
}

/// All images in their places.
#[derive(Debug, Clone, Default)]
pub struct Pages {
    pub width: u32,
    pub height: u32,
    pub count: u32,
    pub images: Vec<Placed>,
    /// The image of each material.
    image_of: Vec<Option<usize>>,
}

/// What an adapter allows of a texture.
#[derive(Debug, Clone, Copy)]
pub struct PageLimits {
    /// Texels a side.
    pub side: u32,
    pub pages: u32,
}

impl PageLimits {
    pub fn of(limits: &wgpu::Limits) -> PageLimits {
        PageLimits { side: limits.max_texture_dimension_2d, pages: limits.max_texture_array_layers }
    }
}

impl Pages {
    /// Places the images of `materials`, each once; with an opacity that counts, and without, it is two.
    ///
    /// # Errors
    /// [`Error::Input`] naming a material whose image is larger than a page, or how many pages there would be.
    pub fn new(materials: &[Material], limits: PageLimits) -> Result<Pages> {
        let mut pages = Pages::default();
        let mut known: HashMap<(*const Texels, bool), usize> = HashMap::new();
        for material in materials {
            let Some(Texture { texels, cutoff, .. }) = &material.texture else {
                pages.image_of.push(None);
                continue;
            };
            let [width, height] = block(texels);
            if width.max(height) > limits.side {
                let (name, side) = (&material.name, limits.side);
                let size = format!("{} x {}", texels.width, texels.height);
                return Err(Error::input(format!(
                    "material {name:?}: its image of {size} takes {width} x {height} texels with its levels, the adapter has {side} a side; make it smaller"
                )));
            }
            let index = *known.entry((Arc::as_ptr(texels), cutoff.is_some())).or_insert_with(|| {
                pages.images.push(Placed {
                    texels: texels.clone(),
                    is_masked: cutoff.is_some(),
                    page: 0,
                    origin: [0; 2],
                });
                pages.images.len() - 1
            });
            pages.image_of.push(Some(index));
        }
        pages.place(limits)?;
        Ok(pages)
    }

    /// Shelf by shelf, the highest blocks first.
    fn place(&mut self, limits: PageLimits) -> Result<()> {
        let area: f64 = self.images.iter().map(|i| block(&i.texels).map_each(f64::from)).map(|[w, h]| w * h).sum();
        let widest = self.images.iter().map(|i| block(&i.texels)[0]).max().unwrap_or(1);
        // as wide as high, about
        self.width = (area.sqrt().ceil() as u32).clamp(widest, limits.side.max(widest));
        let mut order: Vec<usize> = (0..self.images.len()).collect();
        order.sort_by_key(|k| std::cmp::Reverse(block(&self.images[*k].texels)[1]));
        let (mut page, mut x, mut y, mut shelf) = (0, 0, 0, 0);
        for k in order {
            let [width, height] = block(&self.images[k].texels);
            if x + width > self.width {
                (x, y, shelf) = (0, y + shelf, 0);
            }
            if y + height > limits.side {
                (page, x, y, shelf) = (page + 1, 0, 0, 0);
            }
            (self.images[k].page, self.images[k].origin) = (page, [x, y]);
            (x, shelf) = (x + width, shelf.max(height));
            self.height = self.height.max(y + height);
        }
        self.count = page + 1;
        if self.count > limits.pages {
            let (count, most, side) = (self.count, limits.pages, limits.side);
            return Err(Error::input(format!(
                "the scene's images take {count} pages of {side} texels a side, the adapter has {most}; use fewer or smaller ones"
            )));
        }
        Ok(())
    }

    /// The same images in the same places, whatever materials show them.
    pub fn has_the_images_of(&self, other: &Pages) -> bool {
        let place = |p: &Placed| (Arc::as_ptr(&p.texels), p.is_masked, p.page, p.origin);
        let size = |p: &Pages| [p.width, p.height, p.count];
        size(self) == size(other) && self.images.iter().map(place).eq(other.images.iter().map(place))
    }

    /// A material as kernels read it; `index` is its own.
    pub fn packed(&self, index: usize, material: &Material) -> layout::Material {
        let plain = layout::Material {
            diffuse: material.diffuse,
            texture: layout::NONE,
            origin: [0; 2],
            size: [0; 2],
            page: 0,
            levels: 0,
            span: 0,
            cutoff: 0.0,
            specular: material.specular,
            alpha: material.alpha(),
            emissive: material.emissive,
            metallic: material.metallic,
            pattern_light: material.pattern.map_or([1.0; 3], |p| p.light),
            pattern: material.pattern.map_or(0, |p| p.kind as u32),
            pattern_dark: material.pattern.map_or([1.0; 3], |p| p.dark),
            pattern_size: material.pattern.map_or(1.0, |p| p.size as f32),
            opacity: material.blend.unwrap_or(1.0),
            is_blended: material.blend.is_some().into(),
            pad0: 0,
            pad1: 0,
        };
        let placed = self.image_of.get(index).copied().flatten().map(|k| &self.images[k]);
        let (Some(placed), Some(texture)) = (placed, &material.texture) else { return plain };
        let Texels { width, height, .. } = *placed.texels;
        let [right, down] = texture.wrap.map_each(|w| w as u32);
        layout::Material {
            texture: right | down << 2,
            origin: placed.origin,
            size: [width, height],
            page: placed.page,
            levels: levels(&placed.texels),
            span: width.max(height).next_power_of_two(),
            cutoff: texture.least().map_or(0.0, f32::from),
            ..plain
        }
    }
}

/// Levels of an image, each half as large as the one before, down to one texel.
pub fn levels(texels: &Texels) -> u32 {
    texels.width.max(texels.height).ilog2() + 1
}

/// The size of a level.
pub fn level_size(texels: &Texels, level: u32) -> [u32; 2] {
    [texels.width, texels.height].map_each(|n| (n >> level).max(1))
}

/// Where a level stands within its image's block: `level_origin` of the WGSL.
pub fn level_place(texels: &Texels, level: u32) -> [u32; 2] {
    let Texels { width, height, .. } = *texels;
    if level == 0 {
        return [0; 2];
    }
    let span = width.max(height).next_power_of_two();
    let offset = span - (span >> (level - 1));
    if width >= height { [offset, height] } else { [width, offset] }
}

/// Texels that all levels of an image take together.
fn block(texels: &Texels) -> [u32; 2] {
    let ends = (0..levels(texels)).map(|l| {
        let (at, size) = (level_place(texels, l), level_size(texels, l));
        [at[0] + size[0], at[1] + size[1]]
    });
    ends.fold([0; 2], |most, end| [most[0].max(end[0]), most[1].max(end[1])])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn image(width: u32, height: u32) -> Arc<Texels> {
        Arc::new(Texels { width, height, rgba: Vec::new() })
    }

    fn material(texels: &Arc<Texels>, cutoff: Option<f32>) -> Material {
        Material { texture: Some(Texture { cutoff, ..Texture::new(texels.clone()) }), ..Material::default() }
    }

    /// Every level of every image, as page, corner and size.
    fn rectangles(pages: &Pages) -> Vec<(u32, [u32; 2], [u32; 2])> {
        let level = |i: &Placed, l: u32| {
            let at = level_place(&i.texels, l);
            (i.page, [i.origin[0] + at[0], i.origin[1] + at[1]], level_size(&i.texels, l))
        };
        pages.images.iter().flat_map(|i| (0..levels(&i.texels)).map(move |l| level(i, l))).collect()
    }

    #[test]
    fn levels_overlap_nowhere_and_stay_on_their_pages() {
        let sizes = [(1, 1), (1, 37), (640, 3), (64, 64), (65, 64), (63, 65), (100, 200), (2, 1), (128, 5)];
        let images: Vec<_> = sizes.iter().cycle().take(200).map(|&(w, h)| image(w, h)).collect();
        let materials: Vec<Material> = images.iter().map(|i| material(i, None)).collect();
        for limits in [PageLimits { side: 4096, pages: 1 }, PageLimits { side: 1024, pages: 16 }] {
            let pages = Pages::new(&materials, limits).unwrap();
            assert!(pages.width <= limits.side && pages.height <= limits.side);
            assert_eq!(pages.count > 1, limits.side == 1024);
            let all = rectangles(&pages);
            for (k, (page, at, size)) in all.iter().enumerate() {
                assert!(at[0] + size[0] <= pages.width && at[1] + size[1] <= pages.height && *page < pages.count);
                for (other, b, s) in &all[..k] {
                    let disjoint = (0..2).any(|n| at[n] + size[n] <= b[n] || b[n] + s[n] <= at[n]);
                    assert!(page != other || disjoint, "{at:?} {size:?} and {b:?} {s:?}");
                }
            }
        }
    }

    #[test]
    fn an_image_is_there_once_for_all_that_show_it_alike() {
        let (a, b) = (image(8, 8), image(8, 8));
        let materials =
            [material(&a, None), Material::default(), material(&b, None), material(&a, None), material(&a, Some(0.5))];
        let pages = Pages::new(&materials, PageLimits { side: 64, pages: 1 }).unwrap();
        assert_eq!(pages.image_of, [Some(0), None, Some(1), Some(0), Some(2)]);
    }

    #[test]
    fn what_does_not_fit_says_so() {
        let wrong = |images: &[Arc<Texels>], limits| {
            let materials: Vec<Material> = images.iter().map(|i| material(i, None)).collect();
            Pages::new(&materials, limits).unwrap_err().to_string()
        };
        let message = wrong(&[image(64, 64)], PageLimits { side: 64, pages: 9 });
        assert!(message.starts_with("material \"default\": its image of 64 x 64 takes 64 x 96 texels"), "{message}");
        let message = wrong(&[image(64, 32), image(64, 32)], PageLimits { side: 64, pages: 1 });
        assert!(message.starts_with("the scene's images take 2 pages of 64 texels a side"), "{message}");
    }
}
