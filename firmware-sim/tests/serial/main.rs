//! Boards at a serial port: a pseudo-terminal, with the loop of a device in a thread behind it.

mod port;
