// Constant ambient light and background.

#import shading/numbers.wgsl

const SKY: bool = false;

fn from_around(base: vec3<f32>, f0: vec3<f32>, alpha: f32, n: vec3<f32>, v: vec3<f32>) -> vec3<f32> {
    return shading.ambient * (base + f0);
}

// Colour of a pixel that hits nothing.
fn beyond(x: u32, y: u32) -> vec3<f32> {
    return shading.background;
}
