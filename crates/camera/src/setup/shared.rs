//! Data that cameras with the same lens share, whatever their focus: the lens as read, and its most recent
//! set-up.
//!
//! A camera keeps both ([`SharedLens`]). Another camera that is built from it reuses everything that depends
//! only on unchanged input and computes the rest, so that it is bit-identical to a camera built from scratch.
//! Two conditions are tested. If the lens is identified by the same description, nothing is read or checked
//! again. If its groups, wavelength and stop are unchanged, the surfaces, the bounds of aspheres, the
//! first-order optics and the start of focusing are reused. Messages are stored together with the data that
//! caused them and are logged again.

use std::sync::{Arc, OnceLock};

use crate::{host::Host, parameters::Parameters};
use realistic_base::message::{Level, Log};
use realistic_optics::{
    imaging::{
        focus::{Focus, FocusError},
        open::{OpenLens, StopSize, set_up},
    },
    lens::LensError,
    prescription::{Prescription, SearchPath},
};

/// A lens as read, and as set up.
#[derive(Clone, Debug)]
pub struct SharedLens {
    source: Arc<LensSource>,
    pub read: Arc<Prescription>,
    pub in_use: Arc<LensInUse>,
}

/// The source from which a lens is read.
#[derive(Debug, PartialEq)]
pub(super) struct LensSource {
    lens_file: Option<String>,
    glass_catalog: Option<String>,
    strict: Option<bool>,
    lens_text: Option<(String, Vec<u8>)>,
    search: SearchPath,
}

/// A lens with its groups in position, at a given wavelength and stop.
#[derive(Debug)]
pub struct LensInUse {
    pub prescription: Prescription,
    light: (f64, StopSize),
    pub optics: FocusableLens,
    messages: Vec<(Level, String)>,
}

/// A lens with its first-order optics and, once it has been computed, the start of its focusing.
#[derive(Clone, Debug)]
pub struct FocusableLens {
    pub lens: OpenLens,
    focus: OnceLock<Result<Focus, FocusError>>,
}

impl SharedLens {
    /// Returns the lens that the parameters describe: `read` reads it, and `place_lens` positions its groups
    /// at the wavelength and stop of `light`. Reuses the parts of the donor that depend only on unchanged
    /// input.
    pub fn of<E: From<LensError>>(
        (given, host): (&Parameters, &Host),
        donor: Option<&Self>,
        read: impl FnOnce() -> Result<Prescription, E>,
        place_lens: impl FnOnce(&Prescription, Log<'_>) -> Result<(Prescription, (f64, StopSize)), E>,
        log: Log<'_>,
    ) -> Result<Self, E> {
        let source = LensSource::of(given, host);
        let donor = donor.filter(|donor| *donor.source == source);
        let read = donor.map_or_else(|| read().map(Arc::new), |donor| Ok(donor.read.clone()))?;
        let (prescription, light) = place_lens(&read, log)?;
        let in_use = match donor.map(|donor| &donor.in_use) {
            Some(before) if before.light == light && before.prescription == prescription => {
                for (level, text) in &before.messages {
                    log(*level, text);
                }
                before.clone()
            }
            _ => Arc::new(LensInUse::new(prescription, light, log)?),
        };
        let source = donor.map_or_else(|| Arc::new(source), |donor| donor.source.clone());
        Ok(Self { source, read, in_use })
    }
}

impl LensSource {
    fn of(given: &Parameters, host: &Host) -> Self {
        Self {
            lens_file: given.lens_file.clone(),
            glass_catalog: given.glass_catalog.clone(),
            strict: given.strict,
            lens_text: host.lens_text.clone(),
            search: host.search.clone(),
        }
    }
}

impl LensInUse {
    fn new(prescription: Prescription, light: (f64, StopSize), log: Log<'_>) -> Result<Self, LensError> {
        let mut messages = Vec::new();
        let lens = set_up(&prescription, light.0, light.1, &mut |level, text| {
            log(level, text);
            messages.push((level, text.to_owned()));
        })?;
        Ok(Self { prescription, light, optics: lens.into(), messages })
    }
}

impl From<OpenLens> for FocusableLens {
    fn from(lens: OpenLens) -> Self {
        Self { lens, focus: OnceLock::new() }
    }
}

impl FocusableLens {
    /// Returns the start of the lens's focusing, which is computed on the first call.
    ///
    /// # Errors
    /// The lens cannot focus.
    pub fn focus(&self) -> Result<&Focus, FocusError> {
        let OpenLens { lens, first_order, beam } = &self.lens;
        let focus = self.focus.get_or_init(|| Focus::of(lens, first_order.clone()?, beam));
        focus.as_ref().map_err(Clone::clone)
    }
}
