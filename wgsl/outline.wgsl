// outline: one thread per pixel of the band, after shade and resolve.
// Reads the planes around each pixel; mixes line colours into the colour planes at silhouettes, at creases, and at borders of the
// camera's pieces.

#import shading/styles/layout.wgsl
#import shared/items.wgsl
#import shared/params.wgsl
#import shared/planes.wgsl

fn word(plane: u32, pixel: u32) -> u32 {
    return planes[plane * params.width * params.height + pixel];
}

fn number(plane: u32, pixel: u32) -> f32 {
    return bitcast<f32>(word(plane, pixel));
}

// Whether an outline runs between these pixels: one hits nothing, or their surfaces are not continuous.
fn differ(a: u32, b: u32) -> bool {
    let id_a = word(PLANE_TRIANGLE_ID, a);
    let id_b = word(PLANE_TRIANGLE_ID, b);
    if style.outline_width <= 0.0 {
        return false;
    }
    // the first surface that bounced the rays
    if PLANE_MIRROR_ID != NONE && word(PLANE_MIRROR_ID, a) != word(PLANE_MIRROR_ID, b) {
        return true;
    }
    if id_a == id_b {
        return false;
    }
    if id_a == NONE || id_b == NONE {
        return true;
    }
    let n_a = vec3<f32>(number(PLANE_N_X, a), number(PLANE_N_Y, a), number(PLANE_N_Z, a));
    let n_b = vec3<f32>(number(PLANE_N_X, b), number(PLANE_N_Y, b), number(PLANE_N_Z, b));
    let step = vec3<f32>(number(PLANE_P_X, b), number(PLANE_P_Y, b), number(PLANE_P_Z, b))
        - vec3<f32>(number(PLANE_P_X, a), number(PLANE_P_Y, a), number(PLANE_P_Z, a));
    // a step on a surface leaves neither side's plane by more than the angle between the normals
    let off = max(abs(dot(n_a, step)), abs(dot(n_b, step)));
    let sine = max(length(cross(n_a, n_b)), style.jump_sine);
    return dot(n_a, n_b) < style.crease_cosine || off > sine * length(step);
}

fn width_at(a: u32, b: u32) -> f32 {
    if PLANE_Z == NONE {
        return style.outline_width;
    }
    return narrowed(style.outline_width, style.outline_depth, min(number(PLANE_Z, a), number(PLANE_Z, b)));
}

@compute @workgroup_size(64)
fn outline(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    // take a pixel
    let pixel = item_index(group, groups, lane);
    if pixel >= params.width * params.height {
        return;
    }
    let x = i32(pixel % params.width);
    let y = i32(pixel / params.width);

    // look at all borders between pixels that lines may come from
    let reach = i32(ceil(0.5 * max(style.outline_width, style.border_width) + 0.5));
    var line = 0.0;
    var border = 0.0;
    for (var j = max(y - reach, 0); j <= min(y + reach, i32(params.height) - 1); j++) {
        for (var i = max(x - reach, 0); i <= min(x + reach, i32(params.width) - 1); i++) {
            let own = u32(j) * params.width + u32(i);
            for (var k = 0; k < 2; k++) {
                let ni = i + 1 - k;
                let nj = j + k;
                if ni >= i32(params.width) || nj >= i32(params.height) {
                    continue;
                }
                let next = u32(nj) * params.width + u32(ni);
                // from the pixel's centre to the border between the two
                let centre = vec2<f32>(f32(i - x) + 0.5 * f32(1 - k), f32(j - y) + 0.5 * f32(k));
                let past = max(abs(centre) - 0.5 * vec2<f32>(f32(k), f32(1 - k)), vec2<f32>(0.0));
                let distance = length(past);
                if differ(own, next) {
                    line = max(line, covered(distance, width_at(own, next), 1.0));
                }
                if style.border_width > 0.0 && word(PLANE_PIECE_ID, own) != word(PLANE_PIECE_ID, next) {
                    border = max(border, covered(distance, style.border_width, 1.0));
                }
            }
        }
    }

    // draw them
    mixed(PLANE_R, pixel, style.border.x, border, style.outline.x, line);
    mixed(PLANE_G, pixel, style.border.y, border, style.outline.y, line);
    mixed(PLANE_B, pixel, style.border.z, border, style.outline.z, line);
}

fn mixed(plane: u32, pixel: u32, border: f32, border_share: f32, line: f32, line_share: f32) {
    let at = plane * params.width * params.height + pixel;
    let under = mix(bitcast<f32>(planes[at]), border, border_share);
    planes[at] = bitcast<u32>(mix(under, line, line_share));
}
