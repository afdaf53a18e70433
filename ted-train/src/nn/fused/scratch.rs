//! Buffers that are used again: a step of the learner allocates nothing that is large.

use std::cell::RefCell;
use std::ops::{Deref, DerefMut};

use super::layout::{Row, ZERO};

/// Buffers that a thread keeps; more than a step of the learner has in use at a time.
const KEPT: usize = 16;

thread_local! {
    static SPARE: RefCell<Vec<Vec<Row>>> = const { RefCell::new(Vec::new()) };
}

/// Rows that hold anything until they are written. The last one given back is the first to be used again, because it is
/// in the cache.
#[derive(Debug)]
pub(super) struct Scratch {
    /// At least as long as what was asked for: to cut it would mean to fill it up again.
    buffer: Vec<Row>,
    rows: usize,
}

impl Scratch {
    pub(super) fn new(rows: usize) -> Self {
        let buffer = SPARE.with_borrow_mut(|spare| {
            let fits = spare.iter().rposition(|buffer| buffer.len() >= rows);
            fits.map_or_else(|| vec![ZERO; rows], |at| spare.remove(at))
        });
        Self { buffer, rows }
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        let buffer = std::mem::take(&mut self.buffer);
        // A thread that is ending has none left to give it to.
        let _ = SPARE.try_with(|spare| {
            let mut spare = spare.borrow_mut();
            if spare.len() == KEPT {
                spare.remove(0);
            }
            spare.push(buffer);
        });
    }
}

impl Deref for Scratch {
    type Target = [Row];

    fn deref(&self) -> &[Row] {
        &self.buffer[..self.rows]
    }
}

impl DerefMut for Scratch {
    fn deref_mut(&mut self) -> &mut [Row] {
        &mut self.buffer[..self.rows]
    }
}
