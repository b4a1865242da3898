//! The layered BSDF on the device: what `bsdf_sample` draws follows `bsdf_pdf`, its weight is
//! `bsdf_eval` / `bsdf_pdf`, and the albedo is what theory says.
//!
//! Expected counts come from Gauss-Legendre quadrature of the device's pdf over cells that are
//! clustered about the directions of the lobes, in the whole sphere; samples that go nowhere are one more
//! cell. The rate of false alarms is stated in common/statistics.rs.

mod bench;
mod case;
mod controls;
mod density;
mod energy;
mod furnace;
mod layers;
mod reciprocity;
