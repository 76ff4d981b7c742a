//! A lens compiled into steps. The form of the step for each surface is chosen when the lens is built.
//!
//! A path is compiled into a [`Table`] with the constants of the [`Step`]s. The step from one strongly curved sphere to
//! the next is a [`Link`], the cheapest form. The step is a [`Sphere`] if the sphere is met from afar or from a plane,
//! or if a link would amplify rounding. Thresholds are ratios of a step's own lengths, so that a scaled lens gets the
//! same steps.

use super::{
    asphere::{Conic, LaneAsphere},
    rounding::{AxialStep, RoundingGrowth},
    surface::{CompiledSurface, Tests, Transfer, surfaces},
    unsymmetric::{Frame, GeneralStep, LaneCylinder, LaneSheet},
};
use realistic_optics::trace::{ApertureTest, Aspheric, Direction, FrameChange, Path, UnsymmetricSheet};
use realistic_simd::Scalar;

/// The test of a sphere's clear aperture.
#[derive(Clone, Copy, Debug)]
pub enum ClearTest<S> {
    /// x² + y² <= a².
    Height(S),
    /// N_z >= sqrt(1 - c² a²), which also rejects the far hemisphere.
    NormalZ(S),
}

/// A sphere met from any point, by the curvature form of the quadratic equation.
#[derive(Clone, Copy, Debug)]
pub struct Sphere<S> {
    pub transfer: Transfer<S>,
    /// -c, c/2, -2 c n², 1/(c n²).
    pub minus_c: S,
    pub half_c: S,
    pub minus_2cn2: S,
    pub per_cn2: S,
    /// n'² - n².
    pub index_step: S,
    /// Whether the sphere is strongly curved: then t = (g - e)/(c n²) without a division, else t = 2 f/(g + e).
    pub strong: bool,
    /// Whether the ray is moved to the vertex plane first.
    pub far: bool,
    /// Whether the ray carries N_z on, for a link; otherwise it carries z.
    pub carries_normal: bool,
    pub aperture_test: ClearTest<S>,
    pub tests: Tests,
    /// Distance by which a hit may lie behind the ray through rounding alone, in units of V.
    pub slack: S,
    /// Whether `slack` is measured from the ray's origin; a leading plane then passes on the distance from there.
    pub is_led: bool,
    /// Whether this is the common case: the sphere is strongly curved and near, the aperture is tested by N_z, the ray
    /// carries N_z on, and no test is needed that the hit lies ahead.
    pub plain: bool,
}

/// A plane with an index step, or a plane that only limits rays and is either the first surface or behind all
/// refracting surfaces.
#[derive(Clone, Copy, Debug)]
pub struct Plane<S> {
    pub transfer: Transfer<S>,
    pub index_step: S,
    /// a².
    pub aperture: S,
    pub tests: Tests,
    pub slack: S,
    /// Whether the plane is first and only limits rays: it passes on the distance that the ray has travelled
    /// ([`RayLanes::root`](super::ray_lanes::RayLanes)).
    pub leads: bool,
    /// Whether `slack` is measured from the ray's origin; a leading plane then passes on the distance from there.
    pub is_led: bool,
}

/// A sphere or plane that reflects rays. The previous step, with an index step of 0, has moved the rays to the mirror
/// without changing their direction.
#[derive(Clone, Copy, Debug)]
pub struct Mirror<S> {
    /// -c, in the frame before the mirror.
    pub minus_c: S,
    /// N_z is `normal.factor` times the height that a ray carries, plus `normal.offset`.
    pub normal: Transfer<S>,
}

/// A stop, which only tests rays.
#[derive(Clone, Copy, Debug)]
pub struct Stop<S> {
    pub transfer: Transfer<S>,
    /// a².
    pub aperture: S,
}

/// A shaped aperture or obstruction, or a picture.
#[derive(Clone, Debug)]
pub struct ShapedAperture<S> {
    /// Transfer to the plane in which rays are tested. Rays that are already on the surface are tested there.
    pub transfer: Transfer<S>,
    pub test: ApertureTest<S>,
}

/// The step from one strongly curved sphere to the next.
///
/// On the first sphere, z = (1 - ν)/c_p and N·V' = e', which makes f and g linear in ν = N_z, Vz and e'.
#[derive(Clone, Copy, Debug)]
pub struct Link<S> {
    /// 1 + c d - ρ.
    pub alpha: S,
    /// ρ = c/c_p.
    pub rho: S,
    /// -2 φ = `minus_2phi0` + `minus_2phi1` ν, φ = c n² f.
    pub minus_2phi0: S,
    pub minus_2phi1: S,
    pub index_step: S,
    pub minus_c: S,
    /// 1/n².
    pub per_n2: S,
    pub per_cn2: S,
    pub aperture_test: ClearTest<S>,
    /// Whether Vz > 0 must be tested.
    pub forward: bool,
    /// Whether n' < n. Total reflection is then possible, and the test for it also covers every ray that misses the
    /// sphere.
    pub rarer: bool,
}

/// The operation of one surface on a ray.
#[derive(Clone, Debug)]
pub enum Step<S> {
    /// Refraction at a sphere met from any point.
    Sphere(Sphere<S>),
    /// Refraction at a strongly curved sphere behind another such sphere.
    Link(Link<S>),
    /// Refraction at a plane, or a limit of the rays.
    Plane(Plane<S>),
    /// A round stop, which only tests rays.
    Stop(Stop<S>),
    /// An aperture or obstruction inside the clear aperture of a surface, which tests rays and, if it is a picture, dims
    /// their light.
    Aperture(Box<ShapedAperture<S>>),
    /// A conic section of revolution.
    Conic(Conic<S>),
    /// A change of frame, or a surface that is not symmetric about its axis.
    General(Box<GeneralStep<S>>),
    /// Reflection at the sphere or plane to which the previous step has moved the rays.
    Mirror(Mirror<S>),
    /// A surface with terms, boxed so that the other steps stay small.
    Asphere(Box<LaneAsphere<S>>),
    /// Scaling of V to the length n, by 3/2 and -1/(2 n²): V (3/2 - V·V/(2 n²)) has the length n.
    Renormalise([S; 2]),
}

impl<S> Step<S> {
    /// Whether rays are reflected at this step, if it is not general.
    pub fn reflects(&self) -> bool {
        match self {
            Self::Mirror(_) => true,
            Self::Conic(conic) => conic.common.is_mirror,
            Self::Asphere(asphere) => asphere.common.is_mirror,
            _ => false,
        }
    }

    /// Whether this is the step of its surface at which rays are refracted.
    pub fn refracts(&self) -> bool {
        match self {
            Self::Stop(_) | Self::Aperture(_) | Self::Mirror(_) | Self::Renormalise(_) => false,
            Self::General(step) => !matches!(**step, GeneralStep::Frame(_)),
            _ => true,
        }
    }
}

/// A lens compiled for one direction. All indices are relative to that of the medium before the first surface.
#[derive(Clone, Debug)]
pub struct Table<S> {
    /// Steps in order. The first step meets rays anywhere, in the frame of the first vertex.
    pub steps: Box<[Step<S>]>,
    /// Number of steps by which rays enter, before vectors are taken side by side: 1, or 0 if the first step is general.
    pub entered: usize,
    /// The index of each step's surface, counted along the path.
    pub surfaces: Box<[usize]>,
    /// Transfer from the last surface to lens space: z in lens space is `exit.factor` times the height that the ray
    /// carries, plus `exit.offset`.
    pub exit: Transfer<S>,
    /// 3/(2 n) and -1/(2 n³) of the last medium: D = V (`unit[0]` + `unit[1]` V·V) is a unit vector.
    pub unit: [S; 2],
    /// n of the last medium.
    pub last_index: S,
    /// z of the first vertex in lens space.
    pub entry: f64,
    /// +1 toward the scene, -1 toward the film.
    pub travel_sign: f64,
}

/// Ratio of the distance to |R| beyond which a ray is first moved to the vertex plane; f loses precision by this
/// factor.
const FAR: f64 = 4.0;
/// Largest tolerated size of [`RoundingGrowth`]. The lenses of the catalogue reach at most 60.
const MOST_GROWTH: f64 = 64.0;
/// Largest rounding error of t, relative to the clear semi-diameter and in units of the rounding, that a link may have.
/// The lenses of the catalogue reach 27.6, traced from the film.
const LINK_ROUNDING: f64 = 28.0;
/// Largest ratio, for a link, of the previous surface's semi-diameter to |R|. Below this ratio, inside the clear
/// aperture of a surface that is not steep, a ray can reach the far hemisphere only by travelling backward.
const NARROW: f64 = 6.0;

impl<S: Scalar> Table<S> {
    /// Compiles a path. Surfaces are linked up to the given amplification of rounding.
    pub fn new(path: &Path<f64>, amplification: f64) -> Self {
        Self::compiled(path, amplification, Unit::Own)
    }

    /// Compiles a path as [`Table::new`] does, with constants per n² of the medium before each surface.
    pub fn per_square(path: &Path<f64>, amplification: f64) -> Self {
        Self::compiled(path, amplification, Unit::Square)
    }

    fn compiled(path: &Path<f64>, amplification: f64, unit: Unit) -> Self {
        let travel_sign = match path.direction() {
            Direction::FilmToScene => 1.0,
            Direction::SceneToFilm => -1.0,
        };
        let surfaces = surfaces(path.steps(), travel_sign, S::EPSILON);
        let mut steps = Vec::with_capacity(surfaces.len());
        let mut numbers = Vec::with_capacity(surfaces.len());
        let forms = forms(&surfaces, amplification);
        // The last surface that moved the ray, and whether it passes N_z on.
        let mut last: Option<(&CompiledSurface<'_>, bool)> = None;
        for (i, surface) in surfaces.iter().enumerate() {
            let mut transfer = transfer(last, surface.distance);
            if let Some(change) = surface.change {
                steps.push(frame(change, transfer));
                transfer = FROM_Z.rounded();
            }
            if surface.is_still {
                steps.push(Step::Stop(Stop { transfer, aperture: S::from_f64(surface.aperture) }));
                steps.extend(shaped(surface.apertures, transfer));
                numbers.resize(steps.len(), i);
                continue;
            }
            let carries_normal = forms[i + 1..].iter().find_map(|form| match form {
                StepForm::Still => None,
                form => Some(matches!(form, StepForm::Link(_))),
            });
            let carries_normal = carries_normal.unwrap_or(false);
            let n = match unit {
                Unit::Own => surface.n,
                Unit::Square => 1.0,
            };
            let (step, carries_normal) = match forms[i] {
                StepForm::Still => continue,
                StepForm::Link(link) => {
                    let before = last.filter(|_| unit == Unit::Square);
                    (Step::Link(before.map_or(link, |(before, _)| link_at(before, surface, n)).to()), true)
                }
                StepForm::Plane => (Step::Plane(plane(surface, transfer)), false),
                StepForm::Aspheric(aspheric) if aspheric.is_conic() => {
                    (Step::Conic(Conic::new(aspheric, surface, n, transfer)), false)
                }
                StepForm::Aspheric(aspheric) => {
                    (Step::Asphere(Box::new(LaneAsphere::new(aspheric, surface, transfer))), false)
                }
                StepForm::Unsymmetric(sheet) => (unsymmetric(sheet, surface, transfer), false),
                StepForm::Sphere { far } => {
                    (Step::Sphere(sphere(surface, n, transfer, far, carries_normal)), carries_normal)
                }
            };
            if last.is_some() && matches!(forms[i], StepForm::Sphere { far: true }) {
                steps.push(Step::Renormalise([S::from_f64(1.5), S::from_f64(-0.5 / (n * n))]));
            }
            steps.push(step);
            if surface.is_mirror && surface.aspheric.is_none() && surface.unsymmetric.is_none() {
                steps.push(Step::Mirror(mirror(surface, carries_normal)));
            }
            last = Some((surface, carries_normal));
            let here = Transfer { factor: S::ZERO, offset: S::ZERO };
            steps.extend(shaped(surface.apertures, here));
            numbers.resize(steps.len(), i);
        }
        let n = match path.steps() {
            [first, .., last] => last.n_after / first.n,
            [only] => only.n_after / only.n,
            [] => 1.0,
        };
        if let Some(change) = path.leaving() {
            steps.push(frame(change, transfer(last, 0.0)));
            numbers.push(surfaces.len() - 1);
            last = None;
        }
        let (factor, offset) = match last {
            Some((surface, true)) => {
                let c = surface.c_behind();
                (-travel_sign / c, path.exit() + travel_sign / c)
            }
            // Rays carry z in front of a mirror, where it has the other sign.
            Some((surface, false)) if surface.is_mirror => (-travel_sign, path.exit()),
            _ => (travel_sign, path.exit()),
        };
        Self {
            entered: usize::from(!matches!(steps.first(), Some(Step::General(_)))),
            steps: steps.into(),
            surfaces: numbers.into(),
            exit: Transfer { factor: S::from_f64(factor), offset: S::from_f64(offset) },
            unit: [S::from_f64(1.5 / n), S::from_f64(-0.5 / n.powi(3))],
            last_index: S::from_f64(n),
            entry: path.entry(),
            travel_sign,
        }
    }
}

/// Medium that the constants of a table assume before each surface.
#[derive(Clone, Copy, PartialEq)]
enum Unit {
    /// The media at the lens's own wavelength.
    Own,
    /// Media with n² = 1 before each surface; the constants are later multiplied by the actual n².
    Square,
}

/// The form of the step to a surface.
#[derive(Clone, Copy)]
enum StepForm<'a> {
    /// No movement; the surface only tests rays.
    Still,
    Plane,
    Aspheric(&'a Aspheric<f64>),
    Unsymmetric(&'a UnsymmetricSheet<f64>),
    Sphere {
        far: bool,
    },
    Link(Link<f64>),
}

/// Chooses the form of each step: a link where possible, and a sphere that is met anew from its vertex plane where
/// rounding would violate the kernel's assumptions too much.
fn forms<'a>(surfaces: &[CompiledSurface<'a>], amplification: f64) -> Vec<StepForm<'a>> {
    let mut last: Option<(&CompiledSurface<'a>, RoundingGrowth)> = None;
    let mut forms = Vec::with_capacity(surfaces.len());
    for surface in surfaces {
        if surface.is_still {
            forms.push(StepForm::Still);
            continue;
        }
        let CompiledSurface { c, n, index_step, distance, .. } = *surface;
        let reach =
            AxialStep { distance: c * distance, index_ratio: (1.0 + index_step / (n * n)).sqrt().recip() };
        let far = reach.distance.abs() > FAR;
        let figure = surface.aspheric.map(StepForm::Aspheric);
        if let Some(figure) = figure.or(surface.unsymmetric.map(StepForm::Unsymmetric)) {
            // The errors are those behind a plane, because the point is on the surface and N·V is computed there.
            let before = last.map_or(RoundingGrowth::NONE, |(_, growth)| growth);
            forms.push(figure);
            let growth = before.through_plane(reach.index_ratio);
            last = Some((surface, if surface.is_mirror { growth.through_mirror() } else { growth }));
            continue;
        }
        let (form, growth) = match last {
            Some((_, growth)) if c == 0.0 => (StepForm::Plane, growth.through_plane(reach.index_ratio)),
            None if c == 0.0 => (StepForm::Plane, RoundingGrowth::NONE),
            None => (StepForm::Sphere { far }, RoundingGrowth::NONE),
            // In a new frame the ray is met anew from the vertex plane.
            Some(_) if surface.change.is_some() => (StepForm::Sphere { far: true }, RoundingGrowth::NONE),
            Some((last, growth)) => {
                let (form, growth) = match link(last, surface, amplification) {
                    Some(link) => {
                        (StepForm::Link(link), growth.through_link(reach, link.rho, link.alpha.abs()))
                    }
                    None => (StepForm::Sphere { far }, growth.through_sphere(reach)),
                };
                if matches!(form, StepForm::Sphere { far: true }) || growth.size() > MOST_GROWTH {
                    (StepForm::Sphere { far: true }, RoundingGrowth::NONE)
                } else {
                    (form, growth)
                }
            }
        };
        forms.push(form);
        last = Some((surface, if surface.is_mirror { growth.through_mirror() } else { growth }));
    }
    forms
}

/// Transfer from a height that is already z in the frame of the next vertex.
const FROM_Z: Transfer<f64> = Transfer { factor: -1.0, offset: 0.0 };

impl Transfer<f64> {
    fn rounded<S: Scalar>(self) -> Transfer<S> {
        Transfer { factor: S::from_f64(self.factor), offset: S::from_f64(self.offset) }
    }
}

fn unsymmetric<S: Scalar>(
    sheet: &UnsymmetricSheet<f64>,
    surface: &CompiledSurface<'_>,
    transfer: Transfer<S>,
) -> Step<S> {
    Step::General(Box::new(match &sheet.cylinder {
        Some(cylinder) => GeneralStep::Cylinder(LaneCylinder::new(sheet, cylinder, surface, transfer)),
        None => GeneralStep::Sheet(LaneSheet::new(sheet, surface, transfer)),
    }))
}

fn frame<S: Scalar>(change: &FrameChange<f64>, transfer: Transfer<S>) -> Step<S> {
    Step::General(Box::new(GeneralStep::Frame(Frame::new(change, transfer))))
}

fn transfer<S: Scalar>(last: Option<(&CompiledSurface<'_>, bool)>, distance: f64) -> Transfer<S> {
    let (factor, offset) = match last {
        Some((last, true)) => (last.c_behind().recip(), distance - last.c_behind().recip()),
        Some((last, false)) if last.is_mirror => (1.0, distance),
        _ => (-1.0, distance),
    };
    Transfer { factor, offset }.rounded()
}

/// Returns the steps of the apertures of a surface; `transfer` leads to the surface.
fn shaped<S: Scalar>(
    apertures: &[ApertureTest<f64>],
    transfer: Transfer<S>,
) -> impl Iterator<Item = Step<S>> {
    apertures
        .iter()
        .map(move |test| Step::Aperture(Box::new(ShapedAperture { transfer, test: test.rounded() })))
}

fn aperture_test<S: Scalar>(surface: &CompiledSurface<'_>) -> ClearTest<S> {
    if surface.is_steep() {
        // Beyond the equator the sphere is not part of the surface.
        ClearTest::NormalZ(S::from_f64((1.0 - (surface.c * surface.semi).powi(2)).max(0.0).sqrt()))
    } else {
        ClearTest::Height(S::from_f64(surface.aperture))
    }
}

fn mirror<S: Scalar>(surface: &CompiledSurface<'_>, carries_normal: bool) -> Mirror<S> {
    let (factor, offset) = if carries_normal { (1.0, 0.0) } else { (-surface.c, 1.0) };
    let normal = Transfer { factor: S::from_f64(factor), offset: S::from_f64(offset) };
    Mirror { minus_c: S::from_f64(-surface.c), normal }
}

fn plane<S: Scalar>(surface: &CompiledSurface<'_>, transfer: Transfer<S>) -> Plane<S> {
    Plane {
        transfer,
        index_step: S::from_f64(surface.index_step),
        aperture: S::from_f64(surface.aperture),
        tests: surface.tests,
        slack: S::from_f64(surface.slack),
        leads: surface.leads,
        is_led: surface.is_led,
    }
}

fn sphere<S: Scalar>(
    surface: &CompiledSurface<'_>,
    n: f64,
    transfer: Transfer<S>,
    far: bool,
    carries_normal: bool,
) -> Sphere<S> {
    let c = surface.c;
    let strong = surface.is_strong();
    Sphere {
        transfer,
        minus_c: S::from_f64(-c),
        half_c: S::from_f64(c / 2.0),
        minus_2cn2: S::from_f64(-2.0 * c * n * n),
        per_cn2: S::from_f64((c * n * n).recip()),
        index_step: S::from_f64(surface.index_step),
        strong,
        far,
        carries_normal,
        aperture_test: aperture_test(surface),
        tests: surface.tests,
        slack: S::from_f64(surface.slack),
        is_led: surface.is_led,
        plain: strong && !far && carries_normal && surface.is_steep() && !surface.tests.onward,
    }
}

/// Returns the link between two surfaces, if a link is possible: both surfaces are strongly curved, no test is needed
/// except that of the direction of travel, and rounding is amplified by no more than `limit` in the result and
/// [`LINK_ROUNDING`] in t.
fn link(last: &CompiledSurface<'_>, surface: &CompiledSurface<'_>, limit: f64) -> Option<Link<f64>> {
    let CompiledSurface { c, n, .. } = *surface;
    if last.aspheric.is_some() || last.unsymmetric.is_some() || surface.change.is_some() {
        return None;
    }
    let curved = last.c != 0.0 && c != 0.0 && last.is_strong() && surface.is_strong();
    let near_side = surface.is_steep() || last.semi * c.abs() < NARROW;
    if !(curved && near_side) || surface.tests.onward {
        return None;
    }
    let link = link_at(last, surface, n);
    let phi = (link.minus_2phi1.abs()).max(link.minus_2phi0.abs()) / 2.0;
    let along = link.alpha.abs().max(link.rho.abs()) * n;
    // t is the difference of g and e, divided by c n². φ, the sum of two nearly opposite terms, has twice the rounding
    // error of g.
    let rounding = along.max(2.0 * phi) / (c.abs() * n * n * surface.semi);
    (along.max(phi) <= limit && rounding <= LINK_ROUNDING).then_some(link)
}

/// Returns the link between two surfaces in a medium of index `n`.
fn link_at(last: &CompiledSurface<'_>, surface: &CompiledSurface<'_>, n: f64) -> Link<f64> {
    let CompiledSurface { c, distance: d, .. } = *surface;
    let last_c = last.c_behind();
    let rho = c / last_c;
    let alpha = 1.0 + c * d - rho;
    let phi1 = c * n * n * alpha / last_c;
    let phi0 = c * n * n * (d + c * d * d / 2.0 - alpha / last_c);
    Link {
        alpha,
        rho,
        minus_2phi0: -2.0 * phi0,
        minus_2phi1: -2.0 * phi1,
        index_step: surface.index_step,
        minus_c: -c,
        per_n2: (n * n).recip(),
        per_cn2: (c * n * n).recip(),
        aperture_test: aperture_test(surface),
        forward: surface.tests.forward,
        rarer: surface.index_step < 0.0,
    }
}

impl Link<f64> {
    fn to<S: Scalar>(self) -> Link<S> {
        Link {
            alpha: S::from_f64(self.alpha),
            rho: S::from_f64(self.rho),
            minus_2phi0: S::from_f64(self.minus_2phi0),
            minus_2phi1: S::from_f64(self.minus_2phi1),
            index_step: S::from_f64(self.index_step),
            minus_c: S::from_f64(self.minus_c),
            per_n2: S::from_f64(self.per_n2),
            per_cn2: S::from_f64(self.per_cn2),
            aperture_test: match self.aperture_test {
                ClearTest::Height(limit) => ClearTest::Height(S::from_f64(limit)),
                ClearTest::NormalZ(least) => ClearTest::NormalZ(S::from_f64(least)),
            },
            forward: self.forward,
            rarer: self.rarer,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use realistic_optics::{
        lens::{Lens, refraction::Refraction},
        prescription::{catalogue, read},
    };

    fn renormalisations(lens: &Lens, direction: Direction) -> usize {
        let path = Path::new(lens, direction, Refraction::Fused);
        let table = Table::<f64>::new(&path, 25.0);
        table.steps.iter().filter(|step| matches!(step, Step::Sphere(sphere) if sphere.far)).count()
    }

    #[test]
    fn rows_of_balls_are_renormalised_and_catalogue_lenses_rarely() {
        let row = "1 2 1.8 1.9\n-1 4 1 1.9\n".repeat(7) + "1 2 1.8 1.9\n-1 0 1 1.9";
        let balls = Lens::at_d_line(&read("balls", row.as_bytes()).expect("a lens"));
        for direction in [Direction::FilmToScene, Direction::SceneToFilm] {
            assert!(renormalisations(&balls, direction) >= 3);
            let count =
                |name| renormalisations(&Lens::at_d_line(&catalogue::find(name).expect("listed")), direction);
            let some: Vec<(&str, usize)> =
                catalogue::round().map(|name| (name, count(name))).filter(|(_, count)| *count > 0).collect();
            // Each of these lenses has one such surface, which is steep and far from the previous surface.
            assert!(some.len() <= 4 && some.iter().all(|(_, count)| *count == 1), "{some:?}");
        }
    }
}
