//! What differences have in common: the call whose arguments are others, or the block that makes them.
use super::record::BlockLocation;

/// Before and now.
pub(super) type Cause = (BlockLocation, BlockLocation);

/// The outermost call that is written otherwise; else the blocks themselves.
pub(super) fn cause(old: &BlockLocation, new: &BlockLocation) -> Cause {
    let calls = old.calls.iter().rev().zip(new.calls.iter().rev());
    let mut calls = calls.take_while(|(was, is)| was.program == is.program);
    match calls.find(|(was, is)| words(&was.block) != words(&is.block)) {
        Some((was, is)) => (was.clone(), is.clone()),
        None => (old.clone(), new.clone()),
    }
}

/// Blocks that say the same, whatever they call.
pub(super) fn is_same_block(old: &BlockLocation, new: &BlockLocation) -> bool {
    words(&old.block) == words(&new.block)
}

/// A block without sequence number, remarks and spaces.
pub(super) fn words(block: &str) -> String {
    let mut depth = 0;
    let code = block.chars().filter(|c| {
        let is_remark = depth > 0 || *c == '(';
        depth += i32::from(*c == '(') - i32::from(*c == ')');
        !is_remark && !c.is_whitespace()
    });
    let code: String = code.collect();
    let number = code.strip_prefix('N').map(|rest| rest.trim_start_matches(|c: char| c.is_ascii_digit()));
    number.unwrap_or(&code).to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(line: u32, block: &str, calls: &[(u32, &str)]) -> BlockLocation {
        let calls = calls.iter().map(|(line, block)| at(*line, block, &[])).collect();
        BlockLocation { program: "O1".to_owned(), line, block: block.to_owned(), calls }
    }

    #[test]
    fn a_call_written_otherwise_is_the_cause_of_all_in_it() {
        let old = at(9, "G1 X#1", &[(5, "G65 P2 A1."), (3, "N10 G65 P1 A1. (FIRST)")]);
        let new = at(9, "G1 X#1", &[(5, "G65 P2 A1."), (4, "N20 G65P1 A1.01")]);
        assert_eq!(cause(&old, &new), (old.calls[1].clone(), new.calls[1].clone()));
        // Another number, another remark: the same call.
        let same = at(9, "G1 X#2", &[(5, "G65 P2 A1."), (4, "N20 G65P1 A1.")]);
        assert_eq!(cause(&old, &same), (old.clone(), same.clone()));
    }
}
