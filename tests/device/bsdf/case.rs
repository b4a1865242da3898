//! A material, a side of it and a direction to look from; and cells that resolve its lobes from there.

use std::f64::consts::{FRAC_PI_2, PI};

use etendue::render::BsdfTables;
use etendue::scene::Material;
use glam::{DMat3, DVec3, Vec3, Vec4};

use crate::common::grid::{SphereGrid, clustered_about};

/// Azimuth of wo, not along an axis.
const AZIMUTH: f64 = 0.7;
/// Numbers in front of the directions in a kernel's inputs, four by four.
pub const HEAD: usize = 10;

/// What the kernels are asked about.
#[derive(Debug, Clone)]
pub struct Case {
    pub name: &'static str,
    pub material: Material,
    /// Whether wo is inside of the solid.
    pub inside: bool,
    /// Normal of the clear coat in the frame of the base.
    pub coat_normal: DVec3,
    pub cos_o: f64,
}

/// Where light of a lobe mostly goes, and how wide it is about there: in 1 - cos(theta) and in azimuth. For a pole
/// along the frame's z axis.
struct Spot {
    direction: DVec3,
    nu_width: f64,
    phi_width: f64,
}

impl Case {
    pub fn new(name: &'static str, material: Material) -> Self {
        Self {
            name,
            material,
            inside: false,
            coat_normal: DVec3::Z,
            cos_o: 1.0,
        }
    }

    /// Seen at a cosine.
    pub fn at(&self, cos_o: f64) -> Self {
        let mut case = self.clone();
        case.cos_o = cos_o;
        case
    }

    /// With another roughness of the specular layer.
    pub fn roughness(&self, roughness: f32) -> Self {
        let mut case = self.clone();
        case.material.roughness = roughness;
        case
    }

    /// Seen from inside, or not.
    pub fn inside(&self, inside: bool) -> Self {
        let mut case = self.clone();
        case.inside = inside;
        case
    }

    pub fn is_solid(&self) -> bool {
        self.material.bounds_medium() && self.material.ior >= 1.0
    }

    /// In how many parts cells are cut along either side for quadrature: where a lobe ends inside of cells, at the
    /// horizon of a tilted coat, or wide at the cone of what is refracted, one rule for a cell is not enough.
    pub fn parts(&self) -> usize {
        let m = &self.material;
        let tilted = m.clearcoat > 0.0 && self.coat_normal != DVec3::Z;
        let refracts = self.is_solid() && m.transmission > 0.0;
        match (
            tilted,
            refracts && (m.roughness > 0.5 || m.anisotropy > 0.0),
        ) {
            (false, false) => 1,
            _ => 3,
        }
    }

    /// The index on the far side over that on the near one, as the shader takes it.
    pub fn eta(&self) -> f64 {
        let ior = f64::from(self.material.ior);
        if self.is_solid() && self.inside {
            1.0 / ior
        } else {
            ior
        }
    }

    /// What importance is multiplied by to give the radiance that passes to the far side.
    pub fn radiance_scale(&self) -> f64 {
        if self.is_solid() {
            1.0 / self.eta().powi(2)
        } else {
            1.0
        }
    }

    pub fn alpha(&self) -> [f64; 2] {
        let (alpha, stretch) = (self.material.roughness.powi(2), self.material.anisotropy);
        if stretch == 0.0 {
            return [f64::from(alpha); 2];
        }
        let along = alpha + (1.0 - alpha) * stretch.powi(2);
        [f64::from(along), f64::from(alpha.max(1e-4))]
    }

    pub fn wo(&self) -> DVec3 {
        let r = (1.0 - self.cos_o * self.cos_o).sqrt();
        let d = DVec3::new(r * AZIMUTH.cos(), r * AZIMUTH.sin(), self.cos_o);
        d.as_vec3().as_dvec3()
    }

    pub fn label(&self) -> String {
        let side = if self.inside { ", inside" } else { "" };
        format!(
            "{}, roughness {}, cos {}{side}",
            self.name, self.material.roughness, self.cos_o
        )
    }

    /// The kernels' inputs, as `bsdf_parameters` of shaders/material.wgsl makes them; the directions last.
    pub fn inputs(&self, tables: &BsdfTables, directions: &[[f32; 4]]) -> Vec<[f32; 4]> {
        let m = &self.material;
        let with = |v: Vec3, w| v.extend(w).to_array();
        let alpha = self.alpha().map(|a| a as f32);
        let [albedo, glass] = self.tables(tables).map(|n| n as f32);
        let thin = f32::from(!self.is_solid());
        let coat = self.coat_normal.as_vec3();
        let film = 1e-9 * m.iridescence_thickness[1];
        let head: [[f32; 4]; HEAD] = [
            with(m.base_color.truncate(), m.metallic),
            [m.roughness, alpha[0], alpha[1], self.eta() as f32],
            with(m.specular_color, m.specular),
            [albedo, glass, thin, m.transmission],
            with(m.diffuse_transmission_color, m.diffuse_transmission),
            with(coat, m.clearcoat),
            [m.clearcoat_roughness, m.sheen_roughness, 0.0, 0.0],
            with(m.sheen_color, 0.0),
            [m.iridescence, m.iridescence_ior, film, 0.0],
            with(self.wo().as_vec3(), 0.0),
        ];
        head.into_iter().chain(directions.iter().copied()).collect()
    }

    /// First numbers of the tables of its Fresnel term and of glass; the tables of the inside follow those of the
    /// outside.
    fn tables(&self, tables: &BsdfTables) -> [u32; 2] {
        let ior = self.material.ior;
        let next = if self.is_solid() && self.inside {
            super::bench::TABLE_SIZE
        } else {
            0
        };
        [tables.albedo(ior) + next, tables.glass(ior) + next]
    }

    /// Cells that resolve every lobe, with an edge at the horizon.
    pub fn grid(&self) -> SphereGrid {
        if self.material.anisotropy > 0.0 {
            return self.stretched_grid();
        }
        let spots = self.spots();
        let nu = |spot: &Spot| (1.0 - spot.direction.z, spot.nu_width.clamp(1e-9, 1.0));
        let start = AZIMUTH;
        let phi = |spot: &Spot| {
            let phi = spot.direction.y.atan2(spot.direction.x);
            (
                start + (phi - start).rem_euclid(2.0 * PI),
                spot.phi_width.clamp(1e-9, 3.0),
            )
        };
        let (above, below): (Vec<_>, Vec<_>) = spots.iter().map(nu).partition(|(nu, _)| *nu < 1.0);
        let tilted: Vec<_> = spots
            .iter()
            .filter(|s| s.direction.truncate().length() > 1e-6)
            .map(phi)
            .collect();
        let mut nu = clustered_about(0.0, 1.0, &above, 40);
        let rows = if self.material.transmits() { 36 } else { 4 };
        nu.extend(clustered_about(1.0, 2.0, &below, rows).into_iter().skip(1));
        SphereGrid {
            nu,
            phi: clustered_about(start, start + 2.0 * PI, &tilted, 48),
            axes: DMat3::IDENTITY,
        }
    }

    fn spots(&self) -> Vec<Spot> {
        let m = &self.material;
        let wo = self.wo();
        let alpha = self.alpha()[0];
        let mut spots = Vec::new();
        if m.specular > 0.0 || m.metallic > 0.0 {
            spots.push(reflection(wo, DVec3::Z, alpha));
        }
        if m.clearcoat > 0.0 {
            let alpha = f64::from(m.clearcoat_roughness.powi(2));
            spots.push(reflection(wo, self.coat_normal, alpha));
        }
        if m.transmission > 0.0 {
            spots.push(if self.is_solid() {
                refraction(wo, self.eta(), alpha)
            } else {
                let spot = reflection(wo, DVec3::Z, alpha);
                Spot {
                    direction: -wo,
                    ..spot
                }
            });
        }
        spots
    }

    /// Lobes that are narrow along y keep the y of their directions: the pole is along y, and the horizon an edge
    /// in azimuth.
    fn stretched_grid(&self) -> SphereGrid {
        let wo = self.wo();
        let [_, narrow] = self.alpha();
        let wide = self.alpha()[0].max(0.02);
        let mirror = DVec3::new(-wo.x, -wo.y, wo.z);
        let width = (narrow * self.cos_o).max(1e-6);
        let mut nu = vec![(1.0 - mirror.y, width)];
        let azimuth = |d: DVec3| d.x.atan2(d.z);
        let mut below = Vec::new();
        if self.material.transmission > 0.0 {
            let eta = if self.is_solid() { self.eta() } else { 1.0 };
            nu.push((1.0 + wo.y / eta, width));
            let phi = azimuth(DVec3::new(-wo.x / eta, 0.0, -1.0)).rem_euclid(2.0 * PI);
            below.push((phi, wide.min(1.0)));
        }
        let above = [(azimuth(mirror), wide.min(1.0))];
        let mut phi = clustered_about(-FRAC_PI_2, FRAC_PI_2, &above, 40);
        let columns = if below.is_empty() { 4 } else { 36 };
        phi.extend(
            clustered_about(FRAC_PI_2, 1.5 * PI, &below, columns)
                .into_iter()
                .skip(1),
        );
        SphereGrid {
            nu: clustered_about(0.0, 2.0, &nu, 72),
            phi,
            axes: DMat3::from_cols(DVec3::Z, DVec3::X, DVec3::Y),
        }
    }
}

/// The spread of half vectors, reflected about a normal.
fn reflection(wo: DVec3, normal: DVec3, alpha: f64) -> Spot {
    let direction = 2.0 * wo.dot(normal) * normal - wo;
    let sin = direction.truncate().length().max(1e-3);
    Spot {
        direction,
        nu_width: alpha * alpha + alpha * sin,
        // Tilting the half vector sideways turns a grazing reflection but little.
        phi_width: alpha * (direction.z.abs() + alpha) / sin,
    }
}

/// The spread of half vectors, refracted.
fn refraction(wo: DVec3, eta: f64, alpha: f64) -> Spot {
    let flat = -wo.truncate() / eta;
    let cos2 = 1.0 - flat.length_squared();
    if cos2 <= 0.0 {
        // Where something passes, because a microfacet leans back, it leaves near the horizon.
        let direction = flat.normalize().extend(-0.05).normalize();
        let width = alpha.max(0.02);
        return Spot {
            direction,
            nu_width: width,
            phi_width: width,
        };
    }
    let (cos, sin) = (cos2.sqrt(), flat.length().max(1e-3));
    let bend = (cos - wo.z / eta).abs();
    Spot {
        direction: flat.extend(-cos),
        nu_width: alpha * bend * (flat.length() / cos + alpha * bend),
        phi_width: alpha * (bend + alpha) / sin,
    }
}

/// Nothing but a Lambertian base.
pub fn diffuse() -> Case {
    Case::new(
        "diffuse",
        Material {
            base_color: Vec4::new(0.9, 0.5, 0.1, 1.0),
            metallic: 0.0,
            specular: 0.0,
            ..Material::default()
        },
    )
}

pub fn metal(color: [f32; 3]) -> Case {
    Case::new(
        "metal",
        Material {
            base_color: Vec3::from(color).extend(1.0),
            ..Material::default()
        },
    )
}

/// A dielectric of index 1.5 over a base.
pub fn layered(name: &'static str, color: [f32; 3]) -> Case {
    Case::new(
        name,
        Material {
            base_color: Vec3::from(color).extend(1.0),
            metallic: 0.0,
            ..Material::default()
        },
    )
}

/// White glass, solid or thin.
pub fn glass(ior: f32, solid: bool) -> Case {
    let name = if solid { "glass" } else { "thin glass" };
    let mut case = layered(name, [1.0; 3]);
    case.material.ior = ior;
    case.material.transmission = 1.0;
    case.material.solid = solid;
    case
}

/// A unit normal, not along an axis and not across wo, tilted by an angle.
pub fn tilted(angle: f64) -> DVec3 {
    let azimuth = 2.0_f64;
    let (sin, cos) = angle.sin_cos();
    DVec3::new(sin * azimuth.cos(), sin * azimuth.sin(), cos)
}
