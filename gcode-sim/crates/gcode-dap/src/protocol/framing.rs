//! Framing of messages: a header with `Content-Length`, an empty line, and so many bytes.

/// Longest header and longest message that are read.
const MAX_HEADER: usize = 64 * 1024;
const MAX_MESSAGE: usize = 256 * 1024 * 1024;

/// End of a header.
const HEADER_END: &[u8] = b"\r\n\r\n";

/// Splits a stream of bytes into messages.
#[derive(Debug, Default)]
pub struct Framing {
    bytes: Vec<u8>,
}

/// Error of a header without a usable length; its bytes are dropped.
#[derive(Debug, PartialEq, Eq)]
pub struct FramingError(pub String);

impl Framing {
    /// Adds bytes of the stream.
    pub fn push(&mut self, bytes: &[u8]) {
        self.bytes.extend_from_slice(bytes);
    }

    /// Takes the next message; `None` if it is not complete.
    pub fn next_message(&mut self) -> Option<Result<Vec<u8>, FramingError>> {
        let Some(header) = self.bytes.windows(HEADER_END.len()).position(|window| window == HEADER_END)
        else {
            if self.bytes.len() > MAX_HEADER {
                self.bytes.clear();
                return Some(Err(FramingError("a header without an end".to_owned())));
            }
            return None;
        };
        let body = header + HEADER_END.len();
        let text = String::from_utf8_lossy(&self.bytes[..header]).into_owned();
        let Some(length) = content_length(&text).filter(|length| *length <= MAX_MESSAGE) else {
            self.bytes.drain(..body);
            return Some(Err(FramingError(format!("a header without a usable Content-Length: '{text}'"))));
        };
        if self.bytes.len() < body + length {
            return None;
        }
        let message = self.bytes[body..body + length].to_vec();
        self.bytes.drain(..body + length);
        Some(Ok(message))
    }

    /// Returns a message with its header.
    pub fn framed(message: &str) -> String {
        format!("Content-Length: {}\r\n\r\n{message}", message.len())
    }
}

fn content_length(header: &str) -> Option<usize> {
    header.lines().find_map(|line| {
        let (name, value) = line.split_once(':')?;
        name.trim().eq_ignore_ascii_case("Content-Length").then(|| value.trim().parse().ok())?
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_are_split_whatever_the_pieces() {
        let stream = [Framing::framed("{\"a\":1}"), Framing::framed("\"Φ\""), Framing::framed("")].concat();
        for size in [1, 2, 7, 1000] {
            let mut framing = Framing::default();
            let mut messages = Vec::new();
            for piece in stream.as_bytes().chunks(size) {
                framing.push(piece);
                while let Some(message) = framing.next_message() {
                    messages.push(String::from_utf8(message.unwrap()).unwrap());
                }
            }
            assert_eq!(messages, ["{\"a\":1}", "\"Φ\"", ""], "pieces of {size}");
        }
    }

    #[test]
    fn a_bad_header_is_dropped_and_the_next_message_is_read() {
        let mut framing = Framing::default();
        framing.push(b"Content-Length: x\r\n\r\ncontent-length: 2\r\nOther: 1\r\n\r\n{}");
        assert!(framing.next_message().unwrap().is_err());
        assert_eq!(framing.next_message(), Some(Ok(b"{}".to_vec())));
        assert_eq!(framing.next_message(), None);
    }
}
