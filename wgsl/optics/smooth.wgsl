// Turns at surfaces that rays meet where they are. A snippet of each kind says where, `first_root`, and which way the surface
// faces there, `smooth_normal`.
// Provides: Root, camera_of, meeting_with, turn_at
// Needs: Turned, bent_at, first_root, norm, of_words, real, real3, smooth_normal
// Binds: optic, params

struct Root {
    t: real,
    found: bool,
}

// Where the pixel's ray p + t d meets the surface; `last` is the id of the one that it starts on.
fn meeting_with(surface: u32, p: real3, d: real3, last: u32) -> Root {
    return first_root(surface, p, d, last == optic.first_id + surface, of_words(params.t_words.xy), of_words(params.t_words.zw));
}

// A smooth surface is its own piece.
fn camera_of(surface: u32) -> u32 {
    return surface;
}

// The turn of the ray at the surface that it meets.
fn turn_at(surface: u32, p: real3, d: real3, last: u32) -> Turned {
    let place = p + meeting_with(surface, p, d, last).t * d;
    let normal = smooth_normal(surface, place);
    let after = bent_at(d / norm(d), normal, normal);
    return Turned(place, after.d, after.share);
}
