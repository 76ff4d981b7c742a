//! The effects of distributed ray tracing, each of which is optional (R. L. Cook, T. Porter and L. Carpenter,
//! "Distributed Ray Tracing", *Computer Graphics* 18(3), SIGGRAPH 1984).

use clap::ValueEnum;
use std::fmt::{self, Display};
use std::str::FromStr;

/// An effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Effect {
    /// Reflections spread by rough surfaces.
    Gloss,
    /// Objects seen through rough glass, spread by it.
    Translucency,
    /// Penumbras, by a light that has an extent.
    SoftShadow,
    /// Depth of field, at the requested stop; without it the lens is stopped down.
    Dof,
    /// Motion blur, by balls that move while the shutter is open.
    Motion,
}

/// The effects of a picture; without any effect, the picture is made by classical ray tracing.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Effects(Vec<Effect>);

impl Effects {
    /// Makes a set of only these effects.
    pub fn only(effects: &[Effect]) -> Self {
        Self(effects.into())
    }

    /// Whether the set has the effect.
    pub fn has(&self, effect: Effect) -> bool {
        self.0.contains(&effect)
    }
}

impl Display for Effects {
    /// Writes the names separated by commas, in declaration order.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let names: Vec<String> = Effect::value_variants()
            .iter()
            .filter(|effect| self.has(**effect))
            .filter_map(|effect| effect.to_possible_value().map(|value| value.get_name().to_owned()))
            .collect();
        f.write_str(if names.is_empty() { "none".to_owned() } else { names.join(",") }.as_str())
    }
}

impl FromStr for Effects {
    type Err = String;

    /// Parses names separated by commas, or "none" or "all".
    fn from_str(text: &str) -> Result<Self, String> {
        let named = |name: &str| {
            Effect::from_str(name.trim(), false).map_err(|_| {
                format!(
                    "there is no effect \"{name}\"; write some of gloss, translucency, soft-shadow, dof \
                     and motion with commas between them, or none, or all"
                )
            })
        };
        match text {
            "none" => Ok(Self::only(&[])),
            "all" => Ok(Self::only(Effect::value_variants())),
            names => names.split(',').map(named).collect::<Result<_, _>>().map(Self),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wrong_effect_is_answered_with_the_right_names() {
        assert_eq!("gloss, motion".parse(), Ok(Effects::only(&[Effect::Gloss, Effect::Motion])));
        assert_eq!("none".parse(), Ok(Effects::only(&[])));
        let all: Effects = "all".parse().unwrap();
        assert!(Effect::value_variants().iter().all(|effect| all.has(*effect)));
        for wrong in ["", "glos", "gloss,", "gloss;motion", "gloss,none"] {
            let message = wrong.parse::<Effects>().unwrap_err();
            assert!(message.contains("soft-shadow"), "{message}");
        }
    }
}
