// A packed triangle: three vertices in the order of their positions, so that every edge is the same from both sides;
// the last word holds what that order hides.

const ID_MASK: u32 = 0x0fffffffu;
const ONE_SIDED: u32 = 0x80000000u;

fn triangle_id(triangle: vec4<u32>) -> u32 {
    return triangle.w & ID_MASK;
}

// Which of the six orders the file has: see corner_order.
fn triangle_order(triangle: vec4<u32>) -> u32 {
    return (triangle.w >> 28u) & 7u;
}

// For each corner in file order, its position there.
fn corner_order(order: u32) -> vec3<u32> {
    switch order {
        case 0u: { return vec3<u32>(0u, 1u, 2u); }
        case 1u: { return vec3<u32>(1u, 2u, 0u); }
        case 2u: { return vec3<u32>(2u, 0u, 1u); }
        case 3u: { return vec3<u32>(0u, 2u, 1u); }
        case 4u: { return vec3<u32>(2u, 1u, 0u); }
        default: { return vec3<u32>(1u, 0u, 2u); }
    }
}

// Whether that order reverses the winding of the file.
fn triangle_reversed(triangle: vec4<u32>) -> bool {
    return triangle_order(triangle) >= 3u;
}
