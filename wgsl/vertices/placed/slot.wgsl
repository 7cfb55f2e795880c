// The slot of a triangle of a mesh that stands in several places.

#import vertices/placed/vertex.wgsl

var<storage, read> slot_of_id: array<u32>;

fn slot_of(id: u32) -> u32 {
    let head = row_of(last_instance(4u, 1u, id), 0u);
    return slot_of_id[id - head.z] + head.y;
}
