// Structs of the kernels of gradients, as in src/gpu/layout.rs; tests/wgsl_layout.rs compares the two.

var<uniform> gradient_params: GradientParams;

// Some rows of an image.
struct GradientParams {
    width: u32,
    rows: u32,              // of the tables of rays and of slots: those below, and one above and below them if the image has it
    first: u32,             // number of the first pixel that is written, in the tables
    pixels: u32,            // written
    directions: u32,        // CORNER_DIRECTIONS; or 1, that of `ray_rates`
    pixel_first: u32,       // number of the tables' first pixel in the image
    pad0: u32,
    pad1: u32,
}
