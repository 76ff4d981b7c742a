//! Objects in boxes that begin with a tag, which distinguishes a caller's pointer to one from any other pointer.

use std::ptr::null;

/// An object behind its tag, the address of a static of the object's kind. The static must not share its address with
/// another constant.
#[repr(C)]
pub struct Tagged<T> {
    tag: *const u8,
    object: T,
}

impl<T> Tagged<T> {
    /// Puts an object into a box of its own, to be freed by [`Tagged::free`].
    pub fn boxed(tag: &'static u8, object: T) -> *mut Self {
        Box::into_raw(Box::new(Self { tag, object }))
    }

    /// Returns the object at a caller's pointer; `None` for NULL and for an object of any other kind.
    ///
    /// # Safety
    /// `tagged` is NULL, or of [`Tagged::boxed`] and live, or a pointer can be read there.
    pub unsafe fn of<'a>(tagged: *const Self, tag: &'static u8) -> Option<&'a T> {
        if tagged.is_null() || !tagged.is_aligned() {
            return None;
        }
        // SAFETY: the caller's promise; past the tag only when the object is ours.
        unsafe { (*tagged.cast::<*const u8>() == &raw const *tag).then(|| &(*tagged).object) }
    }

    /// Frees the object at a caller's pointer. Returns false, and does nothing, where [`Tagged::of`] is `None`.
    ///
    /// # Safety
    /// As for [`Tagged::of`], and nobody uses the object any more.
    pub unsafe fn free(tagged: *mut Self, tag: &'static u8) -> bool {
        // SAFETY: the caller's promise; the tag shows that it came from a box.
        unsafe {
            let is_ours = Self::of(tagged, tag).is_some();
            if is_ours {
                (*tagged).tag = null();
                drop(Box::from_raw(tagged));
            }
            is_ours
        }
    }
}
