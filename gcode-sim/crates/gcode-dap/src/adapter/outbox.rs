//! Messages for the client: responses, and events that follow them.
use serde::Serialize;
use serde_json::Value;

use crate::protocol::message::{ErrorBody, ErrorMessage, Event, Response};

/// Number of every error of this adapter; the sentence tells them apart.
const ERROR_ID: i64 = 1;

/// Numbered messages in the order in which they are sent.
#[derive(Debug, Default)]
pub(super) struct Outbox {
    seq: i64,
    messages: Vec<String>,
    /// Events that follow the response to the request at work.
    deferred: Vec<(&'static str, Option<Value>)>,
}

impl Outbox {
    /// Adds an event behind the response to the request at work.
    pub(super) fn event(&mut self, event: &'static str, body: impl Serialize) {
        let body = serde_json::to_value(body).ok().filter(|body| !body.is_null());
        self.deferred.push((event, body));
    }

    /// Answers a request; the events that it has caused follow.
    pub(super) fn respond(&mut self, request_seq: i64, command: &str, result: Result<Value, String>) {
        let success = result.is_ok();
        let (message, body) = match result {
            Ok(body) => (None, Some(body).filter(|body| !body.is_null())),
            Err(sentence) => {
                let error = ErrorMessage { id: ERROR_ID, format: sentence.clone(), show_user: true };
                (Some(sentence), serde_json::to_value(ErrorBody { error }).ok())
            }
        };
        let command = command.to_owned();
        let seq = self.next_seq();
        let response = Response { seq, kind: "response", request_seq, success, command, message, body };
        self.push(&response);
        self.send_events();
    }

    /// Sends the events that wait.
    pub(super) fn send_events(&mut self) {
        for (event, body) in std::mem::take(&mut self.deferred) {
            let seq = self.next_seq();
            self.push(&Event { seq, kind: "event", event, body });
        }
    }

    /// Takes the messages.
    pub(super) fn take(&mut self) -> Vec<String> {
        std::mem::take(&mut self.messages)
    }

    fn next_seq(&mut self) -> i64 {
        self.seq += 1;
        self.seq
    }

    fn push(&mut self, message: &impl Serialize) {
        self.messages.extend(serde_json::to_string(message));
    }
}
