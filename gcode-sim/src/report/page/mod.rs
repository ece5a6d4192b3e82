//! The review page: one HTML file that shows a program's effect, or two revisions side by side. It needs
//! neither network nor libraries.
mod changed;
mod document;
mod exact_path;
mod facts;
mod holes;
mod lines;
mod listing;
mod messages;
mod path;
mod proof;
mod rows;
mod stock_edges;
mod stops;
mod words;

use maud::{Markup, html};

use document::document;
use gcode_inspect::machine::Machine;
use gcode_inspect::verify::Verdict;
use gcode_part::Reference;
use gcode_review::{Revision, RevisionDiff, UnexecutedChange};
use gcode_session::{Request, Trace};
use holes::HoleTable;
use lines::Lines;

/// Number of changes that are listed; `--format json` lists all.
const MOST_CHANGES: usize = 500;

/// One program with the results of its run.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ObservedProgram<'a> {
    pub(crate) request: &'a Request,
    pub(crate) revision: &'a Revision,
    pub(crate) trace: &'a Trace,
    /// Verdict; `None` without a reference.
    pub(crate) verdict: Option<&'a Verdict>,
}

impl<'a> ObservedProgram<'a> {
    pub(crate) fn of(request: &'a Request, revision: &'a Revision, trace: &'a Trace) -> Self {
        Self { request, revision, trace, verdict: revision.verdict.as_ref() }
    }
}

/// An input file besides the programs.
#[derive(Clone, Debug)]
pub(crate) struct Document {
    /// Kind of file, such as `machine file`.
    pub(crate) role: &'static str,
    pub(crate) name: String,
    pub(crate) bytes: Vec<u8>,
}

/// The comparison of two revisions, and its tolerance, mm or degrees.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Difference<'a> {
    pub(crate) compared: &'a RevisionDiff,
    pub(crate) unexecuted: &'a [UnexecutedChange],
    pub(crate) tolerance: f64,
}

/// Contents of a page.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Page<'a> {
    /// The old revision, if two are compared.
    pub(crate) old: Option<(ObservedProgram<'a>, Difference<'a>)>,
    pub(crate) new: ObservedProgram<'a>,
    pub(crate) machine: &'a Machine,
    pub(crate) reference: Option<&'a Reference>,
    /// Flags that the run depends on, as given.
    pub(crate) conditions: &'a [String],
    pub(crate) documents: &'a [Document],
}

/// One side of the page.
#[derive(Clone, Copy, Debug)]
struct ReviewSide<'a> {
    /// `old` or `new`; a single program is `new`.
    word: &'static str,
    observed: ObservedProgram<'a>,
    lines: &'a Lines,
}

impl Page<'_> {
    /// Returns the page as HTML.
    ///
    /// # Errors
    /// The error of serde_json if the data cannot be written as JSON.
    pub(crate) fn html(&self) -> Result<String, serde_json::Error> {
        let mut lines: Vec<Lines> = Vec::new();
        for (word, seen) in self.observed_programs() {
            lines.push(Lines::new(word, &seen.revision.simulation.run));
        }
        let sides: Vec<ReviewSide<'_>> = self
            .observed_programs()
            .into_iter()
            .zip(&lines)
            .map(|((word, seen), lines)| ReviewSide { word, observed: seen, lines })
            .collect();
        let table = HoleTable::new(self, &sides);
        let data = path::data(self, &sides, &table);
        let body = html! {
            header {
                h1 { (self.title()) }
                p.basis { "Predicted by simulation, not measured" }
                (facts::answer(self, &sides))
                nav aria-label="Sections" {
                    @for section in self.sections() { a href={ "#" (section.id()) } { (section.name()) } }
                }
            }
            main.alone[self.old.is_none()] {
                @for section in self.sections() {
                    section id=(section.id()) aria-labelledby={ (section.id()) "-name" } {
                        h2 id={ (section.id()) "-name" } { (section.name()) }
                        (self.contents(section, &sides, &table, &data))
                    }
                }
            }
        };
        document(&self.title(), &body, &data)
    }

    fn observed_programs(&self) -> Vec<(&'static str, ObservedProgram<'_>)> {
        let old = self.old.map(|(seen, _)| ("old", seen));
        old.into_iter().chain([("new", self.new)]).collect()
    }

    fn title(&self) -> String {
        let name = |seen: &ObservedProgram<'_>| words::shown(&seen.request.name);
        let memory = self.new.revision.simulation.run.control.memory();
        let label = words::shown(&memory.get(memory.main()).label());
        match &self.old {
            // Several programs of a dump would have one title.
            Some((old, _)) if self.new.request.main.is_some() => {
                format!("Review of {label}, {} against {}", name(&self.new), name(old))
            }
            Some((old, _)) => format!("Review of {} against {}", name(&self.new), name(old)),
            None => {
                let name = name(&self.new);
                format!("Program {label} ({})", name.rsplit(['/', '\\']).next().unwrap_or(&name))
            }
        }
    }

    /// Returns the sections in their order: a review begins with its numbers and changes, the page of one program with its path.
    fn sections(&self) -> Vec<Section> {
        use Section::{Changes, Holes, Messages, Path, Proof, Signatures, Summary};
        let first: &[Section] =
            if self.old.is_some() { &[Summary, Changes, Holes, Path] } else { &[Path, Summary, Holes] };
        [first, &[Messages, Proof, Signatures]].concat()
    }

    fn contents(
        &self,
        section: Section,
        sides: &[ReviewSide<'_>],
        table: &HoleTable,
        data: &path::Data,
    ) -> Markup {
        match section {
            Section::Summary => facts::summary(self, sides),
            Section::Changes => {
                let difference = self.old.map(|(_, difference)| changed::changes(&difference, sides));
                difference.unwrap_or_default()
            }
            Section::Holes => table.markup(self),
            Section::Path => html! {
                div.beside {
                    (path::viewer(sides, data))
                    div #programs { (listing::listing(self, sides)) }
                }
            },
            Section::Messages => messages::messages(self, sides),
            Section::Proof => proof::proof(self, sides),
            Section::Signatures => proof::signatures(),
        }
    }
}

/// A section of the page.
#[derive(Clone, Copy, Debug)]
enum Section {
    Summary,
    Changes,
    Holes,
    Path,
    Messages,
    Proof,
    Signatures,
}

impl Section {
    const fn id(self) -> &'static str {
        match self {
            Self::Summary => "summary",
            Self::Changes => "changes",
            Self::Holes => "holes",
            Self::Path => "path",
            Self::Messages => "messages",
            Self::Proof => "proof",
            Self::Signatures => "signatures",
        }
    }

    const fn name(self) -> &'static str {
        match self {
            Self::Summary => "Summary",
            Self::Changes => "Changes",
            Self::Holes => "Holes",
            Self::Path => "Path and program",
            Self::Messages => "Stops, alarms and findings",
            Self::Proof => "Basis of the results",
            Self::Signatures => "Signatures",
        }
    }
}

/// Returns the heading of a side's column.
fn heading(side: &ReviewSide<'_>, sides: &[ReviewSide<'_>]) -> &'static str {
    match (sides.len(), side.word) {
        (1, _) => "Program",
        (_, "old") => "Old",
        _ => "New",
    }
}

/// Returns the changes that are listed.
fn listed<T>(changes: &[T]) -> &[T] {
    &changes[..changes.len().min(MOST_CHANGES)]
}
