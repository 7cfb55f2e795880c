// A straight ray at the place that this thread looks at, in the coordinates of the hierarchy of the mesh there.

#import rays/coverage
#import rays/straight/stretch.wgsl
#import rays/stretch
#import vertices/placed/vertex.wgsl
#import vertices/vertex

// The ray in coordinates of the mesh. Its direction is scaled by a power of two to a size of 1/2 to 1: s of the ray among the places, times
// `s_share`, is s here.
struct PlacedStretch {
    stretch: Stretch,
    s_share: f32,
}

// A sum of three products and a number loses 5 units of the products as numbers are stored, multiplied and added, one for what f64 lost of the
// matrix, and 3 of the number. The slack is that of `stretch_of`.
fn placed_stretch(stretch: Stretch) -> PlacedStretch {
    let x = bitcast<vec4<f32>>(instance_row(1u));
    let y = bitcast<vec4<f32>>(instance_row(2u));
    let z = bitcast<vec4<f32>>(instance_row(3u));
    let size = bitcast<f32>(instance_row(4u).x);
    let p = vec3<f32>(dot(x.xyz, stretch.p) + x.w, dot(y.xyz, stretch.p) + y.w, dot(z.xyz, stretch.p) + z.w);
    let d = vec3<f32>(dot(x.xyz, stretch.d), dot(y.xyz, stretch.d), dot(z.xyz, stretch.d));
    let constant = largest_of(vec3<f32>(x.w, y.w, z.w));
    let error_p = size * (stretch.error_p + 6.0 * UNIT * largest_of(stretch.p)) + 3.0 * UNIT * constant
        + bitcast<f32>(instance_row(11u).x) + LEAST;
    let exponent = clamp(bitcast<u32>(largest_of(d)) >> 23u, 1u, 252u);
    let share = bitcast<f32>((253u - exponent) << 23u);
    let back = bitcast<f32>((exponent + 1u) << 23u);
    let error_d = min(share * size * (stretch.error_d + 6.0 * UNIT) + LEAST, ENDLESS);
    let far = 1.0 + largest_of(p) + error_p;
    let slack = min(error_p + far * (error_d / max(0.5 - error_d, LEAST) + (23.0 + CORNER_UNITS) * UNIT), ENDLESS);
    return PlacedStretch(
        Stretch(
            p, error_p, d * share, error_d, vec3<f32>(slack),
            clamp(stretch.first * back, -ENDLESS, ENDLESS) - slack, clamp(stretch.last * back, -ENDLESS, ENDLESS) + slack,
            clamp(stretch.inner_first * back, -ENDLESS, ENDLESS) + slack, clamp(stretch.inner_last * back, -ENDLESS, ENDLESS) - slack,
        ),
        back,
    );
}

// What was seen before, by the s of the mesh's hierarchy.
fn seen_in(own: PlacedStretch, seen: Seen) -> Seen {
    return Seen(seen.slot, min(seen.first * own.s_share, ENDLESS), min(seen.last * own.s_share, ENDLESS));
}

// What the path has seen after the mesh, by s among the places. `known` and `found` are what it had seen before and after the mesh, by s in
// the mesh.
fn seen_from(own: PlacedStretch, before: Seen, known: Seen, found: Seen) -> Seen {
    let share = 1.0 / own.s_share;
    return Seen(
        found.slot,
        select(before.first, found.first * share, found.slot != known.slot),
        select(before.last, found.last * share, found.last < known.last),
    );
}
