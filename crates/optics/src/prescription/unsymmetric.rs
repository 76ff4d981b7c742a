//! Surfaces that are not symmetric about their axis: toroids, cylinders among them, and biconics.

use realistic_base::numeric::Arithmetic;

/// One of the two meridians of a surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Meridian {
    /// The plane of x and z.
    X,
    /// The plane of y and z.
    Y,
}

/// Number of terms of a toroid's profile: y², y⁴, … y¹⁴.
pub const PROFILE_TERMS: usize = 7;

/// A toroid: the profile z = f(y) = c y²/(1 + √(1 - (1 + k) c² y²)) + Σ `A_i` y^(2 i), turned about an axis parallel to
/// y through z = R. z is counted from the vertex toward the film (OpticStudio, "Toroidal"). Where R is infinite, the
/// surface is flat in x: a cylinder. In the meridian x, x and y change places.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Toroid {
    /// The meridian of the profile.
    pub meridian: Meridian,
    /// The vertex radius of the profile, mm, signed; infinite for a straight profile, never 0.
    pub radius: f64,
    /// The conic constant k of the profile.
    pub conic: f64,
    /// The terms of the profile, `A_1`, of y², to `A_7`, of y¹⁴, in mm^(1 - 2 i).
    pub terms: [f64; PROFILE_TERMS],
    /// The radius of rotation R, mm, signed; infinite for a cylinder, never 0.
    pub rotation_radius: f64,
}

impl Toroid {
    /// Returns a cylinder that is curved in a meridian, mm; a plane if the radius is infinite.
    pub fn cylinder(meridian: Meridian, radius: f64) -> Self {
        let terms = [0.0; PROFILE_TERMS];
        Self { meridian, radius, conic: 0.0, terms, rotation_radius: f64::INFINITY }
    }
}

/// A biconic: z = (c_x x² + c_y y²)/(1 + √(1 - (1 + k_x) c_x² x² - (1 + k_y) c_y² y²)), where z is counted from the
/// vertex toward the film (OpticStudio, "Biconic").
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Biconic {
    /// The vertex radii in the meridians x and y, mm, signed; infinite for a straight one, never 0.
    pub radii: [f64; 2],
    /// The conic constants in the meridians x and y.
    pub conics: [f64; 2],
}

/// A cylinder whose section is a conic.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cylinder {
    /// The meridian in which the cylinder is curved.
    pub meridian: Meridian,
    /// The vertex radius of the section, mm, signed, never 0.
    pub radius: f64,
    /// The conic constant of the section.
    pub conic: f64,
}

/// A surface that is not symmetric about its axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Unsymmetric {
    /// A toroid or a cylinder.
    Toroid(Toroid),
    /// A biconic.
    Biconic(Biconic),
}

impl Unsymmetric {
    /// Returns the vertex radii in the meridians x and y, mm.
    pub fn radii(&self) -> [f64; 2] {
        match *self {
            Self::Biconic(Biconic { radii, .. }) => radii,
            Self::Toroid(Toroid { meridian, radius, terms, rotation_radius, .. }) => {
                let profile = (radius.recip() + 2.0 * terms[0]).recip();
                match meridian {
                    Meridian::X => [profile, rotation_radius],
                    Meridian::Y => [rotation_radius, profile],
                }
            }
        }
    }

    /// Returns the cylinder that the surface is, if it is one without terms.
    pub fn cylinder(&self) -> Option<Cylinder> {
        match *self {
            Self::Biconic(Biconic { radii: [x, y], conics }) => match (x.is_infinite(), y.is_infinite()) {
                (true, false) => Some(Cylinder { meridian: Meridian::Y, radius: y, conic: conics[1] }),
                (false, true) => Some(Cylinder { meridian: Meridian::X, radius: x, conic: conics[0] }),
                _ => None,
            },
            Self::Toroid(Toroid { terms, .. }) if terms != [0.0; PROFILE_TERMS] => None,
            Self::Toroid(Toroid { meridian, radius, conic, rotation_radius, .. }) => {
                let other = match meridian {
                    Meridian::X => Meridian::Y,
                    Meridian::Y => Meridian::X,
                };
                match (radius.is_infinite(), rotation_radius.is_infinite()) {
                    (false, true) => Some(Cylinder { meridian, radius, conic }),
                    (true, false) => Some(Cylinder { meridian: other, radius: rotation_radius, conic: 0.0 }),
                    _ => None,
                }
            }
        }
    }

    /// Returns whether the surface is a plane.
    pub fn is_plane(&self) -> bool {
        let has_terms = matches!(self, Self::Toroid(Toroid { terms, .. }) if *terms != [0.0; PROFILE_TERMS]);
        !has_terms && self.radii().iter().all(|radius| radius.is_infinite())
    }

    /// Returns the surface with every length multiplied by `factor`, positive and finite.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        match *self {
            Self::Biconic(own) => Self::Biconic(Biconic { radii: own.radii.map(|r| r * factor), ..own }),
            Self::Toroid(own) => {
                let mut terms = own.terms;
                for (i, term) in (1..).zip(&mut terms) {
                    *term *= factor.powi(1 - 2 * i);
                }
                let (radius, rotation_radius) = (own.radius * factor, own.rotation_radius * factor);
                Self::Toroid(Toroid { radius, terms, rotation_radius, ..own })
            }
        }
    }

    /// Returns the constants of the surface, with z reversed if `sign` is -1.
    pub fn constants(&self, sign: f64) -> UnsymmetricConstants<f64> {
        match self {
            Self::Toroid(Toroid { meridian, radius, conic, terms, rotation_radius }) => {
                let c = sign * radius.recip();
                UnsymmetricConstants::Toroid {
                    is_in_x: *meridian == Meridian::X,
                    one: 1.0,
                    c,
                    bend: (1.0 + conic) * c * c,
                    terms: terms.map(|term| sign * term),
                    rotation: sign * rotation_radius.recip(),
                }
            }
            Self::Biconic(Biconic { radii, conics }) => {
                let c = radii.map(|radius| sign * radius.recip());
                let bend = [0, 1].map(|i| (1.0 + conics[i]) * c[i] * c[i]);
                UnsymmetricConstants::Biconic { one: 1.0, c, bend }
            }
        }
    }
}

/// The constants of a surface, as numbers of any type, in a vertex frame whose z axis may be reversed.
#[derive(Clone, Copy, Debug)]
pub enum UnsymmetricConstants<N> {
    /// A toroid.
    Toroid {
        /// Whether x and y change places.
        is_in_x: bool,
        /// 1.
        one: N,
        /// c = 1/radius of the profile.
        c: N,
        /// (1 + k) c².
        bend: N,
        /// The terms of y², y⁴, ….
        terms: [N; PROFILE_TERMS],
        /// 1/R.
        rotation: N,
    },
    /// A biconic.
    Biconic {
        /// 1.
        one: N,
        /// The vertex curvatures.
        c: [N; 2],
        /// (1 + k) c² in both meridians.
        bend: [N; 2],
    },
}

impl<N: Copy> UnsymmetricConstants<N> {
    /// Returns the constants as numbers of another type.
    pub fn map<M>(&self, number: impl Fn(N) -> M) -> UnsymmetricConstants<M> {
        match *self {
            Self::Toroid { is_in_x, one, c, bend, terms, rotation } => UnsymmetricConstants::Toroid {
                is_in_x,
                one: number(one),
                c: number(c),
                bend: number(bend),
                terms: terms.map(&number),
                rotation: number(rotation),
            },
            Self::Biconic { one, c, bend } => {
                UnsymmetricConstants::Biconic { one: number(one), c: c.map(&number), bend: bend.map(&number) }
            }
        }
    }

    /// Returns z at (x, y). The numbers may be plain, carry derivatives, or be intervals.
    ///
    /// The toroid is z = f + x² ρ/(1 + √(1 - x² ρ²)), where ρ = 1/(R - f): no digits cancel, and R may be infinite.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn sagitta<M: Arithmetic<Constant = N>>(&self, [x, y]: [M; 2]) -> M {
        match *self {
            Self::Toroid { is_in_x, one, c, bend, terms, rotation } => {
                let (x, y) = if is_in_x { (y, x) } else { (x, y) };
                let v = y.squared();
                let mut sum = v.times(terms[PROFILE_TERMS - 1]);
                let mut i = PROFILE_TERMS - 1;
                while i > 0 {
                    i -= 1;
                    sum = sum.plus(terms[i]);
                    sum = if i > 0 { sum * v } else { sum };
                }
                let root = v.times(bend).taken_from(one).sqrt();
                let f = v * (root.plus(one).dividing(c) + sum);
                let across = x * f.times(rotation).taken_from(one).dividing(rotation);
                let root = across.squared().taken_from(one).sqrt();
                f + x * across / root.plus(one)
            }
            Self::Biconic { one, c, bend } => {
                let (u, v) = (x.squared(), y.squared());
                let root = (u.times(bend[0]) + v.times(bend[1])).taken_from(one).sqrt();
                (u.times(c[0]) + v.times(c[1])) / root.plus(one)
            }
        }
    }
}
