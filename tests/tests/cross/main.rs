//! What was trained is what flies: from datasets through training and the artefact to the controller and its plants.

mod binaries;
mod commands;
mod d4rl;
mod metaworld;
mod own_robot;
mod toy;
