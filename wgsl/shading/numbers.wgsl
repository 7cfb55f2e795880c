// Lighting parameters.

var<uniform> shading: Shading;

struct Shading {
    background: vec3<f32>,
    ambient: f32,
    anchor: vec3<f32>,      // what positions are relative to
    light_count: u32,       // 0: one headlight along each pixel's ray
    gain: f32,              // of the 8-bit picture: by what light is multiplied, and one of the CURVE constants
    curve: u32,
    filter_width: f32,      // of images, in pixels
    shadow_bvh_scale: f32,  // factor of coordinates in the hierarchy that shadow rays are traced in
    sky: u32,               // index of the material whose image is the light from all around; NONE: there is none
    sky_strength: f32,
    sky_rotation: f32,
    sky_is_seen: u32,
    occlusion_rays: u32,    // by which it is found how much is near a hit; 0: that does not count
    occlusion_reach: f32,
    nodes_first: u32,       // indices in `lights` where the hierarchy begins that hides them, and where its triangles do
    leaves_first: u32,
    pictures_first: u32,    // index in `lights` of the pictures that are thrown onto surfaces, and how many there are
    picture_count: u32,
    masks_first: u32,       // index in `lights` of the alpha masks of shadow casters
    pad0: u32,
    irradiance: array<vec4<f32>, 9>,
}
