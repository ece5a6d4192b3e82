//! The examples' pictures are what the programs draw now.

use gcode_tests::programs::run_line;
use gcode_tests::workspace;

/// A folder of examples, a picture in it, and the command that draws it there as `{}`.
const PICTURES: &[(&str, &str, &str)] = &[
    ("burr", "O8400.png", "gcode-sim render O8400.nc --reference job.toml --machine machine.toml -o {}"),
    (
        "burr",
        "O8400-tip.png",
        "gcode-sim render O8400.nc --reference job.toml --machine machine.toml --view tip -o {}",
    ),
    (
        "burr",
        "O8400-helix.png",
        "gcode-sim render O8400.nc --reference job.toml --machine machine.toml --view helix -o {}",
    ),
    (
        "honeycomb",
        "O8300.png",
        "gcode-sim render O8300.nc --reference job.toml --machine machine.toml --view development -o {}",
    ),
    (
        "honeycomb-tube",
        "O8300.png",
        "gcode-sim render O8300.nc --reference job.toml --machine machine.toml --view development -o {}",
    ),
    (
        "melon-mould",
        "O8100.png",
        "gcode-sim render O8100.nc --reference job.toml --machine machine.toml -o {}",
    ),
    (
        "pocket",
        "O0050.png",
        "gcode-sim render O0050.nc --machine machine.toml --view top,front,right,iso --size 1200x900 -o {}",
    ),
    (
        "published-honeycomb",
        "O2013.png",
        "gcode-sim verify O2013.nc --reference job.toml --machine machine.toml --picture {}",
    ),
];

/// Letters may be a step lighter or darker; `cargo xtask bless` writes them anew.
#[test]
fn the_examples_pictures_are_drawn_as_stored() {
    let place = tempfile::tempdir().unwrap();
    for (folder, name, line) in PICTURES {
        let folder = workspace().join("examples").join(folder);
        let drawn = place.path().join(name);
        run_line(&line.replace("{}", &drawn.display().to_string()), &folder);
        let kept = folder.join(name);
        if std::env::var("BLESS").is_ok() {
            std::fs::copy(&drawn, &kept).unwrap();
        }
        let (kept, drawn) = (std::fs::read(&kept).unwrap(), std::fs::read(&drawn).unwrap());
        let difference = gcode_draw::compare(&kept, &drawn, 1).unwrap();
        assert!(difference.is_none(), "{name} is drawn differently; run cargo xtask bless");
    }
}

#[test]
fn every_picture_of_the_examples_is_compared() {
    let mut found: Vec<String> = Vec::new();
    for folder in std::fs::read_dir(workspace().join("examples")).unwrap() {
        let folder = folder.unwrap();
        let Ok(files) = std::fs::read_dir(folder.path()) else { continue };
        let names = files.map(|file| file.unwrap().file_name().into_string().unwrap());
        let shown = folder.file_name().into_string().unwrap();
        found.extend(names.filter(|name| name.ends_with(".png")).map(|name| format!("{shown}/{name}")));
    }
    found.sort();
    let mut held: Vec<String> = PICTURES.iter().map(|(folder, name, _)| format!("{folder}/{name}")).collect();
    held.sort();
    assert_eq!(found, held);
}
