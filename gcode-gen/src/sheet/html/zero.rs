//! The work zero: a drawing for each family, and the offsets and signs in words.
use gcode_draw::{Align, Pen, arc};
use gcode_inspect::verify::Verdict;
use gcode_part::Flutes;
use gcode_part::job::{Alignment, Burr, Honeycomb, Job, PinHoles, SurfaceSpec};
use gcode_sim::report::figures::short;
use maud::{Markup, html};

use super::drawing::{Drawing, WIDTH};
use super::pattern_zero;
use crate::check::PackageVerdict;
use crate::sheet::Sheet;

pub(super) fn zero(sheet: &Sheet<'_>) -> Markup {
    let (picture, words) = match (sheet.job, &sheet.checked.verdict) {
        (Job::PinHoles(job), PackageVerdict::Holes(verdict)) => (of_pin_holes(job, verdict), pin_holes(job)),
        (Job::Honeycomb(job), _) => (of_honeycomb(job), honeycomb(job)),
        (Job::Burr(job), _) => (of_burr(job), burr(job)),
        (Job::PinHoles(job), PackageVerdict::Flutes(_) | PackageVerdict::Measured) => {
            (html! {}, pin_holes(job))
        }
        (Job::Alignment(job), _) => (of_alignment(job), alignment(job)),
        (Job::Pattern(job), PackageVerdict::Holes(verdict)) => {
            (pattern_zero::drawing(job, verdict), pattern_zero::words(job))
        }
        (Job::Pattern(job), PackageVerdict::Flutes(_) | PackageVerdict::Measured) => {
            (html! {}, pattern_zero::words(job))
        }
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
    all.push(match job.is_tip_programmed() {
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
pub(super) fn on_surface(surface: SurfaceSpec, x: f64) -> [f64; 4] {
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
fn section(surface: SurfaceSpec, rotary: char, mut tools: Vec<([f64; 4], String)>) -> Markup {
    let (a, b) = (surface.a, surface.b);
    let scale = (150.0 / a).min(220.0 / b);
    let (wide, high, unit) = (a * scale, b * scale, 1.0 / scale);
    let mut drawing = Drawing::new([wide + 40.0, high + 60.0], high + 100.0, unit);
    let zero = [0.0, 0.0];
    drawing.line(Pen::Edge, arc(zero, [a, b], [180.0, 0.0]));
    drawing.line(Pen::Edge, [[-a - 15.0 * unit, 0.0], [a + 25.0 * unit, 0.0]]);
    drawing.text([a, 0.0], 30.0, -4.0, Align::Left, "X");
    drawing.line(Pen::Centre, [[0.0, -25.0 * unit], [0.0, b + 36.0 * unit]]);
    drawing.text([0.0, b], 0.0, 44.0, Align::Centre, format!("Y, axis of {rotary}"));
    drawing.zero(zero, 12.0, -20.0, "G54 X0 Y0 Z0");
    drawing.text([-a / 2.0, 0.0], 0.0, -20.0, Align::Centre, format!("a {}", short(a)));
    drawing.text([0.0, b / 2.0], -6.0, 0.0, Align::Right, format!("b {}", short(b)));
    // From the top down, each label below the previous one.
    tools.sort_by(|(one, _), (other, _)| other[1].total_cmp(&one[1]));
    let column = a + 60.0 * unit;
    let mut top = b + 36.0 * unit;
    for ([x, y, across, up], label) in tools.iter().take(8) {
        let back = [x + 42.0 * unit * across, y + 42.0 * unit * up];
        let place = [column, back[1].min(top)];
        top = place[1] - 16.0 * unit;
        drawing.arrow(back, [*x, *y]);
        drawing.line(Pen::Dimension, [back, [place[0] - 3.0 * unit, place[1] + 4.0 * unit]]);
        drawing.text(place, 0.0, 0.0, Align::Left, label);
    }
    if tools.len() > 8 {
        drawing.text([column, 0.0], 0.0, -36.0, Align::Left, format!("and {} more", tools.len() - 8));
    }
    drawing.markup("The section z = 0 of the part with the work zero at its centre")
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
    all.push(
        "Start with the tool clear of the part and home in Z where M06 does not retract by itself: M06 comes first, without G28. \
         The program ends at the retract height, with the tool length offset in force: without G49 and G28."
            .to_owned(),
    );
    all
}

/// Draws the cylinder from the side, with the drill above it, and along its axis.
fn of_honeycomb(job: &Honeycomb) -> Markup {
    let (length, outer, bore) = (job.cylinder.length, job.cylinder.outer(), job.cylinder.bore);
    let scale = (180.0 / length).min(120.0 / outer);
    let (radius, unit) = (outer / 2.0, 1.0 / scale);
    let mut drawing = Drawing::new([70.0, 60.0], outer * scale + 105.0, unit);
    let zero = [0.0, 0.0];
    drawing.line(Pen::Edge, [zero, [length, 0.0], [length, -outer], [0.0, -outer], zero]);
    drawing.line(Pen::Centre, [[-25.0 * unit, -radius], [length + 30.0 * unit, -radius]]);
    let axis = format!("axis of {}, X", job.machine.rotary.letter);
    drawing.text([length, -radius], 8.0, 5.0, Align::Left, axis);
    drawing.arrow([0.0, 44.0 * unit], [0.0, 9.0 * unit]);
    drawing.text(zero, 8.0, 38.0, Align::Left, format!("T{}, first hole", job.drill.number()));
    drawing.zero(zero, 12.0, 6.0, "G54 X0 Z0");
    let holes = format!("holes from X0 to X{}", short(length));
    drawing.text([length / 2.0, -outer], 0.0, -20.0, Align::Centre, holes);
    let end = length + radius + 105.0 * unit;
    drawing.circle([end, -radius], radius);
    if bore > 0.0 {
        drawing.circle([end, -radius], bore / 2.0);
    }
    drawing.line(Pen::Centre, [[end, 30.0 * unit], [end, -outer - 12.0 * unit]]);
    drawing.zero([end, 0.0], 12.0, 6.0, "Y0 Z0");
    drawing.text([end, -outer], 0.0, -26.0, Align::Centre, format!("Φ{}", short(outer)));
    drawing.markup("The cylinder from the side and along its axis, with the work zero on its surface")
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
    let unit = 1.0 / scale;
    let origin = [50.0 - left * scale, 40.0 + high * scale];
    let mut drawing = Drawing::new(origin, (high - low) * scale + 130.0, unit);
    let nose = arc([0.0, 0.0], [-pole, radius], [90.0, 270.0]);
    drawing.line(Pen::Edge, [vec![[shank, radius]], nose, vec![[shank, -radius]]].concat());
    drawing.line(Pen::Centre, [[pole - 15.0 * unit, 0.0], [shank + 12.0 * unit, 0.0]]);
    drawing.line(Pen::Dimension, [[0.0, radius], [0.0, -radius]]);
    drawing.text([shank, 0.0], 14.0, -4.0, Align::Left, "X, A");
    let wheel = 90.0 * unit;
    drawing.line(Pen::Tool, arc([0.0, -radius - wheel], [wheel, wheel], [135.0, 45.0]));
    let contact = [0.0, -radius];
    drawing.text(contact, 70.0, -32.0, Align::Left, "wheel");
    drawing.zero(contact, 12.0, -46.0, "G54 X0 Y0 at C0");
    let ([x, y], across) = ([-ex, -ey], 9.0 * unit);
    drawing.line(Pen::Edge, [[x - across, y], [x + across, y]]);
    drawing.line(Pen::Edge, [[x, y - across], [x, y + across]]);
    let axis = format!("axis of C: {} {} from here to the cylinder's end", short(ex), short(ey));
    drawing.text([x, y], 12.0, 8.0, Align::Left, axis);
    drawing.line(Pen::Dimension, [[x, y], [0.0, 0.0]]);
    let size = format!("Φ{}, flutes {} long", short(2.0 * radius), short(job.shape.length));
    let [right, down] = [WIDTH - 8.0 - origin[0], drawing.height - 10.0 - origin[1]];
    drawing.text([0.0, 0.0], right, -down, Align::Right, size);
    drawing.markup("The burr at C0 with the wheel touching it at the work zero")
}
