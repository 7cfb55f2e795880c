// splat_move: the second pass of Yu et al. 2009, section 3.3: every three neighbours of S are rendered as a triangle where the
// camera shows them, so that no holes are left. What lies behind an eye is clipped off.

enable clip_distances;

#import rays/pieces/table.wgsl
#import rivals/drawing.wgsl
#import rivals/drawn
#import rivals/layout.wgsl
#import rivals/outline.wgsl
#import rivals/range.wgsl
#import rivals/splat_cells.wgsl
#import vertices/triangle.wgsl
#import vertices/vertex

var s: texture_2d<f32>;

struct Corner {
    @builtin(position) position: vec4<f32>,
    @location(0) @interpolate(perspective) t: f32,
    @location(1) @interpolate(flat, either) cell: u32,
}

// What lies outside the GLC's image is clipped off.
struct Clipped {
    @builtin(position) position: vec4<f32>,
    @builtin(clip_distances) distances: array<f32, 3>,
    @location(0) @interpolate(perspective) t: f32,
    @location(1) @interpolate(flat, either) cell: u32,
}

// A corner of one of the (SAMPLES - 1)^2 triangles between the texels of a cell: those of row j come after j (2 n - j) others.
fn neighbour(part: u32, corner: u32) -> vec2<u32> {
    let n = SAMPLES - 1u;
    var j = 0u;
    while (j + 1u) * (2u * n - j - 1u) <= part {
        j++;
    }
    let k = part - j * (2u * n - j);
    let up = array<vec2<u32>, 3>(vec2<u32>(0u, 0u), vec2<u32>(1u, 0u), vec2<u32>(0u, 1u));
    let down = array<vec2<u32>, 3>(vec2<u32>(1u, 0u), vec2<u32>(1u, 1u), vec2<u32>(0u, 1u));
    return vec2<u32>(k / 2u, j) + select(up[corner], down[corner], k % 2u == 1u);
}

@vertex
fn splat_move_corner(@builtin(vertex_index) index: u32) -> Clipped {
    let parts = (SAMPLES - 1u) * (SAMPLES - 1u);
    let cell = index / 3u / parts;
    let sample = textureLoad(s, cell_texel(cell) + neighbour(index / 3u % parts, index % 3u), 0);
    let place = vec3<f32>(sample.xy, 1.0) * sample.w;
    let distances = outline_distances(outlines[piece_at(cell_piece(cell)).number], place);
    return Clipped(vec4<f32>(clip_place(sample.xy), 0.5, 1.0) * sample.w, distances, sample.z, cell);
}

@fragment
fn splat_move_pixel(corner: Corner) -> Drawn {
    let triangle = triangle_at(cell_slot(corner.cell));
    let q = piece_at(cell_piece(corner.cell));
    let o = outlines[q.number];
    let at = floor(corner.position.xy);
    let ray = outline_ray(q, at - piece_origin(q));
    let normal = file_normal(triangle, vertex(triangle.x), vertex(triangle.y), vertex(triangle.z));
    if !in_range(corner.t) || !outline_contains(o, at) || is_back_face(triangle.w, normal, ray.d) {
        discard;
    }
    return drawn(o.layer, triangle.w & ID_MASK, corner.t);
}
