//! Times of whole runs, as ratios: a long file of single moves and a macro loop, compared with the same arithmetic in
//! Rust and, if installed, with LinuxCNC's stand-alone interpreter, and in instructions counted by valgrind.
//!
//! `cargo bench -p gcode-sim --bench speed`. The programs are written to a temporary folder.
#![allow(clippy::print_stdout, reason = "a bench prints its table")]
#![allow(clippy::disallowed_methods, reason = "a bench writes the programs that it runs")]
use std::fmt::Write as _;
use std::hint::black_box;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// Number of blocks or iterations that are timed.
const MANY: u32 = 1_000_000;
/// The two sizes whose difference is counted in instructions: the memory of the lowered blocks is allocated before.
const COUNTED: [u32; 2] = [10_000, 30_000];
/// Sizes whose times are compared with that of the first.
const GROWING: [u32; 4] = [100_000, 200_000, 400_000, 800_000];
/// Number of runs, of which the shortest counts: other processes only add to the time.
const RUNS: usize = 3;

/// One program in two dialects.
struct Workload {
    name: &'static str,
    ours: fn(u32) -> String,
    linuxcnc: fn(u32) -> String,
    native: Option<fn(u32) -> f64>,
}

const WORKLOADS: [Workload; 2] = [
    Workload {
        name: "flat file",
        ours: |lines| format!("O1\n{}", flat(lines)),
        linuxcnc: |lines| format!("%\n{}%\n", flat(lines)),
        native: None,
    },
    Workload { name: "macro loop", ours: macro_loop, linuxcnc: o_word_loop, native: Some(native_loop) },
];

fn main() {
    let folder = tempfile::tempdir().expect("a temporary folder can be made");
    for workload in &WORKLOADS {
        println!("{}, {MANY} blocks or iterations:", workload.name);
        let ours = write(folder.path(), "ours.nc", &(workload.ours)(MANY));
        let took = time(|| run(&mut ours_on(&ours)));
        println!("  gcode-sim run            {:8.3} s", took.as_secs_f64());
        if let Some(native) = workload.native {
            let once = time(|| _ = black_box(native(black_box(MANY))));
            println!(
                "  the same in Rust         {:8.3} s  {:6.1} times",
                once.as_secs_f64(),
                ratio(took, once)
            );
        }
        if is_installed("rs274") {
            let theirs = write(folder.path(), "theirs.ngc", &(workload.linuxcnc)(MANY));
            let other = time(|| run(&mut linuxcnc_on(folder.path(), &theirs)));
            println!(
                "  LinuxCNC's rs274         {:8.3} s  {:6.1} times ours",
                other.as_secs_f64(),
                ratio(other, took)
            );
        } else {
            println!("  LinuxCNC's rs274         is not installed (Debian's linuxcnc-uspace has it)");
        }
        grow(workload, folder.path());
        if is_installed("valgrind") {
            let [few, more] = COUNTED.map(|size| {
                let program = write(folder.path(), "counted.nc", &(workload.ours)(size));
                instructions(&program, folder.path())
            });
            let each = (more - few) / u64::from(COUNTED[1] - COUNTED[0]);
            println!("  instructions for each    {each:8}");
        } else {
            println!("  instructions for each    not counted: valgrind is not installed");
        }
    }
}

/// Prints the times of growing programs as multiples of the first, which should be the multiples of the sizes.
fn grow(workload: &Workload, folder: &Path) {
    let took = GROWING.map(|size| {
        let program = write(folder, "growing.nc", &(workload.ours)(size));
        time(|| run(&mut ours_on(&program)))
    });
    for (size, took_here) in GROWING.iter().zip(took).skip(1) {
        let times = f64::from(*size) / f64::from(GROWING[0]);
        println!(
            "  {size:7} blocks           {:6.2} times {} for {times} times as many",
            ratio(took_here, took[0]),
            GROWING[0]
        );
    }
}

/// Returns moves along a circle, each with a sequence number.
fn flat(lines: u32) -> String {
    let mut text = "G21 G17 G40 G49 G80 G90 G94 F500.\n".to_owned();
    for line in 0..lines {
        let (sine, cosine) = (f64::from(line) * 0.01).sin_cos();
        let depth = f64::from(line % 1000) * 0.001;
        writeln!(text, "N10 G1 X{:.3} Y{:.3} Z-{depth:.3}", 100.0 * cosine, 100.0 * sine)
            .expect("a string can be written to");
    }
    text + "M30\n"
}

fn macro_loop(iterations: u32) -> String {
    format!(
        "O1\nG21 G17 G40 G49 G80 G90 G94 F500.\n#1=0\nWHILE[#1LT{iterations}]DO1\n#2=#1*0.001\n#3=SQRT[#2*#2+1.]\n\
         #4=ATAN[#2]/[#3]\n#5=#3*COS[#4]\n#6=#5+#2\n#1=#1+1\nG1 X#5 Y#6 Z#4\nEND1\nM30\n"
    )
}

fn o_word_loop(iterations: u32) -> String {
    format!(
        "%\nG21 G17 G40 G49 G80 G90 G94 F500.\n#1=0\no1 while [#1 LT {iterations}]\n#2=[#1*0.001]\n#3=SQRT[#2*#2+1.]\n\
         #4=ATAN[#2]/[#3]\n#5=[#3*COS[#4]]\n#6=[#5+#2]\n#1=[#1+1]\nG1 X#5 Y#6 Z#4\no1 endwhile\nM30\n%\n"
    )
}

/// Computes the loop with the same functions, rounded to the same grid.
fn native_loop(iterations: u32) -> f64 {
    let mut length = 0.0;
    let mut from = [0.0_f64; 3];
    for iteration in 0..iterations {
        let x = f64::from(iteration) * 0.001;
        let root = (x * x + 1.0).sqrt();
        let angle = libm::atan2(x, root).to_degrees();
        let first = root * libm::cos(angle.to_radians());
        let to = [first, first + x, angle].map(|value| (value * 1000.0).round() / 1000.0);
        let square: f64 = (0..3).map(|axis| (to[axis] - from[axis]) * (to[axis] - from[axis])).sum();
        length += square.sqrt();
        from = to;
    }
    length
}

fn write(folder: &Path, name: &str, text: &str) -> PathBuf {
    let path = folder.join(name);
    std::fs::write(&path, text).expect("the folder takes files");
    path
}

fn ours_on(program: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_gcode-sim"));
    command.arg("run").arg(program).args(["--max-blocks", "1000000000"]);
    command
}

/// Returns the command; LinuxCNC keeps its variables in a file of its working folder.
fn linuxcnc_on(folder: &Path, program: &Path) -> Command {
    let mut command = Command::new("rs274");
    command.current_dir(folder).arg("-g").arg(program).arg("/dev/null");
    command
}

fn run(command: &mut Command) {
    let status =
        command.stdout(Stdio::null()).stderr(Stdio::null()).status().expect("the program can be started");
    assert!(status.success(), "{command:?} ends with {status}");
}

fn time(work: impl Fn()) -> Duration {
    let once = || {
        let start = Instant::now();
        work();
        start.elapsed()
    };
    (0..RUNS).map(|_| once()).min().unwrap_or_default()
}

fn ratio(a: Duration, b: Duration) -> f64 {
    a.as_secs_f64() / b.as_secs_f64()
}

fn is_installed(program: &str) -> bool {
    Command::new(program).arg("--version").stdout(Stdio::null()).stderr(Stdio::null()).status().is_ok()
}

/// Returns the number of instructions of a whole run of gcode-sim.
fn instructions(program: &Path, folder: &Path) -> u64 {
    let mut command = Command::new("valgrind");
    let file = folder.join("callgrind.out");
    command.args(["--tool=callgrind", &format!("--callgrind-out-file={}", file.display())]);
    let ours = ours_on(program);
    command.arg(ours.get_program()).args(ours.get_args());
    run(&mut command);
    let profile = std::fs::read_to_string(&file).expect("valgrind has written its profile");
    let total =
        profile.lines().find_map(|line| line.strip_prefix("summary: ").or(line.strip_prefix("totals: ")));
    total.and_then(|total| total.trim().parse().ok()).expect("the profile has a sum")
}
