//! A camera of the plugin: an owned value that threads may share.

use super::library::{Plugin, PluginError, text};
use super::options;
use crate::arguments::{PIPED, standard_input};
use ::realistic_camera::Parameters;
use realistic::ffi::{
    realistic_camera, realistic_camera_info, realistic_input, realistic_options, realistic_output,
    realistic_ray, realistic_request, realistic_sample,
};
use realistic_lab::render::Rays;
use std::ffi::{CString, c_char, c_void};
use std::mem::MaybeUninit;
use std::ptr::null;
use std::sync::Arc;

/// A function that receives the plugin's warnings while a camera is being built.
pub type Warn<'a> = &'a dyn Fn(&str);

/// A built camera, which keeps its plugin loaded.
pub struct Camera {
    handle: *mut realistic_camera,
    plugin: Arc<Plugin>,
}

// SAFETY: the ABI states that a camera is immutable once built, and that any number of threads may request rays; the
// thread that drops the camera frees it, once.
unsafe impl Send for Camera {}
// SAFETY: as above.
unsafe impl Sync for Camera {}

impl Camera {
    /// Builds the camera that the parameters describe, for a picture of this size, at a pose. A donor of the same
    /// plugin makes the build faster, with the same result to the last bit.
    ///
    /// # Errors
    /// The plugin rejects the parameters; the message is the plugin's.
    pub fn new(
        plugin: &Arc<Plugin>,
        donor: Option<&Self>,
        parameters: &Parameters,
        [width, height]: [u32; 2],
        camera_to_world: &[f32; 16],
        warn: Warn<'_>,
    ) -> Result<Self, PluginError> {
        let (mut raw, _strings) = c_options(plugin, parameters, [width, height], camera_to_world, &warn)?;
        if let Some(donor) = donor {
            raw.donor = donor.handle;
        }
        let mut handle = std::ptr::null_mut();
        // SAFETY: the strings and `warn` live until the end of this function, and the
        // callback is used only while the camera is being built; the donor's handle is alive.
        plugin.check(unsafe { (plugin.functions.camera_new)(&raw, &mut handle) })?;
        Ok(Self { handle, plugin: Arc::clone(plugin) })
    }

    /// Returns the camera's properties.
    ///
    /// # Errors
    /// The plugin's error.
    pub fn info(&self) -> Result<realistic_camera_info, PluginError> {
        let mut info = MaybeUninit::<realistic_camera_info>::zeroed();
        // SAFETY: the structure has only plain numbers, for which zeros are valid.
        let info = unsafe { info.assume_init_mut() };
        info.struct_size = size_of::<realistic_camera_info>() as u32;
        // SAFETY: the handle is this plugin's and alive; the structure states its size.
        let status = unsafe { (self.plugin.functions.camera_get_info)(self.handle, info) };
        self.plugin.check(status)?;
        Ok(*info)
    }

    /// Returns the name of the lens.
    ///
    /// # Errors
    /// The plugin's error.
    pub fn lens_name(&self) -> Result<String, PluginError> {
        let mut name = [0_u8; 1024];
        let mut length = 0;
        let get = self.plugin.functions.camera_get_lens_name;
        // SAFETY: the handle is this plugin's and alive. The last byte is withheld from the plugin, so that the name
        // ends in a NUL whatever the plugin writes.
        unsafe {
            let start = name.as_mut_ptr().cast();
            self.plugin.check(get(self.handle, start, name.len() - 1, &mut length))?;
            Ok(text(start))
        }
    }

    /// Returns the plugin that built the camera.
    pub(super) fn plugin(&self) -> &Plugin {
        &self.plugin
    }

    /// Returns the handle in the plugin, which is alive.
    pub(super) fn handle(&self) -> *const realistic_camera {
        self.handle
    }

    /// Generates one ray and one weight for every sample.
    ///
    /// # Errors
    /// The plugin's error.
    pub fn rays(&self, rays: Rays<'_>) -> Result<(), PluginError> {
        // SAFETY: the handle is this plugin's and alive.
        unsafe { generate(&self.plugin, self.handle, rays) }
    }

    /// Generates rays at a wavelength, nm.
    ///
    /// # Errors
    /// The plugin's error.
    pub fn rays_at(&self, wavelength: f32, rays: Rays<'_>) -> Result<(), PluginError> {
        let wavelength = realistic_input { x: &raw const wavelength, ..realistic_input::NONE };
        // SAFETY: as above.
        unsafe { request(&self.plugin, self.handle, wavelength, rays) }
    }
}

/// Generates rays of a camera of the plugin.
///
/// # Safety
/// `camera` is a live camera of this plugin.
pub unsafe fn generate(
    plugin: &Plugin,
    camera: *const realistic_camera,
    rays: Rays<'_>,
) -> Result<(), PluginError> {
    // SAFETY: the caller's promise.
    unsafe { request(plugin, camera, realistic_input::NONE, rays) }
}

/// Requests rays at a wavelength, nm, or at the camera's own wavelength.
///
/// # Safety
/// As for [`generate`]; the wavelength is present for each sample, or absent.
unsafe fn request(
    plugin: &Plugin,
    camera: *const realistic_camera,
    wavelength: realistic_input,
    rays: Rays<'_>,
) -> Result<(), PluginError> {
    let n = rays.samples.len();
    let request = realistic_request { wavelength, ..request_of(rays) };
    // SAFETY: the caller's promise; the arrays have the stated length.
    plugin.check(unsafe { (plugin.functions.camera_generate_batch)(camera, n, &request) })
}

/// Makes the request for rays in packed structures, as the header's inline function does.
pub fn request_of(Rays { samples, rays, weights }: Rays<'_>) -> realistic_request {
    assert!(samples.len() == rays.len() && samples.len() == weights.len());
    let (sample, ray) = (samples.as_ptr().cast::<f32>(), rays.as_mut_ptr().cast::<f32>());
    let input = |k: usize| {
        let x = sample.wrapping_add(k);
        realistic_input { x, y: x.wrapping_add(1), z: null(), stride: size_of::<realistic_sample>() as isize }
    };
    let output = |k: usize| {
        let x = ray.wrapping_add(k);
        let (y, z) = (x.wrapping_add(1), x.wrapping_add(2));
        realistic_output { x, y, z, stride: size_of::<realistic_ray>() as isize }
    };
    let weight = realistic_output::columns([weights.as_mut_ptr()]);
    realistic_request {
        image: input(0),
        lens: input(2),
        time: input(4),
        origin: output(0),
        direction: output(3),
        mint: output(6),
        maxt: output(7),
        ray_time: output(8),
        weight,
        ..realistic_request::default()
    }
}

impl Drop for Camera {
    fn drop(&mut self) {
        // SAFETY: the handle is this plugin's, and nothing else uses it.
        unsafe { (self.plugin.functions.camera_free)(self.handle) }
    }
}

/// Fills in the C options of a camera. The strings, and `warn`, must outlive them.
pub fn c_options(
    plugin: &Plugin,
    parameters: &Parameters,
    [width, height]: [u32; 2],
    camera_to_world: &[f32; 16],
    warn: &Warn<'_>,
) -> Result<(realistic_options, Vec<CString>), PluginError> {
    let mut raw = MaybeUninit::zeroed();
    let size = size_of::<realistic_options>() as u32;
    // SAFETY: the structure has the stated size.
    plugin.check(unsafe { (plugin.functions.options_init)(raw.as_mut_ptr(), size) })?;
    // SAFETY: the plugin filled in the structure, whose previous zeros are valid, too.
    let mut raw = unsafe { raw.assume_init() };
    let strings = if parameters.lens_file.as_deref() == Some(PIPED) {
        let text = standard_input().map_err(PluginError::Refused)?;
        (raw.lens_text, raw.lens_text_size) = (text.as_ptr().cast(), text.len());
        options::fill(&mut raw, &Parameters { lens_file: None, ..parameters.clone() })?
    } else {
        options::fill(&mut raw, parameters)?
    };
    let units = (1.0 / parameters.mm_per_unit.unwrap_or(1.0)) as f32;
    raw.camera_to_world = *camera_to_world;
    for row in 0..3 {
        raw.camera_to_world[4 * row + 3] *= units;
    }
    raw.xres = width as i32;
    raw.yres = height as i32;
    raw.log = Some(forward);
    raw.log_user = std::ptr::from_ref(warn).cast_mut().cast();
    Ok((raw, strings))
}

unsafe extern "C" fn forward(user: *mut c_void, level: i32, message: *const c_char) {
    const WARNING: i32 = 1;
    // Errors are returned as the call's status, with the same text.
    if level == WARNING {
        // SAFETY: `user` is the pointer that `Camera::new` passed, alive for the whole call.
        unsafe { (*user.cast::<Warn<'_>>())(&text(message)) }
    }
}
