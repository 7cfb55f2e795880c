// All that trace meets are triangles.
// Provides: with_primitive
// Needs: BvhTriangle, Path, Seen, Stretch, with_triangle

fn with_primitive(path: Path, stretch: Stretch, before: Seen, own: BvhTriangle) -> Seen {
    return with_triangle(path, stretch, before, own);
}
