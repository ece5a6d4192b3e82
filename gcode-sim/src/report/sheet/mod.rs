//! The set-up sheet of any program: what the person at the machine needs to set up, start and watch it.
pub mod layout;
mod program_words;
pub(crate) mod recorder;
mod rotary;

use std::collections::BTreeSet;

use maud::{Markup, html};

use super::encode::base64;
use super::figures::{count, duration, finding_counts, rounded, short};
use super::run::comments;
use gcode_inspect::holes::HoleExtraction;
use gcode_inspect::machine::Machine;
use gcode_inspect::verify::{Answer, Conclusion};
use gcode_lang::diag::{Diagnostic, Severity};
use gcode_lang::motion::{Backtrace, LengthCompensation, StopKind};
use gcode_part::{Assumption, MM_PER_INCH, Total};
use gcode_session::{Request, Simulation};
use layout::{BASIS, blank, cell, digest, table};
use recorder::{OffsetObserver, SheetStop, ToolUse, UseRecorder};

/// Largest number of stops and of findings that are listed.
const MAX_LISTED: usize = 200;

/// Aspects that no simulation here covers.
const NEVER: &[&str] = &[
    "the machine's own errors: positioning, run-out, accuracy of the zero and of the tools' lengths",
    "chips, clamps, fixtures, the machine's head and travel, except limits that the settings state",
    "acceleration and the time of operator stops and tool changes: run times are paths divided by feeds and rapid rates",
];

/// A simulated program with the data for its sheet.
pub(crate) struct ProgramSheet<'a> {
    pub request: &'a Request,
    pub simulation: &'a Simulation,
    pub uses: &'a UseRecorder,
    pub offsets: &'a OffsetObserver,
    /// Conclusion of the verdict, and what was not checked; `None` without a reference.
    pub verdict: Option<(Conclusion<'a>, &'a [String])>,
    pub findings: &'a [Diagnostic],
    pub assumptions: &'a [Assumption],
    /// Files besides the programs: kind, name, content.
    pub files: &'a [(&'static str, String, Vec<u8>)],
    /// Picture of the path, PNG; `None` if there is nothing to draw.
    pub picture: Option<&'a [u8]>,
}

impl ProgramSheet<'_> {
    /// Returns the sheet as one self-contained HTML file.
    pub(crate) fn html(&self) -> String {
        let name = self.name();
        layout::page(&format!("Set-up sheet: {name}"), &name, &self.sections())
    }

    fn sections(&self) -> Markup {
        html! {
            (self.head())
            (self.answer())
            (self.programs())
            (self.work_zeros())
            (rotary::section(&self.request.machine, self.offsets))
            (self.tools())
            (self.switches())
            (self.stops())
            (self.m_codes())
            (self.picture_section())
            (self.findings_section())
            (self.not_checked())
            (layout::signatures())
        }
    }

    /// Returns the name of the main program with its comment: `O1234 (BRACKET)`.
    fn name(&self) -> String {
        let memory = self.simulation.run.control.memory();
        let main = memory.get(memory.main());
        let label = main.label();
        let comment = program_words::main_comment(
            memory.sources().iter().map(|(_, source)| source.lines()),
            main.number(),
        );
        let comment = comment.unwrap_or_default();
        if comment.is_empty() { label } else { format!("{label} ({comment})") }
    }

    fn head(&self) -> Markup {
        let settings = &self.request.settings;
        let [rapid, feed, dwell] = self.uses.times;
        let time = rapid + feed + dwell;
        html! {
            h1 { "Set-up sheet" }
            p { "Program " b { (self.name()) } }
            div.wide { table.facts { tbody {
                tr { th { "part" } td { (blank()) } th { "drawing, revision" } td { (blank()) } }
                tr { th { "material" } td { (blank()) } th { "order" } td { (blank()) } }
                tr {
                    th { "machine" } td { (blank()) }
                    th { "control" } td { (settings.dialect.name()) ", least increment " (settings.increment.name()) }
                }
                tr {
                    th { "run time" }
                    td { (duration(time)) ", feeds " (duration(feed)) ", rapids " (duration(rapid)) ", dwells " (duration(dwell)) }
                    th { "tools, stops" }
                    td { (count(self.tool_count(), "tool")) ", " (count(self.uses.stops.len(), "operator stop")) }
                }
            } } }
            p.note {
                @if self.is_inch() {
                    "The program is in inches (G20): work zeros, F and the values of H and D are in inches, as on the control; lengths "
                    "and diameters of the machine file, and all else, in mm. "
                } @else { "Lengths in mm, angles in degrees, feeds in mm/min. " }
                "Fill in empty lines by hand."
            }
        }
    }

    /// Returns true if the program is in inches.
    fn is_inch(&self) -> bool {
        self.simulation.run.control.is_inch()
    }

    /// Formats a length or a feed in mm in the program's unit.
    fn in_unit(&self, mm: f64) -> String {
        if self.is_inch() { short((mm / MM_PER_INCH * 1e4).round() / 1e4) } else { short(mm) }
    }

    /// Formats a range of values in mm in the program's unit.
    fn range_in_unit(&self, range: Option<[f64; 2]>) -> String {
        range_of(range, |mm| self.in_unit(mm))
    }

    /// Returns ` (not set)` for an offset whose value neither the program nor a file states.
    fn mark_of(&self, offset: &str) -> &'static str {
        let is_assumed = self.assumptions.iter().any(|assumption| assumption.what == offset);
        if is_assumed { " (not set)" } else { "" }
    }

    fn tool_count(&self) -> usize {
        self.uses.uses.iter().filter_map(|one| one.tool).collect::<BTreeSet<_>>().len()
    }

    fn answer(&self) -> Markup {
        let total = Total::Holes(self.simulation.extracted.holes.len());
        html! {
            div.verdict {
                @match &self.verdict {
                    Some((conclusion, _)) => { b { (conclusion.answer.word()) ". " } (BASIS) ". " (as_sentence(conclusion.summary)) "." }
                    None => {
                        @match self.simulation.run.stop_sentence() {
                            Some(sentence) => { b { (Answer::Fail.word()) ". " } (BASIS) ". " (sentence) "." }
                            None => { b { "Not compared with a drawing. " } (BASIS) "." }
                        }
                    }
                }
                @if let Some(counts) = finding_counts(self.findings.iter()) { " " b { (counts) } ": see the findings." }
                @for assumption in self.assumptions { p { "Assumes " (assumption.sentence(total)) } }
            }
        }
    }

    fn programs(&self) -> Markup {
        let memory = self.simulation.run.control.memory();
        let labels = |source| {
            let programs = memory.programs().iter().filter(move |program| program.span.source == source);
            programs.map(|program| program.label()).collect::<Vec<String>>()
        };
        let stubs = &self.simulation.extracted.called_stubs;
        // A stub must not replace the macro that the control has.
        let is_for_control =
            |labels: &[String]| labels.is_empty() || labels.iter().any(|label| !stubs.contains(label));
        let of_memory = memory.sources().iter().filter_map(|(source, text)| {
            let labels = labels(source);
            let row = || vec![cell(&text.name), cell(labels.join(", ")), digest(text.bytes.file_content())];
            is_for_control(&labels).then(row)
        });
        let others = self.files.iter().map(|(kind, name, bytes)| vec![cell(name), cell(kind), digest(bytes)]);
        html! {
            h2 { "Files" }
            (table(&["file", "content", "SHA-256"], of_memory.chain(others)))
            p.note {
                "Compare the hash before the file goes to the control: " code { "certutil -hashfile FILE SHA256" }
                " (Windows) or " code { "sha256sum FILE" } ". An edited file is not the simulated one."
            }
            @if !stubs.is_empty() {
                p {
                    b { "Stubs, not for the control: " } (stubs.join(", "))
                    ". They have M99 alone here; the control needs its own programs of these numbers."
                }
            }
        }
    }

    fn work_zeros(&self) -> Markup {
        let machine = &self.request.machine;
        let rows = self.offsets.work_systems.iter().map(|system| {
            let stated = machine.offsets.iter().find(|offset| offset.system == *system);
            let axes = stated.map(|offset| offset.values.iter());
            let values: Option<Vec<String>> = axes.map(|values| {
                // In the order of the position screen: X, Y, Z, then the rotary axes.
                let mut values: Vec<_> = values.copied().collect();
                values.sort_by_key(|(axis, _)| (machine.axes.is_rotary(*axis), *axis));
                values
                    .into_iter()
                    .map(|(axis, value)| {
                        let is_angle = machine.axes.is_rotary(axis);
                        let value = if is_angle { short(value) } else { self.in_unit(value) };
                        format!("{} {value}", machine.axes.letter(axis))
                    })
                    .collect()
            });
            let value = match values {
                Some(values) => cell(values.join(" ")),
                None => blank(),
            };
            vec![cell(system.name(machine.dialect)), value, blank()]
        });
        html! {
            h2 { "Work zeros" }
            (table(&["system", "offset in the machine file", "where the zero is on the part"], rows))
        }
    }

    fn tools(&self) -> Markup {
        let machine = &self.request.machine;
        let HoleExtraction { holes, air_strokes: beside, .. } = &self.simulation.extracted;
        let used: Vec<&ToolUse> = self.uses.uses.iter().filter(|one| one.first_block.is_some()).collect();
        // A tool that comes again has the number of all its holes in its first row.
        let times = |one: &ToolUse| used.iter().filter(|other| other.tool == one.tool).count();
        let is_first = |one: &ToolUse| {
            used.iter().find(|other| other.tool == one.tool).is_some_and(|first| std::ptr::eq(*first, one))
        };
        let rows = used.iter().map(|one| {
            let made = holes.iter().filter(|hole| hole.passes().any(|pass| pass.tool == one.tool)).count();
            // Those of another vise, too: the tool wears there as well.
            let made = made + beside.iter().filter(|stroke| stroke.tool == one.tool).count();
            let holes = match (made, times(one)) {
                (0, _) => String::new(),
                (made, 1) => made.to_string(),
                (made, _) if is_first(one) => format!("{made} in all"),
                (..) => String::new(),
            };
            let offsets = self.offsets.radius_offsets.iter().filter(|(tool, _)| Some(*tool) == one.tool);
            let name = |(_, number): &(u32, u32)| format!("D{number}{}", self.radius_offset(*number));
            let offsets: Vec<String> = offsets.map(name).collect();
            let known = machine.tools.iter().find(|tool| Some(tool.number) == one.tool);
            let length = known.and_then(|tool| tool.length);
            let per_revolution = one.tool.and_then(|tool| self.offsets.feeds_per_revolution.get(&tool));
            let unit = if self.is_inch() { "inch/rev" } else { "mm/rev" };
            let per_revolution =
                per_revolution.map(|feeds| format!(" ({} {unit}, G95)", range_of(Some(*feeds), short)));
            vec![
                cell(one.tool.map_or("in the spindle".to_owned(), |tool| format!("T{tool}"))),
                self.kind(one),
                cell(length.map_or_else(String::new, short)),
                cell(self.lengths(one)),
                cell(offsets.join(" ")),
                cell(range_of(one.speed, short) + if one.is_reversed { " M04" } else { "" }),
                cell(self.range_in_unit(one.feed) + &per_revolution.unwrap_or_default()),
                cell(one.coolants.iter().map(|code| format!("M{code:02}")).collect::<Vec<_>>().join(" ")),
                cell(holes),
                cell(rounded(one.seconds / 60.0, 1)),
                cell(one.first_block.as_ref().map_or_else(String::new, |at| self.location(at))),
            ]
        });
        let columns =
            ["tool", "kind, diameter", "#length", "H", "D", "#S", "#F", "coolant", "#holes", "#min", "from"];
        html! {
            h2 { "Tools, in the order of use" }
            (table(&columns, rows))
            p.note { "S and F are those of its cuts; a length is that of the machine file, from the gauge line to the tip; a number behind D is a radius. A kind that no machine file states is left empty, a text in quotes is the program's comment; check H and D against the offset page." }
        }
    }

    /// Returns `H1`, or `none` for cuts without a length offset.
    fn lengths(&self, one: &ToolUse) -> String {
        let names = one.length_offsets.iter().map(|offset| match offset {
            LengthCompensation::Off => "none".to_owned(),
            LengthCompensation::Plus(number) => format!("H{number}{}", self.length_offset(*number)),
            LengthCompensation::Minus(number) => format!("H{number} (G44){}", self.length_offset(*number)),
        });
        names.collect::<Vec<_>>().join(" ")
    }

    /// Returns ` = -412.35` for a length offset that the machine file or a flag states, nothing for the length of a tool.
    fn length_offset(&self, number: u32) -> String {
        let Request { machine, variables, settings, .. } = self.request;
        let stated =
            machine.tools.iter().find(|tool| tool.number == number).and_then(|tool| tool.length_offset);
        let variable = settings.length_variable(number);
        let by_flag = variables.iter().rev().find(|(set, _)| Some(*set) == variable);
        match (by_flag, stated) {
            (Some((_, value)), _) => format!(" = {} (--set)", short(*value)),
            (None, Some(value)) => format!(" = {}", self.in_unit(value)),
            (None, None) => self.mark_of(&format!("H{number}")).to_owned(),
        }
    }

    /// Returns ` = 6` for a cutter radius that the machine file states.
    fn radius_offset(&self, number: u32) -> String {
        let stated = self.request.machine.tools.iter().find(|tool| tool.number == number);
        match stated.and_then(|tool| tool.radius_offset) {
            Some(radius) => format!(" = {}", self.in_unit(radius)),
            None => self.mark_of(&format!("D{number}")).to_owned(),
        }
    }

    /// Returns `O1234 line 12, called from O1 line 5`.
    fn location(&self, at: &Backtrace) -> String {
        let run = &self.simulation.run;
        let calls = std::iter::successors(at.calls.as_deref(), |call| call.outer_calls.as_deref());
        let spans = std::iter::once(at.block).chain(calls.map(|call| call.calling_block));
        let places: Vec<String> = spans
            .map(|span| run.locate(span))
            .map(|(program, line)| format!("{program} line {line}"))
            .collect();
        places.join(", called from ")
    }

    /// Returns kind and diameter of a tool as the machine file states them, else a blank, and what the program's comment says.
    fn kind(&self, one: &ToolUse) -> Markup {
        let stated = stated_kind(&self.request.machine, one);
        let comment =
            one.tool.and_then(|tool| program_words::tool_comment(&self.simulation.run, tool, one.change));
        html! {
            @if !stated.is_empty() { (stated) } @else if comment.is_none() { (blank()) }
            @if let Some(comment) = comment { div.note { "“" (comment) "”" } }
        }
    }

    fn switches(&self) -> Markup {
        let optional = self.uses.stops.iter().find(|stop| stop.kind == StopKind::M01);
        let rows = program_words::switches(&self.simulation.run, optional.map(|stop| stop.backtrace.block));
        html! {
            @if !rows.is_empty() {
                h2 { "Switches of the panel" }
                (table(&["switch", "as in this run", "first at"], rows.iter().map(|row| row.iter().map(cell).collect())))
            }
        }
    }

    fn stops(&self) -> Markup {
        let stops = &self.uses.stops;
        let row = |(index, stop): (usize, &SheetStop)| {
            let values =
                stop.variables.iter().map(|(number, value)| format!("#{number} = {}", short(*value)));
            let block = self.simulation.run.control.memory().sources().text(stop.backtrace.block);
            let text = if stop.text.is_empty() { comments(&block) } else { stop.text.clone() };
            vec![
                html! { (index + 1) },
                html! {
                    b { (stop.kind.name()) } " " span.mono { (text) }
                    @for value in values { " " b { (value) } }
                    div.note { (self.location(&stop.backtrace)) }
                },
                cell(stop.tool.map_or_else(String::new, |tool| format!("T{tool}"))),
                cell(rounded(stop.elapsed / 60.0, 1)),
                html! { span.tick {} },
            ]
        };
        html! {
            h2 { "Operator stops" }
            @if stops.is_empty() {
                p { "No operator stop between start and end." }
            } @else {
                p { (count(stops.len(), "stop")) ", in this order. The minutes are the running time before the stop." }
                (table(&["#stop", "the control shows", "tool", "#min", "done"], stops.iter().take(MAX_LISTED).enumerate().map(row)))
                @if MAX_LISTED < stops.len() { p { "The first " (MAX_LISTED) " are listed." } }
            }
        }
    }

    fn m_codes(&self) -> Markup {
        let run = &self.simulation.run;
        let codes = run.control.builder_m_codes();
        let rows = codes.iter().map(|(code, span)| {
            let (program, line) = run.locate(*span);
            vec![cell(format!("M{code:02}")), cell(format!("{program} line {line}")), blank()]
        });
        html! {
            @if !codes.is_empty() {
                h2 { "M codes of the machine builder" }
                p { "Their effect is not simulated." }
                (table(&["code", "first in", "what it does on this machine"], rows))
            }
        }
    }

    fn picture_section(&self) -> Markup {
        html! {
            @if let Some(png) = self.picture {
                h2 { "Path" }
                figure {
                    img alt="Tool path and holes" src={ "data:image/png;base64," (base64(png)) };
                    figcaption { (BASIS) "." }
                }
            }
        }
    }

    fn findings_section(&self) -> Markup {
        let shown: Vec<&Diagnostic> =
            self.findings.iter().filter(|finding| Severity::Note < finding.severity).collect();
        html! {
            @if !shown.is_empty() {
                h2 { "Findings" }
                ul {
                    @for finding in shown.iter().take(MAX_LISTED) {
                        li {
                            b { (finding.severity.name()) } " " code { (finding.code()) } " " (finding.message)
                            @if let Some(at) = &finding.backtrace { div.note { (self.location(at)) } }
                            @if 0 < finding.more { div.note { "and " (finding.more) " more of this kind" } }
                        }
                    }
                }
                @if MAX_LISTED < shown.len() { p { "The first " (MAX_LISTED) " of " (shown.len()) " are listed." } }
            }
        }
    }

    fn not_checked(&self) -> Markup {
        let own = self.verdict.as_ref().map_or(&[] as &[String], |(_, not_checked)| *not_checked);
        html! {
            div.together {
                h2 { "Not checked" }
                ul {
                    @for what in NEVER { li { (what) } }
                    @for what in own { li { (what) } }
                    @if self.verdict.is_none() { li { "the drawing: no hole list was given with " code { "--reference" } } }
                }
            }
        }
    }
}

/// Returns kind and diameter of a tool as the machine file states them.
fn stated_kind(machine: &Machine, one: &ToolUse) -> String {
    let Some(tool) = machine.tools.iter().find(|tool| Some(tool.number) == one.tool) else {
        return String::new();
    };
    let kind = tool.kind.map(|kind| kind.name().replace('-', " "));
    let size = tool.diameter.map(|diameter| format!("Φ{}", short(diameter)));
    kind.into_iter().chain(size).collect::<Vec<_>>().join(" ")
}

/// Returns a text with its first letter in upper case.
fn as_sentence(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().into_iter().flat_map(char::to_uppercase).chain(letters).collect()
}

/// Returns `800` or `800 to 1200`; nothing without a cut.
fn range_of(range: Option<[f64; 2]>, format: impl Fn(f64) -> String) -> String {
    match range.map(|ends| ends.map(format)) {
        None => String::new(),
        Some([min, max]) if min == max => min,
        Some([min, max]) => format!("{min} to {max}"),
    }
}
