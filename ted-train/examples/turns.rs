//! Learners that take turns with those of other projects: `turns BACKEND LEARNERS THREADS` answers every line on standard
//! input, a number of updates, with the seconds they took. `tests/peers/train` is who asks.

use std::io::{self, BufRead, Write};

use ted_train::bench::{Learners, replay, synthetic};
use ted_train::nn::Backend;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [backend, learners, threads] = &arguments[..] else {
        return Err("give a backend, a number of learners and the threads of each".into());
    };
    let backend = match backend.as_str() {
        "fused" => Backend::Fused,
        "flex" => Backend::Flex,
        "ndarray" => Backend::Ndarray,
        other => return Err(format!("no backend {other}: fused, flex or ndarray").into()),
    };
    let dataset = synthetic()?;
    let replay = replay(&dataset);
    let mut learners = Learners::new(backend, learners.parse()?, threads.parse()?)?;
    for line in io::stdin().lock().lines() {
        println!("{}", learners.run(&replay, line?.trim().parse()?));
        io::stdout().flush()?;
    }
    Ok(())
}
