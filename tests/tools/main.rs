//! The scripts of `tools/`.

mod bench;
mod contact_sheet;
mod run;
