// The slot of a triangle.

#import shared/params.wgsl

var<storage, read> slot_of_id: array<u32>;

fn slot_of(id: u32) -> u32 {
    return slot_of_id[id - params.id_first];
}
