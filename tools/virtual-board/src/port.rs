//! The board's USB cable: its serial port as a pseudo-terminal of this machine, which can be pulled out and plugged in again.

use std::io::{ErrorKind, Read, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;

use anyhow::Context;
use serialport::{SerialPort, TTYPort};

/// A port that programs open by its name.
pub struct Port {
    /// Both ends, while the cable is plugged in. The far one stays open here, too: a program that closes the port is no reason to
    /// lose it.
    ends: Option<(TTYPort, TTYPort)>,
    link: Option<PathBuf>,
}

impl Port {
    /// Plugs the cable in. Under `link` the port keeps its name when it is plugged in again.
    ///
    /// # Errors
    /// The machine has no pseudo-terminals, or the link cannot be made.
    pub fn new(link: Option<&Path>) -> anyhow::Result<Self> {
        let mut port = Self { ends: None, link: link.map(Path::to_owned) };
        port.plug()?;
        Ok(port)
    }

    /// Plugs the cable in.
    ///
    /// # Errors
    /// See [`Port::new`].
    pub fn plug(&mut self) -> anyhow::Result<()> {
        let (mut near, far) = TTYPort::pair().context("no pseudo-terminal")?;
        near.set_timeout(Duration::ZERO)?;
        if let (Some(link), Some(name)) = (&self.link, far.name()) {
            let _ = std::fs::remove_file(link);
            std::os::unix::fs::symlink(name, link)
                .with_context(|| format!("{} cannot be made", link.display()))?;
        }
        // Copies that no other program inherits: it would keep the cable plugged in.
        self.ends = Some((near.try_clone_native()?, far.try_clone_native()?));
        Ok(())
    }

    /// Pulls the cable out: whoever has the port open is hung up on.
    pub fn unplug(&mut self) {
        self.ends = None;
        if let Some(link) = &self.link {
            let _ = std::fs::remove_file(link);
        }
    }

    /// What programs open; empty while it is unplugged.
    pub fn name(&self) -> String {
        let linked = self.link.as_ref().map(|link| link.display().to_string());
        let own = || self.ends.as_ref().and_then(|(_, far)| far.name());
        linked.or_else(own).unwrap_or_default()
    }

    /// Takes what programs have sent.
    ///
    /// # Errors
    /// The port fails.
    pub fn receive(&mut self) -> anyhow::Result<Vec<u8>> {
        let Some((near, _)) = &mut self.ends else { return Ok(Vec::new()) };
        let mut bytes = [0; 256];
        match near.read(&mut bytes) {
            Ok(n) => Ok(bytes.get(..n).unwrap_or_default().to_vec()),
            Err(error) if error.kind() == ErrorKind::TimedOut => Ok(Vec::new()),
            Err(error) => Err(error).context("the port cannot be read"),
        }
    }

    /// Sends bytes; those that nobody has room for are lost, as on a wire.
    pub fn send(&mut self, mut bytes: &[u8]) {
        let Some((near, _)) = &mut self.ends else { return };
        while let Ok(n) = near.write(bytes) {
            bytes = bytes.get(n..).unwrap_or_default();
            if bytes.is_empty() {
                return;
            }
        }
    }
}

impl Drop for Port {
    fn drop(&mut self) {
        self.unplug();
    }
}
