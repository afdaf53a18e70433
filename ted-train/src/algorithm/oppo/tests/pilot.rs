//! In the cockpit it does what it does at the desk, and nothing that a controller would not let through.

use firmware_sim::rollout::Pilot;
use firmware_sim::safety::{Fault, ObservationFrame};

use crate::algorithm::oppo::{Oppo, Player, SequencePilot};
use crate::contract::contract;
use crate::nn::Backend;
use crate::nn::fixtures::numbers;
use crate::rng::Seed;

use super::{config, dataset};

#[test]
fn it_acts_as_the_player_does_until_an_observation_is_not_to_be_flown_on() {
    let dataset = dataset();
    let oppo = Oppo::new(&config(), &dataset, Seed::root(6), Backend::Flex).unwrap();
    let contract = contract(&dataset).unwrap();
    let mut pilot = SequencePilot::new(&oppo, &contract);
    for _episode in 0..2 {
        pilot.reset().unwrap();
        let mut player = Player::new(&oppo);
        for tick in 0..8 {
            let seen = numbers(2, &format!("seen/{tick}"));
            // The sixth is beyond everything in the dataset, and what follows is flown by nobody.
            let values = if tick == 5 { vec![1e3, 0.0] } else { seen };
            let now = u64::from(contract.control_period_us) * u64::from(tick);
            let frame = ObservationFrame {
                sequence: tick,
                stamp_us: now,
                values: &values,
            };
            let (action, status) = pilot.tick(now, &frame).unwrap();
            assert_eq!(status.tick, tick);
            if tick < 5 {
                assert_eq!(status.fault, None);
                assert_eq!(action.as_slice(), player.act(&values));
            } else {
                assert_eq!(status.fault, Some(Fault::OutOfRange { index: 0 }));
                assert_eq!(action.as_slice(), [0.0]);
            }
        }
    }
}
