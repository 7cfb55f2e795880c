// Reflection and refraction at smooth surfaces, intersected exactly. A file per kind gives the intersection, `first_root`, and
// the normal, `smooth_normal`.

#import arithmetic
#import optics/layout.wgsl
#import optics/refract.wgsl
#import optics/root
#import shared/params.wgsl

struct Root {
    t: real,
    found: bool,
}

// Where the pixel's ray p + t d meets the surface; `last` is the id of the one that it starts on.
fn meeting_with(surface: u32, p: real3, d: real3, last: u32) -> Root {
    return first_root(surface, p, d, last == optic.first_id + surface, real_from_bits(params.t_words.xy), real_from_bits(params.t_words.zw));
}

// A smooth surface is its own piece.
fn piece_of(surface: u32) -> u32 {
    return surface;
}

// The bounce of the ray at the surface that it meets.
fn bounce_at(surface: u32, p: real3, d: real3, last: u32) -> BouncedRay {
    let place = p + meeting_with(surface, p, d, last).t * d;
    let normal = smooth_normal(surface, place);
    let after = bent_at(d / norm(d), normal, normal);
    return BouncedRay(place, after.d, after.share);
}
