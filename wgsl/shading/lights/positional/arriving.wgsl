// Distant and point lights of any colour: two vec4s each. The first is the direction of travel, or the position and the distance
// at which its colour applies; the second the colour, and 1 if triangles cast shadows. Pictures that are lights: -1 at the end of the
// first, and their number.

#import shading/lights/openness
#import shading/lights/rows.wgsl
#import shading/pictures
#import shading/surface.wgsl

fn arriving(k: u32, lit: Lit) -> Arriving {
    let from_there = light_row(2u * k);
    if PICTURES && from_there.w < 0.0 {
        return thrown(bitcast<u32>(from_there.x), lit);
    }
    let colour = light_row(2u * k + 1u);
    var l = -from_there.xyz;
    var strength = colour.xyz;
    // infinity
    var far = bitcast<f32>(0x7f7fffffu);
    if from_there.w > 0.0 {
        let to_light = from_there.xyz - lit.p;
        let most = max(largest(to_light), 1e-30);
        far = most * max(length(to_light / most), 1e-30);
        l = to_light / far;
        let nearness = from_there.w / far;
        strength *= nearness * nearness;
    }
    if colour.w > 0.0 && dot(lit.n, l) > 0.0 && !reaches(lit, l, far) {
        strength = vec3<f32>(0.0);
    }
    return Arriving(l, strength);
}
