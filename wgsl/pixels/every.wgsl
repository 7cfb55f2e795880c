// Every pixel of the band is taken.

#import shared/items.wgsl
#import shared/params.wgsl

// The column and the row of a thread's pixel; below the band where it has none.
fn pixel_at(group: vec3<u32>, groups: vec3<u32>, lane: u32) -> vec2<u32> {
    let pixel = item_index(group, groups, lane);
    return vec2<u32>(pixel % params.width, pixel / params.width);
}
