//! Arguments to the command line, its exit status to the shell.
fn main() {}
