// Tables in textures.

#import shared/params.wgsl

// The place of a texel of a table.
fn table_texel(index: u32) -> vec2<u32> {
    return vec2<u32>(index % TEXELS_A_ROW, index / TEXELS_A_ROW);
}
