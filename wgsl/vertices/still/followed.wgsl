// What a path meets, through one hierarchy of all triangles.

#import hierarchy/followed.wgsl
#import rays/stretch
#import vertices/traced

fn followed(path: Path, stretch: Stretch, before: Seen, rounds_before: u32) -> Followed {
    return walked(path, stretch, before, rounds_before, bvh_root());
}
