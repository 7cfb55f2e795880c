// What a path meets, through one hierarchy of all triangles.
// Provides: followed
// Needs: Followed, Path, Seen, Stretch, bvh_root, walked

fn followed(path: Path, stretch: Stretch, before: Seen, rounds_before: u32) -> Followed {
    return walked(path, stretch, before, rounds_before, bvh_root());
}
