//! Set-up of the pupil: the cost of finding the open region with tables of several sizes, and how well each table
//! covers the true pupil. The coverage is computed from areas of polygons in slope about the true pupil's centre.

use realistic_camera::sampling::PupilDisk;
use realistic_optics::lens::{film_ray, pupil::SlopeDisk};
use realistic_trace::kernel::Kernel;

use crate::{
    pupil::Outline,
    results::{
        statistics::median,
        table::{Table, row},
    },
    subject::Subject,
    timing::repeated,
};

/// Numbers of film points and builds of a measurement.
#[derive(Clone, Copy, Debug)]
pub struct PupilCounts {
    /// Number of builds; the median of their times is reported.
    pub points: u32,
    /// Builds; the reported time is their median.
    pub repeats: usize,
}

/// A function that returns the edge of the region that is sampled at a film point, as slopes in counter-clockwise
/// order; the edge is empty where the film is assumed to be dark.
type Region = Box<dyn Fn([f64; 2]) -> Vec<[f64; 2]>>;

/// A pupil ready to be sampled.
struct Built {
    region: Region,
    /// Number of film radii in the pupil's table.
    radii: usize,
    /// Number of rays traced to build the pupil.
    rays: usize,
}

/// A function that builds the pupil of a lens.
type Build = fn(&Subject) -> Built;

/// The pupils compared: the two disks, boxes for rings of the film as in M. Pharr, W. Jakob and G. Humphreys,
/// *Physically Based Rendering*, 3rd ed., section 6.4.5, and the warped pupil.
const PUPILS: [(&str, Build); 7] = [
    ("rear", |subject| disk(subject.rear)),
    ("disk", |subject| disk(subject.exit)),
    ("4 boxes", |subject| boxes(subject, 4)),
    ("16 boxes", |subject| boxes(subject, 16)),
    ("64 boxes", |subject| boxes(subject, 64)),
    ("256 boxes", |subject| boxes(subject, 256)),
    ("warped", warped),
];

/// Number of vertices of a polygon.
const EDGE: u32 = 720;

fn unit_circle() -> impl Iterator<Item = [f64; 2]> {
    (0..EDGE).map(|i| std::f64::consts::TAU * f64::from(i) / f64::from(EDGE)).map(|a| [a.cos(), a.sin()])
}

fn disk(disk: PupilDisk) -> Built {
    let region = move |point: [f64; 2]| {
        let SlopeDisk { center, radius } = disk.seen_from(point);
        unit_circle().map(|[x, y]| [center[0] + radius * x, center[1] + radius * y]).collect()
    };
    Built { region: Box::new(region), radii: 0, rays: 0 }
}

fn warped(subject: &Subject) -> Built {
    let pupil = subject.warped_pupil();
    let report = pupil.build_report();
    let region = move |point| {
        unit_circle().filter_map(|d| pupil.sample(point, d)).map(|sample| sample.slopes).collect()
    };
    Built { region: Box::new(region), radii: report.nodes, rays: report.rays as usize }
}

/// Rays along a diameter of the rear disk, to find a box.
const ACROSS: u32 = 64;

/// Returns, for each ring of the film, the box that contains the passing rays of a grid, widened by one grid cell. The
/// box is in slopes, for film points on the +x axis.
fn boxes(subject: &Subject, count: u32) -> Built {
    let reach = subject.film.reach();
    let at = |i: u32, n: u32| (f64::from(i) + 0.5) / f64::from(n);
    let mut all: Vec<Option<[[f64; 2]; 2]>> = Vec::new();
    for ring in 0..count {
        let mut found: Option<[[f64; 2]; 2]> = None;
        let mut cell = 0.0;
        for i in 0..ACROSS * ACROSS {
            let (row, column) = (i / ACROSS, i % ACROSS);
            // Multiples of the golden ratio spread the rays' film points over all radii of the ring.
            let share = (f64::from(i) * 0.618_033_988_749_894_9).fract();
            let point = [reach * (f64::from(ring) + share) / f64::from(count), 0.0];
            let cover = subject.rear.seen_from(point);
            let position = [at(row, ACROSS), at(column, ACROSS)].map(|x| 2.0 * x - 1.0);
            let slopes = [0, 1].map(|k| cover.center[k] + cover.radius * position[k]);
            cell = 2.0 * cover.radius / f64::from(ACROSS);
            if subject.path.trace(film_ray(point, subject.film_z, slopes)).is_ok() {
                let [low, high] = found.unwrap_or([slopes; 2]);
                found = Some([[0, 1].map(|k| low[k].min(slopes[k])), [0, 1].map(|k| high[k].max(slopes[k]))]);
            }
        }
        all.push(found.map(|[low, high]| [low.map(|x| x - cell), high.map(|x| x + cell)]));
    }
    let region = move |[x, _]: [f64; 2]| {
        let ring = ((x / reach * f64::from(count)) as usize).min(all.len() - 1);
        all[ring].map_or_else(Vec::new, |[low, high]| vec![low, [high[0], low[1]], high, [low[0], high[1]]])
    };
    Built { region: Box::new(region), radii: count as usize, rays: (count * ACROSS * ACROSS) as usize }
}

/// The coverage of one pupil on one lens.
#[derive(Clone, Debug, PartialEq)]
pub struct Coverage {
    /// The lens.
    pub lens: String,
    /// The pupil's name.
    pub name: &'static str,
    /// Number of film radii in the pupil's table.
    pub radii: usize,
    /// Number of rays traced to build the pupil.
    pub rays: usize,
    /// Time to build the pupil, seconds.
    pub time: f64,
    /// Share of the true pupil that no sample reaches.
    pub missed: f64,
    /// Share of the samples that the lens blocks.
    pub excess: f64,
}

/// Measures every pupil on one lens.
pub fn measure(subject: &Subject, counts: PupilCounts) -> Vec<Coverage> {
    let reach = subject.film.diagonal() / 2.0;
    let kernel = Kernel::along(&subject.path);
    let truths: Vec<([f64; 2], Outline)> = (0..counts.points)
        .map(|i| [reach * ((f64::from(i) + 0.5) / f64::from(counts.points)).sqrt(), 0.0])
        .filter_map(|point| {
            let cover = subject.rear.seen_from(point);
            Some((point, Outline::of(&kernel, subject.film_z, point, cover, EDGE as usize)?))
        })
        .collect();
    PUPILS
        .iter()
        .map(|&(name, build)| {
            // The first build warms up the caches.
            let (built, times) = repeated(counts.repeats + 1, || build(subject));
            // Sums of squared radii, which are areas up to a common factor.
            let (mut whole, mut sampled, mut missed, mut excess) = (0.0, 0.0, 0.0, 0.0);
            for (point, truth) in &truths {
                let edge = (built.region)(*point);
                for corner in &truth.points {
                    let own = [0, 1].map(|k| corner[k] - truth.center[k]);
                    let size = own[0] * own[0] + own[1] * own[1];
                    let reached = distance_to(&edge, truth.center, own).powi(2) * size;
                    whole += size;
                    sampled += reached;
                    missed += (size - reached).max(0.0);
                    excess += (reached - size).max(0.0);
                }
            }
            Coverage {
                lens: subject.lens.name.clone(),
                name,
                radii: built.radii,
                rays: built.rays,
                time: median(&times[1..]),
                missed: missed / whole,
                excess: excess / sampled,
            }
        })
        .collect()
}

/// Returns the distance, in units of `direction`, from `from` to the point at which the ray leaves the polygon; 0 if
/// the ray misses the polygon.
fn distance_to(polygon: &[[f64; 2]], from: [f64; 2], direction: [f64; 2]) -> f64 {
    let cross = |a: [f64; 2], b: [f64; 2]| a[0] * b[1] - a[1] * b[0];
    let next = polygon.iter().cycle().skip(1);
    polygon
        .iter()
        .zip(next)
        .filter_map(|(a, b)| {
            let (side, start) = ([b[0] - a[0], b[1] - a[1]], [a[0] - from[0], a[1] - from[1]]);
            let across = cross(direction, side);
            let (along, share) = (cross(start, side) / across, cross(start, direction) / across);
            ((0.0..=1.0).contains(&share) && along >= 0.0).then_some(along)
        })
        .fold(0.0, f64::max)
}

/// Returns the results as a table.
pub fn table(results: &[Coverage]) -> Table {
    let rows = results
        .iter()
        .map(|m| row![m.lens.as_str(), m.name, m.radii, m.rays, m.time * 1e3, m.missed, m.excess]);
    Table::of("pupils", "lens pupil film_radii rays build_ms missed_share excess_share", rows)
}

#[cfg(test)]
mod tests {
    use super::*;
    use realistic_optics::prescription::catalogue;

    #[test]
    fn a_half_line_leaves_a_polygon_where_geometry_says() {
        let square = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
        assert_eq!(distance_to(&square, [0.0, 0.0], [0.5, 0.0]), 2.0);
        assert_eq!(distance_to(&square, [0.5, 0.25], [0.0, -1.0]), 1.25);
        assert_eq!(distance_to(&square, [2.0, 0.0], [1.0, 0.0]), 0.0);
    }

    #[test]
    fn the_warped_pupil_covers_the_true_one_closely() {
        let subject = Subject::new(&catalogue::find("dgauss.50mm").expect("listed")).expect("focuses");
        let all = measure(&subject, PupilCounts { points: 12, repeats: 1 });
        let of = |name: &str| all.iter().find(|m| m.name == name).expect("measured");
        assert!(of("warped").missed < 2e-4 && of("warped").excess < 0.01, "{all:?}");
        assert!(of("rear").missed < 1e-6 && of("rear").excess > 0.15, "{all:?}");
        assert!(of("disk").missed > 0.01, "{all:?}");
        let (coarse, fine) = (of("4 boxes"), of("64 boxes"));
        assert!(
            fine.excess < coarse.excess && fine.missed < 1e-3 && fine.excess > of("warped").excess,
            "{all:?}"
        );
    }
}
