//! Signals, switches and counters beside the program: #1100…, #3003, #3004, #3901, #3902 and the output device.
use super::checked::integer;
use gcode_lang::alarm::Alarm;

/// What a program sets beside variables, modes and tables.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Panel {
    /// Output signals, #1100 the lowest bit.
    pub(super) outputs: u32,
    /// #3003 and #3004.
    pub(super) control_switches: [f64; 2],
    /// #3901 and #3902: parts made, parts required.
    pub(super) part_counters: [f64; 2],
    /// The output device is open: between POPEN and PCLOS.
    pub(super) is_output_open: bool,
}

/// A control may have up to 128 signals each way; here are the first 32.
pub(super) fn check_signal_word(word: u32) -> Result<(), Alarm> {
    if word > 0 {
        return Err(Alarm::NotSimulated { what: "more than 32 interface signals".into() });
    }
    Ok(())
}

impl Panel {
    pub(super) fn set_output(&mut self, bit: u32, on: bool) {
        self.outputs = if on { self.outputs | 1 << bit } else { self.outputs & !(1 << bit) };
    }

    pub(super) fn set_outputs(&mut self, word: u32, value: f64) -> Result<(), Alarm> {
        let bits = integer(value)?;
        check_signal_word(word)?;
        // 32 bits, signed or not.
        if !(i64::from(i32::MIN)..=i64::from(u32::MAX)).contains(&bits) {
            return Err(Alarm::OutOfRange { function: "#1132".into(), value });
        }
        self.outputs = bits as u32;
        Ok(())
    }

    /// #3003 has two bits, #3004 three.
    pub(super) fn set_switch(&mut self, switch: u32, value: f64) -> Result<(), Alarm> {
        let most = if switch == 0 { 3.0 } else { 7.0 };
        if !(0.0..=most).contains(&value.round()) {
            return Err(Alarm::OutOfRange { function: format!("#{}", 3003 + switch), value });
        }
        self.control_switches[switch as usize] = value.round();
        Ok(())
    }

    pub(super) fn set_parts(&mut self, counter: u32, value: f64) -> Result<(), Alarm> {
        if value < 0.0 {
            return Err(Alarm::OutOfRange { function: format!("#{}", 3901 + counter), value });
        }
        self.part_counters[counter as usize] = value.round();
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn outputs_are_bits_of_one_word() {
        let mut panel = Panel::default();
        panel.set_output(3, true);
        panel.set_output(0, true);
        panel.set_output(3, false);
        assert_eq!(panel.outputs, 1);
        panel.set_outputs(0, -1.0).unwrap();
        assert_eq!(panel.outputs, u32::MAX, "32 bits with a sign");
        assert!(panel.set_outputs(0, 4_294_967_296.0).is_err());
        assert!(panel.set_outputs(1, 0.0).is_err(), "#1133 is not simulated");
        assert_eq!(panel.outputs, u32::MAX, "a refused value changes nothing");
    }

    #[test]
    fn switches_have_two_and_three_bits() {
        let mut panel = Panel::default();
        panel.set_switch(0, 3.0).unwrap();
        panel.set_switch(1, 7.0).unwrap();
        assert!(panel.set_switch(0, 4.0).is_err() && panel.set_switch(1, 8.0).is_err());
        assert_eq!(panel.control_switches, [3.0, 7.0]);
        assert!(panel.set_parts(0, -1.0).is_err());
    }
}
