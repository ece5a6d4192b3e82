//! POPEN, DPRNT, BPRNT and PCLOS: lines that a program sends to the control's output device.
use gcode_lang::alarm::Alarm;
use gcode_lang::control::Settings;
use gcode_lang::units::round_scaled;

/// What a run may print before it is stopped: a loop that prints must not fill the memory.
pub(super) const MAX_PRINTED_BYTES: usize = 64 << 20;

/// `#n[ab]`: a digits before the point and b behind it. In front stands the place of the sign; with PRT (6001#1)
/// blanks are left out. A control prints the lower digits of a number that has more than a before its point: the answer
/// is whether all of them were printed.
pub(super) fn decimal(
    number: f64,
    whole: u8,
    decimals: u8,
    settings: &Settings,
    line: &mut Vec<u8>,
) -> Result<bool, Alarm> {
    let most = settings.print_digits;
    if !(1..=most).contains(&usize::from(whole + decimals)) {
        return Err(Alarm::PrintFormat);
    }
    let scale = 10_f64.powi(i32::from(decimals));
    let scaled = round_scaled(number.abs(), scale);
    if scaled > 1e15 {
        return Err(Alarm::IntegerOverflow);
    }
    let unit = 10_u64.pow(u32::from(decimals));
    let scaled = scaled as u64;
    let width = usize::from(whole);
    let mut whole_digits = (scaled / unit).to_string();
    let mut is_complete = true;
    if whole_digits.len() > width && !settings.print_expands {
        is_complete = whole_digits.drain(..whole_digits.len() - width).all(|digit| digit == '0');
    }
    let negative = number < 0.0 && scaled > 0;
    if negative {
        line.push(b'-');
    } else if !settings.omits_print_blanks {
        line.push(b' ');
    }
    if !settings.omits_print_blanks {
        line.extend(std::iter::repeat_n(b' ', width.saturating_sub(whole_digits.len())));
    }
    line.extend(whole_digits.bytes());
    if decimals > 0 {
        let fraction = scaled % unit;
        line.push(b'.');
        line.extend(format!("{fraction:0width$}", width = usize::from(decimals)).bytes());
    }
    Ok(is_complete)
}

/// `#n[d]`: the value × 10^d as two words, the highest byte first.
pub(super) fn binary(number: f64, decimals: u8, line: &mut Vec<u8>) -> Result<(), Alarm> {
    let scaled = round_scaled(number, 10_f64.powi(i32::from(decimals)));
    if !(-2_147_483_648.0..=2_147_483_647.0).contains(&scaled) {
        return Err(Alarm::IntegerOverflow);
    }
    line.extend((scaled as i32).to_be_bytes());
    Ok(())
}

/// A printed line as a text: BPRNT's bytes are spelled out, so that none is lost.
pub fn printable(line: &[u8]) -> String {
    line.iter()
        .map(|byte| match byte {
            b' '..=b'~' => char::from(*byte).to_string(),
            byte => format!("\\x{byte:02X}"),
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn printed(number: f64, whole: u8, decimals: u8, settings: &Settings) -> String {
        let mut line = Vec::new();
        decimal(number, whole, decimals, settings, &mut line).unwrap();
        String::from_utf8(line).unwrap()
    }

    #[test]
    fn numbers_as_the_manual_prints_them() {
        // Operator's manual, DPRNT: #2 = 128.47398 as [53], #5 = -91.2 as [53], #30 = 123.456 as [20].
        let mut settings = Settings::default();
        assert_eq!(printed(128.47398, 5, 3, &settings), "   128.474");
        assert_eq!(printed(-91.2, 5, 3, &settings), "-   91.200");
        assert_eq!(printed(123.456, 2, 0, &settings), " 23");
        settings.omits_print_blanks = true;
        assert_eq!(printed(128.47398, 5, 3, &settings), "128.474");
        assert_eq!(printed(-91.2, 5, 3, &settings), "-91.200");
    }

    #[test]
    fn two_words_with_the_highest_byte_first() {
        // Operator's manual, BPRNT: #100 = 0.40956 as [3] is 410, #101 = -1638.4 as [3] is -1638400.
        let mut line = Vec::new();
        binary(0.40956, 3, &mut line).unwrap();
        binary(-1638.4, 3, &mut line).unwrap();
        assert_eq!(line, [0x00, 0x00, 0x01, 0x9A, 0xFF, 0xE7, 0x00, 0x00]);
    }
}
