// Straight rays against a triangle's plane.

#import arithmetic
#import nodes/slabs.wgsl
#import rays/affine_bundle.wgsl
#import rays/meeting.wgsl
#import rays/straight/perturb.wgsl
#import rays/straight/plane_tolerance.wgsl
#import rays/straight/sides.wgsl
#import shared/params.wgsl

// The hit of a ray that a triangle covers, at t = along / across. A triangle whose back face is hidden is not hit where `across` has the sign of
// `back_sign`. A hit is moved to an end of t_range where N . (v - X) is at most `rounding`, X the ray's point at that end. Where the ray runs
// almost along the plane, t is that of the perturbed ray, which is in the triangle (`docs/reference/definitions.md`, Perturbed rays).
fn ray_meeting(
    b: Bundle, v: array<real3, 3>, normal: real3, along: real, across: real, rounding: real, back_sign: real,
) -> Meeting {
    let t_min = real_from_bits(params.t_words.xy);
    let t_max = real_from_bits(params.t_words.zw);
    var meeting = meeting_between(along, across, rounding, back_sign, t_min, t_max);
    // a loop: software adapters take every branch
    var is_edge_on = abs(across) < EDGE_ON * size3(normal) * size3(b.d) && across != 0.0 && across * back_sign <= 0.0;
    loop {
        if !is_edge_on {
            break;
        }
        is_edge_on = false;
        let t = t_between(perturbed(b, real(params.scene_size)), v);
        meeting = Meeting(t, t >= t_min && t <= t_max);
    }
    return meeting;
}

// A hit between two ends of t_range.
fn meeting_between(along: real, across: real, rounding: real, back_sign: real, t_min: real, t_max: real) -> Meeting {
    if across == 0.0 || across * back_sign > 0.0 {
        return Meeting(0.0, false);
    }
    let t = along / across;
    if abs(along - t_min * across) <= rounding {
        return Meeting(t_min, true);
    }
    if abs(along - t_max * across) <= rounding {
        return Meeting(t_max, true);
    }
    return Meeting(t, t >= t_min && t <= t_max);
}

// Largest N . (v h - X h) of a hit that counts as a hit at an end of a bundle's ray; across = N . d. Where layers of a chain meet: the rounding of
// two stored vertices in N, one vertex and p in the offset, d at the joint, 16 units of their sizes' sum.
fn end_rounding(b: Bundle, normal: real3, across: real, reach: real) -> real {
    let of_chain = 16.0 * REAL_UNIT * size3(normal) * (reach * abs(b.h) + size3(b.p) + size3(b.d));
    return select(plane_tolerance(normal, b.d, across) * abs(b.h), of_chain, SLABBED);
}
