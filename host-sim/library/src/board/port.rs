//! Serial ports: which of them is a board's, and how one is lost.

use std::fmt;
use std::io::ErrorKind;
use std::path::Path;
use std::time::Duration;

use anyhow::{Context, bail};
use firmware_logic::stream::BAUD;
use pt326_lab::board::ALONE;
use serialport::{SerialPort, SerialPortInfo, SerialPortType};

/// The USB number of STMicroelectronics, and those of ST-LINKs with a port.
const ST: u16 = 0x0483;
const ST_LINKS: [u16; 8] = [0x374A, 0x374B, 0x374E, 0x374F, 0x3752, 0x3753, 0x3754, 0x3757];

/// How long a read waits for a byte.
const PATIENCE: Duration = Duration::from_millis(20);

/// The port that is meant: the one given, or the only ST-LINK of this machine.
///
/// # Errors
/// There is none, or there are several; they are listed.
pub fn find(given: Option<&str>) -> anyhow::Result<String> {
    if let Some(name) = given {
        return Ok(name.to_owned());
    }
    let ports = ports();
    let boards: Vec<&SerialPortInfo> = ports.iter().filter(|port| is_st_link(port)).collect();
    let names = |ports: &[&SerialPortInfo]| {
        ports.iter().map(|port| port.port_name.as_str()).collect::<Vec<_>>().join(", ")
    };
    match boards[..] {
        [board] => Ok(board.port_name.clone()),
        [] if ports.is_empty() => bail!("no serial port on this machine: is the board plugged in?"),
        [] => bail!(
            "no ST-LINK among the serial ports {}: plug the board in, or name its port",
            names(&ports.iter().collect::<Vec<_>>())
        ),
        _ => bail!("several ST-LINKs: name one of {}", names(&boards)),
    }
}

/// All ports of this machine.
fn ports() -> Vec<SerialPortInfo> {
    // Without that folder serialport 4.10 panics.
    if cfg!(target_os = "linux") && !Path::new("/sys/class/tty").is_dir() {
        return Vec::new();
    }
    serialport::available_ports().unwrap_or_default()
}

fn is_st_link(port: &SerialPortInfo) -> bool {
    matches!(&port.port_type, SerialPortType::UsbPort(usb) if usb.vid == ST && ST_LINKS.contains(&usb.pid))
}

/// Opens a port as the board speaks on it.
///
/// # Errors
/// It is not there, is in use, or this user may not open it.
pub fn open(name: &str) -> anyhow::Result<Box<dyn SerialPort>> {
    let port = serialport::new(name, BAUD).timeout(PATIENCE).open();
    port.with_context(|| format!("{name} cannot be opened"))
}

/// Why a board can be reached no more. It carries no error of the system below it: a broken pipe to a board is not one to whoever reads
/// our output.
#[derive(Debug)]
pub enum Lost {
    /// Its port gives an error, or takes no bytes.
    Gone(std::io::Error),
    /// It does not answer; what it was to do, and how long it had for it.
    Silent(String),
}

impl Lost {
    /// `what` has not happened in that time.
    pub(super) fn silent(what: &str, time: Duration) -> Self {
        Self::Silent(format!("{what} within {} s", time.as_secs()))
    }
}

impl fmt::Display for Lost {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Gone(error) => write!(f, "the port has gone ({error}): {ALONE}"),
            Self::Silent(what) => write!(f, "{what}: {ALONE}"),
        }
    }
}

impl std::error::Error for Lost {}

/// Whether a port that gave this error has gone, and not only nothing to say.
pub(super) fn has_gone(error: &std::io::Error) -> bool {
    !matches!(error.kind(), ErrorKind::TimedOut | ErrorKind::Interrupted | ErrorKind::WouldBlock)
}

#[cfg(test)]
mod tests {
    use serialport::UsbPortInfo;

    use super::*;

    fn usb(vid: u16, pid: u16) -> SerialPortInfo {
        let usb = UsbPortInfo { vid, pid, serial_number: None, manufacturer: None, product: None };
        SerialPortInfo { port_name: "x".to_owned(), port_type: SerialPortType::UsbPort(usb) }
    }

    #[test]
    fn the_st_link_of_a_nucleo_is_known_and_another_adapter_is_not() {
        assert!(is_st_link(&usb(0x0483, 0x374B)));
        assert!(!is_st_link(&usb(0x0403, 0x6001)));
        assert!(!is_st_link(&usb(0x0483, 0x5740)));
    }

    #[test]
    fn a_port_that_is_not_there_is_named() {
        let Err(error) = open("/dev/no-such-port") else { panic!("it is there") };
        let error = format!("{error:#}");
        assert!(error.contains("/dev/no-such-port cannot be opened"), "{error}");
    }
}
