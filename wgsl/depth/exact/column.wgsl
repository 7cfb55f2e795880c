// The rays of one column of a tile: of its four upper pixels, then of its four lower ones.

#import arithmetic

// Origins, less a point, and directions of four pixels below each other.
struct Strip {
    px: real4,
    py: real4,
    pz: real4,
    dx: real4,
    dy: real4,
    dz: real4,
}

struct Column {
    upper: Strip,
    lower: Strip,
    has_upper: vec4<bool>,      // a ray
    has_lower: vec4<bool>,
}

const NO_STRIP: Strip = Strip(real4(0.0), real4(0.0), real4(0.0), real4(0.0), real4(0.0), real4(0.0));

fn either(a: Strip, b: Strip, is_b: vec4<bool>) -> Strip {
    return Strip(
        select(a.px, b.px, is_b), select(a.py, b.py, is_b), select(a.pz, b.pz, is_b),
        select(a.dx, b.dx, is_b), select(a.dy, b.dy, is_b), select(a.dz, b.dz, is_b),
    );
}

// Of four pixels or rays those that are so, as bits.
fn row_bits(is_so: vec4<bool>) -> u32 {
    let bits = select(vec4<u32>(0u), vec4<u32>(1u, 2u, 4u, 8u), is_so);
    return bits.x | bits.y | bits.z | bits.w;
}
