//! As many boards of one kind as are asked for, each greeted over its link.

use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::time::Duration;

use super::{Board, Device, Emulator, Firmware, Link, QemuError};
use crate::progress::Audience;
use crate::remote::{Connection, LinkOptions, RemoteError};

/// How long an answer may take. Nothing gets lost between two processes, so only a board that computes is waited for.
const TIMEOUT: Duration = Duration::from_secs(20);

/// What is needed to start boards of one kind.
#[derive(Clone, Debug)]
pub struct Fleet {
    emulator: Emulator,
    firmware: Firmware,
    link: Link,
    flash_image: Option<PathBuf>,
}

impl Fleet {
    /// Looks for the emulator and the board's image, which may have to be built, and says so to the audience. With a file for the flash only one board
    /// can run at a time.
    ///
    /// # Errors
    /// When one of the two is not to be had.
    pub fn find(
        board: Board,
        link: Link,
        flash_image: Option<PathBuf>,
        audience: Audience,
    ) -> Result<Self, QemuError> {
        Ok(Self {
            emulator: Emulator::find()?,
            firmware: Firmware::find(board, audience)?,
            link,
            flash_image,
        })
    }

    /// The emulator.
    #[must_use]
    pub const fn emulator(&self) -> &Emulator {
        &self.emulator
    }

    /// The board.
    #[must_use]
    pub const fn board(&self) -> Board {
        self.firmware.board()
    }

    /// The link.
    #[must_use]
    pub const fn link(&self) -> Link {
        self.link
    }

    /// The file of their flash.
    #[must_use]
    pub fn flash_image(&self) -> Option<&Path> {
        self.flash_image.as_deref()
    }

    /// How many boards can run at once: one if it has a file for its flash.
    #[must_use]
    pub fn limit(&self) -> NonZeroUsize {
        match self.flash_image {
            Some(_) => NonZeroUsize::MIN,
            None => NonZeroUsize::MAX,
        }
    }

    /// Starts a board and greets it. It ends at the latest with this thread.
    ///
    /// # Errors
    /// When it does not start or does not answer.
    pub fn connect(&self) -> Result<Connection<Device>, RemoteError> {
        let device = self
            .emulator
            .start(&self.firmware, self.link, self.flash_image.as_deref())
            .map_err(|error| RemoteError::NoLink(error.into()))?;
        let options = LinkOptions {
            timeout: TIMEOUT,
            tries: 3,
            ..LinkOptions::default()
        };
        Connection::open(device, options)
    }
}
