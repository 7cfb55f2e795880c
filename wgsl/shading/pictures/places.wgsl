// Places in pictures: the image of a camera in patches, over each of which the origins and directions of rays are bilinear, and a tree
// of boxes around them. These rows follow the lights in `lights`: of each picture a header; then its nodes, each before those below it;
// then its patches. Coordinates are relative to the anchor, times the header's scale, directions have a scale of their own.

#import project/half_meets.wgsl
#import shading/lights/rows.wgsl
#import shading/numbers.wgsl
#import shared/params.wgsl

const HEADER_ROWS: u32 = 4u;
const NODE_ROWS: u32 = 4u;
const MODE_PAINT: u32 = 0u;
const MODE_LIGHT: u32 = 2u;

struct Header {
    mode: u32,
    material: u32,          // whose image is the picture
    nodes_first: u32,       // row
    nodes: u32,
    strength: f32,
    feather: f32,           // px
    angle_power: f32,
    distance_power: f32,
    size: vec2<f32>,        // px
    skipped: f32,           // t from the camera's start of a ray to t = 0 here
    t_last: f32,
    scale: f32,
    distance: f32,          // at which it has its colours; 0: everywhere
    occlusion: u32,
}

fn header_of(k: u32) -> Header {
    let at = shading.pictures_first + HEADER_ROWS * k;
    let a = light_row(at);
    let b = light_row(at + 1u);
    let c = light_row(at + 2u);
    let d = light_row(at + 3u);
    return Header(
        bitcast<u32>(a.x), bitcast<u32>(a.y), bitcast<u32>(a.z), bitcast<u32>(a.w),
        b.x, b.y, b.z, b.w, c.xy, c.z, c.w, d.x, d.y, bitcast<u32>(d.z),
    );
}

// Where a point lies in a picture, and how it moves there with the point.
struct PlaceOf {
    is_there: bool,
    px: vec2<f32>,
    right: vec3<f32>,       // px to the right for a step of 1 / scale along each axis
    down: vec3<f32>,
    d: vec3<f32>,           // the ray's direction
    t: f32,
}

// The places of points farther beyond a patch than this, px, are its neighbours'.
const OVERLAP: f32 = 0.03125;

// Steps of Newton's method at most; it has arrived after one shorter than this, px, and squares what is left.
const STEPS: u32 = 8u;
const ARRIVED: f32 = 0.015625;

// In one patch, whose rows begin at `row`: u and v are -1 and 1 at its sides.
fn place_in(row: u32, x: vec3<f32>) -> PlaceOf {
    let p0 = light_row(row);
    let pu = light_row(row + 1u);
    let pv = light_row(row + 2u);
    let puv = light_row(row + 3u);
    let d0 = light_row(row + 4u).xyz;
    let du = light_row(row + 5u).xyz;
    let dv = light_row(row + 6u).xyz;
    let duv = light_row(row + 7u).xyz;
    let middle = vec2<f32>(p0.w, pu.w);
    let half_size = vec2<f32>(pv.w, puv.w);
    var found: PlaceOf;
    found.is_there = false;
    var uv = vec2<f32>(0.0);
    for (var k = 0u; k < STEPS; k++) {
        let d = d0 + uv.x * du + uv.y * dv + uv.x * uv.y * duv;
        let rest = x - (p0.xyz + uv.x * pu.xyz + uv.y * pv.xyz + uv.x * uv.y * puv.xyz);
        let t = dot(rest, d) / dot(d, d);
        let right = pu.xyz + uv.y * puv.xyz + t * (du + uv.y * duv);
        let down = pv.xyz + uv.x * puv.xyz + t * (dv + uv.x * duv);
        let across = cross(down, d);
        let along = cross(d, right);
        let det = dot(right, across);
        let off = rest - t * d;
        let step = vec2<f32>(dot(off, across), dot(off, along)) / det;
        uv = clamp(uv + step, vec2<f32>(-2.0), vec2<f32>(2.0));
        // false where it is no number
        if all(abs(step * half_size) < vec2<f32>(ARRIVED)) {
            let px = middle + uv * half_size;
            found = PlaceOf(true, px, across * (half_size.x / det), along * (half_size.y / det), d, t);
            break;
        }
    }
    found.is_there = found.is_there && all(abs(found.px - middle) <= half_size + OVERLAP);
    return found;
}

// Of several places that of the least t.
fn place_of(picture: Header, x: vec3<f32>) -> PlaceOf {
    var nearest: PlaceOf;
    nearest.is_there = false;
    nearest.t = picture.t_last;
    var k = 0u;
    while k < picture.nodes {
        let row = picture.nodes_first + NODE_ROWS * k;
        let p_lo = light_row(row);
        let p_hi = light_row(row + 1u);
        let d_lo = light_row(row + 2u).xyz;
        let d_hi = light_row(row + 3u).xyz;
        let patch_row = bitcast<u32>(p_hi.w);
        if !half_meets(x - p_lo.xyz, p_hi.xyz - x, d_lo, d_hi, vec2<f32>(0.0, nearest.t)) {
            k = bitcast<u32>(p_lo.w);
            continue;
        }
        if patch_row != NONE {
            let place = place_in(patch_row, x);
            let inside = all(place.px >= vec2<f32>(0.0)) && all(place.px <= picture.size);
            if place.is_there && inside && place.t >= 0.0 && place.t <= nearest.t {
                nearest = place;
            }
        }
        k++;
    }
    return nearest;
}
