//! The work zeros that a picture and a page draw.
use gcode_inspect::machine::{HeadKind, Machine, Setup, WorkOffset};
use gcode_lang::motion::Position;
use gcode_session::Run;

/// Returns the work zeros in whose coordinates one of the runs has placed an axis: those of the machine file, or the origin of the
/// part, from which positions then count.
pub(crate) fn zeros<'r>(
    machine: &Machine,
    runs: impl IntoIterator<Item = &'r Run>,
) -> Vec<(String, [f64; 3])> {
    // Where the tip is in an offset depends on the angle of a head that is set by hand.
    let head_axes = match &machine.head.kind {
        HeadKind::Manual { .. } => return Vec::new(),
        HeadKind::Axes { chain, .. } => chain.0.iter().fold(0u8, |axes, link| axes | 1 << link.axis),
        HeadKind::Axis { axis, .. } => 1 << axis,
        HeadKind::Free | HeadKind::Fixed(_) => 0,
    };
    if machine.offsets.is_empty() {
        return vec![("zero".to_owned(), [0.0; 3])];
    }
    let zero = |values: &[(usize, f64)]| {
        let mut at = Position::default();
        // An offset counts with the axes of the head at 0.
        let values = values.iter().filter(|(axis, _)| head_axes >> axis & 1 == 0);
        values.for_each(|(axis, value)| at[*axis] = *value);
        machine.forward(&at, &Setup::default()).tip.coords.into()
    };
    let runs: Vec<&Run> = runs.into_iter().collect();
    let is_used = |offset: &&WorkOffset| runs.iter().any(|run| run.control.uses_work_system(offset.system));
    let used = machine.offsets.iter().filter(is_used);
    used.map(|offset| (offset.system.name(machine.dialect), zero(&offset.values))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use gcode_inspect::machine::{AxisLink, Chain, Head};
    use gcode_lang::program::NoLibrary;
    use gcode_lang::program::modes::WorkSystem;
    use gcode_session::{Request, simulate};
    use nalgebra::{Point3, Vector3};

    /// A fork head whose pivot is 150 mm above the gauge line: G54 contains the pivot in Z, and its A, an angle of the head, turns nothing.
    /// Set by hand, the head may be at any angle.
    #[test]
    fn the_zero_of_a_head_is_where_a_tool_without_length_touches() {
        let link = AxisLink::rotary(3, Vector3::x_axis(), Point3::origin(), 1.0);
        let fork = HeadKind::Axes { chain: Chain(vec![link]), direction: Vector3::z_axis() };
        let offset =
            WorkOffset { system: WorkSystem::Standard(1), values: vec![(0, 20.0), (2, 150.0), (3, 90.0)] };
        let zeros_of = |kind: HeadKind| {
            let machine =
                Machine { head: Head::new(kind, 150.0), offsets: vec![offset.clone()], ..Machine::default() };
            let request = Request::new("O1.nc", *b"O1\nG90 G00 X1. Z5.\nM30", machine.clone());
            let simulation = simulate(&request, &mut NoLibrary, None).unwrap();
            zeros(&machine, [&simulation.run])
        };
        let [(name, at)] = &zeros_of(fork)[..] else { panic!("one zero") };
        let distance = (Point3::from(*at) - Point3::new(20.0, 0.0, 0.0)).norm();
        assert!(name == "G54" && distance < 1e-9, "{name} {at:?}");
        assert_eq!(zeros_of(HeadKind::Manual { start: None }), []);
    }

    /// G54 at X300, G55 at X20, G54.1 P2 at X50. G53 moves before any offset is selected, and G28 through the position.
    #[test]
    fn an_offset_in_which_nothing_is_placed_has_no_zero() {
        let offset = |system, x| WorkOffset { system, values: vec![(0, x)] };
        let systems = [WorkSystem::Standard(1), WorkSystem::Standard(2), WorkSystem::Additional(2)];
        let offsets =
            systems.into_iter().zip([300.0, 20.0, 50.0]).map(|(system, x)| offset(system, x)).collect();
        let head = Head::new(HeadKind::Fixed(Vector3::z_axis()), 0.0);
        let machine = Machine { head, offsets, ..Machine::default() };
        let zeros_of = |program: &str| {
            let request = Request::new("O1.nc", program.as_bytes(), machine.clone());
            let simulation = simulate(&request, &mut NoLibrary, None).unwrap();
            zeros(&machine, [&simulation.run])
        };
        let at = |name: &str, x: f64| (name.to_owned(), [x, 0.0, 0.0]);
        assert_eq!(zeros_of("O1\nG90 G53 G00 Z0.\nG91 G28 Z0.\nG90 G55 X1. Z5.\nM30"), [at("G55", 20.0)]);
        assert_eq!(
            zeros_of("O1\nG90 G00 X1. Z5.\nG54.1 P2 X1.\nM30"),
            [at("G54", 300.0), at("G54.1 P2", 50.0)]
        );
        assert_eq!(zeros_of("O1\nG55\nG55 G53 G00 Z0.\nM30"), []);
    }
}
