//! Pictures of whole kernels: against closed forms, against each other, and against another renderer.

mod agreement;
mod closed_forms;
mod common;
mod features;
mod guiding;
mod instances;
mod long_run;
mod pieces;
mod reference;
