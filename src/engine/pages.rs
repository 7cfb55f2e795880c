//! The images on a scene's triangles, put on the device with all their levels.

use crate::engine::plan::pages::{PageLimits, Pages, Placed, level_place, level_size, levels};
use crate::engine::stage::dispatch_items;
use crate::geometry::mesh::Material;
use crate::geometry::texture::Texels;
use crate::gpu::Gpu;
use crate::gpu::buffers::{Buffers, Pipeline};
use crate::gpu::kernels::Kernel;
use crate::input::Result;
use crate::parallel;
use half::f16;
use std::borrow::Cow;
use std::sync::{Mutex, PoisonError};

const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;

/// Bytes of a texel: four half floats.
const TEXEL_BYTES: u32 = 8;

/// The images that were last put on the device, for all frames that show the same ones.
#[derive(Default)]
pub struct PageStore {
    state: Mutex<PageStoreState>,
}

#[derive(Default)]
struct PageStoreState {
    pipeline: Option<Pipeline>,
    last: Option<(Pages, wgpu::Texture)>,
}

impl PageStore {
    /// The images of `materials` in their places, all levels of which `buffers` then has; those that are there already are not made
    /// again.
    ///
    /// # Errors
    /// Those of [`Pages::new`].
    pub fn place(&self, gpu: &Gpu, materials: &[Material], buffers: &mut Buffers) -> Result<Pages> {
        let pages = Pages::new(materials, PageLimits::of(&gpu.limits))?;
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        let PageStoreState { pipeline, last } = &mut *state;
        let known =
            last.as_ref().filter(|(known, _)| known.has_the_images_of(&pages)).map(|(_, texture)| texture.clone());
        let target = match known {
            Some(known) => known,
            None => {
                let usage = wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST;
                let size = [pages.width.max(1), pages.height.max(1), pages.count.max(1)];
                let target = texture(gpu, "pages", size, 1, usage);
                let pipeline = match pipeline {
                    Some(pipeline) => pipeline,
                    None => pipeline.insert(Pipeline::new(gpu, Kernel::alone("mip.wgsl"))?),
                };
                pages.images.iter().try_for_each(|image| put(gpu, pipeline, image, &target))?;
                *last = Some((pages.clone(), target.clone()));
                target
            }
        };
        buffers.place_texture("pages", &target, wgpu::TextureViewDimension::D2Array);
        Ok(pages)
    }
}

/// Makes an image's levels and puts them in their places.
fn put(gpu: &Gpu, mip: &Pipeline, image: &Placed, target: &wgpu::Texture) -> Result<()> {
    let Texels { width, height, .. } = *image.texels;
    let usage = wgpu::TextureUsages::TEXTURE_BINDING
        | wgpu::TextureUsages::STORAGE_BINDING
        | wgpu::TextureUsages::COPY_SRC
        | wgpu::TextureUsages::COPY_DST;
    let count = levels(&image.texels);
    let all = texture(gpu, "levels", [width, height, 1], count, usage);
    let shown = shown(image);
    gpu.queue.write_texture(
        all.as_image_copy(),
        bytemuck::cast_slice(shown.as_flattened()),
        wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(TEXEL_BYTES * width), rows_per_image: None },
        all.size(),
    );
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    let view = |level: u32| {
        all.create_view(&wgpu::TextureViewDescriptor {
            base_mip_level: level,
            mip_level_count: Some(1),
            ..Default::default()
        })
    };
    for level in 1..count {
        let (finer, coarser) = (view(level - 1), view(level));
        let group = mip.bind_textures(gpu, &[], &[("finer", &finer), ("coarser", &coarser)])?;
        let mut pass = encoder.begin_compute_pass(&Default::default());
        pass.set_pipeline(mip.raw());
        pass.set_bind_group(0, &group, &[]);
        let [w, h] = level_size(&image.texels, level);
        dispatch_items(gpu, &mut pass, w * h);
    }
    for level in 0..count {
        let ([x, y], [w, h]) = (level_place(&image.texels, level), level_size(&image.texels, level));
        let from = wgpu::TexelCopyTextureInfo { mip_level: level, ..all.as_image_copy() };
        let origin = wgpu::Origin3d { x: image.origin[0] + x, y: image.origin[1] + y, z: image.page };
        let to = wgpu::TexelCopyTextureInfo { origin, ..target.as_image_copy() };
        encoder.copy_texture_to_texture(from, to, wgpu::Extent3d { width: w, height: h, depth_or_array_layers: 1 });
    }
    gpu.queue.submit([encoder.finish()]);
    Ok(())
}

/// Texels as kernels read them: opaque, or colours times their opacity.
fn shown(image: &Placed) -> Cow<'_, [[f16; 4]]> {
    let rgba = &image.texels.rgba;
    let opaque = |[r, g, b, _]: &[f16; 4]| [*r, *g, *b, f16::ONE];
    let premultiplied = |[r, g, b, a]: &[f16; 4]| [*r * *a, *g * *a, *b * *a, *a];
    match (image.is_masked, !parallel::any(rgba, |t| t[3] != f16::ONE)) {
        (_, true) => Cow::Borrowed(rgba),
        (true, false) => parallel::map(rgba, premultiplied).into(),
        (false, false) => parallel::map(rgba, opaque).into(),
    }
}

fn texture(
    gpu: &Gpu,
    label: &str,
    [width, height, layers]: [u32; 3],
    levels: u32,
    usage: wgpu::TextureUsages,
) -> wgpu::Texture {
    gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some(label),
        size: wgpu::Extent3d { width, height, depth_or_array_layers: layers },
        mip_level_count: levels,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: FORMAT,
        usage,
        view_formats: &[],
    })
}
