//! Evaluation without a run: arithmetic of numbers, and the variables that a control has.
use super::system_variables;
use super::variables::{VariableClass, Vars};
use gcode_lang::alarm::Alarm;
use gcode_lang::control::Settings;

pub use super::functions::{atan2, binary, function, power};

/// Variables that a control has.
#[derive(Debug)]
pub struct VariableTable<'a> {
    settings: &'a Settings,
    vars: Vars,
}

impl<'a> VariableTable<'a> {
    /// Returns the variables of a control with these settings.
    pub fn new(settings: &'a Settings) -> Self {
        Self { settings, vars: Vars::new(&settings.extra_commons, settings.aliases_commons) }
    }

    /// Raises the alarm of reading a variable, whatever its value.
    pub fn read(&self, number: u32) -> Result<(), Alarm> {
        match self.vars.classify(number) {
            VariableClass::System => system_variables::check_readable(number, self.settings),
            VariableClass::Vacant | VariableClass::Local(_) | VariableClass::Common(_) => Ok(()),
        }
    }

    /// Raises the alarm of writing a variable, whatever the value; #3000 and #3006 stop, as they should.
    pub fn write(&self, number: u32) -> Result<(), Alarm> {
        match self.vars.classify(number) {
            VariableClass::Vacant => Err(Alarm::WriteProtected { number }),
            VariableClass::Local(_) | VariableClass::Common(_) => Ok(()),
            VariableClass::System if matches!(number, 3000 | 3006) => Ok(()),
            VariableClass::System => system_variables::check_writable(number, self.settings),
        }
    }
}
