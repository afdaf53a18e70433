//! Which numbers of an observation are places in space, and what the others are called. It is the task that says so; where nobody
//! declared anything, every number is a plot.

use std::time::Duration;

use firmware_sim::plants::metaworld;
use firmware_sim::plants::toy::{self, Units};
use firmware_sim::tasks;
use serde::Serialize;

use crate::contract::{ContractText, channel_text};
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
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Position {
    /// What is there.
    pub name: &'static str,
    /// How it is drawn.
    pub mark: Mark,
    /// x, y and z, which points up.
    pub axes: [Option<usize>; 3],
}

/// What the numbers of a dataset are.
#[derive(Clone, Debug)]
pub struct Channels {
    /// Places in space.
    pub positions: Vec<Position>,
    /// Channels that are plotted, with name and unit.
    pub plots: Vec<(usize, String, &'static str)>,
    /// Names of the actions' channels.
    pub actions: Vec<String>,
    /// Time from one step to the next.
    pub period: Duration,
}

/// Time from one step to the next where nobody declared one.
const PERIOD: Duration = Duration::from_millis(50);

impl Channels {
    /// Those of a dataset, by the task that it says it is of.
    #[must_use]
    pub fn of(dataset: &Dataset) -> Self {
        let dims = dataset.observation_dim();
        let text = ContractText::new(dataset);
        let actions = match text.contract() {
            Ok(contract) => (contract.action.iter())
                .map(|channel| channel.name.to_string())
                .collect(),
            Err(_) => (0..dataset.action_dim())
                .map(|i| format!("action_{i}"))
                .collect(),
        };
        let declared = dataset.task().and_then(|task| Declared::of(task, dims));
        let (positions, repeated, micros): (&[Position], _, _) = match declared {
            Some(Declared::MetaWorld) => (&META_WORLD, 18..36, Some(metaworld::CONTROL_PERIOD_US)),
            Some(Declared::Toy) => (&TOY, 0..0, Some(toy::CONTROL_PERIOD_US)),
            None => (&[], 0..0, None),
        };
        let positions: Vec<Position> = (positions.iter().copied())
            .filter(|position| ever_moves(dataset, position))
            .collect();
        let in_space = |channel: &usize| {
            let mut axes = positions.iter().flat_map(|it| it.axes);
            axes.any(|axis| axis == Some(*channel))
        };
        let plots = (0..dims)
            .filter(|channel| !repeated.contains(channel) && !in_space(channel))
            .map(|channel| {
                let (name, unit) = channel_text(channel, dims);
                (channel, name, unit)
            })
            .collect();
        Self {
            plots,
            actions,
            period: micros.map_or(PERIOD, |micros| Duration::from_micros(micros.into())),
            positions,
        }
    }
}

/// Numbers in an observation of Meta-World: 18 of now, 18 of the step before, and the goal.
const META_WORLD_DIM: usize = 39;

/// Tasks that say what their channels are.
enum Declared {
    MetaWorld,
    Toy,
}

impl Declared {
    fn of(task: &str, dims: usize) -> Option<Self> {
        if tasks::single(task).is_ok() && dims == META_WORLD_DIM {
            Some(Self::MetaWorld)
        } else if Units::of_task(task).is_some() && dims == toy::OBSERVATION_DIM {
            Some(Self::Toy)
        } else {
            None
        }
    }
}

/// A thing that a task does not have stands at 0 for ever.
fn ever_moves(dataset: &Dataset, position: &Position) -> bool {
    let dims = dataset.observation_dim();
    let mut rows = dataset.observations().chunks_exact(dims);
    rows.any(|row| position.axes.iter().flatten().any(|&axis| row[axis] != 0.0))
}

const fn space(name: &'static str, mark: Mark, first: usize) -> Position {
    Position {
        name,
        mark,
        axes: [Some(first), Some(first + 1), Some(first + 2)],
    }
}

const fn table(name: &'static str, mark: Mark, first: usize) -> Position {
    Position {
        name,
        mark,
        axes: [Some(first), Some(first + 1), None],
    }
}

/// Of Meta-World's 39 numbers.
const META_WORLD: [Position; 4] = [
    space("goal", Mark::Cross, 36),
    space("object", Mark::Square, 4),
    space("second object", Mark::Triangle, 11),
    space("hand", Mark::Circle, 0),
];

/// Of the toy's 5 numbers.
const TOY: [Position; 2] = [
    table("goal", Mark::Cross, 2),
    table("point", Mark::Circle, 0),
];
