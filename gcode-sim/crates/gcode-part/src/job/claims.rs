//! Claims of a test case, `claims.toml`: what is proved of its program for all values of ranges at once.
//!
//! ```toml
//! [[proof]]
//! call = "G65 P8101 A#101 B724.3 R#102"
//! range = ["#101=500..2000", "#102=0..499"]
//! where = ["#102 LE #101"]
//! claim = ["no-alarm", "blocks LE 93"]
//! time = 10
//! ```
use schemars::JsonSchema;
use serde::Deserialize;

use super::FileError;
use crate::reader::bounds::ProofSeconds;
use crate::reader::{FileKey, Items, Optional, Reader, Section};

/// Claims on a case's program, proved for all values of ranges at once.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ClaimsFile {
    /// Requests, each proved on its own.
    #[serde(with = "Items::<Section<ProofRequest>>")]
    #[schemars(length(min = 1))]
    pub proof: Vec<ProofRequest>,
}

/// One request, as of gcode-sim prove.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ProofRequest {
    /// The block that is run instead of the case's program, as --call: "G65 P8101 A#101".
    #[schemars(regex(pattern = r"^[^\n;]*[^\s;][^\n;]*$"))]
    pub call: Option<String>,
    /// Limits of variables, as --range: "#101=500..2000".
    pub range: Vec<String>,
    /// Conditions on the variables, as --where: "#102 LE #101". Values that don't satisfy them are left out.
    #[serde(default, rename = "where")]
    pub conditions: Vec<String>,
    /// Claims, as --claim: "no-alarm", "alarm MC3001|MC3002", "#100 LE 2", "blocks LE 93", "travel 1320=X100.".
    #[schemars(length(min = 1))]
    pub claim: Vec<String>,
    /// Seconds after which what isn't proved is undecided, as --time [default: 10].
    #[serde(default, with = "Optional::<ProofSeconds>")]
    pub time: Option<f64>,
}

impl ClaimsFile {
    /// Parses the text of a file of claims.
    ///
    /// # Errors
    /// A syntax error, or a key that is unknown, missing or has a value that is not allowed, with its line.
    pub fn parse(text: &str) -> Result<Self, FileError> {
        let reader = Reader { text };
        let file: Self = reader.parse()?;
        reader.check(!file.proof.is_empty(), "proof", "[]", "at least one [[proof]]")?;
        for (index, proof) in file.proof.iter().enumerate() {
            let claim = format!("proof.{index}.claim");
            reader.check(!proof.claim.is_empty(), &claim, "[]", "at least one claim, \"no-alarm\"")?;
            if let Some(call) = &proof.call {
                let is_block = !call.trim().is_empty() && !call.contains(['\n', ';']);
                let shown = format!("{call:?}");
                reader.check(
                    is_block,
                    &format!("proof.{index}.call"),
                    shown,
                    "one block, \"G65 P8101 A#101\"",
                )?;
            }
        }
        Ok(file)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_request_has_its_keys() {
        let text =
            "[[proof]]\nrange = [\"#1=0..4\"]\nwhere = [\"#1 GT 0\"]\nclaim = [\"no-alarm\"]\ntime = 0.5\n";
        let file = ClaimsFile::parse(text).unwrap();
        let proof = &file.proof[0];
        assert_eq!((proof.call.as_deref(), proof.time), (None, Some(0.5)));
        assert_eq!((&proof.range[0][..], &proof.conditions[0][..]), ("#1=0..4", "#1 GT 0"));
        assert_eq!(proof.claim, ["no-alarm"]);
    }

    #[test]
    fn a_wrong_key_is_named_with_its_line() {
        let claims = "[[proof]]\nrange = []\nclaim = [\"no-alarm\"]\n";
        for (text, message) in [
            ("proof = []\n".to_owned(), "line 1: key 'proof' is []: at least one [[proof]]"),
            ("[[proof]]\nrange = []\n".to_owned(), "line 1: key 'proof.claim' is missing"),
            ("[[proof]]\nclaim = [\"no-alarm\"]\n".to_owned(), "line 1: key 'proof.range' is missing"),
            (claims.replace("[\"no-alarm\"]", "[]"), "line 3: key 'proof.claim' is []: at least one claim"),
            (
                format!("{claims}claims = []\n"),
                "line 4: key 'proof.claims' is unknown (did you mean 'claim'?)",
            ),
            (format!("{claims}time = 0\n"), "line 4: key 'proof.time' is 0: 0.001 to 86400 seconds"),
            (format!("{claims}call = \" \"\n"), "line 4: key 'proof.call' is \" \": one block"),
            (
                format!("{claims}call = \"#1=1\\n#2=2\"\n"),
                "line 4: key 'proof.call' is \"#1=1\\n#2=2\": one block",
            ),
        ] {
            let error = ClaimsFile::parse(&text).unwrap_err().to_string();
            assert!(error.starts_with(message), "{error}");
        }
    }
}
