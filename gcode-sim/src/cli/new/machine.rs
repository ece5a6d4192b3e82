//! `gcode-sim new machine`: a machine file for a kind of machine, which works unchanged.
use clap::{Args, ValueEnum};

use super::{ExitStatus, OutputFile, UsageError};
use gcode_lang::control::Dialect;
use gcode_part::reader::names;

#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// The kind of machine
    #[arg(long, value_enum)]
    kind: Kind,

    /// The control
    #[arg(long, value_name = "NAME", default_value = "fanuc-31i", value_parser = dialects())]
    dialect: String,

    #[command(flatten)]
    file: OutputFile,
}

/// Kinds of machines, by the axes that rotate.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Kind {
    /// X, Y and Z
    #[value(name = "3-axis")]
    ThreeAxis,
    /// A rotary axis A carries the part
    #[value(name = "4th-axis")]
    FourthAxis,
    /// A tilts the table, C rotates on it
    Trunnion,
    /// B tilts the spindle, C rotates the part
    HeadTable,
    /// C and A tilt the spindle: a fork head
    HeadHead,
    /// No kind: three kinds have five axes
    #[value(name = "5-axis", aliases = ["5axis", "5-axes", "five-axis"], hide = true)]
    FiveAxis,
}

fn dialects() -> clap::builder::PossibleValuesParser {
    names(&Dialect::ALL).into()
}

impl Kind {
    /// Returns the kind in words, the control's axis table, and the sections on table, head and part.
    fn template(self) -> Result<(&'static str, &'static str, &'static str), UsageError> {
        Ok(match self {
            Self::ThreeAxis => ("3 axes", "XYZ", include_str!("machine/3-axis.toml")),
            Self::FourthAxis => {
                ("a 4th axis A under the part", "XYZA", include_str!("machine/4th-axis.toml"))
            }
            Self::Trunnion => (
                "5 axes, A tilts the table and C rotates on it",
                "XYZAC",
                include_str!("machine/trunnion.toml"),
            ),
            Self::HeadTable => (
                "5 axes, B tilts the spindle and C rotates the part",
                "XYZBC",
                include_str!("machine/head-table.toml"),
            ),
            Self::HeadHead => {
                ("5 axes, C and A tilt the spindle", "XYZAC", include_str!("machine/head-head.toml"))
            }
            Self::FiveAxis => {
                return Err(UsageError::new(
                    "--kind 5-axis: give the kind by its rotary axes: trunnion (A tilts the table, C rotates on it), head-table \
                     (B tilts the spindle, C rotates the part) or head-head (C and A tilt the spindle)",
                ));
            }
        })
    }
}

pub(super) fn run(arguments: &Arguments) -> Result<ExitStatus, UsageError> {
    arguments.file.write(&text(arguments.kind, &arguments.dialect)?)?;
    Ok(ExitStatus::Passed)
}

/// Returns the text of the machine file.
fn text(kind: Kind, dialect: &str) -> Result<String, UsageError> {
    let (words, axes, sections) = kind.template()?;
    let quoted = |name: &str| format!("\"{name}\"");
    let control = format!(
        "\
# Machine file of gcode-sim: {words}.
# Lengths are in mm, angles in degrees. Replace the numbers by those of the machine; docs/machine-file.md describes every
# key.

[control]
dialect = {:<18} # {}
increment = \"IS-B\"           # least input increment: IS-A 0.01, IS-B 0.001, IS-C 0.0001
unit = \"metric\"              # or \"inch\": the unit of programs at power-on
axes = {:<21} # axis table of the control, axis 1 first
",
        quoted(dialect),
        names(&Dialect::ALL).join(", "),
        quoted(axes)
    );
    Ok(control + sections + include_str!("machine/tools.toml"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use gcode_inspect::machine::Machine;

    /// Returns the kinds that have a machine file.
    fn kinds() -> impl Iterator<Item = Kind> {
        Kind::value_variants().iter().copied().filter(|kind| *kind != Kind::FiveAxis)
    }

    #[test]
    fn every_kind_is_read_for_every_control() {
        for kind in kinds() {
            for (name, dialect) in Dialect::ALL {
                let machine = Machine::parse(&text(kind, name).unwrap()).unwrap();
                assert_eq!(machine.dialect, dialect);
                let has_rotary = kind != Kind::ThreeAxis;
                assert_eq!(machine.kinematics().is_some(), has_rotary, "{kind:?}");
            }
        }
    }

    /// The commented sections are right as well: without their # signs the file is read.
    #[test]
    fn the_commented_sections_are_read() {
        let is_key = |line: &str| line.contains(" = ") || line.starts_with('[');
        let uncommented = |line: &str| match line.strip_prefix("# ") {
            Some(rest) if is_key(rest) => rest.to_owned(),
            _ => line.to_owned(),
        };
        for kind in kinds() {
            let text: Vec<_> = text(kind, "fanuc-31i").unwrap().lines().map(uncommented).collect();
            let machine = Machine::parse(&text.join("\n")).unwrap();
            assert_eq!(machine.tools[0].length, Some(120.0));
            assert!(machine.stock.is_some() && machine.start == [(2, 250.0)]);
        }
    }
}
