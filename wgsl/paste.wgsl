// paste: one thread per pixel of the band.
// Reads the visibility buffer, the pixel's ray and the facet that it meets first; copies the nearest atlas
// texel of the facet's piece to the planes.

#import arithmetic
#import keys/key.wgsl
#import optics/bounce
#import optics/facets/bounce.wgsl
#import optics/layout.wgsl
#import optics/refract.wgsl
#import rays/pixel
#import shared/items.wgsl
#import shared/params.wgsl
#import shared/planes.wgsl

var<uniform> atlas_layout: AtlasLayout;
var<storage, read> atlas: array<u32>;
var<storage, read> visibility: array<u32>;

fn copied(plane: u32, pixel: u32, texel: u32) {
    if plane != NONE {
        planes[plane * params.width * params.height + pixel] = atlas[plane * atlas_layout.texel_count + texel];
    }
}

fn tinted(plane: u32, pixel: u32, texel: u32, by: f32) {
    if plane != NONE {
        let light = bitcast<f32>(atlas[plane * atlas_layout.texel_count + texel]);
        planes[plane * params.width * params.height + pixel] = bitcast<u32>(by * light);
    }
}

fn set_word(plane: u32, pixel: u32, word: u32) {
    if plane != NONE {
        planes[plane * params.width * params.height + pixel] = word;
    }
}

@compute @workgroup_size(64)
fn paste(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    // take a pixel that shows a facet
    let pixel = item_index(group, groups, lane);
    if pixel >= params.width * params.height {
        return;
    }
    let won = vec2<u32>(visibility[2u * pixel], visibility[2u * pixel + 1u]);
    let id = key_id(~won);
    if all(won == vec2<u32>(0u)) || id < optic.first_id {
        return;
    }
    let b = ray_bundle(0u, pixel % params.width, pixel / params.width, 0.0);
    let facet = id - optic.first_id;
    let w = vec3<f32>(facet_weights(facet, b.p / b.h, b.d / b.h));

    // find its texel on its piece: the second corner is below the first, the third beside it; in the lower half rotated by 180 degrees
    let piece = piece_of(facet);
    let on = piece_weights(facet, w);
    let side = f32(atlas_layout.side);
    let last = atlas_layout.side - 1u;
    let at = clamp(on.yx * side, vec2<f32>(0.0), vec2<f32>(side));
    var texel = min(vec2<u32>(at), vec2<u32>(last));
    if texel.x + texel.y > last {
        // beyond the long side: back across it, along the row or the column that it left last
        let by_row = fract(at.x) < fract(at.y);
        texel = select(vec2<u32>(texel.x, last - texel.x), vec2<u32>(last - texel.y, texel.y), by_row);
    }
    if piece % 2u == 1u {
        texel = vec2<u32>(last) - texel;
    }
    let cell = vec2<u32>(piece / 2u % atlas_layout.columns, piece / 2u / atlas_layout.columns);
    let place = atlas_layout.side * cell + texel;
    let from_texel = place.y * atlas_layout.width + place.x;

    // copy what it shows
    tinted(PLANE_R, pixel, from_texel, optic.tint.x);
    tinted(PLANE_G, pixel, from_texel, optic.tint.y);
    tinted(PLANE_B, pixel, from_texel, optic.tint.z);
    copied(PLANE_T, pixel, from_texel);
    copied(PLANE_TRIANGLE_ID, pixel, from_texel);
    copied(PLANE_BARY_U, pixel, from_texel);
    copied(PLANE_BARY_V, pixel, from_texel);
    copied(PLANE_N_X, pixel, from_texel);
    copied(PLANE_N_Y, pixel, from_texel);
    copied(PLANE_N_Z, pixel, from_texel);
    copied(PLANE_P_X, pixel, from_texel);
    copied(PLANE_P_Y, pixel, from_texel);
    copied(PLANE_P_Z, pixel, from_texel);
    copied(PLANE_VIEW_X, pixel, from_texel);
    copied(PLANE_VIEW_Y, pixel, from_texel);
    copied(PLANE_VIEW_Z, pixel, from_texel);
    copied(PLANE_ALBEDO_R, pixel, from_texel);
    copied(PLANE_ALBEDO_G, pixel, from_texel);
    copied(PLANE_ALBEDO_B, pixel, from_texel);
    copied(PLANE_UV_U, pixel, from_texel);
    copied(PLANE_UV_V, pixel, from_texel);
    set_word(PLANE_A, pixel, bitcast<u32>(1.0));
    set_word(PLANE_PIECE_ID, pixel, optic.piece_first + piece);
    set_word(PLANE_MIRROR_ID, pixel, facet);
    if PLANE_Z != NONE {
        let path_length = f32(norm(facet_place(facet, real3(w)) - b.p / b.h));
        let z = bitcast<f32>(atlas[PLANE_Z * atlas_layout.texel_count + from_texel]);
        set_word(PLANE_Z, pixel, bitcast<u32>(path_length + z));
    }
}
