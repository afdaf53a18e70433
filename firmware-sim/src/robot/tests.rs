//! What a robot's file says, what cannot be, and the robots of all worlds.

use super::*;
use crate::plants::toy::{ACTION_DIM, OBSERVATION_DIM, Units};
use crate::worlds::metaworld;

fn cart() -> Robot {
    Robot::parse(
        r#"
        name = "a cart on a rail"
        period_us = 33333
        max_observation_age_us = 66666

        [[observation]]
        name = "cart_x"
        unit = "m"
        range = [-1.2, 1.2]
        resolution = 0.001
        role = "x of cart"

        [[observation]]
        name = "cart_v"
        unit = "m/s"
        role = "velocity"

        [[action]]
        name = "throttle"
        range = [0, 1]
        slew_per_tick = 0.25
        on_fault = 0.5
        "#,
    )
    .unwrap()
}

fn refused(change: impl FnOnce(&mut Robot)) -> String {
    let mut robot = cart();
    change(&mut robot);
    robot.check().unwrap_err().to_string()
}

#[test]
fn the_robots_of_all_worlds_are_declared_and_can_be() {
    let arm = metaworld::robot();
    assert_eq!((arm.observation.len(), arm.action.len()), (39, 4));
    let toys = Units::ALL.map(Units::robot);
    for toy in &toys {
        assert_eq!(
            (toy.observation.len(), toy.action.len()),
            (OBSERVATION_DIM, ACTION_DIM)
        );
    }
    for robot in toys.into_iter().chain([arm]) {
        assert_eq!(robot.check(), Ok(()), "{}", robot.name);
        assert!(robot.declared());
    }
}

#[test]
fn what_is_written_is_what_is_read() {
    for robot in [cart(), metaworld::robot(), Robot::draft(3, &[[0.0, 2.0]])] {
        assert_eq!(Robot::parse(&robot.to_toml()).unwrap(), robot);
    }
}

#[test]
fn a_contract_says_what_the_file_says() {
    let robot = cart();
    let contract = robot
        .contract("balance", &[[-1.0, 1.0], [-9.0, 9.0]])
        .unwrap();
    assert!(contract.declared);
    assert_eq!(contract.control_period_us, 33_333);
    assert_eq!(contract.max_observation_age_us, 66_666);
    assert_eq!(contract.observation[1].high, 9.0);
    let throttle = &contract.action[0];
    assert_eq!((throttle.low, throttle.high), (0.0, 1.0));
    assert_eq!(throttle.slew_per_tick, 0.25);
    assert_eq!(throttle.on_fault, ted_policy::SafeAction::Value(0.5));
    assert_eq!(throttle.map().robot(-1.0), 0.0);
}

#[test]
fn a_channel_without_a_slew_limit_may_cross_its_range_in_a_tick() {
    let mut robot = cart();
    robot.action[0].slew_per_tick = None;
    robot.action[0].range = [-0.4, 0.4];
    robot.action[0].on_fault = OnFault::ZERO;
    let contract = robot.contract("x", &[[0.0, 1.0]; 2]).unwrap();
    assert_eq!(contract.action[0].slew_per_tick, 0.8);
}

#[test]
fn a_robot_with_a_guess_in_it_is_undeclared() {
    let mut robot = cart();
    robot.observation[1].guessed = vec![Fact::Unit];
    assert!(!robot.declared());
    assert_eq!(
        robot.guesses().collect::<Vec<_>>(),
        [(Some("cart_v"), Fact::Unit)]
    );
    assert!(!robot.contract("x", &[[0.0, 1.0]; 2]).unwrap().declared);
    assert!(!Robot::draft(1, &[[-1.0, 1.0]]).declared());
}

#[test]
fn a_draft_can_be_and_stops_where_zero_is_not_to_be_had() {
    let draft = Robot::draft(2, &[[-1.0, 1.0], [0.5, 1.0]]);
    assert_eq!(draft.check(), Ok(()));
    assert_eq!(draft.action[0].on_fault, OnFault::ZERO);
    assert_eq!(draft.action[1].on_fault, OnFault::HOLD);
}

#[test]
fn what_cannot_be_is_named_with_its_channel_and_a_way_out() {
    let cases: [(&str, String); 11] = [
        ("no name", refused(|r| r.name = " ".into())),
        ("period_us of the robot is 0", refused(|r| r.period_us = 0)),
        (
            "max_observation_age_us of the robot is 100",
            refused(|r| r.max_observation_age_us = 100),
        ),
        (
            "0 action channels, and a controller has room for 1 to",
            refused(|r| r.action.clear()),
        ),
        (
            "observation channel 1 (counted from 0) has no name",
            refused(|r| r.observation[1].name.clear()),
        ),
        (
            "two observation channels are called \"cart_x\"",
            refused(|r| r.observation[1].name = "cart_x".into()),
        ),
        (
            "range of cart_x is [1, 1]",
            refused(|r| r.observation[0].range = Some([1.0, 1.0])),
        ),
        (
            "resolution of cart_x is 0",
            refused(|r| r.observation[0].resolution = Some(0.0)),
        ),
        (
            "range of throttle is [0, inf]",
            refused(|r| r.action[0].range[1] = f32::INFINITY),
        ),
        (
            "slew_per_tick of throttle is -1",
            refused(|r| r.action[0].slew_per_tick = Some(-1.0)),
        ),
        (
            "on_fault of throttle is 2: it must be inside the channel's range, or \"hold\"",
            refused(|r| r.action[0].on_fault = OnFault::Value(2.0)),
        ),
    ];
    for (expected, text) in cases {
        assert!(text.contains(expected), "{expected}: {text}");
    }
    let text = refused(|r| r.observation[1].role = r.observation[0].role.clone());
    assert!(
        text.starts_with("cart_v and cart_x are both the x of cart"),
        "{text}"
    );
    let text = refused(|r| {
        r.action[0].range = [0.5, 1.0];
        r.action[0].on_fault = OnFault::ZERO;
    });
    assert!(text.contains("on_fault of throttle is 0"), "{text}");
}

#[test]
fn a_file_that_is_no_robot_says_the_line_and_what_there_is() {
    let wrong = |from: &str, to: &str| {
        let text = cart().to_toml().replace(from, to);
        Robot::parse(&text).unwrap_err().to_string()
    };
    let text = wrong("\"x of cart\"", "\"w of cart\"");
    assert!(
        text.contains("no role is called \"w of cart\": there are"),
        "{text}"
    );
    let text = wrong("on_fault = 0.5", "on_fault = \"stop\"");
    assert!(
        text.contains("on_fault is \"zero\", \"hold\"") && text.contains("line"),
        "{text}"
    );
    let text = wrong("period_us = 33333", "period = 33333");
    assert!(text.contains("unknown field `period`"), "{text}");
}
