//! Differences of a hole between two revisions, a few words each, for pictures and pages.
use super::figures::with_sign;
use gcode_inspect::holes::DrilledHole;
use gcode_lang::units::Deg;
use gcode_review::Paired;

/// A hole of one revision, and the tools that make it.
pub(super) type HoleWithTools<'a> = (&'a DrilledHole, &'a [u32]);

/// Returns the differences; none for an unchanged hole or one that only one revision makes.
pub(super) fn remarks(
    pair: &Paired,
    was: Option<HoleWithTools<'_>>,
    is: Option<HoleWithTools<'_>>,
) -> Vec<String> {
    let (true, Some((was, before)), Some((is, now))) = (pair.changed, was, is) else { return Vec::new() };
    let mut words = Vec::new();
    let seen = |value: f64| 0.0005 <= value.abs();
    words.extend(seen(pair.moved).then(|| format!("moved {:.3}", pair.moved)));
    words.extend(seen(pair.deeper).then(|| format!("depth {}", with_sign(pair.deeper))));
    if let (Some(was), Some(is)) = (was.diameter, is.diameter)
        && 1e-9 < (was - is).abs()
    {
        words.push(format!("Φ{is}, was Φ{was}"));
    }
    if before != now && !before.is_empty() && !now.is_empty() {
        words.push(format!("{}, was {}", tools(now), tools(before)));
    }
    let Deg(tilted) = pair.tilted;
    words.extend(seen(tilted).then(|| format!("tilted {tilted:.3}°")));
    if words.is_empty() {
        words.push("changed".to_owned());
    }
    words
}

/// Returns `T1 T2`.
pub(super) fn tools(numbers: &[u32]) -> String {
    numbers.iter().map(|tool| format!("T{tool}")).collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use gcode_inspect::machine::Machine;
    use gcode_lang::program::NoLibrary;
    use gcode_review::{Revision, RevisionDiff};
    use gcode_session::Request;

    fn all_remarks(old: &str, new: &str) -> Vec<Vec<String>> {
        let made = |text: &str| {
            let request = Request::new("O1.nc", text.as_bytes(), Machine::default());
            Revision::of(&request, &mut NoLibrary, None).unwrap()
        };
        let sides = [made(old), made(new)];
        let lists = [0, 1].map(|side: usize| sides[side].record.made_by());
        let compared = RevisionDiff::new(&sides[0].record, &sides[1].record, 1e-4);
        let of = |side: usize, hole: Option<usize>| {
            hole.map(|hole| (&sides[side].simulation.extracted.holes[hole], lists[side][hole].as_slice()))
        };
        compared.holes.iter().map(|pair| remarks(pair, of(0, pair.old), of(1, pair.new))).collect()
    }

    /// Spot drilled by T1 and drilled by T2 to 20 mm; then drilled by T2 alone, 2 mm less deep and 0.03 mm
    /// off.
    #[test]
    fn a_changed_hole_has_all_its_tools() {
        let pass = |tool: u32, x: &str, y: &str| {
            format!("T{tool} M6\nS500 M3\nG0 Y50.\nX{x} Z0\nG1 Y{y} F100\nG0 Y50.\n")
        };
        let program = |passes: &[String]| format!("O1\nG90\n{}M30\n", passes.concat());
        let old = program(&[pass(1, "10.", "-2."), pass(2, "10.", "-20.")]);
        assert_eq!(all_remarks(&old, &old), [Vec::<String>::new()]);
        assert_eq!(
            all_remarks(&old, &program(&[pass(2, "10.", "-18.")])),
            [["depth −2.000", "T2, was T1 T2"]]
        );
        let moved = program(&[pass(1, "10.03", "-2."), pass(2, "10.03", "-20.")]);
        assert_eq!(all_remarks(&old, &moved), [["moved 0.030"]]);
    }
}
