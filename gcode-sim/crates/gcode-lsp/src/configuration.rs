//! Settings of the editor, `gcode-sim.*`: files that gcode.toml does not name.
use std::path::{Path, PathBuf};

use serde::Deserialize;
use serde_json::Value;

/// Name of the settings' section.
pub(crate) const SECTION: &str = "gcode-sim";

/// Settings of the editor; a path that is not absolute begins at the first folder of the workspace.
#[derive(Clone, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(crate) struct EditorSettings {
    pub machine: Option<PathBuf>,
    pub control: Option<PathBuf>,
    pub dialect: Option<String>,
    pub libraries: Vec<PathBuf>,
    pub reference: Option<PathBuf>,
}

impl EditorSettings {
    /// Reads settings as initializationOptions and the answers of workspace/configuration have them, with or without
    /// their section.
    ///
    /// # Errors
    /// A value of another kind.
    pub(crate) fn parse(value: &Value) -> Result<Self, String> {
        let value = value.get(SECTION).unwrap_or(value);
        if value.is_null() {
            return Ok(Self::default());
        }
        let settings = Self::deserialize(value).map_err(|error| format!("settings {SECTION}: {error}"))?;
        let is_empty = |path: &PathBuf| path.as_os_str().is_empty();
        Ok(Self {
            machine: settings.machine.filter(|path| !is_empty(path)),
            control: settings.control.filter(|path| !is_empty(path)),
            dialect: settings.dialect.filter(|name| !name.is_empty()),
            libraries: settings.libraries,
            reference: settings.reference.filter(|path| !is_empty(path)),
        })
    }

    /// Makes the paths absolute.
    pub(crate) fn below(mut self, folder: Option<&Path>) -> Self {
        let Some(folder) = folder else { return self };
        let paths = [&mut self.machine, &mut self.control, &mut self.reference].into_iter().flatten();
        paths.chain(&mut self.libraries).for_each(|path| *path = folder.join(&*path));
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn settings_are_read_with_and_without_their_section() {
        let settings = EditorSettings { dialect: Some("haas-ngc".to_owned()), ..EditorSettings::default() };
        assert_eq!(
            EditorSettings::parse(&json!({ "gcode-sim": { "dialect": "haas-ngc" } })),
            Ok(settings.clone())
        );
        assert_eq!(
            EditorSettings::parse(&json!({ "dialect": "haas-ngc", "machine": "", "other": 1 })),
            Ok(settings)
        );
        assert_eq!(EditorSettings::parse(&Value::Null), Ok(EditorSettings::default()));
        assert!(EditorSettings::parse(&json!({ "libraries": "macros" })).is_err());
    }

    #[test]
    fn a_relative_path_begins_at_the_workspace() {
        let settings =
            EditorSettings::parse(&json!({ "machine": "m.toml", "libraries": ["/lib", "lib"] })).unwrap();
        let settings = settings.below(Some(Path::new("/w")));
        assert_eq!(settings.machine, Some(PathBuf::from("/w/m.toml")));
        assert_eq!(settings.libraries, ["/lib", "/w/lib"].map(PathBuf::from));
    }
}
