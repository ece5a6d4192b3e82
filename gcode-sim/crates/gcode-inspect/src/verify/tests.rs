//! Runs that are right by construction and runs with one fault each, compared with a job's reference.
//!
//! The runs are built from the section's parametric form, (a·cos t, b·sin t) with the tangent (−a·sin t, b·cos t):
//! neither the reference's search nor any formula of the generator.
use proptest::prelude::*;

use super::{Answer, Tolerances, Verdict, verify};
use crate::holes::HoleExtractor;
use crate::holes::event_script::EventScript;
use crate::machine::{Head, HeadKind, Machine, Tool};
use gcode_lang::units::Deg;
use gcode_part::NominalPart;
use gcode_part::Reference;
use gcode_part::job::Job;

#[derive(Clone, Copy, Debug)]
struct Section {
    a: f64,
    b: f64,
}

/// A hole by its parameter t on the section (90° at the pole) and its azimuth.
#[derive(Clone, Copy, Debug)]
struct NominalHole {
    t: f64,
    azimuth: f64,
    axial: bool,
}

impl Section {
    fn radius(self, nominal: NominalHole) -> f64 {
        self.a * Deg(nominal.t).cos()
    }

    /// Returns a point `above` the surface along the hole's axis, and the angle of that axis from x.
    fn above(self, nominal: NominalHole, above: f64) -> (f64, f64, Deg) {
        let (c, s) = (Deg(nominal.t).cos(), Deg(nominal.t).sin());
        let angle = if nominal.axial { Deg(90.0) } else { Deg::atan2(self.a * s, self.b * c) };
        (self.a * c + above * angle.cos(), self.b * s + above * angle.sin(), angle)
    }

    /// Returns the word for a height above the part with any head.
    fn high(self) -> String {
        format!("Y{:.3}", 4.0 * self.a.max(self.b) + 700.0)
    }

    fn reference(self, holes: &[NominalHole]) -> Reference {
        let mut text = format!(
            "family = \"pin-holes\"\n[control]\ndialect = \"fanuc-31i\"\nincrement = \"IS-B\"\n\
             [machine]\nrotary = {{ letter = \"B\", sign = 1 }}\n\
             [surface]\nkind = \"ellipsoid\"\na = {}\nb = {}\n[tolerance]\nposition = 0.1\n",
            self.a, self.b
        );
        for (index, nominal) in holes.iter().enumerate() {
            let axis = if nominal.axial { "axial" } else { "normal" };
            text += &format!(
                "[[hole]]\nid = \"{}\"\nradius = {:?}\nazimuth = {:?}\naxis = \"{axis}\"\ndiameter = 6.0\ndepth = 15.0\n",
                index + 1,
                self.radius(*nominal),
                nominal.azimuth
            );
        }
        NominalPart::from_job(&Job::parse(&text).unwrap()).unwrap().into_holes().unwrap()
    }
}

/// Moves that drill one hole; a fault changes a field.
#[derive(Clone, Copy)]
struct Drilling {
    sign: f64,
    /// Added to every point, machine x y z.
    shift: [f64; 3],
    /// Added to the direction of tool and feed, about the entry.
    lean: f64,
    depth: f64,
    set_head: bool,
    /// Distance of the programmed point from the tip.
    reach: f64,
}

const RIGHT: Drilling =
    Drilling { sign: 1.0, shift: [0.0; 3], lean: 0.0, depth: 15.0, set_head: true, reach: 0.0 };

fn drill(script: EventScript, section: Section, nominal: NominalHole, drilling: Drilling) -> EventScript {
    let (x, y, angle) = section.above(nominal, 0.0);
    let angle = angle + Deg(drilling.lean);
    let at = |height: f64| {
        let along = height + drilling.reach;
        let (x, y) =
            (x + along * angle.cos() + drilling.shift[0], y + along * angle.sin() + drilling.shift[1]);
        format!("X{x:.3} Y{y:.3}")
    };
    let high = section.high();
    let turn = format!("B{:.3} Z{:.3}", drilling.sign * nominal.azimuth, drilling.shift[2]);
    let over = at(20.0).split_whitespace().next().unwrap().to_owned();
    let script = if drilling.set_head { script.head(angle.0) } else { script };
    // A rapid of two axes is no straight line: the tool leaves the hole by a feed.
    let script = script.rapid(&turn).rapid(&over).rapid(&at(20.0)).feed(&at(-drilling.depth));
    script.feed(&at(20.0)).rapid(&high)
}

fn start(section: Section) -> EventScript {
    EventScript::new().rapid(&section.high())
}

fn judge(machine: &Machine, reference: &Reference, script: &EventScript) -> Verdict {
    let mut extractor = HoleExtractor::new(machine).with_surface(reference.surface);
    script.emit_to(&mut extractor);
    let locate = |span: gcode_lang::source::Span| ("O8101".to_owned(), span.start);
    verify(&extractor.finish(), reference, Tolerances::of(reference, None), machine, &locate)
}

fn codes(verdict: &Verdict) -> Vec<&str> {
    verdict.findings.iter().map(|finding| &*finding.code).collect()
}

const PAPER: Section = Section { a: 1158.8, b: 724.3 };

/// Five holes: one axial, four normal, on three radii; azimuths beyond 180° and negative.
fn five() -> Vec<NominalHole> {
    let nominal = |t, azimuth, axial| NominalHole { t, azimuth, axial };
    vec![
        nominal(70.0, 0.0, true),
        nominal(50.0, 30.0, false),
        nominal(50.0, 210.0, false),
        nominal(30.0, -75.0, false),
        nominal(30.0, 330.0, false),
    ]
}

/// Drills the five holes; `change` returns the drilling of each, counted from 0.
fn drill_all(change: impl Fn(usize) -> Drilling) -> EventScript {
    let holes = five().into_iter().enumerate();
    holes.fold(start(PAPER), |script, (index, nominal)| drill(script, PAPER, nominal, change(index)))
}

fn verdict_on(script: &EventScript) -> Verdict {
    judge(&Machine::default(), &PAPER.reference(&five()), script)
}

#[test]
fn five_right_holes_pass_within_the_effect_of_rounding() {
    let verdict = verdict_on(&drill_all(|_| RIGHT));
    assert_eq!(verdict.verdict, Answer::Pass, "{:?}", codes(&verdict));
    assert_eq!((verdict.holes.len(), codes(&verdict).len()), (5, 0));
    for hole in &verdict.holes {
        assert!(hole.position_deviation <= hole.rounding + 1e-9, "{hole:?}");
    }
    // Half of 0.001° at the largest radius, 1158.8·cos 30°, is 0.00876 mm; X and Y add half of 0.001 each, sideways.
    let b = 1158.8 * Deg(30.0).cos() * Deg(0.0005).to_rad();
    let rounding = verdict.rounding.unwrap();
    assert!(rounding > 2.0 * b && rounding < 2.0 * (b + 0.001), "{rounding}");
    assert!(verdict.worst_from.unwrap().contains("within the effect of rounding"));
}

/// One hole at azimuth 0, so that B is not rounded: only X and Y are, and the head if its angle is not whole. Half of
/// 0.001° over a depth of 15 mm is 15·0.0005·π/180 = 0.000131 mm, at the bottom.
#[test]
fn a_head_set_by_hand_has_its_share_of_rounding() {
    let machine = Machine { head: Head::new(HeadKind::Manual { start: None }, 0.0), ..Machine::default() };
    let share = |axial, machine: &Machine, drilling| {
        let nominal = NominalHole { t: 50.0, azimuth: 0.0, axial };
        let script = drill(start(PAPER), PAPER, nominal, drilling);
        let verdict = judge(machine, &PAPER.reference(&[nominal]), &script);
        assert_eq!(verdict.verdict, Answer::Pass, "{:?}", codes(&verdict));
        let (angle, rounding) = (PAPER.above(nominal, 0.0).2, verdict.rounding.unwrap());
        // Half an increment of X and of Y, whichever of both signs is worse across the hole.
        let feed = 0.0005 * (angle.sin().abs() + angle.cos().abs());
        let x_alone = 0.0005 * angle.sin();
        (rounding / 2.0 - if axial { x_alone } else { feed }, verdict.worst_from.unwrap())
    };
    let (more, said) = share(false, &machine, RIGHT);
    assert!((more - 0.000_130_9).abs() < 1e-6 && said.contains("head 0.0001"), "{more} {said}");
    // The same for a head of which only the message to the operator is known.
    let (more, said) = share(false, &Machine::default(), RIGHT);
    assert!((more - 0.000_130_9).abs() < 1e-6 && said.contains("head 0.0001"), "{more} {said}");
    // Whole degrees, and a head that is not set.
    for (axial, drilling) in [(true, RIGHT), (false, Drilling { set_head: false, ..RIGHT })] {
        let (more, said) = share(axial, &Machine::default(), drilling);
        assert!(more.abs() < 1e-6 && !said.contains("head"), "{more} {said}");
    }
}

/// A tilt of 0.7° over 15 mm is 15·tan 0.7° = 0.1833 mm at the bottom.
#[test]
fn a_fault_of_one_hole_is_found_at_that_hole_alone() {
    let aside = |shift| (0, Drilling { shift, ..RIGHT }, "hole-position", "is out of position: Φ0.1");
    let depth = |depth, said| (4, Drilling { depth, ..RIGHT }, "hole-depth", said);
    for (fault, drilling, code, said) in [
        aside([0.08, 0.0, 0.0]),
        aside([0.0, 0.0, 0.08]),
        (2, Drilling { lean: 0.7, ..RIGHT }, "hole-tilted", "is tilted by 0.7"),
        depth(14.5, "0.500 mm too shallow"),
        depth(15.2, "0.200 mm too deep"),
    ] {
        let verdict = verdict_on(&drill_all(|index| if index == fault { drilling } else { RIGHT }));
        assert_eq!((verdict.verdict, codes(&verdict)), (Answer::Fail, vec![code]));
        let message = &verdict.findings[0].message;
        assert!(message.contains(said), "{message}");
        let bad: Vec<usize> = (0..5).filter(|index| !verdict.holes[*index].ok).collect();
        assert_eq!(bad, [fault]);
        let hole = &verdict.holes[fault];
        if code == "hole-position" {
            assert!((hole.position_deviation - 0.16).abs() < 0.002, "{}", hole.position_deviation);
            assert!(verdict.worst_from.unwrap().contains("beyond the effect of rounding"));
        } else if code == "hole-tilted" {
            assert!((hole.at_bottom - 0.1833).abs() < 0.01 && hole.at_entry < 0.01, "{hole:?}");
        }
    }
}

/// The feed is right and the head is not: the hole is tilted, and the tool is dragged sideways.
#[test]
fn a_wrong_head_angle_is_a_tilt_and_a_feed_off_the_tool() {
    let mut script = start(PAPER);
    for (index, nominal) in five().into_iter().enumerate() {
        let angle = PAPER.above(nominal, 0.0).2 + Deg(if index == 1 { 0.7 } else { 0.0 });
        script = drill(script.head(angle.0), PAPER, nominal, Drilling { set_head: false, ..RIGHT });
    }
    let verdict = verdict_on(&script);
    assert_eq!(
        (verdict.verdict, codes(&verdict)),
        (Answer::Fail, vec!["hole-tilted", "feed-not-along-tool"])
    );
}

#[test]
fn a_wrong_sign_of_b_is_named() {
    let script = drill_all(|_| Drilling { sign: -1.0, ..RIGHT });
    let verdict = verdict_on(&script);
    assert_eq!(verdict.verdict, Answer::Fail);
    assert_eq!(codes(&verdict)[0], "rotary-sign", "{:?}", codes(&verdict));
    // Holes 2 and 5 are at azimuths 30° and 330° but on other radii; only the one at azimuth 0 is in position.
    assert_eq!((verdict.missing.len(), verdict.extra.len()), (4, 4));
    let mut other = Machine::default();
    other.table.0[0].sign = -1.0;
    let right = judge(&other, &PAPER.reference(&five()), &script);
    assert_eq!(right.verdict, Answer::Pass, "the same program on the machine with this sign");
}

#[test]
fn missing_repeated_and_extra_holes_are_named() {
    let script =
        five()[..4].iter().fold(start(PAPER), |script, nominal| drill(script, PAPER, *nominal, RIGHT));
    let verdict = verdict_on(&script);
    assert_eq!((verdict.verdict, codes(&verdict)), (Answer::Fail, vec!["hole-missing"]));
    assert_eq!(verdict.missing, ["5"]);
    let verdict = verdict_on(&drill(drill_all(|_| RIGHT), PAPER, five()[2], RIGHT));
    assert_eq!((verdict.verdict, codes(&verdict)), (Answer::Pass, vec!["hole-twice"]));
    assert_eq!((verdict.holes.len(), verdict.extra.len()), (5, 0));
    assert_eq!(verdict.repeated, [(3, "3".to_owned())]);
    assert_eq!(verdict.findings[0].message, "hole 3 is drilled a second time");
    let nominal = NominalHole { t: 40.0, azimuth: 12.0, axial: false };
    let verdict = verdict_on(&drill(drill_all(|_| RIGHT), PAPER, nominal, RIGHT));
    assert_eq!((verdict.verdict, codes(&verdict)), (Answer::Fail, vec!["hole-extra"]));
}

#[test]
fn a_hole_finished_by_the_drill_alone_has_the_wrong_diameter() {
    let tool = |number, diameter| Tool { number, diameter: Some(diameter), ..Tool::default() };
    let machine = Machine { tools: vec![tool(1, 5.9), tool(2, 6.0)], ..Machine::default() };
    let by = |number: u32, holes: &[NominalHole], script: EventScript| {
        holes.iter().fold(script.then(&format!("tool {number}")), |script, nominal| {
            drill(script, PAPER, *nominal, RIGHT)
        })
    };
    let reference = PAPER.reference(&five());
    let both = by(2, &five(), by(1, &five(), start(PAPER)));
    let verdict = judge(&machine, &reference, &both);
    assert_eq!((verdict.verdict, verdict.holes.len()), (Answer::Pass, 5), "{:?}", codes(&verdict));
    let drilled = by(2, &five()[1..], by(1, &five(), start(PAPER)));
    let verdict = judge(&machine, &reference, &drilled);
    assert_eq!((verdict.verdict, codes(&verdict)), (Answer::Fail, vec!["hole-diameter", "hole-tools"]));
}

/// A part 0.2 mm off its position, and one tilted by 0.05° about z, with a right program.
#[test]
fn a_misplaced_part_gets_displaced_holes() {
    let mut machine = Machine::default();
    machine.part.shift.x = 0.2;
    let verdict = judge(&machine, &PAPER.reference(&five()), &drill_all(|_| RIGHT));
    // The part is shifted to +x, so the hole at azimuth 0 is 0.2 mm nearer to its axis.
    assert!((verdict.holes[0].actual.entry[0] - verdict.holes[0].nominal.entry[0] + 0.2).abs() < 0.001);
    assert_eq!(verdict.verdict, Answer::Fail);
    let mut machine = Machine::default();
    machine.part.tilt[2] = Deg(0.05);
    let verdict = judge(&machine, &PAPER.reference(&five()), &drill_all(|_| RIGHT));
    assert!((verdict.holes[0].tilt - 0.05).abs() < 1e-6, "{}", verdict.holes[0].tilt);
}

#[test]
fn a_run_without_holes_has_no_worst_hole() {
    let verdict = verdict_on(&start(PAPER));
    assert_eq!((verdict.verdict, verdict.worst, verdict.missing.len()), (Answer::Fail, None, 5));
}

fn holes() -> impl Strategy<Value = Vec<NominalHole>> {
    // 15° apart round the axis, so that no two are one hole; the first is near the pole.
    let hole = (14.1..86.0, 0.0..9.0, -2i32..=2, any::<bool>());
    prop::collection::vec(hole, 24).prop_map(|holes| {
        let nominal = |(index, (t, jitter, turns, axial)): (usize, (f64, f64, i32, bool))| NominalHole {
            t: if index == 0 { 89.9999 } else { t },
            azimuth: 15.0 * index as f64 + jitter + 360.0 * f64::from(turns),
            axial,
        };
        holes.into_iter().enumerate().map(nominal).collect()
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    /// Flat and prolate ellipsoids and spheres, both signs, 24 holes from near 0 to 0.97·a, heads of every kind.
    #[test]
    fn right_runs_pass_within_the_effect_of_rounding(
        (a, ratio) in (150.0..2000.0, prop_oneof![Just(1.0), 0.4..2.5]),
        holes in holes(),
        negative in any::<bool>(),
        (manual, pivot, length) in (any::<bool>(), 0.0..200.0, 50.0..150.0),
    ) {
        let section = Section { a, b: a * ratio };
        let reference = section.reference(&holes);
        let mut machine = Machine::default();
        let drilling = Drilling { sign: if negative { -1.0 } else { 1.0 }, set_head: manual, ..RIGHT };
        machine.table.0[0].sign = drilling.sign;
        let script = holes.iter().fold(start(section), |script, nominal| drill(script, section, *nominal, drilling));
        let verdict = judge(&machine, &reference, &script);
        prop_assert_eq!(verdict.verdict, Answer::Pass, "{:?}", codes(&verdict));
        for hole in &verdict.holes {
            prop_assert!(hole.position_deviation <= hole.rounding + 1e-8, "{} {} {}", hole.id, hole.position_deviation, hole.rounding);
        }

        // The same holes with a head that has a pivot and a tool of a length: the pivot point is programmed.
        machine.head = Head::new(HeadKind::Manual { start: None }, pivot);
        machine.tools = vec![Tool { number: 7, length: Some(length), diameter: None, ..Tool::default() }];
        let drilling = Drilling { reach: pivot + length, set_head: true, ..drilling };
        let begin = start(section).then("tool 7");
        let script = holes.iter().fold(begin, |script, nominal| drill(script, section, *nominal, drilling));
        let verdict = judge(&machine, &reference, &script);
        prop_assert_eq!(verdict.verdict, Answer::Pass, "{:?}", codes(&verdict));
    }
}
