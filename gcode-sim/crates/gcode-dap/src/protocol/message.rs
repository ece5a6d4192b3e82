//! Messages: requests in, responses and events out.
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// Request of a client.
#[derive(Clone, Debug, Deserialize)]
pub(crate) struct Request {
    pub(crate) seq: i64,
    #[serde(rename = "type")]
    pub(crate) kind: String,
    pub(crate) command: String,
    #[serde(default)]
    pub(crate) arguments: Value,
}

/// What can still be read of a message that is no request.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct MalformedMessage {
    pub(crate) seq: i64,
    pub(crate) command: String,
    pub(crate) reason: String,
}

impl Request {
    /// Reads a message.
    pub(crate) fn parse(message: &[u8]) -> Result<Self, MalformedMessage> {
        let value: Value = serde_json::from_slice(message).map_err(|error| MalformedMessage {
            reason: format!("the message is no JSON: {error}"),
            ..MalformedMessage::default()
        })?;
        let malformed = MalformedMessage {
            seq: value.get("seq").and_then(Value::as_i64).unwrap_or_default(),
            command: value.get("command").and_then(Value::as_str).unwrap_or_default().to_owned(),
            reason: String::new(),
        };
        let request = serde_json::from_value::<Self>(value).map_err(|error| error.to_string());
        match request {
            Ok(request) if request.kind == "request" => Ok(request),
            Ok(request) => {
                Err(MalformedMessage { reason: format!("'{}' is no request", request.kind), ..malformed })
            }
            Err(error) => {
                Err(MalformedMessage { reason: format!("the message is no request: {error}"), ..malformed })
            }
        }
    }
}

/// Answer to a request.
#[derive(Debug, Serialize)]
pub(crate) struct Response {
    pub(crate) seq: i64,
    #[serde(rename = "type")]
    pub(crate) kind: &'static str,
    pub(crate) request_seq: i64,
    pub(crate) success: bool,
    pub(crate) command: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) message: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) body: Option<Value>,
}

/// Body of a response to a request that failed.
#[derive(Debug, Serialize)]
pub(crate) struct ErrorBody {
    pub(crate) error: ErrorMessage,
}

/// Structured message of an error.
#[derive(Debug, Serialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct ErrorMessage {
    pub(crate) id: i64,
    pub(crate) format: String,
    pub(crate) show_user: bool,
}

/// Event.
#[derive(Debug, Serialize)]
pub(crate) struct Event {
    pub(crate) seq: i64,
    #[serde(rename = "type")]
    pub(crate) kind: &'static str,
    pub(crate) event: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) body: Option<Value>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_malformed_message_keeps_what_can_be_read() {
        let reason = |text: &str| Request::parse(text.as_bytes()).unwrap_err();
        assert_eq!(reason("{").seq, 0);
        let other = reason(r#"{"seq":7,"type":"event","command":"next"}"#);
        assert_eq!(
            (other.seq, other.command.as_str(), other.reason.as_str()),
            (7, "next", "'event' is no request")
        );
        assert_eq!(reason(r#"{"seq":8,"type":"request"}"#).seq, 8);
        assert_eq!(reason("[1]").command, "");
        let request = Request::parse(br#"{"seq":1,"type":"request","command":"threads"}"#).unwrap();
        assert_eq!((request.seq, request.arguments), (1, Value::Null));
    }
}
