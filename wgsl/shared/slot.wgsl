// The slot of a triangle.
// Provides: slot_of
// Binds: params, slot_of_id

fn slot_of(id: u32) -> u32 {
    return slot_of_id[id - params.id_first];
}
