//! Which numbers of an observation are places in space, and what the others are called: the roles of the robot's channels say so.
//! A number without a role is a plot.

use std::time::Duration;

use firmware_sim::robot::{Axis, Robot, Role};
use serde::Serialize;

use crate::dataset::Dataset;

/// How a place is drawn, so that colour is not all that tells them apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Mark {
    /// What acts.
    Circle,
    /// A thing.
    Square,
    /// Another thing.
    Triangle,
    /// Where something is to go.
    Cross,
}

/// A place in space: the channels that hold its coordinates, none for one that is always 0.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Position {
    /// What is there.
    pub name: String,
    /// How it is drawn.
    pub mark: Mark,
    /// x, y and z, which points up.
    pub axes: [Option<usize>; 3],
}

/// What the numbers of a dataset are.
#[derive(Clone, Debug)]
pub struct Channels {
    /// Places in space, what acts last, so that it is drawn over the others.
    pub positions: Vec<Position>,
    /// Channels that are plotted, with name and unit.
    pub plots: Vec<(usize, String, String)>,
    /// Names of the actions' channels.
    pub actions: Vec<String>,
    /// Time from one step to the next.
    pub period: Duration,
}

/// The point where something is to go.
const GOAL: &str = "goal";

impl Channels {
    /// Those of a dataset.
    #[must_use]
    pub fn of(dataset: &Dataset) -> Self {
        let robot = dataset.robot();
        let mut positions = places(robot);
        positions.retain(|position| ever_moves(dataset, position));
        positions.reverse();
        let sensors = robot.observation.iter().enumerate();
        let plots = sensors
            .filter(|(_, sensor)| !matches!(sensor.role, Role::Place { .. } | Role::Earlier))
            .map(|(channel, sensor)| (channel, sensor.name.clone(), sensor.unit.clone()))
            .collect();
        Self {
            positions,
            plots,
            actions: robot.action.iter().map(|it| it.name.clone()).collect(),
            period: Duration::from_micros(robot.period_us.into()),
        }
    }
}

/// The points of a robot, in the order in which it names them: what acts, things, and where they are to go.
fn places(robot: &Robot) -> Vec<Position> {
    let mut positions: Vec<Position> = Vec::new();
    for (channel, sensor) in robot.observation.iter().enumerate() {
        let Role::Place { axis, point } = &sensor.role else {
            continue;
        };
        let known = positions.iter().position(|it| it.name == *point);
        let place = known.unwrap_or_else(|| {
            let things = positions.iter().filter(|it| it.mark != Mark::Cross).count();
            positions.push(Position {
                name: point.clone(),
                mark: match (point.as_str(), things) {
                    (GOAL, _) => Mark::Cross,
                    (_, 0) => Mark::Circle,
                    (_, 1) => Mark::Square,
                    _ => Mark::Triangle,
                },
                axes: [None; 3],
            });
            positions.len() - 1
        });
        let axis = match axis {
            Axis::X => 0,
            Axis::Y => 1,
            Axis::Z => 2,
        };
        positions[place].axes[axis] = Some(channel);
    }
    positions
}

/// A thing that a task does not have stands at 0 for ever.
fn ever_moves(dataset: &Dataset, position: &Position) -> bool {
    let dims = dataset.observation_dim();
    let mut rows = dataset.observations().chunks_exact(dims);
    rows.any(|row| position.axes.iter().flatten().any(|&axis| row[axis] != 0.0))
}
