//! Images of one size, one below another.

/// Images of one size, one below another. Between them are rows of pixels without rays.
#[derive(Debug, Clone)]
pub(super) struct Stack<T> {
    pub images: Vec<T>,
    /// Rows from the top of an image to that of the next.
    pub step: u32,
}

impl<T> Stack<T> {
    /// The number of the image that row `j` belongs to, or lies below, and the row's number there.
    pub fn at(&self, j: u32) -> (usize, u32) {
        ((j / self.step) as usize, j % self.step)
    }
}
