//! The effects of distributed ray tracing, each of which can be left out (R. L. Cook, T. Porter
//! and L. Carpenter, "Distributed Ray Tracing", *Computer Graphics* 18(3), SIGGRAPH 1984).

use std::str::FromStr;

/// Which of them a picture has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Effects {
    /// Reflections spread by rough surfaces.
    pub gloss: bool,
    /// What is seen through rough glass spread by it.
    pub translucency: bool,
    /// Penumbras, by a light that has an extent.
    pub soft_shadow: bool,
    /// Depth of field, by a lens at the stop asked for; without it the lens is stopped down.
    pub dof: bool,
    /// Motion blur, by balls that move while the shutter is open.
    pub motion: bool,
}

impl Effects {
    /// None of them: ray tracing as it was before.
    pub const NONE: Self =
        Self { gloss: false, translucency: false, soft_shadow: false, dof: false, motion: false };

    fn switch(&mut self, name: &str) -> Option<&mut bool> {
        Some(match name {
            "gloss" => &mut self.gloss,
            "translucency" => &mut self.translucency,
            "soft-shadow" => &mut self.soft_shadow,
            "dof" => &mut self.dof,
            "motion" => &mut self.motion,
            _ => return None,
        })
    }
}

impl FromStr for Effects {
    type Err = String;

    /// Names with commas between them, or "none" or "all".
    fn from_str(text: &str) -> Result<Self, String> {
        let mut effects = Self::NONE;
        let names = match text {
            "none" => return Ok(effects),
            "all" => "gloss,translucency,soft-shadow,dof,motion",
            names => names,
        };
        for name in names.split(',') {
            *effects.switch(name.trim()).ok_or_else(|| {
                format!(
                    "there is no effect \"{name}\"; write some of gloss, translucency, soft-shadow, dof \
                     and motion with commas between them, or none, or all"
                )
            })? = true;
        }
        Ok(effects)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn effects_go_by_name_and_a_wrong_name_is_told_the_right_ones() {
        let some: Effects = "gloss, motion".parse().unwrap();
        assert_eq!(some, Effects { gloss: true, motion: true, ..Effects::NONE });
        assert_eq!("none".parse(), Ok(Effects::NONE));
        let all: Effects = "all".parse().unwrap();
        assert!(all.gloss && all.translucency && all.soft_shadow && all.dof && all.motion);
        for wrong in ["", "glos", "gloss,", "gloss;motion", "gloss,none"] {
            let message = wrong.parse::<Effects>().unwrap_err();
            assert!(message.contains("soft-shadow"), "{message}");
        }
    }
}
