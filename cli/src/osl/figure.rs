//! OSL text of an aspheric surface: Newton's method on the implicit figure, then Snell's law at the surface's normal.
//!
//! In the frame of the vertex, with w = z - T(r²) and q = 1 - κ c w, the figure is (c/2) r² - w (1 + q)/2 = 0, and its
//! normal is (-m x, -m y, q) with m = c + 2 q dT/dr², so no square root is needed before the intersection is found.
//! Beyond the clear aperture T continues along its tangent, so that rays beside the surface stay in range.

use super::text::number;
use realistic_optics::lens::Surface;
use realistic_optics::prescription::FIRST_POWER;
use std::fmt::Write as _;

/// Largest number of Newton steps.
const STEPS: u32 = 12;
/// Step, in clear semi-diameters, below which the iteration ends: four times the rounding error of a coordinate.
const SMALL: f64 = 2.5e-7;
/// Step, in clear semi-diameters, above which the iteration has found no surface.
const FAILED: f64 = 1e-3;

/// n cos θ before and behind a surface, and its unit normal, in the variables of [`surface`].
pub const MEETING: ([&str; 2], [&str; 3]) = (["g", "f"], ["-k*x", "-k*y", "q"]);

/// Writes the code that moves the ray to the surface, tests it against `limit` and refracts it with `step` = n'² -
/// n². The code in `light` precedes the refraction.
pub fn surface(text: &mut String, surface: &Surface, limit: &str, step: &str, light: &str) {
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
    let _ = write!(
        text,
        "  r2 = x*x + y*y;\n  if (r2 > {limit} || abs(e) > {} || q <= 0 || g <= 0)\n    return 0;\n  \
         f = 1/sqrt(k*k*r2 + q*q);\n  g *= f;\n  q *= f;\n  k *= f;\n  e = g*g + {step};\n  if (e <= 0)\n    return 0;\n  \
         f = sqrt(e);\n{light}  g = f - g;\n  vx -= g*k*x;\n  vy -= g*k*y;\n  vz += g*q;\n",
        number(FAILED * surface.semi_diameter),
    );
}
