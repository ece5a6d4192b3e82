//! JSON Schemas of the files that users write and of the results written as JSON.
//!
//! They are derived from the types that are read and written, so that schemas and documents always agree.
mod types;

use schemars::{JsonSchema, Schema};
use serde_json::Value;

use crate::report::budget::BudgetReport;
use crate::report::changes::ChangesReport;
use crate::report::check::CheckReport;
use crate::report::explained::ExplainReport;
use crate::report::pictures::{CompareReport, RenderReport};
use crate::report::readings::ReadingsReport;
use crate::report::run::RunReport;
use crate::report::settings::SettingsReport;
use crate::report::test_report::TestReport;
use gcode_inspect::machine::{ErrorFile, MachineFile};
use gcode_inspect::verify::Verdict;
use gcode_inspect::verify::flutes::{FluteVerdict, NominalFlutes};
use gcode_part::HoleList;
use gcode_part::job::control_file::ControlFile;
use gcode_part::job::{JobFile, Rates};
use gcode_review::AcceptedFile;

/// One kind of document and its schema.
pub struct Format {
    /// Name for `gcode-sim schema`.
    pub name: &'static str,
    /// Title: the document in one line.
    pub about: &'static str,
    /// Whether users write it as TOML; else it is JSON.
    pub is_toml: bool,
    schema: fn() -> Schema,
}

/// All formats: files first, then results by the commands that write them.
pub const FORMATS: &[Format] = &[
    file::<JobFile>("job", "a job file, of any family"),
    file::<MachineFile>("machine", "a machine file: --machine"),
    file::<ControlFile>("control", "settings of the control: --control-file"),
    file::<ErrorFile>("errors", "set-up and machine errors: budget --errors"),
    file::<Rates>("rates", "machine-hour rates: gcode-gen sheet --rates"),
    Format {
        name: "reference",
        about: "a list of holes: --reference",
        is_toml: false,
        schema: types::read::<HoleList>,
    },
    Format {
        name: "accepted",
        about: "an accepted result of a case: accepted.json",
        is_toml: false,
        schema: types::read::<AcceptedFile>,
    },
    result::<RunReport>("run", "the result of run"),
    result::<HoleList>("holes", "the result of holes, and of reference for a part with holes"),
    result::<NominalFlutes>("wanted-flutes", "the result of reference for a burr"),
    result::<Verdict>("verify", "the result of verify for a part with holes"),
    result::<FluteVerdict>("verify-flutes", "the result of verify for a burr"),
    result::<ReadingsReport>("readings", "the result of readings"),
    result::<CheckReport>("check", "the result of check"),
    result::<ChangesReport>("diff", "the result of diff"),
    result::<TestReport>("test", "the result of test, which test --merge reads"),
    result::<BudgetReport>("budget", "the result of budget"),
    result::<RenderReport>("render", "the result of render, in addition to the picture"),
    result::<CompareReport>("compare", "the result of compare"),
    result::<SettingsReport>("settings", "the result of settings"),
    result::<ExplainReport>("explain", "the result of explain"),
];

const fn file<T: JsonSchema>(name: &'static str, about: &'static str) -> Format {
    Format { name, about, is_toml: true, schema: types::toml::<T> }
}

/// Returns the format of a command's JSON result.
pub const fn result<T: JsonSchema>(name: &'static str, about: &'static str) -> Format {
    Format { name, about, is_toml: false, schema: types::written::<T> }
}

impl Format {
    /// Returns the schema, draft 2020-12.
    pub fn schema(&self) -> Value {
        let mut schema = (self.schema)();
        schema.insert("title".to_owned(), self.about.into());
        schema.to_value()
    }
}
