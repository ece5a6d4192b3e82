//! The columns of a list: the separator, their names, and what a list without some of them means.
use super::Cells;
use super::names::{
    COLUMNS, DIAMETER_WORDS, FEATURE_COLUMNS, FEATURE_NAMES, REMARKS, ROUND, TWO_MEANINGS, VALUE_NAMES,
    is_known, unit_of,
};
use crate::feature::FeatureKind;
use crate::hole::{MM_PER_INCH, Unit};
use gcode_lang::similar;

/// Largest number of lines with a title that are looked for above the names of the columns.
const MOST_TITLES: usize = 8;

/// Returns true if the first line looks like a header of columns, unlike the first line of a job file.
pub(crate) fn is_csv(text: &str) -> bool {
    let first = first_line(text);
    let separator = separator(first);
    // `#` heads the numbers of the holes; with words behind it, it is a comment.
    if first.trim_start().starts_with('#')
        && first.split(separator).next().is_none_or(|cell| cell.trim() != "#")
    {
        return false;
    }
    let names: Vec<_> = first.split(separator).map(column_name).collect();
    // A job file begins with a key and its value, or with a section.
    1 < names.len() && !first.contains('=') && !names[0].starts_with('[')
}

/// Returns the line and the fault of a list that begins with values instead of the names of its columns, or whose names
/// have only spaces between them; `None` for another text.
pub(crate) fn wrong_header(text: &str) -> Option<(usize, String)> {
    let first = first_line(text);
    let line = text.lines().position(|line| line == first)? + 1;
    let words: Vec<&str> = first.split_whitespace().collect();
    if words.iter().any(|word| word.eq_ignore_ascii_case("x"))
        && words.iter().any(|word| word.eq_ignore_ascii_case("y"))
        && !first.contains([',', ';', '\t', '='])
    {
        let message = "columns are separated by spaces: separate them by commas, semicolons or tabs";
        return Some((line, format!("{message}; {}", example(&[], ','))));
    }
    // A title above the table.
    let has_place = |line: &str| {
        let names: Vec<String> = line.split(separator(line)).map(column_name).collect();
        let has = |column: usize| {
            let (own, others) = COLUMNS[column];
            names.iter().any(|name| name == own || others.contains(&name.as_str()))
        };
        has(1) && (has(2) || names.iter().any(|name| name == ROUND[0]))
    };
    let below = text.lines().enumerate().skip(line).take(MOST_TITLES).find(|(_, below)| has_place(below));
    if let Some((below, _)) = below.filter(|_| !has_place(first)) {
        let message = "line {} names the columns, and has to be the first: remove what stands above it";
        return Some((line, message.replace("{}", &(below + 1).to_string())));
    }
    let separator = separator(first);
    let cells: Vec<&str> = first.split(separator).map(str::trim).collect();
    let is_number = |cell: &&str| cell.replacen(',', ".", 1).parse::<f64>().is_ok();
    let numbers = cells.iter().filter(|cell| is_number(cell)).count();
    let message = format!("the names of the columns are missing; {}", example(&[], separator));
    let is_x = |cell: &&str| COLUMNS[1].1.contains(&column_name(cell).as_str()) || column_name(cell) == "x";
    let has_names = cells.iter().any(is_x);
    (1 < numbers && !has_names).then_some((line, message))
}

/// Returns the first line with columns: Excel may write the separator as a line before it.
pub(super) fn first_line(text: &str) -> &str {
    let mut lines = text.lines().filter(|line| !line.trim().is_empty());
    lines.find(|line| !is_separator_line(line)).unwrap_or_default()
}

fn is_separator_line(line: &str) -> bool {
    line.trim().trim_matches('"').to_lowercase().starts_with("sep=")
}

/// Returns the character between the columns of a header.
pub(super) fn separator(header: &str) -> char {
    let count = |separator: char| header.matches(separator).count();
    [',', ';', '\t'].into_iter().rev().max_by_key(|separator| count(*separator)).unwrap_or(',')
}

/// Returns the name of a column in lower case, without quotes and a unit in brackets; an unknown unit stays.
pub(super) fn column_name(cell: &str) -> String {
    name_and_unit(cell).0
}

/// Returns the name of a column, and its unit of length if brackets behind it have one.
fn name_and_unit(cell: &str) -> (String, Option<Unit>) {
    let name = cell.trim().trim_matches('"').trim().to_lowercase().replace(['_', '-'], " ");
    let Some(at) = name.find(['[', '(']) else {
        // Without brackets, behind a known name: `X mm`.
        let split = name.rsplit_once(' ').and_then(|(before, word)| Some((before, unit_of(word)?)));
        return match split.filter(|(before, _)| is_known(before)) {
            Some((before, unit)) => (before.to_owned(), unit),
            None => (name, None),
        };
    };
    match unit_of(name[at + 1..].trim_end_matches([']', ')'])) {
        Some(unit) => (name[..at].trim().to_owned(), unit),
        None => (name, None),
    }
}

/// Returns the unit of all lengths of a list by the units in its header; mm without one.
pub(super) fn unit<'c>(header: impl Iterator<Item = &'c str>) -> Result<Unit, String> {
    let mut units = header.filter_map(|cell| name_and_unit(cell).1);
    let first = units.next().unwrap_or_default();
    match units.all(|unit| unit == first) {
        true => Ok(first),
        false => Err("columns are in mm and in inches: give all lengths in one unit".to_owned()),
    }
}

/// Returns a line that would be right below these columns; without columns, a short list.
pub(super) fn example(names: &[String], separator: char) -> String {
    let text = separator.to_string();
    if names.is_empty() {
        let lines = ["id,x,y,depth,diameter", "1,30,10,15,6"].map(|line| line.replace(',', &text));
        return format!(
            "a list begins with its columns, for example: {}, and below them: {}",
            lines[0], lines[1]
        );
    }
    let point = if separator == ',' { "." } else { "," };
    let has = |wanted: &str| names.iter().any(|name| name == wanted);
    // A diameter beside features is that of one of them.
    let has_features = FeatureKind::ALL.iter().any(|kind| has(kind.name()));
    let cell = |name: &String| match name.as_str() {
        "id" | "k" => "1".to_owned(),
        "x" => format!("30{point}5"),
        "y" => "10".to_owned(),
        "z" | "i" | "j" => "0".to_owned(),
        "angle" => "90".to_owned(),
        "radius" => "25".to_owned(),
        "depth" | "drill depth" => "15".to_owned(),
        "diameter" if !has_features => "6".to_owned(),
        "through" => "false".to_owned(),
        "features" => "drill 6 15".to_owned(),
        "drill" => format!("6{point}8"),
        "ream" | "bore" => "8".to_owned(),
        "tap" => "M8".to_owned(),
        "ream depth" | "bore depth" | "tap depth" | "countersink" => "12".to_owned(),
        "counterbore" => "14".to_owned(),
        "counterbore depth" => "5".to_owned(),
        "countersink angle" => "90".to_owned(),
        _ => String::new(),
    };
    // A drilled diameter beside a thread is a feature.
    let mut all = names.to_vec();
    if (has("tap") || has("counterbore"))
        && !has("drill")
        && let Some(place) = names.iter().position(|name| name == "diameter")
    {
        "drill".clone_into(&mut all[place]);
    }
    // Each feature has a depth of its own, but for a drill that goes to the depth of the hole, and a cone.
    for kind in FeatureKind::ALL {
        let value = if kind == FeatureKind::Countersink { "angle" } else { "depth" };
        let own = format!("{} {value}", kind.name());
        let is_deep = kind == FeatureKind::Drill && has("depth");
        if let Some(place) = all.iter().position(|name| name == kind.name())
            && !is_deep
            && !all.contains(&own)
        {
            all.insert(place + 1, own);
        }
    }
    // A cone alone has no depth.
    let is_deep = |kind: &FeatureKind| *kind != FeatureKind::Countersink && has(kind.name());
    if has("countersink") && !has("depth") && !has("features") && !FeatureKind::ALL.iter().any(is_deep) {
        all.push("depth".to_owned());
    }
    if has("through") && !has("depth") && !has("features") && !FeatureKind::ALL.iter().any(is_deep) {
        all.push("depth".to_owned());
    }
    let line: Vec<_> = all.iter().map(cell).collect();
    match all == names {
        true => format!("a right line: {}", line.join(&text)),
        false => format!("right columns: {}, and a right line: {}", all.join(&text), line.join(&text)),
    }
}

/// Renames the column `drill` to `diameter` where a list says no more of a hole than that.
fn drill_alone_is_the_diameter(names: &mut [String]) {
    let says_more = |name: &String| {
        let is_of_kind = FeatureKind::ALL.iter().any(|kind| name.starts_with(kind.name()));
        matches!(name.as_str(), "diameter" | "depth" | "features") || (name != "drill" && is_of_kind)
    };
    if !names.iter().any(says_more)
        && let Some(drill) = names.iter_mut().find(|name| *name == "drill")
    {
        "diameter".clone_into(drill);
    }
}

/// Returns true for columns of holes round x: an angle in place of y.
fn is_round(names: &[String]) -> bool {
    let has = |wanted: &str| names.iter().any(|name| name == wanted);
    has("angle") && !has("y")
}

/// A column by its name, with its place in a line; `None` if the list lacks it.
#[derive(Clone, Copy)]
pub(super) struct Column<'n> {
    pub(super) name: &'n str,
    pub(super) place: Option<usize>,
}

/// The columns of a hole, besides those of its features.
#[derive(Clone, Copy)]
pub(super) struct HoleColumns {
    pub(super) id: Column<'static>,
    pub(super) x: Column<'static>,
    pub(super) y: Column<'static>,
    pub(super) z: Column<'static>,
    pub(super) i: Column<'static>,
    pub(super) j: Column<'static>,
    pub(super) k: Column<'static>,
    pub(super) angle: Column<'static>,
    pub(super) radius: Column<'static>,
    pub(super) depth: Column<'static>,
    pub(super) diameter: Column<'static>,
    pub(super) features: Column<'static>,
    pub(super) through: Column<'static>,
}

impl HoleColumns {
    /// Finds them once for all lines.
    pub(super) fn of(columns: &Columns) -> Self {
        let [id, x, y, z, i, j, k, angle, radius, depth, diameter, features, through] =
            COLUMNS.map(|(name, _)| columns.column(name));
        Self { id, x, y, z, i, j, k, angle, radius, depth, diameter, features, through }
    }
}

/// The columns of a list by their names, other names and unused columns among them.
pub(super) struct Columns {
    pub(super) names: Vec<String>,
    unused: Vec<String>,
    /// Kinds of features with columns of their own.
    pub(super) feature_kinds: Vec<FeatureKind>,
    pub(super) separator: char,
    /// Unit of all lengths.
    pub(super) unit: Unit,
    /// `angle` and `radius` are the places of the holes, round the axis x.
    pub(super) is_round: bool,
}

impl Columns {
    /// Returns the columns; refuses a list without x and y, one with a column twice, and misspelt names.
    pub(super) fn new(mut names: Vec<String>, separator: char, unit: Unit) -> Result<Self, String> {
        for (name, others) in COLUMNS {
            if !names.iter().any(|other| other == name)
                && let Some(place) = names.iter().position(|other| others.contains(&other.as_str()))
            {
                name.clone_into(&mut names[place]);
            }
        }
        for (name, meaning, other) in TWO_MEANINGS {
            let free = [Some(meaning), other].into_iter().flatten();
            let free = free.into_iter().find(|free| !names.iter().any(|name| name == free));
            if let (Some(place), Some(free)) = (names.iter().position(|other| other == name), free) {
                free.clone_into(&mut names[place]);
            }
        }
        let kinds = FeatureKind::ALL.map(FeatureKind::name);
        for name in &mut names {
            for (other, kind) in FEATURE_NAMES {
                match name.strip_prefix(other) {
                    Some(rest) if rest.is_empty() || rest.starts_with(' ') => {
                        *name = format!("{}{rest}", kind.name());
                    }
                    _ => {}
                }
            }
            if let Some((_, meant)) = VALUE_NAMES.iter().find(|(other, _)| other == name) {
                (*meant).clone_into(name);
            }
            let of_kind =
                |kind: &str| DIAMETER_WORDS.iter().any(|word| name.strip_suffix(word) == Some(kind));
            if let Some(kind) = kinds.into_iter().find(|kind| of_kind(kind)) {
                kind.clone_into(name);
            }
        }
        drill_alone_is_the_diameter(&mut names);
        let is_round = is_round(&names);
        let of_features =
            kinds.iter().flat_map(|kind| FEATURE_COLUMNS.map(|value| format!("{kind} {value}")));
        let known: Vec<String> = COLUMNS
            .iter()
            .map(|(name, _)| (*name).to_owned())
            .chain(kinds.map(str::to_owned))
            .chain(of_features)
            .collect();
        let mut unused = Vec::new();
        for (index, name) in names.iter().enumerate() {
            if known.contains(name) {
                if names[..index].contains(name) {
                    return Err(format!("column '{name}' is there twice"));
                }
                if !is_round && ROUND.contains(&name.as_str()) {
                    unused.push(name.clone());
                }
                continue;
            }
            if name.contains(['(', '[']) && known.iter().any(|known| name.starts_with(known.as_str())) {
                return Err(format!("column '{name}': lengths are in mm, or in inches: [mm] or [inch]"));
            }
            match similar(name, known.iter().map(String::as_str))
                .filter(|known| !names.iter().any(|name| name == known))
            {
                Some(meant) => return Err(format!("column '{name}' is unknown (did you mean '{meant}'?)")),
                None if name.is_empty() => {}
                None => unused.push(name.clone()),
            }
        }
        let is_of = |name: &str, kind: FeatureKind| {
            name.strip_prefix(kind.name()).is_some_and(|rest| rest.is_empty() || rest.starts_with(' '))
        };
        let has_columns = |kind: &FeatureKind| names.iter().any(|name| is_of(name, *kind));
        let feature_kinds = FeatureKind::ALL.into_iter().filter(has_columns).collect();
        let columns = Self { names, unused, feature_kinds, separator, unit, is_round };
        let place: &[&str] = if is_round { &["x", "angle", "radius"] } else { &["x", "y"] };
        if let Some(missing) = place.iter().find(|name| !columns.has(name)) {
            let round = if is_round { ": x, angle and radius are the place of a hole round x" } else { "" };
            let there = columns.names.iter().filter(|name| !name.is_empty()).cloned().collect::<Vec<_>>();
            return Err(format!("column '{missing}' is missing among {}{round}", there.join(", ")));
        }
        if let Some(other) = ["z", "i", "j", "k"].into_iter().find(|name| is_round && columns.has(name)) {
            return Err(format!("column '{other}' is there: it follows from angle and radius"));
        }
        let axis = ["i", "j", "k"];
        match axis.into_iter().find(|name| !columns.has(name)) {
            Some(missing) if axis.into_iter().any(|name| columns.has(name)) => {
                Err(format!("column '{missing}' is missing: i, j and k together are the axis"))
            }
            _ => Ok(columns),
        }
    }

    pub(super) fn has(&self, name: &str) -> bool {
        self.column(name).place.is_some()
    }

    /// Returns the unused columns that may state something of a hole; remarks don't.
    pub(super) fn unread(&self) -> Vec<String> {
        let is_remark = |name: &str| REMARKS.contains(&name);
        self.unused.iter().filter(|name| !is_remark(name)).cloned().collect()
    }

    /// Returns the length of the unit of a column's numbers, mm; 1 for a column without lengths.
    pub(super) fn length_of_unit(&self, column: &str) -> f64 {
        let is_length = || !matches!(column, "i" | "j" | "k" | "angle") && !column.ends_with(" angle");
        if self.unit == Unit::Inch && is_length() { MM_PER_INCH } else { 1.0 }
    }

    pub(super) fn column<'n>(&self, name: &'n str) -> Column<'n> {
        Column { name, place: self.names.iter().position(|other| other == name) }
    }

    /// Returns what the reader takes for granted.
    pub(super) fn note(&self, has_open_depths: bool, cells: &Cells<'_>) -> Option<String> {
        let Cells { has_comma, has_hole_deep_drill, has_through_finish, shallow, .. } = cells;
        let mut facts = Vec::new();
        if self.unit == Unit::Inch {
            facts.push("lengths are in inches".to_owned());
        }
        if self.is_round {
            facts.push("angle counts about x, from z towards y, and the axis is along radius".to_owned());
        }
        if !self.has("z") && !self.is_round {
            facts.push("z is 0: no column z".to_owned());
        }
        if !self.has("i") && !self.is_round {
            facts.push("the axis is 0, 0, 1: no columns i, j, k".to_owned());
        }
        if has_open_depths {
            facts.push("depths that are left out are not compared".to_owned());
        }
        if *has_hole_deep_drill {
            facts.push("a drill without a depth of its own is as deep as its hole".to_owned());
        }
        if *has_through_finish {
            facts.push(
                "reaming or boring of a through hole without a depth of its own is as deep as its hole"
                    .to_owned(),
            );
        }
        if let Some(first) = shallow.first() {
            let others =
                if shallow.len() == 1 { String::new() } else { format!(" and {} others", shallow.len() - 1) };
            facts.push(format!(
                "the depth of hole {first}{others} is less than that of a feature: the feature counts"
            ));
        }
        if has_comma.get() {
            facts.push("commas in numbers are decimal commas".to_owned());
        }
        if !self.unused.is_empty() {
            facts.push(format!("unused: {}", self.unused.join(", ")));
        }
        (!facts.is_empty()).then(|| facts.join("; "))
    }
}
