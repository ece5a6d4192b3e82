//! Times and peak memory of commands on files of nearly a million milled lines, with the size of the text beside them.
//!
//! `cargo bench -p gcode-sim --bench large`. The programs are written to a temporary folder.
#![allow(clippy::print_stdout, reason = "a bench prints its table")]
#![allow(clippy::disallowed_methods, reason = "a bench writes the programs that it runs")]
use std::fmt::Write as _;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

const LINES: u32 = 990_000;

/// Time between two readings of a command's peak memory.
const INTERVAL: Duration = Duration::from_millis(2);

const HEAD: &str =
    "O1\nG21 G17 G90 G94 G40 G49 G80 G54\nT1 M6\nS2000 M3\nG43 H1 Z50.\nG0 X0. Y0.\nG1 Z-1. F500.\n";

const MACHINE: &str =
    "[head]\nkind = \"fixed\"\ndirection = [0, 0, 1]\n[[tool]]\nnumber = 1\nlength = 100.0\ndiameter = 1.0\n";

/// A hole beside all of the moves.
const REFERENCE: &str = "id,x,y,z,i,j,k,depth,diameter\n1,500.0,500.0,0,0,0,1,8,1\n";

fn main() {
    let folder = tempfile::tempdir().expect("a temporary folder can be made");
    let write = |name: &str, text: &str| {
        std::fs::write(folder.path().join(name), text).expect("the folder takes files");
    };
    write("m.toml", MACHINE);
    write("r.csv", REFERENCE);
    for (name, text) in
        [("lines", lines()), ("lines and half circles", half_circles()), ("strokes", strokes())]
    {
        println!("{name}, {LINES} blocks, {} MB of text:", text.len() / 1_000_000);
        write("old.nc", &text);
        write("point.nc", &text.replacen("X50.", "X50.1", 1));
        write("feed.nc", &text.replacen("F500.", "F600.", 1));
        write("block.nc", &text.replacen("F500.\n", "F500.\nX7. Y7.\n", 1));
        for command in [
            "check old.nc",
            "holes old.nc --machine m.toml",
            "verify old.nc --reference r.csv --machine m.toml",
            "diff old.nc point.nc --machine m.toml",
            "diff old.nc feed.nc --machine m.toml",
            "diff old.nc block.nc --machine m.toml",
        ] {
            measured(folder.path(), command, text.len());
        }
    }
    for (count, step) in [(7, 50), (700, 1)] {
        let feeds = |feed: u32| surface(|index| format!(" F{}.", feed + index % count * step));
        let [old, new] = [500, 501].map(feeds);
        write("old.nc", &old);
        write("new.nc", &new);
        println!("lines with one of {count} feeds in each, all changed:");
        measured(folder.path(), "diff old.nc new.nc --machine m.toml", old.len());
    }
    let [old, new] = [0.0, 0.01].map(numbered);
    write("old.nc", &old);
    write("new.nc", &new);
    println!("numbered lines, all moved:");
    measured(folder.path(), "diff old.nc new.nc --machine m.toml", old.len());
}

/// Prints time and peak memory of a command on texts of this length.
fn measured(folder: &Path, command: &str, length: usize) {
    let (time, peak) = measure(folder, command);
    let words: Vec<&str> =
        command.split(' ').filter(|word| !word.ends_with("toml") && !word.starts_with("--")).collect();
    let ratio = peak as f64 * 1e6 / length as f64;
    println!(
        "  {:20} {:8.3} s  {peak:6} MB  {ratio:4.1} times the text",
        words.join(" "),
        time.as_secs_f64()
    );
}

/// Returns a surface of lines 0.1 mm apart.
fn lines() -> String {
    surface(|_| String::new())
}

/// Returns the same surface with words behind each line.
fn surface(words: impl Fn(u32) -> String) -> String {
    program((0..LINES).map(|index| format!("{}{}", point(index, 0.0), words(index))))
}

/// Returns the same surface in numbered lines, shifted along X.
fn numbered(shift: f64) -> String {
    program((0..LINES).map(|index| format!("N{} G1 {}", index + 1, point(index, shift))))
}

/// Returns the words of a point of the surface.
fn point(index: u32, shift: f64) -> String {
    let (row, column) = (index / 1000, index % 1000);
    let x = 0.1 * f64::from(if row % 2 == 0 { column } else { 999 - column }) + shift;
    let y = 0.1 * f64::from(row);
    format!("X{x:.3} Y{y:.3} Z{:.3}", -1.0 - 0.5 * (0.3 * x).sin() * (0.2 * y).cos())
}

fn half_circles() -> String {
    program((0..LINES / 2).map(|index| {
        let (x, y) = (0.2 * f64::from(index % 1000), 0.5 * f64::from(index / 1000));
        format!("G1 X{x:.3} Y{y:.3}\nG2 X{:.3} I0.05 J0.", x + 0.1)
    }))
}

/// Returns strokes of four lines each, with a plunge before and a retract after them.
fn strokes() -> String {
    program((0..LINES / 5).map(|index| {
        let (x, y) = (2.0 * f64::from(index % 500), 2.0 * f64::from(index / 500));
        format!("G0 Z2.\nX{x:.3} Y{y:.3}\nG1 Z-1.\nX{:.3}\nY{:.3}", x + 0.8, y + 0.8)
    }))
}

fn program(blocks: impl Iterator<Item = String>) -> String {
    let mut text = HEAD.to_owned();
    for block in blocks {
        writeln!(text, "{block}").expect("a string can be written to");
    }
    text + "G0 Z50.\nM30\n"
}

/// Returns the time of a command and its peak memory in MB; 0 where the system does not tell it.
fn measure(folder: &Path, command: &str) -> (Duration, u64) {
    let start = Instant::now();
    let mut child = Command::new(env!("CARGO_BIN_EXE_gcode-sim"))
        .current_dir(folder)
        .args(command.split(' '))
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .expect("the program can be started");
    let status = format!("/proc/{}/status", child.id());
    let mut peak = 0;
    let end = loop {
        if let Some(end) = child.try_wait().expect("the program can be waited for") {
            break end;
        }
        let text = std::fs::read_to_string(&status).unwrap_or_default();
        let line = text.lines().find_map(|line| line.strip_prefix("VmHWM:"));
        let kilobytes = line.and_then(|line| line.trim().trim_end_matches(" kB").parse::<u64>().ok());
        peak = peak.max(kilobytes.unwrap_or(0) / 1000);
        std::thread::sleep(INTERVAL);
    };
    assert!(end.code().is_some_and(|code| code < 2), "{command} ends with {end}");
    (start.elapsed(), peak)
}
