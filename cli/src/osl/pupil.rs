//! The text of the pupil's sampling: a field, a film distance, a stop and two random numbers in; a point of the sampling plane and
//! the area that it stands for out.

use super::optics::Optics;
use super::stop::{NO_LIMIT, Numbers, StopView};
use super::table::{FIELDS, FOCI, Node, PLACES, Table};
use super::text::{array, number};

/// Numbers of a node: low, high, g, and those of the stop's image.
const NODE: usize = 2 + PLACES + STOP;
const STOP: usize = 10;
/// Numbers of the film's centre per focus: the radius at the widest stop, and the three of the stop's image.
const AXIS: usize = 4;

/// The function `pupil`, and `on_axis`, which gives the radius of the pupil of the film's centre.
pub fn text(optics: &Optics, table: &Table) -> String {
    let views: Vec<StopView> =
        table.distances.iter().map(|&distance| StopView::of(optics, distance)).collect();
    let images = views.iter().flat_map(|view| images(view, table));
    let nodes = table.nodes.iter().zip(images).flat_map(|(Node { low, high, g }, image)| {
        [*low, *high].into_iter().chain(*g).chain(image).collect::<Vec<f64>>()
    });
    let axis = views.iter().zip(table.on_axis).flat_map(|(view, radius)| {
        let [k0, k1, k2] = view.radius();
        [radius, k0, k1, k2]
    });
    // The table's step along 1/B.
    let per = (FOCI - 1) as f64 / (1.0 / table.distances[0] - 1.0 / table.distances[FOCI - 1]);
    let first = per / table.distances[0];
    format!(
        "/* Samples the pupil that a film point sees. field: its distance from the axis over that of the film from the plane\n   \
            of the pupil, the point being on +x; far: 1 over the latter distance; stop: as in trace. Gives a point of the plane\n   \
            in mm, and the area that it stands for over pi. 0: the point is dark. */\n\
         int pupil(float field, float far, float stop, float sample_1, float sample_2, output float px, output float py,\n          \
         output float patch)\n{{\n{}\
           float a = field*{};\n  \
           if (a >= 1)\n    return 0;\n  \
           a = {}*{};\n  \
           float b = clamp({} - far*{}, 0.0, {});\n  \
           int i = int(a);\n  \
           int j = min(int(b), {});\n  \
           a -= i;\n  b -= j;\n  \
           int n0 = (j*{FIELDS} + i)*{NODE};\n  \
           int n1 = n0 + {NODE};\n  \
           int n2 = n0 + {FIELDS}*{NODE};\n  \
           int n3 = n2 + {NODE};\n  \
           float w3 = a*b;\n  float w2 = b - w3;\n  float w1 = a - w3;\n  float w0 = 1 - a - w2;\n  \
           float low = w0*T[n0] + w1*T[n1] + w2*T[n2] + w3*T[n3];\n  \
           float high = w0*T[n0 + 1] + w1*T[n1 + 1] + w2*T[n2 + 1] + w3*T[n3 + 1];\n  \
           float center = 0.5*(low + high);\n  float half_width = 0.5*(high - low);\n  \
           float c = 0, w = 1, h = 1, egg = 0;\n  \
           if (stop < 1) {{\n    \
             int at = {};\n    \
             float s2 = stop*stop;\n    \
             float N[{STOP}];\n    \
             for (int k = 0; k < {STOP}; k++)\n      \
               N[k] = w0*T[n0 + at + k] + w1*T[n1 + at + k] + w2*T[n2 + at + k] + w3*T[n3 + at + k];\n    \
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
           float height = (1 - a)*(w0*T[n0 + i] + w1*T[n1 + i] + w2*T[n2 + i] + w3*T[n3 + i]) +\n                 \
             a*(w0*T[n0 + i + 1] + w1*T[n1 + i + 1] + w2*T[n2 + i + 1] + w3*T[n3 + i + 1]);\n  \
           if (stop < 1) {{\n    \
             shape = max(1 - along*along, 1e-6);\n    \
             float squared = height*height*(1 - place*place);\n    \
             place = clamp((px - c)/w, -1.0, 1.0);\n    \
             h *= 1 + egg*place;\n    \
             height = sqrt(max(min(squared, h*h*(1 - place*place)), 0.0)/shape);\n  }}\n  \
           py = radius*sine*height;\n  \
           patch *= height;\n  \
           return 1;\n}}\n\n\
         /* The square of the radius of the pupil of the film's centre, mm2. */\n\
         float on_axis(float far, float stop)\n{{\n{}  \
           float b = clamp({} - far*{}, 0.0, {});\n  \
           int j = min(int(b), {});\n  \
           b -= j;\n  \
           j *= {AXIS};\n  \
           float s2 = stop*stop;\n  \
           float rim = (1 - b)*(R[j + 1] + s2*(R[j + 2] + s2*R[j + 3])) +\n              \
             b*(R[j + {}] + s2*(R[j + {}] + s2*R[j + {}]));\n  \
           rim = min(stop*rim, (1 - b)*R[j] + b*R[j + {AXIS}]);\n  \
           return rim*rim;\n}}\n\n",
        array("T", nodes),
        number(1.0 / table.widest_field),
        number((FIELDS - 1) as f64),
        if table.ends_dark { "(1 - sqrt(1 - a))" } else { "a" },
        number(first),
        number(per),
        number((FOCI - 1) as f64),
        FOCI - 2,
        2 + PLACES,
        number(std::f64::consts::TAU),
        number((PLACES - 1) as f64 / 2.0),
        PLACES - 2,
        array("R", axis),
        number(first),
        number(per),
        number((FOCI - 1) as f64),
        FOCI - 2,
        AXIS + 1,
        AXIS + 2,
        AXIS + 3,
    )
}

/// The images of the stop at the nodes of one film distance. From the first field on from which rays do not reach the stop's
/// centre there is no limit; interpolated between a limit and none the shader has almost none, which leaves nothing out.
fn images(view: &StopView, table: &Table) -> Vec<Numbers> {
    let mut near = [0.0, 0.0];
    let mut images: Vec<Numbers> = Vec::new();
    for i in 0..FIELDS {
        let field = table.field(i as f64);
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
