//! The server of one page, for this machine.

use std::io::{self, BufRead, BufReader, ErrorKind, Read, Write};
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;
use std::time::{Duration, Instant};

/// The most bytes of a request that are read.
const MOST_REQUEST: u64 = 64 << 10;

/// The pause after a failure to accept a connection: where descriptors are exhausted, the next attempt fails at once as well.
const PAUSE: Duration = Duration::from_millis(50);

/// Limits of a server.
#[derive(Clone, Copy, Debug)]
pub(super) struct Limits {
    /// How long a client may take for its whole request, and for the whole answer.
    pub(super) patience: Duration,
    /// The most connections at once; others wait.
    pub(super) connections: usize,
}

impl Default for Limits {
    fn default() -> Self {
        Limits { patience: Duration::from_secs(5), connections: 64 }
    }
}

/// Answers requests until the process ends.
pub(super) fn serve(listener: &TcpListener, address: SocketAddr, page: &[u8], limits: Limits) {
    let open = AtomicUsize::new(0);
    let open = &open;
    thread::scope(|scope| {
        for stream in listener.incoming() {
            let Ok(stream) = stream else {
                thread::sleep(PAUSE);
                continue;
            };
            // Each of them ends within the patience.
            while open.load(Ordering::Relaxed) >= limits.connections {
                thread::sleep(Duration::from_millis(5));
            }
            open.fetch_add(1, Ordering::Relaxed);
            let serve = move || {
                // A client that leaves early harms nobody else.
                drop(answer(&stream, address, page, limits.patience));
                open.fetch_sub(1, Ordering::Relaxed);
            };
            if thread::Builder::new().spawn_scoped(scope, serve).is_err() {
                open.fetch_sub(1, Ordering::Relaxed);
                thread::sleep(PAUSE);
            }
        }
    });
}

/// A connection whose reads, or whose writes, end together at one time.
struct Until<'s> {
    stream: &'s TcpStream,
    end: Instant,
}

impl Until<'_> {
    /// The time that is left.
    fn left(&self) -> io::Result<Option<Duration>> {
        match self.end.checked_duration_since(Instant::now()) {
            Some(left) if !left.is_zero() => Ok(Some(left)),
            _ => Err(ErrorKind::TimedOut.into()),
        }
    }
}

impl Read for Until<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.stream.set_read_timeout(self.left()?)?;
        self.stream.read(buffer)
    }
}

impl Write for Until<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.stream.set_write_timeout(self.left()?)?;
        self.stream.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.stream.flush()
    }
}

/// Answers one request.
fn answer(
    stream: &TcpStream,
    address: SocketAddr,
    page: &[u8],
    patience: Duration,
) -> io::Result<()> {
    let mut head = Vec::new();
    let request = Until { stream, end: Instant::now() + patience };
    for line in BufReader::new(request.take(MOST_REQUEST)).lines() {
        match line? {
            line if line.is_empty() => break,
            line => head.push(line),
        }
    }
    let (status, kind, body) = reply(&head, address.port(), page);
    let length = body.len();
    let mut stream = Until { stream, end: Instant::now() + patience };
    let fields = format!(
        "HTTP/1.1 {status}\r\nContent-Type: {kind}; charset=utf-8\r\nContent-Length: {length}\r\nConnection: close\r\n\
         X-Content-Type-Options: nosniff\r\nX-Frame-Options: DENY\r\nCross-Origin-Resource-Policy: same-origin\r\n\
         Referrer-Policy: no-referrer\r\n\r\n"
    );
    stream.write_all(fields.as_bytes())?;
    if !head.first().is_some_and(|line| line.starts_with("HEAD ")) {
        stream.write_all(body)?;
    }
    stream.flush()
}

/// Status, type and body for the head of a request. A name that another machine chose to mean this one is refused.
fn reply<'p>(head: &[String], port: u16, page: &'p [u8]) -> (&'static str, &'static str, &'p [u8]) {
    let refused = |status, why: &'static str| (status, "text/plain", why.as_bytes());
    let field = |name: &str| {
        head.iter().skip(1).find_map(|line| {
            let (own, value) = line.split_once(':')?;
            own.trim().eq_ignore_ascii_case(name).then(|| value.trim())
        })
    };
    let mut hosts: Vec<String> =
        ["127.0.0.1", "localhost"].iter().map(|name| format!("{name}:{port}")).collect();
    // Browsers leave out the port of the protocol.
    if port == 80 {
        hosts.extend(["127.0.0.1".to_owned(), "localhost".to_owned()]);
    }
    let is_host = |line: &&String| {
        line.split_once(':').is_some_and(|(own, _)| own.trim().eq_ignore_ascii_case("host"))
    };
    if head.iter().skip(1).filter(is_host).count() != 1 {
        return refused("400 Bad Request", "expected one field `Host`\n");
    }
    if !field("host").is_some_and(|host| hosts.iter().any(|own| own.eq_ignore_ascii_case(host))) {
        return refused("403 Forbidden", "this page is for this machine alone\n");
    }
    let is_own = |origin: &str| hosts.iter().any(|own| origin == format!("http://{own}"));
    if field("origin").is_some_and(|origin| !is_own(origin)) {
        return refused("403 Forbidden", "pages of other origins are refused\n");
    }
    let mut words = head.first().map_or("", String::as_str).split(' ');
    let method = words.next();
    let path = words.next().map(|path| path.split('?').next().unwrap_or_default());
    match (method, path) {
        (Some("GET" | "HEAD"), Some("/" | "/index.html")) => ("200 OK", "text/html", page),
        (Some("GET" | "HEAD"), _) => refused("404 Not Found", "there is one page, at /\n"),
        _ => refused("405 Method Not Allowed", "expected GET\n"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn status(lines: &[&str]) -> &'static str {
        let head: Vec<String> = lines.iter().map(|line| (*line).to_owned()).collect();
        reply(&head, 8765, b"page").0
    }

    #[test]
    fn only_requests_for_this_machine_of_its_own_page_are_answered() {
        let get = "GET / HTTP/1.1";
        for (lines, expected) in [
            (&[get, "Host: 127.0.0.1:8765"][..], "200 OK"),
            (&[get, "host:localhost:8765", "Origin: http://localhost:8765"], "200 OK"),
            (&["HEAD / HTTP/1.1", "Host: localhost:8765"], "200 OK"),
            (&[get], "400 Bad Request"),
            (&[get, "Host: localhost:8765", "Host: example.org"], "400 Bad Request"),
            (&["GET /?x=1 HTTP/1.1", "Host: localhost:8765"], "200 OK"),
            (&[get, "Host: example.org"], "403 Forbidden"),
            (&[get, "Host: example.org:8765"], "403 Forbidden"),
            (&[get, "Host: localhost:8765", "Origin: https://example.org"], "403 Forbidden"),
            (&[get, "Host: localhost:8765", "Origin: null"], "403 Forbidden"),
            (&["GET /etc/passwd HTTP/1.1", "Host: localhost:8765"], "404 Not Found"),
            (&["POST / HTTP/1.1", "Host: localhost:8765"], "405 Method Not Allowed"),
            (&["", "Host: localhost:8765"], "405 Method Not Allowed"),
            (&[], "400 Bad Request"),
        ] {
            assert_eq!(status(lines), expected, "{lines:?}");
        }
    }

    const GET: &[u8] = b"GET / HTTP/1.1\r\nHost: localhost\r\n\r\n";

    /// Calls `client` with the address of a server of these limits.
    fn with_server(limits: Limits, client: impl FnOnce(SocketAddr)) {
        let listener = TcpListener::bind(("127.0.0.1", 0)).unwrap();
        let address = listener.local_addr().unwrap();
        // It has no end but that of the process.
        thread::spawn(move || serve(&listener, address, b"page", limits));
        client(address);
    }

    fn text(mut stream: TcpStream) -> String {
        let mut text = String::new();
        // A server that closes with bytes unread resets the connection.
        let _ = stream.read_to_string(&mut text);
        text
    }

    #[test]
    fn a_client_that_sends_a_byte_now_and_then_is_left_after_the_patience() {
        let patience = Duration::from_millis(300);
        with_server(Limits { patience, ..Limits::default() }, |address| {
            let mut stream = TcpStream::connect(address).unwrap();
            stream.set_read_timeout(Some(Duration::from_millis(20))).unwrap();
            let begin = Instant::now();
            let mut is_open = true;
            while is_open {
                assert!(begin.elapsed() < Duration::from_secs(20), "the connection stays open");
                is_open = stream.write_all(b"x").is_ok()
                    && !matches!(stream.read(&mut [0]), Ok(0))
                    && begin.elapsed() < Duration::from_secs(21);
            }
            assert!(begin.elapsed() >= patience / 2, "{:?}", begin.elapsed());
        });
    }

    #[test]
    fn connections_beyond_the_limit_wait_and_are_answered() {
        let patience = Duration::from_millis(300);
        with_server(Limits { patience, connections: 2 }, |address| {
            let begin = Instant::now();
            let silent: Vec<_> = (0..4).map(|_| TcpStream::connect(address).unwrap()).collect();
            let mut stream = TcpStream::connect(address).unwrap();
            stream.write_all(GET).unwrap();
            let answer = text(stream);
            assert!(answer.starts_with("HTTP/1.1 403"), "{answer}");
            // Two at once: the four silent ones take twice the patience.
            assert!(begin.elapsed() >= patience, "{:?}", begin.elapsed());
            drop(silent);
        });
    }
}
