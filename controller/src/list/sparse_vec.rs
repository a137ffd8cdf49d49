//! A bounded list that allocates memory on demand.

use alloc::vec::Vec;
use core::marker::PhantomData;
use core::ops::{Deref, DerefMut};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// At most `N` items, with the functions of [`heapless::Vec`].
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct SparseVec<T, const N: usize, L = usize>(Vec<T>, PhantomData<L>);

/// Bytes by which a list grows, about: unused memory of that size costs less than moves.
const STEP: usize = 48;

impl<T, const N: usize, L> SparseVec<T, N, L> {
    pub(crate) const fn new() -> Self {
        Self(Vec::new(), PhantomData)
    }

    pub(crate) fn is_full(&self) -> bool {
        self.0.len() >= N
    }

    pub(crate) fn push(&mut self, item: T) -> Result<(), T> {
        if self.is_full() {
            return Err(item);
        }
        if self.0.len() == self.0.capacity() {
            let step = STEP.checked_div(size_of::<T>()).unwrap_or(1).clamp(1, 4);
            self.0.reserve_exact(step.max(self.0.len() >> 2));
        }
        self.0.push(item);
        Ok(())
    }

    pub(crate) fn pop(&mut self) -> Option<T> {
        self.0.pop()
    }

    pub(crate) fn retain(&mut self, is_kept: impl FnMut(&T) -> bool) {
        self.0.retain(is_kept);
    }

    /// Also releases the memory.
    pub(crate) fn clear(&mut self) {
        self.0 = Vec::new();
    }
}

impl<T, const N: usize, L> Default for SparseVec<T, N, L> {
    fn default() -> Self {
        Self::new()
    }
}

impl<T, const N: usize, L> Deref for SparseVec<T, N, L> {
    type Target = [T];
    fn deref(&self) -> &[T] {
        &self.0
    }
}

impl<T, const N: usize, L> DerefMut for SparseVec<T, N, L> {
    fn deref_mut(&mut self) -> &mut [T] {
        &mut self.0
    }
}

impl<'a, T, const N: usize, L> IntoIterator for &'a SparseVec<T, N, L> {
    type Item = &'a T;
    type IntoIter = core::slice::Iter<'a, T>;
    fn into_iter(self) -> Self::IntoIter {
        self.0.iter()
    }
}

impl<'a, T, const N: usize, L> IntoIterator for &'a mut SparseVec<T, N, L> {
    type Item = &'a mut T;
    type IntoIter = core::slice::IterMut<'a, T>;
    fn into_iter(self) -> Self::IntoIter {
        self.0.iter_mut()
    }
}

// Like `heapless::Vec`, so that digests are equal.
impl<T: Serialize, const N: usize, L> Serialize for SparseVec<T, N, L> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.deref().serialize(serializer)
    }
}

impl<'de, T: Deserialize<'de>, const N: usize, L> Deserialize<'de> for SparseVec<T, N, L> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let items = heapless::Vec::<T, N>::deserialize(deserializer)?;
        Ok(Self(items.into_iter().collect(), PhantomData))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::digest::digest;

    #[test]
    fn it_takes_as_many_as_a_fixed_list_and_reads_the_same() {
        let (mut seldom, mut fixed) = (SparseVec::<u32, 9>::new(), heapless::Vec::<u32, 9>::new());
        assert_eq!(digest(&seldom), digest(&fixed));
        for item in 0..12 {
            assert_eq!(seldom.push(item), fixed.push(item));
            assert_eq!((&*seldom, seldom.is_full()), (&*fixed, fixed.is_full()));
            assert_eq!(digest(&seldom), digest(&fixed));
        }
        assert_eq!((seldom.pop(), fixed.pop()), (Some(8), Some(8)));
        seldom.retain(|item| item % 2 == 0);
        fixed.retain(|item| item % 2 == 0);
        assert_eq!(*seldom, *fixed);
        seldom.clear();
        assert_eq!((seldom.len(), seldom.pop(), SparseVec::<u32, 0>::new().push(1)), (0, None, Err(1)));
    }
}
