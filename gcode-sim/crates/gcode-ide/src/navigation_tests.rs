//! Tests of definitions, references, symbols, folding, calls and links.
use gcode_lang::control::Settings;

use crate::folding::FoldingKind;
use crate::navigation::Access;
use crate::project::{ProgramKey, Project};
use crate::symbols::DocumentSymbol;
use crate::testing::fixture;
use crate::text::FileId;

fn defined(text: &str) -> Vec<String> {
    let fixture = fixture(text);
    let found = fixture.project.definition(fixture.file, fixture.offset);
    let targets = found.into_iter().flat_map(|found| found.targets);
    targets.map(|target| fixture.place(target.file, target.selection)).collect()
}

fn referred(text: &str) -> Vec<String> {
    let fixture = fixture(text);
    let found = fixture.project.references(fixture.file, fixture.offset, true).into_iter();
    let shown = found.map(|reference| {
        let sign = match reference.access {
            Access::Declaration => "!",
            Access::Read => "",
            Access::Write => "=",
        };
        format!("{}{sign}", fixture.place(reference.location.file, reference.location.range))
    });
    shown.collect()
}

#[test]
fn a_jump_leads_to_its_block() {
    assert_eq!(defined("O1\nN10\nGOTO $0100\nN100 M30\nO2\nN100\n"), ["4:N100"]);
    assert_eq!(defined("O1\nN5\nN5\nGOTO $05\nN5 M30\n"), ["5:N5"], "the next one");
    assert_eq!(defined("O1\nN5\nN5\nGOTO $05\nM30\n"), ["2:N5"], "otherwise the first");
    assert_eq!(defined("O1\nGOTO $05\nM30\nO2\nN5\n"), [""; 0]);
    assert_eq!(defined("O1\nGOTO $0#1\nM30\n"), [""; 0]);
    assert_eq!(defined("O1\nM98 P2\nN7 M30\nO2\nM99 P$07\n"), ["3:N7"], "in the caller");
    assert_eq!(defined("O1\nM98 P2 Q$05\nN5 M30\nO2\nN5 M99\n"), ["5:N5"], "in the called program");
    assert_eq!(defined("O1\n..5 X\nGOTO $05\nX..5\nN5 M30\n"), ["5:N5"], "about broken lines");
}

#[test]
fn a_call_leads_to_its_program() {
    let library = "//- O9001.nc\n%\nO9001(DRILL)\nM99\n%\n";
    assert_eq!(defined(&format!("//- O1.nc\nO1\nG65 P9$0001 A1.\nM30\n{library}")), ["1:2:O9001"]);
    assert_eq!(defined(&format!("//- O1.nc\nO1\nG$065 P9001 A1.\nM30\n{library}")), ["1:2:O9001"]);
    assert_eq!(
        defined("//- O1.nc\nO1\nM98 P$09001\nM30\n//- sub/o9001.NC\nX1.\nM99\n"),
        ["1:1:"],
        "by the name of its file"
    );
    assert_eq!(defined("O1\nM98 P<SU$0B>\nM30\n<SUB>\nM99\n"), ["4:<SUB>"]);
}

#[test]
fn a_variable_leads_to_its_value() {
    assert_eq!(defined("O1\nX#$01\n#1=5\n#1=6\nM30\n"), ["3:#1"]);
    assert_eq!(defined("//- O1.nc\nO1\nX#$0500\nM30\n//- O2.nc\nO2\n#500=1\nM30\n"), ["1:2:#500"]);
    assert_eq!(defined("O9(T)\n(A #1 RADIUS)\nX#$01\nM99\n"), ["2:(A #1 RADIUS)"]);
    assert_eq!(defined("O1\nG65 P9 R$05.\nM30\nO9\n(R #18 RADIUS)\nX#18\nM99\n"), ["5:(R #18 RADIUS)"]);
    assert_eq!(defined("O1\nG65 P9 R$05.\nM30\nO9\nX#18\nM99\n"), ["5:#18"]);
}

#[test]
fn references_are_told_apart_by_their_use() {
    assert_eq!(referred("O1\nG65 P9 A5.\n#1=2\nM30\nO9\n#2=#$01\nX#1 (#1)\nM99\n"), ["2:A=", "6:#1", "7:#1"]);
    assert_eq!(
        referred(
            "//- O1.nc\nO1\n#5$000=1\nWHILE[#500 LT 2]DO1\n#500=#500+1\nEND1\n//- O2.nc\nO2\nDPRNT[#500[44]]\n"
        ),
        ["2:#500=", "3:#500", "4:#500=", "4:#500", "1:2:#500"]
    );
    assert_eq!(referred("O1\nN5\nIF[#1 EQ 1]GOTO 5\nGOTO $05\nO2\nGOTO 5\n"), ["2:N5!", "3:5", "4:5"]);
    assert_eq!(referred("O1\nG65 P2\nM98 P2\nM30\n$0O2\nM99\n"), ["2:P2", "3:P2", "5:O2!"]);
    assert_eq!(
        referred("O1\nSETVN 510[TOOL,WORK]\n#$0511=1\nX[#WORK]\nY[#TOOL]\nM30\n"),
        ["3:#511=", "4:[#WORK]"],
        "a name that a program gives"
    );
    assert_eq!(referred("O1\n#1=#$05021\nX[#_ABSMT[1]]\n"), ["2:#5021", "3:[#_ABSMT[1]]"]);
}

#[test]
fn symbols_are_nested() {
    let fixture = fixture("O1(TITLE)\nN10 G0\nWHILE[#1 LT 3]DO1\nN20 X#1\nEND1\nN30 M30\nO2\nDO2\n");
    fn shown(symbols: &[DocumentSymbol]) -> String {
        let each = symbols.iter().map(|s| format!("{}{}", s.name, shown(&s.children)));
        let all = each.collect::<Vec<_>>().join(" ");
        if all.is_empty() { all } else { format!("({all})") }
    }
    let symbols = fixture.project.document_symbols(FileId(0));
    assert_eq!(shown(&symbols), "(O0001(N10 WHILE[#1 LT 3]DO1(N20) N30) O0002(DO2))");
    assert_eq!((symbols[0].detail.as_str(), symbols[0].children[0].detail.as_str()), ("TITLE", "G0"));
    check_nesting(&symbols, 0, u32::MAX);
}

/// A control has DO1 to DO3, and none of them within itself.
#[test]
fn loops_without_their_end_are_no_deeper_than_a_control_has_them() {
    fn depth(symbols: &[DocumentSymbol]) -> usize {
        symbols.iter().map(|symbol| 1 + depth(&symbol.children)).max().unwrap_or(0)
    }
    let loops: String = (0..20_000).map(|n| format!("WHILE[#1 LT 1]DO{}\nN{n}\n", 1 + n % 7)).collect();
    let symbols = fixture(&format!("O1\n{loops}")).project.document_symbols(FileId(0));
    assert_eq!(depth(&symbols), 5, "program, three loops, N");
    check_nesting(&symbols, 0, u32::MAX);
}

#[test]
fn the_callers_of_a_file_are_files() {
    let mut project = Project::new(Settings::default());
    let files = [
        ("p/b", "O1\nM98 P3\nM98 P4\nM30\n"),
        ("p/a", "O2\nG65 P4\nM98 P5\nO5\nM99\n"),
        ("p/c", "O3\nM98 P4\nM99\nO4\nM99\n"),
    ];
    for (id, (name, text)) in (0..).zip(files) {
        project.set_file(FileId(id), name, text.as_bytes().to_vec());
    }
    assert_eq!(project.calling_files(FileId(2)), [FileId(1), FileId(0)], "by name; its own calls aside");
    assert_eq!(project.calling_files(FileId(1)), []);
}

/// Checks that symbols lie in a range, their names in them, and so on inside.
fn check_nesting(symbols: &[DocumentSymbol], start: u32, end: u32) {
    for symbol in symbols {
        assert!(start <= symbol.range.start && symbol.range.end <= end, "{symbol:?}");
        assert!(symbol.range.start <= symbol.selection.start && symbol.selection.end <= symbol.range.end);
        check_nesting(&symbol.children, symbol.range.start, symbol.range.end);
    }
}

#[test]
fn a_symbol_of_the_last_line_ends_with_its_program() {
    for text in ["O1\nG21\nN9 ", "O1\nN9 X1. % Y2.\n", "O1\nDO1\nN9 \t", "O1\nDO1\nX1.\nEND1  "] {
        check_nesting(&fixture(text).project.document_symbols(FileId(0)), 0, u32::MAX);
    }
}

#[test]
fn the_order_in_which_files_are_opened_decides_nothing() {
    let main = ("p/O1.nc", "O1\nG65 P9 A1.\n#500=1.\nM30\n");
    let other = ("p/O2.nc", "O2\nG65 P9 A2.\n#500=2.\nM30\n");
    let called = ("p/O9.nc", "O9\nX#500\nM99\n");
    let shown = |files: [(&str, &str); 3]| {
        let mut project = Project::new(Settings::default());
        for (id, (name, text)) in (0..).zip(files) {
            project.set_file(FileId(id), name, text.as_bytes().to_vec());
        }
        let name = |file| project.file_name(file).unwrap().to_owned();
        let id = project.files().map(|(id, _)| id).find(|id| name(*id) == "p/O9.nc").unwrap();
        // Of the O word and of #500.
        let references = [1, 5].map(|offset| project.references(id, offset, true)).concat().into_iter();
        let places = references.map(|found| (name(found.location.file), found.location.range));
        let callers = project.incoming_calls(ProgramKey { file: id, program: 0 }).into_iter();
        let definition = project.definition(id, 5).unwrap().targets.into_iter();
        (
            places.collect::<Vec<_>>(),
            callers.map(|group| group.item.name).collect::<Vec<_>>(),
            definition.map(|target| name(target.file)).collect::<Vec<_>>(),
        )
    };
    let first = shown([main, other, called]);
    assert_eq!(first.1, ["O0001", "O0002"]);
    assert_eq!(first.2, ["p/O1.nc", "p/O2.nc"]);
    assert_eq!(shown([called, other, main]), first);
    assert_eq!(shown([other, main, called]), first);
}

#[test]
fn symbols_of_the_project_are_found_by_name_and_title() {
    let fixture = fixture("//- O1.nc\nO1(MAIN)\nN70\n//- O8101.nc\nO8101(ONE HOLE)\nM99\n");
    let found = |query: &str| {
        let symbols = fixture.project.workspace_symbols(query, 10).into_iter();
        symbols.map(|symbol| symbol.name).collect::<Vec<_>>()
    };
    assert_eq!(found("hole"), ["O8101"]);
    assert_eq!(found("o1"), ["O0001"], "its number");
    assert_eq!(found("810"), ["O8101"]);
    assert_eq!(found(""), ["O0001", "O8101"]);
    assert_eq!(found("N7"), ["N70"]);
}

#[test]
fn programs_loops_jumps_and_comments_fold() {
    let text = "O1\n(A)\n(B)\nIF[#1 EQ 1]GOTO 5\nX1.\nN5 DO1\nX2.\nEND1\n(ONE)\nM30\n";
    let fixture = fixture(text);
    let found = fixture.project.folding_ranges(FileId(0)).into_iter();
    let shown: Vec<_> = found.map(|folding| (folding.kind, fixture.text(FileId(0), folding.range))).collect();
    assert_eq!(
        shown,
        [
            (FoldingKind::Program, text.trim_end().to_owned()),
            (FoldingKind::Comment, "(A)\n(B)".to_owned()),
            (FoldingKind::If, "IF[#1 EQ 1]GOTO 5\nX1.".to_owned()),
            (FoldingKind::Loop, "DO1\nX2.\nEND1".to_owned()),
        ]
    );
}

#[test]
fn calls_and_links_go_both_ways() {
    let fixture = fixture("//- O1.nc\nO1\nG65 P2\nM98 P2\nG65 P7\nM30\n//- O2.nc\nO$02(T)\nM98 P1\nM99\n");
    let project = &fixture.project;
    let item = project.call_item(fixture.file, fixture.offset).unwrap();
    assert_eq!((item.name.as_str(), item.detail.as_str()), ("O0002", "T"));
    let incoming = project.incoming_calls(item.key);
    assert_eq!((incoming[0].item.name.as_str(), incoming[0].places.len()), ("O0001", 2));
    let outgoing = project.outgoing_calls(item.key);
    assert_eq!(
        (outgoing[0].item.name.as_str(), fixture.text(FileId(1), outgoing[0].places[0])),
        ("O0001", "P1".into())
    );
    let links = project.document_links(FileId(0));
    assert_eq!(links.iter().map(|link| link.label.as_str()).collect::<Vec<_>>(), ["O0002", "O0002"]);
}

#[test]
fn a_call_finds_the_program_of_its_folder() {
    let text = "//- a/O1.nc\nO1\nM98 P$02\nM30\n//- b/O2.nc\nO2(B2)\nM99\n//- a/O2.nc\nO2(A2)\nM99\n\
                //- b/O3.nc\nO3\nM98 P2\nM30\n";
    assert_eq!(defined(text), ["2:1:O2"], "that of a, not of b");
    assert_eq!(referred(text), ["2:P2", "2:1:O2!"], "the call in b reaches the other one");
    let far = "//- a/O1.nc\nO1\nM98 P$02\nM30\n//- b/O2.nc\nO2\nM99\n//- c/O2.nc\nO2\nM99\n";
    assert_eq!(defined(far), ["1:1:O2", "2:1:O2"], "either may be in a library");
}
