//! Triangles through the adapter's rasterizer: into a picture of ids and depths, and from there into the visibility buffer.

use super::kernels;
use anamorph::internals::engine::rival::{Setup, Target};
use anamorph::internals::engine::stage::{Scopes, dispatch_items};
use anamorph::internals::gpu::Gpu;
use anamorph::internals::gpu::buffers::{Binder, Pipeline};
use anamorph::internals::gpu::compile::Module;
use anamorph::internals::gpu::kernels::Kernel;
use anamorph::internals::gpu::recorder::Recorder;
use anamorph::internals::gpu::recorder::drawing::DrawPass;
use anamorph::internals::input::{Error, Result};
use wgpu::{Extent3d, LoadOp, Operations, StoreOp, TextureFormat, TextureUsages};

/// Layer and id, and the bits of t.
const SEEN: TextureFormat = TextureFormat::Rg32Uint;
const DEPTH: TextureFormat = TextureFormat::Depth32Float;
/// The same of several samples a pixel, in halves: every adapter has this with multisampling.
const SEEN_SAMPLES: TextureFormat = TextureFormat::Rgba16Uint;
/// Bytes of a sample, of seen and depth.
const SAMPLE_BYTES: u64 = 12;

/// A render pipeline whose buffers and textures are bound by name.
pub struct Draw {
    binder: Binder,
    pub pipeline: wgpu::RenderPipeline,
}

impl Draw {
    /// Onto a render target of so many samples a pixel, the nearest last. The entry points are NAME_corner and NAME_pixel.
    pub fn new(gpu: &Gpu, kernel: Kernel, samples: u32) -> Draw {
        let nearest = wgpu::DepthStencilState {
            format: DEPTH,
            depth_write_enabled: Some(true),
            depth_compare: Some(wgpu::CompareFunction::Greater),
            stencil: Default::default(),
            bias: Default::default(),
        };
        Draw::onto(gpu, kernel, (seen_format(samples), samples), Some(nearest))
    }

    /// The same of a kernel that clips.
    ///
    /// # Errors
    /// [`Error::Work`] where the adapter cannot.
    pub fn clipped(gpu: &Gpu, kernel: Kernel, samples: u32) -> Result<Draw> {
        if gpu.has.clip_distances {
            return Ok(Draw::new(gpu, kernel, samples));
        }
        Err(Error::work(format!("adapter {} has no clip distances; use raytrace", gpu.info.name)))
    }

    pub fn onto(
        gpu: &Gpu,
        kernel: Kernel,
        (format, samples): (TextureFormat, u32),
        depth_stencil: Option<wgpu::DepthStencilState>,
    ) -> Draw {
        let device = &gpu.device;
        let name = kernel.name;
        let Module { module, bindings } = gpu.compile(&kernel);
        let constants = kernel.constants;
        let binder = Binder::new(device, name, bindings, wgpu::ShaderStages::VERTEX_FRAGMENT);
        let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(name),
            bind_group_layouts: &[Some(&binder.layout)],
            immediate_size: 0,
        });
        let compilation_options = wgpu::PipelineCompilationOptions { constants: &constants, ..Default::default() };
        let (corner, pixel) = (format!("{name}_corner"), format!("{name}_pixel"));
        let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(name),
            layout: Some(&layout),
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some(&corner),
                compilation_options: compilation_options.clone(),
                buffers: &[],
            },
            primitive: wgpu::PrimitiveState::default(),
            depth_stencil,
            multisample: wgpu::MultisampleState { count: samples, ..Default::default() },
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: Some(&pixel),
                compilation_options,
                targets: &[Some(format.into())],
            }),
            multiview_mask: None,
            cache: None,
        });
        Draw { binder, pipeline }
    }

    pub fn bind(&self, gpu: &Gpu, scopes: Scopes) -> Result<wgpu::BindGroup> {
        self.binder.bind(gpu, scopes, &[])
    }

    /// With a texture.
    pub fn bind_texture(
        &self,
        gpu: &Gpu,
        scopes: Scopes,
        texture: (&'static str, &wgpu::TextureView),
    ) -> Result<wgpu::BindGroup> {
        self.binder.bind(gpu, scopes, &[texture])
    }
}

/// The render target of rivals: an image, and the depth of the nearest fragment.
pub struct RasterTarget {
    seen: wgpu::TextureView,
    depth: wgpu::TextureView,
    size: (u32, u32),
    samples: u32,
}

fn seen_format(samples: u32) -> TextureFormat {
    if samples > 1 { SEEN_SAMPLES } else { SEEN }
}

/// A texture to draw on and to read.
pub fn texture(gpu: &Gpu, (width, height): (u32, u32), (format, samples): (TextureFormat, u32)) -> wgpu::TextureView {
    let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("raster_target"),
        size: Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: samples,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: TextureUsages::RENDER_ATTACHMENT | TextureUsages::TEXTURE_BINDING,
        view_formats: &[],
    });
    texture.create_view(&Default::default())
}

impl RasterTarget {
    pub fn new(gpu: &Gpu, size: (u32, u32), samples: u32) -> RasterTarget {
        let texture = |format| texture(gpu, size, (format, samples));
        RasterTarget { seen: texture(seen_format(samples)), depth: texture(DEPTH), size, samples }
    }

    /// A render pass over it; the first clears it.
    pub fn pass<'a>(&self, recorder: &'a mut Recorder, name: &'static str, is_first: bool) -> DrawPass<'a> {
        // NONE, of several samples in halves
        let [whole, half] = [u32::MAX.into(), u16::MAX.into()];
        let (r, g) = if self.samples > 1 { (half, half) } else { (whole, 0.0) };
        let nothing = wgpu::Color { r, g, b: 0.0, a: 0.0 };
        let seen = if is_first { LoadOp::Clear(nothing) } else { LoadOp::Load };
        let depth = if is_first { LoadOp::Clear(0.0) } else { LoadOp::Load };
        let colour = wgpu::RenderPassColorAttachment {
            view: &self.seen,
            depth_slice: None,
            resolve_target: None,
            ops: Operations { load: seen, store: StoreOp::Store },
        };
        let depth = wgpu::RenderPassDepthStencilAttachment {
            view: &self.depth,
            depth_ops: Some(Operations { load: depth, store: StoreOp::Store }),
            stencil_ops: None,
        };
        recorder.draw(name, &[Some(colour)], Some(depth))
    }

    pub fn seen(&self) -> &wgpu::TextureView {
        &self.seen
    }

    pub fn bytes(&self) -> u64 {
        SAMPLE_BYTES * u64::from(self.samples) * u64::from(self.size.0) * u64::from(self.size.1)
    }
}

/// A render target of the size of the largest band, whose image becomes the band's visibility buffer, and of several samples a pixel also its
/// records of samples.
pub struct BandRaster {
    pub raster_target: RasterTarget,
    take: Pipeline,
    width: u32,
}

impl BandRaster {
    pub fn new(gpu: &Gpu, setup: &Setup) -> Result<BandRaster> {
        let width = setup.camera.width;
        let samples = setup.variant.samples();
        let take = if samples > 1 { kernels::take_samples(setup.variant) } else { kernels::take(setup.variant) };
        let raster_target = RasterTarget::new(gpu, (width, setup.rows), samples);
        Ok(BandRaster { raster_target, take: Pipeline::new(gpu, take)?, width })
    }

    /// Brings a band from the picture to the visibility buffer.
    pub fn take(&self, gpu: &Gpu, recorder: &mut Recorder, band: &Target) -> Result<()> {
        let Some(chunk) = band.chunks.first() else { return Ok(()) };
        run(gpu, recorder, "take", (&self.take, &chunk.scopes, self.raster_target.seen()), self.width * band.rows)
    }
}

/// A kernel that reads a picture, for so many pixels.
pub fn run(
    gpu: &Gpu,
    recorder: &mut Recorder,
    name: &'static str,
    (pipeline, scopes, picture): (&Pipeline, Scopes, &wgpu::TextureView),
    pixels: u32,
) -> Result<()> {
    let group = pipeline.bind_textures(gpu, scopes, &[("picture", picture)])?;
    let mut pass = recorder.compute(name);
    pass.set_pipeline(pipeline.raw());
    pass.set_bind_group(0, &group, &[]);
    dispatch_items(gpu, &mut pass, pixels);
    Ok(())
}
