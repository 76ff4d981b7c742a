//! The whole shader: its parameters, the functions from the other files, and the body that calls them.

use super::glass;
use super::light::Light;
use super::numbers::Numbers;
use super::optics::{FOCUS_TERMS, Optics, STOP_TERMS};
use super::polynomial::Polynomial;
use super::pupil;
use super::quarter::QuarterTable;
use super::stations::Station;
use super::table::{FOCI, PupilTable, Span};
use super::text::{is_complete, number, plain};
use super::trace::{self, TracedLens};
use crate::failure::Failure;
use realistic_base::message::{as_given, fixed, short};
use realistic_light::Absorbers;
use realistic_optics::lens::Lens;
use realistic_optics::prescription::{Prescription, SurfaceCoating};

/// Largest number of surfaces in a shader.
const MOST_SURFACES: usize = 64;
/// Largest side, in pixels, of a picture in the stop. The shader's text has its pixels, 10 bytes each; with a picture of
/// this size Blender 5.0 takes half a second more to compile the shader and to begin a render.
const MOST_PICTURE_SIDE: usize = 256;

/// The input of the shader generator.
#[derive(Debug)]
pub struct ShaderRequest<'a> {
    pub prescription: &'a Prescription,
    /// The lens at its widest stop at each focal length, and the index of the initial focal length.
    pub stations: &'a [Station],
    pub start: usize,
    /// Distance from the axis beyond which film points get no light, mm.
    pub reach: f64,
    /// Whether each sample has its own wavelength.
    pub spectral: bool,
    /// Coatings of the surfaces, from the scene on; `None` if transmission is ignored.
    pub coatings: Option<&'a [SurfaceCoating]>,
    /// Whether the lens file describes how the lens zooms, and how groups move to focus.
    pub could_zoom: bool,
    pub could_focus_by_groups: bool,
}

/// A shader and the facts reported to its user.
#[derive(Debug)]
pub struct OslCamera {
    pub text: String,
    /// Shortest and longest focal length, mm; equal for a lens that does not zoom.
    pub focal_lengths: [f64; 2],
    /// f-number at the widest stop and the initial focal length.
    pub fnumber: f64,
    /// Distance of the nearest object in focus from the front vertex, mm.
    pub nearest: f64,
    /// Distance from the axis up to which film points get light, mm.
    pub reach: f64,
}

impl OslCamera {
    /// Writes the shader.
    ///
    /// # Errors
    /// The lens has too many surfaces, cannot focus, or passes no light.
    pub fn of(request: &ShaderRequest<'_>) -> Result<Self, Failure> {
        let ShaderRequest { prescription, stations, start, .. } = *request;
        let lens = &stations[start].lens;
        let name = &lens.name;
        takes(request)?;
        if lens.surfaces.len() > MOST_SURFACES {
            let count = lens.surfaces.len();
            return Err(Failure::Other(format!(
                "lens \"{name}\" has {count} surfaces; a shader is written for at most {MOST_SURFACES}"
            )));
        }
        if let Some([width, height]) = lens.picture().map(|picture| picture.size())
            && width.max(height) > MOST_PICTURE_SIDE
        {
            return Err(Failure::Other(format!(
                "\"stop_picture\" has {width} x {height} pixels; a shader takes at most {MOST_PICTURE_SIDE} a side: scale it down"
            )));
        }
        let stated = nearest_stated(prescription);
        let all: Result<Vec<Optics>, _> =
            stations.iter().map(|station| Optics::of(station, stated)).collect();
        let all = all.map_err(|error| Failure::Other(error.to_string()))?;
        let others: Vec<Lens> = if request.spectral {
            glass::ENDS.iter().map(|nm| Lens::new(prescription, *nm)).collect()
        } else {
            Vec::new()
        };
        let pupils = Pupils::of(&all, &others, request.reach)
            .ok_or_else(|| Failure::Other(format!("no light passes along the axis of lens \"{name}\"")))?;
        let reach = pupils.reach(&all).min(request.reach);
        let optics = &all[start];
        let nearest = all.iter().map(Optics::nearest_object).fold(0.0, f64::max);
        let focal = |station: &Optics| station.focal_length;
        let mut camera = Self {
            text: String::new(),
            focal_lengths: [focal(&all[0]), focal(&all[all.len() - 1])],
            fnumber: optics.widest,
            nearest,
            reach,
        };
        let (gaps, stop_radius_moves) = moving(&all);
        let mut widest = optics.lens.clone();
        let stop_radius = |optics: &Optics| optics.lens.surfaces[optics.stop].semi_diameter;
        widest.surfaces[optics.stop].semi_diameter = all.iter().map(stop_radius).fold(0.0, f64::max);
        let wavelength = (!request.spectral).then_some(widest.wavelength);
        let absorbers = Absorbers::new(&prescription.transmittances());
        let light =
            request.coatings.map(|coatings| Light::new(&widest.surfaces, coatings, &absorbers, wavelength));
        let functions = light.as_ref().map(Light::functions);
        let traced = TracedLens {
            lens: &widest,
            stop: optics.stop,
            focal_length: optics.focal_length,
            gaps: &gaps,
            stop_radius_moves,
            indices: request.spectral.then(|| glass::declarations(&glass::indices(prescription))),
            light,
        };
        camera.text = camera.header(request)
            + if request.spectral { glass::colour() } else { String::new() }.as_str()
            + &functions.unwrap_or_default()
            + &pupils.text(&all)
            + &trace::text(&traced)
            + &entry_function(request, &all, &pupils, &traced);
        if !is_complete(&camera.text) {
            return Err(Failure::Other(format!(
                "lens \"{name}\" has numbers beyond single precision, in which a shader computes; give a lens of millimetres, as in \
                 NAME@35mm"
            )));
        }
        Ok(camera)
    }

    fn header(&self, request: &ShaderRequest<'_>) -> String {
        let Prescription { title, .. } = request.prescription;
        let wavelength = if request.spectral {
            let [from, to] = glass::ENDS;
            format!("a wavelength from {from} to {to} nm for each sample")
        } else {
            format!("{} nm", as_given(request.stations[request.start].lens.wavelength))
        };
        let [shortest, longest] = self.focal_lengths.map(|length| fixed(length, 2));
        let zooms = if shortest == longest { shortest } else { format!("{shortest} to {longest}") };
        let station = &request.stations[request.start];
        let name = plain(&station.lens.name);
        let title = plain(title.as_deref().unwrap_or(&name));
        let facts = serde_json::json!({
            "title": title,
            "focal_lengths_mm": self.focal_lengths,
            "fnumber": self.fnumber,
            "nearest_mm": self.nearest,
            "film_reach_mm": self.reach,
            "loses_light": request.coatings.is_some(),
            "focuses_by_groups": station.focuses_by_groups(),
            "could_zoom": request.could_zoom,
            "could_focus_by_groups": request.could_focus_by_groups,
        });
        format!(
            "/* {}: {}\n   \
                A camera for Blender (Cycles, Open Shading Language), written by realistic {}.\n   \
                Focal length {} mm, widest f/{}, nearest focus {} mm in front of the lens, film points up to {} mm from\n   \
                the axis; {}; {}{}.\n   \
                The camera's Depth of Field must be on; from it come focus and f-number, and from the camera the sensor. */\n\
             // facts: {}\n\n",
            name,
            title,
            env!("CARGO_PKG_VERSION"),
            zooms,
            fixed(self.fnumber, 2),
            short(self.nearest),
            fixed(self.reach, 2),
            wavelength,
            if station.focuses_by_groups() {
                "its groups move to focus"
            } else {
                "the whole lens moves to focus"
            },
            if request.coatings.is_some() { ";\n   what its surfaces reflect is lost" } else { "" },
            facts,
        )
    }
}

/// Checks that the shader can trace the lens and sample its pupil; the error names what it cannot do.
fn takes(request: &ShaderRequest<'_>) -> Result<(), Failure> {
    let lens = &request.stations[request.start].lens;
    let is_posed =
        lens.film_break.is_some() || lens.surfaces.iter().any(|surface| surface.coordinate_break.is_some());
    let (what, instead) = if lens.has_mirror() {
        ("mirrors", "a host of the library renders it")
    } else if is_posed {
        ("tilted or decentred surfaces", "a host of the library renders it, or remove them from the file")
    } else if !lens.is_round() && request.stations.len() > 1 {
        ("cylindrical surfaces and zooms", "choose one focal length with --zoom")
    } else {
        return Ok(());
    };
    Err(Failure::Other(format!(
        "lens \"{}\" has {what}, which a shader for Blender cannot trace: {instead}",
        lens.name
    )))
}

/// The pupils of all film points.
enum Pupils {
    Round(PupilTable),
    Quarter(QuarterTable),
}

impl Pupils {
    /// Makes the tables for film points up to `reach` mm from the axis, as [`PupilTable::of`].
    fn of(stations: &[Optics], others: &[Lens], reach: f64) -> Option<Self> {
        match stations {
            [optics] if !optics.lens.is_round() => QuarterTable::of(optics, others, reach).map(Self::Quarter),
            _ => PupilTable::of(stations, others, reach).map(Self::Round),
        }
    }

    /// Returns the distance from the axis up to which film points get light, mm; the smallest of all stations applies.
    fn reach(&self, stations: &[Optics]) -> f64 {
        let bright = |(optics, span): (&Optics, &Span)| {
            span.widest_field * (optics.film_distance(0.0, 1.0) + optics.plane)
        };
        match self {
            Self::Round(table) => {
                stations.iter().zip(&table.stations).map(bright).fold(f64::INFINITY, f64::min)
            }
            Self::Quarter(table) => table.reach,
        }
    }

    /// Returns the function `pupil`.
    fn text(&self, stations: &[Optics]) -> String {
        match self {
            Self::Round(table) => pupil::text(stations, table),
            Self::Quarter(table) => table.text(),
        }
    }

    /// Returns the text that calls the function `pupil`.
    fn sampling(&self, stations: &[Optics], numbers: &mut Numbers) -> String {
        match self {
            Self::Round(table) => pupil::sampling(stations, table, numbers),
            Self::Quarter(table) => table.sampling(),
        }
    }
}

/// Returns the distance of the nearest object for which the lens file has a position, mm in front of the front
/// vertex.
fn nearest_stated(prescription: &Prescription) -> Option<f64> {
    let positions = prescription.positions.as_ref()?;
    positions.columns.iter().filter_map(|column| column.object_distance).reduce(f64::min)
}

/// Returns the gaps that change as the lens zooms or its groups focus, each as the index of the surface before it and
/// its largest value, mm. Also returns whether the stop's clear semi-diameter changes.
fn moving(all: &[Optics]) -> (Vec<(usize, f64)>, bool) {
    // Each value is monotonic in the focus.
    let lenses: Vec<Lens> =
        all.iter().flat_map(|optics| [0.0, 0.5, 1.0].map(|f| optics.focused(f))).collect();
    let changes = |value: &dyn Fn(&Lens) -> f64| {
        let first = value(&lenses[0]);
        lenses.iter().any(|lens| (value(lens) - first).abs() > 1e-9)
    };
    let gaps = (0..lenses[0].surfaces.len() - 1)
        .filter(|&row| changes(&|lens: &Lens| lens.surfaces[row].thickness))
        .map(|row| (row, lenses.iter().map(|lens| lens.surfaces[row].thickness).fold(0.0, f64::max)))
        .collect();
    (gaps, changes(&|lens: &Lens| lens.surfaces[all[0].stop].semi_diameter))
}

/// Returns the text of the values that move, as functions of the focus.
fn moved(all: &[Optics], traced: &TracedLens<'_>, numbers: &mut Numbers) -> Vec<(String, String)> {
    let fixed = |value: f64| Polynomial([value, 0.0, 0.0, 0.0, 0.0]);
    let gap = |optics: &Optics, row: usize| match &optics.motion {
        Some(motion) => motion.gaps[row],
        None => fixed(optics.lens.surfaces[row].thickness),
    };
    let stop_radius = |optics: &Optics| match &optics.motion {
        Some(motion) => motion.stop_radius,
        None => fixed(optics.lens.surfaces[optics.stop].semi_diameter),
    };
    let mut of = |value: &dyn Fn(&Optics) -> Polynomial<FOCUS_TERMS>| {
        let rows: Vec<Polynomial<FOCUS_TERMS>> = all.iter().map(value).collect();
        let rows: Vec<&[f64]> = rows.iter().map(|row| row.0.as_slice()).collect();
        numbers.polynomial(&rows, "focus")
    };
    let mut texts: Vec<String> =
        traced.gaps.iter().map(|&(row, _)| of(&|optics: &Optics| gap(optics, row))).collect();
    if traced.stop_radius_moves {
        texts.push(of(&stop_radius));
    }
    traced.moving().into_iter().zip(texts).collect()
}

/// Returns the text of the film distance as a function of the focus and the square of the stop.
fn film_distance(all: &[Optics], numbers: &mut Numbers) -> String {
    let mut row = |power: usize| {
        let rows: Vec<&[f64]> = all.iter().map(|optics| optics.film[power].0.as_slice()).collect();
        numbers.polynomial(&rows, "focus")
    };
    let highest = row(STOP_TERMS - 1);
    (0..STOP_TERMS - 1).rev().fold(highest, |sum, power| format!("({sum}*s2 +\n      {})", row(power)))
}

/// Returns the shader with its parameters.
fn entry_function(
    request: &ShaderRequest<'_>,
    all: &[Optics],
    pupils: &Pupils,
    traced: &TracedLens<'_>,
) -> String {
    let colour = if request.spectral {
        "  /* A wavelength of its own for every sample: a third random number, by hashing the two that there are. */\n  \
           float nm = mix(420, 680, noise(\"hash\", point(lens_sample[0], lens_sample[1], raster[0]), raster[1]));\n"
    } else {
        "  float nm = 0;\n"
    };
    let throughput = if request.spectral { "colour_of(nm)*weight" } else { "color(weight)" };
    let zooms: Vec<f64> = request.stations.iter().map(|station| station.zoom).collect();
    let is_zoom = zooms.len() > 1;
    let zoom = if is_zoom {
        let [from, start, to] = [0, request.start, zooms.len() - 1].map(|station| number(zooms[station]));
        format!(
            "float zoom = {start} [[ string label = \"Zoom\", float min = {from}, float max = {to}, float sensitivity = 1,\n      \
               string help = \"Focal length of the zoom lens, mm\" ]],\n    "
        )
    } else {
        String::new()
    };
    let mut numbers = Numbers::new(all.len());
    let mut of = |value: fn(&Optics) -> f64| numbers.text(all.iter().map(value));
    let widest = of(|optics| optics.widest);
    let entrance = of(|optics| optics.entrance);
    let focus_point = of(|optics| optics.focus_point);
    let farthest = of(|optics| 1.0 / optics.nearest);
    let plane = of(|optics| optics.plane);
    let focal_length = of(Optics::front_focal_length);
    let squeeze = match traced.lens.is_round() {
        true => String::new(),
        false => of(Optics::squeeze) + "*",
    };
    let magnified = of(|optics| optics.nearest * optics.rear_focal_length());
    let steps = (FOCI - 1) as f64;
    // Position in the table for a focus.
    let table_position = if all[0].motion.is_some() {
        format!("{}*focus", number(steps))
    } else {
        let per = |optics: &Optics| {
            let [shortest, longest] = optics.distances();
            (steps / (1.0 / shortest - 1.0 / longest), shortest)
        };
        let first = numbers.text(all.iter().map(|optics| per(optics).0 / per(optics).1));
        let per = numbers.text(all.iter().map(|optics| per(optics).0));
        format!("{first} - far*{per}")
    };
    let film = film_distance(all, &mut numbers);
    let per_width: Vec<&[f64]> = all.iter().map(|optics| optics.stop_per_width.0.as_slice()).collect();
    let per_width = numbers.polynomial(&per_width, "wide2");
    let moved = moved(all, traced, &mut numbers);
    let names: String = moved.iter().map(|(name, _)| format!("  float {name} = 0;\n")).collect();
    let set: String = moved.iter().map(|(name, text)| format!("    {name} = {text};\n")).collect();
    let given: String = moved.iter().map(|(name, _)| format!(", {name}")).collect();
    let [declared, left, lost] = match traced.changes_light() {
        true => ["  float left = 1;\n", ", left", "  weight *= left;\n"],
        false => [""; 3],
    };
    let sampling = pupils.sampling(all, &mut numbers);
    let rear = trace::behind_front(traced, traced.lens.surfaces.len() - 1);
    format!(
        "shader realistic_camera(\n    \
             {zoom}\
             float fnumber = 0 [[ string label = \"F-Number\", float min = 0, float sensitivity = 0.1,\n      \
               string help = \"0: the camera's F-Stop; the lens opens no wider than its own\" ]],\n    \
             float focus_distance = 0 [[ string label = \"Focus Distance\", float min = 0, string unit = \"m\",\n      \
               string help = \"0: the camera's Focus Distance or object; without Depth of Field infinity\" ]],\n    \
             int camera_point = 0 [[ string label = \"Camera's Origin\", string widget = \"mapper\",\n      \
               string options = \"Front of the lens:0|Entrance pupil:1|Film:2\",\n      \
               string help = \"Which point of the lens is where the camera object is\" ]],\n    \
             float focal_length = 0 [[ string label = \"Focal Length in 4.5\", float min = 0,\n      \
               string help = \"In Blender 4.5 the camera's Focal Length in mm, through which it gives its F-Stop; 0: Blender 5.0 and later\" ]],\n    \
             float mm_per_unit = 1000 [[ string label = \"Millimetres per Unit\", float min = 1e-6,\n      \
               string help = \"1000 in a scene in metres\" ]],\n    \
             output point position = 0,\n    \
             output vector direction = 0,\n    \
             output color throughput = 0,\n    \
             output vector dPdx = 0,\n    output vector dPdy = 0,\n    output vector dDdx = 0,\n    output vector dDdy = 0)\n{{\n  \
           point raster = camera_shader_raster_position();\n  \
           point lens_sample = camera_shader_random_sample();\n  \
           vector sensor = 0;\n  \
           getattribute(\"cam:sensor_size\", sensor);\n  \
\n{}  \
           /* The width of the beam from a distant point on the axis, and the stop that leaves so much of it. Without\n     \
              Depth of Field the aperture's size is 0. */\n  \
           float number = fnumber;\n  \
           if (number <= 0) {{\n    \
             float size = 0;\n    \
             getattribute(\"cam:aperture_size\", size);\n    \
             /* In 4.5 the radius of the aperture in m, of a lens with the camera's focal length. */\n    \
             number = size > 0 ? (focal_length > 0 ? 0.0005*focal_length : 0.5)/size : 0;\n  }}\n  \
           float wide = number > {widest} ? {widest}/number : 1;\n  \
           float wide2 = wide*wide;\n  \
           float stop = number > {widest} ? min(wide*{per_width}, 1.0) : 1.0;\n  \
           float s2 = stop*stop;\n\n  \
           /* The focus, and with it the film, for the sharpest image on the axis. Counted from the film, which moves, by a few\n     \
              steps. */\n  \
           float object = focus_distance;\n  \
           if (object <= 0)\n    getattribute(\"cam:focal_distance\", object);\n  \
           float focus = 0;\n  \
           float back = 0;\n  \
           float origin = camera_point == 1 ? {entrance} : 0;\n{names}  \
           for (int i = camera_point == 2 ? 5 : 1; i > 0; i--) {{\n    \
             if (object > 0 && i < 5) {{\n      \
               float ahead = object*mm_per_unit + origin - {focus_point};\n      \
               focus = ahead > {farthest} ? {farthest}/ahead : 1;\n    }}\n    \
             back = {film};\n{set}    \
             if (camera_point == 2)\n      origin = 0{rear} - back;\n  }}\n\n  \
           /* The film point: the image on film is upside down. */\n  \
           float fx = (0.5 - raster[0])*sensor[0];\n  \
           float fy = (0.5 - raster[1])*sensor[1];\n  \
           float far = 1/(back + {plane});\n  \
           float b = clamp({table_position}, 0.0, {});\n  \
           float px = 0, py = 0, patch = 0;\n{}\n  \
           /* The ray on the plane of the last vertex. */\n  \
           float x = fx + back*sx;\n  \
           float y = fy + back*sy;\n  \
           float z = 0;\n  \
           float vz = 1/sqrt(1 + sx*sx + sy*sy);\n  \
           float vx = sx*vz;\n  \
           float vy = sy*vz;\n  \
           /* Irradiance of the sample over that of the film's centre. */\n  \
           float weight = patch*far*far*vz*vz*vz*vz/centre;\n{colour}{declared}  \
           if (!trace(stop, nm, x, y, z, vx, vy, vz{given}{left}))\n    return;\n{lost}  \
           position = point(x, y, z - origin)/mm_per_unit;\n  \
           direction = vector(vx, vy, vz);\n  \
           throughput = {throughput};\n  \
           /* From pixel to pixel, by first-order optics: what textures are filtered by. */\n  \
           float scale = 1/({focal_length}*(1 + focus*{magnified}));\n  \
           dDdx = vector({squeeze}scale*sensor[0]*Dx(raster[0]), 0, 0);\n  \
           dDdy = vector(0, scale*sensor[1]*Dy(raster[1]), 0);\n}}\n",
        numbers.declarations(&zooms),
        number(steps),
        sampling,
    )
}
