// The path of a pixel in a layer: its curve, cut into straight segments at equal steps of t (Brosz et al. 2007, section 4.3).

#import arithmetic
#import hierarchy/segment.wgsl
#import rays/curves/curve.wgsl
#import rays/curves/pixel.wgsl
#import rivals/raytrace.wgsl
#import shared/params.wgsl

fn path_segment(layer: u32, x: u32, y: u32, k: u32) -> Segment {
    let c = pixel_curve(layer, x, y);
    let from_t = f32(k) / f32(SEGMENTS);
    let p = vec3<f32>(curve_point(c, real(from_t)));
    let q = vec3<f32>(curve_point(c, real(f32(k + 1u) / f32(SEGMENTS))));
    let first = params.t_min.x * f32(SEGMENTS) - f32(k);
    let last = params.t_max.x * f32(SEGMENTS) - f32(k);
    return Segment(p, q - p, max(first, 0.0), min(last, 1.0));
}

fn path_t(s: f32, k: u32) -> f32 {
    return (f32(k) + s) / f32(SEGMENTS);
}
