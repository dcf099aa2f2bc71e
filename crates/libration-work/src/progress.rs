//! How far work is.

/// Told how far the work is. Work itself knows no terminal.
pub trait Progress: Sync {
    /// The study `name` begins, the `number`-th of `of`.
    fn study(&self, name: &str, number: usize, of: usize) {
        let _ = (name, number, of);
    }
    /// `what` begins; it has `total` parts of about equal size.
    fn begin(&self, what: &str, total: usize);
    /// One part is done.
    fn advance(&self);
    /// All that began is done.
    fn end(&self);
}

/// Reports nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct Silent;

impl Progress for Silent {
    fn begin(&self, _: &str, _: usize) {}
    fn advance(&self) {}
    fn end(&self) {}
}
