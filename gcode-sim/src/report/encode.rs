//! Bytes as text: digests that identify files, and data embedded in a page.
use data_encoding::{BASE64, HEXLOWER};
use sha2::{Digest, Sha256};

/// Returns the SHA-256 (FIPS 180-4) in 64 hexadecimal digits, as `sha256sum` and `certutil` print it.
pub fn sha256(bytes: &[u8]) -> String {
    HEXLOWER.encode(&Sha256::digest(bytes))
}

/// Returns the base64 encoding of RFC 4648, section 4.
pub fn base64(bytes: &[u8]) -> String {
    BASE64.encode(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sha256_gives_the_digest_of_the_standard() {
        // FIPS 180-2, appendix B.1.
        assert_eq!(sha256(b"abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    }
}
