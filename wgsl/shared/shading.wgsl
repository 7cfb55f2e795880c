// Lighting parameters; and the plane of each channel, NONE if it is not rendered.
// Provides: PLANE_A, PLANE_ALBEDO_B, PLANE_ALBEDO_G, PLANE_ALBEDO_R, PLANE_B, PLANE_BARY_U, PLANE_BARY_V, PLANE_G, PLANE_MIRROR_ID,
//   PLANE_N_X, PLANE_N_Y, PLANE_N_Z, PLANE_PIECE_ID, PLANE_P_X, PLANE_P_Y, PLANE_P_Z, PLANE_R, PLANE_T, PLANE_TRIANGLE_ID, PLANE_UV_U,
//   PLANE_UV_V, PLANE_Z, Shading

override PLANE_R: u32 = 0xffffffffu;
override PLANE_G: u32 = 0xffffffffu;
override PLANE_B: u32 = 0xffffffffu;
override PLANE_A: u32 = 0xffffffffu;
override PLANE_Z: u32 = 0xffffffffu;
override PLANE_T: u32 = 0xffffffffu;
override PLANE_TRIANGLE_ID: u32 = 0xffffffffu;
override PLANE_PIECE_ID: u32 = 0xffffffffu;
override PLANE_BARY_U: u32 = 0xffffffffu;
override PLANE_BARY_V: u32 = 0xffffffffu;
override PLANE_MIRROR_ID: u32 = 0xffffffffu;
override PLANE_N_X: u32 = 0xffffffffu;
override PLANE_N_Y: u32 = 0xffffffffu;
override PLANE_N_Z: u32 = 0xffffffffu;
override PLANE_P_X: u32 = 0xffffffffu;
override PLANE_P_Y: u32 = 0xffffffffu;
override PLANE_P_Z: u32 = 0xffffffffu;
override PLANE_ALBEDO_R: u32 = 0xffffffffu;
override PLANE_ALBEDO_G: u32 = 0xffffffffu;
override PLANE_ALBEDO_B: u32 = 0xffffffffu;
override PLANE_UV_U: u32 = 0xffffffffu;
override PLANE_UV_V: u32 = 0xffffffffu;

struct Shading {
    background: vec3<f32>,
    ambient: f32,
    anchor: vec3<f32>,      // what positions are relative to
    light_count: u32,       // 0: one headlight along each pixel's ray
    gain: f32,              // of the 8-bit picture: by what light is multiplied, and one of the CURVE constants
    curve: u32,
    spread: f32,            // of a pixel: how wide images are filtered
    hidden_scale: f32,      // by which numbers of the hierarchy are multiplied that hides lights
    sky: u32,               // the row of the material whose image is the light from all around; NONE: there is none
    sky_strength: f32,
    sky_rotation: f32,
    sky_is_seen: u32,
    occlusion_rays: u32,    // by which it is found how much is near a hit; 0: that does not count
    occlusion_reach: f32,
    nodes_first: u32,       // rows of `lights` where the hierarchy begins that hides them, and where its triangles do
    leaves_first: u32,
    irradiance: array<vec4<f32>, 9>,
}
