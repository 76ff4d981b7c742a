//! The pupil of one film point, ray by ray: slopes in, how far outside every aperture their rays are out.
//!
//! The film point lies at (h, 0); its pupil is symmetric about the sx axis of slopes. A pupil much higher than wide is
//! seen as wide as high: sx counts in units of the width scale τ, here and in the outline.

use std::cell::Cell;

use crate::{
    prescription::MAX_INTERFACES,
    trace::{
        self, Path,
        kernel::{Clearance, ClearanceTracer, MeridianRay},
    },
};

/// Rays that are counted as one packet: what few registers of any processor take.
pub(super) const GROUP: usize = 8;
/// What a table may take: some 12,000 packets, for which a surface takes some 20 ns each.
const MOST_WORK: u64 = 12_000 * PACKET;
/// What a packet counts: no lens of spheres has more surfaces.
const PACKET: u64 = MAX_INTERFACES as u64;
/// What an asphere counts in the place of the whole packet, where aspheres are so many that this is more, and what each
/// further evaluation of it for a ray counts (some 110 and 25 ns): a table of a lens of 100 interfaces then takes 50 ms at
/// most.
const ASPHERE: u64 = 27;
const EVALUATION: u64 = 6;
/// Interfaces from which on a lens may take longer, in proportion.
const LONG: u64 = 100;

/// Traces rays for searches, and counts them.
pub(crate) struct Tracer {
    clearances: ClearanceTracer,
    rays: Cell<u32>,
    /// Packets traced, full or not, and evaluations of aspheres, times what they count: what the time depends on,
    /// whatever the width of the registers.
    work: Cell<u64>,
    per_packet: u64,
    /// How much longer than others the lens may take.
    longer: u64,
}

impl Tracer {
    pub fn new(path: &Path, film: f64) -> Self {
        let longer = (path.surfaces() as u64 / LONG).max(1);
        Self {
            clearances: ClearanceTracer::new(path, film),
            rays: Cell::new(0),
            work: Cell::new(0),
            per_packet: (ASPHERE * path.aspheres() as u64 / longer).max(PACKET),
            longer,
        }
    }

    /// Rays traced so far.
    pub fn rays(&self) -> u32 {
        self.rays.get()
    }

    /// Whether all the rays that a table may take were traced. Counted, not timed: the same lens gets the same table.
    pub fn is_spent(&self) -> bool {
        self.work.get() >= MOST_WORK
    }

    /// How far outside every aperture each of the rays is.
    pub fn excesses(&self, rays: impl ExactSizeIterator<Item = MeridianRay>, found: &mut Vec<Excess>) {
        let count = rays.len();
        self.rays.set(self.rays.get() + count as u32);
        found.clear();
        let before = trace::evaluations();
        self.clearances.trace(rays, |clearance| {
            found.push(match clearance {
                Some(Clearance { ratio, surface, lost }) => {
                    Excess { value: ratio - 1.0, limit: Limit::Aperture(surface), lost }
                }
                None => Excess { value: f64::INFINITY, limit: Limit::Optics, lost: true },
            });
        });
        let packets = self.per_packet * count.div_ceil(GROUP) as u64;
        let further = EVALUATION * (trace::evaluations() - before) / self.longer;
        self.work.set(self.work.get() + packets + further);
    }
}

/// The lens from one film point.
#[derive(Clone, Copy)]
pub(crate) struct View<'a> {
    pub tracer: &'a Tracer,
    /// Distance from the axis, mm.
    pub height: f64,
    /// τ, in units of which sx counts.
    pub width_scale: f64,
}

/// What stops the rays beyond a point of the edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Limit {
    /// The aperture of a surface.
    Aperture(usize),
    /// A ray that misses, is reflected or turns back.
    Optics,
}

/// How far outside an aperture a ray is: negative for one that gets through.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Excess {
    /// Height over semi-diameter, minus 1; infinite for [`Limit::Optics`].
    pub value: f64,
    pub limit: Limit,
    /// Whether the ray would get lost without apertures, too.
    pub lost: bool,
}

impl View<'_> {
    /// How far outside the pupil the ray of these slopes is.
    pub fn excess(&self, slopes: [f64; 2]) -> Excess {
        let mut found = Vec::with_capacity(1);
        self.excesses(&[slopes], &mut found);
        found[0]
    }

    /// [`View::excess`] of many.
    pub fn excesses(&self, slopes: &[[f64; 2]], found: &mut Vec<Excess>) {
        self.tracer.excesses(slopes.iter().map(|&slopes| self.ray(slopes)), found);
    }

    /// The ray of these slopes.
    pub fn ray(&self, [x, y]: [f64; 2]) -> MeridianRay {
        MeridianRay { height: self.height, slopes: [self.width_scale * x, y] }
    }

    /// Which of the rays of these slopes get through.
    pub fn pass(&self, slopes: &[[f64; 2]]) -> Vec<bool> {
        let mut found = Vec::with_capacity(slopes.len());
        self.excesses(slopes, &mut found);
        found.iter().map(|excess| excess.value <= 0.0).collect()
    }
}
