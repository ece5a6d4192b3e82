//! Jobs of burrs, chosen and random.
use gcode_tests::bench::Bench;
use proptest::prelude::*;

/// The keys of a job that differ from test to test.
#[derive(Clone, Debug)]
pub(super) struct Wish {
    pub(super) control: (&'static str, &'static str),
    pub(super) diameter: f64,
    /// Of the cylinder.
    pub(super) cylinder: f64,
    pub(super) flutes: u32,
    pub(super) helix: f64,
    pub(super) law: &'static str,
    pub(super) tip_angle: f64,
    pub(super) chord_error: f64,
    pub(super) offset: [f64; 2],
    /// Large and small radius, in parts of the burr's.
    pub(super) profile: Option<(f64, f64)>,
    pub(super) signs: [i8; 5],
    pub(super) form: &'static str,
}

impl Wish {
    pub(super) fn text(&self) -> String {
        let radius = self.diameter / 2.0;
        let (nose, profile) = match self.profile {
            None => (radius, String::new()),
            Some((large, small)) => {
                let (large, small) = (large * radius, small * radius);
                let (hypotenuse, leg) = (large - small, large - radius);
                let nose = (hypotenuse * hypotenuse - leg * leg).sqrt() + small;
                (nose, format!("profile = {{ large = {large:?}, small = {small:?} }}\n"))
            }
        };
        let [x, y, a, b, c] = self.signs;
        format!(
            "family = \"burr\"\n[control]\ndialect = \"{}\"\nincrement = \"{}\"\n[burr]\ndiameter = {:?}\n\
             length = {:?}\nflutes = {}\nhelix = {:?}\nlaw = \"{}\"\ntip_angle = {:?}\nchord_error = {:?}\n\
             tooth_depth = 0.3\n[machine]\nc_offset = {:?}\n{profile}\
             signs = {{ X = {x}, Y = {y}, A = {a}, B = {b}, C = {c} }}\n[program]\nform = \"{}\"\nspeed = 200.0\n",
            self.control.0,
            self.control.1,
            self.diameter,
            self.cylinder + nose,
            self.flutes,
            self.helix,
            self.law,
            self.tip_angle,
            self.chord_error,
            self.offset,
            self.form
        )
    }

    pub(super) fn bench(&self) -> Bench {
        Bench::of(&self.text())
    }
}

pub(super) fn example() -> Wish {
    Wish {
        control: ("fanuc-31i", "IS-B"),
        diameter: 12.0,
        cylinder: 19.0,
        flutes: 16,
        helix: 20.0,
        law: "constant-helix",
        tip_angle: 5.0,
        chord_error: 0.002,
        offset: [40.0, -15.0],
        profile: None,
        signs: [1; 5],
        form: "loop",
    }
}

pub(super) fn wishes() -> impl Strategy<Value = Wish> {
    let control = (
        prop::sample::select(vec!["fanuc-31i", "fanuc-0i-f", "haas-ngc"]),
        prop::sample::select(vec!["IS-B", "IS-C"]),
    );
    let burr = (4.0..20.0f64, prop_oneof![Just(0.0), 0.5..20.0f64], 1u32..7);
    let flute = (
        prop_oneof![5.0..40.0f64, -40.0..-5.0f64],
        prop::sample::select(vec!["constant-helix", "published"]),
        8.0..70.0f64,
        0.002..0.01f64,
    );
    let grinder = (
        prop::array::uniform2(-80.0..80.0f64),
        prop::array::uniform5(prop::sample::select(vec![1i8, -1])),
        prop::option::of((1.2..3.0f64, 0.3..0.9f64)),
        prop::sample::select(vec!["loop", "moves"]),
    );
    (control, burr, flute, grinder).prop_map(|(control, burr, flute, (offset, signs, profile, form))| {
        let (diameter, cylinder, flutes) = burr;
        let (helix, law, tip_angle, chord_error) = flute;
        let form = if control.0 == "haas-ngc" { "moves" } else { form };
        let flute = Wish { flutes, helix, law, tip_angle, chord_error, ..example() };
        Wish { control, diameter, cylinder, offset, signs, profile, form, ..flute }
    })
}
