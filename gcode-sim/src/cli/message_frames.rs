//! Frames of messages of both editor protocols: a header with `Content-Length`, an empty line, and so many bytes.
use std::io::{self, BufRead, Read, Write};

/// Longest line of a header, bytes.
const MAX_LINE: u64 = 64 * 1024;

/// Longest message, bytes.
const MAX_LENGTH: usize = 1 << 30;

/// Sentence on a header without a usable length; its bytes are dropped.
pub(super) type FrameError = String;

/// Reads one message; `None` at the end of the input.
pub(super) fn read_body(input: &mut impl BufRead) -> io::Result<Option<Result<Vec<u8>, FrameError>>> {
    let mut header = String::new();
    let mut length: Option<usize> = None;
    loop {
        let mut line = Vec::new();
        if input.by_ref().take(MAX_LINE).read_until(b'\n', &mut line)? == 0 {
            return Ok(None);
        }
        let line = String::from_utf8_lossy(&line);
        let line = line.trim();
        if !line.is_empty() {
            if let Some((name, value)) = line.split_once(':')
                && name.trim().eq_ignore_ascii_case("content-length")
            {
                length = value.trim().parse().ok().filter(|length| *length <= MAX_LENGTH);
            }
            let room = (MAX_LINE as usize).saturating_sub(header.len());
            header.extend(line.chars().take(room).chain(Some(' ')).take(room));
            continue;
        }
        match length {
            Some(length) => {
                let mut body = Vec::new();
                let read = input.by_ref().take(length as u64).read_to_end(&mut body)?;
                return Ok((read == length).then_some(Ok(body)));
            }
            // Blank lines between messages.
            None if header.is_empty() => {}
            None => {
                let header = header.trim();
                return Ok(Some(Err(format!("a header without a usable Content-Length: '{header}'"))));
            }
        }
    }
}

/// Writes one message with its header at once, so that no other stands in between.
pub(super) fn write_body(output: &mut impl Write, body: &[u8]) -> io::Result<()> {
    let message = [format!("Content-Length: {}\r\n\r\n", body.len()).as_bytes(), body].concat();
    output.write_all(&message)?;
    output.flush()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn written_messages_are_read() {
        let mut stream = Vec::new();
        for body in ["{\"a\":1}", "\"\u{3a6}\"", ""] {
            write_body(&mut stream, body.as_bytes()).unwrap();
        }
        let mut input = &stream[..];
        let mut next =
            || read_body(&mut input).unwrap().map(|body| String::from_utf8(body.unwrap()).unwrap());
        assert_eq!(
            [next(), next(), next(), next()].map(|body| body.unwrap_or("end".to_owned())),
            ["{\"a\":1}", "\"\u{3a6}\"", "", "end"]
        );
    }

    #[test]
    fn a_bad_header_is_dropped_and_the_next_message_is_read() {
        let mut input = &b"Content-Length: x\r\n\r\n\r\ncontent-length:2\r\nOther: 1\r\n\r\n{}"[..];
        let refused = read_body(&mut input).unwrap().unwrap().unwrap_err();
        assert_eq!(refused, "a header without a usable Content-Length: 'Content-Length: x'");
        assert_eq!(read_body(&mut input).unwrap(), Some(Ok(b"{}".to_vec())));
        assert_eq!(read_body(&mut input).unwrap(), None);
        assert_eq!(read_body(&mut &b"Content-Length: 99\r\n\r\n{}"[..]).unwrap(), None, "cut off");
    }
}
