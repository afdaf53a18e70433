//! What every learner learns from: transitions of each lane, on the host.

/// A batch on the host, lane after lane, rows in row-major order.
#[derive(Clone, Debug, Default)]
pub struct Batch {
    /// Standardised observations `[lane, batch, observation]`.
    pub observations: Vec<f32>,
    /// Standardised next observations `[lane, batch, observation]`.
    pub next_observations: Vec<f32>,
    /// Actions `[lane, batch, action]` in [-1, 1].
    pub actions: Vec<f32>,
    /// Rewards `[lane, batch]`.
    pub rewards: Vec<f32>,
    /// Discount of each transition `[lane, batch]`: `gamma(s, a)`, and 0 after a terminal.
    pub discounts: Vec<f32>,
    /// Which step of the dataset each row is `[lane, batch]`, for a learner that keeps a number for each.
    pub transitions: Vec<u32>,
    /// How good the episode of each row is `[lane, batch]`; nothing, unless what it was drawn from is conditioned.
    pub conditions: Vec<f32>,
}

impl Batch {
    /// The batches of several lanes as one.
    #[must_use]
    pub fn of_lanes(lanes: Vec<Self>) -> Self {
        let mut lanes = lanes.into_iter();
        let mut all = lanes.next().unwrap_or_default();
        for lane in lanes {
            all.observations.extend(lane.observations);
            all.next_observations.extend(lane.next_observations);
            all.actions.extend(lane.actions);
            all.rewards.extend(lane.rewards);
            all.discounts.extend(lane.discounts);
            all.transitions.extend(lane.transitions);
            all.conditions.extend(lane.conditions);
        }
        all
    }
}
