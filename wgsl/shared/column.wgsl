// The rays of one column of a tile: of its four upper pixels, then of its four lower ones.

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
