//! OSL text that samples the pupil. The shader's function takes a field, a focus, a zoom, a stop and two random
//! numbers; it returns a point of the sampling plane and the area that the point represents.

use super::numbers::Numbers as Moving;
use super::optics::Optics;
use super::stop::{EggCoefficients, NO_LIMIT, StopView};
use super::table::{FIELDS, FOCI, HEIGHTS, PupilNode, PupilTable};
use super::text::{array, number};
use std::fmt::Write as _;

/// Numbers per node: low, high and the values of g, and the numbers of the stop's image.
const NODE: usize = 2 + HEIGHTS + STOP;
const STOP: usize = 10;
/// Numbers per focus for the film's centre: the pupil's radius at the widest stop, and three numbers of the stop's
/// image.
const AXIS: usize = 4;

/// Returns the function `pupil`. For a zoom lens it has a parameter `zoomed`, too.
pub fn text(stations: &[Optics], table: &PupilTable) -> String {
    let zooms = stations.len() > 1;
    let images = all_images(stations, table);
    let nodes = table.nodes.iter().zip(images).flat_map(|(PupilNode { low, high, g }, image)| {
        [*low, *high].into_iter().chain(*g).chain(image).collect::<Vec<f64>>()
    });
    // Each number of the table at this index of a node, interpolated.
    let corners = if zooms { 8 } else { 4 };
    let sum = |index: &str| {
        let terms: Vec<String> = (0..corners).map(|n| format!("w{n}*T[n{n}{index}]")).collect();
        terms.join(" + ")
    };
    let mut weights = format!(
        "  int n0 = (j*{FIELDS} + i)*{NODE};\n  \
           int n1 = n0 + {NODE};\n  \
           int n2 = n0 + {FIELDS}*{NODE};\n  \
           int n3 = n2 + {NODE};\n  \
           float w3 = a*b;\n  float w2 = b - w3;\n  float w1 = a - w3;\n  float w0 = 1 - a - w2;\n"
    );
    if zooms {
        let _ = writeln!(
            weights,
            "  int node = min(int(zoomed), {});\n  float part = zoomed - node;\n  node *= {};",
            stations.len() / 2 - 1,
            FOCI * FIELDS * NODE,
        );
        for n in 0..4 {
            let _ = writeln!(
                weights,
                "  n{n} += node;\n  int n{} = n{n} + {};\n  float w{} = part*w{n};\n  w{n} -= w{};",
                n + 4,
                FOCI * FIELDS * NODE,
                n + 4,
                n + 4
            );
        }
    }
    format!(
        "/* Samples the pupil that a film point sees. a: its distance from the axis, the point being on +x, as a share of that\n   \
            of the farthest bright one; b: the focus, in steps of the table;{} stop: as in trace. Gives a point of the\n   \
            plane in mm, and the area that it stands for over pi. 0: the point is dark. */\n\
         int pupil(float field, float focus,{} float stop, float sample_1, float sample_2, output float px,\n          \
         output float py, output float patch)\n{{\n{}\
           float a = field;\n  float b = focus;\n  \
           if (a >= 1)\n    return 0;\n  \
           a = {}*{};\n  \
           int i = min(int(a), {});\n  \
           int j = min(int(b), {});\n  \
           a -= i;\n  b -= j;\n{weights}  \
           float low = {};\n  \
           float high = {};\n  \
           float center = 0.5*(low + high);\n  float half_width = 0.5*(high - low);\n  \
           float c = 0, w = 1, h = 1, egg = 0;\n  \
           if (stop < 1) {{\n    \
             int at = {};\n    \
             float s2 = stop*stop;\n    \
             float N[{STOP}];\n    \
             for (int k = 0; k < {STOP}; k++)\n      \
               N[k] = {};\n    \
             c = N[0] + s2*(N[1] + s2*N[2]);\n    \
             w = stop*(N[3] + s2*(N[4] + s2*N[5]));\n    \
             h = stop*(N[6] + s2*(N[7] + s2*N[8]));\n    \
             egg = stop*N[9];\n    \
             low = max(low, c - w);\n    high = min(high, c + w);\n  }}\n  \
           if (low >= high)\n    return 0;\n  \
           float radius = sqrt(sample_1);\n  \
           float sine = 0, cosine = 0;\n  \
           sincos({}*sample_2, sine, cosine);\n  \
           float along = radius*cosine;\n  \
           patch = 0.5*(high - low);\n  \
           px = 0.5*(low + high) + patch*along;\n  \
           /* The table's height over that of the unit disk, at the same x. */\n  \
           float place = clamp((px - center)/half_width, -1.0, 1.0);\n  \
           float shape = 1;\n  \
           a = {}*(place + 1);\n  \
           i = min(int(a), {});\n  \
           a -= i;\n  \
           i += 2;\n  \
           float height = (1 - a)*({}) +\n                 \
             a*({});\n  \
           if (stop < 1) {{\n    \
             shape = max(1 - along*along, 1e-6);\n    \
             float squared = height*height*(1 - place*place);\n    \
             place = clamp((px - c)/w, -1.0, 1.0);\n    \
             h *= 1 + egg*place;\n    \
             height = sqrt(max(min(squared, h*h*(1 - place*place)), 0.0)/shape);\n  }}\n  \
           py = radius*sine*height;\n  \
           patch *= height;\n  \
           return 1;\n}}\n\n",
        if zooms { " zoomed: the zoom, in nodes;" } else { "" },
        if zooms { " float zoomed," } else { "" },
        array("T", nodes),
        number((FIELDS - 1) as f64),
        if table.ends_dark { "(1 - sqrt(1 - a))" } else { "a" },
        FIELDS - 2,
        FOCI - 2,
        sum(""),
        sum(" + 1"),
        2 + HEIGHTS,
        sum(" + at + k"),
        number(std::f64::consts::TAU),
        number((HEIGHTS - 1) as f64 / 2.0),
        HEIGHTS - 2,
        sum(" + i"),
        sum(" + i + 1"),
    )
}

/// Returns the text that samples the pupil from the position `b` of the focus in the table: the slopes `sx` and `sy`, and
/// `centre`, the irradiance of the film's centre over pi; and the array that this text needs, if the lens does not zoom.
pub fn sampling(stations: &[Optics], table: &PupilTable, numbers: &mut Moving) -> String {
    let field = numbers.text(table.stations.iter().map(|span| 1.0 / span.widest_field));
    let rows: Vec<Vec<f64>> = stations
        .iter()
        .zip(&table.stations)
        .map(|(optics, span)| {
            let views = span.foci.iter().map(|(lens, distance)| StopView::of(optics, lens, *distance));
            let terms = |(view, radius): (StopView, &f64)| {
                let [k0, k1, k2] = view.radius();
                [*radius, k0, k1, k2]
            };
            views.zip(&span.on_axis).flat_map(terms).collect()
        })
        .collect();
    let (declared, name, start) = match &*rows {
        [row] => (array("R", row.iter().copied()), "R", 0),
        rows => (String::new(), "C", numbers.block(rows)),
    };
    let at = |step: usize, term: usize| format!("{name}[at + {}]", start + AXIS * step + term);
    let stop_radius = |step: usize| format!("({} + s2*({} + s2*{}))", at(step, 1), at(step, 2), at(step, 3));
    format!(
        "  float r = sqrt(fx*fx + fy*fy);\n  \
           float ex = r > 0 ? fx/r : 1;\n  \
           float ey = r > 0 ? fy/r : 0;\n  \
           if (!pupil(r*far*{field}, b,{} stop, lens_sample[0], lens_sample[1], px, py, patch))\n    return;\n  \
           float along = (px - r)*far;\n  \
           float across = py*far;\n  \
           float sx = ex*along - ey*across;\n  \
           float sy = ey*along + ex*across;\n\n  \
           /* The radius of the pupil of the film's centre, and the irradiance there over pi. */\n{declared}  \
           int at = min(int(b), {});\n  \
           float c = b - at;\n  \
           at *= {AXIS};\n  \
           float opening = far*min(stop*((1 - c)*{} + c*{}), (1 - c)*{} + c*{});\n  \
           float centre = opening*opening/(1 + opening*opening);\n",
        if stations.len() > 1 { " zoomed," } else { "" },
        FOCI - 2,
        stop_radius(0),
        stop_radius(1),
        at(0, 0),
        at(1, 0),
    )
}

/// Returns the images of the stop at all nodes, widened so that an image interpolated between two nodes of the zoom
/// contains the true image.
fn all_images(stations: &[Optics], table: &PupilTable) -> Vec<EggCoefficients> {
    let of = |(station, optics): (usize, &Optics)| -> Vec<EggCoefficients> {
        let foci = &table.stations[station].foci;
        foci.iter()
            .flat_map(|(lens, distance)| {
                images(&StopView::of(optics, lens, *distance), |node| table.field(station, node))
            })
            .collect()
    };
    let all: Vec<Vec<EggCoefficients>> = stations.iter().enumerate().map(of).collect();
    // Factor by which the image at each node must be widened.
    let mut widening = vec![vec![1.0_f64; FOCI * FIELDS]; all.len()];
    for between in (1..all.len()).step_by(2) {
        for (i, image) in all[between].iter().enumerate() {
            let ends = [&all[between - 1][i], &all[between + 1][i]];
            if *image == NO_LIMIT || ends.contains(&&NO_LIMIT) {
                continue;
            }
            for s in [0.125_f64, 0.25, 0.5, 1.0] {
                let s2 = s * s;
                let terms =
                    |image: &EggCoefficients, k: usize| image[k] + s2 * (image[k + 1] + s2 * image[k + 2]);
                let mean = |k: usize| f64::midpoint(terms(ends[0], k), terms(ends[1], k));
                // The widths are divided by s; the centre is not.
                let off = (terms(image, 0) - mean(0)).abs() / s;
                let needed = ((terms(image, 3) + off) / mean(3)).max(terms(image, 6) / mean(6));
                for node in [between - 1, between + 1] {
                    widening[node][i] = widening[node][i].max(needed);
                }
            }
        }
    }
    let widened = |(mut image, widening): (EggCoefficients, f64)| {
        image[3..9].iter_mut().for_each(|number| *number *= widening);
        image
    };
    let all = all.into_iter().zip(widening).step_by(2);
    all.flat_map(|(images, widening)| images.into_iter().zip(widening)).map(widened).collect()
}

/// Returns the images of the stop at the nodes of one focus. From the first field on for which no ray reaches the
/// stop's centre, the stop sets no limit. Between a field with a limit and a field without, the shader interpolates a
/// limit so loose that it excludes nothing.
fn images(view: &StopView, field_of: impl Fn(f64) -> f64) -> Vec<EggCoefficients> {
    let mut near = [0.0, 0.0];
    let mut images: Vec<EggCoefficients> = Vec::new();
    for i in 0..FIELDS {
        let field = field_of(i as f64);
        match view.image(field, near) {
            Some((numbers, center)) => {
                near = center;
                images.push(numbers);
            }
            None => break,
        }
    }
    images.resize(FIELDS, NO_LIMIT);
    images
}
