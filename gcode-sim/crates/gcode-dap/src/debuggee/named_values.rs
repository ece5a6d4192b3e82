//! Values of the variables that a message names, behind its text.
use super::values;
use gcode_control::Control;
use gcode_lang::alarm::Alarm;

/// Returns a message with the values of its variables: `ANGLE IN #140 (#140 = 90)`.
pub(crate) fn with_values(text: &str, control: &Control) -> String {
    let level = control.vars().level();
    let mut numbers: Vec<u32> = Vec::new();
    for part in text.split('#').skip(1) {
        let digits = part.len() - part.trim_start_matches(|c: char| c.is_ascii_digit()).len();
        numbers.extend(part[..digits].parse::<u32>().ok().filter(|number| !numbers.contains(number)));
    }
    let value = |number: &u32| -> Result<String, Alarm> {
        Ok(format!("#{number} = {}", values::value(control.variable_of(level, *number)?)))
    };
    let shown: Vec<String> = numbers.iter().filter_map(|number| value(number).ok()).collect();
    if shown.is_empty() { text.to_owned() } else { format!("{text} ({})", shown.join(", ")) }
}
