//! Objects in boxes that begin with a tag. The tag distinguishes a caller's pointer to such an object from
//! any other pointer.

use std::ptr::null;

/// An object preceded by its tag, which is the address of a static that stands for the object's kind. This
/// static must not share its address with another constant.
#[repr(C)]
pub struct Tagged<T> {
    tag: *const u8,
    object: T,
}

impl<T> Tagged<T> {
    /// Puts an object into a box, which is freed with [`Tagged::free`].
    pub fn boxed(tag: &'static u8, object: T) -> *mut Self {
        Box::into_raw(Box::new(Self { tag, object }))
    }

    /// Returns the object at a caller's pointer; `None` for NULL and for an object of any other kind.
    ///
    /// # Safety
    /// `tagged` is NULL or a live object made by [`Tagged::boxed`], or memory of the size of a pointer can be
    /// read there.
    pub unsafe fn of<'a>(tagged: *const Self, tag: &'static u8) -> Option<&'a T> {
        if tagged.is_null() || !tagged.is_aligned() {
            return None;
        }
        // SAFETY: the caller's promise. Memory past the tag is read only if the object is ours.
        unsafe { (*tagged.cast::<*const u8>() == &raw const *tag).then(|| &(*tagged).object) }
    }

    /// Frees the object at a caller's pointer. If [`Tagged::of`] returns `None`, does nothing and returns
    /// false.
    ///
    /// # Safety
    /// The promises of [`Tagged::of`]; also, nobody uses the object any more.
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
