// subgroup_width: one thread per place of a workgroup. Reads how many threads its subgroup has; writes that.

var<storage, read_write> found: array<u32>;

@compute @workgroup_size(64)
fn subgroup_width(
    @builtin(local_invocation_index) lane: u32,
    @builtin(subgroup_size) width: u32,
) {
    found[lane] = width;
}
