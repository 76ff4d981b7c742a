//! The pupil of one film point, ray by ray: slopes in, how far outside every aperture their rays are out.
//!
//! The film point lies at (h, 0); its pupil is symmetric about the sx axis of slopes. A pupil much higher than wide is
//! seen as wide as high: sx counts in units of the width scale τ, here and in the outline.

use std::cell::Cell;

use crate::{
    prescription::MAX_INTERFACES,
    trace::{
        Path,
        kernel::{Clearance, ClearanceTracer, MeridianRay},
    },
};

/// Rays that are counted as one packet: what few registers of any processor take.
const GROUP: usize = 8;
/// What a table may take: some 12,000 packets, for which a surface takes some 20 ns each.
const MOST_WORK: u64 = 12_000 * PACKET;
/// What a packet counts: no lens of spheres has more surfaces.
const PACKET: u64 = MAX_INTERFACES as u64;
/// What an asphere counts in the place of the whole packet, where aspheres are so many that this is more, and what each of
/// its rays counts that has to be followed there, or walked (some 110, 80 and 320 ns): a table of a lens of 100 interfaces
/// then takes 50 ms at most.
const ASPHERE: u64 = 27;
const FOLLOWED: u64 = 20;
const WALKED: u64 = 80;
/// Interfaces from which on a lens may take longer, in proportion.
const LONG: u64 = 100;

/// Traces rays for searches, and counts them.
pub(crate) struct Tracer<'a> {
    clearances: ClearanceTracer<'a>,
    rays: Cell<u32>,
    /// Packets traced, full or not, and rays followed to aspheres, times what they count: what the time depends on,
    /// whatever the width of the registers.
    work: Cell<u64>,
    per_packet: u64,
    per_followed: u64,
    per_walk: u64,
}

impl<'a> Tracer<'a> {
    pub fn new(path: &'a Path, film: f64) -> Self {
        let longer = (path.surfaces() as u64 / LONG).max(1);
        Self {
            clearances: ClearanceTracer::new(path, film),
            rays: Cell::new(0),
            work: Cell::new(0),
            per_packet: (ASPHERE * path.aspheres() as u64 / longer).max(PACKET),
            per_followed: FOLLOWED / longer,
            per_walk: WALKED / longer,
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
        let open = self.clearances.trace(rays, |clearance| {
            found.push(match clearance {
                Some(Clearance { ratio, surface, lost }) => {
                    Excess { value: ratio - 1.0, limit: Limit::Aperture(surface), lost }
                }
                None => Excess { value: f64::INFINITY, limit: Limit::Optics, lost: true },
            });
        });
        let packets = self.per_packet * count.div_ceil(GROUP) as u64;
        let open = self.per_followed * u64::from(open.followed) + self.per_walk * u64::from(open.walked);
        self.work.set(self.work.get() + packets + open);
    }
}

/// The lens from one film point.
#[derive(Clone, Copy)]
pub(crate) struct View<'a> {
    pub tracer: &'a Tracer<'a>,
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

/// How far around a guess for a pupil about so wide, within reach, a search looks first: film close behind a lens sees
/// the rear element much larger than the pupil.
pub(crate) fn first_look(reach: f64, width: f64) -> f64 {
    (0.02 * reach).min(0.25 * width)
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

    /// The slope sx on the meridian that is farthest inside the pupil, sought from `guess`, first as far as `width` from it,
    /// and within `reach` where there is nothing to go by; and its excess: where that is positive, the pupil is empty. With
    /// `any` the search ends at the first slope inside.
    pub fn innermost(&self, guess: f64, width: f64, reach: f64, any: bool) -> (f64, f64) {
        let start = self.least_of(&[guess]);
        if start.1 < f64::INFINITY {
            return self.descended(start, width, reach, any);
        }
        // Nothing to descend along.
        let near = self.scanned(guess, width, any);
        if near.1 < f64::INFINITY { near } else { self.scanned(guess, reach, any) }
    }

    /// The same after a coarse scan.
    pub fn scanned(&self, guess: f64, reach: f64, any: bool) -> (f64, f64) {
        const GRID: u32 = 24;
        let width = 2.0 * reach / f64::from(GRID);
        let grid: Vec<_> = (0..=GRID).map(|i| guess - reach + width * f64::from(i)).collect();
        self.descended(self.least_of(&grid), width, reach, any)
    }

    /// Where on the meridian a descent of the excess from a slope and its excess ends: at the least one as far as that
    /// matters, which is for the sign with `any`, else to a thousandth.
    fn descended(&self, mut best: (f64, f64), mut width: f64, reach: f64, any: bool) -> (f64, f64) {
        /// As many as a packet takes, but for the slope in the middle, which is known.
        const LOOKS: [f64; GROUP] = [-1.0, -0.75, -0.5, -0.25, 0.25, 0.5, 0.75, 1.0];
        const BELOW: usize = GROUP / 2 - 1;
        let enough = if any { 0.5 } else { 1e-3 };
        let mut found = Vec::with_capacity(GROUP);
        while width > 1e-9 * reach && !(any && best.1 < 0.0) && !self.tracer.is_spent() {
            self.excesses(&LOOKS.map(|part| [best.0 + part * width, 0.0]), &mut found);
            let looks = LOOKS.iter().zip(&found);
            let (least, part) =
                looks.fold(
                    (best.1, 0.0),
                    |least, (&part, excess)| {
                        if excess.value < least.0 { (excess.value, part) } else { least }
                    },
                );
            if part == 0.0 {
                // The excess falls and then rises: between two looks it is no deeper than their difference, unless rays
                // get lost, where it jumps.
                let jumps = found.iter().any(|excess| excess.lost);
                let depth = found[BELOW].value.max(found[BELOW + 1].value) - best.1;
                if !jumps && depth < enough * best.1.abs() {
                    break;
                }
            }
            best = (best.0 + part * width, least);
            width *= if part.abs() == 1.0 { 4.0 } else { 0.25 };
        }
        best
    }

    /// Of some slopes on the meridian the one with the least excess, and that.
    fn least_of(&self, places: &[f64]) -> (f64, f64) {
        let slopes: Vec<_> = places.iter().map(|&s| [s, 0.0]).collect();
        let mut found = Vec::with_capacity(slopes.len());
        self.excesses(&slopes, &mut found);
        let found = places.iter().zip(&found).map(|(&s, excess)| (s, excess.value));
        found.fold((places[0], f64::INFINITY), |best, new| if new.1 < best.1 { new } else { best })
    }
}
