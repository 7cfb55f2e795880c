// All that trace meets are triangles.

#import rays/seen
#import rays/stretch
#import vertices/traced

fn with_primitive(path: Path, stretch: Stretch, before: Seen, own: BvhTriangle) -> Seen {
    return with_triangle(path, stretch, before, own);
}
