//! The same work on several threads at once.

/// Runs `work` on each part on a thread of its own, and waits for all.
pub(crate) fn together<P: Send>(parts: impl IntoIterator<Item = P>, work: impl Fn(P) + Sync) {
    let work = &work;
    std::thread::scope(|scope| {
        for part in parts {
            scope.spawn(move || work(part));
        }
    });
}
