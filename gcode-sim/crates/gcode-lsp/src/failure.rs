//! Errors of requests.
use lsp_server::{ErrorCode, RequestId, Response, ResponseError};

/// Request that was well understood and cannot be done, `RequestFailed` of the protocol.
const REQUEST_FAILED: i32 = -32803;

/// Error of a request.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Failure {
    code: i32,
    message: String,
}

impl Failure {
    /// The parameters are unusable.
    pub(crate) fn params(message: impl Into<String>) -> Self {
        Self { code: ErrorCode::InvalidParams as i32, message: message.into() }
    }

    /// The request is refused for a reason.
    pub(crate) fn refused(message: impl Into<String>) -> Self {
        Self { code: REQUEST_FAILED, message: message.into() }
    }

    /// An edit has made the answer useless.
    pub(crate) fn outdated() -> Self {
        Self { code: ErrorCode::ContentModified as i32, message: "the document has changed".to_owned() }
    }

    /// The client has cancelled the request.
    pub(crate) fn cancelled() -> Self {
        Self { code: ErrorCode::RequestCanceled as i32, message: "the request was cancelled".to_owned() }
    }

    /// The server does not know the method.
    pub(crate) fn unknown_method(method: &str) -> Self {
        Self { code: ErrorCode::MethodNotFound as i32, message: format!("unknown method {method}") }
    }

    /// The request comes at a time when it is not allowed.
    pub(crate) fn not_now(message: &str) -> Self {
        Self { code: ErrorCode::InvalidRequest as i32, message: message.to_owned() }
    }

    /// No initialize came before.
    pub(crate) fn not_initialized() -> Self {
        let message = "the server is not initialized: send initialize first".to_owned();
        Self { code: ErrorCode::ServerNotInitialized as i32, message }
    }

    /// The server itself is at fault.
    pub(crate) fn internal(message: impl Into<String>) -> Self {
        Self { code: ErrorCode::InternalError as i32, message: message.into() }
    }

    /// Returns the answer to a request.
    pub(crate) fn response(self, id: RequestId) -> Response {
        let error = ResponseError { code: self.code, message: self.message, data: None };
        Response { id, result: None, error: Some(error) }
    }
}
