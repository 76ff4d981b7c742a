//! Connections from points of a scene to a camera of the plugin: directions toward its lens, and the importance of
//! rays along these directions.

use super::camera::Camera;
use super::library::PluginError;
use realistic::ffi::{
    realistic_aimed, realistic_camera, realistic_importance, realistic_input, realistic_output,
    realistic_scene_points,
};

/// Points of a scene, in the camera's units, each with a lens sample (u, v) and a time.
#[derive(Default)]
pub struct ScenePoints {
    columns: [Vec<f32>; 6],
}

impl ScenePoints {
    /// Adds a point.
    pub fn push(&mut self, [x, y, z]: [f32; 3], [u, v]: [f32; 2], time: f32) {
        for (column, number) in self.columns.iter_mut().zip([x, y, z, u, v, time]) {
            column.push(number);
        }
    }

    /// Returns the number of points.
    pub fn len(&self) -> usize {
        self.columns[0].len()
    }

    /// Returns a point's position.
    pub fn point(&self, i: usize) -> [f32; 3] {
        [0, 1, 2].map(|axis| self.columns[axis][i])
    }

    /// Returns a point's time.
    pub fn time(&self, i: usize) -> f32 {
        self.columns[5][i]
    }
}

/// Directions toward the lens and their importance, one for each point.
#[derive(Default)]
pub struct Connections {
    rays: [Vec<f32>; 6],
    image: [Vec<f32>; 2],
    /// Probability density of the direction per solid angle at the point.
    pub density: Vec<f32>,
    /// Importance We; 0 if no light passes.
    pub importance: Vec<f32>,
}

impl Connections {
    /// Returns the point at which a ray meets the lens.
    pub fn origin(&self, i: usize) -> [f32; 3] {
        [0, 1, 2].map(|axis| self.rays[axis][i])
    }

    /// Returns the unit vector from the point toward the lens.
    pub fn direction(&self, i: usize) -> [f32; 3] {
        [3, 4, 5].map(|axis| self.rays[axis][i])
    }

    /// Returns the raster coordinates of the film point.
    pub fn pixel(&self, i: usize) -> [f32; 2] {
        [0, 1].map(|axis| self.image[axis][i])
    }
}

/// Type of `realistic_camera_sample_importance`.
pub type SampleImportance = unsafe extern "C" fn(
    *const realistic_camera,
    usize,
    *const realistic_scene_points,
    *const realistic_aimed,
    *const realistic_importance,
) -> i32;

/// Connects points of a scene to a camera with the function `sample`, and returns the function's status.
///
/// # Safety
/// The camera is alive, and the function belongs to the camera's library.
pub unsafe fn connect(
    sample: SampleImportance,
    camera: *const realistic_camera,
    scene_points: &ScenePoints,
    found: &mut Connections,
) -> i32 {
    let n = scene_points.len();
    let room = |column: &mut Vec<f32>| {
        column.resize(n, 0.0);
        column.as_mut_ptr()
    };
    let [ox, oy, oz, dx, dy, dz] = found.rays.each_mut().map(room);
    let [image_x, image_y] = found.image.each_mut().map(room);
    let [x, y, z, u, v, time] = scene_points.columns.each_ref().map(|column| column.as_ptr());
    let struct_size = size_of::<realistic_scene_points>() as u32;
    let points = realistic_scene_points {
        struct_size,
        point: realistic_input::columns([x, y, z]),
        lens: realistic_input::columns([u, v]),
        time: realistic_input::columns([time]),
    };
    let aimed = realistic_aimed {
        struct_size: size_of::<realistic_aimed>() as u32,
        origin: realistic_output::columns([ox, oy, oz]),
        direction: realistic_output::columns([dx, dy, dz]),
        density: realistic_output::columns([room(&mut found.density)]),
    };
    let importance = realistic_importance {
        struct_size: size_of::<realistic_importance>() as u32,
        image: realistic_output::columns([image_x, image_y]),
        importance: realistic_output::columns([room(&mut found.importance)]),
        density: realistic_output::NONE,
        area_density: realistic_output::NONE,
        solid_angle_density: realistic_output::NONE,
    };
    // SAFETY: the caller's promise, and every array has `n` elements.
    unsafe { sample(camera, n, &points, &aimed, &importance) }
}

impl Camera {
    /// Connects points of the scene to the camera.
    ///
    /// # Errors
    /// The plugin's error: the camera has no importance.
    pub fn connect(&self, scene_points: &ScenePoints, found: &mut Connections) -> Result<(), PluginError> {
        let sample = self.plugin().functions.camera_sample_importance;
        // SAFETY: the handle is this plugin's and alive.
        self.plugin().check(unsafe { connect(sample, self.handle(), scene_points, found) })
    }
}
