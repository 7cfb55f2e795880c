// The surfaces of triangles and spheres. The normal of a sphere is another one at each place: that of this thread's hit.
// Provides: flat_normal, has_corners, take_surface
// Needs: chord_of, is_sphere, largest, ray_bundle, real, sphere_of, vertex

// Outwards, unit.
var<private> surface_direction: vec3<f32>;

// A hit of this thread at t, to f32. In recheck arithmetic it is where the ray enters or leaves the sphere, whichever is nearer to t.
fn take_surface(triangle: vec4<u32>, layer: u32, x: u32, y: u32, t: f32) {
    if is_sphere(triangle) {
        let b = ray_bundle(layer, x, y, t);
        let s = sphere_of(triangle);
        let chord = chord_of(b, s);
        let is_left = abs(chord.leaves - real(t)) < abs(chord.enters - real(t));
        let at = select(chord.enters, chord.leaves, is_left);
        surface_direction = normalize(vec3<f32>((at * b.d - (s.centre * b.h - b.p)) / (s.radius * b.h)));
    }
}

fn has_corners(triangle: vec4<u32>) -> bool {
    return !is_sphere(triangle);
}

// The unit normal, on the side opposite a direction.
fn flat_normal(triangle: vec4<u32>, direction: vec3<f32>) -> vec3<f32> {
    var flat = surface_direction;
    if !is_sphere(triangle) {
        let v0 = vertex(triangle.x);
        let e1 = vertex(triangle.y) - v0;
        let e2 = vertex(triangle.z) - v0;
        let inverse = 1.0 / max(largest(e1), largest(e2));
        flat = normalize(cross(inverse * e1, inverse * e2));
    }
    return select(flat, -flat, dot(flat, direction) > 0.0);
}
