//! Throughput of the search: calls of O8101 at points spread over its arguments, on two cores.
#![expect(clippy::unwrap_used, clippy::disallowed_methods, reason = "a benchmark reads files and may panic")]

use std::num::NonZeroUsize;
use std::time::Duration;

use divan::Bencher;
use divan::counter::ItemsCount;

use gcode_control::Control;
use gcode_lang::control::Settings;
use gcode_lang::program::{Memory, NoLibrary};
use gcode_prove::{Ask, Setup, Watch, sample};

fn main() {
    divan::main();
}

/// The macros, and a block that calls one of them.
struct Call(&'static str);

impl Setup for Call {
    type Library = NoLibrary;

    fn control(&self, _: &[(String, String)]) -> Result<Control, String> {
        let mut memory = Memory::default();
        memory.load("call", format!("O1\n{}\nM30\n", self.0).into_bytes());
        for name in ["O8101_pin_hole.nc", "O8102_head_angle.nc"] {
            let path = format!("{}/../../../macros/{name}", env!("CARGO_MANIFEST_DIR"));
            memory.load(name, std::fs::read(path).unwrap());
        }
        Ok(Control::new(memory, Settings::default()))
    }

    fn library(&self) -> NoLibrary {
        NoLibrary
    }
}

#[divan::bench]
fn calls_of_a_pin_hole(bencher: Bencher<'_, '_>) {
    const CALLS: u32 = 100_000;
    let call = Call("G65 P8101 A#101 B#102 C5. D20. E500. F100. H0. Q0. R#103 T6. U1. V50. W#104");
    let ranges = ["#101=1000..2000", "#102=300..1200", "#103=0..900", "#104=-180..180"];
    let ask = Ask {
        ranges: ranges.map(str::to_owned).to_vec(),
        claims: vec!["no-alarm".to_owned()],
        threads: NonZeroUsize::new(2).unwrap(),
        ..Ask::default()
    };
    let watch = Watch::new(&|| Duration::ZERO, Duration::from_secs(3600));
    bencher.counter(ItemsCount::new(CALLS)).bench(|| sample(&call, &ask, CALLS, &watch).unwrap());
}
