//! The request to the client to ask for inlay hints again, which it has not answered yet.
use lsp_server::RequestId;

/// Request to ask for hints again.
#[derive(Debug, Default)]
pub(crate) struct HintRefresh {
    /// Request without an answer.
    pub asked: Option<RequestId>,
    /// Hints have changed since it was sent.
    is_outdated: bool,
}

impl HintRefresh {
    /// Returns true if a change of hints needs a request. One that waits for its answer is followed by another.
    pub(crate) fn is_needed(&mut self) -> bool {
        self.is_outdated = self.asked.is_some();
        self.asked.is_none()
    }

    /// Takes an answer; returns true if hints have changed since its request.
    pub(crate) fn is_answered_late(&mut self, id: &RequestId) -> bool {
        let is_answered = self.asked.take_if(|asked| asked == id).is_some();
        is_answered && std::mem::take(&mut self.is_outdated)
    }
}
