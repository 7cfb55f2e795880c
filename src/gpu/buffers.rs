//! Buffers by name, pipelines by kernel, and the bind groups that join the two.

use super::compile::Module;
use super::device::{Gpu, one_line};
use super::kernels::{Access, Binding, Kernel, storage_buffers};
use super::layout::TEXELS_A_ROW;
use crate::input::{Error, Result};
use std::collections::{BTreeMap, HashMap};
use std::ops::Range;
use std::sync::{Arc, Mutex, PoisonError};

/// Buffers and textures of one lifetime (a scene's chunk, a band, a frame), by the names that kernels know them by.
#[derive(Default)]
pub struct Buffers {
    buffers: BTreeMap<&'static str, wgpu::Buffer>,
    textures: BTreeMap<&'static str, Texture>,
}

struct Texture {
    texture: wgpu::Texture,
    view: wgpu::TextureView,
    bytes: u64,
}

/// Bytes of a texel of a table.
const TEXEL_BYTES: u32 = 16;

/// Sends rows of a table. `bytes` are all of its bytes; the last row ends in zeros.
fn write_rows(gpu: &Gpu, texture: &wgpu::Texture, bytes: &[u8], rows: Range<u32>) {
    let row_bytes = TEXEL_BYTES * TEXELS_A_ROW;
    let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(row_bytes), rows_per_image: None };
    let write = |bytes: &[u8], y: u32| {
        let to = wgpu::TexelCopyTextureInfo { origin: wgpu::Origin3d { x: 0, y, z: 0 }, ..texture.as_image_copy() };
        let height = bytes.len() as u32 / row_bytes;
        let size = wgpu::Extent3d { width: TEXELS_A_ROW, height, depth_or_array_layers: 1 };
        gpu.queue.write_texture(to, bytes, layout, size);
    };
    let own = &bytes[(rows.start * row_bytes) as usize..bytes.len().min((rows.end * row_bytes) as usize)];
    let (full, rest) = own.split_at(own.len() / row_bytes as usize * row_bytes as usize);
    if !full.is_empty() {
        write(full, rows.start);
    }
    if !rest.is_empty() {
        let mut last = rest.to_vec();
        last.resize(row_bytes as usize, 0);
        write(&last, rows.start + full.len() as u32 / row_bytes);
    }
}

/// Bytes of a buffer that are sent together where one of them changed.
const BLOCK_BYTES: usize = 1 << 12;

/// The blocks of so many bytes that hold ascending ranges of items, joined where they touch.
fn blocks_of<T>(ranges: &[Range<usize>], count: usize, bytes: usize) -> Vec<Range<usize>> {
    let mut blocks: Vec<Range<usize>> = Vec::new();
    for range in ranges {
        let (start, end) =
            (range.start * size_of::<T>() / bytes, (range.end.min(count) * size_of::<T>()).div_ceil(bytes));
        match blocks.last_mut() {
            Some(last) if start <= last.end => last.end = last.end.max(end),
            _ => blocks.push(start..end),
        }
    }
    blocks
}

/// Rows of a table that are sent at once: 32 MiB.
const ROWS_A_WRITE: u32 = 512;

/// A table of triangles may be as many times as large as a binding: the buffers that go with it, slots of ids and boxes of triangle groups, have a
/// twelfth of its bytes.
const BINDINGS_A_TABLE: u64 = 8;

/// What every buffer may be used for: kernels see it, the host writes, clears and copies it.
const USAGE: wgpu::BufferUsages =
    wgpu::BufferUsages::STORAGE.union(wgpu::BufferUsages::COPY_SRC).union(wgpu::BufferUsages::COPY_DST);

/// The smallest buffer, so that empty lists bind too: one of the largest struct.
pub(super) const SMALLEST: u64 = 256;

/// How large a buffer of so many bytes is.
fn padded_size(bytes: u64) -> u64 {
    bytes.max(SMALLEST).next_multiple_of(4)
}

impl Buffers {
    /// A buffer of at least `bytes`, its contents undefined to the kernels.
    pub fn create(&mut self, gpu: &Gpu, name: &'static str, bytes: u64, more: wgpu::BufferUsages) -> Result<()> {
        let size = padded_size(bytes);
        let limit =
            if more.contains(wgpu::BufferUsages::UNIFORM) { gpu.limits.max_buffer_size } else { gpu.binding_limit() };
        if size > limit {
            return Err(Error::work(format!("buffer {name}: {size} bytes needed, the adapter binds {limit} at most")));
        }
        let usage = USAGE | more;
        let descriptor = wgpu::BufferDescriptor { label: Some(name), size, usage, mapped_at_creation: false };
        self.buffers.insert(name, gpu.device.create_buffer(&descriptor));
        Ok(())
    }

    /// As [`Buffers::create`], unless the buffer that is there is as large.
    pub fn fit(&mut self, gpu: &Gpu, name: &'static str, bytes: u64, more: wgpu::BufferUsages) -> Result<()> {
        if self.get(name).is_some_and(|there| there.size() == padded_size(bytes)) {
            return Ok(());
        }
        self.create(gpu, name, bytes, more)
    }

    /// A storage buffer that holds `items`: the one that is there, if it is as large.
    pub fn upload<T: bytemuck::NoUninit>(&mut self, gpu: &Gpu, name: &'static str, items: &[T]) -> Result<()> {
        let bytes: &[u8] = bytemuck::cast_slice(items);
        self.fit(gpu, name, bytes.len() as u64, wgpu::BufferUsages::empty())?;
        gpu.queue.write_buffer(&self.buffers[name], 0, bytes);
        Ok(())
    }

    /// A uniform buffer that holds `value`.
    pub fn upload_uniform<T: bytemuck::NoUninit>(&mut self, gpu: &Gpu, name: &'static str, value: &T) -> Result<()> {
        let bytes = bytemuck::bytes_of(value);
        self.create(gpu, name, bytes.len() as u64, wgpu::BufferUsages::UNIFORM)?;
        gpu.queue.write_buffer(&self.buffers[name], 0, bytes);
        Ok(())
    }

    /// The buffer that is `from` in `other`, under another name here too.
    pub fn share(&mut self, name: &'static str, other: &Buffers, from: &str) {
        if let Some(buffer) = other.get(from) {
            self.buffers.insert(name, buffer.clone());
        }
    }

    pub fn get(&self, name: &str) -> Option<&wgpu::Buffer> {
        self.buffers.get(name)
    }

    /// A texture that holds a table, four words a texel, [`TEXELS_A_ROW`] texels a row, and zeros behind it: the one that is there, if it
    /// is as large.
    pub fn upload_texels<T: bytemuck::NoUninit>(&mut self, gpu: &Gpu, name: &'static str, items: &[T]) -> Result<()> {
        let bytes: &[u8] = bytemuck::cast_slice(items);
        let row_bytes = TEXEL_BYTES * TEXELS_A_ROW;
        let rows = bytes.len().div_ceil(row_bytes as usize).max(1) as u32;
        let most = gpu.limits.max_texture_dimension_2d;
        if rows > most {
            return Err(Error::work(format!("texture {name}: {rows} rows needed, the adapter has {most} at most")));
        }
        let size = wgpu::Extent3d { width: TEXELS_A_ROW, height: rows, depth_or_array_layers: 1 };
        if self.textures.get(name).is_none_or(|there| there.texture.size() != size) {
            let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
                label: Some(name),
                size,
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format: wgpu::TextureFormat::Rgba32Uint,
                usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
                view_formats: &[],
            });
            self.place_texture(name, &texture, wgpu::TextureViewDimension::D2);
        }
        let texture = &self.textures[name].texture;
        for first in (0..rows).step_by(ROWS_A_WRITE as usize) {
            write_rows(gpu, texture, bytes, first..(first + ROWS_A_WRITE).min(rows));
            if rows > ROWS_A_WRITE {
                // the copies that wgpu keeps of these bytes are free once the device has them
                gpu.queue.submit([]);
            }
        }
        Ok(())
    }

    /// Uploads the rows of a table that hold `changed` items. `items` are all items, as many as the existing texture holds.
    pub fn update_texels<T: bytemuck::NoUninit>(
        &mut self,
        gpu: &Gpu,
        name: &'static str,
        items: &[T],
        changed: &[Range<usize>],
    ) -> Result<()> {
        let Some(there) = self.textures.get(name) else { return self.upload_texels(gpu, name, items) };
        for rows in blocks_of::<T>(changed, items.len(), (TEXEL_BYTES * TEXELS_A_ROW) as usize) {
            // within the rows of the texture
            write_rows(gpu, &there.texture, bytemuck::cast_slice(items), rows.start as u32..rows.end as u32);
        }
        Ok(())
    }

    /// Sends some items of a storage buffer again, which has as many.
    pub fn update<T: bytemuck::NoUninit>(
        &mut self,
        gpu: &Gpu,
        name: &'static str,
        items: &[T],
        changed: &[Range<usize>],
    ) -> Result<()> {
        let Some(there) = self.buffers.get(name) else { return self.upload(gpu, name, items) };
        let bytes: &[u8] = bytemuck::cast_slice(items);
        for block in blocks_of::<T>(changed, items.len(), BLOCK_BYTES) {
            let start = block.start * BLOCK_BYTES;
            let end = (block.end * BLOCK_BYTES).min(bytes.len());
            gpu.queue.write_buffer(there, start as u64, &bytes[start..end]);
        }
        Ok(())
    }

    /// A texture, all of it.
    pub fn place_texture(
        &mut self,
        name: &'static str,
        texture: &wgpu::Texture,
        dimension: wgpu::TextureViewDimension,
    ) {
        let texel = u64::from(texture.format().block_copy_size(None).unwrap_or(0));
        let size = texture.size();
        let texels = u64::from(size.width) * u64::from(size.height) * u64::from(size.depth_or_array_layers);
        let descriptor = wgpu::TextureViewDescriptor { dimension: Some(dimension), ..Default::default() };
        let view = texture.create_view(&descriptor);
        let placed = Texture { texture: texture.clone(), view, bytes: texel * texels };
        self.textures.insert(name, placed);
    }

    /// Bytes of device memory held.
    pub fn bytes(&self) -> u64 {
        let textures: u64 = self.textures.values().map(|t| t.bytes).sum();
        textures + self.buffers.values().map(wgpu::Buffer::size).sum::<u64>()
    }
}

/// Returns the size limit of a table of triangles or vertices, bytes: a texture's size, but at most `BINDINGS_A_TABLE` bindings.
pub fn table_limit(limits: &wgpu::Limits) -> u64 {
    let texels = u64::from(limits.max_texture_dimension_2d) * u64::from(TEXELS_A_ROW);
    (BINDINGS_A_TABLE * limits.max_storage_buffer_binding_size).min(texels * u64::from(TEXEL_BYTES))
}

/// Joins the bindings of a kernel with buffers of their names.
pub struct Binder {
    kernel: &'static str,
    bindings: Vec<(u32, Binding)>,
    pub layout: wgpu::BindGroupLayout,
}

impl Binder {
    /// Makes the binder of a kernel of this name, from the bindings that it reaches.
    pub fn new(
        device: &wgpu::Device,
        kernel: &'static str,
        bindings: Vec<(u32, Binding)>,
        stages: wgpu::ShaderStages,
    ) -> Binder {
        let entries: Vec<wgpu::BindGroupLayoutEntry> =
            bindings.iter().map(|(number, binding)| layout_entry(*number, binding, stages)).collect();
        let label = Some(kernel);
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label, entries: &entries });
        Binder { kernel, bindings, layout }
    }

    /// Binds every buffer by its name, from the first of `scopes` that has it, and textures.
    pub fn bind(
        &self,
        gpu: &Gpu,
        scopes: &[&Buffers],
        textures: &[(&str, &wgpu::TextureView)],
    ) -> Result<wgpu::BindGroup> {
        let bound = self.resources(scopes, &[], textures).collect::<Result<Vec<_>>>()?;
        Ok(self.group(gpu, &bound))
    }

    /// What is bound, in the order of the bindings.
    fn resources<'a>(
        &'a self,
        scopes: &'a [&'a Buffers],
        renamed: &'a [(&str, &str)],
        textures: &'a [(&str, &'a wgpu::TextureView)],
    ) -> impl Iterator<Item = Result<Resource>> {
        self.bindings.iter().map(move |(_, b)| {
            let name = renamed.iter().find(|r| r.0 == b.name).map_or(b.name, |r| r.1);
            let own = || textures.iter().find(|t| t.0 == name).map(|t| t.1);
            let shared = || scopes.iter().find_map(|s| s.textures.get(name)).map(|t| &t.view);
            let texture = || own().or_else(shared).cloned().map(Resource::Texture);
            let buffer = scopes.iter().find_map(|s| s.get(name)).cloned().map(Resource::Buffer);
            buffer
                .or_else(texture)
                .ok_or_else(|| Error::work(format!("kernel {}: no buffer or texture {name}", self.kernel)))
        })
    }

    fn group(&self, gpu: &Gpu, bound: &[Resource]) -> wgpu::BindGroup {
        let entries: Vec<wgpu::BindGroupEntry> = (self.bindings.iter())
            .zip(bound)
            .map(|((binding, _), resource)| {
                let binding = *binding;
                let resource = match resource {
                    Resource::Buffer(buffer) => buffer.as_entire_binding(),
                    Resource::Texture(view) => wgpu::BindingResource::TextureView(view),
                };
                wgpu::BindGroupEntry { binding, resource }
            })
            .collect();
        let (label, layout) = (Some(self.kernel), &self.layout);
        gpu.device.create_bind_group(&wgpu::BindGroupDescriptor { label, layout, entries: &entries })
    }
}

#[derive(PartialEq)]
enum Resource {
    Buffer(wgpu::Buffer),
    Texture(wgpu::TextureView),
}

/// The bind groups of a frame in their order, for the next frame: most bind the same again.
#[derive(Default)]
pub struct BindGroups {
    groups: Vec<BoundGroup>,
    /// How many this frame has taken.
    taken: usize,
}

struct BoundGroup {
    pipeline: Pipeline,
    bound: Vec<Resource>,
    group: wgpu::BindGroup,
}

impl BindGroups {
    /// The next one of a frame: binds every buffer and texture by its name, from the first of `scopes` that has it; a name on the left of
    /// `renamed` is looked up as the one on its right.
    pub fn next(
        &mut self,
        gpu: &Gpu,
        pipeline: &Pipeline,
        scopes: &[&Buffers],
        renamed: &[(&str, &str)],
    ) -> Result<&wgpu::BindGroup> {
        let bound = pipeline.0.binder.resources(scopes, renamed, &[]).collect::<Result<Vec<_>>>()?;
        let at = self.taken;
        self.taken += 1;
        let is_same = |there: &BoundGroup| Arc::ptr_eq(&there.pipeline.0, &pipeline.0) && there.bound == bound;
        if !self.groups.get(at).is_some_and(is_same) {
            let group = pipeline.0.binder.group(gpu, &bound);
            let new = BoundGroup { pipeline: pipeline.clone(), bound, group };
            self.groups.splice(at..(at + 1).min(self.groups.len()), [new]);
        }
        Ok(&self.groups[at].group)
    }

    /// The next group is the first of a frame. What the last frame did not take is forgotten.
    pub fn rewind(&mut self) {
        self.groups.truncate(self.taken);
        self.taken = 0;
    }
}

/// One compute kernel, compiled. Clones are the same pipeline.
#[derive(Clone)]
pub struct Pipeline(Arc<Compiled>);

struct Compiled {
    binder: Binder,
    pipeline: wgpu::ComputePipeline,
}

/// The pipelines of a device, by what they were compiled from: variants that differ in one kernel share all others.
#[derive(Default)]
pub struct Pipelines(Mutex<HashMap<Key, Pipeline>>);

/// The source of a kernel, whether its f64 is in 32-bit words, and the bits of its constants.
type Key = (String, bool, Vec<(&'static str, u64)>);

impl Pipeline {
    /// The pipeline of a kernel, without f64 of the adapter's own where it has none: compiled, if none of the same was.
    ///
    /// # Errors
    /// [`Error::Work`] for a kernel that binds more storage buffers than the adapter has; later kernels are not affected.
    pub fn new(gpu: &Gpu, kernel: Kernel) -> Result<Pipeline> {
        let constants = kernel.constants.iter().map(|(name, value)| (*name, value.to_bits())).collect();
        let key = (gpu.with_replaced(&kernel).source(), gpu.lowers(&kernel), constants);
        let known = || gpu.pipelines.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(pipeline) = known().get(&key) {
            return Ok(pipeline.clone());
        }
        // others may compile meanwhile
        let pipeline = Pipeline(Arc::new(Compiled::new(gpu, &kernel)?));
        known().insert(key, pipeline.clone());
        Ok(pipeline)
    }

    pub fn raw(&self) -> &wgpu::ComputePipeline {
        &self.0.pipeline
    }

    /// Binds every buffer by its name, from the first of `scopes` that has it.
    pub fn bind(&self, gpu: &Gpu, scopes: &[&Buffers]) -> Result<wgpu::BindGroup> {
        self.0.binder.bind(gpu, scopes, &[])
    }

    /// With textures.
    pub fn bind_textures(
        &self,
        gpu: &Gpu,
        scopes: &[&Buffers],
        textures: &[(&str, &wgpu::TextureView)],
    ) -> Result<wgpu::BindGroup> {
        self.0.binder.bind(gpu, scopes, textures)
    }
}

impl Compiled {
    fn new(gpu: &Gpu, kernel: &Kernel) -> Result<Compiled> {
        let device = &gpu.device;
        let (name, constants) = (kernel.name, &kernel.constants);
        let label = Some(name);
        let Module { module, bindings } = gpu.compile(kernel);
        let (binds, most) = (storage_buffers(&bindings), gpu.limits.max_storage_buffers_per_shader_stage);
        if binds > most {
            let adapter = &gpu.info.name;
            let needs = format!("kernel {name} needs {binds} storage buffers, there are {most}");
            return Err(Error::work(format!("adapter {adapter}: {needs}; use --engine reference")));
        }
        let binder = Binder::new(device, name, bindings, wgpu::ShaderStages::COMPUTE);
        let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label,
            bind_group_layouts: &[Some(&binder.layout)],
            immediate_size: 0,
        });
        let scope = device.push_error_scope(wgpu::ErrorFilter::Validation);
        let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label,
            layout: Some(&layout),
            module: &module,
            entry_point: Some(name),
            compilation_options: wgpu::PipelineCompilationOptions { constants, ..Default::default() },
            cache: None,
        });
        if let Some(error) = pollster::block_on(scope.pop()) {
            gpu.failed(format!("kernel {name}: {}", one_line(error)));
        }
        Ok(Compiled { binder, pipeline })
    }
}

/// A picture of several samples a pixel.
const MULTISAMPLED: &str = "texture_multisampled_2d<u32>";

fn layout_entry(binding: u32, of: &Binding, visibility: wgpu::ShaderStages) -> wgpu::BindGroupLayoutEntry {
    let buffer = |ty| wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None };
    let ty = match of.access {
        Access::Uniform => buffer(wgpu::BufferBindingType::Uniform),
        Access::Read => buffer(wgpu::BufferBindingType::Storage { read_only: true }),
        Access::Write => buffer(wgpu::BufferBindingType::Storage { read_only: false }),
        Access::Texels => wgpu::BindingType::Texture {
            sample_type: match of.wgsl_type {
                "texture_2d<u32>" | MULTISAMPLED => wgpu::TextureSampleType::Uint,
                _ => wgpu::TextureSampleType::Float { filterable: false },
            },
            view_dimension: match of.wgsl_type {
                "texture_2d_array<f32>" => wgpu::TextureViewDimension::D2Array,
                _ => wgpu::TextureViewDimension::D2,
            },
            multisampled: of.wgsl_type == MULTISAMPLED,
        },
        Access::WriteTexels => wgpu::BindingType::StorageTexture {
            access: wgpu::StorageTextureAccess::WriteOnly,
            format: wgpu::TextureFormat::Rgba16Float,
            view_dimension: wgpu::TextureViewDimension::D2,
        },
    };
    wgpu::BindGroupLayoutEntry { binding, visibility, ty, count: None }
}

/// Waits until everything submitted is done.
pub fn wait(gpu: &Gpu) -> Result<()> {
    gpu.device.poll(wgpu::PollType::wait_indefinitely()).map_err(|e| gpu.failed(one_line(e)))?;
    gpu.failure()
}

/// Waits until a submission is done, and with it the [`PendingRead`]s of what it wrote that were started before.
pub fn wait_for(gpu: &Gpu, submission: &wgpu::SubmissionIndex) -> Result<()> {
    let until = wgpu::PollType::Wait { submission_index: Some(submission.clone()), timeout: None };
    gpu.device.poll(until).map_err(|e| gpu.failed(one_line(e)))?;
    gpu.failure()
}
