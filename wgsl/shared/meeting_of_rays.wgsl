// Straight rays against a triangle's plane.
// Provides: end_rounding, meeting_between, ray_meeting
// Needs: Bundle, Meeting, REAL_UNIT, SLABBED, real, real3, real_from_bits, size3
// Binds: params

// t = along / across of a ray; `across` of the sign of `back_sign` is a back face, which is not visible. In a chain a hit within
// `rounding` (of `along`) beyond an end of its segment counts as on that end: the next segment starts there, up to
// rounding, and what lies in the face between them must not fall through.
fn ray_meeting(along: real, across: real, rounding: real, back_sign: real) -> Meeting {
    return meeting_between(along, across, rounding, back_sign, real_from_bits(params.t_words.xy), real_from_bits(params.t_words.zw));
}

// The same, between two t: a loop that calls it loads them once.
fn meeting_between(along: real, across: real, rounding: real, back_sign: real, t_min: real, t_max: real) -> Meeting {
    if across == 0.0 || across * back_sign > 0.0 {
        return Meeting(0.0, false);
    }
    let t = along / across;
    if SLABBED {
        let margin = rounding / abs(across);
        return Meeting(min(max(t, t_min), t_max), t >= t_min - margin && t <= t_max + margin);
    }
    return Meeting(t, t >= t_min && t <= t_max);
}

// Rounding of N . (v h - p) where a segment of a chain ends: two stored vertices in N, another and p in the offset, d in the face
// there: 16 units of what is summed up.
fn end_rounding(b: Bundle, normal: real3, reach: real) -> real {
    let sizes = reach * abs(b.h) + size3(b.p) + size3(b.d);
    return 16.0 * REAL_UNIT * size3(normal) * sizes;
}
