//! OSL text of the trace, unrolled: it follows a ray from the rear vertex plane through every surface to the front
//! surface.
//!
//! The arithmetic is that of the kernel (`realistic_optics::trace`): V = n D, curvatures instead of radii, one frame
//! per surface with the transfer from vertex to vertex, and two square roots per surface, without a division if the
//! curvature is strong.

use super::figure;
use super::light::{Light, Meeting};
use super::text::{array, number};
use realistic_optics::lens::{Lens, Surface};
use realistic_optics::prescription::{Aperture, StopPicture};
use realistic_optics::trace::{ApertureTest, Edge, OutlineTest, PictureTest};
use std::fmt::Write as _;

/// Radius of curvature, in focal lengths, below which a surface counts as strong: the division-free form of the
/// distance to it keeps enough digits.
const STRONG: f64 = 2.0;
/// Distance to the vertex, in radii of curvature, beyond which the ray is first moved to the vertex plane.
const FAR: f64 = 3.0;
/// Semi-diameter, in radii of curvature, above which a test must exclude the other half of the sphere.
const WIDE: f64 = 0.7;

/// The input of the text.
#[derive(Debug)]
pub struct TracedLens<'a> {
    pub lens: &'a Lens,
    /// The surface whose aperture the f-number sets, counted from the scene.
    pub stop: usize,
    pub focal_length: f64,
    /// Gaps that change, each as the index of the surface before it, which gives the variable's name, and its largest
    /// value, mm.
    pub gaps: &'a [(usize, f64)],
    /// Whether the stop's clear semi-diameter changes and is in the variable `stop_radius`.
    pub stop_radius_moves: bool,
    /// Declarations of the indices, for dispersion.
    pub indices: Option<String>,
    /// Transmission of surfaces and glasses; `None` if it is ignored.
    pub light: Option<Light<'a>>,
}

impl TracedLens<'_> {
    /// Returns the names of the numbers that change; `gap5` is the gap behind row 5.
    pub fn moving(&self) -> Vec<String> {
        let gaps = self.gaps.iter().map(|(row, _)| format!("gap{}", row + 1));
        gaps.chain(self.stop_radius_moves.then(|| "rim".to_owned())).collect()
    }

    /// Whether the trace returns a factor for the light of the ray: with transmission, with a picture in the stop, and
    /// where the radiance varies.
    pub fn changes_light(&self) -> bool {
        self.light.is_some() || self.lens.picture().is_some() || self.radiance_varies()
    }

    /// Whether the factor (n'/n)² of the radiance depends on the wavelength of the ray.
    fn radiance_varies(&self) -> bool {
        self.indices.is_some() && self.lens.outer_indices() != [1.0; 2]
    }

    /// Returns the text of the index of a medium: 0 is the scene's, i that behind row i. Its index at the lens's own
    /// wavelength is `n`.
    fn index(&self, medium: usize, n: f64) -> String {
        if self.indices.is_some() && n != 1.0 { format!("n{medium}") } else { number(n) }
    }
}

/// A length along the axis: the sum of a fixed part and gaps that change.
#[derive(Clone, Default)]
struct Length {
    fixed: f64,
    gaps: Vec<usize>,
    /// Length with all gaps at their largest.
    most: f64,
}

impl Length {
    fn add(&mut self, traced: &TracedLens<'_>, row: usize) {
        let moving = traced.gaps.iter().find(|(moving, _)| *moving == row);
        let gap = traced.lens.surfaces[row].thickness;
        match moving {
            Some((_, most)) => {
                self.gaps.push(row + 1);
                self.most += most;
            }
            None => {
                self.fixed += gap;
                self.most += gap;
            }
        }
    }

    fn is_zero(&self) -> bool {
        self.fixed == 0.0 && self.gaps.is_empty()
    }

    /// Returns the text for a subtraction of the length: a minus sign precedes each part.
    fn subtracted(&self) -> String {
        let fixed = (self.fixed != 0.0).then(|| format!(" - {}", number(self.fixed)));
        fixed.into_iter().chain(self.gaps.iter().map(|row| format!(" - gap{row}"))).collect()
    }
}

/// Returns the text to be subtracted from z in the frame of the first vertex to get z in the frame of the surface
/// `row`.
pub fn behind_front(traced: &TracedLens<'_>, row: usize) -> String {
    let mut length = Length::default();
    (0..row).for_each(|row| length.add(traced, row));
    length.subtracted()
}

/// Returns the function `trace`, and the function `picture` that it calls if a picture dims the light.
pub fn text(traced: &TracedLens<'_>) -> String {
    let lens = traced.lens;
    let moving: String = traced.moving().iter().map(|name| format!(", float {name}")).collect();
    let left = if traced.changes_light() { ", output float left" } else { "" };
    let mut text = lens.picture().map_or_else(String::new, picture_function);
    let _ = write!(
        text,
        "/* Takes a ray from (x, y) on the plane of the last vertex, with unit direction (vx, vy, vz), through every\n   \
            surface to the first: the point is then in the frame of the first vertex. 0: it is blocked. Lengths in mm;\n   \
            stop: the clear diameter of the stop over its widest{}{}. */\n\
         int trace(float stop, float nm, output float x, output float y, output float z, output float vx,\n          \
         output float vy, output float vz{moving}{left})\n{{\n",
        if moving.is_empty() { "" } else { "; then what moves" },
        if traced.changes_light() { "; left: the factor of its light" } else { "" },
    );
    if let Some(indices) = &traced.indices {
        text += indices;
    }
    text += "  float r2 = x*x + y*y;\n  float f = 0, g = 0, e = 0, q = 0, t = 0, k = 0, h = 0, j = 0;\n  z = 0;\n";
    if lens.surfaces.iter().any(|surface| !surface.apertures.is_empty()) {
        text += "  /* A point in a shaped aperture, and what decides whether it lies inside. */\n  \
                 float u = 0, v = 0, m = 0;\n";
    }
    if traced.changes_light() {
        text += "  left = 1;\n";
    }
    if traced.light.is_some() {
        text += "  vector stokes = 0, across = 0;\n";
    }
    let [n_scene, n_film] = lens.outer_indices();
    let [scene, film] = [(0, n_scene), (lens.surfaces.len(), n_film)].map(|(i, n)| traced.index(i, n));
    if n_film != 1.0 {
        let _ = writeln!(text, "  vx *= {film};\n  vy *= {film};\n  vz *= {film};");
    }
    // Absorption coefficient of the medium behind each row, if it absorbs. The film's medium is no part of the lens.
    let absorption: Vec<Option<String>> = (0..lens.surfaces.len())
        .map(|row| traced.light.as_ref().filter(|_| row + 1 < lens.surfaces.len())?.absorption(row))
        .collect();
    if absorption.iter().any(Option::is_some) {
        text += "  /* Where the glass that the ray is in began. */\n  float px = 0, py = 0, pz = 0;\n";
    }
    // Distance from the vertex of the current frame to the next vertex.
    let mut pending = Length::default();
    let mut last = lens.surfaces.len() - 1;
    for (i, surface) in lens.surfaces.iter().enumerate().rev() {
        if i + 1 < lens.surfaces.len() {
            pending.add(traced, i);
        }
        let _ = writeln!(text, "  /* Row {}. */", i + 1);
        let limit = match i == traced.stop {
            true if traced.stop_radius_moves => "stop*stop*rim*rim".to_owned(),
            true => format!("stop*stop*{}", number(surface.semi_diameter.powi(2))),
            false => number(surface.semi_diameter.powi(2)),
        };
        let radius = match i == traced.stop {
            true if traced.stop_radius_moves => "stop*rim".to_owned(),
            true => format!("stop*{}", number(surface.semi_diameter)),
            false => number(surface.semi_diameter),
        };
        let is_plane = surface.curvature == 0.0 && surface.figure.is_none() && surface.unsymmetric.is_none();
        // Between media of equal index there is no refraction, but another glass may begin.
        let ahead = i.checked_sub(1).and_then(|row| absorption[row].as_ref());
        let changes = absorption[i].as_ref() != ahead;
        if is_plane && surface.n_film == surface.n_scene && !changes {
            opening(&mut text, &pending, &limit);
            apertures(&mut text, traced, &surface.apertures, &radius, ["f", "g", "vz"]);
            continue;
        }
        let absorbed = absorption[i].as_ref().map_or_else(String::new, |coefficient| {
            format!(
                "  t = exp(-({coefficient})*sqrt((x - px)*(x - px) + (y - py)*(y - py) + (z - pz)*(z - pz)));\n  \
                   left *= t;\n  stokes = stokes*t;\n"
            )
        });
        if !pending.is_zero() {
            let offset = pending.subtracted();
            let _ = writeln!(text, "  z = z{offset};");
            if !absorbed.is_empty() {
                let _ = writeln!(text, "  pz = pz{offset};");
            }
        }
        // The medium before the surface is on the film's side; the medium behind it belongs to the previous row.
        let (before, after) = (surface.n_film, surface.n_scene);
        let (squares, step) = match &traced.indices {
            Some(_) => {
                let [before, after] = [traced.index(i + 1, before), traced.index(i, after)];
                let step = format!("({after} - {before})*({after} + {before})");
                ([before, after].map(|n| format!("{n}*{n}")), step)
            }
            None => {
                let step = number((after - before) * (after + before));
                ([before, after].map(|n| number(n * n)), step)
            }
        };
        let light = |(cosines, normal): ([&str; 2], [&str; 3])| {
            let meeting = Meeting { cosines, squares: [&squares[0], &squares[1]], normal };
            let line = |light: &Light<'_>| absorbed.clone() + &light.line(i, surface, &meeting);
            traced.light.as_ref().map_or_else(String::new, line)
        };
        if surface.figure.is_some() || surface.unsymmetric.is_some() {
            figure::surface(&mut text, surface, &limit, &step, &light(figure::MEETING));
        } else if is_plane {
            plane(&mut text, &limit, &step, &light((["vz", "f"], ["0", "0", "1"])));
        } else {
            let curvature = number(-surface.curvature);
            let [x, y, z] = ["-", "-", "1 - "].map(|sign| format!("{sign}{curvature}*"));
            let normal = [x + "x", y + "y", z + "z"];
            let normal: [&str; 3] = std::array::from_fn(|axis| &*normal[axis]);
            let light = light((["e", "f"], normal));
            sphere(&mut text, traced, surface, pending.most, &limit, [&squares[0], &step], &light);
        }
        apertures(&mut text, traced, &surface.apertures, &radius, ["x", "y", "1.0"]);
        if ahead.is_some() {
            text += "  px = x;\n  py = y;\n  pz = z;\n";
        }
        (pending, last) = (Length::default(), i);
    }
    let offset = behind_front(traced, last);
    if !offset.is_empty() {
        let _ = writeln!(text, "  z = z{offset};");
    }
    if n_scene != 1.0 {
        let _ = writeln!(text, "  vx /= {scene};\n  vy /= {scene};\n  vz /= {scene};");
    }
    if traced.radiance_varies() {
        let own = number((n_scene / n_film).powi(2));
        let _ = writeln!(text, "  left *= {own}*({film}*{film})/({scene}*{scene});");
    }
    text + "  return 1;\n}\n\n"
}

/// Writes the test of a plane aperture, which does not move the ray to the aperture.
fn opening(text: &mut String, ahead: &Length, limit: &str) {
    let z = if ahead.is_zero() { "z".to_owned() } else { format!("(z{})", ahead.subtracted()) };
    let _ = writeln!(text, "  f = x*vz - {z}*vx;\n  g = y*vz - {z}*vy;");
    let _ = writeln!(text, "  if (f*f + g*g > {limit}*vz*vz || vz <= 0)\n    return 0;");
}

/// Writes the tests of the apertures and obstructions inside a clear aperture of the semi-diameter `radius`, for the
/// point (x, y) times `w`. The constants are those of [`ApertureTest`] for a clear semi-diameter of 1.
fn apertures(
    text: &mut String,
    traced: &TracedLens<'_>,
    apertures: &[Aperture],
    radius: &str,
    [x, y, w]: [&str; 3],
) {
    for aperture in apertures {
        let test = ApertureTest::<f64>::new(aperture, 1.0);
        let inside = match &test.outline {
            OutlineTest::Convex(test) => {
                let [cx, cy] = test.center.map(number);
                let [[xx, xy], [yx, yy]] = test.axes.map(|row| row.map(number));
                let _ = writeln!(text, "  m = {x} - {cx}*{radius}*{w};\n  v = {y} - {cy}*{radius}*{w};");
                let _ = writeln!(text, "  u = {xx}*m + {xy}*v;\n  v = {yx}*m + {yy}*v;\n  m = 0;");
                for [nx, ny] in test.normals.iter().map(|normal| normal.map(number)) {
                    let _ = writeln!(text, "  m = max(m, {nx}*u + {ny}*v);");
                }
                let [bulge, slant, limit] = [test.bulge, test.slant, test.limit].map(number);
                format!("{bulge}*(u*u + v*v) + {slant}*{radius}*m*{w} <= {limit}*{radius}*{radius}*{w}*{w}")
            }
            OutlineTest::Polygon(edges) => {
                text.push_str("  m = 0;\n");
                for Edge { lower, upper, along } in edges {
                    let ([x0, y0], y1, [dx, dy]) = (lower.map(number), number(*upper), along.map(number));
                    let _ = writeln!(
                        text,
                        "  if ({y0}*{radius}*{w} <= {y} && {y} < {y1}*{radius}*{w}\n      \
                         && ({x} - {x0}*{radius}*{w})*{dy} < ({y} - {y0}*{radius}*{w})*{dx})\n    m = 1 - m;"
                    );
                }
                "m > 0.5".to_owned()
            }
            OutlineTest::Picture(PictureTest { axes, offset, .. }) => {
                let [[xx, xy], [yx, yy]] = axes.map(|row| row.map(number));
                let [column, row] = offset.map(number);
                let polarised = if traced.light.is_some() { "  stokes = stokes*m;\n" } else { "" };
                let _ = write!(
                    text,
                    "  u = ({xx}*{x} + {xy}*{y})/({radius}*{w}) + {column};\n  \
                       v = ({yx}*{x} + {yy}*{y})/({radius}*{w}) + {row};\n  \
                       m = picture(u, v);\n  left *= m;\n{polarised}"
                );
                "m > 0".to_owned()
            }
        };
        let blocked = if test.is_obstruction { inside } else { format!("!({inside})") };
        let _ = writeln!(text, "  if ({blocked})\n    return 0;");
    }
}

/// Returns the function `picture` of the transmission of a picture, which is [`StopPicture::at`].
fn picture_function(picture: &StopPicture) -> String {
    let stride = picture.stride();
    let [[first, _], [right, bottom]] = picture.borders().map(|place| place.map(number));
    // Each cell has the value of its own point and that one row below; the last cell has no point of its own.
    let points = &picture.cells()[..picture.cells().len() - 1];
    format!(
        "/* The transmission of the stop's picture at a place that is counted in points of its grid, of which the border\n   \
            repeats the outermost pixels. 0 outside. */\n\
         float picture(float column, float row)\n{{\n{}  \
           if (!(column >= {first} && column <= {right} && row >= {first} && row <= {bottom}))\n    return 0;\n  \
           int i = int(column);\n  int j = int(row);\n  \
           float u = column - i;\n  float v = row - j;\n  \
           i += j*{stride};\n  \
           float above = (1 - u)*P[i] + u*P[i + 1];\n  \
           float below = (1 - u)*P[i + {stride}] + u*P[i + {}];\n  \
           return (1 - v)*above + v*below;\n}}\n\n",
        array("P", points.iter().map(|cell| f64::from(cell[0]))),
        stride + 1,
    )
}

fn plane(text: &mut String, limit: &str, step: &str, light: &str) {
    let _ = write!(
        text,
        "  t = -z/vz;\n  x += t*vx;\n  y += t*vy;\n  z = 0;\n  r2 = x*x + y*y;\n  q = vz*vz + {step};\n  \
         if (r2 > {limit} || q <= 0 || vz <= 0)\n    return 0;\n  f = sqrt(q);\n{light}  vz = f;\n"
    );
}

fn sphere(
    text: &mut String,
    traced: &TracedLens<'_>,
    surface: &Surface,
    distance: f64,
    limit: &str,
    [square, step]: [&str; 2],
    light: &str,
) {
    // The curvature is positive if its centre lies ahead of the ray.
    let c = -surface.curvature;
    let curvature = number(c);
    if distance * c.abs() > FAR {
        text.push_str("  t = -z/vz;\n  x += t*vx;\n  y += t*vy;\n  z = 0;\n  r2 = x*x + y*y;\n");
    }
    let twice = match &traced.indices {
        None => number(2.0 * c * surface.n_film.powi(2)),
        Some(_) => format!("{}*{square}", number(2.0 * c)),
    };
    let _ = write!(
        text,
        "  f = {}*(r2 + z*z) - z;\n  g = vz - {curvature}*(x*vx + y*vy + z*vz);\n  q = g*g - {twice}*f;\n  \
         if (q <= 0)\n    return 0;\n  e = sqrt(q);\n",
        number(c / 2.0),
    );
    if surface.radius.abs() < STRONG * traced.focal_length {
        match &traced.indices {
            None => {
                let _ = writeln!(text, "  t = (g - e)*{};", number(1.0 / (c * surface.n_film.powi(2))));
            }
            Some(_) => {
                let _ = writeln!(text, "  t = (g - e)/({curvature}*{square});");
            }
        }
    } else {
        text.push_str("  t = 2*f/(g + e);\n");
    }
    let half =
        if surface.semi_diameter * c.abs() > WIDE { format!(" || {curvature}*z > 1") } else { String::new() };
    let _ = write!(
        text,
        "  x += t*vx;\n  y += t*vy;\n  z += t*vz;\n  r2 = x*x + y*y;\n  q += {step};\n  \
         if (r2 > {limit} || q <= 0{half})\n    return 0;\n  f = sqrt(q);\n{light}  g = f - e;\n  k = {curvature}*g;\n  \
         vx -= k*x;\n  vy -= k*y;\n  vz += g - k*z;\n",
    );
}
