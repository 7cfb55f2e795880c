// splat_project: the first pass of Yu et al. 2009, section 3.3: every triangle fills a cell of the texture S, each texel with where
// the camera shows it, its t, and the width of a pixel's beam there, below 0 behind an eye. A cell is for a triangle and a piece.

#import rays/pieces/table.wgsl
#import rivals/outline.wgsl
#import rivals/project.wgsl
#import rivals/splat_cells.wgsl
#import vertices/vertex

struct Corner {
    @builtin(position) position: vec4<f32>,
    @location(0) @interpolate(flat, either) cell: u32,
}

@vertex
fn splat_project_corner(@builtin(vertex_index) index: u32) -> Corner {
    let side = f32(splat.side);
    let corner = vec2<f32>(f32((0x32u >> (index % 6u)) & 1u), f32((0x2cu >> (index % 6u)) & 1u));
    let cell = index / 6u;
    let place = (vec2<f32>(cell_texel(cell)) + corner * f32(SAMPLES)) / side;
    return Corner(vec4<f32>(place.x * 2.0 - 1.0, 1.0 - place.y * 2.0, 0.5, 1.0), cell);
}

@fragment
fn splat_project_pixel(corner: Corner) -> @location(0) vec4<f32> {
    let at = vec2<f32>(vec2<u32>(corner.position.xy) - cell_texel(corner.cell)) / f32(SAMPLES - 1u);
    let triangle = triangle_at(cell_slot(corner.cell));
    let v0 = vertex(triangle.x);
    let q = piece_at(cell_piece(corner.cell));
    let image = image_of(q, v0 + at.x * (vertex(triangle.y) - v0) + at.y * (vertex(triangle.z) - v0));
    return vec4<f32>(piece_origin(q) + image.place, image.t, select(image.width, -image.width, image.t < 0.0));
}
