//! Access to the caller's memory. Only this module turns pointers into references, after all
//! possible checks.

use crate::status::{Checked, StayaStatus};
use core::ffi::{CStr, c_char, c_void};
use core::marker::PhantomData;
use core::mem::MaybeUninit;
use core::ptr::NonNull;

/// Types for which any bytes are a valid value, so that memory written by C may be read: integers,
/// floats, pointers, arrays and structures of these.
///
/// # Safety
/// No field may be a `bool`, an enum or a reference.
pub(crate) unsafe trait Plain {}

macro_rules! plain {
    ($($type:ty),* $(,)?) => {
        // SAFETY: numbers, or a structure of numbers, pointers and arrays of them.
        $(unsafe impl $crate::memory::Plain for $type {})*
    };
}
pub(crate) use plain;

plain!(i8, u8, u32, i32, f32, u64, usize);

// SAFETY: any bytes are a valid raw pointer, including null; it is not dereferenced.
unsafe impl<T> Plain for *mut T {}

// SAFETY: any bytes are a valid array if they are valid for its elements.
unsafe impl<T: Plain, const N: usize> Plain for [T; N] {}

/// A type that lives in the caller's memory and is marked by its first word.
///
/// # Safety
/// `repr(C)`, and its first field is a `u32`.
pub(crate) unsafe trait Resident: Sized {
    const MARK: u32;
}

pub(crate) fn check<T>(pointer: *const T) -> Checked<()> {
    if pointer.is_null() {
        Err(StayaStatus::Null)
    } else if !pointer.is_aligned() {
        Err(StayaStatus::Alignment)
    } else {
        Ok(())
    }
}

/// Any pointer for no elements.
fn check_row<T>(first: *const T, count: usize) -> Checked<*const T> {
    if count == 0 {
        return Ok(NonNull::dangling().as_ptr());
    }
    check(first)?;
    let fits = count.saturating_mul(size_of::<T>()) <= isize::MAX.unsigned_abs();
    if fits { Ok(first) } else { Err(StayaStatus::TooMany) }
}

/// Runs a function that C calls, with its [`Call`].
macro_rules! answers {
    ($run:expr) => {
        // SAFETY: C keeps the promises of the header's introduction.
        unsafe { $crate::memory::Call::new() }.answers($run)
    };
}
pub(crate) use answers;

/// One call from C, whose pointers its methods check and use: each is null, misaligned, or as the
/// header's introduction requires.
#[derive(Clone, Copy)]
pub(crate) struct Call<'a>(PhantomData<&'a ()>);

impl<'a> Call<'a> {
    /// # Safety
    /// All pointers that the methods get come from C, which keeps the promises of the header's
    /// introduction for their types until the call returns.
    pub(crate) const unsafe fn new() -> Self {
        Self(PhantomData)
    }

    /// Runs the call; no reference outlives it.
    pub(crate) fn answers(self, run: impl for<'c> FnOnce(Call<'c>) -> Checked<()>) -> StayaStatus {
        match run(self) {
            Ok(()) => StayaStatus::Ok,
            Err(status) => status,
        }
    }

    /// Reads a value.
    pub(crate) fn shared<T: Plain>(self, pointer: *const T) -> Checked<&'a T> {
        check(pointer)?;
        // SAFETY: neither null nor misaligned, and so valid. Any bytes are a `T`.
        Ok(unsafe { &*pointer })
    }

    /// Like [`Self::shared`], but null is permitted.
    pub(crate) fn optional<T: Plain>(self, pointer: *const T) -> Checked<Option<&'a T>> {
        if pointer.is_null() { Ok(None) } else { self.shared(pointer).map(Some) }
    }

    /// Reads `count` consecutive values; null with 0 is empty.
    pub(crate) fn row<T: Plain>(self, first: *const T, count: usize) -> Checked<&'a [T]> {
        let first = check_row(first, count)?;
        // SAFETY: valid for `count` values, and within the limits of memory.
        Ok(unsafe { core::slice::from_raw_parts(first, count) })
    }

    /// Reads a text that ends with a zero; one that is not UTF-8 is empty.
    pub(crate) fn text(self, text: *const c_char) -> Checked<&'a str> {
        check(text)?;
        // SAFETY: not null, and so a text.
        Ok(unsafe { CStr::from_ptr(text) }.to_str().unwrap_or_default())
    }

    /// Writes a whole result, overwriting any previous bytes.
    pub(crate) fn write<T: Plain>(self, to: *mut T, value: T) -> Checked<()> {
        check(to)?;
        // SAFETY: neither null nor misaligned, and so space for a `T`.
        unsafe { to.write(value) };
        Ok(())
    }

    /// Zeroed space for a result that is written in pieces.
    pub(crate) fn zeroed<T: Plain>(self, to: *mut T) -> Checked<&'a mut T> {
        check(to)?;
        // SAFETY: neither null nor misaligned, and so space for a `T`. Zeros are a valid `T`.
        unsafe {
            to.write_bytes(0, 1);
            Ok(&mut *to)
        }
    }

    /// Space for `count` results.
    pub(crate) fn room<T: Plain>(self, first: *mut T, count: usize) -> Checked<&'a mut [MaybeUninit<T>]> {
        let first = check_row(first, count)?.cast_mut();
        // SAFETY: space for `count`, within the limits of memory; the bytes need not be a `T` yet.
        Ok(unsafe { core::slice::from_raw_parts_mut(first.cast(), count) })
    }

    /// Checks memory for a [`Resident`] and clears the mark of any previous one.
    pub(crate) fn site<T: Resident>(self, memory: *mut c_void, bytes: usize) -> Checked<*mut T> {
        let place = memory.cast::<T>();
        check(place)?;
        if bytes < size_of::<T>() {
            return Err(StayaStatus::MemorySize);
        }
        // SAFETY: aligned space for the whole value, which begins with this word.
        unsafe { place.cast::<u32>().write(0) };
        Ok(place)
    }

    /// A resident that the call may change.
    pub(crate) fn resident_mut<T: Resident>(self, place: *mut T) -> Checked<&'a mut T> {
        self.resident(place)?;
        // SAFETY: the mark in its first word shows that it exists, and nothing else uses it.
        Ok(unsafe { &mut *place })
    }

    /// A resident that the call reads.
    pub(crate) fn resident<T: Resident>(self, place: *const T) -> Checked<&'a T> {
        check(place)?;
        // SAFETY: neither null nor misaligned, and so at least a word.
        let mark = unsafe { place.cast::<u32>().read() };
        // SAFETY: the mark in its first word shows that it exists.
        if mark == T::MARK { Ok(unsafe { &*place }) } else { Err(StayaStatus::NotThere) }
    }
}
