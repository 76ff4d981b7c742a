//! A camera of the plugin, owned and safe to share.

use super::library::{Plugin, PluginError, text};
use super::options;
use crate::lens_and_film::{PIPED, standard_input};
use realistic::abi::{realistic_camera, realistic_camera_info, realistic_options};
use realistic::camera::Parameters;
use realistic_lab::render::Rays;
use std::ffi::{CString, c_char, c_void};
use std::mem::MaybeUninit;
use std::sync::Arc;

/// Receives the plugin's warnings while a camera is being built.
pub type Warn<'a> = &'a dyn Fn(&str);

/// A built camera. It keeps its plugin loaded.
pub struct Camera {
    handle: *mut realistic_camera,
    plugin: Arc<Plugin>,
}

// SAFETY: the ABI says that a camera is immutable once built, and that rays may be asked for
// from any number of threads; it is freed once, by whichever thread drops it.
unsafe impl Send for Camera {}
// SAFETY: as above.
unsafe impl Sync for Camera {}

impl Camera {
    /// Builds the camera that the parameters describe, for a picture of this size, at a place.
    ///
    /// # Errors
    /// The plugin refuses the parameters; the message is its own.
    pub fn new(
        plugin: &Arc<Plugin>,
        parameters: &Parameters,
        [width, height]: [u32; 2],
        camera_to_world: &[f32; 16],
        warn: Warn<'_>,
    ) -> Result<Self, PluginError> {
        let (raw, _strings) = c_options(plugin, parameters, [width, height], camera_to_world, &warn)?;
        let mut handle = std::ptr::null_mut();
        // SAFETY: the strings and `warn` live until the end of this function, and the
        // callback is used only while the camera is being built.
        plugin.check(unsafe { (plugin.functions.camera_new)(&raw, &mut handle) })?;
        Ok(Self { handle, plugin: Arc::clone(plugin) })
    }

    /// What the camera is.
    ///
    /// # Errors
    /// The plugin's own.
    pub fn info(&self) -> Result<realistic_camera_info, PluginError> {
        let mut info = MaybeUninit::<realistic_camera_info>::zeroed();
        // SAFETY: all of it is plain numbers, for which zeros are valid.
        let info = unsafe { info.assume_init_mut() };
        info.struct_size = size_of::<realistic_camera_info>() as u32;
        // SAFETY: the handle is this plugin's and alive; the structure says its size.
        let status = unsafe { (self.plugin.functions.camera_get_info)(self.handle, info) };
        self.plugin.check(status)?;
        Ok(*info)
    }

    /// The name of the lens.
    ///
    /// # Errors
    /// The plugin's own.
    pub fn lens_name(&self) -> Result<String, PluginError> {
        let mut name = [0_u8; 1024];
        let mut length = 0;
        let get = self.plugin.functions.camera_get_lens_name;
        // SAFETY: the handle is this plugin's and alive. One byte is kept back, so that the
        // name ends in a NUL whatever the plugin writes.
        unsafe {
            let start = name.as_mut_ptr().cast();
            self.plugin.check(get(self.handle, start, name.len() - 1, &mut length))?;
            Ok(text(start))
        }
    }

    /// Where the camera comes from.
    pub(super) fn plugin(&self) -> &Plugin {
        &self.plugin
    }

    /// The plugin's own, alive.
    pub(super) fn handle(&self) -> *const realistic_camera {
        self.handle
    }

    /// One ray and one weight for every sample.
    ///
    /// # Errors
    /// The plugin's own.
    pub fn rays(&self, rays: Rays<'_>) -> Result<(), PluginError> {
        // SAFETY: the handle is this plugin's and alive.
        unsafe { generate(&self.plugin, self.handle, rays) }
    }

    /// The same at a wavelength, nm.
    ///
    /// # Errors
    /// The plugin's own.
    pub fn rays_at(
        &self,
        wavelength: f32,
        Rays { samples, rays, weights }: Rays<'_>,
    ) -> Result<(), PluginError> {
        assert!(samples.len() == rays.len() && samples.len() == weights.len());
        let wavelengths = vec![wavelength; samples.len()];
        let generate = self.plugin.functions.camera_generate_rays_at;
        // SAFETY: the handle is this plugin's and alive; the arrays are as long as we say, and packed.
        self.plugin.check(unsafe {
            generate(
                self.handle,
                samples.len(),
                samples.as_ptr(),
                0,
                wavelengths.as_ptr(),
                0,
                rays.as_mut_ptr(),
                0,
                weights.as_mut_ptr(),
                std::ptr::null_mut(),
            )
        })
    }
}

/// Rays of a camera of the plugin.
///
/// # Safety
/// `camera` is a live camera of this plugin.
pub unsafe fn generate(
    plugin: &Plugin,
    camera: *const realistic_camera,
    Rays { samples, rays, weights }: Rays<'_>,
) -> Result<(), PluginError> {
    assert!(samples.len() == rays.len() && samples.len() == weights.len());
    let generate = plugin.functions.camera_generate_rays;
    // SAFETY: the caller's promise; the arrays are as long as we say, and packed.
    plugin.check(unsafe {
        generate(
            camera,
            samples.len(),
            samples.as_ptr(),
            0,
            rays.as_mut_ptr(),
            0,
            weights.as_mut_ptr(),
            std::ptr::null_mut(),
        )
    })
}

impl Drop for Camera {
    fn drop(&mut self) {
        // SAFETY: the handle is this plugin's, and nobody has it any more.
        unsafe { (self.plugin.functions.camera_free)(self.handle) }
    }
}

/// The C options of a camera. The strings, and `warn`, must outlive them.
pub fn c_options(
    plugin: &Plugin,
    parameters: &Parameters,
    [width, height]: [u32; 2],
    camera_to_world: &[f32; 16],
    warn: &Warn<'_>,
) -> Result<(realistic_options, Vec<CString>), PluginError> {
    let mut raw = MaybeUninit::zeroed();
    let size = size_of::<realistic_options>() as u32;
    // SAFETY: the structure is as large as we say.
    plugin.check(unsafe { (plugin.functions.options_init)(raw.as_mut_ptr(), size) })?;
    // SAFETY: it was filled in, and zeros, which it held before, are valid too.
    let mut raw = unsafe { raw.assume_init() };
    let strings = if parameters.specfile.as_deref() == Some(PIPED) {
        let text = standard_input().map_err(PluginError::Refused)?;
        (raw.lens_text, raw.lens_text_size) = (text.as_ptr().cast(), text.len());
        options::fill(&mut raw, &Parameters { specfile: None, ..parameters.clone() })?
    } else {
        options::fill(&mut raw, parameters)?
    };
    let units = (1.0 / parameters.mmperunit.unwrap_or(1.0)) as f32;
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
    // Errors come back as the call's status, with the same text.
    if level == WARNING {
        // SAFETY: `user` is what `Camera::new` passed, alive for the whole call.
        unsafe { (*user.cast::<Warn<'_>>())(&text(message)) }
    }
}
