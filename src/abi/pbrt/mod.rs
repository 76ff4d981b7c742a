//! The entry point of a pbrt-v1 host, `CreateCamera`, which takes the host's parameters, transform and film,
//! and returns a camera with the layout of the host's cameras. `shim` reads the host's objects. The host
//! warns of an unused parameter but does not suggest the intended name, so this module finds misspelt names
//! ([`misspelt`]). The cameras, and the functions through which the host calls them, are in `abi/object`.

mod shim;

use std::{ffi::c_void, path::Path, ptr::null_mut};

use super::{
    boundary::{self, Failure, realistic_status},
    library,
    object::{self, Handle, HostPart},
    options,
    types::realistic_camera,
};
use ::realistic_camera::{
    CameraError, CameraToWorld, Host, Kind, Level, Model, PARAMETERS, ParameterError, Parameters, Value,
};
use realistic_base::message::bounded;
use shim::{Given, HostKind, ParamSet};

/// Makes a camera for a pbrt-v1 host: takes the host's `const ParamSet &`, `const Transform &` (world to camera) and
/// `Film *`, and returns the host's `Camera *`.
///
/// The host calls the camera through its vtable and frees it with `delete`, which also deletes the film. On
/// failure the function passes the reason to the host's error function and returns NULL; the host then still
/// owns the film.
///
/// # Safety
/// Each of the three pointers is NULL or points to an object of a pbrt-v1 host in this process, with the
/// layout of version 1.05.
#[unsafe(no_mangle)]
#[allow(non_snake_case)]
pub unsafe extern "C" fn CreateCamera(
    params: *const c_void,
    world2cam: *const c_void,
    film: *mut c_void,
) -> *mut realistic_camera {
    // SAFETY: the caller's promise.
    boundary::catch(|| unsafe { create(params, world2cam, film) }).unwrap_or_else(|failure| {
        boundary::remember(&failure);
        // Reports line by line, because the host prints each message with its own prefix.
        for line in bounded(&failure.message).lines() {
            report(Level::Error, line);
        }
        null_mut()
    })
}

/// Note on a directory that a user of the host may expect to be searched for lens files, but which is not
/// searched.
const NOT_SEEN: &str = " (a scene's SearchPath cannot be seen from a plugin)";

/// Warning about `crop`. A camera cannot choose the pixels that a pbrt-v1 host renders; the host's film
/// chooses them and requests samples only for those pixels.
const CROP: &str = "\"crop\" is not used by pbrt, whose film says what to render: give it \"float cropwindow\" [x-from \
                    x-to y-from y-to], parts of the picture from 0 to 1";

/// Warning about `af_zones`, which some course scenes specify for a host that has autofocus.
const AF_ZONES: &str = "\"af_zones\" is not used: this host offers no autofocus; give \"focus_distance\" (units of \
                        camera space from the film) or \"film_distance\" (mm)";

/// # Safety
/// The promises of [`CreateCamera`].
unsafe fn create(
    params: *const c_void,
    world2cam: *const c_void,
    film: *mut c_void,
) -> Result<*mut realistic_camera, Failure> {
    boundary::memory_to_build()?;
    let null = |what| Failure::new(realistic_status::NullPointer, format!("the host gave no {what}"));
    // SAFETY: the caller's promise, for each of the three.
    let (params, transform, resolution) = unsafe {
        (
            ParamSet::new(params).ok_or_else(|| null("parameters"))?,
            shim::transform(world2cam).ok_or_else(|| null("transform"))?,
            shim::film_resolution(film).ok_or_else(|| null("film"))?,
        )
    };
    let set = params.text().unwrap_or_default();
    let mut parameters = read_parameters(&params, &set)?;
    for name in misspelt(&set) {
        // A name that is looked up counts as used, so the host does not warn about it a second time.
        if !given(&params, name)?.is_empty() {
            report(Level::Warning, &Parameters::unknown(name).to_string());
        }
    }
    if parameters.crop.is_some() {
        report(Level::Warning, CROP);
    }
    if params.find("af_zones", HostKind::String)?.is_some() {
        report(Level::Warning, AF_ZONES);
    }
    if parameters.model.is_none() {
        parameters.model = library::plugin_path().as_deref().and_then(model_named);
    }
    let (xres, yres) = resolution;
    let mut host = Host::new(options::raster(xres, yres)?, library::plugin_directory());
    let to_world = CameraToWorld::from_rows_and_inverse(&transform.inverse, &transform.matrix);
    host.to_world = to_world.map_err(CameraError::from)?.into();
    host.can_redraw = false;
    let scene = shim::scene_file();
    host.search = host.search.first(scene.as_deref().and_then(Path::parent)).without(NOT_SEEN);
    let handle = Handle::build(None, &parameters, &host, &mut report)?;
    let host = HostPart::of(handle.camera(), film, transform.matrix, transform.inverse);
    object::new(handle, &host).ok_or_else(boundary::out_of_memory)
}

/// Reports a message through the host, with the library's name in front.
fn report(level: Level, text: &str) {
    shim::message(level, &format!("realistic: {text}"));
}

/// Returns the model after which the file is named: "environment" for `environment.so`.
fn model_named(plugin: &Path) -> Option<Model> {
    plugin.file_stem()?.to_str()?.parse().ok()
}

/// Reads every parameter of this library from the host. Only these names are looked up, so that the host
/// counts all others as unused and reports them. `set` is the text of the parameter set.
fn read_parameters(params: &ParamSet<'_>, set: &str) -> Result<Parameters, Failure> {
    let mut parameters = Parameters::default();
    let mut complaints: Vec<String> = of_foreign_types(set).collect();
    for row in PARAMETERS {
        for name in row.names() {
            match read_one(params, name, row.kind, &mut parameters)? {
                Ok(()) => {}
                Err(complaint) => complaints.push(complaint),
            }
        }
    }
    if complaints.is_empty() { Ok(parameters) } else { Err(Failure::invalid(complaints.join("\n"))) }
}

/// Reads one parameter. The outer error ends the whole reading; the inner error concerns this parameter only.
///
/// The host keeps a separate set for each kind and finds a name only in the set of its kind, so every set is
/// searched. A value of another kind is accepted if its meaning is unambiguous: an integer for a number, or a
/// string as on the command line (`--param NAME=TEXT`).
fn read_one(
    params: &ParamSet<'_>,
    name: &'static str,
    kind: Kind,
    parameters: &mut Parameters,
) -> Result<Result<(), String>, Failure> {
    let values = match given(params, name)?[..] {
        [] => return Ok(Ok(())),
        [(_, values)] => values,
        [(first, _), (second, _), ..] => {
            let [first, second] = [first, second].map(HostKind::word);
            return Ok(Err(format!(
                "parameter \"{name}\" is given as \"{first}\" and as \"{second}\"; give one of them"
            )));
        }
    };
    let is_four = kind == Kind::Four && matches!(values, Given::Floats(_) | Given::Integers(_));
    let (takes, in_words) = if is_four { (4, "four") } else { (1, "one") };
    if values.count() != takes {
        let count = values.count();
        return Ok(Err(format!("parameter \"{name}\" is given {count} values; it takes {in_words}")));
    }
    let set = match values {
        Given::Floats(&[x0, x1, y0, y1]) => {
            parameters.set(name, Value::Four([x0, x1, y0, y1].map(as_written)))
        }
        Given::Integers(&[x0, x1, y0, y1]) => {
            parameters.set(name, Value::Four([x0, x1, y0, y1].map(f64::from)))
        }
        Given::Floats(numbers) => parameters.set(name, Value::Float(as_written(numbers[0]))),
        Given::Integers(numbers) => parameters.set(name, Value::Float(numbers[0].into())),
        Given::Bools(_, truth) => parameters.set(name, Value::Bool(truth)),
        Given::Strings(_, bytes) => match std::str::from_utf8(bytes) {
            Ok(text) => parameters.set_from_text(name, text),
            Err(_) => return Ok(Err(format!("parameter \"{name}\" is not UTF-8 text"))),
        },
    };
    Ok(set.map_err(|error| match error {
        ParameterError::Kind { .. } => format!("{error}; write \"{} {name}\"", host_kind(kind).word()),
        error => error.to_string(),
    }))
}

/// Returns the host's values under a name, with the kind of each.
fn given<'a>(params: &ParamSet<'a>, name: &str) -> Result<Vec<(HostKind, Given<'a>)>, Failure> {
    let mut found = Vec::new();
    for kind in HostKind::ALL {
        found.extend(params.find(name, kind)?.map(|values| (kind, values)));
    }
    Ok(found)
}

/// Returns the kind of a scene file's value that corresponds to a kind of this library.
fn host_kind(kind: Kind) -> HostKind {
    match kind {
        Kind::Float | Kind::Four => HostKind::Float,
        Kind::Text => HostKind::String,
        Kind::Bool => HostKind::Bool,
    }
}

/// Returns the number that the scene's author wrote. A host stores floats, and 35.1 as a float is 35.099998…
/// in double precision. C callers and the command line would pass the shortest decimal number that rounds to
/// this float; using it here makes the cameras agree.
fn as_written(number: f32) -> f64 {
    number.to_string().parse().unwrap_or_else(|_| f64::from(number))
}

/// Returns the names in a set that are unknown but similar to a known name.
fn misspelt(set: &str) -> impl Iterator<Item = &str> {
    let names = declarations(set).map(|(_, name)| name);
    names.filter(|name| Parameters::find(name).is_none() && Parameters::nearest(name).is_some())
}

/// Returns errors about known parameters that a set contains as points, textures or other types in which
/// names are not looked up.
fn of_foreign_types(set: &str) -> impl Iterator<Item = String> {
    let is_foreign = |kind: &str| HostKind::ALL.iter().all(|known| known.word() != kind);
    declarations(set).filter(move |(kind, _)| is_foreign(kind)).filter_map(|(kind, name)| {
        let row = Parameters::find(name)?;
        let (expected, word) = (row.kind.words(), host_kind(row.kind).word());
        Some(format!("parameter \"{name}\" takes {expected}, not a {kind}; write \"{word} {name}\""))
    })
}

/// Returns the types and names of the parameters in a set, whose text has the form of a scene file:
/// `"float fov" [45 ] "string pupil" ["rear" ]`.
fn declarations(set: &str) -> impl Iterator<Item = (&str, &str)> {
    const KINDS: [&str; 9] =
        ["integer", "bool", "float", "point", "vector", "normal", "color", "string", "texture"];
    set.split("\" [").filter_map(|before| {
        let (_, declaration) = before.rsplit_once('"')?;
        let (kind, name) = declaration.split_once(' ')?;
        (KINDS.contains(&kind) && !name.contains(char::is_whitespace)).then_some((kind, name))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_float_means_the_decimal_that_was_written() {
        for text in ["35.1", "0.1", "1e30", "50", "-0.001", "1e-40"] {
            assert_eq!(as_written(text.parse().unwrap()), text.parse::<f64>().unwrap(), "{text}");
        }
        assert!(as_written(f32::NAN).is_nan());
        assert_eq!(as_written(f32::INFINITY), f64::INFINITY);
    }

    #[test]
    fn a_file_name_tells_the_model() {
        assert_eq!(model_named(Path::new("/plugins/environment.so")), Some(Model::Environment));
        assert_eq!(model_named(Path::new("thin.so")), Some(Model::Thin));
        assert_eq!(model_named(Path::new("/lens/realistic.so")), None);
        assert_eq!(model_named(Path::new("librealistic.so")), None);
    }

    #[test]
    fn without_a_host_there_is_a_reason_and_no_camera() {
        let transform = [[0_usize; 2]; 1];
        // SAFETY: NULL parameters are refused before anything is read.
        let camera = unsafe { CreateCamera(std::ptr::null(), transform.as_ptr().cast(), null_mut()) };
        assert!(camera.is_null());
        let message = boundary::with_last_message(|text| text.to_str().unwrap().to_owned());
        assert_eq!(message.as_deref(), Some("the host gave no parameters"));
    }

    #[test]
    fn misspelt_names_are_found_among_those_of_a_scene() {
        let set = "\"integer xresolution\" [3 ] \"float fokusdistance\" [1 2 ] \"float fov\" [45 ] \
                   \"string pupli\" [\"rear\" ] \"string lens_file\" [\"a\" \"b \\\" [c\" ] ";
        assert_eq!(
            declarations(set).map(|(_, name)| name).collect::<Vec<_>>(),
            ["xresolution", "fokusdistance", "fov", "pupli", "lens_file"]
        );
        let misspelt = |set| misspelt(set).collect::<Vec<_>>();
        assert_eq!(misspelt(set), ["fokusdistance", "pupli"]);
        assert_eq!(misspelt("\"float foo\" [1 ] "), [""; 0]);
        assert_eq!(misspelt(""), [""; 0]);
        assert_eq!(misspelt("\" [\" [] ["), [""; 0]);
    }
}
