//! The functions that a page calls.
//!
//! A page writes a request into the memory that [`request`] returns, and reads the answer of [`answer`], whose first four bytes are its
//! length.

#![allow(unsafe_code, reason = "exported functions take addresses")]

use std::cell::RefCell;

thread_local! {
    static REQUEST: RefCell<Vec<u8>> = const { RefCell::new(Vec::new()) };
    static ANSWER: RefCell<Vec<u8>> = const { RefCell::new(Vec::new()) };
}

/// Memory for a request of `length` bytes.
// SAFETY: no other function of the module has this name.
#[unsafe(no_mangle)]
pub extern "C" fn request(length: usize) -> *mut u8 {
    REQUEST.with_borrow_mut(|request| {
        request.clear();
        request.resize(length, 0);
        request.as_mut_ptr()
    })
}

/// The answer to the request in memory, as of [`Answer::to_bytes`](crate::Answer::to_bytes) after its length in four bytes.
// SAFETY: no other function of the module has this name.
#[unsafe(no_mangle)]
pub extern "C" fn answer() -> *const u8 {
    let request = REQUEST.with_borrow(|bytes| String::from_utf8_lossy(bytes).into_owned());
    let bytes = crate::answer(&request).to_bytes();
    ANSWER.with_borrow_mut(|answer| {
        answer.clear();
        answer.extend((bytes.len() as u32).to_le_bytes());
        answer.extend(bytes);
        answer.as_ptr()
    })
}
