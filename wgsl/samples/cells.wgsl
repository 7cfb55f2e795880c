// Which cell a sample's ray belongs to. Per cell: the pixels with any sample in it, those with all, and for each sample the pixels
// that have it there.

var<storage, read> cell_samples: array<vec2<u32>>;

// Samples per pixel.
override SAMPLES: u32 = 1u;

// Strips of four samples per pixel.
override STRIPS: u32 = 1u;

// All samples, one bit each.
fn all_samples() -> u32 {
    return 0xffffffffu >> (32u - SAMPLES);
}

fn cell_at(cell: u32) -> u32 {
    return cell * (SAMPLES + 2u);
}

fn pixels_in_part(cell: u32) -> vec2<u32> {
    return cell_samples[cell_at(cell)];
}

fn pixels_whole(cell: u32) -> vec2<u32> {
    return cell_samples[cell_at(cell) + 1u];
}

fn pixels_of_sample(cell: u32, sample: u32) -> vec2<u32> {
    return cell_samples[cell_at(cell) + 2u + sample];
}
