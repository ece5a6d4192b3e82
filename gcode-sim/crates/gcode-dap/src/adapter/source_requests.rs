//! Sources: which file a client means, where a block is, and the texts of programs.
use std::path::Path;

use super::program_files::{BlockSite, ProgramFile};
use super::{Adapter, Answer, Host, body};
use crate::protocol::arguments::{self, BreakpointLocations, SourceText};
use crate::protocol::bodies::{self, LoadedSource, LoadedSources, Location, Source};
use gcode_lang::source::{SourceId, Span};
use gcode_session::file_uri;

impl<H: Host> Adapter<H> {
    pub(super) fn client_line(&self, line: u32) -> i64 {
        i64::from(line) - 1 + self.client.first_line
    }

    pub(super) fn client_column(&self, column: u32) -> i64 {
        i64::from(column) - 1 + self.client.first_column
    }

    /// Returns a line of the client, counted from 1.
    pub(super) fn own_line(&self, line: i64) -> u32 {
        u32::try_from(line.saturating_add(1 - self.client.first_line)).unwrap_or(0)
    }

    pub(super) fn own_column(&self, column: i64) -> u32 {
        u32::try_from(column.saturating_add(1 - self.client.first_column)).unwrap_or(0)
    }

    /// Returns the path of a file that a client names, and its canonical path.
    pub(super) fn paths_of(&self, source: &arguments::Source) -> Result<(String, String), String> {
        let id = source.source_reference.filter(|reference| *reference > 0);
        if let Some(name) = id.and_then(|id| self.source_name(id)) {
            return Ok((name.clone(), (self.canonical)(&name)));
        }
        let path = source.path.as_deref().ok_or("the source has no path")?;
        let path = file_uri::path(path).map_or_else(|| path.to_owned(), |path| path.display().to_string());
        Ok((path.clone(), (self.canonical)(&path)))
    }

    fn source_name(&self, reference: i64) -> Option<String> {
        let index = usize::try_from(reference.checked_sub(1)?).ok()?;
        let sources = self.session.as_ref()?.debuggee.control().memory().sources();
        sources.iter().nth(index).map(|(_, source)| source.name.clone())
    }

    /// Returns the id of a loaded file.
    pub(super) fn loaded_source(&self, canonical: &str) -> Option<SourceId> {
        let sources = self.session.as_ref()?.debuggee.control().memory().sources();
        sources.iter().find(|(_, source)| (self.canonical)(&source.name) == canonical).map(|(id, _)| id)
    }

    /// Returns a file, loaded or not.
    pub(super) fn file(&mut self, path: &str, canonical: &str) -> Result<&mut ProgramFile, String> {
        let loaded = self.loaded_source(canonical).and_then(|id| {
            let sources = self.session.as_ref()?.debuggee.control().memory().sources();
            Some(sources.get(id).bytes.clone())
        });
        let host = &mut self.host;
        self.files.file(canonical, || match loaded {
            Some(bytes) => Ok(bytes),
            None => host.program_text(path),
        })
    }

    /// Returns the block of a client's line, or the next one, with the canonical path of its file.
    pub(super) fn block_at(
        &mut self,
        source: &arguments::Source,
        line: i64,
        column: Option<i64>,
    ) -> Result<(String, BlockSite), String> {
        let (path, canonical) = self.paths_of(source)?;
        let (line, column) = (self.own_line(line), column.map(|column| self.own_column(column)));
        let site = self.file(&path, &canonical)?.block_from(line, column)?;
        Ok((canonical, site))
    }

    /// Returns the source of a loaded file as the client knows it.
    fn source_of(&self, name: &str) -> Source {
        let canonical = (self.canonical)(name);
        let path = self.files.client_path(&canonical).map_or_else(|| self.host.absolute(name), str::to_owned);
        let file = path.rsplit(['/', '\\']).next().unwrap_or(&path).to_owned();
        let uri = self.client.uses_uris.then(|| file_uri::of_path(Path::new(&path))).flatten();
        let path = uri.unwrap_or(path);
        Source { name: file, path: Some(path), source_reference: None }
    }

    /// Returns a file as a source of the protocol.
    pub(super) fn named_source(&self, path: &str) -> Source {
        self.source_of(path)
    }

    /// Returns source, line and column of a block.
    pub(super) fn place(&self, block: Span) -> Option<(Source, i64, i64)> {
        let sources = self.session.as_ref()?.debuggee.control().memory().sources();
        let (_, text) = sources.iter().nth(block.source.0 as usize)?;
        let place = text.line_column(block.start);
        let source = self.source_of(&text.name);
        Some((source, self.client_line(place.line), self.client_column(place.column)))
    }

    pub(super) fn source(&mut self, arguments: &SourceText) -> Answer {
        let by_reference = arguments::Source {
            path: None,
            source_reference: Some(arguments.source_reference).filter(|reference| *reference > 0),
        };
        let source = arguments.source.as_ref().unwrap_or(&by_reference);
        let (path, canonical) = self.paths_of(source).or_else(|_| self.paths_of(&by_reference))?;
        let content = self.file(&path, &canonical)?.text();
        body(bodies::SourceText { content })
    }

    pub(super) fn loaded_sources(&mut self) -> Answer {
        let session = self.session.as_ref().ok_or("no program is launched")?;
        let names = session.debuggee.control().memory().sources().iter();
        let sources = names.map(|(_, source)| self.source_of(&source.name)).collect();
        body(LoadedSources { sources })
    }

    /// Reports files that have been loaded since the last report.
    pub(super) fn report_sources(&mut self) {
        let Some(session) = &mut self.session else { return };
        let sources = session.debuggee.control().memory().sources();
        if sources.count() == session.reported_sources {
            return;
        }
        let new: Vec<String> =
            sources.iter().skip(session.reported_sources).map(|(_, source)| source.name.clone()).collect();
        session.reported_sources = sources.count();
        for name in new {
            let source = self.source_of(&name);
            self.outbox.event("loadedSource", LoadedSource { reason: "new", source });
        }
    }

    pub(super) fn breakpoint_locations(&mut self, arguments: &BreakpointLocations) -> Answer {
        let (path, canonical) = self.paths_of(&arguments.source)?;
        let first = self.own_line(arguments.line);
        let last = arguments.end_line.map_or(first, |line| self.own_line(line));
        let sites = self.file(&path, &canonical)?.blocks_on(first, last);
        let location = |site: &BlockSite| Location {
            line: self.client_line(site.line),
            column: self.client_column(site.column),
        };
        body(bodies::BreakpointLocations { breakpoints: sites.iter().map(location).collect() })
    }
}
