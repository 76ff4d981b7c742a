//! Construction and release of lenses, and the check that a pointer points to a lens.

use std::sync::OnceLock;

use super::super::{
    boundary::{self, Failure, realistic_status},
    camera::construct,
    object::Tagged,
    options::realistic_options,
};
use ::realistic_camera::{Parameters, open_lens};
use realistic_optics::{
    imaging::{
        axial_beam::AxialBeam,
        focus::{Focus, FocusError},
    },
    lens::{Lens, LensError, first_order::FirstOrder},
    prescription::Prescription,
    trace::{Direction, Path},
};
use realistic_trace::kernel::{Kernel, PathKernel};

/// A lens at one wavelength and stop. Immutable and thread-safe once built.
// This type is not `repr(C)`, so that the header only declares it.
#[allow(non_camel_case_types)]
pub struct realistic_lens {
    _opaque: [u8; 0],
    _pinned: core::marker::PhantomData<(*mut u8, core::marker::PhantomPinned)>,
}

/// Parameters that select a lens and its settings.
const PARAMETERS: [&str; 7] =
    ["lens_file", "glass_catalog", "strict", "wavelength", "zoom", "aperture_diameter", "fnumber"];

/// A lens together with the data that callers request repeatedly.
#[derive(Debug)]
pub(super) struct OpenedLens {
    pub lens: Lens,
    pub stated_focal_length: Option<f64>,
    pub first_order: Result<FirstOrder, LensError>,
    pub beam: AxialBeam,
    pub focus: Result<Focus, FocusError>,
    /// The lens prepared for rays from the film and for rays from the scene.
    pub directed: [DirectedLens; 2],
}

/// A lens prepared for rays in one direction.
#[derive(Debug)]
pub(super) struct DirectedLens {
    pub direction: Direction,
    pub path: Path,
    pub kernel: Kernel<f64>,
    path_kernel: OnceLock<PathKernel>,
}

impl DirectedLens {
    fn new(lens: &Lens, direction: Direction) -> Self {
        let path = Path::new(lens, direction, Default::default());
        Self { direction, kernel: Kernel::along(&path), path_kernel: OnceLock::new(), path }
    }

    /// Returns the kernel for rays whose optical paths are requested, which few hosts do.
    pub fn path_kernel(&self) -> &PathKernel {
        self.path_kernel.get_or_init(|| PathKernel::along(&self.path))
    }
}

impl OpenedLens {
    fn new(prescription: &Prescription, lens: Lens) -> Self {
        let beam = AxialBeam::of(&lens);
        let first_order = FirstOrder::of(&lens);
        let focus = first_order.clone().map_err(FocusError::from);
        Self {
            stated_focal_length: prescription.stated_focal_length,
            focus: focus.and_then(|first_order| Focus::of(&lens, first_order, &beam)),
            first_order,
            beam,
            directed: [Direction::FilmToScene, Direction::SceneToFilm]
                .map(|direction| DirectedLens::new(&lens, direction)),
            lens,
        }
    }
}

static TAG: u8 = 0x4c;

/// Opens a lens, which the caller frees with `realistic_lens_free`. `lens_file` or `lens_text`, with
/// `glass_catalog` and `strict`, selects the lens; `wavelength`, `zoom` and `aperture_diameter` or `fnumber`
/// set it up, as for a camera. `xres`, `yres` and the transforms are not read. Any other parameter is
/// refused, because it would have no effect.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn realistic_lens_new(
    options: *const realistic_options,
    out: *mut *mut realistic_lens,
) -> realistic_status {
    // SAFETY: the caller's promise, here and within.
    unsafe {
        construct(options, out, |options, parameters, log| {
            let host = options.lens_host()?;
            only_of_a_lens(parameters)?;
            let (prescription, lens) = open_lens(parameters, &host, log)?;
            Ok(Tagged::boxed(&TAG, OpenedLens::new(&prescription, lens)).cast())
        })
    }
}

/// Refuses the parameters that only a camera has.
///
/// # Errors
/// Such a parameter is given.
fn only_of_a_lens(parameters: &Parameters) -> Result<(), Failure> {
    match parameters.given().find(|row| !PARAMETERS.contains(&row.name)) {
        Some(row) => Err(Failure::invalid(format!(
            "parameter \"{}\" is a camera's; a lens without a film takes {}",
            row.name,
            PARAMETERS.join(", ")
        ))),
        None => Ok(()),
    }
}

/// Frees a lens.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn realistic_lens_free(lens: *mut realistic_lens) {
    boundary::value((), || {
        // SAFETY: the caller's promise.
        if lens.is_null() || unsafe { Tagged::<OpenedLens>::free(lens.cast(), &TAG) } {
            Ok(())
        } else {
            Err(not_a_lens())
        }
    });
}

/// Returns the lens at a caller's pointer.
///
/// # Errors
/// The pointer is NULL or does not point to a lens.
///
/// # Safety
/// `lens` is NULL or a live lens made by `realistic_lens_new`, or memory of the size of a pointer can be read
/// there.
pub(super) unsafe fn opened<'a>(lens: *const realistic_lens) -> Result<&'a OpenedLens, Failure> {
    // SAFETY: the caller's promise.
    unsafe { Tagged::of(lens.cast(), &TAG) }.ok_or_else(not_a_lens)
}

fn not_a_lens() -> Failure {
    Failure::new(realistic_status::NotALens, "this is no lens of this library (or it is NULL)")
}
