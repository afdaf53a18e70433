//! Studies: the measurements behind the defaults, each a command that prints the table in the docs.

pub mod reward;
