//! Memory of the caller's: the only place that turns pointers into references, after all that can be checked is.

use crate::status::{Checked, StayaStatus};
use core::ffi::c_void;
use core::mem::MaybeUninit;

/// Types of which any bytes are a value, so that what C left there may be read: integers, floats, pointers, arrays and structures of
/// these.
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

plain!(u8, u32, i32, f32, u64, usize);

// SAFETY: null is a pointer; any other bytes are one, too, which is not followed.
unsafe impl<T> Plain for *mut T {}

// SAFETY: an array of what any bytes are a value of is one, too.
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

/// What the caller lets us read.
///
/// # Safety
/// If it is neither null nor misaligned, there is a `T` that nobody writes to until the call is over.
pub(crate) unsafe fn shared<'a, T: Plain>(pointer: *const T) -> Checked<&'a T> {
    check(pointer)?;
    // SAFETY: neither null nor misaligned; the rest is the caller's promise. Any bytes are a `T`.
    Ok(unsafe { &*pointer })
}

/// The same for what may be left out.
///
/// # Safety
/// As [`shared`].
pub(crate) unsafe fn optional<'a, T: Plain>(pointer: *const T) -> Checked<Option<&'a T>> {
    if pointer.is_null() {
        return Ok(None);
    }
    // SAFETY: the caller's promise.
    unsafe { shared(pointer) }.map(Some)
}

/// So many of them in a row; null with 0 is none.
///
/// # Safety
/// If it is neither null nor misaligned, there are `count` of them that nobody writes to until the call is over.
pub(crate) unsafe fn row<'a, T: Plain>(first: *const T, count: usize) -> Checked<&'a [T]> {
    if count == 0 {
        return Ok(&[]);
    }
    check(first)?;
    if count.saturating_mul(size_of::<T>()) > isize::MAX.unsigned_abs() {
        return Err(StayaStatus::TooMany);
    }
    // SAFETY: neither null nor misaligned, and not longer than memory can be; the rest is the caller's promise.
    Ok(unsafe { core::slice::from_raw_parts(first, count) })
}

/// Writes a whole answer, whatever was there.
///
/// # Safety
/// If it is neither null nor misaligned, there is room for a `T` that nobody else uses until the call is over.
pub(crate) unsafe fn write<T: Plain>(to: *mut T, value: T) -> Checked<()> {
    check(to)?;
    // SAFETY: neither null nor misaligned; the rest is the caller's promise.
    unsafe { to.write(value) };
    Ok(())
}

/// Room for an answer that is written piece by piece: all zeros.
///
/// # Safety
/// As [`write`].
pub(crate) unsafe fn zeroed<'a, T: Plain>(to: *mut T) -> Checked<&'a mut T> {
    check(to)?;
    // SAFETY: neither null nor misaligned, and room for a `T` by the caller's promise, which is a `T` of zeros then.
    unsafe {
        to.write_bytes(0, 1);
        Ok(&mut *to)
    }
}

/// Room for so many answers.
///
/// # Safety
/// If it is neither null nor misaligned, there is room for `count` of them that nobody else uses until the call is over.
pub(crate) unsafe fn room<'a, T: Plain>(first: *mut T, count: usize) -> Checked<&'a mut [MaybeUninit<T>]> {
    if count == 0 {
        return Ok(&mut []);
    }
    check(first)?;
    if count.saturating_mul(size_of::<T>()) > isize::MAX.unsigned_abs() {
        return Err(StayaStatus::TooMany);
    }
    // SAFETY: neither null nor misaligned, and not longer than memory can be; what is there need not be a `T` yet. The rest is the
    // caller's promise.
    Ok(unsafe { core::slice::from_raw_parts_mut(first.cast(), count) })
}

/// Something that lives in the caller's memory and says so in its first word.
///
/// # Safety
/// `repr(C)`, and its first field is a `u32`.
pub(crate) unsafe trait Resident: Sized {
    /// That word.
    const MARK: u32;
}

/// Memory for a [`Resident`], checked; what was in it is none any more.
///
/// # Safety
/// If it is neither null nor misaligned, there are `bytes` of it that nobody else uses.
pub(crate) unsafe fn site<T: Resident>(memory: *mut c_void, bytes: usize) -> Checked<*mut T> {
    let place = memory.cast::<T>();
    check(place)?;
    if bytes < size_of::<T>() {
        return Err(StayaStatus::MemorySize);
    }
    // SAFETY: aligned room for all of it, of which this is the first word.
    unsafe { place.cast::<u32>().write(0) };
    Ok(place)
}

fn check_resident<T: Resident>(place: *const T) -> Checked<()> {
    check(place)?;
    // SAFETY: neither null nor misaligned, and at least its first word is there by the caller's promise.
    let mark = unsafe { place.cast::<u32>().read() };
    if mark == T::MARK { Ok(()) } else { Err(StayaStatus::NotThere) }
}

/// What was made there, to be used.
///
/// # Safety
/// If it is neither null nor misaligned, there is memory for a `T` with one in it, or with another first word, that nobody else uses
/// until the call is over.
pub(crate) unsafe fn resident_mut<'a, T: Resident>(place: *mut T) -> Checked<&'a mut T> {
    check_resident(place)?;
    // SAFETY: its first word says that there is one; the rest is the caller's promise.
    Ok(unsafe { &mut *place })
}

/// What was made there, to be looked at.
///
/// # Safety
/// As [`resident_mut`], but that others may look at it, too.
pub(crate) unsafe fn resident<'a, T: Resident>(place: *const T) -> Checked<&'a T> {
    check_resident(place)?;
    // SAFETY: its first word says that there is one; the rest is the caller's promise.
    Ok(unsafe { &*place })
}
