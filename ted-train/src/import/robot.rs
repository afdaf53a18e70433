//! The robot of a source: the one that somebody declared, or what the source says of it, and the rest guessed and marked as such.

use firmware_sim::robot::{Fact, Robot};

use super::reader::{Channel, Header};
use super::{ImportError, Seen};

/// So many names are read in a message.
const FEW: usize = 12;

/// The declared robot, if it has the channels of the source.
pub(super) fn fitting(robot: Robot, header: &Header) -> Result<Robot, ImportError> {
    let widths = [
        ("observation", robot.observation.len(), &header.observation),
        ("action", robot.action.len(), &header.action),
    ];
    for (kind, declared, found) in widths {
        if declared != found.len() {
            let mut names: Vec<_> = found.iter().map(|it| it.name.as_str()).collect();
            if names.len() > FEW {
                names.truncate(FEW);
                names.push("...");
            }
            return Err(ImportError::OtherRobot {
                robot: robot.name,
                kind,
                declared,
                found: found.len(),
                names: names.join(", "),
            });
        }
    }
    Ok(robot)
}

/// What the source says, with guesses.
pub(super) fn draft(header: &Header, seen: &Seen) -> Robot {
    let ranges: Vec<_> = (header.action.iter().zip(&seen.actions))
        .map(|(channel, seen)| declared(channel).unwrap_or_else(|| guess(*seen)))
        .collect();
    let mut robot = Robot::draft(header.observation.len(), &ranges);
    if let Some(period_us) = header.period_us {
        robot.period_us = period_us;
        robot.max_observation_age_us = period_us.saturating_mul(2);
        robot.guessed.retain(|fact| *fact != Fact::PeriodUs);
    }
    for (sensor, channel) in robot.observation.iter_mut().zip(&header.observation) {
        sensor.name.clone_from(&channel.name);
        sensor
            .guessed
            .retain(|fact| *fact != Fact::Name || numbered(&channel.name));
    }
    for (actuator, channel) in robot.action.iter_mut().zip(&header.action) {
        actuator.name.clone_from(&channel.name);
        actuator.guessed.retain(|fact| match fact {
            Fact::Name => numbered(&channel.name),
            Fact::Range => declared(channel).is_none(),
            _ => true,
        });
    }
    robot
}

/// Whether a name is nothing but a place in a list.
fn numbered(name: &str) -> bool {
    name.rsplit_once('_').is_some_and(|(stem, number)| {
        number.parse::<usize>().is_ok() && (stem.starts_with("obs") || stem.starts_with("action"))
    })
}

/// The bounds that a source gives a channel, if it gives both.
fn declared(channel: &Channel) -> Option<[f32; 2]> {
    let ends = [channel.low? as f32, channel.high? as f32];
    (ends[0] < ends[1]).then_some(ends)
}

/// The range that a robot most likely has whose actions were these: one of the two usual ones, or what was seen.
fn guess([low, high]: [f32; 2]) -> [f32; 2] {
    if low >= 0.0 && high <= 1.0 {
        [0.0, 1.0]
    } else if low >= -1.0 && high <= 1.0 {
        [-1.0, 1.0]
    } else if low < high {
        [low, high]
    } else {
        [low, low + 1.0]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_range_is_one_of_the_usual_ones_or_what_was_seen() {
        assert_eq!(guess([0.1, 0.9]), [0.0, 1.0]);
        assert_eq!(guess([-0.1, 0.9]), [-1.0, 1.0]);
        assert_eq!(guess([-2.5, 40.0]), [-2.5, 40.0]);
        assert_eq!(guess([3.0, 3.0]), [3.0, 4.0]);
    }

    #[test]
    fn a_number_in_a_list_is_no_name() {
        assert!(numbered("observation_3") && numbered("actions_0"));
        assert!(!numbered("joint_3") && !numbered("thruster_x"));
    }
}
