//! Unit in which the numbers of a program count: its own G20 or G21, those of the programs that it calls or
//! that call it, or the unit at power-on.
use std::collections::BTreeSet;

use gcode_lang::program::modes::Unit;

use crate::context::{CheckContext, ProgramUnit, Role};
use crate::possible_units::PossibleUnits;

/// Returns the unit in which a program counts; `None` if it may be either.
///
/// A program that commands none counts as its callers do. Nothing states the unit of a macro that unknown programs
/// call. A main program without one counts as at power-on, in mm where nothing states that, as a run does.
pub(crate) fn unit_in_force(context: &CheckContext<'_>, unit: &ProgramUnit<'_>) -> Option<Unit> {
    let mut units = PossibleUnits::default();
    let mut seen = BTreeSet::from([unit.id]);
    let mut open = vec![unit];
    while let Some(unit) = open.pop() {
        let commanded = commanded_below(context, unit);
        units |= match unit.role {
            _ if !commanded.is_none() => commanded,
            Role::Called => PossibleUnits::default(),
            Role::Resident => PossibleUnits::BOTH,
            Role::Main => match context.settings.is_inch_at_power_on {
                Some(true) => PossibleUnits::of(Unit::Inch),
                Some(false) | None => PossibleUnits::of(Unit::Metric),
            },
        };
        if commanded.is_none() {
            let callers = unit.callers.iter().map(|(caller, _)| &context.units[*caller]);
            open.extend(callers.filter(|caller| seen.insert(caller.id)));
        }
    }
    units.only()
}

/// Returns the units that a program commands, or else those that the programs command which it calls.
fn commanded_below(context: &CheckContext<'_>, unit: &ProgramUnit<'_>) -> PossibleUnits {
    let mut units = unit.commanded_units();
    if !units.is_none() {
        return units;
    }
    let mut seen = BTreeSet::from([unit.id]);
    let mut open = vec![unit];
    while let Some(unit) = open.pop() {
        units |= unit.commanded_units();
        let called = unit.calls.iter().filter_map(|call| context.called_unit(call));
        open.extend(called.map(|called| &context.units[called]).filter(|called| seen.insert(called.id)));
    }
    units
}
