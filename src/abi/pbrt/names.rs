//! The names that a scene gives a camera, and which of them are misspelt: the host tells that a parameter is not used,
//! and not which one it was meant to be.

use crate::camera::Parameters;

/// What to say of each name that is none of ours and near to one.
pub fn misspelt(set: &str) -> Vec<String> {
    let unknown = names(set).filter(|name| Parameters::find(name).is_none());
    let hint = |name: &str| {
        let nearest = Parameters::nearest(name)?;
        Some(format!("no parameter is called \"{name}\"; did you mean \"{nearest}\"?"))
    };
    unknown.filter_map(hint).collect()
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
    fn a_misspelt_name_is_told_with_the_one_that_it_was_meant_to_be() {
        let set = "\"integer xresolution\" [3 ] \"float fokusdistance\" [1 2 ] \"float fov\" [45 ] \
                   \"string pupli\" [\"rear\" ] \"string specfile\" [\"a\" \"b \\\" [c\" ] ";
        assert_eq!(
            names(set).collect::<Vec<_>>(),
            ["xresolution", "fokusdistance", "fov", "pupli", "specfile"]
        );
        let said = [
            "no parameter is called \"fokusdistance\"; did you mean \"focusdistance\"?",
            "no parameter is called \"pupli\"; did you mean \"pupil\"?",
        ];
        assert_eq!(misspelt(set), said);
        assert_eq!(misspelt(""), [""; 0]);
        assert_eq!(misspelt("\" [\" [] ["), [""; 0]);
    }
}
