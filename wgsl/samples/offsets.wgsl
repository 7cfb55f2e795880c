// Offsets of samples from their pixel's centre, px right and down.

#import shared/params.wgsl

var<uniform> sample_offsets: SampleOffsets;

fn sample_offset(sample: u32) -> vec2<f32> {
    let two = sample_offsets.at[sample / 2u];
    return select(two.xy, two.zw, (sample & 1u) == 1u);
}
