//! Work shared among threads, with results that do not depend on their number: every piece of work has its own
//! place in the result, and sums are taken over blocks of fixed size in a fixed order.
//!
//! Without the feature `parallel` the same blocks are worked through by one thread.

use std::ops::Range;

#[cfg(feature = "parallel")]
use rayon::prelude::*;

/// Items of one block of a sum, and the least work worth a thread.
const BLOCK: usize = 256;

/// The fewest elements of chunks worth a thread, whose work is a few operations an element.
#[cfg(feature = "parallel")]
const CHUNKED: usize = 4096;

/// Blocks that `count` items make.
pub fn blocks(count: usize) -> usize {
    count.div_ceil(BLOCK)
}

/// `[work(0), work(1), ...]`, `count` of them.
pub fn map<T: Send>(count: usize, work: impl Fn(usize) -> T + Sync + Send) -> Vec<T> {
    #[cfg(feature = "parallel")]
    return (0..count).into_par_iter().with_min_len(BLOCK).map(work).collect();
    #[cfg(not(feature = "parallel"))]
    (0..count).map(work).collect()
}

/// `[work(0..256), work(256..512), ...]` in one row, for `count` items, of which each has one result.
pub fn map_blocks<T: Send>(count: usize, work: impl Fn(Range<usize>) -> Vec<T> + Sync + Send) -> Vec<T> {
    let block = |b: usize| work(b * BLOCK..((b + 1) * BLOCK).min(count));
    #[cfg(feature = "parallel")]
    return (0..blocks(count)).into_par_iter().flat_map_iter(block).collect();
    #[cfg(not(feature = "parallel"))]
    (0..blocks(count)).flat_map(block).collect()
}

/// The sum of `term(0) + term(1) + ...`, `count` of them: the same bits for any number of threads.
pub fn sum(count: usize, term: impl Fn(usize) -> f64 + Sync + Send) -> f64 {
    let block = |b: usize| (b * BLOCK..((b + 1) * BLOCK).min(count)).map(&term).sum::<f64>();
    let blocks = blocks(count);
    #[cfg(feature = "parallel")]
    let sums: Vec<f64> = (0..blocks).into_par_iter().with_min_len(16).map(block).collect();
    #[cfg(not(feature = "parallel"))]
    let sums: Vec<f64> = (0..blocks).map(block).collect();
    sums.into_iter().sum()
}

/// Calls `work(i, &mut items[i], chunk i of flat)` for every item; the chunks have `flat.len() / items.len()` elements.
pub fn for_each_with_chunk<T: Send, U: Send>(
    items: &mut [T],
    flat: &mut [U],
    work: impl Fn(usize, &mut T, &mut [U]) + Sync + Send,
) {
    for_each_with_scratch(items, flat, || (), |(), i, item, part| work(i, item, part));
}

/// The same with something of its own for every thread, to work in; results must not depend on what is in it.
pub fn for_each_with_scratch<T: Send, U: Send, S>(
    items: &mut [T],
    flat: &mut [U],
    scratch: impl Fn() -> S + Sync + Send,
    work: impl Fn(&mut S, usize, &mut T, &mut [U]) + Sync + Send,
) {
    if items.is_empty() {
        return;
    }
    let chunk = (flat.len() / items.len()).max(1);
    #[cfg(feature = "parallel")]
    items
        .par_iter_mut()
        .zip(flat.par_chunks_mut(chunk))
        .with_min_len(16)
        .enumerate()
        .for_each_init(scratch, |scratch, (i, (item, part))| work(scratch, i, item, part));
    #[cfg(not(feature = "parallel"))]
    {
        let mut scratch = scratch();
        for (i, (item, part)) in items.iter_mut().zip(flat.chunks_mut(chunk)).enumerate() {
            work(&mut scratch, i, item, part);
        }
    }
}

/// Calls `work(i, chunk i of flat)` for every chunk of `length` elements.
pub fn for_each_chunk<T: Send>(flat: &mut [T], length: usize, work: impl Fn(usize, &mut [T]) + Sync + Send) {
    let length = length.max(1);
    #[cfg(feature = "parallel")]
    flat.par_chunks_mut(length)
        .with_min_len(CHUNKED.div_ceil(length))
        .enumerate()
        .for_each(|(i, chunk)| work(i, chunk));
    #[cfg(not(feature = "parallel"))]
    flat.chunks_mut(length).enumerate().for_each(|(i, chunk)| work(i, chunk));
}

/// Calls `work(first, items, part of flat, result)` for every block of items, `first` being the number of its first one; an item
/// has `flat.len() / items.len()` elements of `flat`, and a block has one of the [`blocks`] results.
pub fn for_each_block<T: Send, U: Send, R: Send>(
    items: &mut [T],
    flat: &mut [U],
    results: &mut [R],
    work: impl Fn(usize, &mut [T], &mut [U], &mut R) + Sync + Send,
) {
    if items.is_empty() {
        return;
    }
    let width = (flat.len() / items.len()).max(1);
    #[cfg(feature = "parallel")]
    items
        .par_chunks_mut(BLOCK)
        .zip(flat.par_chunks_mut(BLOCK * width))
        .zip(results)
        .enumerate()
        .for_each(|(block, ((items, flat), result))| work(block * BLOCK, items, flat, result));
    #[cfg(not(feature = "parallel"))]
    items
        .chunks_mut(BLOCK)
        .zip(flat.chunks_mut(BLOCK * width))
        .zip(results)
        .enumerate()
        .for_each(|(block, ((items, flat), result))| work(block * BLOCK, items, flat, result));
}
