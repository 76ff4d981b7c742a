//! OSL text of surfaces that are not spheres: their intersection, then Snell's law at the normal (-h, -j, q).
//!
//! **Aspheres of revolution** are reached by Newton's method on the implicit figure. In the frame of the vertex, with
//! w = z - T(r²) and q = 1 - κ c w, the figure is (c/2) r² - w (1 + q)/2 = 0, and its normal is (-m x, -m y, q) with
//! m = c + 2 q dT/dr², so no square root is needed before the intersection is found. Beyond the clear aperture T continues
//! along its tangent, so that rays beside the surface stay in range.
//!
//! **Cylinders, toroids and biconics** are reached as in the library (`realistic_optics::trace`): a cylinder without
//! terms in closed form, the others by steps that cannot skip a crossing, with the library's proven bounds.

use super::text::number;
use realistic_optics::lens::Surface;
use realistic_optics::prescription::{FIRST_POWER, UnsymmetricConstants};
use realistic_optics::trace::UnsymmetricSheet;
use std::fmt::Write as _;

/// Largest number of Newton steps, and of steps to a surface that is not symmetric.
const STEPS: u32 = 12;
const SAFE_STEPS: u32 = 64;
/// Step, in clear semi-diameters, below which the iteration ends: four times the rounding error of a coordinate.
const SMALL: f64 = 2.5e-7;
/// Step, in clear semi-diameters, above which the iteration has found no surface.
const FAILED: f64 = 1e-3;
/// Rounding error of a distance to a surface that is not symmetric, in units of its size.
const ROUNDING: f64 = 4.0 * f32::EPSILON as f64;

/// n cos θ before and behind a surface, and its unit normal, in the variables of [`surface`].
pub const MEETING: ([&str; 2], [&str; 3]) = (["g", "f"], ["-h", "-j", "q"]);

/// Writes the code that moves the ray to the surface, tests it against `limit` and refracts it with `step` = n'² -
/// n². The code in `light` precedes the refraction.
pub fn surface(text: &mut String, surface: &Surface, limit: &str, step: &str, light: &str) {
    match &surface.unsymmetric {
        Some(figure) => {
            let sheet = UnsymmetricSheet::new(figure, false);
            if sheet.cylinder.is_some() { cylinder(text, &sheet) } else { sheet_steps(text, &sheet) }
        }
        None => asphere(text, surface),
    }
    let _ = write!(
        text,
        "  r2 = x*x + y*y;\n  if (r2 > {limit} || q <= 0 || g <= 0)\n    return 0;\n  \
         f = 1/sqrt(h*h + j*j + q*q);\n  g *= f;\n  q *= f;\n  h *= f;\n  j *= f;\n  e = g*g + {step};\n  \
         if (e <= 0)\n    return 0;\n  f = sqrt(e);\n{light}  g = f - g;\n  vx -= g*h;\n  vy -= g*j;\n  vz += g*q;\n",
    );
}

/// Writes the code that moves the ray to an asphere of revolution.
fn asphere(text: &mut String, surface: &Surface) {
    let figure = surface.figure.as_ref().expect("an asphere");
    // The figure measures z toward the film, and the ray measures it toward the scene.
    let asphere = &figure.asphere;
    let c = number(-asphere.radius.recip());
    let bent = number(-(1.0 + asphere.conic) * asphere.radius.recip());
    let rim_squared = figure.rim * figure.rim;
    let terms: Vec<(usize, f64)> = (FIRST_POWER..)
        .zip(asphere.terms)
        .filter(|(_, term)| *term != 0.0)
        .map(|(i, term)| (i, -term))
        .collect();
    let even = |text: &mut String| {
        // Horner's rule in p = r²/rim² gives T and its derivative by r².
        let of = |power: usize| terms.iter().find(|(i, _)| *i == power).map_or(0.0, |(_, term)| *term);
        let highest = terms.iter().map(|(i, _)| *i).filter(|i| i % 2 == 0).max().unwrap_or(0);
        let scaled = |power: usize| of(power) * figure.rim.powi(power as i32);
        let coefficients: Vec<f64> = (1..=highest / 2).map(|j| scaled(2 * j)).collect();
        let odd: Vec<(usize, f64)> = terms.iter().filter(|(i, _)| i % 2 == 1).copied().collect();
        let horner = |list: &[f64]| {
            list.iter().rev().fold(String::new(), |sum, term| match &*sum {
                "" => number(*term),
                _ => format!("({sum}*p + {})", number(*term)),
            })
        };
        let slopes: Vec<f64> =
            (1..).zip(&coefficients).map(|(j, term)| f64::from(j) * term / rim_squared).collect();
        let (mut value, mut slope) = ("0".to_owned(), "0".to_owned());
        if !coefficients.is_empty() {
            (value, slope) = (format!("p*{}", horner(&coefficients)), horner(&slopes));
        }
        let _ = writeln!(text, "    float p = min(r2*{}, 1.0);", number(1.0 / rim_squared));
        if !odd.is_empty() {
            text.push_str("    float o = sqrt(p);\n");
            for (power, term) in odd {
                let scale = term * figure.rim.powi(power as i32);
                let _ = write!(value, " + {}*o", number(scale));
                let _ = write!(slope, " + {}*", number(scale * power as f64 / 2.0 / rim_squared));
                value += &"*p".repeat(power / 2);
                // On the axis, x and y make the slope of a cone count nothing.
                slope += &if power == 1 {
                    "1/max(o, 1e-9)".to_owned()
                } else {
                    "o".to_owned() + &"*p".repeat(power / 2 - 1)
                };
            }
        }
        // Beyond the clear aperture, the code adds a difference that is exactly 0 within it.
        let _ = writeln!(
            text,
            "    k = {slope};\n    f = z - ({value} + k*max(r2 - {}, 0.0));",
            number(rim_squared)
        );
    };
    let _ = write!(
        text,
        "  t = -z/vz;\n  x += t*vx;\n  y += t*vy;\n  z = 0;\n  e = 1e30;\n  \
         for (int i = 0; i < {STEPS} && abs(e) > {}; i++) {{\n    r2 = x*x + y*y;\n",
        number(SMALL * surface.semi_diameter)
    );
    even(text);
    let _ = write!(
        text,
        "    q = 1 - {bent}*f;\n    k = {c} + 2*q*k;\n    g = q*vz - k*(x*vx + y*vy);\n    \
         e = ({}*r2 - 0.5*f*(1 + q))/g;\n    x += e*vx;\n    y += e*vy;\n    z += e*vz;\n  }}\n",
        number(-asphere.radius.recip() / 2.0),
    );
    let _ = writeln!(
        text,
        "  if (abs(e) > {})\n    return 0;\n  h = k*x;\n  j = k*y;",
        number(FAILED * surface.semi_diameter)
    );
}

/// Returns the rounding error of a distance to the surface along the axis, mm.
fn rounding(sheet: &UnsymmetricSheet<f64>) -> f64 {
    let [low, high] = sheet.inside.extent;
    ROUNDING * (sheet.rim.sqrt() + high - low)
}

/// Writes the code that moves the ray to a cylinder whose section is a conic.
fn cylinder(text: &mut String, sheet: &UnsymmetricSheet<f64>) {
    let Some(cylinder) = &sheet.cylinder else { return };
    let [u, h, j] = if cylinder.is_in_x { ["x", "c*x", "0"] } else { ["y", "0", "c*y"] };
    let c = number(cylinder.curvature);
    // The crossing lies neither in front of the clear aperture nor behind the last point of the ray.
    let _ = write!(
        text,
        "  k = max({}, z) - {};\n  t = -z/vz;\n  x += t*vx;\n  y += t*vy;\n  \
         e = {c}*(v{u}*v{u} + {}*vz*vz);\n  g = vz - {c}*{u}*v{u};\n  q = g*g - {c}*{u}*{u}*e;\n  \
         if (q <= 0)\n    return 0;\n  q = sqrt(q);\n  t = g > 0 ? {c}*{u}*{u}/(g + q) : (g - q)/e;\n  \
         x += t*vx;\n  y += t*vy;\n  z = t*vz;\n  \
         if (z < k || -e*(z - k) >= 2*q*vz)\n    return 0;\n  \
         g = q;\n  q = 1 - {}*z;\n  h = {};\n  j = {};\n",
        number(sheet.inside.extent[0]),
        number(rounding(sheet)),
        number(cylinder.kappa),
        number(cylinder.kappa * cylinder.curvature),
        h.replace('c', &c),
        j.replace('c', &c),
    );
}

/// Writes the code that moves the ray to a toroid or a biconic, in steps that end at the first crossing: `f` is the
/// distance to the surface along the axis, and (`h`, `j`) the surface's slopes.
fn sheet_steps(text: &mut String, sheet: &UnsymmetricSheet<f64>) {
    let measure = match sheet.constants {
        UnsymmetricConstants::Toroid { is_in_x, c, bend, terms, rotation, .. } => {
            // Horner's rule in the square of the coordinate along the profile gives the terms and their derivative.
            let horner = |factor: &dyn Fn(usize) -> f64| {
                let highest = terms.iter().rposition(|term| *term != 0.0)?;
                let last = number(factor(highest) * terms[highest]);
                let add = |sum: String, i| format!("({sum}*square + {})", number(factor(i) * terms[i]));
                Some((0..highest).rev().fold(last, add))
            };
            let value = horner(&|_| 1.0).map_or_else(String::new, |sum| format!(" + {sum}"));
            let slope = horner(&|i| 2.0 * (i + 1) as f64).map_or_else(String::new, |sum| format!(" + {sum}"));
            let [a, b, along_a, along_b] = if is_in_x { ["y", "x", "j", "h"] } else { ["x", "y", "h", "j"] };
            let (c, bend, rotation) = (number(c), number(bend), number(rotation));
            format!(
                "    float square = {b}*{b};\n    float root = sqrt(1 - {bend}*square);\n    \
                 float sag = square*({c}/(1 + root){value});\n    \
                 float turn = {a}*{rotation}/(1 - {rotation}*sag);\n    \
                 {along_b} = {b}*({c}/root{slope});\n    \
                 root = sqrt(1 - turn*turn);\n    \
                 {along_a} = turn/root;\n    {along_b} /= root;\n    f = sag + {a}*turn/(1 + root) - z;\n"
            )
        }
        UnsymmetricConstants::Biconic { c, bend, .. } => {
            let ([cx, cy], [bx, by]) = (c.map(number), bend.map(number));
            let slope = |u: &str, c: f64, bend: &str| {
                format!("{u}*({} + {bend}*sag/root)/(1 + root)", number(2.0 * c))
            };
            format!(
                "    float root = sqrt(1 - {bx}*x*x - {by}*y*y);\n    \
                 float sag = ({cx}*x*x + {cy}*y*y)/(1 + root);\n    h = {};\n    j = {};\n    f = sag - z;\n",
                slope("x", c[0], &bx),
                slope("y", c[1], &by),
            )
        }
    };
    let [lowest, highest] = sheet.beyond.extent.map(number);
    let [inside, beyond] = [&sheet.inside, &sheet.beyond].map(|bounds| number(2.0 * bounds.bend));
    let (rim, reach) = (number(sheet.rim), number(sheet.reach));
    let _ = write!(
        text,
        "  t = max({lowest} - z, 0.0)/vz;\n  x += t*vx;\n  y += t*vy;\n  z += t*vz;\n  \
         k = vx*vx + vy*vy;\n  r2 = x*x + y*y;\n  \
         if (r2 > {reach}) {{\n    \
           g = x*vx + y*vy;\n    q = g*g - k*(r2 - {reach});\n    \
           if (q <= 0 || g >= 0)\n      return 0;\n    \
           t = -(g + sqrt(q))/k;\n    x += t*vx;\n    y += t*vy;\n    z += t*vz;\n  }}\n  \
         e = 1;\n  \
         for (int i = 0; i < {SAFE_STEPS} && e > 0; i++) {{\n{measure}    \
           g = vz - h*vx - j*vy;\n    \
           if (abs(f) <= {}) {{\n      e = 0;\n      t = f/g;\n    }} else {{\n      \
             t = 2*f/(g + sqrt(g*g + {inside}*k*f));\n      \
             q = x + t*vx;\n      e = y + t*vy;\n      \
             if (t <= 0 || max(x*x + y*y, q*q + e*e) > {rim})\n        \
               t = 2*f/(g + sqrt(g*g + {beyond}*k*f));\n      \
             if (f < 0 || t <= 0 || z > {highest} || x*x + y*y > {})\n        return 0;\n      \
             e = 1;\n    }}\n    \
           x += t*vx;\n    y += t*vy;\n    z += t*vz;\n  }}\n  \
         if (e > 0)\n    return 0;\n  q = 1;\n",
        number(rounding(sheet)),
        number(sheet.reach * (1.0 + ROUNDING)),
    );
}
