//! Remedies for the alarms of the measurements, for the set-up sheet. Alarms that refuse an argument of a
//! call are omitted: the generator writes and tries the calls.

/// An alarm that a macro or main program raises because of the machine, the part or the operation.
pub(crate) struct MacroAlarm {
    /// n of `#3000=n`.
    pub(crate) number: u32,
    /// Text as the control shows it.
    pub(crate) text: &'static str,
    /// Remedy at the machine.
    pub(crate) remedy: &'static str,
}

const fn alarm(number: u32, text: &'static str, remedy: &'static str) -> MacroAlarm {
    MacroAlarm { number, text, remedy }
}

const SHIFT: &str = "Cancel the offset left in force: G52 X0 Y0 Z0 or G92.1. Check that G54 is the work \
                     zero of this sheet; start again.";
const CHANGED: &str = "Cancel the modes left in force, in MDI: G15, G50, G50.1 and G69, as far as the \
                       control has them. Start again.";
const START: &str = "The path to the part would lead through it. Move the ball up above the part's pole, \
                     or to X+; start again.";
const NEEDS: &str = "The program's second block or the call has been changed: load the programs again.";

/// The alarms in the order of the work.
pub(crate) const ALARMS: &[MacroAlarm] = &[
    alarm(138, "G52 OR G92 SHIFT IN X Y Z", SHIFT),
    alarm(139, "G16 G51 G51.1 G68 IN FORCE", CHANGED),
    alarm(140, "START ABOVE POLE OR AT +X", START),
    alarm(153, "NEEDS G21 G40 G49 G54 G94", NEEDS),
    alarm(
        154,
        "TOUCHES V BEFORE SURFACE",
        "The part protrudes too far, or the probe signals all the time. Move the ball away towards X+; \
         check the probe by hand; set the part up more accurately.",
    ),
    alarm(
        155,
        "NO CONTACT",
        "The ball went as far behind the surface as it started in front of it. Check that the probe is on, \
         that the part is there, and G54. Move the ball away towards X+, then start again.",
    ),
    alarm(
        156,
        "TILT NOT TOLD FROM SHIFT",
        "The readings are too close to each other: use wider angles or heights farther apart in the job, \
         and emit the programs again.",
    ),
    alarm(
        157,
        "READINGS DO NOT FIT",
        "#585 is the residual of the fit. Look for a touch on dirt or a loose probe and repeat; if it \
         stays, the ball's radius, a or b of the job or G54 do not match the part. No result is left; do \
         not move the part.",
    ),
    alarm(
        158,
        "Y SHIFT #584 TOO LARGE",
        "The part appears to be this much too high: check Y of G54, the ball's radius and b. No result is \
         left; do not move the part.",
    ),
    alarm(165, "NO TILT IN #583, RUN O8210", "The tilt is already used up: run O8210 first."),
    alarm(
        167,
        "RUN-OUT NOT ENDED, #585",
        "O8210 was interrupted or ended in an alarm: run it to its end first.",
    ),
    alarm(168, "TILT #583 BEYOND 1 DEGREE", "Set the part up more accurately by hand, then run O8210 again."),
    alarm(
        166,
        "PHI BEYOND 0. TO 45.",
        "The corrected angle is out of the sine table's range: check that #596 is the table's angle, and \
         the direction of the table.",
    ),
    alarm(
        169,
        "SET #596, PHI OF THE TABLE",
        "RESET came while #596 was changed. Write the angle of the blocks under the table to it, \
         asin(height/L); start again.",
    ),
    alarm(137, "G52 OR G92 SHIFT IN X Y Z", SHIFT),
    alarm(120, "G16 G51 G51.1 G68 IN FORCE", CHANGED),
    alarm(131, "NEEDS G21 G40 G49 G54 G94", NEEDS),
    alarm(
        133,
        "TOUCHES V ABOVE SURFACE",
        "As TOUCHES V BEFORE SURFACE, with the ball moved up, towards Y+. The points are lost.",
    ),
    alarm(134, "NO CONTACT", "As in O8210, with the ball moved up, towards Y+. The points are lost."),
    alarm(
        135,
        "TOUCH BROKEN OFF, SET #578",
        "RESET came during a touch. Write 0. to #578 to touch all points again; or make it vacant and \
         enter all candidates by hand.",
    ),
    alarm(
        136,
        "#578 NOT VACANT, 0. OR 1.",
        "Write 0. to it to touch all points again; make it vacant if marks were entered.",
    ),
    alarm(132, "TOO STEEP TO TOUCH ALONG Y", "Measure the candidates by hand and enter them."),
    alarm(
        68,
        "A CANDIDATE IS MISSING",
        "Enter x, y and z of all candidates: E's from #501 on, F's from #531 on; or make all of them \
         vacant, so that they are touched.",
    ),
    alarm(
        73,
        "POINT #570 IS FAR FROM E",
        "Mistyped: #570 is its number. Correct it from #501 + 3·(#570 − 1) on, start again; the others are kept.",
    ),
    alarm(
        74,
        "POINT #571 IS FAR FROM F",
        "Mistyped: #571 is its number. Correct it from #531 + 3·(#571 − 1) on, start again; the others are kept.",
    ),
    alarm(
        75,
        "E F UNEVEN, O8210 FIRST",
        "The part is higher over one of E and F than a part set right by the run-out: O8210 and O8230 \
         first. The points are lost.",
    ),
    alarm(
        72,
        "E AND F TOO NEAR FOR Y",
        "Touched points this close to each other do not determine y: move E and F farther apart in the \
         job, or enter marks by hand.",
    ),
    alarm(
        71,
        "POINTS ARE FAR FROM E F",
        "No correction of a part set right by the run-out: O8210 first; check that the marks are those of \
         E and F, not exchanged.",
    ),
    alarm(69, "NEEDS G21 AND G54 TO G59", NEEDS),
    alarm(112, "G52 OR G92 SHIFT IN X Y Z", SHIFT),
    alarm(113, "G16 G51 G51.1 G68 IN FORCE", CHANGED),
    alarm(114, "START ABOVE POLE OR AT +X", START),
    alarm(111, "NEEDS G21 G40 G49 G54 G94", NEEDS),
];

#[cfg(test)]
mod tests {
    use super::super::emit;
    use super::*;
    use gcode_part::job::{Alignment, Job};

    fn job() -> Alignment {
        match Job::parse(super::super::FAMILY.new_job) {
            Ok(Job::Alignment(job)) => job,
            other => panic!("{other:?}"),
        }
    }

    /// Returns number and text of every `#3000=` in a text.
    fn raised(text: &str) -> impl Iterator<Item = (u32, &str)> {
        text.split("#3000=").skip(1).map(|rest| {
            let (number, rest) = rest.split_once('(').unwrap();
            (number.parse().unwrap(), rest.split_once(')').unwrap().0)
        })
    }

    #[test]
    fn every_alarm_but_those_of_arguments_is_here_with_its_text() {
        let package = emit(&job());
        let mut unknown = Vec::new();
        for program in &package.programs {
            // Macros check their arguments last.
            let own = program.text.split("(REFUSED,").next().unwrap();
            let known = |(number, text): &(u32, &str)| {
                ALARMS.iter().any(|alarm| alarm.number == *number && alarm.text == *text)
            };
            unknown.extend(
                raised(own).filter(|raised| !known(raised)).map(|(number, text)| format!("{number} {text}")),
            );
        }
        assert!(unknown.is_empty(), "{unknown:?}");
        for alarm in ALARMS {
            let there = package
                .programs
                .iter()
                .any(|program| raised(&program.text).any(|raised| raised == (alarm.number, alarm.text)));
            assert!(there, "nothing raises {} {}", alarm.number, alarm.text);
        }
    }
}
