// resolve: one thread per record of `samples`, after shade.
// Reads the visibility keys of a listed pixel's samples, the triangles and the samples' rays; writes the pixel's colour and coverage, the
// means of its samples', each triangle's share of them by its samples' number or by areas; where these and the centre see one triangle they
// are what shade has written. Each triangle is shaded once, in the middle of the samples that see it. Triangles in another
// chunk of the scene are left to that chunk's dispatch, which adds its share.

#import keys/key.wgsl
#import masks/opacity
#import nodes/slabs.wgsl
#import primitives/flat
#import rays/pixel
#import rays/ray.wgsl
#import rays/sample_ray
#import samples/cells.wgsl
#import samples/measure
#import samples/offsets.wgsl
#import samples/shaded_part
#import shading/materials
#import shading/numbers.wgsl
#import shading/pictures
#import shading/sky
#import shading/styles
#import shading/styles/shaded_hit.wgsl
#import shading/surface.wgsl
#import shading/textures
#import shared/items.wgsl
#import shared/params.wgsl
#import shared/planes.wgsl
#import vertices/vertex

var<storage, read> samples: array<u32>;
var<storage, read> slot_of_id: array<u32>;

fn key_of(record: u32, sample: u32) -> vec2<u32> {
    let at = 2u * (record * (SAMPLES + 1u) + 1u + sample);
    return vec2<u32>(samples[at], samples[at + 1u]);
}

@compute @workgroup_size(64)
fn resolve(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    // take a listed pixel
    let record = item_index(group, groups, lane);
    // of records that ran over not all are written
    let count = atomicLoad(&counters[COUNT_EDGES]);
    if record >= count || count > params.edge_capacity {
        return;
    }
    let pixel = samples[2u * record * (SAMPLES + 1u)];
    let centre = samples[2u * record * (SAMPLES + 1u) + 1u];
    var colour = vec3<f32>(0.0);
    var coverage = 0.0;

    // take each triangle with all samples that see it
    measure(pixel, record);
    var left = all_samples();
    var k = 0u;
    loop {
        let first = key_of(record, firstTrailingBit(left));
        let is_hit = any(first != vec2<u32>(0u));
        let same = seen_next(k, record, left);
        if same == all_samples() && select(NONE, key_id(~first), is_hit) == centre {
            return;
        }
        let share = share_of(k, same);
        if is_hit {
            coverage += share;
            if key_id(~first) - params.id_first < params.id_count {
                colour += share * seen_by(pixel, record, same);
            }
        } else if params.id_first == 0u {
            colour += share * beyond(pixel % params.width, pixel / params.width);
        }
        left &= ~same;
        k += 1u;
        if left == 0u {
            break;
        }
    }

    // write what they come to
    put(PLANE_A, pixel, coverage / whole(), false);
    put(PLANE_R, pixel, colour.x / whole(), true);
    put(PLANE_G, pixel, colour.y / whole(), true);
    put(PLANE_B, pixel, colour.z / whole(), true);
}

// The remaining samples that see the same triangle as the first of them.
fn seen_alike(record: u32, left: u32) -> u32 {
    let first = key_of(record, firstTrailingBit(left));
    let is_hit = any(first != vec2<u32>(0u));
    var same = 0u;
    for (var others = left; others != 0u; others &= others - 1u) {
        let n = firstTrailingBit(others);
        let key = key_of(record, n);
        let is_same = any(key != vec2<u32>(0u)) == is_hit && key_id(~key) == key_id(~first);
        same |= select(0u, 1u << n, is_same);
    }
    return same;
}

// The sample nearest to a place.
fn nearest_to(place: vec2<f32>, some: u32) -> u32 {
    var nearest = 0u;
    var least = 4.0;
    for (var others = some; others != 0u; others &= others - 1u) {
        let n = firstTrailingBit(others);
        let off = sample_offset(n) - place;
        let distance = dot(off, off);
        nearest = select(nearest, n, distance < least);
        least = min(least, distance);
    }
    return nearest;
}

// The mean of some samples that see one triangle; lines and strokes on it are each sample's own.
fn seen_by(pixel: u32, record: u32, some: u32) -> vec3<f32> {
    let part = part_of(some);
    let sample = nearest_to(part.middle, some);
    let key = ~key_of(record, sample);
    let slot = slot_of_id[key_id(key) - params.id_first];
    let triangle = triangle_at(slot);
    let x = pixel % params.width;
    let y = pixel / params.width;
    take_place(vec2<u32>(x, y));
    let ray = sample_ray(key_layer(key), x, y, sample);
    var differential: RayDifferential;
    // the same in the middle, for images and patterns
    var middle = ray;
    var filtered: RayDifferential;
    if TEXTURED || STYLED {
        differential = sample_differential(key_layer(key), x, y, sample, key_t(key));
        middle.p += along_plane(triangle, ray, differential, part.middle - sample_offset(sample));
        filtered = RayDifferential(part.sides.x * differential.right, part.sides.y * differential.down);
    }
    let n = surface_normal(slot, triangle, ray);
    let p = point_at(ray, key_t(key));
    let albedo = surface_albedo(slot, triangle, middle, filtered);
    let place = Lit(slot, p, reach_of(ray, key_t(key)), n, normalize(ray.d));
    if !STYLED {
        return lit_by_all(place, differential, albedo);
    }
    var z = 0.0;
    for (var k = 0u; SLABBED && k < key_layer(key); k++) {
        z += segment_length(k, x, y);
    }
    let whole = ShadedHit(slot, point_at(middle, key_t(key)), z, ray.d, filtered, shading.filter_width);
    let lit = lit_by_all(place, differential, albedo * pattern_at(whole));
    var sum = vec3<f32>(0.0);
    for (var others = some; others != 0u; others &= others - 1u) {
        let own = firstTrailingBit(others);
        let t = key_t(~key_of(record, own));
        let its = sample_ray(key_layer(key), x, y, own);
        let hit = ShadedHit(slot, point_at(its, t), z + reached(its, key_layer(key), x, y, t), its.d, differential, inverseSqrt(f32(SAMPLES)));
        sum += drawn(hit, n, lit);
    }
    return sum / f32(countOneBits(some));
}

// How a hit moves in the triangle's plane by px right and down, to first order.
fn along_plane(triangle: vec4<u32>, ray: Ray, differential: RayDifferential, by: vec2<f32>) -> vec3<f32> {
    let moved = by.x * differential.right + by.y * differential.down;
    let n = flat_normal(triangle, ray.d);
    let cosine = dot(n, ray.d);
    return select(moved - ray.d * (dot(n, moved) / cosine), vec3<f32>(0.0), cosine == 0.0);
}

// A hit in all light, with the pictures that are thrown onto it.
fn lit_by_all(place: Lit, differential: RayDifferential, albedo: vec3<f32>) -> vec3<f32> {
    if !PICTURES {
        return sent_back(place, albedo);
    }
    let picture = painted(place, differential, albedo);
    return sent_back(place, picture.lit) + picture.seen;
}

// A sum that the first chunk begins, or what all of them find alike.
fn put(plane: u32, pixel: u32, value: f32, is_sum: bool) {
    if plane != NONE {
        let at = plane * params.width * params.height + pixel;
        let before = select(0.0, bitcast<f32>(planes[at]), is_sum && params.id_first != 0u);
        planes[at] = bitcast<u32>(before + value);
    }
}
