//! Published kernels: bounds against the true ranges.
