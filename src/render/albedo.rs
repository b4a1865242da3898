//! Directional albedos of lobes, as `shaders/bsdf/albedo.wgsl` looks them up: how much of the light that arrives
//! a lobe sends on, by the cosine of its direction and the perceptual roughness.

use rayon::prelude::*;

use super::microfacets::{dielectric_weight, glass, reflection, schlick_weight, sheen};
use super::{spectrum, stretched};
use crate::host::Cache;
use crate::scene::{Features, Scene};

/// What the values follow from: tables that are kept between runs are those of the same program text.
const SOURCES: [&str; 3] = [
    include_str!("albedo.rs"),
    include_str!("microfacets.rs"),
    include_str!("stretched.rs"),
];

/// Values along a row, at cosines (i / (n - 1))⁴: what a smooth lobe loses it loses at cosines about its α.
const COSINES: usize = 64;
/// Rows, at roughnesses (j / (m - 1))².
const ROUGHNESSES: usize = 32;
/// Values of a table.
const SIZE: u32 = (COSINES * ROUGHNESSES) as u32;
/// Nodes of the quadrature along either side of the unit square.
const NODES: usize = 48;
/// The lowest cosine, in place of 0, where nothing is defined.
const GRAZING: f64 = 1e-6;

/// Tables and where they are. GGX and Schlick come first, then sheen if the scene has any, then for each index of
/// refraction the Fresnel weight from outside and, of what transmits, from inside, and both albedos of glass.
#[derive(Debug, Clone, Default)]
pub struct BsdfTables {
    /// All values.
    pub values: Vec<f32>,
    /// First value of the wavelengths.
    pub spectrum: u32,
    /// First value of the albedo of stretched lobes.
    pub stretched: u32,
    /// Index of refraction, whether anything of it transmits, its first value.
    indices: Vec<(f32, bool, u32)>,
}

impl BsdfTables {
    /// The tables that a scene's materials look up, integrated where `cache` does not hold them.
    pub fn new(scene: &Scene, features: &Features, cache: &Cache) -> Self {
        let mut tables = Self::default();
        if features.specular || features.clearcoat || features.sheen {
            tables.add(cache, "ggx", |alpha, mu, u| reflection(alpha, mu, u).0);
            tables.add(cache, "schlick", |alpha, mu, u| {
                let (weight, cos_h) = reflection(alpha, mu, u);
                weight * schlick_weight(cos_h)
            });
        }
        if features.sheen {
            tables.add(cache, "sheen", sheen);
        }
        for (eta, transmits) in indices(scene) {
            tables.add_index(cache, eta, transmits);
        }
        tables.spectrum = tables.values.len() as u32;
        if features.dispersion {
            tables.values.extend(spectrum::table());
        }
        tables.stretched = tables.values.len() as u32;
        if features.anisotropy {
            let table = kept(cache, "stretched", stretched::COUNT, stretched::table);
            tables.values.extend(table);
        }
        tables
    }

    /// First value of the Fresnel weight's table of an index; 0, which is never read, if there is none.
    pub fn albedo(&self, ior: f32) -> u32 {
        let found = self.indices.iter().find(|index| index.0 == ior);
        found.map_or(0, |index| index.2)
    }

    /// First value of the tables of glass of an index; as above.
    pub fn glass(&self, ior: f32) -> u32 {
        let found = self.indices.iter().find(|index| index.0 == ior && index.1);
        found.map_or(0, |index| index.2 + 2 * SIZE)
    }

    fn add_index(&mut self, cache: &Cache, ior: f32, transmits: bool) {
        let first = self.values.len() as u32;
        self.indices.push((ior, transmits, first));
        let outside = f64::from(ior);
        self.add_weight(cache, outside);
        if transmits {
            self.add_weight(cache, 1.0 / outside);
            for eta in [outside, 1.0 / outside] {
                let passing = |alpha, mu, u| glass(alpha, eta, mu, u);
                self.add(cache, &format!("glass {eta}"), passing);
            }
        }
    }

    /// Appends the Fresnel weight's table of a relative index.
    fn add_weight(&mut self, cache: &Cache, eta: f64) {
        self.add(cache, &format!("dielectric {eta}"), |alpha, mu, u| {
            let (weight, cos_h) = reflection(alpha, mu, u);
            weight * dielectric_weight(cos_h, eta)
        });
    }

    /// Appends the table called `name`, of the means of `integrand(alpha, cosine, u)` over u.
    fn add(
        &mut self,
        cache: &Cache,
        name: &str,
        integrand: impl Fn(f64, f64, [f64; 2]) -> f64 + Sync,
    ) {
        let table = kept(cache, name, SIZE as usize, || integrate(integrand));
        self.values.extend(table);
    }
}

/// The table of `count` values called `name`, from an earlier run or made now.
fn kept(cache: &Cache, name: &str, count: usize, make: impl FnOnce() -> Vec<f32>) -> Vec<f32> {
    let mut hasher = blake3::Hasher::new();
    for text in SOURCES.into_iter().chain([name]) {
        hasher.update(&(text.len() as u64).to_le_bytes());
        hasher.update(text.as_bytes());
    }
    let key = hasher.finalize().into();
    let known = cache.get("albedo", &key);
    if let Some(bytes) = known.filter(|bytes| bytes.len() == count * size_of::<f32>()) {
        return bytemuck::pod_collect_to_vec(&bytes);
    }
    let table = make();
    cache.put("albedo", &key, bytemuck::cast_slice(&table));
    table
}

/// The means of `integrand(alpha, cosine, u)` over u, which does not tell left from right.
fn integrate(integrand: impl Fn(f64, f64, [f64; 2]) -> f64 + Sync) -> Vec<f32> {
    let nodes = gauss_legendre(NODES);
    let mean = |(roughness, cos): (f64, f64)| {
        let alpha = roughness * roughness;
        let row = |u: f64| -> f64 {
            let at = |(v, weight): &(f64, f64)| weight * integrand(alpha, cos, [u, *v]);
            nodes.iter().map(at).sum()
        };
        nodes
            .iter()
            .map(|(u, weight)| weight * row(0.5 * u))
            .sum::<f64>() as f32
    };
    let place = |i: usize| {
        let row = (i / COSINES) as f64 / (ROUGHNESSES - 1) as f64;
        let column = (i % COSINES) as f64 / (COSINES - 1) as f64;
        (row.powi(2), column.powi(4).max(GRAZING))
    };
    let all = (0..SIZE as usize).into_par_iter();
    all.map(|i| mean(place(i))).collect()
}

/// The indices of refraction of dielectric layers in use, and whether light passes any that has it.
fn indices(scene: &Scene) -> Vec<(f32, bool)> {
    let mut list: Vec<(f32, bool)> = Vec::new();
    for instance in &scene.instances {
        let material = &scene.materials[scene.meshes[instance.mesh].material];
        let dielectric = material.metallic < 1.0 || material.metallic_roughness_texture.is_some();
        let transmits = material.transmission > 0.0 || material.bounds_medium();
        if material.unlit || !dielectric || material.ior == 0.0 {
            continue;
        }
        if material.specular == 0.0 && !transmits {
            continue;
        }
        match list.iter_mut().find(|(ior, _)| *ior == material.ior) {
            Some(known) => known.1 |= transmits,
            None => list.push((material.ior, transmits)),
        }
    }
    list
}

/// Nodes and weights of Gauss-Legendre quadrature on [0, 1] (Newton's method on the Legendre polynomial).
fn gauss_legendre(n: usize) -> Vec<(f64, f64)> {
    let node = |i: usize| {
        let mut x = (std::f64::consts::PI * (i as f64 + 0.75) / (n as f64 + 0.5)).cos();
        let mut derivative = 1.0;
        for _ in 0..100 {
            let (mut previous, mut value) = (1.0, x);
            for k in 2..=n {
                let k = k as f64;
                (previous, value) = (
                    value,
                    ((2.0 * k - 1.0) * x * value - (k - 1.0) * previous) / k,
                );
            }
            derivative = n as f64 * (x * value - previous) / (x * x - 1.0);
            let step = value / derivative;
            x -= step;
            if step.abs() < 1e-15 {
                break;
            }
        }
        (
            0.5 * (x + 1.0),
            1.0 / ((1.0 - x * x) * derivative * derivative),
        )
    };
    (0..n).map(node).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_is_made_once() {
        let folder = tempfile::tempdir().expect("a folder");
        let cache = Cache::in_folder(folder.path());
        let made = kept(&cache, "a", 3, || vec![0.1, -0.0, f32::MIN_POSITIVE]);
        let again = kept(&cache, "a", 3, || panic!("it is known"));
        let bits = |table: &[f32]| table.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&made), bits(&again));
        assert_eq!(kept(&cache, "b", 1, || vec![2.0]), [2.0]);
        // Another size is another table.
        assert_eq!(kept(&cache, "a", 2, || vec![4.0, 5.0]), [4.0, 5.0]);
    }
}
