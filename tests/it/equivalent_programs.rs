//! A rewritten program has no change: other sequence numbers, locals, remarks, spaces, digits and order of words; tried on the programs
//! of the families, on every example with its macros, and on the programs of cases.
use std::path::Path;

use gcode_inspect::machine::Machine;
use gcode_lang::program::Library;
use gcode_review::{Record, Revision, changes};
use gcode_session::Request;
use gcode_tests::workspace;

use crate::accepted::{EditedLibrary, folders, mains, request};
use crate::mutations::cases;

/// A text with N and GOTO counted from elsewhere, #27 to #33 in the opposite order, two blanks for one, a 0 behind each
/// fraction, axis words and F at the beginning of their block, and a remark in place of each that stands alone. What an operator
/// is shown stays.
fn rewrite(text: &str) -> String {
    // A computed number selects the block or the local.
    let is_counted = !["GOTO#", "GOTO #", "GOTO["].iter().any(|jump| text.contains(jump));
    let is_named = !text.contains("#[");
    let line = |line: &str| {
        if line.starts_with('(') {
            return "(ANOTHER REMARK)".to_owned();
        }
        let (code, remark) = line.find('(').map_or((line, ""), |at| line.split_at(at));
        let mut code = code.to_owned();
        if is_named {
            code = (27..=33).fold(code, |code, n| code.replace(&format!("#{n}"), &format!("#@{}@", 60 - n)));
            code = code.replace("#@", "#").replace('@', "");
        }
        let code = digits(&reordered(&code)).replace(' ', "  ");
        format!("{}{remark}", if is_counted { renumbered(&code) } else { code })
    };
    text.lines().map(|one| line(one) + "\n").collect()
}

/// N numbers and the targets of jumps 5000 higher.
fn renumbered(code: &str) -> String {
    let mut renumbered = String::new();
    let mut rest = code;
    let target =
        |text: &str| ["GOTO", "M99 P", "M99  P"].iter().find_map(|jump| Some(text.find(jump)? + jump.len()));
    while let Some(at) = rest.starts_with('N').then_some(1).or_else(|| target(rest)) {
        let digits = rest[at..].trim_start().chars().take_while(char::is_ascii_digit).count();
        let skip = rest[at..].len() - rest[at..].trim_start().len();
        let number = &rest[at + skip..at + skip + digits];
        renumbered.push_str(&rest[..at]);
        renumbered.push_str(&number.parse::<u32>().map_or(String::new(), |n| (n + 5000).to_string()));
        rest = &rest[at + skip + digits..];
    }
    renumbered + rest
}

/// Axis words and F of a block of plain words before its codes.
fn reordered(code: &str) -> String {
    let words: Vec<&str> = code.split_whitespace().collect();
    let is_plain = |word: &&str| {
        let number = word.trim_start_matches(|c: char| c.is_ascii_uppercase());
        word.len() == number.len() + 1
            && !number.is_empty()
            && number.chars().all(|c| c.is_ascii_digit() || ".-".contains(c))
    };
    // A call hands its words over in their order; a data block has its own.
    let is_other =
        |word: &&str| ["G65", "G66", "G10", "G04", "G4", "O"].iter().any(|code| word.starts_with(code));
    if !words.iter().all(is_plain) || words.iter().any(is_other) {
        return code.to_owned();
    }
    let rank = |word: &&str| match word.as_bytes()[0] {
        b'N' => 0,
        b'X' | b'Y' | b'Z' | b'A' | b'B' | b'C' | b'F' => 1,
        _ => 2,
    };
    let mut words = words;
    words.sort_by_key(rank);
    words.join(" ")
}

/// `1.5` as `1.50`, `3.` as `3.0`.
fn digits(code: &str) -> String {
    let mut written = String::new();
    let mut number = String::new();
    for c in code.chars().chain(['\n']) {
        if c.is_ascii_digit() || c == '.' {
            number.push(c);
            continue;
        }
        // A control reads eight digits.
        let more = if number.contains('.') && number.len() < 8 { "0" } else { "" };
        written.push_str(&number);
        written.push_str(more);
        number.clear();
        written.push(c);
    }
    written.trim_end_matches('\n').to_owned()
}

#[test]
fn a_rewritten_program_has_other_numbers_remarks_and_order() {
    let text =
        "O1\nN10 G90 G01 X1.5 Y-3. F100 (KEEP)\n(GONE)\n#30=#27+.5\nIF[#1 GT 2.]GOTO 10\nG65 P9 B2. A1.\n";
    let expected = "O1\nN5010  X1.50  Y-3.0  F100  G90  G01(KEEP)\n(ANOTHER REMARK)\n#30=#33+.50\nIF[#1  GT  2.0]GOTO5010\nG65  P9  B2.0  A1.0\n";
    assert_eq!(rewrite(text), expected);
}

#[test]
fn a_rewritten_program_of_a_family_has_no_change() {
    let less = [("flutes = 16", "flutes = 1"), ("length = 300.0", "length = 20.0")];
    for family in gcode_gen::families::ALL {
        let job = less.iter().fold(family.new_job.to_owned(), |job, (from, to)| job.replace(from, to));
        let package = gcode_gen::families::emit(&gcode_part::job::Job::parse(&job).unwrap());
        let mut other = package.clone();
        other.programs.iter_mut().for_each(|program| program.text = rewrite(&program.text));
        for main in &package.mains {
            let of = |package: &gcode_gen::package::Package| {
                let machine = Machine::parse(&package.machine).unwrap();
                let text = package.program(*main).unwrap().text.as_bytes().to_vec();
                let request = Request::new(format!("O{main}.nc"), text, machine);
                Revision::of(&request, &mut gcode_gen::check::Programs(package), None).unwrap().record
            };
            let (was, is) = (of(&package), of(&other));
            assert!(1 < was.totals.blocks, "{}: O{main} does nothing", family.name);
            let found = changes(&was, &is, 0.0001);
            assert!(found.is_empty(), "{}: O{main}: {found:#?}", family.name);
        }
    }
}

fn record(main: &Path, text: String, library: &mut impl Library) -> Option<Record> {
    let mut request = request(main);
    request.bytes = text.into_bytes().into();
    Some(Revision::of(&request, library, None).ok()?.record)
}

/// Programs that a rewriting changes, and why.
const OTHER: [(&str, &str); 1] = [("one_change/parameter.nc", "behind G10 L52 an N names a parameter")];

#[test]
fn a_rewritten_example_or_case_has_no_change() {
    let (mut wrong, mut tried) = (String::new(), 0);
    for main in mains().into_iter().chain(cases()) {
        let name = main.strip_prefix(workspace()).unwrap().display().to_string();
        let Ok(text) = std::fs::read_to_string(&main) else { continue };
        if OTHER.iter().any(|(part, _)| name.contains(part)) {
            continue;
        }
        let was = record(&main, text.clone(), &mut folders(&main));
        let is = record(&main, rewrite(&text), &mut EditedLibrary::new(&main, |_, text| rewrite(&text)));
        let (Some(was), Some(is)) = (was, is) else { continue };
        tried += 1;
        for change in changes(&was, &is, 0.0001) {
            wrong.push_str(&format!("{name}: {}: {}\n", change.code, change.message));
        }
    }
    assert!(wrong.is_empty(), "{wrong}");
    assert!(tried > 200, "too few: {tried}");
}
