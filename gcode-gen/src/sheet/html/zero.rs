//! The work zero: a drawing for each family, and the offsets and signs in words.
use gcode_inspect::verify::Verdict;
use gcode_part::Flutes;
use gcode_part::job::{Alignment, Burr, Honeycomb, Job, PinHoles, Surface};
use gcode_sim::report::figures::short;
use maud::{Markup, html};

use super::drawing::{Anchor, Paper, WIDTH, arrow, centre_line, drawing, line, path, text, thin, zero_sign};
use crate::check::PackageVerdict;
use crate::sheet::Sheet;
use crate::sheet::stop_instructions::tip_is_programmed;

pub(super) fn zero(sheet: &Sheet<'_>) -> Markup {
    let (picture, words) = match (sheet.job, &sheet.checked.verdict) {
        (Job::PinHoles(job), PackageVerdict::Holes(verdict)) => (of_pin_holes(job, verdict), pin_holes(job)),
        (Job::Honeycomb(job), _) => (of_honeycomb(job), honeycomb(job)),
        (Job::Burr(job), _) => (of_burr(job), burr(job)),
        (Job::PinHoles(job), PackageVerdict::Flutes(_) | PackageVerdict::Measured) => {
            (html! {}, pin_holes(job))
        }
        (Job::Alignment(job), _) => (of_alignment(job), alignment(job)),
    };
    html! {
        div.together {
            h2 { "Work zero" }
            figure { (picture) figcaption { "Drawn to scale except tools and arrows; the symbol with two \
                                             black quarters is the work zero G54." } }
        }
        ul { @for sentence in words { li { (sentence) } } }
    }
}

fn pin_holes(job: &PinHoles) -> Vec<String> {
    let (letter, minus) = (job.machine.rotary.letter, if job.machine.rotary.sign < 0 { "−" } else { "" });
    let mut all = vec![
        format!(
            "G54: X0 Y0 Z0 is the centre of the ellipsoid. Y is its axis of revolution and the axis of {letter}; the pole \
             is at Y{}.",
            short(job.surface.b)
        ),
        format!(
            "{letter} = {minus}azimuth (sign {}); the azimuth counts from X towards Z, and {letter}0 has azimuth 0 in the plane \
             Z0 on the side of X+.",
            if minus.is_empty() { "+1" } else { "−1" }
        ),
        format!(
            "Check the sign before the first cut: with {letter} at {minus}10 the position of azimuth +10 \
             must be in the plane Z0. If it is on the other side the sign is wrong, and all holes are \
             mirrored."
        ),
    ];
    all.push(match tip_is_programmed(job) {
        true => "X and Y are the tip of the tool.".to_owned(),
        false => "X and Y are the pivot of the head; the program includes the pivot's distance and the \
                  tool's length."
            .to_owned(),
    });
    all.push("Start with the tool clear of the part, above or next to it.".to_owned());
    all
}

fn length(one: f64, other: f64) -> f64 {
    (one * one + other * other).sqrt()
}

/// Draws the section with the tool at every angle of the head.
fn of_pin_holes(job: &PinHoles, verdict: &Verdict) -> Markup {
    let mut tools: Vec<([f64; 4], String)> = Vec::new();
    for hole in &verdict.holes {
        let ([x, y, z], [i, j, k]) = (hole.nominal.entry, hole.nominal.axis);
        let one = [length(x, z), y, length(i, k), j];
        if !tools.iter().any(|(known, _)| (0..4).all(|at| (known[at] - one[at]).abs() < 1e-6)) {
            tools.push((one, format!("radius {}", short(one[0]))));
        }
    }
    section(job.surface, job.machine.rotary.letter, tools)
}

/// Returns a point of the surface in the plane z = 0 and the direction out of the part: x, y, across, up.
pub(super) fn on_surface(surface: Surface, x: f64) -> [f64; 4] {
    let (a, b) = (surface.a, surface.b);
    let y = b * (1.0 - (x / a) * (x / a)).sqrt();
    let (across, up) = (x / (a * a), y / (b * b));
    let long = length(across, up);
    [x, y, across / long, up / long]
}

fn alignment(job: &Alignment) -> Vec<String> {
    let (letter, minus) = (job.machine.rotary.letter, if job.machine.rotary.sign < 0 { "−" } else { "" });
    vec![
        format!(
            "G54: X0 Z0 on the axis of {letter}, Y0 at the centre of the ellipsoid, {} mm below its pole. \
             The reference point is the centre of the stylus ball.",
            short(job.surface.b)
        ),
        format!(
            "{letter} = {minus}azimuth (sign {}); the azimuth counts from X towards Z. The head does not rotate.",
            if minus.is_empty() { "+1" } else { "−1" }
        ),
        format!(
            "Check the sign before the first touch: rotate {letter} from 0 to +10. The side of the part at \
             X+ must move towards Z{}. If it moves in the opposite direction the sign is wrong, and the \
             run-out gives #581 and #582 with the wrong sign, which no fit can detect.",
            if minus.is_empty() { "−" } else { "+" }
        ),
        format!(
            "Set X and Z of G54 on a surface that rotates with {letter}, the bore of the table or a ground \
             ring, not on the part: rotate it by 180 and halve the indicator reading. A zero that is off \
             in X appears as a shift and a tilt of the part, one in Z is not detected; one in Y is \
             corrected by O8200."
        ),
        "Cancel any shift by G52 or G92 in X, Y or Z and any G16, G51, G51.1 or G68 left in force: the \
         programs refuse them."
            .to_owned(),
        format!(
            "E and F are points of the surface in the plane Z0, at X{} and X{}.",
            short(job.chord.e_radius),
            short(job.chord.f_radius)
        ),
        format!(
            "Start every program with the ball above the pole of the part or clear of it at X+, and \
             {letter} free to rotate. O8210 moves out to X{} first, O8200 up; O8220 rotates {letter} to 0 \
             at the ball's position.",
            short(job.surface.a + job.probe.radius + job.probe.search)
        ),
    ]
}

fn of_alignment(job: &Alignment) -> Markup {
    let ends = [("E", job.chord.e_radius), ("F", job.chord.f_radius)];
    let ends = ends.map(|(name, x)| (on_surface(job.surface, x), format!("{name} at X{}", short(x))));
    section(job.surface, job.machine.rotary.letter, ends.into())
}

/// Draws the section z = 0: the ellipse, and arrows along the outward directions at some of its points.
fn section(surface: Surface, rotary: char, mut tools: Vec<([f64; 4], String)>) -> Markup {
    let (a, b) = (surface.a, surface.b);
    let scale = (150.0 / a).min(220.0 / b);
    let (wide, high) = (a * scale, b * scale);
    let paper = Paper { origin: [wide + 40.0, high + 60.0], scale };
    let height = high + 100.0;
    let [left, right] = [paper.at(-a, 0.0), paper.at(a, 0.0)];
    let dome =
        format!("M{:.1} {:.1}A{wide:.1} {high:.1} 0 0 1 {:.1} {:.1}", left[0], left[1], right[0], right[1]);
    let zero = paper.at(0.0, 0.0);
    let column = right[0] + 60.0;
    // From the top down, each label below the previous one.
    tools.sort_by(|(one, _), (other, _)| other[1].total_cmp(&one[1]));
    let more = tools.len().saturating_sub(8);
    tools.truncate(8);
    let mut below = 24.0;
    let tools = tools.into_iter().map(|([x, y, across, up], label)| {
        let tip = paper.at(x, y);
        let back = [tip[0] + 42.0 * across, tip[1] - 42.0 * up];
        let place = [column, f64::max(below, back[1])];
        below = place[1] + 16.0;
        html! {
            (arrow(back, tip))
            (thin(back, [place[0] - 3.0, place[1] - 4.0]))
            (text(place, Anchor::Start, &label))
        }
    });
    let content = html! {
        (path(&dome))
        (line([left[0] - 15.0, left[1]], [right[0] + 25.0, right[1]]))
        (text([right[0] + 30.0, right[1] + 4.0], Anchor::Start, "X"))
        (centre_line([zero[0], height - 15.0], [zero[0], 24.0]))
        (text([zero[0], 16.0], Anchor::Middle, &format!("Y, axis of {rotary}")))
        (zero_sign(zero))
        (text([zero[0] + 12.0, zero[1] + 20.0], Anchor::Start, "G54 X0 Y0 Z0"))
        (text([(zero[0] + left[0]) / 2.0, zero[1] + 20.0], Anchor::Middle, &format!("a {}", short(a))))
        (text([zero[0] - 6.0, zero[1] - high / 2.0], Anchor::End, &format!("b {}", short(b))))
        @for tool in tools { (tool) }
        @if more > 0 {
            (text([column, zero[1] + 36.0], Anchor::Start, &format!("and {more} more")))
        }
    };
    drawing(height, "The section z = 0 of the part with the work zero at its centre", content)
}

fn honeycomb(job: &Honeycomb) -> Vec<String> {
    let (letter, minus) = (job.machine.rotary.letter, if job.machine.rotary.sign < 0 { "−" } else { "" });
    let mut all = vec![
        "G54: X0 at the first hole of the first row, Y0 on the axis of the cylinder, Z0 on its outer surface.".to_owned(),
        format!(
            "Z0 is {} mm from the axis: the radius of the outer diameter {}.",
            short(job.cylinder.outer() / 2.0),
            short(job.cylinder.outer())
        ),
        format!(
            "{letter} rotates about X; row by row {letter} = {minus}row·180/N (sign {}). {letter}0 is the \
             first row: put a seam or a mark there.",
            if minus.is_empty() { "+1" } else { "−1" }
        ),
        format!("Tool length: H{0} is that of T{0}, called by G43.", job.drill.number()),
    ];
    all.extend(job.machine.clamp.map(|clamp| {
        format!("M{} releases the rotary before it rotates, M{} clamps it.", clamp.off, clamp.on)
    }));
    all.push("Start with the tool clear of the part.".to_owned());
    all
}

/// Draws the cylinder from the side, with the drill above it, and along its axis.
fn of_honeycomb(job: &Honeycomb) -> Markup {
    let (length, outer, bore) = (job.cylinder.length, job.cylinder.outer(), job.cylinder.bore);
    let scale = (180.0 / length).min(120.0 / outer);
    let radius = outer / 2.0;
    let paper = Paper { origin: [70.0, 60.0], scale };
    let [first, last] = [paper.at(0.0, 0.0), paper.at(length, -outer)];
    let (middle, height) = ((first[1] + last[1]) / 2.0, last[1] + 45.0);
    let sides = format!("M{:.1} {:.1}H{:.1}V{:.1}H{:.1}Z", first[0], first[1], last[0], last[1], first[0]);
    let end = [last[0] + 105.0 + radius * scale, middle];
    let content = html! {
        (path(&sides))
        (centre_line([first[0] - 25.0, middle], [last[0] + 30.0, middle]))
        (text([last[0] + 8.0, middle - 5.0], Anchor::Start, &format!("axis of {}, X", job.machine.rotary.letter)))
        (arrow([first[0], 16.0], [first[0], first[1] - 9.0]))
        (text([first[0] + 8.0, 22.0], Anchor::Start, &format!("T{}, first hole", job.drill.number())))
        (zero_sign(first))
        (text([first[0] + 12.0, first[1] - 6.0], Anchor::Start, "G54 X0 Z0"))
        (text([(first[0] + last[0]) / 2.0, last[1] + 20.0], Anchor::Middle, &format!("holes from X0 to X{}", short(length))))
        circle cx=(format!("{:.1}", end[0])) cy=(format!("{:.1}", end[1])) r=(format!("{:.1}", radius * scale)) {}
        @if bore > 0.0 {
            circle cx=(format!("{:.1}", end[0])) cy=(format!("{:.1}", end[1])) r=(format!("{:.1}", bore / 2.0 * scale)) {}
        }
        (centre_line([end[0], first[1] - 30.0], [end[0], last[1] + 12.0]))
        (zero_sign([end[0], first[1]]))
        (text([end[0] + 12.0, first[1] - 6.0], Anchor::Start, "Y0 Z0"))
        (text([end[0], last[1] + 26.0], Anchor::Middle, &format!("Φ{}", short(outer))))
    };
    drawing(
        height,
        "The cylinder from the side and along its axis, with the work zero on its surface",
        content,
    )
}

fn burr(job: &Burr) -> Vec<String> {
    let [x, y] = job.grinder.c_offset.map(short);
    let signs = job.grinder.signs();
    let turned: Vec<_> = [("X", signs.x), ("Y", signs.y), ("A", signs.a), ("B", signs.b), ("C", signs.c)]
        .into_iter()
        .filter_map(|(letter, sign)| (sign < 0).then_some(letter))
        .collect();
    let turned = match turned.is_empty() {
        true => "All axes run as in the method (signs +1).".to_owned(),
        false => format!("These axes run in the opposite direction (sign −1): {}.", turned.join(", ")),
    };
    vec![
        "G54 X0 Y0 at C0: the burr is along X, its tip towards X−, and the wheel, which comes from Y−, \
         touches the tooth bottom at the end of the cylinder."
            .to_owned(),
        format!(
            "From the axis of C to the end of the cylinder, in the middle of the burr: X{x} Y{y} at C0. \
             Measure these two at the machine; a wrong value spoils the nose."
        ),
        format!("B swivels the wheel to the helix angle {}°; A0 is the first flute.", short(job.helix)),
        turned,
        "Start with C between 0 and the end of the flute, the wheel clear of the burr.".to_owned(),
    ]
}

/// Draws the burr at C0 X0 Y0 with the wheel in contact.
fn of_burr(job: &Burr) -> Markup {
    let flutes = Flutes::from_job(job);
    let (radius, pole, start) = (flutes.profile.radius(), flutes.profile.pole(), flutes.start);
    let [ex, ey] = job.grinder.c_offset;
    let shank = start + 0.6 * radius;
    let (left, right) = (pole.min(-ex), shank.max(-ex));
    let (low, high) = ((-radius).min(-ey), radius.max(-ey));
    let scale = (360.0 / (right - left)).min(170.0 / (high - low));
    let paper = Paper { origin: [50.0 - left * scale, 40.0 + high * scale], scale };
    let height = (high - low) * scale + 130.0;
    let (r, nose) = (radius * scale, -pole * scale);
    let [top, bottom, back] = [paper.at(0.0, radius), paper.at(0.0, -radius), paper.at(shank, radius)];
    let outline = format!(
        "M{:.1} {:.1}H{:.1}A{nose:.1} {r:.1} 0 0 0 {:.1} {:.1}H{:.1}",
        back[0], top[1], top[0], bottom[0], bottom[1], back[0]
    );
    let wheel = format!(
        "M{:.1} {:.1}A90 90 0 0 1 {:.1} {:.1}",
        bottom[0] - 64.0,
        bottom[1] + 27.0,
        bottom[0] + 64.0,
        bottom[1] + 27.0
    );
    let (centre, c) = (paper.at(0.0, 0.0), paper.at(-ex, -ey));
    let across = 9.0;
    let content = html! {
        (path(&outline))
        (centre_line([paper.at(pole, 0.0)[0] - 15.0, centre[1]], [back[0] + 12.0, centre[1]]))
        (thin([centre[0], top[1]], [centre[0], bottom[1]]))
        (text([back[0] + 14.0, centre[1] + 4.0], Anchor::Start, "X, A"))
        g stroke="#0072b2" { (path(&wheel)) }
        (text([bottom[0] + 70.0, bottom[1] + 32.0], Anchor::Start, "wheel"))
        (zero_sign(bottom))
        (text([bottom[0] + 12.0, bottom[1] + 46.0], Anchor::Start, "G54 X0 Y0 at C0"))
        (line([c[0] - across, c[1]], [c[0] + across, c[1]]))
        (line([c[0], c[1] - across], [c[0], c[1] + across]))
        (text([c[0] + 12.0, c[1] - 8.0], Anchor::Start, &format!("axis of C: {} {} from here to the cylinder's end", short(ex), short(ey))))
        (thin(c, centre))
        (text([WIDTH - 8.0, height - 10.0], Anchor::End, &format!("Φ{}, flutes {} long", short(2.0 * radius), short(job.shape.length))))
    };
    drawing(height, "The burr at C0 with the wheel touching it at the work zero", content)
}
