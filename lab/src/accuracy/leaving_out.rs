//! What leaving out saves: the same camera with everything kept and with what its plan proves idle left out, no bit of any
//! ray different; times per ray in turns out.

use realistic::camera::{
    CameraError, Host, Parameters, Precision, Raster, RealisticCamera, Sample, SampleBlock,
};

use crate::{
    BLOCK,
    results::table::{Table, row},
    subject::{FILM_DIAGONAL, PIXELS, STOPPED_DOWN, quasirandom::spread},
    timing::{
        Effort, Timing,
        camera_calls::{in_one_call, one_by_one},
        interleaved,
    },
};

/// What one camera saves on one way of asking it.
#[derive(Clone, Debug)]
pub struct Saving {
    /// The lens.
    pub lens: String,
    /// Wide open or stopped down, the precision, and how it is asked.
    pub camera: String,
    /// Time per ray with everything kept, seconds.
    pub kept: Timing,
    /// The same of the camera that leaves out what its plan says.
    pub left_out: Timing,
}

impl Saving {
    /// The share of the time that leaving out saves, at the median and the quartiles, the least first; negative where it
    /// costs time.
    pub fn share(&self) -> [f64; 3] {
        [self.left_out.high, self.left_out.median, self.left_out.low]
            .map(|time| 1.0 - time / self.kept.median)
    }
}

/// A camera focused at infinity on the film of every subject.
fn camera(
    lens: &str,
    fnumber: Option<f64>,
    precision: Precision,
    leave_out: bool,
) -> Result<RealisticCamera, CameraError> {
    let parameters = Parameters {
        specfile: Some(lens.to_owned()),
        filmdiag: Some(FILM_DIAGONAL),
        focusdistance: Some(f64::INFINITY),
        precision: Some(Some(precision)),
        fnumber,
        ..Parameters::default()
    };
    let host = Host { leave_out, ..Host::new(PIXELS, None) };
    RealisticCamera::build(&parameters, &host, &mut |_, _| {})
}

/// Both precisions of a lens, wide open and stopped down, in blocks and one by one.
///
/// # Errors
/// A camera cannot be built.
pub fn measure(lens: &str, effort: Effort) -> Result<Vec<Saving>, CameraError> {
    let samples = samples();
    let mut savings = Vec::new();
    for (stop, fnumber) in [("wide open".to_owned(), None), (format!("f/{STOPPED_DOWN}"), Some(STOPPED_DOWN))]
    {
        for precision in [Precision::F64, Precision::F32] {
            let [kept, left_out] = [false, true].map(|leave_out| camera(lens, fnumber, precision, leave_out));
            let cameras = [kept?, left_out?];
            let mut add = |way: &str, times: Vec<Timing>| {
                let [kept, left_out] = [times[0], times[1]].map(|time| time.per(BLOCK));
                let camera = format!("{stop}, {precision}, {way}");
                savings.push(Saving { lens: lens.to_owned(), camera, kept, left_out });
            };
            add("blocks", timed(&cameras, effort, |camera| in_one_call(camera, &samples)));
            add("one by one", timed(&cameras, effort, |camera| one_by_one(camera, &samples)));
        }
    }
    Ok(savings)
}

fn timed(cameras: &[RealisticCamera; 2], effort: Effort, work: impl Fn(&RealisticCamera)) -> Vec<Timing> {
    let work = &work;
    interleaved(cameras.iter().map(|camera| Box::new(move || work(camera)) as Box<dyn FnMut()>), effort)
}

/// Samples all but evenly spread over the image.
fn samples() -> Box<SampleBlock<BLOCK>> {
    let mut block = Box::new(SampleBlock::<BLOCK>::new());
    let Raster { xres, yres } = PIXELS;
    for (i, [x, y, u, v]) in spread::<4>(0.5).take(BLOCK).enumerate() {
        let across = |share: f64, pixels: u32| (f64::from(pixels) * share) as f32;
        let (image_x, image_y) = (across(x, xres), across(y, yres));
        block.set(i, &Sample { image_x, image_y, lens_u: u as f32, lens_v: v as f32, time: 0.5 });
    }
    block
}

/// The results as a table.
pub fn table(results: &[Saving]) -> Table {
    let columns = "lens camera kept_ns left_out_ns saved_low saved saved_high";
    let rows = results.iter().map(|saving| {
        let [low, median, high] = saving.share();
        let times = [saving.kept.median * 1e9, saving.left_out.median * 1e9];
        row![saving.lens.as_str(), saving.camera.as_str(), times[0], times[1], low, median, high]
    });
    Table::of("leaving-out", columns, rows)
}
