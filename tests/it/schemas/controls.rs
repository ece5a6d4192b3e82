//! The schema of the control's settings against what the control takes, key by key and value by value.
use gcode_lang::control::{ROWS, SettingValues, Settings};
use gcode_part::job::control_file;
use serde_json::{Value, json};

use super::validator;

fn is_taken(key: &str, value: &Value) -> bool {
    let text = format!("\"{key}\" = {value}\n");
    control_file::apply(&text, &mut Settings::default(), true).is_ok()
}

/// Values of every kind of setting; words are separated by `|`.
const NUMBERS: &str = "-9999 -1 0 1 2 3 4 9 10 15 16 30 31 300 301 999 1000 4095 9000 9001 1000000000";
const WORDS: &str = "|fanuc-31i|haas-ngc|haas|IS-C|A|AC|A+B|X|X10|X10,Z-5|X.5, Z-5.|1+2|1+|10+1|98000-98499|400-499,900000-907399|98000|L|whole|feed|first";

#[test]
fn each_setting_takes_the_values_of_its_schema() {
    let whole = NUMBERS.split(' ').map(|number| json!(number.parse::<i64>().unwrap()));
    let values = whole.chain(WORDS.split('|').map(|word| json!(word)));
    let values: Vec<Value> = values.chain([json!(0.5), json!(-0.5), json!(true), json!(false)]).collect();
    let validator = validator("control");
    for row in ROWS {
        let mut taken = 0;
        for value in &values {
            // The reader takes a number for a text as well: BDT = 1.
            let is_text = matches!(row.values, SettingValues::Text(..) | SettingValues::Ranges(_));
            // … and a number in quotes.
            let is_quoted = value.as_str().is_some_and(|text| text.parse::<f64>().is_ok());
            if if is_text { value.is_number() } else { is_quoted } {
                continue;
            }
            let is_valid = validator.is_valid(&json!({ row.key: value }));
            assert_eq!(is_taken(row.key, value), is_valid, "{} = {value}", row.key);
            taken += usize::from(is_valid);
        }
        assert!(taken > 0, "{} takes none of the values that are tried", row.key);
    }
}

#[test]
fn signals_and_codes_that_call_are_known_by_their_names() {
    let validator = validator("control");
    let programs = [0, 1, 65, 66, 99, 201, 9000, 9004, 9005, 9010, 9020, 9028, 9029, -65, -201, -10_000];
    for key in [
        "#999", "#1000", "#1009", "#1031", "G201", "G-201", "G201.5", "GX", "M6", "M50", "M", "T", "S", "B",
        "V", "N", "X1", "6037", "6038", "6039", "6046", "6049", "6050", "6059", "6060", "6071", "6080",
        "6089", "6090", "6091", "6092",
    ] {
        for program in programs {
            let value = json!(program);
            let is_valid = validator.is_valid(&json!({ key: value }));
            assert_eq!(is_taken(key, &value), is_valid, "{key} = {program}");
        }
    }
}

/// A pattern cannot exclude single codes; docs/schemas.md lists these.
#[test]
fn codes_that_are_calls_themselves_are_left_to_the_reader() {
    for key in ["G65", "M99", "M30"] {
        assert!(!is_taken(key, &json!(9010)), "{key}");
        assert!(validator("control").is_valid(&json!({ key: 9010 })), "{key}");
    }
}
