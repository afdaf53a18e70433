//! Ranges of the simulated teacher's numbers, and whether anything comes of them.

use crate::config::ranges::Table;
use crate::config::{Config, ConfigError};
use crate::preferences::{Says, TeacherConfig};

pub(super) fn teacher(config: &Config) -> Result<(), ConfigError> {
    let TeacherConfig {
        says,
        errs,
        tolerance,
        cannot_tell,
    } = config.teacher;
    let table = Table("teacher");
    table.share("errs", errs)?;
    table.not_negative("tolerance", tolerance)?;
    table.share("cannot_tell", cannot_tell)?;
    let name = says.name();
    let idle = if !config.asks() && !config.teacher.is_default() {
        "this run asks nobody: leave the teacher out, or choose a reward that is learned from answers".to_owned()
    } else if tolerance > 0.0 && !says.looks_at_rewards() {
        format!(
            "teacher.says = \"{name}\" looks at no returns, so nothing would come of teacher.tolerance: leave it out"
        )
    } else if errs > 0.0 && matches!(says, Says::Random | Says::Equal) {
        format!(
            "teacher.says = \"{name}\" is the same turned round, so nothing would come of teacher.errs: leave it out"
        )
    } else {
        return Ok(());
    };
    Err(ConfigError::Composition {
        choice: "teacher",
        reason: idle,
    })
}
