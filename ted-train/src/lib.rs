//! Preferences to policies: datasets, reward ensembles, TED, offline RL, evaluation, export, and the `ted` command.
#![doc = include_str!("../README.md")]

pub mod algorithm;
pub mod answers;
pub mod ask;
pub mod bench;
pub mod check;
pub mod checkpoint;
pub mod cli;
pub mod collect;
pub mod config;
pub mod contract;
pub mod crosscheck;
pub mod dataset;
pub mod doctor;
pub mod evaluate;
pub mod export;
pub mod filter;
pub mod fleet;
pub mod inspect;
pub mod nn;
pub mod preferences;
mod protobuf;
pub mod quantise;
pub mod quickstart;
mod ranking;
pub mod recording;
pub mod replay;
pub mod report;
pub mod reward;
pub mod rng;
pub mod robot;
pub mod run;
pub mod statistics;
pub mod study;
pub mod ted;
pub mod tolerance;
pub mod train;
