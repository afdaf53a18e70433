//! A plant that lies: it puts chosen faults between another plant and the controller.
//!
//! The plant inside goes on untouched, so what a fault does to an episode is what the controller did about it.

mod plan;

pub use plan::{FaultPlan, Injected, PlanError, When};

use crate::plant::{Observed, Plant, PlantError, StepOutcome};
use crate::splitmix::mix;

/// How far a false time stamp or a late tick is off: longer than any control period or observation age in use.
const OFF_US: u64 = 1_000_000;
/// A finite value outside any sensible range.
const FAR_OUT: f32 = 1.0e9;

/// Faults between a plant and its observer.
///
/// The clock starts at one second, not at zero, so that an old stamp can be told from the first one at any tick.
#[derive(Clone, Debug)]
pub struct FaultInjector<P> {
    plant: P,
    plans: Vec<FaultPlan>,
    seed: u64,
    episode_seed: u64,
    tick: u32,
    clock_shift_us: u64,
    sequence_shift: u32,
    present: Option<Observed>,
    previous: Option<Observed>,
}

impl<P: Plant> FaultInjector<P> {
    /// Puts the planned faults in front of `plant`; `seed` decides what the plans leave open.
    pub fn new(plant: P, plans: Vec<FaultPlan>, seed: u64) -> Self {
        Self {
            plant,
            plans,
            seed,
            episode_seed: 0,
            tick: 0,
            clock_shift_us: OFF_US,
            sequence_shift: 0,
            present: None,
            previous: None,
        }
    }

    /// The plant inside.
    pub fn inner(&self) -> &P {
        &self.plant
    }

    /// The number that decides, for this tick, whatever is left to chance.
    fn draw(&self) -> u64 {
        mix(mix(self.seed, self.episode_seed), u64::from(self.tick))
    }

    fn active(&self) -> impl Iterator<Item = Injected> + '_ {
        let draw = self.draw();
        let planned = self.plans.iter().zip(0..);
        let active =
            planned.filter(move |(plan, index)| plan.strikes(self.tick, mix(draw, *index)));
        active.map(|(plan, _)| plan.fault)
    }

    fn begin_tick(&mut self) {
        let late = self
            .active()
            .filter(|fault| *fault == Injected::Late)
            .count() as u64;
        let dropped = self
            .active()
            .filter(|fault| *fault == Injected::Dropped)
            .count() as u32;
        self.clock_shift_us += late * OFF_US;
        self.sequence_shift = self.sequence_shift.wrapping_add(dropped);
    }

    fn distort(&self, observed: &mut Observed, fault: Injected) {
        let dimensions = observed.values.len().max(1) as u64;
        let somewhere = observed.values.get_mut((self.draw() % dimensions) as usize);
        match (fault, somewhere) {
            (Injected::Nan, Some(value)) => *value = f32::NAN,
            (Injected::Infinite, Some(value)) => *value = f32::INFINITY,
            (Injected::OutOfRange, Some(value)) => *value = FAR_OUT,
            (Injected::WrongLength, _) => {
                observed.values.pop();
            }
            (Injected::Stale, _) => observed.stamp_us = observed.stamp_us.saturating_sub(OFF_US),
            (Injected::Future, _) => observed.stamp_us += OFF_US,
            (Injected::Duplicated, _) => {
                if let Some(previous) = &self.previous {
                    observed.clone_from(previous);
                }
            }
            (Injected::Nan | Injected::Infinite | Injected::OutOfRange, None)
            | (Injected::Dropped | Injected::Late, _) => {}
        }
    }
}

impl<P: Plant> Plant for FaultInjector<P> {
    fn reset(&mut self, seed: u64) -> Result<(), PlantError> {
        self.plant.reset(seed)?;
        self.episode_seed = seed;
        (self.tick, self.clock_shift_us, self.sequence_shift) = (0, OFF_US, 0);
        (self.present, self.previous) = (None, None);
        self.begin_tick();
        Ok(())
    }

    fn now_us(&self) -> u64 {
        self.plant.now_us() + self.clock_shift_us
    }

    fn observe(&mut self) -> Result<Observed, PlantError> {
        let mut observed = self.plant.observe()?;
        observed.sequence = observed.sequence.wrapping_add(self.sequence_shift);
        observed.stamp_us += self.clock_shift_us;
        self.present = Some(observed.clone());
        for fault in self.active() {
            self.distort(&mut observed, fault);
        }
        Ok(observed)
    }

    fn announce(&mut self, action_env: &[f32]) -> Result<(), PlantError> {
        self.plant.announce(action_env)
    }

    fn apply(&mut self, action_env: &[f32]) -> Result<StepOutcome, PlantError> {
        let outcome = self.plant.apply(action_env)?;
        self.previous = self.present.take();
        self.tick += 1;
        self.begin_tick();
        Ok(outcome)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plants::toy::ToyPlant;

    fn observed(plan: &str) -> (Observed, Observed) {
        let mut honest = ToyPlant::new();
        let mut lying = FaultInjector::new(ToyPlant::new(), vec![plan.parse().unwrap()], 3);
        honest.reset(1).unwrap();
        lying.reset(1).unwrap();
        lying.observe().unwrap();
        honest.apply(&[0.1; 3]).unwrap();
        lying.apply(&[0.1; 3]).unwrap();
        let mut truth = honest.observe().unwrap();
        truth.stamp_us += OFF_US;
        (truth, lying.observe().unwrap())
    }

    #[test]
    fn a_fault_changes_what_it_names_and_nothing_else() {
        let (truth, lie) = observed("nan@1");
        assert_eq!(lie.values.iter().filter(|value| value.is_nan()).count(), 1);
        assert_eq!(
            (lie.sequence, lie.stamp_us),
            (truth.sequence, truth.stamp_us)
        );
        let (truth, lie) = observed("wrong-length@1");
        assert_eq!(lie.values.len() + 1, truth.values.len());
        let (truth, lie) = observed("stale@1");
        assert_eq!(
            (lie.stamp_us + OFF_US, &lie.values),
            (truth.stamp_us, &truth.values)
        );
        let (truth, lie) = observed("dropped@1");
        assert_eq!(
            (lie.sequence, &lie.values),
            (truth.sequence + 1, &truth.values)
        );
    }

    #[test]
    fn a_duplicated_frame_is_the_one_before() {
        let (truth, lie) = observed("duplicated@1");
        assert_eq!(
            (lie.sequence + 1, lie.stamp_us + 10_000),
            (truth.sequence, truth.stamp_us)
        );
    }

    #[test]
    fn nothing_is_changed_at_other_ticks() {
        let (truth, seen) = observed("nan@2");
        assert_eq!(truth, seen);
    }

    #[test]
    fn observing_twice_shows_the_same_lie() {
        let mut plant = FaultInjector::new(
            ToyPlant::new(),
            vec!["out-of-range~0.5".parse().unwrap()],
            3,
        );
        plant.reset(1).unwrap();
        for _ in 0..20 {
            assert_eq!(plant.observe().unwrap(), plant.observe().unwrap());
            plant.apply(&[0.0; 3]).unwrap();
        }
    }
}
