// The slot of a triangle of a mesh that stands in several places.
// Provides: slot_of
// Needs: last_instance, row_of
// Binds: slot_of_id

fn slot_of(id: u32) -> u32 {
    let head = row_of(last_instance(4u, 1u, id), 0u);
    return slot_of_id[id - head.z] + head.y;
}
