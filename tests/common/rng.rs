//! Random numbers that follow from a seed alone.

#[path = "../../src/testing.rs"]
mod testing;
pub use testing::Rng;

impl Rng {
    /// 0 .. n in any order.
    pub fn shuffled(&mut self, n: usize) -> Vec<usize> {
        let mut order: Vec<usize> = (0..n).collect();
        for k in (1..n).rev() {
            order.swap(k, self.below(k + 1));
        }
        order
    }
}
