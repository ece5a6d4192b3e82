//! Errors of pattern jobs name the key, the line and what is allowed.
use crate::job::Job;

const JOB: &str = r#"family = "pattern"
[control]
dialect = "fanuc-31i"
increment = "IS-B"
[tolerance]
position = 0.1
[[tool]]
number = 1
operation = "drill"
diameter = 8.5
speed = 1500
feed = 200.0
[[pattern]]
id = "A"
circle = { diameter = 80.0, holes = 6 }
make = [{ tool = 1, depth = 20.0 }]
"#;

/// The message of the job with one replacement, or "no error".
fn message(from: &str, to: &str) -> String {
    let job = JOB.replace(from, to);
    assert_ne!(job, JOB, "'{from}' is not in the job");
    Job::parse(&job).map_or_else(|error| error.to_string(), |_| "no error".to_owned())
}

#[test]
fn a_wrong_key_is_named_with_its_line() {
    for (from, to, expected) in [
        ("holes = 6", "holes = 0", "line 15: key 'pattern.circle.holes' is 0: 1 to 9999"),
        ("circle = {", "circles = {", "line 15: key 'pattern.circles' is unknown (did you mean 'circle'?)"),
        ("holes = 6", "hole = 6", "line 15: key 'pattern.circle.hole' is unknown (did you mean 'holes'?)"),
        (
            "id = \"A\"\n",
            "id = \"A\"\npoints = [[1.0, 2.0]]\n",
            "line 15: key 'pattern.points' excludes 'circle'",
        ),
        ("make = [", "skip = [7]\nmake = [", "line 16: key 'pattern.skip' is 7: one of the holes 1 to 6"),
        ("make = [", "skip = [2, 2]\nmake = [", "line 16: key 'pattern.skip' is 2: it is named twice"),
        (
            "make = [",
            "skip = [1, 2, 3, 4, 5, 6]\nmake = [",
            "line 16: key 'pattern.skip' is 6: left out of 6",
        ),
        ("\"drill\"", "\"spot-drill\"", "line 16: key 'pattern.make' has spot drills alone"),
        ("tool = 1", "tool = 2", "line 16: key 'pattern.make.tool' names tool 2, which is not in [[tool]]"),
        ("\"drill\"", "\"peck\"", "line 9: key 'tool.peck' is missing: operation = \"peck\" needs it"),
        (
            "feed = 200.0",
            "feed = 200.0\npitch = 1.0",
            "line 13: key 'tool.pitch' is not for operation = \"drill\"",
        ),
        ("depth = 20.0", "depth = 20.0, diameter = 9.0", "line 16: key 'pattern.make.diameter' is not for"),
        (
            "[tolerance]",
            "[cylinder]\ndiameter = 90.0\n[tolerance]",
            "line 5: key 'machine.rotary' is missing",
        ),
        (
            "[tolerance]",
            "[machine]\nrotary = { letter = \"A\", sign = 1 }\n[tolerance]",
            "line 6: key 'machine.rotary' is for a [cylinder] or a tilted [face] only",
        ),
    ] {
        let found = message(from, to);
        assert!(found.starts_with(expected), "{to}\n   found: {found}\nexpected: {expected}");
    }
}

#[test]
fn numbers_at_their_limits_are_read() {
    for (from, to) in [
        ("holes = 6", "holes = 1"),
        ("holes = 6", "holes = 6, angle = -90.0, clockwise = true"),
        ("make = [", "skip = [1, 6]\nmake = ["),
        (
            "circle = { diameter = 80.0, holes = 6 }",
            "arc = { diameter = 80.0, holes = 5, angle = 0.0, step = -72.0 }",
        ),
        ("circle = { diameter = 80.0, holes = 6 }", "line = { holes = 3, pitch = -12.5 }"),
    ] {
        assert_eq!(message(from, to), "no error", "{to}");
    }
    // Six holes at 72° meet: five steps are the whole circle.
    let arc = "arc = { diameter = 80.0, holes = 6, angle = 0.0, step = 72.0 }";
    let found = message("circle = { diameter = 80.0, holes = 6 }", arc);
    assert!(found.starts_with("line 15: key 'pattern.arc.step' is 72: 6 holes span 360 degrees"), "{found}");
}

/// A mill Φ8.5 mills from above its own diameter to twice that.
#[test]
fn a_milled_hole_is_wider_than_its_mill_and_leaves_no_core() {
    let job = JOB.replace("\"drill\"", "\"mill-circle\"\npeck = 1.0");
    for (diameter, is_allowed) in [("8.5", false), ("8.6", true), ("17.0", true), ("17.1", false)] {
        let job = job.replace("depth = 20.0", &format!("depth = 20.0, diameter = {diameter}"));
        assert_eq!(Job::parse(&job).is_ok(), is_allowed, "{diameter}: {:?}", Job::parse(&job).err());
    }
}
