// Which points count as on a triangle's plane.
// Provides: plane_tolerance
// Needs: PERTURB, real, real3, size3
// Binds: params

// Largest N . (v - X) of a point X that counts as on the plane (`docs/reference/definitions.md`, Ends of t_range).
fn plane_tolerance(normal: real3) -> real {
    return PERTURB * real(params.scene_size) * size3(normal);
}
