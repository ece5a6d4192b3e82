//! Exact points of a path as a compact text that the page's script reads when a person zooms in.
use nalgebra::Point3;

use crate::report::encode::base64;

/// Parts of a millimetre that are told apart: less than the least increment of any control, IS-C.
const PARTS: f64 = 1e4;

/// Returns the base64 of the differences from point to point, x, y and z in 0.0001 mm; the first point counts from 0.
///
/// Each is a number of 7 bits a byte, the lowest first, with the top bit set if more follow. Even numbers are twice a positive
/// difference, odd ones twice a negative one less 1.
pub(super) fn encoded(points: &[Point3<f64>]) -> String {
    let mut bytes = Vec::with_capacity(6 * points.len());
    let mut last = [0i64; 3];
    for point in points {
        for (value, before) in point.coords.iter().zip(&mut last) {
            let now = (value * PARTS).round() as i64;
            let difference = now - *before;
            *before = now;
            let mut rest = ((difference << 1) ^ (difference >> 63)) as u64;
            while 0x7f < rest {
                bytes.push((rest & 0x7f) as u8 | 0x80);
                rest >>= 7;
            }
            bytes.push(rest as u8);
        }
    }
    base64(&bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// x 0.0001 is 1, written 2; y −0.0001 is −1, written 1; z 0.01 is 100, written 200 = 72 + 128·1: bytes 200 and 1. The second
    /// point differs by 0, 0 and −0.0064: 64, written 127.
    #[test]
    fn differences_are_numbers_of_seven_bits() {
        let points = [Point3::new(0.0001, -0.0001, 0.01), Point3::new(0.0001, -0.0001, 0.0036)];
        assert_eq!(encoded(&points), base64(&[2, 1, 200, 1, 0, 0, 127]));
        assert_eq!(encoded(&[]), "");
    }
}
