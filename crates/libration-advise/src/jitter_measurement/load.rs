//! Load on all cores.

use std::hint::black_box;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::thread::JoinHandle;

/// A thread per core that computes and reads memory until the value is dropped.
pub(super) struct Load {
    stop: Arc<AtomicBool>,
    threads: Vec<JoinHandle<()>>,
}

/// Numbers per thread: more than the nearest caches hold.
const NUMBERS: usize = 1 << 20;

impl Load {
    /// Starts the threads.
    pub(super) fn begin() -> Self {
        let stop = Arc::new(AtomicBool::new(false));
        let cores = thread::available_parallelism().map_or(1, usize::from);
        let work = |stop: Arc<AtomicBool>| {
            let mut numbers = vec![1.0_f64; NUMBERS];
            while !stop.load(Ordering::Relaxed) {
                numbers.iter_mut().for_each(|x| *x = 0.5 * *x + x.sqrt());
                black_box(&mut numbers);
            }
        };
        let threads = (0..cores).map(|_| {
            thread::spawn({
                let stop = stop.clone();
                move || work(stop)
            })
        });
        Load { threads: threads.collect(), stop }
    }
}

impl Drop for Load {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        for thread in self.threads.drain(..) {
            // It only computes.
            let _ = thread.join();
        }
    }
}
