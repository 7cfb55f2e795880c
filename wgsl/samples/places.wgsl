// Offsets of samples from their pixel's centre, px right and down.
// Provides: sample_place
// Binds: places

fn sample_place(sample: u32) -> vec2<f32> {
    let two = places.at[sample / 2u];
    return select(two.xy, two.zw, (sample & 1u) == 1u);
}
