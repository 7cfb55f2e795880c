// Whose ray a sample has. Of each cell: the pixels that have any sample in it, those that have all, and of each sample the pixels
// that have it there.
// Provides: SAMPLES, STRIPS, all_samples, pixels_in_part, pixels_of_sample, pixels_whole
// Binds: cell_samples

// Samples of a pixel.
override SAMPLES: u32 = 1u;

// Strips of four samples that a pixel has.
override STRIPS: u32 = 1u;

// All of them, a bit each.
fn all_samples() -> u32 {
    return 0xffffffffu >> (32u - SAMPLES);
}

fn cell_row(cell: u32) -> u32 {
    return cell * (SAMPLES + 2u);
}

fn pixels_in_part(cell: u32) -> vec2<u32> {
    return cell_samples[cell_row(cell)];
}

fn pixels_whole(cell: u32) -> vec2<u32> {
    return cell_samples[cell_row(cell) + 1u];
}

fn pixels_of_sample(cell: u32, sample: u32) -> vec2<u32> {
    return cell_samples[cell_row(cell) + 2u + sample];
}
