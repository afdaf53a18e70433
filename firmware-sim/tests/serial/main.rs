//! Boards at a serial port: a pseudo-terminal, with the loop of a device in a thread behind it.

mod board;
mod commands;
mod failures;
mod port;
