// A triangle's row: three vertices in the order of their positions, so that every edge is the same from both sides;
// the last word holds what that order hides.
// Provides: ID_MASK, ONE_SIDED, corner_order, triangle_id, triangle_order, triangle_reversed

const ID_MASK: u32 = 0x0fffffffu;
const ONE_SIDED: u32 = 0x80000000u;

fn triangle_id(row: vec4<u32>) -> u32 {
    return row.w & ID_MASK;
}

// Which of the six orders the file has: see corner_order.
fn triangle_order(row: vec4<u32>) -> u32 {
    return (row.w >> 28u) & 7u;
}

// For each corner in file order, its position in the row.
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

// Whether the row's order reverses the winding of the file.
fn triangle_reversed(row: vec4<u32>) -> bool {
    return triangle_order(row) >= 3u;
}
