//! The whole shader: its parameters, the functions of the other files and the body that joins them.

use super::glass;
use super::optics::{FOCUS_TERMS, Optics, STOP_TERMS};
use super::pupil;
use super::table::Table;
use super::text::{number, plain};
use super::trace::{self, Traced};
use crate::failure::Failure;
use realistic::lens::Lens;
use realistic::message::{as_given, fixed, short};
use realistic::prescription::Prescription;

/// The most surfaces that a shader is written for.
const MOST_SURFACES: usize = 64;

/// What a shader is to be made of.
#[derive(Debug)]
pub struct Request<'a> {
    pub prescription: &'a Prescription,
    /// The lens at its widest stop.
    pub lens: &'a Lens,
    /// Film points farther than this from the axis get no light, mm.
    pub reach: f64,
    /// Whether each sample has a wavelength of its own.
    pub spectral: bool,
}

/// A shader and what its user is told of it.
#[derive(Debug)]
pub struct Camera {
    pub text: String,
    pub focal_length: f64,
    /// At the widest stop.
    pub fnumber: f64,
    /// Distance of the nearest object in focus from the front vertex, mm.
    pub nearest: f64,
    /// Film points get light up to this distance from the axis, mm.
    pub reach: f64,
}

impl Camera {
    /// Writes the shader.
    ///
    /// # Errors
    /// The lens has too many surfaces, cannot focus, or passes no light.
    pub fn of(request: &Request<'_>) -> Result<Self, Failure> {
        let Request { prescription, lens, .. } = *request;
        let name = &lens.name;
        if lens.surfaces.len() > MOST_SURFACES {
            let count = lens.surfaces.len();
            return Err(Failure::Other(format!(
                "lens \"{name}\" has {count} surfaces; a shader is written for at most {MOST_SURFACES}"
            )));
        }
        let optics = Optics::of(lens, nearest_stated(prescription))
            .map_err(|error| Failure::Other(error.to_string()))?;
        let others: Vec<Lens> = if request.spectral {
            glass::ENDS.iter().map(|nm| with_indices(lens, &Lens::new(prescription, *nm))).collect()
        } else {
            Vec::new()
        };
        let table = Table::of(&optics, &others, request.reach)
            .ok_or_else(|| Failure::Other(format!("no light passes along the axis of lens \"{name}\"")))?;
        let reach = (table.widest_field * (optics.film_distance(0.0, 1.0) + optics.plane)).min(request.reach);
        let mut camera = Self {
            text: String::new(),
            focal_length: optics.focal_length,
            fnumber: optics.widest,
            nearest: optics.nearest_object(),
            reach,
        };
        let indices = request.spectral.then(|| glass::declarations(&glass::indices(prescription)));
        let traced = Traced {
            lens,
            stop: optics.stop,
            blades: prescription.blades,
            focal_length: optics.focal_length,
            indices,
        };
        camera.text = camera.header(request)
            + if request.spectral { glass::colour() } else { String::new() }.as_str()
            + &film_distance(&optics)
            + &pupil::text(&optics, &table)
            + &trace::text(&traced)
            + &body(&optics, request.spectral);
        Ok(camera)
    }

    fn header(&self, request: &Request<'_>) -> String {
        let Prescription { title, .. } = request.prescription;
        let wavelength = if request.spectral {
            let [from, to] = glass::ENDS;
            format!("a wavelength from {from} to {to} nm for each sample")
        } else {
            format!("{} nm", as_given(request.lens.wavelength))
        };
        format!(
            "/* {}: {}\n   \
                A camera for Blender (Cycles, Open Shading Language), written by realistic {}.\n   \
                Focal length {} mm, widest f/{}, nearest focus {} mm in front of the lens, film points up to {} mm from\n   \
                the axis; {}.\n   \
                The camera's Depth of Field must be on; from it come focus and f-number, and from the camera the sensor. */\n\n",
            plain(&request.lens.name),
            plain(title.as_deref().unwrap_or("a lens")),
            env!("CARGO_PKG_VERSION"),
            fixed(self.focal_length, 2),
            fixed(self.fnumber, 2),
            short(self.nearest),
            fixed(self.reach, 2),
            wavelength,
        )
    }
}

/// The nearest object, mm in front of the front vertex, that the lens file has a position for.
fn nearest_stated(prescription: &Prescription) -> Option<f64> {
    let positions = prescription.positions.as_ref()?;
    positions.columns.iter().filter_map(|column| column.object_distance).reduce(f64::min)
}

/// The lens with the indices of the same one at another wavelength.
fn with_indices(lens: &Lens, other: &Lens) -> Lens {
    let mut lens = lens.clone();
    for (surface, other) in lens.surfaces.iter_mut().zip(&other.surfaces) {
        (surface.n_scene, surface.n_film) = (other.n_scene, other.n_film);
    }
    lens
}

/// The function `film_distance`.
fn film_distance(optics: &Optics) -> String {
    let row = |power: usize| {
        let terms = optics.film[power].0;
        let start = number(terms[FOCUS_TERMS - 1]);
        terms[..FOCUS_TERMS - 1]
            .iter()
            .rev()
            .fold(start, |sum, term| format!("({sum}*f + {})", number(*term)))
    };
    let sum = (0..STOP_TERMS - 1)
        .rev()
        .fold(row(STOP_TERMS - 1), |sum, power| format!("({sum}*s2 +\n      {})", row(power)));
    format!(
        "/* Distance of the film from the last vertex for the sharpest image on the axis, mm: of the focus and the square of the\n   \
            stop. */\n\
         float film_distance(float f, float s2)\n{{\n  return {sum};\n}}\n\n"
    )
}

/// The shader with its parameters.
fn body(optics: &Optics, spectral: bool) -> String {
    let colour = if spectral {
        "  /* A wavelength of its own for every sample: a third random number, by hashing the two that there are. */\n  \
           float nm = mix(420, 680, noise(\"hash\", point(lens_sample[0], lens_sample[1], raster[0]), raster[1]));\n"
    } else {
        "  float nm = 0;\n"
    };
    let throughput = if spectral { "colour_of(nm)*weight" } else { "color(weight)" };
    format!(
        "shader realistic_camera(\n    \
             float fnumber = 0 [[ string label = \"F-Number\", float min = 0, float sensitivity = 0.1,\n      \
               string help = \"0: the camera's F-Stop; the lens opens no wider than its own\" ]],\n    \
             float focus_distance = 0 [[ string label = \"Focus Distance\", float min = 0, string unit = \"m\",\n      \
               string help = \"0: the camera's Focus Distance or object; without Depth of Field infinity\" ]],\n    \
             int camera_point = 0 [[ string label = \"Camera's Origin\", string widget = \"mapper\",\n      \
               string options = \"Front of the lens:0|Entrance pupil:1|Film:2\",\n      \
               string help = \"Which point of the lens is where the camera object is\" ]],\n    \
             float focal_length = 0 [[ string label = \"Focal Length in 4.5\", float min = 0,\n      \
               string help = \"In Blender 4.5 the camera's Focal Length in mm, through which it gives its F-Stop; 0: Blender 5.0 and later\" ]],\n    \
             float unit = 1000 [[ string label = \"Millimetres per Unit\", float min = 1e-6,\n      \
               string help = \"1000 in a scene in metres\" ]],\n    \
             output point position = 0,\n    \
             output vector direction = 0,\n    \
             output color throughput = 0,\n    \
             output vector dPdx = 0,\n    output vector dPdy = 0,\n    output vector dDdx = 0,\n    output vector dDdy = 0)\n{{\n  \
           point raster = camera_shader_raster_position();\n  \
           point lens_sample = camera_shader_random_sample();\n  \
           vector sensor = 0;\n  \
           getattribute(\"cam:sensor_size\", sensor);\n  \
\n  \
           /* The stop. Without Depth of Field the aperture's size is 0. */\n  \
           float number = fnumber;\n  \
           if (number <= 0) {{\n    \
             float size = 0;\n    \
             getattribute(\"cam:aperture_size\", size);\n    \
             /* In 4.5 the radius of the aperture in m, of a lens with the camera's focal length. */\n    \
             number = size > 0 ? (focal_length > 0 ? 0.0005*focal_length : 0.5)/size : 0;\n  }}\n  \
           float stop = number > {} ? min({}/number, 1.0) : 1.0;\n\n  \
           /* The focus, and with it the film. */\n  \
           float object = focus_distance;\n  \
           if (object <= 0)\n    getattribute(\"cam:focal_distance\", object);\n  \
           float focus = 0;\n  \
           float back = 0;\n  \
           float origin = camera_point == 1 ? {} : 0;\n  \
           if (camera_point == 2)\n    origin = {} - film_distance(0, stop*stop);\n  \
           /* From the film, which moves, by a few steps. */\n  \
           for (int i = camera_point == 2 ? 4 : 1; i > 0; i--) {{\n    \
             if (object > 0) {{\n      \
               float ahead = object*unit + origin - {};\n      \
               focus = ahead > {} ? {}/ahead : 1;\n    }}\n    \
             back = film_distance(focus, stop*stop);\n    \
             if (camera_point == 2)\n      origin = {} - back;\n  }}\n\n  \
           /* The film point: the image on film is upside down. */\n  \
           float fx = (0.5 - raster[0])*sensor[0];\n  \
           float fy = (0.5 - raster[1])*sensor[1];\n  \
           float r = sqrt(fx*fx + fy*fy);\n  \
           float ex = r > 0 ? fx/r : 1;\n  \
           float ey = r > 0 ? fy/r : 0;\n  \
           float far = 1/(back + {});\n  \
           float px = 0, py = 0, patch = 0;\n  \
           if (!pupil(r*far, far, stop, lens_sample[0], lens_sample[1], px, py, patch))\n    return;\n\n  \
           /* Slopes, and the ray on the plane of the last vertex. */\n  \
           float along = (px - r)*far;\n  \
           float across = py*far;\n  \
           float x = fx + back*(ex*along - ey*across);\n  \
           float y = fy + back*(ey*along + ex*across);\n  \
           float z = 0;\n  \
           float vz = 1/sqrt(1 + along*along + across*across);\n  \
           float vx = (ex*along - ey*across)*vz;\n  \
           float vy = (ey*along + ex*across)*vz;\n  \
           /* Irradiance of the sample over that of the film's centre. */\n  \
           float opening = on_axis(far, stop)*far*far;\n  \
           float weight = patch*far*far*vz*vz*vz*vz*(1 + opening)/opening;\n{colour}  \
           if (!trace(stop, nm, x, y, z, vx, vy, vz))\n    return;\n  \
           position = point(x, y, z - origin)/unit;\n  \
           direction = vector(vx, vy, vz);\n  \
           throughput = {throughput};\n  \
           /* From pixel to pixel, by first-order optics: what textures are filtered by. */\n  \
           float scale = 1/({}*(1 + focus*{}));\n  \
           dDdx = vector(scale*sensor[0]*Dx(raster[0]), 0, 0);\n  \
           dDdy = vector(0, scale*sensor[1]*Dy(raster[1]), 0);\n}}\n",
        number(optics.widest),
        number(optics.fnumber_of_stop),
        number(optics.entrance),
        number(optics.lens.rear().vertex),
        number(optics.front_focal_point),
        number(1.0 / optics.nearest),
        number(1.0 / optics.nearest),
        number(optics.lens.rear().vertex),
        number(optics.plane),
        number(optics.focal_length),
        number(optics.nearest * optics.focal_length),
    )
}
