//! Many rays in one call, between arrays of numbers and vectors of any strides: NumPy's, and those of hosts that have
//! two- and three-component vectors side by side.

use std::array;

use super::{
    super::{
        boundary::{self, Failure, realistic_status},
        exchange, object,
        types::{realistic_batch, realistic_camera, realistic_input, realistic_output, realistic_reason},
    },
    columns::{Column, ColumnMut, Reasons},
    request::Request,
};

/// Where nothing is given.
static NOTHING: f32 = 0.0;

/// Rays of `n` samples, the same as by `realistic_camera_generate_rays_soa`, with wavelengths as by
/// `realistic_camera_generate_rays_at_soa`, with neighbours as by `realistic_camera_generate_ray_differentials_soa`, and with
/// both as by `realistic_camera_generate_ray_differentials_at_soa`.
/// The arrays must not overlap; where `n` is 0 they may all be NULL.
///
/// # Safety
/// `camera` is NULL or a live camera of this library; `batch` is NULL or valid, and what it points to is NULL or has room
/// for `n` elements at its strides.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn realistic_camera_generate_batch(
    camera: *const realistic_camera,
    n: usize,
    batch: *const realistic_batch,
) -> realistic_status {
    boundary::status(|| {
        // SAFETY: the caller's promise.
        let (handle, batch) = unsafe {
            let handle = object::handle_of(camera).ok_or_else(boundary::not_a_camera)?;
            (handle, exchange::take("realistic_batch", "batch", batch)?)
        };
        boundary::fits_memory(n, size_of::<f32>())?;
        if n == 0 {
            return Ok(());
        }
        let reader = |name: &str, given: &realistic_input| required_input(name, given, n);
        let [x, y] = reader("image", &batch.image)?;
        let [u, v] = reader("lens", &batch.lens)?;
        let nothing = Column { first: &raw const NOTHING, stride: 0, shared_by: 1 };
        let time = optional_input("time", &batch.time, n)?.unwrap_or(nothing);
        let wavelengths = optional_input("wavelength", &batch.wavelength, n)?;
        let [[ox, oy, oz], [dx, dy, dz], [weight, ..]] =
            vectors(["origin", "direction", "weight"], [&batch.origin, &batch.direction, &batch.weight], n)?;
        let [mint, maxt, ray_time] =
            [("mint", &batch.mint), ("maxt", &batch.maxt), ("ray_time", &batch.ray_time)].map(
                |(name, given)| {
                    if given.first.is_null() { Ok(NONE) } else { output(name, given, n).map(|[x, ..]| x) }
                },
            );
        let reasons = Reasons { first: batch.reason, stride: batch.reason_stride };
        if !reasons.first.is_null() {
            stride("reason_stride", reasons.stride, size_of::<realistic_reason>(), n, false)?;
        }
        let request = Request {
            handle,
            n,
            samples: [x, y, u, v, time],
            wavelengths,
            rays: [ox, oy, oz, dx, dy, dz, mint?, maxt?, ray_time?, weight],
            neighbours: neighbours(&batch, n)?,
            reasons,
        };
        // SAFETY: the caller's promise; what must be there is, and no stride times n overflows.
        unsafe { request.answer() }
    })
}

/// Room for nothing.
const NONE: ColumnMut = ColumnMut::packed(std::ptr::null_mut());

/// The two components of what must be given.
fn required_input(name: &str, given: &realistic_input, n: usize) -> Result<[Column; 2], Failure> {
    if given.first.is_null() {
        return Err(boundary::null(&format!("batch.{name}.first")));
    }
    stride(&format!("{name}.stride"), given.stride, size_of::<f32>(), n, true)?;
    Ok(array::from_fn(|k| Column {
        first: given.first.wrapping_byte_offset(k as isize * given.component_stride),
        stride: given.stride,
        shared_by: 1,
    }))
}

/// Numbers, if given.
fn optional_input(name: &str, given: &realistic_input, n: usize) -> Result<Option<Column>, Failure> {
    if given.first.is_null() {
        Ok(None)
    } else {
        required_input(name, given, n).map(|[column, _]| Some(column))
    }
}

/// The components of room that must be there: three, of which a number has the first.
fn output(name: &str, given: &realistic_output, n: usize) -> Result<[ColumnMut; 3], Failure> {
    if given.first.is_null() {
        return Err(boundary::null(&format!("batch.{name}.first")));
    }
    stride(&format!("{name}.stride"), given.stride, size_of::<f32>(), n, false)?;
    Ok(array::from_fn(|k| ColumnMut {
        first: given.first.wrapping_byte_offset(k as isize * given.component_stride),
        stride: given.stride,
    }))
}

/// [`output`] of an origin, a direction and a weight.
fn vectors(
    names: [&str; 3],
    given: [&realistic_output; 3],
    n: usize,
) -> Result<[[ColumnMut; 3]; 3], Failure> {
    let [origin, direction, weight] = array::from_fn(|k| output(names[k], given[k], n));
    Ok([origin?, direction?, weight?])
}

/// The neighbours' room, if it is asked for.
///
/// # Errors
/// A part of it is missing.
fn neighbours(batch: &realistic_batch, n: usize) -> Result<Option<[[ColumnMut; 7]; 2]>, Failure> {
    let right = [&batch.rx_origin, &batch.rx_direction, &batch.rx_weight];
    let below = [&batch.ry_origin, &batch.ry_direction, &batch.ry_weight];
    if right.iter().chain(&below).all(|given| given.first.is_null()) {
        return Ok(None);
    }
    let flat =
        |[[ox, oy, oz], [dx, dy, dz], [weight, ..]]: [[ColumnMut; 3]; 3]| [ox, oy, oz, dx, dy, dz, weight];
    Ok(Some([
        flat(vectors(["rx_origin", "rx_direction", "rx_weight"], right, n)?),
        flat(vectors(["ry_origin", "ry_direction", "ry_weight"], below, n)?),
    ]))
}

/// Refuses a stride that no array has: one at which elements of `size` bytes overlap, though `may_repeat` allows 0, or
/// `n` of which no memory holds.
fn stride(name: &str, given: isize, size: usize, n: usize, may_repeat: bool) -> Result<(), Failure> {
    let bytes = given.unsigned_abs();
    if n > 1 && bytes < size && !(may_repeat && bytes == 0) {
        let zero = if may_repeat { "0, or " } else { "" };
        return Err(Failure::invalid(format!(
            "batch.{name} is {given}; it must be {zero}at least {size} bytes, or minus that"
        )));
    }
    boundary::fits_memory(n, bytes)
}
