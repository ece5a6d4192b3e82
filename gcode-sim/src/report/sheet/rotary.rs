//! The rotary axes on a set-up sheet: what each of them turns, its sense as it is seen at the machine, and its first angle.
use maud::{Markup, html};
use nalgebra::Vector3;

use super::layout::{blank, cell, table};
use super::recorder::OffsetObserver;
use crate::report::figures::short;
use gcode_inspect::machine::{AxisLink, HeadKind, LinkMotion, Machine};

/// Least part of a direction along a machine axis that names it.
const ALONG: f64 = 0.99;

/// Returns the section; nothing for a machine without rotary axes.
pub(super) fn section(machine: &Machine, observed: &OffsetObserver) -> Markup {
    let of_table = machine.table.0.iter().map(|link| (link, "the part"));
    let of_head = match &machine.head.kind {
        HeadKind::Axes { chain, .. } => chain.0.as_slice(),
        HeadKind::Free | HeadKind::Fixed(_) | HeadKind::Manual { .. } | HeadKind::Axis { .. } => &[],
    };
    let links = of_table.chain(of_head.iter().map(|link| (link, "the spindle")));
    let is_rotary = |link: &AxisLink| matches!(link.motion, LinkMotion::Rotary { .. });
    // Without a machine file nothing says which axes the machine has.
    let links: Vec<_> = links.filter(|(link, _)| is_rotary(link) && !machine.has_default_table).collect();
    let rows = links.iter().map(|(link, carried)| {
        let letter = machine.axes.letter(link.axis);
        let first = observed.first_angles.iter().find(|(axis, _)| *axis == link.axis);
        vec![
            cell(letter.to_string()),
            cell(sense(letter, link, carried)),
            match first {
                Some((_, angle)) => cell(format!("{letter}{}", short(*angle))),
                None => cell("not commanded"),
            },
            blank(),
        ]
    });
    html! {
        @if !links.is_empty() {
            h2 { "Rotary axes" }
            (table(&["axis", "sense by the machine file", "first angle in the program", "seen at the machine"], rows))
            p.note {
                "Command 10 degrees at the machine before the first cut and compare: with the other sense each hole off angle 0 is on "
                "the wrong side. The zero of a rotary axis is that of its work offset."
            }
        }
    }
}

/// Returns what a positive command moves: `A+ turns the part: its top moves towards Y+`.
fn sense(letter: char, link: &AxisLink, carried: &str) -> String {
    let LinkMotion::Rotary { about, .. } = &link.motion else { return String::new() };
    let is_upright = ALONG < about.z.abs();
    let (seen, name) = if is_upright {
        (Vector3::x(), "the side at X+")
    } else {
        (Vector3::z(), if carried == "the part" { "the top" } else { "the upper end" })
    };
    let towards = about.cross(&seen) * link.sign;
    let axis = (0..3).find(|axis| ALONG < towards[*axis].abs());
    match axis {
        Some(axis) => {
            let way = format!("{}{}", ["X", "Y", "Z"][axis], if towards[axis] < 0.0 { "−" } else { "+" });
            format!("{letter}+ turns {carried}: {name} moves towards {way}")
        }
        None => format!("{letter} turns {carried} about a direction between the machine axes"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Point3, Unit};

    /// About +x a right-handed rotation takes z to −y, about +y it takes z to x, about +z it takes x to y.
    #[test]
    fn a_sense_is_what_is_seen_to_move() {
        let words = |about: Vector3<f64>, sign: f64, carried: &str| {
            let link = AxisLink::rotary(3, Unit::new_normalize(about), Point3::origin(), sign);
            sense('A', &link, carried)
        };
        assert_eq!(words(Vector3::x(), 1.0, "the part"), "A+ turns the part: the top moves towards Y−");
        assert_eq!(words(Vector3::x(), -1.0, "the part"), "A+ turns the part: the top moves towards Y+");
        assert_eq!(
            words(Vector3::y(), 1.0, "the spindle"),
            "A+ turns the spindle: the upper end moves towards X+"
        );
        assert_eq!(
            words(Vector3::z(), -1.0, "the part"),
            "A+ turns the part: the side at X+ moves towards Y−"
        );
        assert!(words(Vector3::new(0.0, 1.0, 1.0), 1.0, "the part").contains("between the machine axes"));
    }
}
