//! The sheet as HTML, section by section.
mod alignment;
mod drawing;
mod end;
mod gauge;
mod head;
mod inspection;
mod machine;
mod pattern_zero;
mod stops;
mod time;
mod zero;

use gcode_part::job::Job;
use gcode_sim::report::sheet::layout::{self, blank, cell, table};
use maud::{Markup, html};

use super::Sheet;
use crate::package::stem;

pub(super) fn page(sheet: &Sheet<'_>) -> String {
    let main = mains(sheet);
    let words = sheet.job.sheet();
    let part = words.part.as_deref().unwrap_or("part not named");
    let drawing = [("drawing", &words.drawing), ("revision", &words.revision)];
    let running = std::iter::once(part.to_owned())
        .chain(drawing.iter().filter_map(|(name, word)| Some(format!("{name} {}", word.as_ref()?))))
        .chain([main.clone()]);
    let running: Vec<String> = running.collect();
    layout::page(&format!("Set-up sheet: {part}, {main}"), &running.join(", "), &sections(sheet))
}

fn sections(sheet: &Sheet<'_>) -> Markup {
    html! {
        (head::facts(sheet))
        (head::verdict(sheet))
        (head::programs(sheet))
        (zero::zero(sheet))
        (machine::tools(sheet))
        (machine::head_angles(sheet))
        (gauge::blocks(sheet))
        (stops::stops(sheet))
        (alignment::readings(sheet))
        (alignment::alarms(sheet))
        (machine::settings(sheet))
        (inspection::form(sheet))
        (inspection::holes(sheet))
        (inspection::pictures(sheet))
        // On paper, the rest of the page is next to the signatures.
        div.together {
            (time::time(sheet))
            (end::unknown(sheet))
            (layout::signatures())
        }
    }
}

/// Returns the main programs: `O8100`.
fn mains(sheet: &Sheet<'_>) -> String {
    sheet.package.mains.iter().map(|main| stem(*main)).collect::<Vec<_>>().join(", ")
}

/// Returns the kind of part, for a heading.
fn kind(job: &Job) -> &'static str {
    match job {
        Job::PinHoles(_) => "pin holes on an ellipsoid of revolution",
        Job::Honeycomb(_) => "honeycomb of radial holes on a cylinder",
        Job::Burr(_) => "ball-end rotary burr",
        Job::Alignment(_) => "setting up a part of revolution",
        Job::Pattern(_) => "patterns of holes",
    }
}
