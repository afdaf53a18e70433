//! Files of answers beside any run: what they say, what they would be used for, several as one, and those of other programs.

pub mod import;
mod merge;
mod survey;

pub use merge::{Merged, merge};
pub use survey::{About, AnswerText, ClipText, Survey};
