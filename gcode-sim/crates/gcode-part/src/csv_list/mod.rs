//! Lists of holes as CSV, as spreadsheets and people write them: columns in any order, decimal commas, features in columns of
//! their own.
mod columns;
mod names;
#[cfg(test)]
mod tests;

use std::cell::Cell;

pub(super) use columns::is_csv;
pub(super) use columns::wrong_header;
use columns::{Column, Columns, HoleColumns, column_name, example, first_line, separator, unit};

use names::FEATURE_COLUMNS;

use super::feature::{DepthTo, Feature, FeatureKind};
use super::hand::Hand;
use super::hole::{Hole, HoleList, MM_PER_INCH, Unit};
use super::read::{check, complete, repeated_id};
use crate::reader::FileError;
use crate::{drill_size, exceeds, thread_size};
use gcode_lang::units::Deg;

/// Beginning of the last line of a list whose run stopped before its end.
pub const STOPPED: &str = "# stopped: ";

/// Depth of a hole whose list gives none, until that of the program is known, mm.
const OPEN_DEPTH: f64 = 1.0;

/// Columns of diameters, which may hold a size of a drill.
const DIAMETERS: [&str; 6] = ["diameter", "drill", "ream", "bore", "counterbore", "countersink"];

/// Largest difference between a pitch in a column and that of the thread's designation, mm.
const SAME_PITCH: f64 = 0.001;

/// Returns true if a depth says that the hole goes through, as drawings do.
fn is_through(depth: &str) -> bool {
    depth.starts_with(char::is_alphabetic)
        && ["thru", "through", "thru all", "through all", "durchgehend", "通孔"]
            .contains(&depth.to_lowercase().as_str())
}

/// A list with what its reader assumed.
#[derive(Debug)]
pub(super) struct CsvList {
    pub(super) holes: HoleList,
    /// Holes without a depth, by their indices.
    pub(super) open_depths: Vec<usize>,
    /// What the reader took for granted, in one sentence; `None` for a list with all columns and no others.
    pub(super) note: Option<String>,
    /// Columns that the reader does not use, but for remarks.
    pub(super) unread: Vec<String>,
}

fn error(line: Option<usize>, message: impl Into<String>) -> FileError {
    FileError { line, message: message.into() }
}

/// Parses the text of a list.
pub(super) fn csv(text: &str) -> Result<CsvList, FileError> {
    let (text, stopped) = match text.trim_end().rsplit_once('\n') {
        Some((before, last)) if last.starts_with(STOPPED) => (before, last.strip_prefix(STOPPED)),
        _ => (text, None),
    };
    let header = first_line(text);
    let separator = separator(header);
    let start = text.find(header).unwrap_or_default();
    let mut reader = csv::ReaderBuilder::new()
        .flexible(true)
        .delimiter(separator as u8)
        .from_reader(&text.as_bytes()[start..]);
    // A record begins behind the empty lines that its position counts in.
    let line_at = |byte: u64| {
        let from = start + byte as usize;
        let is_break = |byte: &&u8| matches!(byte, b'\r' | b'\n');
        let from = from + text.as_bytes()[from..].iter().take_while(is_break).count();
        text[..from].matches('\n').count() + 1
    };
    let line_of = |position: Option<&csv::Position>| Some(line_at(position?.byte()));
    let wrong = |e: &csv::Error| error(line_of(e.position()), e.to_string());
    let header = reader.headers().map_err(|e| wrong(&e))?;
    let names = header.iter().map(column_name).collect();
    let columns = unit(header.iter()).and_then(|unit| Columns::new(names, separator, unit));
    let columns = columns.map_err(|message| {
        error(line_of(Some(&csv::Position::new())), format!("{message}; {}", example(&[], separator)))
    })?;
    let mut list = CsvList {
        holes: HoleList {
            unit: Unit::Mm,
            holes: Vec::new(),
            stock: None,
            assumptions: None,
            stopped: stopped.map(str::to_owned),
        },
        open_depths: Vec::new(),
        note: None,
        unread: columns.unread(),
    };
    let mut cells = Cells {
        columns: &columns,
        of_hole: HoleColumns::of(&columns),
        record: csv::StringRecord::new(),
        has_comma: Cell::default(),
        has_point: Cell::default(),
        has_hole_deep_drill: false,
        has_through_finish: false,
        shallow: Vec::new(),
    };
    // A line is counted from the start of the text, only for an error.
    let mut positions: Vec<Option<u64>> = Vec::new();
    let mut read_rows = || -> Result<(), FileError> {
        while reader.read_record(&mut cells.record).map_err(|e| wrong(&e))? {
            if cells.record.iter().all(|cell| cell.trim().is_empty()) {
                continue;
            }
            let index = list.holes.holes.len();
            let hole = cells.hole(index).map_err(|message| {
                error(
                    line_of(cells.record.position()),
                    format!("{message}; {}", example(&columns.names, separator)),
                )
            })?;
            positions.push(cells.record.position().map(csv::Position::byte));
            if hole.is_open {
                list.open_depths.push(index);
            }
            list.holes.holes.push(hole.hole);
        }
        Ok(())
    };
    let rows = read_rows();
    if let Some([first, second]) = repeated_id(&list.holes.holes) {
        let id = list.holes.holes[second].id.as_deref().unwrap_or_default();
        let [first, line] = [first, second].map(|index| positions[index].map(line_at));
        let first = first.map_or_else(String::new, |first| format!(", in line {first} first"));
        return Err(error(line, format!("id '{id}' is used twice{first}: give each hole its own")));
    }
    rows?;
    if list.holes.holes.is_empty() && stopped.is_none() {
        let example = example(&columns.names, separator);
        return Err(error(None, format!("no hole after the header: one line for each; {example}")));
    }
    list.note = columns.note(!list.open_depths.is_empty(), &cells);
    check_levels(&list, &columns, separator)?;
    Ok(list)
}

/// Returns an error for a list without depths, and without columns i, j and k, whose holes all begin below z 0: in many tables of
/// drawings z is the depth.
fn check_levels(list: &CsvList, columns: &Columns, separator: char) -> Result<(), FileError> {
    let holes = &list.holes.holes;
    let is_plain = columns.has("z") && !columns.has("i") && list.open_depths.len() == holes.len();
    let Some(first) = holes.first().filter(|_| is_plain && holes.iter().all(|hole| hole.entry[2] < 0.0))
    else {
        return Ok(());
    };
    let names: Vec<String> = columns.names.iter().filter(|name| *name != "depth").cloned().collect();
    let names: Vec<String> =
        names.into_iter().map(|name| if name == "z" { "depth".to_owned() } else { name }).collect();
    let example = example(&names, separator);
    Err(error(
        None,
        format!(
            "column 'z' is below 0 in all holes, {} in the first, and no depth is given: z is where a hole begins, 0 on most \
             plates, and its depth is a number above 0 in a column 'depth'; right columns: {}, and {example}; where all holes begin below z 0, add a column 'depth'",
            first.entry[2],
            names.join(&separator.to_string()),
        ),
    ))
}

/// A hole of a list.
struct CsvHole {
    hole: Hole,
    /// The list gives it no depth.
    is_open: bool,
}

/// The cells of one line.
struct Cells<'c> {
    columns: &'c Columns,
    of_hole: HoleColumns,
    record: csv::StringRecord,
    has_comma: Cell<bool>,
    has_point: Cell<bool>,
    /// A drill has no depth of its own, and is as deep as its hole.
    has_hole_deep_drill: bool,
    /// A ream or a bore of a through hole has no depth of its own, and is as deep as its hole.
    has_through_finish: bool,
    /// Holes whose depth is less than that of a feature.
    shallow: Vec<String>,
}

impl Cells<'_> {
    fn text(&self, column: Column<'_>) -> &str {
        column.place.and_then(|place| self.record.get(place)).unwrap_or_default().trim()
    }

    /// Returns a number; `None` for an empty cell.
    fn number(&self, column: Column<'_>) -> Result<Option<f64>, String> {
        let text = self.text(column);
        if text.is_empty() { Ok(None) } else { self.parse(column.name, text).map(Some) }
    }

    /// Parses a number, which has a decimal comma where commas are no separators.
    fn parse(&self, column: &str, text: &str) -> Result<f64, String> {
        if text.contains(['−', '–', '—']) {
            return Err(format!("column '{column}' is '{text}': a minus is the sign - of the keyboard"));
        }
        let text = if DIAMETERS.contains(&column) {
            if let Some(inches) = drill_size::inches(text) {
                return Ok(inches * MM_PER_INCH);
            }
            text.trim_start_matches(['Ø', 'ø', '⌀', '∅', 'Φ', 'φ']).trim_start()
        } else {
            text
        };
        let (has_comma, has_point) = (text.contains(','), text.contains('.'));
        if has_comma && self.columns.separator == ',' {
            return Err(format!(
                "column '{column}' is '{text}': a number with a point is required, because commas are separators"
            ));
        }
        self.has_comma.set(self.has_comma.get() || has_comma);
        self.has_point.set(self.has_point.get() || has_point);
        // One of the two could separate thousands.
        if self.columns.separator != ',' && self.has_comma.get() && self.has_point.get() {
            return Err(format!(
                "column '{column}' is '{text}': the list has commas and points in its numbers"
            ));
        }
        let number = if has_comma { text.replacen(',', ".", 1).parse() } else { text.parse() };
        let number: Result<f64, _> = number.map(|number: f64| number * self.columns.length_of_unit(column));
        number.map_err(|_| format!("column '{column}' is '{text}': a number is required"))
    }

    fn required(&self, column: Column<'_>, default: Option<f64>) -> Result<f64, String> {
        match (self.number(column)?, default.filter(|_| column.place.is_none())) {
            (Some(number), _) | (None, Some(number)) => Ok(number),
            (None, None) => Err(format!("column '{}' is empty: a number is required", column.name)),
        }
    }

    /// Returns the hole of the line.
    fn hole(&mut self, index: usize) -> Result<CsvHole, String> {
        let (count, expected) = (self.record.len(), self.columns.names.len());
        let has_more =
            expected < count && self.record.iter().skip(expected).any(|cell| !cell.trim().is_empty());
        if count < expected || has_more {
            let has_doubt = self.columns.separator == ',' && expected < count;
            let help = if has_doubt { ": decimal commas need semicolons between the columns" } else { "" };
            return Err(format!("{count} columns, the header has {expected}{help}"));
        }
        let (entry, axis) = if self.columns.is_round { self.round_place()? } else { self.place()? };
        let HoleColumns { id, depth, diameter, .. } = self.of_hole;
        if is_through(self.text(depth)) {
            return Err(format!(
                "column 'depth' is '{}': the thickness of the part is required, and true in a column 'through'",
                self.text(depth)
            ));
        }
        let mut hole = Hole {
            id: Some(self.text(id).to_owned()).filter(|id| !id.is_empty()),
            entry,
            axis,
            diameter: self.number(diameter)?,
            features: self.features()?,
            through: self.through()?,
            ..Hole::default()
        };
        let depth = self.number(depth)?;
        if let Some(depth) = depth.filter(|_| !hole.through)
            && hole.features.iter().any(|feature| exceeds(feature.bottom() - depth, 0.0))
        {
            self.shallow.push(hole.id.clone().unwrap_or_else(|| format!("#{}", index + 1)));
        }
        let is_open = depth.is_none() && hole.features.is_empty();
        if is_open && hole.through {
            return Err("column 'depth' is '': a through hole needs the thickness of the part".to_owned());
        }
        hole.depth = depth.unwrap_or(if is_open { OPEN_DEPTH } else { 0.0 });
        complete(&mut hole);
        if hole.depth == 0.0 && depth.is_none() {
            let is_there = if self.columns.has("depth") { "empty" } else { "missing" };
            return Err(format!("column 'depth' is {is_there}: a hole of countersinks alone needs it"));
        }
        check(&hole, index)?;
        Ok(CsvHole { hole, is_open })
    }

    /// Returns true if the line says that its hole goes through.
    fn through(&self) -> Result<bool, String> {
        match self.text(self.of_hole.through).to_lowercase().as_str() {
            "" | "false" | "no" | "n" | "0" | "-" | "nein" => Ok(false),
            "true" | "yes" | "y" | "1" | "x" | "ja" | "j" | "thru" | "through" | "durch" => Ok(true),
            other => Err(format!("column 'through' is '{other}': yes or no is required")),
        }
    }

    /// Returns the entry and the axis of the line.
    fn place(&self) -> Result<([f64; 3], [f64; 3]), String> {
        let HoleColumns { x, y, z, i, j, k, .. } = self.of_hole;
        let entry = [self.required(x, None)?, self.required(y, None)?, self.required(z, Some(0.0))?];
        let axis = [self.required(i, Some(0.0))?, self.required(j, Some(0.0))?, self.required(k, Some(1.0))?];
        Ok((entry, axis))
    }

    /// Returns the entry and the axis of a hole at an angle about x, in degrees from z towards y, that points away from x.
    fn round_place(&self) -> Result<([f64; 3], [f64; 3]), String> {
        let HoleColumns { x, angle, radius: radius_column, .. } = self.of_hole;
        let [x, angle, radius] = [x, angle, radius_column].map(|column| self.required(column, None));
        let (x, angle, radius) = (x?, angle?, radius?);
        if radius <= 0.0 {
            return Err(format!(
                "column 'radius' is '{}': a number above 0 is required",
                self.text(radius_column)
            ));
        }
        let (sine, cosine) = (Deg(angle).sin(), Deg(angle).cos());
        Ok(([x, radius * sine, radius * cosine], [0.0, sine, cosine]))
    }

    /// Returns the features of the line: those of the column `features`, then those with columns of their own.
    fn features(&mut self) -> Result<Vec<Feature>, String> {
        let mut cell = self.text(self.of_hole.features).to_owned();
        if self.columns.separator != ',' {
            self.has_comma.set(self.has_comma.get() || cell.contains(','));
            cell = cell.replace(',', ".");
        }
        let unit = self.columns.length_of_unit("features");
        let in_column = cell.split(';').map(str::trim).filter(|text| !text.is_empty());
        let mut features = in_column
            .map(|text| {
                Feature::parse_in(unit, text).map_err(|message| format!("column 'features': {message}"))
            })
            .collect::<Result<Vec<_>, _>>()?;
        let columns = self.columns;
        for kind in &columns.feature_kinds {
            features.extend(self.feature(*kind)?);
        }
        Ok(features)
    }

    /// Returns the feature of a kind that has columns of its own: `tap`, `tap depth`, `tap pitch`.
    fn feature(&mut self, kind: FeatureKind) -> Result<Option<Feature>, String> {
        let name = kind.name();
        let own = |value: &str| format!("{name} {value}");
        let columns = self.columns;
        let text = self.text(columns.column(name)).to_lowercase();
        if text.is_empty() {
            let given = |column: &String| !self.text(columns.column(column)).is_empty();
            return match FEATURE_COLUMNS.map(own).into_iter().find(given) {
                Some(column) => {
                    let text = self.text(columns.column(&column));
                    Err(format!("column '{column}' is '{text}': '{name}' is empty"))
                }
                None => Ok(None),
            };
        }
        let thread = thread_size::parse(&text).filter(|_| kind == FeatureKind::Tap).transpose()?;
        let diameter = match (thread, kind) {
            (Some(thread), _) => thread.diameter,
            (None, FeatureKind::Tap) => self
                .parse(name, &text)
                .map_err(|message| format!("{message}, or a thread such as M8, M8x1, 1/4-20 or G1/4"))?,
            (None, _) => self.parse(name, &text)?,
        };
        let own_pitch = self.number(columns.column(&own("pitch")))?;
        if let (Some(own), Some(thread)) = (own_pitch, thread)
            && exceeds((own - thread.pitch).abs(), SAME_PITCH)
        {
            return Err(format!(
                "column '{name} pitch' is {own}, and {text} has the pitch {:.4}",
                thread.pitch
            ));
        }
        let depth = own("depth");
        let written = self.text(columns.column(name)).to_owned();
        // Reamed and bored through holes are so over their whole length; a thread may be shorter.
        let is_through_finish = matches!(kind, FeatureKind::Ream | FeatureKind::Bore) && self.through()?;
        let is_hole_deep = kind == FeatureKind::Drill || is_through_finish;
        let of_hole = if is_hole_deep { self.number(self.of_hole.depth)? } else { None };
        let own_depth = self.number(columns.column(&depth))?;
        let is_taken = own_depth.is_none() && of_hole.is_some();
        self.has_hole_deep_drill |= is_taken && !is_through_finish;
        self.has_through_finish |= is_taken && is_through_finish;
        let is_deep = own_depth.or(of_hole).is_some() || kind == FeatureKind::Countersink;
        if !is_deep && columns.has(&depth) {
            return Err(format!("column '{depth}' is empty: {name} {written} needs a depth of its own"));
        }
        if !is_deep {
            return Err(format!("column '{depth}' is missing: {name} {written} needs a depth of its own"));
        }
        let to = own("to");
        let hand = own("hand");
        let feature = Feature {
            diameter,
            depth: own_depth.or(of_hole),
            angle: self.number(columns.column(&own("angle")))?,
            pitch: own_pitch.or(thread.map(|thread| thread.pitch)),
            to: match self.text(columns.column(&to)) {
                "" | "point" => DepthTo::Point,
                "full" => DepthTo::Full,
                other => return Err(format!("column '{to}' is '{other}': full or point is required")),
            },
            hand: match self.text(columns.column(&hand)) {
                "" => thread.and_then(|thread| thread.hand).unwrap_or_default(),
                "right" => Hand::Right,
                "left" => Hand::Left,
                other => return Err(format!("column '{hand}' is '{other}': right or left is required")),
            },
            ..Feature::of(kind)
        };
        Ok(Some(feature))
    }
}
