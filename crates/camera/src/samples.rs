//! Samples of a picture: a single sample with the layout of the first members of pbrt-v1's `Sample`, and
//! columns of samples.

use std::{
    array,
    marker::PhantomData,
    mem::{offset_of, size_of},
    ptr, slice,
};

use glam::Vec4;

use super::columns::{Columns, Strided, read};
use realistic_simd::{Cpu, Lanes};

/// A sample of a picture, with the layout of the first members of pbrt-v1's `Sample`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sample {
    /// Raster x, pixels, growing to the right; may lie outside the raster.
    pub image_x: f32,
    /// Raster y, pixels, growing downward; may lie outside the raster.
    pub image_y: f32,
    /// Lens sample u, in [0, 1].
    pub lens_u: f32,
    /// Lens sample v, in [0, 1].
    pub lens_v: f32,
    /// Time sample, in [0, 1].
    pub time: f32,
}

/// Columns of samples: image x and y, lens u and v, and time; each column is a slice or a member of an array
/// of structures. Optionally there is a column of wavelengths, either one or `k` per sample; a sample with
/// `k` wavelengths has `k` rays.
#[derive(Clone, Copy, Debug)]
pub struct Samples<'a> {
    source: SampleSource<'a>,
    /// Number of rays of each sample.
    per_sample: usize,
    rays: usize,
    /// Whether every column that is present is a slice with one number per ray.
    are_slices: bool,
    borrow: PhantomData<&'a [f32]>,
}

/// One sample with an optional wavelength, or columns of members and wavelengths.
#[derive(Clone, Copy, Debug)]
enum SampleSource<'a> {
    One(&'a Sample, Option<&'a f32>),
    Columns([Strided; 6]),
}

/// The offsets of a sample's members.
const MEMBERS: [usize; 5] = [
    offset_of!(Sample, image_x),
    offset_of!(Sample, image_y),
    offset_of!(Sample, lens_u),
    offset_of!(Sample, lens_v),
    offset_of!(Sample, time),
];
/// Index of the column of wavelengths.
pub(crate) const WAVELENGTH: usize = 5;

impl<'a> Samples<'a> {
    /// Wraps one sample.
    #[inline(always)]
    pub fn of(sample: &'a Sample) -> Self {
        Self {
            source: SampleSource::One(sample, None),
            per_sample: 1,
            rays: 1,
            are_slices: true,
            borrow: PhantomData,
        }
    }

    /// Wraps an array of structures.
    #[inline(always)]
    pub fn structs(samples: &'a [Sample]) -> Self {
        let first = samples.as_ptr();
        let mut columns = [Strided::NONE; 6];
        for (column, offset) in columns.iter_mut().zip(MEMBERS) {
            let member = first.wrapping_byte_add(offset).cast::<f32>().cast_mut();
            *column = Strided::new(member, size_of::<Sample>() as isize);
        }
        let are_slices = samples.len() == 1;
        Self {
            source: SampleSource::Columns(columns),
            per_sample: 1,
            rays: samples.len(),
            are_slices,
            borrow: PhantomData,
        }
    }

    /// Wraps slices, in the order image x, image y, lens u, lens v, time.
    ///
    /// # Panics
    /// The slices differ in length.
    #[inline(always)]
    pub fn columns(slices: [&'a [f32]; 5]) -> Self {
        let rays = slices[0].len();
        let mut columns = [Strided::NONE; 6];
        for (column, slice) in columns.iter_mut().zip(slices) {
            assert_eq!(slice.len(), rays, "the columns of samples must have one length");
            *column = Strided::new(slice.as_ptr().cast_mut(), size_of::<f32>() as isize);
        }
        Self {
            source: SampleSource::Columns(columns),
            per_sample: 1,
            rays,
            are_slices: true,
            borrow: PhantomData,
        }
    }

    /// Adds wavelengths, nm: `k` per sample, beginning with those of the first sample.
    ///
    /// # Panics
    /// The number of wavelengths is not a multiple of the number of samples.
    #[inline(always)]
    pub fn at(self, wavelengths: &'a [f32]) -> Self {
        if let (SampleSource::One(sample, _), [wavelength]) = (self.source, wavelengths) {
            return Self { source: SampleSource::One(sample, Some(wavelength)), ..self };
        }
        let samples = self.rays / self.per_sample;
        let per_sample = wavelengths.len() / samples.max(1);
        assert!(
            per_sample * samples == wavelengths.len() && (per_sample > 0 || samples == 0),
            "the number of wavelengths must be a multiple of the number of samples"
        );
        let mut columns = self.all();
        columns[WAVELENGTH] = Strided::new(wavelengths.as_ptr().cast_mut(), size_of::<f32>() as isize);
        let are_slices = self.are_slices && per_sample == 1;
        let (per_sample, rays) = (per_sample.max(1), wavelengths.len());
        Self { source: SampleSource::Columns(columns), per_sample, rays, are_slices, borrow: PhantomData }
    }

    /// Adds `per_sample` wavelengths per sample, nm, unless the column is missing.
    ///
    /// # Safety
    /// All these wavelengths can be read for `'a`.
    #[inline(always)]
    pub unsafe fn raw_at(self, wavelengths: Strided, per_sample: usize) -> Self {
        if let (SampleSource::One(sample, _), 1, true) = (self.source, per_sample, wavelengths.is_slice(1)) {
            // SAFETY: promised by the caller; the number is aligned.
            let wavelength = unsafe { wavelengths.at(0).as_ref() };
            return Self { source: SampleSource::One(sample, wavelength), ..self };
        }
        let [x, y, u, v, time, _] = self.all();
        // SAFETY: the columns are those of this value; the caller promises the wavelengths.
        unsafe { Self::raw([x, y, u, v, time, wavelengths], per_sample, self.rays * per_sample) }
    }

    /// Wraps columns of samples and, unless the column of wavelengths is missing, `per_sample` wavelengths
    /// per sample.
    ///
    /// # Safety
    /// `rays / per_sample` numbers of each column of samples, and `rays` wavelengths, can be read for `'a`.
    #[inline(always)]
    pub unsafe fn raw(columns: [Strided; 6], per_sample: usize, rays: usize) -> Self {
        let mut are_slices = per_sample == 1;
        for column in columns {
            are_slices &= !column.is_there() || column.is_slice(rays);
        }
        Self { source: SampleSource::Columns(columns), per_sample, rays, are_slices, borrow: PhantomData }
    }

    /// Returns the number of rays, `k` per sample.
    #[inline(always)]
    pub fn len(&self) -> usize {
        self.rays
    }

    /// Whether there are no samples.
    pub fn is_empty(&self) -> bool {
        self.rays == 0
    }

    /// Returns all columns: the members of a sample, then the wavelengths, which may be missing.
    #[inline(always)]
    fn all(&self) -> [Strided; 6] {
        match self.source {
            SampleSource::Columns(columns) => columns,
            SampleSource::One(sample, wavelength) => {
                let member = |offset| {
                    Strided::new(ptr::from_ref(sample).wrapping_byte_add(offset).cast::<f32>().cast_mut(), 0)
                };
                let [x, y, u, v, time] = MEMBERS.map(member);
                let first = |number: &f32| ptr::from_ref(number).cast_mut();
                [x, y, u, v, time, Strided::new(wavelength.map_or(ptr::null_mut(), first), 0)]
            }
        }
    }

    /// Returns the sample to which a ray belongs.
    ///
    /// # Panics
    /// `ray` is not less than [`Samples::len`].
    pub fn get(&self, ray: usize) -> Sample {
        assert!(ray < self.rays, "no such ray");
        let [x, y, u, v, time, _] = self.all();
        // SAFETY: by the assertion, the sample exists.
        let [image_x, image_y, lens_u, lens_v, time] =
            [x, y, u, v, time].map(|column| unsafe { column.get(ray / self.per_sample) });
        Sample { image_x, image_y, lens_u, lens_v, time }
    }

    /// Returns the wavelength of a ray, nm; `None` for the camera's own.
    ///
    /// # Panics
    /// `ray` is not less than [`Samples::len`].
    pub fn wavelength(&self, ray: usize) -> Option<f32> {
        assert!(ray < self.rays, "no such ray");
        // SAFETY: by the assertion, the wavelength exists.
        self.have_wavelengths().then(|| unsafe { self.all()[WAVELENGTH].get(ray) })
    }

    /// Whether rays have wavelengths of their own.
    #[inline(always)]
    pub(crate) fn have_wavelengths(&self) -> bool {
        match &self.source {
            SampleSource::One(_, wavelength) => wavelength.is_some(),
            SampleSource::Columns(columns) => columns[WAVELENGTH].is_there(),
        }
    }

    /// Whether every column that is present is a slice with one number per ray.
    #[inline(always)]
    pub(crate) fn are_slices(&self) -> bool {
        self.are_slices
    }

    /// Returns a column that is present; the order is image x, image y, lens u, lens v, time, wavelengths.
    ///
    /// # Panics
    /// The column is missing or is not a slice.
    #[inline(always)]
    pub fn column(&self, number: usize) -> &[f32] {
        // Does not use `all`: a wide copy of addresses that were just stored one by one stalls on store
        // forwarding.
        let first = match &self.source {
            SampleSource::Columns(columns) => columns[number].at(0),
            SampleSource::One(..) => self.all()[number].at(0),
        };
        assert!(self.are_slices && !first.is_null(), "a column that is no slice");
        // SAFETY: the constructors guarantee a slice of `rays` numbers.
        unsafe { slice::from_raw_parts(first, self.rays) }
    }

    /// Loads a vector of a column's numbers, from ray `at` on.
    ///
    /// # Panics
    /// The column is missing, is not a slice, or is too short.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn load<L: Lanes>(&self, cpu: Cpu<L>, number: usize, at: usize) -> L {
        // A single sample needs no address arithmetic.
        if let (1, SampleSource::One(sample, wavelength)) = (L::WIDTH, self.source) {
            let Sample { image_x, image_y, lens_u, lens_v, time } = sample;
            let wavelength = wavelength.unwrap_or(image_x);
            let numbers = [image_x, image_y, lens_u, lens_v, time, wavelength];
            return L::load_single(cpu, slice::from_ref(numbers[number]));
        }
        L::load_single(cpu, &self.column(number)[at..])
    }

    /// Returns the sample of one ray, with its wavelength.
    #[inline(always)]
    pub fn part(&self, ray: usize) -> Self {
        assert!(ray < self.rays, "no such ray");
        let all = self.all();
        let mut columns = all.map(|column| column.from(ray / self.per_sample));
        columns[WAVELENGTH] = all[WAVELENGTH].from(ray);
        // SAFETY: the part is one element of these columns.
        unsafe { Self::raw(columns, 1, 1) }
    }

    /// Replaces one of the five columns of samples.
    ///
    /// # Panics
    /// The columns are not slices, or the new column differs in length.
    #[inline(always)]
    pub(crate) fn with_column<'b>(&self, number: usize, column: &'b [f32]) -> Samples<'b>
    where
        'a: 'b,
    {
        assert!(self.are_slices && column.len() == self.rays, "columns that are slices of one length");
        let mut columns = self.all();
        columns[number] = Strided::new(column.as_ptr().cast_mut(), size_of::<f32>() as isize);
        Samples { source: SampleSource::Columns(columns), borrow: PhantomData, ..*self }
    }

    /// Copies the samples of the rays from `first` on: image x and y, lens u and v, time, and the wavelength
    /// (0 if there is none).
    pub fn copy(&self, first: usize, to: &mut [&mut [f32]; 6]) {
        assert!(first + to[0].len() <= self.rays, "the rays end before");
        // SAFETY: by the assertion, the rays exist.
        unsafe {
            if self.per_sample == 1 {
                return read(&self.all(), first, to);
            }
            let columns = self.all();
            for (column, to) in columns[..WAVELENGTH].iter().zip(&mut *to) {
                (first..).zip(to.iter_mut()).for_each(|(i, to)| *to = column.get(i / self.per_sample));
            }
            read(&[columns[WAVELENGTH]], first, array::from_mut(&mut to[WAVELENGTH]));
        }
    }
}

/// Buffers for a block of samples, one per ray.
impl Columns<6> {
    /// Wraps the buffers as samples.
    pub fn samples(&self, count: usize, have_wavelengths: bool) -> Samples<'_> {
        let [x, y, u, v, time, wavelengths] = self.first(count);
        let samples = Samples::columns([x, y, u, v, time]);
        if have_wavelengths { samples.at(wavelengths) } else { samples }
    }
}

/// Builds the columns of four samples that share the lens and time sample of `sample` and differ in their
/// image points. The columns are stored as vectors, because vector loads of numbers that were just stored one
/// by one stall on store forwarding.
#[inline(always)]
pub fn at_points(sample: &Sample, image_x: [f32; 4], image_y: [f32; 4]) -> [[f32; 4]; 5] {
    let vectors = [
        Vec4::from_array(image_x),
        Vec4::from_array(image_y),
        Vec4::splat(sample.lens_u),
        Vec4::splat(sample.lens_v),
        Vec4::splat(sample.time),
    ];
    vectors.map(|vector| vector.to_array())
}
