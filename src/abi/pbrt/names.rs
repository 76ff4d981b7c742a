//! The names that a scene gives a camera, and which of them are misspelt: the host warns that a parameter is not used,
//! and does not say which one it was meant to be.

use crate::camera::Parameters;

/// The names that are none of ours and near to one.
pub fn misspelt(set: &str) -> impl Iterator<Item = &str> {
    names(set).filter(|name| Parameters::find(name).is_none() && Parameters::nearest(name).is_some())
}

/// The names of a set as a scene file writes it: `"float fov" [45 ] "string pupil" ["rear" ]`.
fn names(set: &str) -> impl Iterator<Item = &str> {
    const KINDS: [&str; 9] =
        ["integer", "bool", "float", "point", "vector", "normal", "color", "string", "texture"];
    set.split("\" [").filter_map(|before| {
        let (_, declaration) = before.rsplit_once('"')?;
        let (kind, name) = declaration.split_once(' ')?;
        (KINDS.contains(&kind) && !name.contains(char::is_whitespace)).then_some(name)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn misspelt_names_are_found_among_those_of_a_scene() {
        let set = "\"integer xresolution\" [3 ] \"float fokusdistance\" [1 2 ] \"float fov\" [45 ] \
                   \"string pupli\" [\"rear\" ] \"string specfile\" [\"a\" \"b \\\" [c\" ] ";
        assert_eq!(
            names(set).collect::<Vec<_>>(),
            ["xresolution", "fokusdistance", "fov", "pupli", "specfile"]
        );
        let misspelt = |set| misspelt(set).collect::<Vec<_>>();
        assert_eq!(misspelt(set), ["fokusdistance", "pupli"]);
        assert_eq!(misspelt("\"float foo\" [1 ] "), [""; 0]);
        assert_eq!(misspelt(""), [""; 0]);
        assert_eq!(misspelt("\" [\" [] ["), [""; 0]);
    }
}
