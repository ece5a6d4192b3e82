//! The work zeros that a picture and a page draw.
use gcode_inspect::machine::{HeadKind, Machine, Setup};
use gcode_lang::motion::Position;
use gcode_session::work_offset_name;

/// Returns the work zeros: those of the machine file, or the origin of the part, from which positions then count.
pub(crate) fn zeros(machine: &Machine) -> Vec<(String, [f64; 3])> {
    if !matches!(machine.head.kind, HeadKind::Free | HeadKind::Fixed(_)) {
        return Vec::new();
    }
    if machine.offsets.is_empty() {
        return vec![("zero".to_owned(), [0.0; 3])];
    }
    let zero = |values: &[(usize, f64)]| {
        let mut at = Position::default();
        values.iter().for_each(|(axis, value)| at[*axis] = *value);
        machine.forward(&at, &Setup::default()).tip.coords.into()
    };
    let name = |system| work_offset_name(system, machine.dialect);
    machine.offsets.iter().map(|offset| (name(offset.system), zero(&offset.values))).collect()
}
