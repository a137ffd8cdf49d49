//! Functions on fixed lists that provably cannot panic: those of [`heapless::Vec`] (extend,
//! collect, remove, sort, iteration by value) leave a panic in the firmware.

use heapless::{LenType, Vec};

/// A list that is short in nearly all robots, such as pending requests. Firmware reserves its
/// memory, with a length of type `L`; hosts with many robots allocate it on demand.
#[cfg(all(not(feature = "host"), any(feature = "route", feature = "wire")))]
pub(crate) type SparseVec<T, const N: usize, L = usize> = heapless::Vec<T, N, L>;
#[cfg(feature = "host")]
pub(crate) use sparse_vec::SparseVec;

#[cfg(feature = "host")]
mod sparse_vec;

/// Drops items beyond the capacity.
pub(crate) fn extend<T, L: LenType, const N: usize>(list: &mut Vec<T, N, L>, items: impl IntoIterator<Item = T>) {
    for item in items {
        if list.push(item).is_err() {
            break;
        }
    }
}

pub(crate) fn collect<T, const N: usize>(items: impl IntoIterator<Item = T>) -> Vec<T, N> {
    let mut list = Vec::new();
    extend(&mut list, items);
    list
}

/// Moves the last item towards the front past all items that must come after it.
/// It copies, because `mem::swap` moves one word at a time in a loop.
pub(crate) fn sink_last<T: Copy>(items: &mut [T], must_swap: impl Fn(&T, &T) -> bool) {
    for i in (1..items.len()).rev() {
        match items.get_mut(i - 1..=i) {
            Some([before, after]) if must_swap(before, after) => (*before, *after) = (*after, *before),
            _ => break,
        }
    }
}

/// Sorts a short list by distinct keys. O(n^2).
#[cfg(feature = "negotiation")]
pub(crate) fn sort_by_key<T: Copy, K: Ord>(items: &mut [T], key: impl Fn(&T) -> K) {
    for end in 1..=items.len() {
        sink_last(items.get_mut(..end).unwrap_or_default(), |before, after| key(before) > key(after));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_full_list_takes_nothing_more() {
        let mut list = Vec::<_, 3>::from_array([1, 2]);
        extend(&mut list, [3, 4, 5]);
        assert_eq!(list, [1, 2, 3]);
        assert_eq!(collect::<_, 2>(7..), [7, 8]);
    }

    #[test]
    fn the_last_item_sinks_and_the_others_keep_their_order() {
        let mut items = [1, 3, 5, 7, 4];
        sink_last(&mut items, |before, after| before > after);
        assert_eq!(items, [1, 3, 4, 5, 7]);
    }
}
