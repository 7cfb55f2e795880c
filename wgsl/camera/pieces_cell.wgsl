// The bounds of one piece's rays over a tile.

// What rounding of the rows and of what is computed from them may add to a radius: four roundings of 2^-24.
const CELL_SLACK: f32 = 1.0 / 4194304.0;

// The pixels of a cell's tile that the triangle may cover by the cell's own rays. All, where its weight is not constant.
fn cell_pixels(index: u32, v0: vec3<f32>, v1: vec3<f32>, v2: vec3<f32>) -> vec4<u32> {
    let cell = cells[index];
    let piece = pieces[cell.piece];
    if piece.hx_hi != 0.0 || piece.hy_hi != 0.0 {
        return vec4<u32>(0u, 0u, TILE, TILE);
    }
    // node units are half a tile
    let half = 0.5 * f32(TILE) / cell.h;
    var node: Node;
    node.rays = RAYS_AFFINE;
    node.p = cell.p / cell.h;
    node.px = half * piece.px_hi;
    node.py = half * piece.py_hi;
    node.d = cell.d / cell.h;
    node.dx = half * piece.dx_hi;
    node.dy = half * piece.dy_hi;
    node.r_p = CELL_SLACK * (length(node.p) + length(node.px) + length(node.py));
    node.r_d = CELL_SLACK * (length(node.d) + length(node.dx) + length(node.dy));
    if !may_cover(conics(node, v0, v1, v2), 0.0, 0.0, CENTRES) {
        return vec4<u32>(0u);
    }
    return pixels_within(extent(node, v0, v1, v2), TILE);
}
