// meet: one thread per pixel of the band that may have a ray.
// Reads the pixel's ray and path state; merges the visibility key of the nearest smooth surface that the ray meets. Ids of smooth
// surfaces follow those of all triangles.
// Needs: NONE, Root, has_ray, meeting_with, merge, pixel_at, ray_bundle, real, visibility_key
// Binds: optic, params, paths

@compute @workgroup_size(64)
fn meet(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    // take a pixel that has a ray
    let place = pixel_at(group, groups, lane);
    if place.x >= params.width || place.y >= params.height {
        return;
    }
    let x = place.x;
    let y = place.y;
    let pixel = y * params.width + x;
    if !has_ray(0u, x, y) || (optic.bounces > 0u && optic.sees_itself == 0u) {
        return;
    }

    // find the nearest surface
    let b = ray_bundle(0u, x, y, 0.0);
    let p = b.p / b.h;
    let d = b.d / b.h;
    var nearest = Root(real(0.0), false);
    var id = NONE;
    for (var k = 0u; k < optic.count; k++) {
        let root = meeting_with(k, p, d, paths[pixel].last);
        if root.found && (!nearest.found || root.t < nearest.t) {
            nearest = root;
            id = optic.first_id + k;
        }
    }
    if nearest.found {
        merge(pixel, ~visibility_key(0u, nearest.t, id));
    }
}
