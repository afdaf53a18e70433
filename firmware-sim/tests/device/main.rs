//! A device at the end of a link: the same episodes, whatever the line does, and a policy in flash, whatever the power does.

mod artefacts;
mod drill;
mod flight;
mod host;
mod link;
mod scoring;
mod silence;
mod slots;
