// The path of a pixel in a layer: its one straight ray.

#import hierarchy/segment.wgsl
#import rays/pixel
#import shared/params.wgsl

fn path_segment(layer: u32, x: u32, y: u32, k: u32) -> Segment {
    let ray = pixel_ray(layer, x, y, 0.0);
    let first = params.t_min.x + params.t_min.y + params.t_min.z;
    let last = params.t_max.x + params.t_max.y + params.t_max.z;
    return Segment(ray.p, ray.d, first, last);
}

fn path_t(s: f32, k: u32) -> f32 {
    return s;
}
