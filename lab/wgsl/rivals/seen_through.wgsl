// A triangle that was projected by its corners, seen through a piece.

enable clip_distances;

#import rays/pieces/table.wgsl
#import rivals/drawing.wgsl
#import rivals/drawn
#import rivals/layout.wgsl
#import rivals/outline.wgsl
#import rivals/range.wgsl
#import vertices/triangle.wgsl

struct Corner {
    @builtin(position) position: vec4<f32>,
    @location(0) @interpolate(perspective) t: f32,
    @location(1) @interpolate(flat, either) normal: vec3<f32>,
    @location(2) @interpolate(flat, either) packed_id: u32,
    @location(3) @interpolate(flat, either) piece: u32,
}

// What lies outside the piece is clipped off.
struct Clipped {
    @builtin(position) position: vec4<f32>,
    @builtin(clip_distances) distances: array<f32, 3>,
    @location(0) @interpolate(perspective) t: f32,
    @location(1) @interpolate(flat, either) normal: vec3<f32>,
    @location(2) @interpolate(flat, either) packed_id: u32,
    @location(3) @interpolate(flat, either) piece: u32,
}

// Several samples a pixel: what is clipped off decides, since the piece that holds the centre need not hold all of them.
override MULTISAMPLED: bool = false;

// What its fragment leaves, of the part of the image that the piece holds.
fn seen_through(corner: Corner) -> Drawn {
    let q = piece_at(corner.piece);
    let o = outlines[q.number];
    let at = floor(corner.position.xy);
    let ray = outline_ray(q, at - piece_origin(q));
    if !in_range(corner.t) || !(MULTISAMPLED || outline_contains(o, at)) || is_back_face(corner.packed_id, corner.normal, ray.d) {
        discard;
    }
    return drawn(o.layer, corner.packed_id & ID_MASK, corner.t);
}
