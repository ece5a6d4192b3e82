//! One mistake that moves all holes: one finding instead of one for each hole.
use super::*;
use crate::findings::HOLES_TRANSFORMED;
use crate::verify::transformation::{Mistake, Transformation};

/// Shifts below this are not named, mm.
const MIN_SHIFT: f64 = 0.0005;

pub(super) fn check(inspection: &HoleInspection<'_>, findings: &mut HoleFindings) {
    let HoleInspection { comparison, machine, .. } = inspection;
    let Some(Transformation { mistake, extra, explained, backtrace }) = &inspection.transformation else {
        return;
    };
    let (summary, without, help) = describe(mistake, machine);
    let (count, all) = (explained.len(), extra.unwrap_or(comparison.nominal.len()));
    let holes = if extra.is_some() { "extra holes" } else { "holes" };
    let summary = if extra.is_some() { format!("{all} extra holes: {summary}") } else { summary };
    let message = format!("{summary}; {without} {count} of {all} {holes} are in position");
    let finding = Diagnostic::new(&HOLES_TRANSFORMED, message).help(help);
    findings.add_summed(Subject::Whole, locate_at_call(finding, backtrace), summary);
}

/// Returns the mistake in words for the first line of the verdict, what puts the holes in position, and the remedy.
fn describe(mistake: &Mistake, machine: &Machine) -> (String, String, String) {
    let words =
        |summary: &str, without: &str, help: &str| (summary.to_owned(), without.to_owned(), help.to_owned());
    match mistake {
        Mistake::MillimetresAsInches => words(
            "the coordinates are 25.4 times too large",
            "read in mm",
            "if the list is in inches, say so in it: `x (inch)` in the header of a CSV list, \"unit\": \"inch\" in JSON; else the numbers of the program are mm and count as inches (G20, or the unit at power-on): command G21 before the first motion",
        ),
        Mistake::InchesAsMillimetres => words(
            "the coordinates are 25.4 times too small",
            "read in inches",
            "the numbers are inches and count as mm (G21, or the unit at power-on): command G20 before the first motion",
        ),
        Mistake::Negated(axes) => {
            let names = match axes {
                [true, true] => "x and y",
                [true, false] => "x",
                _ => "y",
            };
            (
                format!("the holes are mirrored in {names}"),
                format!("with {names} negated"),
                "check the signs of the coordinates, and for a mirror image (G51.1) left in force".to_owned(),
            )
        }
        Mistake::Exchanged => {
            words("x and y are exchanged", "exchanged back", "exchange X and Y in the program")
        }
        Mistake::Turned(degrees) => (
            format!("the holes are rotated by {degrees:+.0}° about the work zero"),
            "rotated back".to_owned(),
            "check the rotation (G68), the axes of the drawing, and how the part is clamped".to_owned(),
        ),
        Mistake::Shifted(by) => (
            format!("the holes are shifted by {}", shift_words(by)),
            "without the shift".to_owned(),
            missing_origin(machine, by).unwrap_or_else(|| {
                let others = match by.z.abs() < MIN_SHIFT {
                    true => "and the point from which the program counts",
                    false => {
                        "the tool length and its H; in G91 R counts from the level before it, and Z from R"
                    }
                };
                format!("check the work offset (G54 to G59), G52, G92, {others}")
            }),
        ),
        Mistake::Rotated(axis, by) => {
            let letter = machine.axes.letter(*axis);
            (
                format!("the holes are rotated by {letter}{:+.3}°", by.0),
                "without that angle".to_owned(),
                format!("correct {letter} in the program, or its zero in the work offset"),
            )
        }
        Mistake::AbsoluteAsIncrements => words(
            "the holes are counted from one another",
            "as absolute points (G90)",
            "the points are absolute and G91 is in force: command G90 before them",
        ),
        Mistake::IncrementsAsAbsolute => words(
            "the holes are counted from the work zero",
            "as increments (G91)",
            "the points are increments and G90 is in force: command G91 before them",
        ),
    }
}

/// Returns `X+100.000 Y-5.000`: a shift in its axes, without those of no shift.
pub(super) fn shift_words(by: &Vector3<f64>) -> String {
    let axes = [('X', by.x), ('Y', by.y), ('Z', by.z)].into_iter();
    let named = axes.filter(|(_, by)| MIN_SHIFT <= by.abs());
    named.map(|(letter, by)| format!("{letter}{by:+.3}")).collect::<Vec<_>>().join(" ")
}

/// Returns the remedy for a machine file that states a work offset and no origin of the part: then the part counts from machine
/// zero, and its holes are shifted by that offset.
fn missing_origin(machine: &Machine, by: &Vector3<f64>) -> Option<String> {
    if machine.part.origin != Point3::origin() {
        return None;
    }
    let value = |values: &[(usize, f64)], letter: u8| {
        let axis = machine.axes.find(letter)?;
        values.iter().find(|(of, _)| *of == axis).map(|(_, value)| *value)
    };
    let is_shift = |(letter, shift): (u8, f64), values: &[(usize, f64)]| {
        value(values, letter).is_some_and(|value| (value - shift).abs() < MIN_SHIFT)
    };
    let offset = machine
        .offsets
        .iter()
        .find(|offset| [(b'X', by.x), (b'Y', by.y)].into_iter().all(|part| is_shift(part, &offset.values)))?;
    let (name, values) = (offset.system.name(machine.dialect), &offset.values);
    let [x, y, z] = [b'X', b'Y', b'Z'].map(|letter| value(values, letter).unwrap_or(0.0));
    Some(format!(
        "the machine file states {name} and no origin of the part: write below [part] origin = [{x:?}, {y:?}, {z:?}], the \
         part's zero in machine coordinates"
    ))
}
