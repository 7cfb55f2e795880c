// White distant lights without shadows: one vec4 each, the direction of travel.

#import shading/lights/rows.wgsl
#import shading/surface.wgsl

fn arriving(k: u32, lit: Lit) -> Arriving {
    return Arriving(-light_row(k).xyz, vec3<f32>(1.0));
}
