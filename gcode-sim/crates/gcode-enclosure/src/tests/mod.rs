//! Tests of the crate as a whole: soundness at random, published kernels.
mod certificates;
mod conditions;
mod exact;
mod guards;
mod identities;
mod kernels;
mod libm_errors;
mod random_nodes;
