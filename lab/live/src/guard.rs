//! Who may ask for what. Whoever has the token may do everything; the page holds it. Any other site, and any name that was made to point here, is
//! turned away.

use std::net::{IpAddr, SocketAddr};

use axum::http::{HeaderMap, StatusCode, header};

/// Where the server listens, and what it asks for.
#[derive(Clone, Debug)]
pub struct Access {
    /// Known to the page, asked for with every command.
    pub(crate) token: String,
    /// The page is for those who bring the token.
    pub(crate) asks: bool,
    /// It can be reached from other machines: the numbers ask for the token, too.
    pub(crate) open: bool,
}

/// Shortest token that a user may choose.
const SHORTEST: usize = 16;

impl Access {
    /// For this machine alone, with a token that nobody has chosen. Where the page asks for it, it is for the user who has started the
    /// server; else for every user of the machine.
    ///
    /// # Errors
    /// The system gives no random numbers.
    pub fn local(asks: bool) -> anyhow::Result<Self> {
        Ok(Self { token: random()?, asks, open: false })
    }

    /// For other machines, too.
    ///
    /// # Errors
    /// The token is too short, or not made of letters and digits.
    pub fn open(token: &str) -> anyhow::Result<Self> {
        let plain = token.chars().all(|c| c.is_ascii_alphanumeric());
        anyhow::ensure!(
            plain && token.len() >= SHORTEST,
            "the token must be {SHORTEST} letters and digits or more"
        );
        Ok(Self { token: token.into(), asks: true, open: true })
    }

    pub(crate) fn knows(&self, token: Option<&str>) -> bool {
        token.is_some_and(|token| same(token.as_bytes(), self.token.as_bytes()))
    }
}

/// What nobody can guess.
pub(crate) fn random() -> anyhow::Result<String> {
    let mut bytes = [0; 24];
    getrandom::fill(&mut bytes).map_err(|error| anyhow::anyhow!("no random numbers: {error}"))?;
    Ok(bytes.iter().map(|byte| format!("{byte:02x}")).collect())
}

/// Whether both are the same, in a time that does not say where they differ.
fn same(a: &[u8], b: &[u8]) -> bool {
    a.len() == b.len() && a.iter().zip(b).fold(0, |differ, (x, y)| differ | (x ^ y)) == 0
}

/// Checks the headers that a browser sets by itself: a name that an attacker owns is no address, and another site's script has another origin.
///
/// # Errors
/// The status to answer with.
pub(crate) fn check(headers: &HeaderMap) -> Result<(), StatusCode> {
    let text = |name| headers.get(name).map(|value| value.to_str().unwrap_or("")); // what is no text is no host
    let host = text(header::HOST).filter(|_| headers.get_all(header::HOST).iter().count() == 1);
    let host = host.filter(|host| is_address(host)).ok_or(StatusCode::MISDIRECTED_REQUEST)?;
    match text(header::ORIGIN) {
        Some(origin) if origin.strip_prefix("http://") != Some(host) => Err(StatusCode::FORBIDDEN),
        _ => Ok(()),
    }
}

/// Whether it is an address in numbers, or this machine's name.
fn is_address(host: &str) -> bool {
    let name = host.rsplit_once(':').map_or(host, |(name, _)| name);
    host.parse::<SocketAddr>().is_ok() || host.parse::<IpAddr>().is_ok() || name == "localhost"
}

#[cfg(test)]
mod tests {
    use super::*;

    fn checked(headers: &[(&'static str, &'static str)]) -> Result<(), u16> {
        let mut map = HeaderMap::new();
        for (name, value) in headers {
            map.append(*name, value.parse().unwrap());
        }
        check(&map).map_err(|status| status.as_u16())
    }

    #[test]
    fn only_addresses_and_the_pages_own_origin_pass() {
        for host in ["127.0.0.1:8326", "localhost:8326", "[::1]:8326", "192.168.1.7:80", "127.0.0.1"] {
            assert_eq!(checked(&[("host", host)]), Ok(()), "{host}");
        }
        for host in [
            "evil.example:8326",
            "localhost.evil.example",
            "127.0.0.1.evil.example:1",
            "",
            "127.0.0.1:8326 evil",
        ] {
            assert_eq!(checked(&[("host", host)]), Err(421), "{host}");
        }
        assert_eq!(checked(&[]), Err(421));
        assert_eq!(checked(&[("host", "127.0.0.1:1"), ("host", "evil.example")]), Err(421));
        let origin = |origin| checked(&[("host", "127.0.0.1:8326"), ("origin", origin)]);
        assert_eq!(origin("http://127.0.0.1:8326"), Ok(()));
        for other in ["http://127.0.0.1:1", "https://evil.example", "null", ""] {
            assert_eq!(origin(other), Err(403), "{other}");
        }
    }

    #[test]
    fn a_token_is_long_and_its_own() {
        for token in ["", "short", "with blanks and more", "<script>alert(1)</script>"] {
            assert!(Access::open(token).is_err(), "{token}");
        }
        let [a, b] = [(); 2].map(|()| Access::local(false).unwrap());
        assert!(a.token.len() == 48 && a.token != b.token);
        assert!(a.knows(Some(&a.token)) && !a.knows(Some(&b.token)) && !a.knows(None) && !a.knows(Some("")));
    }
}
