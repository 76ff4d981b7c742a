//! Rays of one pencil, traced for searches: points of a plane in, how far outside every aperture their rays are out.

use std::sync::atomic::{AtomicU32, AtomicU64, Ordering::Relaxed};

use crate::{
    lens::pupil::SlopeDisk,
    prescription::MAX_INTERFACES,
    sampling::pupil_disk::PupilDisk,
    trace::{
        self, Path,
        kernel::{Clearance, ClearanceTracer, MeridianRay},
    },
};

/// Rays that take hardly more time than one and count as one packet: what few registers of any processor take.
pub(crate) const LANES: usize = 8;
/// What a table may take: some 12,000 packets, for which a surface takes some 20 ns each.
const MOST_WORK: u64 = 12_000 * PACKET;
/// What a packet counts: no lens of spheres has more surfaces.
const PACKET: u64 = MAX_INTERFACES as u64;
/// What an asphere counts in the place of the whole packet, where aspheres are so many that this is more, and what each
/// further evaluation of it for a ray counts (some 110 and 25 ns): a table of a lens of 100 interfaces then takes 50 ms at
/// most.
const ASPHERE: u64 = 27;
const EVALUATION: u64 = 6;
/// A lens may take so many times longer as it has whole hundreds of interfaces.
const LONG: u64 = 100;

/// Film radius up to which there is always a table, mm: much less than a wavelength, and enough for differences on film
/// without width.
const LEAST_REACH: f64 = 1e-6;
/// [`Family::loose`] of the film's side: two thirds of it take a sixth more slices, more blocks more samples.
const LOOSE: f64 = 2.5e-3;
/// [`Family::finest`] of the film's side.
const FINEST: usize = 1;
/// [`Pencil::accuracy`] of the film's side.
const ACCURACY: f64 = 1e-4;

/// What stops the rays beyond a point of the edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Limit {
    /// The aperture of a surface.
    Aperture(usize),
    /// A ray that misses, is reflected or turns back.
    Optics,
}

/// How far outside an aperture a ray is: at most 0 for one that gets through.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Excess {
    /// Height over semi-diameter, minus 1; infinite for [`Limit::Optics`].
    pub value: f64,
    pub limit: Limit,
    /// Whether the ray would get lost without apertures, too.
    pub lost: bool,
}

impl Excess {
    /// Whether the ray gets through.
    pub fn passes(&self) -> bool {
        self.value <= 0.0
    }

    /// Of what became of a ray.
    pub fn of(clearance: Option<Clearance>) -> Self {
        match clearance {
            Some(Clearance { ratio, surface, lost, .. }) => {
                Self { value: ratio - 1.0, limit: Limit::Aperture(surface), lost }
            }
            None => Self { value: f64::INFINITY, limit: Limit::Optics, lost: true },
        }
    }
}

/// The rays of one point, named by points (x, y) of a plane; what gets through is symmetric in y.
pub(crate) trait Pencil {
    /// How far outside the apertures they are: of all apertures the largest; at most 0 for what gets through.
    fn excesses(&self, points: &[[f64; 2]]) -> Vec<Excess>;
    /// Accuracy of an outline's edges over their distance: less takes more rays, more light is missed.
    fn accuracy(&self) -> f64;
    /// Whether all the rays that a table may take were traced.
    fn is_spent(&self) -> bool;
}

/// Counts what tracing takes, in units that do not depend on the machine: the same lens gets the same table.
pub(crate) struct RayBudget {
    rays: AtomicU32,
    /// Packets traced, full or not, and evaluations of aspheres, times what they count.
    done: AtomicU64,
    per_packet: u64,
    /// How much longer than others the lens may take.
    longer: u64,
}

impl RayBudget {
    pub fn new(path: &Path) -> Self {
        let longer = (path.surfaces() as u64 / LONG).max(1);
        let per_packet = (ASPHERE * path.aspheres() as u64 / longer).max(PACKET);
        Self { rays: AtomicU32::new(0), done: AtomicU64::new(0), per_packet, longer }
    }

    /// Counts rays while they are traced.
    pub fn count<T>(&self, rays: usize, traced: impl FnOnce() -> T) -> T {
        let before = trace::evaluations();
        let found = traced();
        let further = EVALUATION * (trace::evaluations() - before) / self.longer;
        let packets = self.per_packet * rays.div_ceil(LANES) as u64;
        self.rays.fetch_add(rays as u32, Relaxed);
        self.done.fetch_add(packets + further, Relaxed);
        found
    }

    /// Rays traced so far.
    pub fn rays(&self) -> u32 {
        self.rays.load(Relaxed)
    }

    /// Whether all the rays that a table may take were traced.
    pub fn is_spent(&self) -> bool {
        self.done.load(Relaxed) >= MOST_WORK
    }

    /// Whether half of them were.
    pub fn is_short(&self) -> bool {
        self.done.load(Relaxed) >= MOST_WORK / 2
    }
}

/// Pencils of one parameter h, from 0 on the axis outward, and where to look for their pupils.
pub(crate) trait Family {
    /// Whether there are no rays beyond the table's end, even where light would get through.
    const ENDS: bool;
    /// What a map and the one interpolated over it may differ by, as a share of the area, before steps are halved: less
    /// takes more slices, more blocks more samples.
    fn loose(&self) -> f64;
    /// The narrowest step, a power of two of smallest intervals: narrower ones follow jumps closer, and take more slices.
    fn finest(&self) -> usize;

    /// Whether pupils are looked at for what lies beside their outlines.
    fn probes_components(&self) -> bool {
        true
    }
    /// The rays of one of them.
    fn pencil(&self, height: f64) -> impl Pencil + '_;
    /// A disk, its middle on the x axis, that holds a pupil.
    fn cover(&self, height: f64) -> SlopeDisk;
    /// The largest h asked for.
    fn reach(&self) -> f64;
    /// h times this is about where the pupil's centre lies.
    fn shift(&self) -> f64;
    /// What tracing took.
    fn work(&self) -> &RayBudget;
}

/// The film's side of a lens: h is the film radius.
pub(crate) struct FilmPencils {
    clearances: ClearanceTracer,
    work: RayBudget,
    /// Largest film radius asked for, mm.
    reach: f64,
    /// A disk that holds every pupil.
    cover: PupilDisk,
    shift: f64,
}

impl FilmPencils {
    /// For film at z = `film`, behind the lens, and film points up to `reach` mm from the axis. `cover` is a disk that holds all
    /// their pupils; `shift` an estimate of the slope to the pupil's centre over the film radius, 1/mm.
    pub fn new(path: &Path, film: f64, reach: f64, cover: PupilDisk, shift: f64) -> Self {
        let (clearances, work) =
            (ClearanceTracer::new(&path.clone().without_blades(), film), RayBudget::new(path));
        Self { clearances, work, reach: reach.max(LEAST_REACH), cover, shift }
    }

    /// The disk that holds every pupil.
    pub fn disk(&self) -> PupilDisk {
        self.cover
    }
}

impl Family for FilmPencils {
    const ENDS: bool = false;

    fn loose(&self) -> f64 {
        LOOSE
    }

    fn finest(&self) -> usize {
        FINEST
    }

    fn pencil(&self, height: f64) -> impl Pencil + '_ {
        FilmPencil { side: self, height }
    }

    fn cover(&self, height: f64) -> SlopeDisk {
        self.cover.seen_from([height, 0.0])
    }

    fn reach(&self) -> f64 {
        self.reach
    }

    fn shift(&self) -> f64 {
        self.shift
    }

    fn work(&self) -> &RayBudget {
        &self.work
    }
}

/// The rays of the film point (`height`, 0), named by their slopes.
struct FilmPencil<'a> {
    side: &'a FilmPencils,
    height: f64,
}

impl Pencil for FilmPencil<'_> {
    fn excesses(&self, slopes: &[[f64; 2]]) -> Vec<Excess> {
        let rays = slopes.iter().map(|&slopes| MeridianRay { height: self.height, slopes });
        let mut found = Vec::with_capacity(slopes.len());
        let FilmPencils { clearances, work, .. } = self.side;
        work.count(slopes.len(), || clearances.trace(rays, |clearance| found.push(Excess::of(clearance))));
        found
    }

    fn accuracy(&self) -> f64 {
        ACCURACY
    }

    fn is_spent(&self) -> bool {
        self.side.work.is_spent()
    }
}
