// The camera's range of t.

#import shared/params.wgsl

fn range_start() -> f32 {
    return params.t_min.x + params.t_min.y + params.t_min.z;
}

fn range_end() -> f32 {
    return params.t_max.x + params.t_max.y + params.t_max.z;
}

fn in_range(t: f32) -> bool {
    return t >= range_start() && t <= range_end();
}
