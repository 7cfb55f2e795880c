// Segments of paths, and their first hits.

#import shared/params.wgsl

// A part of a pixel's path or of a shadow ray: p + s d for s in [first, last].
struct Segment {
    p: vec3<f32>,
    d: vec3<f32>,
    first: f32,
    last: f32,
}

// The first triangle that a segment hits.
struct Found {
    s: f32,
    id: u32,
}

// A box around two children, or around triangles.
struct BvhNode {
    lo: vec3<f32>,
    first: u32,             // child, the other beside it; or triangle
    hi: vec3<f32>,
    count: u32,             // triangles; 0: it has children
}

// A triangle of a leaf, corners relative to the anchor; or a sphere or capsule by its ends v0 and v2 and its radius, the x of v1.
struct LeafTriangle {
    v0: vec3<f32>,
    id: u32,
    v1: vec3<f32>,
    one_sided: u32,
    v2: vec3<f32>,
    is_round: u32,
}

fn nothing() -> Found {
    // infinity
    return Found(bitcast<f32>(0x7f800000u), NONE);
}

// The nearer of a previous hit and a triangle; of equals the smaller id.
fn nearer(segment: Segment, found: Found, triangle: LeafTriangle) -> Found {
    let m0 = triangle.v0 - segment.p;
    let m1 = triangle.v1 - segment.p;
    let m2 = triangle.v2 - segment.p;
    // edges are subtracted before they are multiplied: next to them the corners are far from where the segment starts. An edge that
    // two triangles share has the same number in both, with the other sign (Plücker coordinates)
    let e01 = triangle.v1 - triangle.v0;
    let e12 = triangle.v2 - triangle.v1;
    let e20 = triangle.v0 - triangle.v2;
    let normal = cross(e20, e01);
    let a = dot(segment.d, cross(e01, m0 + m1));
    let b = dot(segment.d, cross(e12, m1 + m2));
    let c = dot(segment.d, cross(e20, m2 + m0));
    let across = dot(normal, segment.d);
    let s = dot(normal, m0) / across;
    let inside = (a >= 0.0 && b >= 0.0 && c >= 0.0) || (a <= 0.0 && b <= 0.0 && c <= 0.0);
    let shown = across != 0.0 && (triangle.one_sided == 0u || across < 0.0);
    let in_range = s >= segment.first && s <= segment.last;
    if inside && shown && in_range && (s < found.s || (s == found.s && triangle.id < found.id)) {
        return Found(s, triangle.id);
    }
    return found;
}
