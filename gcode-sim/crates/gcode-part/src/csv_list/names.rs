//! Names of the columns of a list, in English, German and Chinese, and what they mean.
use crate::feature::FeatureKind;
use crate::hole::Unit;

/// Columns of a list, with other names of each; a feature's own columns are beside them.
pub(super) const COLUMNS: [(&str, &[&str]); 13] = [
    (
        "id",
        &[
            "hole",
            "no",
            "nr",
            "no.",
            "nr.",
            "tag",
            "#",
            "hole #",
            "hole#",
            "hole no",
            "hole no.",
            "hole number",
            "hole id",
            "pos",
            "pos.",
            "item",
            "孔号",
            "序号",
        ],
    ),
    (
        "x",
        &[
            "x pos",
            "x pos.",
            "x location",
            "x coordinate",
            "x dim",
            "x loc",
            "xpos",
            "pos x",
            "posx",
            "x coord",
            "x position",
            "x koord",
            "x koordinate",
            "x wert",
            "x maß",
            "x坐标",
        ],
    ),
    (
        "y",
        &[
            "y pos",
            "y pos.",
            "y location",
            "y coordinate",
            "y dim",
            "y loc",
            "ypos",
            "pos y",
            "posy",
            "y coord",
            "y position",
            "y koord",
            "y koordinate",
            "y wert",
            "y maß",
            "y坐标",
        ],
    ),
    (
        "z",
        &[
            "z pos",
            "z loc",
            "zpos",
            "pos z",
            "posz",
            "z coord",
            "z position",
            "z koord",
            "z koordinate",
            "z wert",
            "z maß",
            "z坐标",
        ],
    ),
    ("i", &[]),
    ("j", &[]),
    ("k", &[]),
    ("angle", &["winkel", "角度"]),
    ("radius", &["radius r", "半径"]),
    ("depth", &["hole depth", "tiefe", "深度", "孔深"]),
    (
        "diameter",
        &[
            "dia",
            "dia.",
            "d",
            "ø",
            "φ",
            "hole dia",
            "hole dia.",
            "hole diameter",
            "hole size",
            "durchmesser",
            "直径",
            "孔径",
        ],
    ),
    ("features", &[]),
    ("through", &["thru", "thru hole", "through hole", "durchgehend", "durchgangsbohrung", "通孔"]),
];

/// Other names of the columns of features, which `thread depth` begins with too.
pub(super) const FEATURE_NAMES: [(&str, FeatureKind); 14] = [
    ("thread", FeatureKind::Tap),
    ("gewinde", FeatureKind::Tap),
    ("kernloch", FeatureKind::Drill),
    ("reiben", FeatureKind::Ream),
    ("flachsenkung", FeatureKind::Counterbore),
    ("kegelsenkung", FeatureKind::Countersink),
    ("senkung", FeatureKind::Countersink),
    ("cbore", FeatureKind::Counterbore),
    ("c'bore", FeatureKind::Counterbore),
    ("csink", FeatureKind::Countersink),
    ("c'sink", FeatureKind::Countersink),
    ("csk", FeatureKind::Countersink),
    ("tap drill", FeatureKind::Drill),
    ("bohrer", FeatureKind::Drill),
];

/// Names of a value of a feature in one word.
pub(super) const VALUE_NAMES: [(&str, &str); 5] = [
    ("gewindetiefe", "tap depth"),
    ("gewindesteigung", "tap pitch"),
    ("steigung", "tap pitch"),
    ("kernlochtiefe", "drill depth"),
    ("senkwinkel", "countersink angle"),
];

/// Names with two meanings: the second counts where another column has the first. Without a second the column is unused then.
pub(super) const TWO_MEANINGS: [(&str, &str, Option<&str>); 3] = [
    ("bohrung", "id", Some("drill")),
    ("bohrtiefe", "depth", Some("drill depth")),
    ("size", "diameter", None),
];

/// Words of columns that state nothing of the drawing's holes.
pub(super) const REMARKS: [&str; 22] = [
    "remark",
    "remarks",
    "note",
    "notes",
    "comment",
    "comments",
    "description",
    "qty",
    "quantity",
    "name",
    "tool",
    "bemerkung",
    "bemerkungen",
    "beschreibung",
    "kommentar",
    "anzahl",
    "menge",
    "stück",
    "werkzeug",
    "备注",
    "数量",
    "刀具",
];

/// Words for a diameter behind the name of a feature: `Drill Dia` means `drill`.
pub(super) const DIAMETER_WORDS: [&str; 5] = [" dia", " dia.", " diameter", " size", " ø"];

/// Columns of a hole round the axis x, in place of y, z, i, j and k.
pub(super) const ROUND: [&str; 2] = ["angle", "radius"];

/// Further values of a feature with columns of its own: `tap pitch`.
pub(super) const FEATURE_COLUMNS: [&str; 5] = ["depth", "to", "angle", "pitch", "hand"];

/// Returns the unit of length that a word names, `None` inside for an angle; `None` for another word.
pub(super) fn unit_of(word: &str) -> Option<Option<Unit>> {
    match word {
        "mm" => Some(Some(Unit::Mm)),
        "in" | "inch" | "inches" | "in." => Some(Some(Unit::Inch)),
        "°" => Some(None),
        _ => None,
    }
}

/// Returns true for a name of a column, as it is or in other words.
pub(super) fn is_known(name: &str) -> bool {
    let of_columns = COLUMNS.iter().any(|(own, others)| *own == name || others.contains(&name));
    let of_kind =
        |kind: &str| name == kind || name.strip_prefix(kind).is_some_and(|rest| rest.starts_with(' '));
    let mut kinds =
        FeatureKind::ALL.iter().map(|kind| kind.name()).chain(FEATURE_NAMES.iter().map(|(other, _)| *other));
    let mut others =
        VALUE_NAMES.iter().map(|(other, _)| *other).chain(TWO_MEANINGS.iter().map(|(other, ..)| *other));
    of_columns || kinds.any(of_kind) || others.any(|other| other == name)
}
