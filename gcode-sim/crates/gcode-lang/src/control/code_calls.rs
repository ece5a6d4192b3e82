//! Calls by codes: the G, M, T, S and B codes and the addresses that parameters make call programs.

use std::ops::RangeInclusive;

/// Program called by a code, and the kind of call.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CalledProgram {
    /// Program number.
    pub program: u32,
    /// Kind of call.
    pub kind: CodeCallKind,
}

/// Kind of a call by a code.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CodeCallKind {
    /// Macro call like G65: the other words are arguments.
    Macro,
    /// Modal call like G66, or like G66.1 with MGE 6007#3.
    Modal,
    /// Macro call of the program in P, like G65: `M165 P9810`.
    MacroInP,
    /// Subprogram call like M98: the other words act first.
    Subprogram,
}

/// Parameters that hold one code each: the first calls `program`, each next one the next program.
#[derive(Debug)]
pub struct SequentialCodes {
    /// Letter of the codes.
    pub letter: u8,
    /// First parameter.
    pub first: u16,
    /// Last parameter.
    pub last: u16,
    /// Program called by the first parameter's code.
    pub program: u32,
    /// Kind of call.
    pub kind: CodeCallKind,
}

impl SequentialCodes {
    /// Returns the range of a parameter's value; a negative G code makes a modal call.
    pub fn codes(&self) -> RangeInclusive<i64> {
        if self.letter == b'G' { -9999..=9999 } else { 0..=99_999_999 }
    }

    /// Returns the parameter that makes a code of this letter such a call.
    fn parameter(&self, letter: u8, called: CalledProgram) -> Option<u16> {
        let same = (self.kind == CodeCallKind::Subprogram) == (called.kind == CodeCallKind::Subprogram);
        let index = u16::try_from(called.program.checked_sub(self.program)?).ok()?;
        let number = self.first.checked_add(index)?;
        (same && self.letter == letter && number <= self.last).then_some(number)
    }
}

const fn sequential_codes(
    letter: u8,
    first: u16,
    last: u16,
    program: u32,
    kind: CodeCallKind,
) -> SequentialCodes {
    SequentialCodes { letter, first, last, program, kind }
}

/// Parameters with one code each.
pub const SEQUENTIAL_CODES: [SequentialCodes; 3] = [
    sequential_codes(b'G', 6050, 6059, 9010, CodeCallKind::Macro),
    sequential_codes(b'M', 6071, 6079, 9001, CodeCallKind::Subprogram),
    sequential_codes(b'M', 6080, 6089, 9020, CodeCallKind::Macro),
];

/// Three parameters that make a range of codes calls: first code, first program, number of codes.
#[derive(Debug)]
pub struct CodeRange {
    /// Letter of the codes.
    pub letter: u8,
    /// First of the three parameters.
    pub first: u16,
    /// Kind of call.
    pub kind: CodeCallKind,
}

/// Parameters with ranges of codes.
pub const CODE_RANGES: [CodeRange; 3] = [
    CodeRange { letter: b'G', first: 6038, kind: CodeCallKind::Macro },
    CodeRange { letter: b'M', first: 6044, kind: CodeCallKind::Subprogram },
    CodeRange { letter: b'M', first: 6047, kind: CodeCallKind::Macro },
];

/// Subprogram call by an address with any number; a common variable receives the number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AddressCall {
    /// Program number.
    pub program: u32,
    /// Common variable that receives the number.
    pub variable: u32,
}

const T_CALL: AddressCall = AddressCall { program: 9000, variable: 149 };
const S_CALL: AddressCall = AddressCall { program: 9029, variable: 147 };
const B_CALL: AddressCall = AddressCall { program: 9028, variable: 146 };
/// Calls of the addresses whose character codes 6090 and 6091 hold.
const ADDRESS_CALLS: [AddressCall; 2] =
    [AddressCall { program: 9004, variable: 146 }, AddressCall { program: 9005, variable: 147 }];
const FIRST_ADDRESS_PARAMETER: u16 = 6090;

/// Addresses that 6090 and 6091 may hold.
pub const ADDRESSES: &[u8] = b"ABDFHIJKMPQRSTVXYZ";

/// Returns the codes × 10 of a letter that are calls or program ends themselves.
const fn reserved(letter: u8) -> &'static [u32] {
    match letter {
        b'G' => &[650, 660, 661, 670],
        b'M' => &[0, 10, 20, 300, 960, 970, 980, 990, 1980],
        _ => &[],
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct CodeCall {
    /// Parameter of [`SEQUENTIAL_CODES`] that holds the code; `None` for a call without a parameter.
    parameter: Option<u16>,
    letter: u8,
    /// Code × 10, as in the G code table.
    code: u32,
    target: CalledProgram,
}

/// All codes that call programs. `Default` has none.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CodeCalls {
    codes: Vec<CodeCall>,
    /// Values of the parameters of [`CODE_RANGES`].
    ranges: [[i64; 3]; 3],
    addresses: [Option<u8>; 2],
    /// TCS 6001#5: T calls O9000.
    pub t_calls_program: bool,
    /// S calls O9029.
    pub s_calls_program: bool,
    /// B calls O9028 unless it is an axis.
    pub b_calls_program: bool,
    /// MGE 6007#3: a modal call by a G code is G66.1 instead of G66.
    pub modal_is_every_block: bool,
    /// GMP 6008#6: G codes call in programs that other codes called, and vice versa.
    pub allows_nested_calls: bool,
}

impl CodeCalls {
    /// Returns true if no code calls a program.
    pub fn is_empty(&self) -> bool {
        let Self {
            codes,
            ranges,
            addresses,
            t_calls_program: by_t,
            s_calls_program: by_s,
            b_calls_program: by_b,
            modal_is_every_block: _,
            allows_nested_calls: _,
        } = self;
        // Evaluated for every block, so one test instead of nine.
        let [g, m, t] = ranges.map(|[.., count]| count);
        let [one, other] = addresses.map(|address| address.is_some());
        codes.is_empty() & (g | m | t == 0) & !(one | other | by_t | by_s | by_b)
    }

    /// Returns the call that a G or M code × 10 makes.
    ///
    /// A single code takes precedence over a range, and the lowest parameter over others with the same code.
    pub fn find_call(&self, letter: u8, code: u32) -> Option<CalledProgram> {
        let same = self.codes.iter().filter(|call| (call.letter, call.code) == (letter, code));
        let own = same.min_by_key(|call| call.parameter);
        own.map(|call| call.target).or_else(|| self.find_in_ranges(letter, code))
    }

    fn find_in_ranges(&self, letter: u8, code: u32) -> Option<CalledProgram> {
        let number = code.is_multiple_of(10).then_some(i64::from(code / 10))?;
        if reserved(letter).contains(&code) {
            return None;
        }
        CODE_RANGES.iter().zip(&self.ranges).find_map(|(family, [first, program, count])| {
            let index = number - first.abs();
            if family.letter != letter || *first == 0 || !(0..*count).contains(&index) {
                return None;
            }
            let kind = if *first < 0 { CodeCallKind::Modal } else { family.kind };
            Some(CalledProgram { program: u32::try_from(program + index).ok()?, kind })
        })
    }

    /// Returns the call that an address makes with any number.
    pub fn address_call(&self, letter: u8) -> Option<AddressCall> {
        let index = self.addresses.iter().position(|address| *address == Some(letter));
        match letter {
            b'T' if self.t_calls_program => Some(T_CALL),
            b'S' if self.s_calls_program => Some(S_CALL),
            b'B' if self.b_calls_program => Some(B_CALL),
            _ => index.map(|index| ADDRESS_CALLS[index]),
        }
    }

    /// Returns the value of a parameter of this table; `None` for any other number.
    pub fn parameter(&self, number: u16) -> Option<i64> {
        if sequential_codes_of(number).is_some() {
            let own = self.codes.iter().rfind(|call| call.parameter == Some(number));
            return Some(own.map_or(0, |call| {
                let code = i64::from(call.code / 10);
                if call.target.kind == CodeCallKind::Modal { -code } else { code }
            }));
        }
        if let Some((range, index)) = range_parameter(number) {
            return Some(self.ranges[range][index]);
        }
        let index = usize::from(number.checked_sub(FIRST_ADDRESS_PARAMETER)?);
        self.addresses.get(index).map(|address| address.map_or(0, i64::from))
    }

    /// Iterates over the codes of a letter that cannot be made calls.
    pub fn reserved_codes(letter: u8) -> impl Iterator<Item = u32> {
        reserved(letter).iter().map(|code| code / 10)
    }

    /// Iterates over the programs that an address may call: its own and those of 6090 and 6091.
    pub fn address_programs(letter: u8) -> impl Iterator<Item = u32> {
        let own = [(b'T', T_CALL), (b'S', S_CALL), (b'B', B_CALL)]
            .into_iter()
            .filter(move |(own, _)| *own == letter);
        own.map(|(_, call)| call).chain(ADDRESS_CALLS).map(|call| call.program)
    }

    /// Sets a parameter of this table; `None` for any other number and for an invalid value.
    pub fn set_parameter(&mut self, number: u16, value: i64) -> Option<()> {
        if let Some(family) = sequential_codes_of(number) {
            if !family.codes().contains(&value) {
                return None;
            }
            let kind = if value < 0 { CodeCallKind::Modal } else { family.kind };
            let code = u32::try_from(value.unsigned_abs()).ok()?.checked_mul(10)?;
            if value != 0 && reserved(family.letter).contains(&code) {
                return None;
            }
            self.codes.retain(|call| call.parameter != Some(number));
            if value != 0 {
                let target =
                    CalledProgram { program: family.program + u32::from(number - family.first), kind };
                self.codes.push(CodeCall { parameter: Some(number), letter: family.letter, code, target });
            }
            return Some(());
        }
        if let Some((range, index)) = range_parameter(number) {
            let min = if index == 0 && CODE_RANGES[range].letter == b'G' { -9999 } else { 0 };
            let kept = (min..=99_999_999).contains(&value).then_some(value)?;
            self.ranges[range][index] = kept;
            return Some(());
        }
        let index = usize::from(number.checked_sub(FIRST_ADDRESS_PARAMETER)?);
        let address = self.addresses.get_mut(index)?;
        let letter = u8::try_from(value).ok().filter(|letter| *letter == 0 || ADDRESSES.contains(letter))?;
        *address = (letter != 0).then_some(letter);
        Some(())
    }

    /// Sets a call by its code: `G201=9010`, `M50=9020`, `M6=9001`, `T=9000`, `S=9029`, `B=9028`, `V=9004`.
    ///
    /// `G-201=9010` is a modal call. M codes call O9001 to O9009 as subprograms and any other program as a
    /// macro. `None` for an invalid code or program.
    pub(super) fn set_code(&mut self, key: &str, program: u32) -> Option<()> {
        let letter = key.bytes().next()?.to_ascii_uppercase();
        let number = key.get(1..)?.trim();
        if number.is_empty() {
            return self.set_address(letter, program);
        }
        let code: f64 = number.parse().ok()?;
        let tenths = (code.abs() * 10.0).round();
        let kind = match letter {
            b'G' if (10.0..=99_990.0).contains(&tenths) && code < 0.0 => CodeCallKind::Modal,
            b'G' if (10.0..=99_990.0).contains(&tenths) => CodeCallKind::Macro,
            b'M' if (1.0..=99_999_999.0).contains(&code) && code.fract() == 0.0 => match program {
                9001..=9009 => CodeCallKind::Subprogram,
                _ => CodeCallKind::Macro,
            },
            _ => return None,
        };
        self.add(letter, tenths as u32, CalledProgram { program, kind })
    }

    /// Makes a code, `M165`, the macro call of the program in P.
    pub(super) fn set_code_with_p(&mut self, key: &str) -> Option<()> {
        let letter = key.bytes().next()?.to_ascii_uppercase();
        let code: f64 = key.get(1..)?.trim().parse().ok()?;
        let tenths = (code * 10.0).round();
        let is_code = matches!(letter, b'G' | b'M') && (10.0..=99_990.0).contains(&tenths);
        let target = CalledProgram { program: 0, kind: CodeCallKind::MacroInP };
        is_code.then(|| self.add(letter, tenths as u32, target)).flatten()
    }

    fn set_address(&mut self, letter: u8, program: u32) -> Option<()> {
        match (letter, program) {
            (b'T', 9000) => self.t_calls_program = true,
            (b'S', 9029) => self.s_calls_program = true,
            (b'B', 9028) => self.b_calls_program = true,
            _ => {
                let index = ADDRESS_CALLS.iter().position(|call| call.program == program)?;
                self.addresses[index] = ADDRESSES.contains(&letter).then_some(Some(letter))?;
            }
        }
        Some(())
    }

    fn add(&mut self, letter: u8, code: u32, called: CalledProgram) -> Option<()> {
        if reserved(letter).contains(&code) {
            return None;
        }
        self.codes.retain(|call| (call.letter, call.code) != (letter, code));
        let parameter = SEQUENTIAL_CODES.iter().find_map(|family| family.parameter(letter, called));
        self.codes.push(CodeCall { parameter, letter, code, target: called });
        Some(())
    }
}

/// Returns the row with this parameter.
fn sequential_codes_of(number: u16) -> Option<&'static SequentialCodes> {
    SEQUENTIAL_CODES.iter().find(|family| (family.first..=family.last).contains(&number))
}

/// Returns the row of [`CODE_RANGES`] with this parameter, and its index among the three.
fn range_parameter(number: u16) -> Option<(usize, usize)> {
    CODE_RANGES.iter().enumerate().find_map(|(range, family)| {
        let index = usize::from(number.checked_sub(family.first)?);
        (index < 3).then_some((range, index))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn called(program: u32, kind: CodeCallKind) -> Option<CalledProgram> {
        Some(CalledProgram { program, kind })
    }

    #[test]
    fn each_parameter_has_its_program() {
        let mut calls = CodeCalls::default();
        for (parameter, code) in [(6050, 201), (6059, -81), (6071, 6), (6079, 60), (6080, 50), (6089, 59)] {
            calls.set_parameter(parameter, code).unwrap();
            assert_eq!(calls.parameter(parameter), Some(code), "{parameter}");
        }
        assert_eq!(calls.find_call(b'G', 2010), called(9010, CodeCallKind::Macro));
        assert_eq!(calls.find_call(b'G', 810), called(9019, CodeCallKind::Modal));
        assert_eq!(calls.find_call(b'M', 60), called(9001, CodeCallKind::Subprogram));
        assert_eq!(calls.find_call(b'M', 600), called(9009, CodeCallKind::Subprogram));
        assert_eq!(calls.find_call(b'M', 500), called(9020, CodeCallKind::Macro));
        assert_eq!(calls.find_call(b'M', 590), called(9029, CodeCallKind::Macro));
        assert_eq!((calls.find_call(b'G', 500), calls.parameter(6060)), (None, None));
        calls.set_parameter(6050, 0).unwrap();
        assert_eq!(calls.find_call(b'G', 2010), None, "0 calls nothing");
    }

    #[test]
    fn each_parameter_keeps_its_value_beside_one_with_the_same_code() {
        let mut calls = CodeCalls::default();
        calls.set_parameter(6050, 201).unwrap();
        calls.set_parameter(6051, 201).unwrap();
        assert_eq!((calls.parameter(6050), calls.parameter(6051)), (Some(201), Some(201)));
        assert_eq!(calls.find_call(b'G', 2010), called(9010, CodeCallKind::Macro));
        assert_eq!(calls.set_parameter(6050, 65), None, "G65 is a call itself");
        assert_eq!(calls.parameter(6050), Some(201), "what is refused changes nothing");
        calls.set_parameter(6050, 0).unwrap();
        assert_eq!(calls.find_call(b'G', 2010), called(9011, CodeCallKind::Macro));
    }

    #[test]
    fn a_range_excludes_ends_and_calls() {
        let mut calls = CodeCalls::default();
        for (parameter, value) in [(6044, 1), (6045, 3000), (6046, 200), (6038, 60), (6039, 4000), (6040, 10)]
        {
            calls.set_parameter(parameter, value).unwrap();
        }
        for code in [1, 2, 30, 98, 99, 198] {
            assert_eq!(calls.find_call(b'M', code * 10), None, "M{code}");
        }
        assert_eq!(calls.find_call(b'M', 40), called(3003, CodeCallKind::Subprogram));
        assert_eq!((calls.find_call(b'G', 650), calls.find_call(b'G', 660)), (None, None));
        assert_eq!(calls.find_call(b'G', 640), called(4004, CodeCallKind::Macro));
        calls.set_parameter(6044, 0).unwrap();
        assert_eq!(calls.find_call(b'M', 40), None, "a range from 0 on is none");
    }

    #[test]
    fn a_single_code_precedes_a_range() {
        let mut calls = CodeCalls::default();
        for (parameter, value) in [(6038, -900), (6039, 3000), (6040, 10), (6047, 200), (6048, 50), (6049, 2)]
        {
            calls.set_parameter(parameter, value).unwrap();
        }
        calls.set_code("G905", 9010).unwrap();
        assert_eq!(calls.find_call(b'G', 9000), called(3000, CodeCallKind::Modal));
        assert_eq!(calls.find_call(b'G', 9090), called(3009, CodeCallKind::Modal));
        assert_eq!(calls.find_call(b'G', 9050), called(9010, CodeCallKind::Macro));
        assert_eq!((calls.find_call(b'G', 9100), calls.find_call(b'G', 8990)), (None, None));
        assert_eq!(calls.find_call(b'M', 2010), called(51, CodeCallKind::Macro));
        assert_eq!(calls.find_call(b'M', 2020), None);
    }

    #[test]
    fn ends_and_calls_cannot_call_programs() {
        let mut calls = CodeCalls::default();
        for key in ["G65", "M99", "M30", "M0", "X1", "M1.5", "M-5"] {
            assert_eq!(calls.set_code(key, 9020), None, "{key}");
        }
        assert_eq!(calls.set_parameter(6080, 98), None);
        assert_eq!(calls.set_parameter(6090, i64::from(b'N')), None);
        assert!(calls.is_empty());
    }
}
