//! Tests of the crate as a whole: soundness at random, published kernels.
mod kernels;
mod random_nodes;
