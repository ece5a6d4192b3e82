//! Controls of a proof: as from power-on, with the programs of a package.
use gcode_control::Control;
use gcode_prove::Setup;
use gcode_session::Request;

use crate::check::Programs;
use crate::package::Package;

/// Source of controls that run a program, or a block instead of it.
pub(crate) struct Controls<'a> {
    pub(crate) request: Request,
    /// Block that is run instead of the program.
    pub(crate) call: Option<String>,
    pub(crate) programs: &'a Package,
}

impl<'a> Setup for Controls<'a> {
    type Library = Programs<'a>;

    fn control(&self, settings: &[(String, String)]) -> Result<Control, String> {
        let request = self.request.with_settings(settings).map_err(|error| error.to_string())?;
        gcode_session::set_up(&request, self.call.as_deref()).map_err(|error| error.to_string())
    }

    fn library(&self) -> Programs<'a> {
        Programs(self.programs)
    }
}
