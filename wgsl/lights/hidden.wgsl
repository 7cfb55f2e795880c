// What is in the way of light: straight segments through the hierarchy of the scene's triangles, whose rows follow those of the lights.

// How far above a surface segments start, of the largest coordinate that its place was found with.
const ABOVE: f32 = 4e-6;

fn node_at(k: u32) -> BvhNode {
    let a = lights[shading.nodes_first + 2u * k];
    let b = lights[shading.nodes_first + 2u * k + 1u];
    return BvhNode(a.xyz, bitcast<u32>(a.w), b.xyz, bitcast<u32>(b.w));
}

fn leaf_at(k: u32) -> LeafTriangle {
    let at = shading.leaves_first + 3u * k;
    let a = lights[at];
    let b = lights[at + 1u];
    let c = lights[at + 2u];
    return LeafTriangle(a.xyz, bitcast<u32>(a.w), b.xyz, bitcast<u32>(b.w), c.xyz, 0u);
}

// The unit normal of the triangle itself, turned to the viewer.
fn facing(lit: Lit) -> vec3<f32> {
    let triangle = triangles[lit.slot];
    let v0 = vertex(triangle.x);
    let flat = normalize(cross(vertex(triangle.y) - v0, vertex(triangle.z) - v0));
    return select(flat, -flat, dot(flat, lit.view) > 0.0);
}

fn start_above(lit: Lit, flat: vec3<f32>) -> vec3<f32> {
    let size = max(max(abs(lit.p.x), abs(lit.p.y)), max(abs(lit.p.z), lit.reach));
    return lit.p + ABOVE * size * flat;
}

// No triangle is between a hit and a light.
fn reaches(lit: Lit, l: vec3<f32>, far: f32) -> bool {
    let flat = facing(lit);
    return dot(flat, l) > 0.0 && traced(Segment(start_above(lit, flat), l, 0.0, far)).id == NONE;
}

// The share of directions about the normal, by their cosine, in which nothing is near: what is hides the less the farther it is, up to
// the reach. The directions are a spiral of Fibonacci's on the disc below them.
fn openness(lit: Lit) -> f32 {
    if shading.occlusion_rays == 0u {
        return 1.0;
    }
    let flat = facing(lit);
    let start = start_above(lit, flat);
    // a frame about the normal (Duff et al. 2017)
    let n = lit.n;
    let side = select(-1.0, 1.0, n.z >= 0.0);
    let a = -1.0 / (side + n.z);
    let b = n.x * n.y * a;
    let right = vec3<f32>(1.0 + side * n.x * n.x * a, side * b, -side * n.x);
    let up = vec3<f32>(b, side + n.y * n.y * a, -n.y);
    var hidden = 0.0;
    let count = f32(shading.occlusion_rays);
    for (var k = 0u; k < shading.occlusion_rays; k++) {
        let square = (f32(k) + 0.5) / count;
        // turns by the golden section, of 2^32 a turn
        let angle = 6.2831853 / 4294967296.0 * f32(k * 1640531527u);
        let d = sqrt(square) * (cos(angle) * right + sin(angle) * up) + sqrt(1.0 - square) * n;
        if dot(d, flat) > 0.0 {
            let found = traced(Segment(start, d, 0.0, shading.occlusion_reach));
            if found.id != NONE {
                hidden += 1.0 - found.s / shading.occlusion_reach;
            }
        }
    }
    return 1.0 - hidden / count;
}
