//! Signature of a macro call: the arguments that the called program takes.
use crate::entry::EntryKind;
use crate::file_index::Call;
use crate::head_comment::title;
use crate::lexer::LexemeKind;
use crate::project::Project;
use crate::text::{FileId, TextRange, line_range};

/// Signature of a called macro.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SignatureHelp {
    /// `G65 P8101 A B C`.
    pub label: String,
    /// Title of the macro.
    pub documentation: String,
    /// Arguments in the order of the label.
    pub parameters: Vec<SignatureParameter>,
    /// Index of the argument at the cursor.
    pub active: Option<usize>,
}

/// Argument of a signature.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SignatureParameter {
    /// Place in the label, bytes.
    pub label: TextRange,
    /// Letter.
    pub letter: char,
    /// Local that it sets.
    pub local: u32,
    /// Meaning.
    pub documentation: String,
}

impl Project {
    /// Returns the signature of the macro call at an offset: in its block, behind the code.
    pub fn signature_help(&self, file: FileId, offset: u32) -> Option<SignatureHelp> {
        let call = self.macro_call_at(file, offset)?;
        let called = self.called_program(file, &call.record.target)?;
        let index = self.file(file)?;
        let code = String::from_utf8_lossy(call.code.of(index.text())).into_owned();
        let target =
            call.target_range().map(|range| String::from_utf8_lossy(range.of(index.text())).into_owned());
        let mut label = code;
        label.extend(target.map(|target| format!(" {target}")));
        let mut parameters = Vec::new();
        for parameter in self.parameters_of(called) {
            let start = label.len() as u32 + 1;
            label.push_str(&format!(" {}", parameter.letter));
            let mut meaning = format!("#{} {}", parameter.local, parameter.text).trim_end().to_owned();
            if parameter.is_optional {
                meaning.push_str(" (may be left out)");
            }
            parameters.push(SignatureParameter {
                label: TextRange::new(start, start + 1),
                letter: parameter.letter,
                local: parameter.local,
                documentation: meaning,
            });
        }
        // The last letter before the cursor.
        let line = line_range(index.text(), offset);
        let lexemes = self.line_lexemes(file, line);
        let letters = lexemes
            .iter()
            .filter(|lexeme| lexeme.range.start < offset && lexeme.range.start > call.code.start);
        let last = letters.filter_map(|lexeme| match lexeme.kind {
            LexemeKind::Letter(letter) => Some((lexeme.range.start, char::from(letter))),
            _ => None,
        });
        let last = last.max_by_key(|(start, _)| *start).map(|(_, letter)| letter);
        let active = parameters.iter().position(|parameter| Some(parameter.letter) == last);
        let documentation =
            self.file(called.file).and_then(|index| title(index, called.program)).unwrap_or_default();
        Some(SignatureHelp { label, documentation, parameters, active })
    }

    /// Returns the macro call of the block of an offset, if the offset is behind its code.
    pub(crate) fn macro_call_at(&self, file: FileId, offset: u32) -> Option<Call<'_>> {
        let index = self.file(file)?;
        let line = line_range(index.text(), offset);
        let mut entries = index.entries(TextRange::new(line.start, line.end + 1));
        let call = entries.find(|entry| entry.kind == EntryKind::Call)?.call()?;
        (call.record.has_own_locals && call.code.end <= offset).then_some(call)
    }
}

#[cfg(test)]
mod tests {
    use crate::testing::fixture;

    const MACRO: &str = "O9(HOLE)\n(R #18 RADIUS)\n(D #7 DEPTH)\nIF[#18 EQ #0]THEN #3000=1(R MISSING)\nIF[#6 EQ #0]THEN #6=1.\n#30=#18*#7*#6\n#20=1.\nX#20\nM99\n";

    #[test]
    fn a_macro_shows_its_arguments() {
        let fixture = fixture(&format!("O1\nG65 P9 D1. R$0\nM30\n{MACRO}"));
        let help = fixture.project.signature_help(fixture.file, fixture.offset).unwrap();
        assert_eq!((help.label.as_str(), help.documentation.as_str()), ("G65 P9 D K R", "HOLE"));
        let shown: Vec<_> = help.parameters.iter().map(|p| (p.letter, p.documentation.as_str())).collect();
        assert_eq!(shown, [('D', "#7 DEPTH"), ('K', "#6 (may be left out)"), ('R', "#18 RADIUS")]);
        assert_eq!(help.active, Some(2));
        assert_eq!(&help.label[help.parameters[1].label.start as usize..][..1], "K");
    }

    #[test]
    fn other_blocks_have_none() {
        for text in ["O1\nM98 P9 $0\n", "O1\nG0 X$01.\n", "O1\nG65 P77 A$0\n", "O1\n$0G65 P9\n"] {
            let fixture = fixture(&format!("{text}M30\n{MACRO}"));
            assert_eq!(fixture.project.signature_help(fixture.file, fixture.offset), None, "{text}");
        }
    }
}
