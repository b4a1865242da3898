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
    /// A thin lens; none for a pinhole. A panorama has none.
    pub lens: Option<Lens>,
}

/// A thin lens around the camera's position, across its axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lens {
    /// Half the diameter of the aperture, metres, finite and not negative.
    pub radius: f64,
    /// Distance of the plane in focus along the camera's axis, metres, more than 0; infinite if rays
    /// of a point of the film leave in parallel.
    pub focus_distance: f64,
}

impl Default for Camera {
    /// A pinhole at the origin that looks along −Z, 40° high.
    fn default() -> Self {
        Self {
            name: String::new(),
            to_world: DMat4::IDENTITY,
            projection: Projection::Perspective {
                yfov: DEFAULT_YFOV,
                aspect: None,
            },
            lens: None,
        }
    }
}

/// Vertical field of view where nothing asks for another, radians: 40°.
pub const DEFAULT_YFOV: f64 = 40.0 * std::f64::consts::PI / 180.0;

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
    /// The whole sphere around the camera's position, equirectangular in the axes of the world,
    /// however the camera is turned: u = 0.5 + atan2(d.z, d.x)/2π, v = acos(d.y)/π from the top row, so
    /// that +X is in the middle and +Z half way from there to the right edge.
    Panorama,
}
