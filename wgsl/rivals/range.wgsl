// The camera's range of t.
// Provides: in_range
// Binds: params

fn in_range(t: f32) -> bool {
    return t >= params.t_min.x + params.t_min.y + params.t_min.z
        && t <= params.t_max.x + params.t_max.y + params.t_max.z;
}
