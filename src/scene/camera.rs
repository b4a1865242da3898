//! Cameras.

use glam::DMat4;

/// A camera placed in the world. It looks along −Z of its own space, +Y up.
#[derive(Debug, Clone, PartialEq)]
pub struct Camera {
    /// Name of the node or else of the camera, possibly empty.
    pub name: String,
    /// Camera space to world space, rigid: scale is removed when it is loaded.
    pub to_world: DMat4,
    /// How directions map to the film.
    pub projection: Projection,
}

/// The map from the film to rays.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Projection {
    /// A pinhole.
    Perspective {
        /// Vertical field of view, radians, in (0, π).
        yfov: f64,
        /// Width over height that the file asks for, if any; it gives the default picture size.
        aspect: Option<f64>,
    },
    /// Parallel rays.
    Orthographic {
        /// Half the width of the view, metres, nonzero.
        xmag: f64,
        /// Half the height of the view, metres, nonzero.
        ymag: f64,
    },
}
