//! Progress of long computations.

/// Receives the progress of a computation.
pub trait Progress: Sync {
    /// The study `name` begins: number `number` of `of`.
    fn study(&self, name: &str, number: usize, of: usize) {
        let _ = (name, number, of);
    }
    /// The computation `what` of `total` parts begins.
    fn begin(&self, what: &str, total: usize);
    /// One part is done.
    fn advance(&self);
    /// The computation is done.
    fn end(&self);
}

/// Discards progress.
#[derive(Clone, Copy, Debug, Default)]
pub struct Silent;

impl Progress for Silent {
    fn begin(&self, _: &str, _: usize) {}
    fn advance(&self) {}
    fn end(&self) {}
}
