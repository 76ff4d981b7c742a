//! OSL text of a lens's transmission: Fresnel's equations and thin films by the transfer matrix, the change of
//! polarisation from surface to surface, and the absorption of the glass between them.
//!
//! The method is that of the library (`docs/light.md`), without a fit. The trace has n cos θ on both sides of a
//! surface, which is all that the matrix needs from a ray. Each stack becomes one function of the shader, and so does
//! a surface's effect on the Stokes vector; each surface in the trace calls the function of its stack. The absorption
//! coefficient of a glass is the library's, with the knots of its cubics.

use super::text::{array, number};
use realistic_light::Absorbers;
use realistic_optics::lens::Surface;
use realistic_optics::prescription::{Layer, SurfaceCoating, glass::InternalTransmittance};
use std::f64::consts::TAU;

/// The surfaces of a lens with their coatings and glasses.
#[derive(Debug)]
pub struct Light<'a> {
    coatings: &'a [SurfaceCoating],
    /// The distinct stacks, each listed from the air on; empty for a bare surface.
    stacks: Vec<Vec<Layer>>,
    absorbers: &'a Absorbers,
    /// Wavelength, nm; `None` if each sample has its own.
    wavelength: Option<f64>,
}

/// A ray at a surface, in variables of the shader.
#[derive(Debug)]
pub struct Meeting<'a> {
    /// n cos θ before and behind the surface.
    pub cosines: [&'a str; 2],
    /// n² before and behind the surface.
    pub squares: [&'a str; 2],
    /// The unit normal.
    pub normal: [&'a str; 3],
}

/// The functions that all stacks call.
const FUNCTIONS: &str = "\
/* Puts a film of tilted admittance n before a stack with the fields B and C; its phase has this cosine and sine. */
void film(float n, float cosine, float sine, output float br, output float bi, output float cr, output float ci)
{
  float r = cosine*br - sine*ci/n;
  float i = cosine*bi + sine*cr/n;
  cr = cosine*cr - sine*n*bi;
  ci = cosine*ci + sine*n*br;
  br = r;
  bi = i;
}

/* What light has left behind a surface, of which s and p transmit these shares, and turn is a_s a_p* of their amplitudes.
   stokes: Q, U and V, in the plane of incidence that across is normal to. */
void meet(float s, float p, float turn_r, float turn_i, vector v, vector up, output float left, output vector stokes,
          output vector across)
{
  vector next = cross(up, v);
  if (dot(next, next) > 1e-12*dot(v, v)) {
    float c = dot(across, next);
    float d = dot(cross(across, next), v)/sqrt(dot(v, v));
    float e = c*c + d*d;
    if (e > 0) {
      float double_c = (c*c - d*d)/e;
      float double_s = 2*c*d/e;
      stokes = vector(double_c*stokes[0] + double_s*stokes[1], double_c*stokes[1] - double_s*stokes[0], stokes[2]);
    }
    across = next;
  }
  float m = 0.5*(s + p);
  float d = 0.5*(s - p);
  float power = left;
  left = m*power + d*stokes[0];
  stokes = vector(d*power + m*stokes[0], turn_r*stokes[1] - turn_i*stokes[2], turn_i*stokes[1] + turn_r*stokes[2]);
}

";

impl<'a> Light<'a> {
    /// Prepares a lens whose surfaces, from the scene on, have these coatings, and whose glasses absorb.
    pub fn new(
        surfaces: &[Surface],
        coatings: &'a [SurfaceCoating],
        absorbers: &'a Absorbers,
        wavelength: Option<f64>,
    ) -> Self {
        let mut stacks: Vec<Vec<Layer>> = Vec::new();
        for (surface, coating) in surfaces.iter().zip(coatings) {
            let stack = stack(surface, coating);
            if surface.n_film != surface.n_scene && !stacks.contains(&stack) {
                stacks.push(stack);
            }
        }
        Self { coatings, stacks, absorbers, wavelength }
    }

    /// Returns the functions of the stacks, and of the absorbing glasses if each sample has its own wavelength.
    pub fn functions(&self) -> String {
        let stacks = self.stacks.iter().enumerate().map(|(i, stack)| self.function(i, stack));
        let curves = self.absorbers.curves().iter().enumerate().filter(|_| self.wavelength.is_none());
        FUNCTIONS.to_owned()
            + &stacks.collect::<String>()
            + &curves.map(|(glass, own)| curve(glass, own)).collect::<String>()
    }

    /// Returns the absorption coefficient, 1/mm, of the medium behind the surface with this index; `None` if the
    /// medium does not absorb.
    pub fn absorption(&self, row: usize) -> Option<String> {
        let glass = self.absorbers.behind(row)?;
        let Some(nm) = self.wavelength else { return Some(format!("absorbs{glass}(nm)")) };
        let own = self.absorbers.curves()[glass].coefficient(nm);
        (own > 0.0).then(|| number(own))
    }

    /// Returns the function of a stack between media with n cos θ = a and n cos θ = b; a belongs to the medium next
    /// to the first layer.
    fn function(&self, i: usize, stack: &[Layer]) -> String {
        let layers: String = stack
            .iter()
            .rev()
            .map(|layer| {
                let square = number(layer.index * layer.index);
                let phase = TAU * layer.thickness;
                let phase =
                    self.wavelength.map_or_else(|| format!("{}/nm", number(phase)), |nm| number(phase / nm));
                format!(
                    "  m = sqrt({square} - sine);\n  \
                       sincos({phase}*m, turn, whole);\n  \
                       film(m, whole, turn, sbr, sbi, scr, sci);\n  \
                       film({square}/m, whole, turn, pbr, pbi, pcr, pci);\n"
                )
            })
            .collect();
        let what = match stack.len() {
            0 => "a bare surface".to_owned(),
            1 => "a film".to_owned(),
            count => format!("a stack of {count} films"),
        };
        format!(
            "/* What {what} between the indices of squares aa and bb leaves of light; a and b are n cos of the angles there. */\n\
             void stack{i}(float nm, float given_a, float given_b, float aa, float bb, vector v, vector up,\n            \
                         output float left, output vector stokes, output vector across)\n{{\n  \
               /* Grazing light has no admittance of p. */\n  \
               float a = max(given_a, 1e-6);\n  \
               float b = max(given_b, 1e-6);\n  \
               float sine = aa - a*a;\n  \
               float m = 0, turn = 0, whole = 0;\n  \
               float sbr = 1, sbi = 0, scr = b, sci = 0;\n  \
               float pbr = 1, pbi = 0, pcr = bb/b, pci = 0;\n{layers}  \
               float dsr = a*sbr + scr, dsi = a*sbi + sci;\n  \
               float dpr = aa/a*pbr + pcr, dpi = aa/a*pbi + pci;\n  \
               float ds = dsr*dsr + dsi*dsi, dp = dpr*dpr + dpi*dpi;\n  \
               m = 4*sqrt(aa*bb)/(ds*dp);\n  \
               meet(4*a*b/ds, 4*(aa/a)*(bb/b)/dp, m*(dsr*dpr + dsi*dpi), m*(dsr*dpi - dsi*dpr), v, up, left, stokes,\n       \
                    across);\n}}\n\n"
        )
    }

    /// Returns the line for a ray in (vx, vy, vz) at the surface with this index; empty if the medium does not change.
    pub fn line(&self, number: usize, surface: &Surface, meeting: &Meeting<'_>) -> String {
        let own = stack(surface, &self.coatings[number]);
        let Some(i) = self.stacks.iter().position(|stack| *stack == own) else { return String::new() };
        if surface.n_film == surface.n_scene {
            return String::new();
        }
        let Meeting { cosines: [a, b], squares: [aa, bb], normal: [x, y, z] } = meeting;
        // The rays come from the film's side. The layers are listed from the air, which is the medium of lower index.
        let sides = if surface.n_film < surface.n_scene {
            format!("{a}, {b}, {aa}, {bb}")
        } else {
            format!("{b}, {a}, {bb}, {aa}")
        };
        format!("  stack{i}(nm, {sides}, vector(vx, vy, vz), vector({x}, {y}, {z}), left, stokes, across);\n")
    }
}

/// Returns the function of a glass's absorption coefficient.
fn curve(glass: usize, absorption: &InternalTransmittance) -> String {
    let knots = absorption.knots();
    let column = |name, k: usize| array(name, knots.iter().map(|knot| knot[k]));
    let count = knots.len();
    let [first, last] = [0, count - 1].map(|i| number(knots[i][0]));
    let cubic = if count > 1 {
        format!(
            "  int i = 0;\n  \
               while (i < {} && at > W[i + 1])\n    i++;\n  \
               float s = W[i + 1] - W[i];\n  \
               float t = (at - W[i])/s;\n  \
               float u = 1 - t;\n  \
               return u*u*((1 + 2*t)*A[i] + t*s*D[i]) + t*t*((1 + 2*u)*A[i + 1] - u*s*D[i + 1]);\n",
            count - 2
        )
    } else {
        "  return A[0];\n".to_owned()
    };
    format!(
        "/* The absorption coefficient, 1/mm, of a glass: cubics between these wavelengths, nm, at which it\n   \
            and its slope are given. */\n\
         float absorbs{glass}(float nm)\n{{\n{}{}{}  float at = clamp(nm, {first}, {last});\n{cubic}}}\n\n",
        column("W", 0),
        column("A", 1),
        column("D", 2),
    )
}

/// Returns the layers of a surface, from the air on.
fn stack(surface: &Surface, coating: &SurfaceCoating) -> Vec<Layer> {
    let is_coated = !coating.layers([surface.n_scene, surface.n_film]).is_empty();
    if is_coated { coating.from_air() } else { Vec::new() }
}
