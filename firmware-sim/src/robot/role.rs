//! What a number of an observation is to somebody who looks at the robot: the page that asks questions draws from it.

use std::fmt;

use serde::{Deserialize, Serialize};

/// The meaning of an observation channel, as far as a picture needs it.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub enum Role {
    /// Nothing in space: it is plotted.
    #[default]
    None,
    /// A coordinate of a point. The first point of a robot is what acts; one that is called `goal` is where something is to go.
    Place {
        /// Which coordinate.
        axis: Axis,
        /// What is there, such as `hand`.
        point: String,
    },
    /// An angle.
    Angle,
    /// How far a gripper is open.
    Gripper,
    /// A speed.
    Velocity,
    /// What another channel was a step before: it is not shown.
    Earlier,
}

/// A direction; z points up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    /// To the right.
    X,
    /// To the back.
    Y,
    /// Up.
    Z,
}

/// The roles that are one word.
const WORDS: [(&str, Role); 5] = [
    ("none", Role::None),
    ("angle", Role::Angle),
    ("gripper", Role::Gripper),
    ("velocity", Role::Velocity),
    ("earlier", Role::Earlier),
];

impl Role {
    /// Whether there is nothing to draw.
    #[must_use]
    pub fn is_none(&self) -> bool {
        *self == Self::None
    }
}

impl TryFrom<String> for Role {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        if let Some((_, role)) = WORDS.iter().find(|(word, _)| *word == text) {
            return Ok(role.clone());
        }
        let axis = |letter: &str| match letter {
            "x" => Some(Axis::X),
            "y" => Some(Axis::Y),
            "z" => Some(Axis::Z),
            _ => None,
        };
        let place = text.split_once(" of ");
        match place.and_then(|(letter, point)| Some((axis(letter)?, point.trim()))) {
            Some((axis, point)) if !point.is_empty() => Ok(Self::Place {
                axis,
                point: point.to_owned(),
            }),
            _ => Err(format!(
                "no role is called {text:?}: there are \"x of hand\" (x, y or z of any point), \"angle\", \"gripper\", \
                 \"velocity\", \"earlier\" (another channel a step before) and \"none\""
            )),
        }
    }
}

impl From<Role> for String {
    fn from(role: Role) -> Self {
        role.to_string()
    }
}

impl fmt::Display for Role {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Self::Place { axis, point } = self {
            let axis = match axis {
                Axis::X => "x",
                Axis::Y => "y",
                Axis::Z => "z",
            };
            return write!(f, "{axis} of {point}");
        }
        let word = WORDS.iter().find(|(_, role)| role == self);
        f.write_str(word.map_or("none", |(word, _)| word))
    }
}
