//! Reads lists of nominal holes as JSON in the schema of `hole`, and rejects implausible entries of any list.
use std::collections::HashMap;

use nalgebra::Vector3;

use super::feature::{Feature, FeatureKind};
use super::hole::{Hole, HoleList};
use crate::reader::FileError;
use crate::reader::bounds::{KeyRange, Length, MachinePoint};

fn error(line: Option<usize>, message: impl Into<String>) -> FileError {
    FileError { line, message: message.into() }
}

pub(super) fn json(text: &str) -> Result<HoleList, FileError> {
    serde_json::from_str(text).map_err(|e| {
        let message = e.to_string();
        let message = message.split(" at line ").next().unwrap_or_default();
        error(Some(e.line()), format!("column {}: {message}", e.column()))
    })
}

/// Returns the holes with an id each and axes normalised to length 1, or the first error.
pub(super) fn check_all(mut holes: Vec<Hole>) -> Result<Vec<Hole>, FileError> {
    for (index, hole) in holes.iter_mut().enumerate() {
        complete(hole);
        check(hole, index).map_err(|message| error(None, message))?;
        hole.axis = Vector3::from(hole.axis).normalize().into();
        hole.id.get_or_insert_with(|| format!("#{}", index + 1));
    }
    if let Some([first, second]) = repeated_id(&holes) {
        let id = holes[second].id.as_deref().unwrap_or_default();
        let message = format!(
            "id '{id}' is used twice, in hole {} and hole {}: give each its own",
            first + 1,
            second + 1
        );
        return Err(error(None, message));
    }
    Ok(holes)
}

/// Returns the indices of the first hole whose id an earlier one has, behind that one.
pub(super) fn repeated_id(holes: &[Hole]) -> Option<[usize; 2]> {
    let ids = || holes.iter().enumerate().filter_map(|(index, hole)| Some((index, hole.id.as_deref()?)));
    // Most lists count upwards.
    if ids().is_sorted_by(|one, next| (one.1.len(), one.1) < (next.1.len(), next.1)) {
        return None;
    }
    let mut known = HashMap::with_capacity(holes.len());
    ids().find_map(|(index, id)| Some([known.insert(id, index)?, index]))
}

/// Sets a depth that is left out, or that is less than that of a feature, to that of the deepest one. That of a through hole
/// is the thickness of the part.
pub(super) fn complete(hole: &mut Hole) {
    let deepest = hole.features.iter().map(Feature::bottom).fold(0.0, f64::max);
    if hole.depth == 0.0 || (!hole.through && 0.0 < hole.depth && hole.depth < deepest) {
        hole.depth = deepest;
    }
}

/// Checks one hole for finite, plausible values.
pub(super) fn check(hole: &Hole, index: usize) -> Result<(), String> {
    find_fault(hole).map_or(Ok(()), |fault| {
        let name = match &hole.id {
            Some(id) => format!("hole {} (id '{id}')", index + 1),
            None => format!("hole {}", index + 1),
        };
        Err(format!("{name}: {fault}"))
    })
}

/// Returns what is wrong with a hole.
fn find_fault(hole: &Hole) -> Option<String> {
    let numbers = hole.entry.iter().chain(&hole.axis).chain([&hole.depth]).chain(&hole.diameter);
    if let Some(number) = numbers.clone().find(|n| !n.is_finite()) {
        return Some(format!("a number is {number}: all must be finite"));
    }
    if let Some(number) = hole.entry.iter().find(|number| !MachinePoint::contains(**number)) {
        return Some(format!("a coordinate of the entry is {number:?}: {}", MachinePoint::allowed()));
    }
    let sizes = hole.features.iter().flat_map(|one| one.depth.into_iter().chain([one.diameter]));
    let mut sizes = sizes.chain([hole.depth]).chain(hole.diameter);
    if let Some(size) = sizes.find(|size| Length::MAX < *size) {
        return Some(format!("a depth or a diameter is {size:?}: at most {} mm", Length::MAX));
    }
    let length = Vector3::from(hole.axis).norm();
    if length == 0.0 {
        return Some("the axis is 0, 0, 0: give the unit vector out of the part".to_owned());
    }
    // Axes rounded to a few digits are normalised; a larger error is not a direction of length 1.
    if (length - 1.0).abs() > 1e-3 {
        return Some(format!("the axis has the length {length:.7}: divide i, j, k by it"));
    }
    if hole.depth == 0.0 {
        return Some("the depth is left out or 0: a number above 0 is required, or features".to_owned());
    }
    if hole.depth < 0.0 {
        return Some(format!("the depth is {}: a number above 0 is required", hole.depth));
    }
    if let Some(diameter) = hole.diameter.filter(|diameter| *diameter <= 0.0) {
        return Some(format!("the diameter is {diameter}: a number above 0 is required"));
    }
    check_features(hole).err()
}

/// Checks each feature, and that the hole's own diameter is that of one of them.
fn check_features(hole: &Hole) -> Result<(), String> {
    let cylinders = hole.features.iter().filter(|feature| feature.kind != FeatureKind::Countersink);
    let walls: Vec<f64> = cylinders.map(|feature| feature.diameter).collect();
    hole.features.iter().try_for_each(|feature| feature.check(&walls))?;
    let is_own = |diameter: f64| hole.features.iter().any(|feature| feature.diameter == diameter);
    match hole.diameter.filter(|diameter| !hole.features.is_empty() && !is_own(*diameter)) {
        Some(diameter) => Err(format!(
            "the diameter is {diameter}, which no feature has: if it is drilled, it is a feature too, \
             drill, and its column in a list is 'drill'"
        )),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::super::nominal::NominalPart;
    use super::super::reference::Reference;
    use super::*;

    const HOLE: &str =
        r#"{"unit": "mm", "holes": [{"id": "1", "entry": [1, 2, 3], "axis": [0, 0.6, 0.8], "depth": 5}]}"#;

    fn refused(text: &str) -> String {
        NominalPart::parse(text).unwrap_err().to_string()
    }

    fn read_holes(text: &str) -> Reference {
        NominalPart::parse(text).unwrap().into_holes().unwrap()
    }

    #[test]
    fn json_and_csv_give_the_same_holes() {
        let csv = "id,x,y,z,i,j,k,depth,diameter\r\n1, 1, 2, 3, 0, 0.6, 0.8, 5,\r\n";
        assert_eq!(NominalPart::parse(HOLE).unwrap(), NominalPart::parse(csv).unwrap());
    }

    #[test]
    fn a_list_of_a_run_that_stopped_is_no_reference() {
        for list in [
            r#"{"unit": "mm", "holes": [{"id": "1", "entry": [1, 2, 3], "axis": [0, 0, 1], "depth": 5}], "stopped": "alarm; holes may be missing"}"#,
            "id,x,y,z,i,j,k,depth,diameter\n1,1,2,3,0,0,1,5,\n# stopped: alarm; holes may be missing\n",
            "id,x,y,z,i,j,k,depth,diameter\n# stopped: alarm; holes may be missing\n",
        ] {
            let error = NominalPart::parse(list).unwrap_err();
            assert_eq!(error.to_string(), "the list is of a run that stopped: alarm; holes may be missing");
        }
        // A hole may have any name.
        let holes = read_holes("id,x,y,z,i,j,k,depth,diameter\n# 1,1,2,3,0,0,1,5,\n").holes;
        assert_eq!(holes[0].id.as_deref(), Some("# 1"));
    }

    #[test]
    fn json_and_csv_give_the_same_features() {
        let json = r#"{"unit": "mm", "holes": [{"id": "1", "entry": [1, 2, 3], "axis": [0, 0, 1], "depth": 30,
            "through": true, "features": [{"kind": "drill", "diameter": 8.5, "depth": 30, "to": "full", "angle": 118},
            {"kind": "tap", "diameter": 10, "depth": 22, "pitch": 1.5}]}]}"#;
        let csv = "id,x,y,z,i,j,k,depth,features,through\n\
                   1,1,2,3,0,0,1,30,drill 8.5 30 to=full angle=118; tap 10 22 pitch=1.5,true\n";
        assert_eq!(NominalPart::parse(json).unwrap(), NominalPart::parse(csv).unwrap());
    }

    /// Φ12 at 90° is 6 deep to its point. A through hole is as deep as the part is thick.
    #[test]
    fn features_give_the_depth_that_is_left_out_or_less() {
        let depth = |columns: &str| {
            let csv = format!("id,x,y,z,i,j,k,depth,features,through\n1,0,0,0,0,0,1,{columns}\n");
            read_holes(&csv).holes[0].depth
        };
        assert_eq!(depth(",drill 6 15; counterbore 10 5,"), 15.0);
        assert_eq!(depth("5,drill 6 15; counterbore 10 5,false"), 15.0);
        assert_eq!(depth("18,drill 6 15; counterbore 10 5,"), 18.0);
        let cone = depth("5,drill 6 5; countersink 12 angle=90,");
        assert!((cone - 6.0).abs() < 1e-12, "{cone}");
        assert_eq!(depth("12,drill 6 15; counterbore 10 5,true"), 12.0);
    }

    #[test]
    fn a_hole_without_an_id_is_named_by_its_number() {
        let csv = "id,x,y,z,i,j,k,depth,diameter\n,0,0,0,0,1,0,5,6\n";
        assert_eq!(read_holes(csv).holes[0].id.as_deref(), Some("#1"));
    }

    #[test]
    fn an_axis_rounded_to_a_few_digits_is_taken() {
        let csv = "id,x,y,z,i,j,k,depth,diameter\n1,0,0,0,0.453,0.879,-0.149,5,6\n";
        let axis = read_holes(csv).holes[0].axis;
        assert!((Vector3::from(axis).norm() - 1.0).abs() < 1e-15, "{axis:?}");
    }

    #[test]
    fn an_implausible_entry_is_refused_with_its_place() {
        let row = |row: &str| format!("id,x,y,z,i,j,k,depth,diameter\n0,0,0,0,0,1,0,5,6\n{row}\n");
        let cases = [
            (row("1,0,0,zero,0,1,0,5,6"), "line 3: column 'z' is 'zero': a number is required"),
            (row("1,0,0,nan,0,1,0,5,6"), "line 3: hole 2 (id '1'): a number is NaN: all must be finite"),
            (
                row("1,0,0,0,0,0,0,5,6"),
                "line 3: hole 2 (id '1'): the axis is 0, 0, 0: give the unit vector out of the part",
            ),
            (
                row("1,0,0,0,0,2,0,5,6"),
                "line 3: hole 2 (id '1'): the axis has the length 2.0000000: divide i, j, k by it",
            ),
            (
                row("1,0,0,0,0,1,0,-5,6"),
                "line 3: hole 2 (id '1'): the depth is -5: a number above 0 is required",
            ),
            (
                row("1,0,0,0,0,1,0,0,6"),
                "line 3: hole 2 (id '1'): the depth is left out or 0: a number above 0 is required, or features",
            ),
            (
                row("0,0,0,0,0,1,0,5,6"),
                "line 3: id '0' is used twice, in line 2 first: give each hole its own",
            ),
            (row("1,0,0"), "line 3: 3 columns, the header has 9"),
            (
                "id,x,y,z,i,j,depth,diameter\n".to_owned(),
                "line 1: column 'k' is missing: i, j and k together are the axis; a list begins with its columns, for \
                 example: id,x,y,depth,diameter, and below them: 1,30,10,15,6",
            ),
            (
                "id,x,y,z,i,j,k,depth,through\n1,0,0,0,0,1,0,5,maybe\n".to_owned(),
                "line 2: column 'through' is 'maybe': yes or no",
            ),
            (
                "id,x,y,z,i,j,k,depth,features\n1,0,0,0,0,1,0,5,drill 6 15; cbore 10 5\n".to_owned(),
                "line 2: column 'features': 'cbore' is no kind of feature: one of drill, ream",
            ),
            ("id,x,y,depth,through\n1,0,0,,true\n".to_owned(), "line 2: column 'depth' is ''"),
            (
                "id,x,y,z,i,j,k,depth,diameter,features\n1,0,0,0,0,1,0,15,7,drill 6 15\n".to_owned(),
                "line 2: hole 1 (id '1'): the diameter is 7, which no feature has: if it is drilled, it is a feature too, drill",
            ),
            (
                HOLE.replace("[1, 2, 3]", "[1, 2, 6e307]"),
                "hole 1 (id '1'): a coordinate of the entry is 6e307: -100000 to 100000",
            ),
            (
                HOLE.replace("5}]}", "1e300}]}"),
                "hole 1 (id '1'): a depth or a diameter is 1e300: at most 99999 mm",
            ),
            (HOLE.replace("depth", "deep"), "line 1: column 86: unknown field `deep`"),
            (HOLE.replace("5}]}", "5}"), "line 1: column 91: EOF while parsing a list"),
        ];
        for (text, expected) in cases {
            let found = refused(&text);
            assert!(found.starts_with(expected), "{text}\n  says {found:?}\n  not  {expected:?}");
        }
    }
}
