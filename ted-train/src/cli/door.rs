//! Where a person answers: on a web page, or in the terminal.

use std::io::{BufReader, IsTerminal, stderr, stdin};
use std::path::PathBuf;

use clap::Args;
use firmware_sim::exit::ExitCode;
use firmware_sim::failure::Failure;
use firmware_sim::progress::{Audience, tell};

use super::failures::end;
use crate::ask::film;
use crate::ask::web::{End, Listen, Page};
use crate::ask::{Numbers, Session, Terminal, begin};
use crate::fleet::{Datasets, Lane};
use crate::run::{DatasetReference, PREFERENCES};
use crate::train::has_learned;

/// Who answers, and where.
#[derive(Debug, Args)]
pub(super) struct DoorArgs {
    /// Who answers, as every line of the log will say; the user's name if not given
    #[arg(long, value_name = "NAME")]
    by: Option<String>,
    /// Address of the page, with a port or without; 127.0.0.1 and any free port if not given
    #[arg(long, value_name = "ADDRESS")]
    listen: Option<Listen>,
    /// Ask in the terminal, with numbers and small curves
    #[arg(long, conflicts_with = "listen")]
    text: bool,
}

/// What comes after the answers.
#[derive(Clone, Copy)]
pub(super) enum Errand<'a> {
    /// The run goes on by itself.
    Train,
    /// Nothing: this is the command that goes on with so many answers.
    Ask(&'a dyn Fn(usize) -> String),
}

/// Characters of a name.
const NAME: usize = 80;

impl DoorArgs {
    /// Refuses a name that is none, and a door where nobody is asked.
    pub(super) fn check(&self, asked: bool) -> Result<(), Failure> {
        let given = self.by.is_some() || self.listen.is_some() || self.text;
        if given && !asked {
            let message = "--by, --listen and --text say how a person answers: add --ask";
            return Err(Failure::new(ExitCode::Usage, message));
        }
        let bad = |by: &String| {
            by.trim().is_empty() || by.len() > NAME || by.chars().any(char::is_control)
        };
        match self.by.as_ref().filter(|by| bad(by)) {
            Some(_) => Err(Failure::new(
                ExitCode::Usage,
                format_args!("--by takes a name of 1 to {NAME} characters"),
            )),
            None => Ok(()),
        }
    }

    fn by(&self) -> String {
        let user = || std::env::var("USER").ok().filter(|user| !user.is_empty());
        self.by
            .clone()
            .or_else(user)
            .unwrap_or_else(|| "me".to_owned())
    }
}

/// Asks a person what a run asks, and makes the run one that wants as many answers as they give. Returns the log with these. A run
/// that learned from its log already asks no more.
pub(super) fn door(
    lane: &mut Lane,
    datasets: &Datasets,
    args: &DoorArgs,
    errand: Errand<'_>,
    audience: Audience,
) -> Result<PathBuf, Failure> {
    let dataset = datasets.open(&lane.dataset).map_err(end)?;
    let reference = DatasetReference {
        id: dataset.id().to_owned(),
        digest: dataset.digest().to_owned(),
        path: lane.dataset.clone(),
    };
    let least = lane.config.answers();
    let folder;
    (folder, lane.config) = begin(&lane.folder, &lane.config, &reference).map_err(end)?;
    let log = folder.file(PREFERENCES);
    if matches!(errand, Errand::Train) && has_learned(&folder) {
        audience.note("the answers are in, and the run goes on");
        return Ok(log);
    }
    let by = args.by();
    let session = Session {
        dataset: &dataset,
        config: &lane.config,
        least,
        folder: &folder,
        by: &by,
        audience,
    };
    let clips = Numbers::of(&dataset);
    if args.text {
        let mut person = Terminal::new(BufReader::new(stdin()), stderr(), &clips);
        lane.config = session.hold(&mut person).map_err(end)?;
        return Ok(log);
    }
    let listen = args.listen.unwrap_or_default();
    let studio = film::studio(&dataset, &lane.dataset);
    let mut page = Page::open(listen, dataset.id(), &by, &clips, studio).map_err(end)?;
    welcome(&page, listen);
    let held = session.hold(&mut page);
    page.close(match &held {
        Ok(config) => match errand {
            Errand::Train => End::GoesOn,
            Errand::Ask(command) => End::Next(command(config.answers())),
        },
        Err(error) => End::Stopped(error.to_string()),
    });
    lane.config = held.map_err(end)?;
    Ok(log)
}

/// Says where the page is, also to those who asked for silence: nobody else can tell them.
fn welcome(page: &Page<'_>, listen: Listen) {
    if !listen.is_loopback() {
        tell(&format!(
            "warning: the page can be reached from other machines at {}, and what is sent can be read on the way. Whoever has the \
             address with its token can answer. A tunnel is safer: leave out --listen, and ssh -L",
            listen.0.ip()
        ));
    }
    let mark = if stderr().is_terminal() { "\n" } else { "" };
    tell(&format!("{mark}answer here: {}{mark}", page.address()));
}
