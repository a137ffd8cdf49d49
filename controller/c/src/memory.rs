//! Access to the caller's memory. Only this module turns pointers into references, after all
//! possible checks.

use crate::status::{Checked, StayaStatus};
use core::ffi::{CStr, c_char, c_void};
use core::mem::MaybeUninit;

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

fn check<T>(pointer: *const T) -> Checked<()> {
    if pointer.is_null() {
        Err(StayaStatus::Null)
    } else if !pointer.is_aligned() {
        Err(StayaStatus::Alignment)
    } else {
        Ok(())
    }
}

/// Reads a value of the caller.
///
/// # Safety
/// If the pointer is neither null nor misaligned, it points to a `T` that is not modified during
/// the call.
pub(crate) unsafe fn shared<'a, T: Plain>(pointer: *const T) -> Checked<&'a T> {
    check(pointer)?;
    // SAFETY: neither null nor misaligned; the rest is the caller's contract. Any bytes are a `T`.
    Ok(unsafe { &*pointer })
}

/// Like [`shared`], but null is permitted.
///
/// # Safety
/// As [`shared`].
pub(crate) unsafe fn optional<'a, T: Plain>(pointer: *const T) -> Checked<Option<&'a T>> {
    if pointer.is_null() {
        return Ok(None);
    }
    // SAFETY: the caller's contract.
    unsafe { shared(pointer) }.map(Some)
}

/// Reads `count` consecutive values; null with 0 is empty.
///
/// # Safety
/// If the pointer is neither null nor misaligned, it points to `count` values that are not modified
/// during the call.
pub(crate) unsafe fn row<'a, T: Plain>(first: *const T, count: usize) -> Checked<&'a [T]> {
    if count == 0 {
        return Ok(&[]);
    }
    check(first)?;
    if count.saturating_mul(size_of::<T>()) > isize::MAX.unsigned_abs() {
        return Err(StayaStatus::TooMany);
    }
    // SAFETY: neither null nor misaligned, and within the limits of memory; the rest is the
    // caller's contract.
    Ok(unsafe { core::slice::from_raw_parts(first, count) })
}

/// Reads a text; one that is not UTF-8 is empty.
///
/// # Safety
/// If the pointer is not null, it points to bytes that end with a zero and are not modified during
/// the call.
pub(crate) unsafe fn text<'a>(text: *const c_char) -> Checked<&'a str> {
    check(text)?;
    // SAFETY: not null, and it ends with a zero by the caller's contract.
    Ok(unsafe { CStr::from_ptr(text) }.to_str().unwrap_or_default())
}

/// Writes a whole result, overwriting any previous bytes.
///
/// # Safety
/// If the pointer is neither null nor misaligned, it points to space for a `T` that is not used
/// elsewhere during the call.
pub(crate) unsafe fn write<T: Plain>(to: *mut T, value: T) -> Checked<()> {
    check(to)?;
    // SAFETY: neither null nor misaligned; the rest is the caller's contract.
    unsafe { to.write(value) };
    Ok(())
}

/// Zeroed space for a result that is written in pieces.
///
/// # Safety
/// As [`write`].
pub(crate) unsafe fn zeroed<'a, T: Plain>(to: *mut T) -> Checked<&'a mut T> {
    check(to)?;
    // SAFETY: neither null nor misaligned, space by contract. Zeros are a valid `T`.
    unsafe {
        to.write_bytes(0, 1);
        Ok(&mut *to)
    }
}

/// Space for `count` results.
///
/// # Safety
/// If the pointer is neither null nor misaligned, it points to space for `count` values that is not
/// used elsewhere during the call.
pub(crate) unsafe fn room<'a, T: Plain>(first: *mut T, count: usize) -> Checked<&'a mut [MaybeUninit<T>]> {
    if count == 0 {
        return Ok(&mut []);
    }
    check(first)?;
    if count.saturating_mul(size_of::<T>()) > isize::MAX.unsigned_abs() {
        return Err(StayaStatus::TooMany);
    }
    // SAFETY: neither null nor misaligned, and within the limits of memory; the bytes need not be a
    // `T` yet. The rest is the caller's contract.
    Ok(unsafe { core::slice::from_raw_parts_mut(first.cast(), count) })
}

/// A type that lives in the caller's memory and is marked by its first word.
///
/// # Safety
/// `repr(C)`, and its first field is a `u32`.
pub(crate) unsafe trait Resident: Sized {
    const MARK: u32;
}

/// Checks memory for a [`Resident`] and clears the mark of any previous one.
///
/// # Safety
/// If the pointer is neither null nor misaligned, it points to `bytes` bytes that are not used
/// elsewhere.
pub(crate) unsafe fn site<T: Resident>(memory: *mut c_void, bytes: usize) -> Checked<*mut T> {
    let place = memory.cast::<T>();
    check(place)?;
    if bytes < size_of::<T>() {
        return Err(StayaStatus::MemorySize);
    }
    // SAFETY: aligned space for the whole value, which begins with this word.
    unsafe { place.cast::<u32>().write(0) };
    Ok(place)
}

fn check_resident<T: Resident>(place: *const T) -> Checked<()> {
    check(place)?;
    // SAFETY: neither null nor misaligned, and the first word is valid by the caller's contract.
    let mark = unsafe { place.cast::<u32>().read() };
    if mark == T::MARK { Ok(()) } else { Err(StayaStatus::NotThere) }
}

/// # Safety
/// If the pointer is neither null nor misaligned, it points to memory for a `T` that holds one, or
/// has another first word, and is not used elsewhere during the call.
pub(crate) unsafe fn resident_mut<'a, T: Resident>(place: *mut T) -> Checked<&'a mut T> {
    check_resident(place)?;
    // SAFETY: the mark in its first word shows that it exists; the rest is the caller's contract.
    Ok(unsafe { &mut *place })
}

/// # Safety
/// As [`resident_mut`], but other readers are permitted.
pub(crate) unsafe fn resident<'a, T: Resident>(place: *const T) -> Checked<&'a T> {
    check_resident(place)?;
    // SAFETY: the mark in its first word shows that it exists; the rest is the caller's contract.
    Ok(unsafe { &*place })
}
