//! What a scene requires of the shader, and which of its objects asks for it.

use glam::{Mat2, Vec2, Vec3};
use serde::Serialize;

use super::feature_bytes;
use super::{
    AlphaMode, Filter, LightKind, Material, Mesh, Projection, Scene, Texels, Texture, TextureSlot,
    Wrap,
};

/// Why a feature is compiled in.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct FeatureReason {
    /// Name of the field of [`Features`].
    pub feature: &'static str,
    /// The first object that asks for it.
    pub reason: String,
    /// Bytes on the device that are there for its sake, instances not shared.
    pub bytes: u64,
}

/// The reason of a feature that the scene does not need.
const ASKED_FOR: &str = "asked for by name";

/// Set a feature; the first reason stays.
macro_rules! need {
    ($features:expr, $name:ident if $condition:expr, $reason:expr) => {
        if $condition && !$features.$name {
            $features.$name = true;
            $features.reasons.push(FeatureReason {
                feature: stringify!($name),
                reason: $reason.to_string(),
                bytes: 0,
            });
        }
    };
}

macro_rules! features {
    ($($(#[$doc:meta])* $name:ident,)*) => {
        /// What the shader must be able to do to render a scene. Only materials that triangles use count.
        #[derive(Debug, Clone, Default, PartialEq, Eq, Serialize)]
        pub struct Features {
            $($(#[$doc])* pub $name: bool,)*
            /// One for each feature that is set, in the order in which they were found.
            #[serde(skip)]
            pub reasons: Vec<FeatureReason>,
        }

        impl Features {
            /// Every feature with its name, in the order of declaration.
            pub fn flags(&self) -> Vec<(&'static str, bool)> {
                vec![$((stringify!($name), self.$name),)*]
            }

            /// Everything at once.
            pub fn all() -> Self {
                Self { $($name: true,)* reasons: Vec::new() }
            }

            /// Compiles one in, whether the scene needs it or not; false if there is none of that name.
            fn require(&mut self, name: &str) -> bool {
                match name {
                    $(stringify!($name) => {
                        need!(self, $name if true, ASKED_FOR);
                        true
                    })*
                    _ => false,
                }
            }
        }
    };
}

features! {
    /// A base colour texture.
    base_color_texture,
    /// A metallic-roughness texture.
    metallic_roughness_texture,
    /// A normal map on a mesh that has tangents.
    normal_texture,
    /// An emission texture.
    emissive_texture,
    /// A texture of the specular strength.
    specular_texture,
    /// A texture of the specular colour.
    specular_color_texture,
    /// A texture of the transmission.
    transmission_texture,
    /// A texture of the diffuse transmission or its colour.
    diffuse_transmission_texture,
    /// A texture of the clear coat or its roughness.
    clearcoat_texture,
    /// A normal map of a clear coat on a mesh that has tangents.
    clearcoat_normal_texture,
    /// A texture of the sheen's colour or roughness.
    sheen_texture,
    /// A texture of the anisotropy on a mesh that has tangents.
    anisotropy_texture,
    /// A texture of the iridescence or the film's thickness.
    iridescence_texture,
    /// A texture whose alpha multiplies the glossiness.
    glossiness_texture,
    /// A texture slot with a transform other than the identity.
    texture_transform,
    /// A sampler that clamps to the edge.
    wrap_clamp,
    /// A sampler that mirrors.
    wrap_mirror,
    /// A sampler that repeats.
    wrap_repeat,
    /// A sampler that takes the nearest texel.
    filter_nearest,
    /// A sampler that blends four texels.
    filter_linear,
    /// An image with 8 bits a channel.
    texels_8,
    /// An image with 16 bits a channel.
    texels_16,
    /// A mesh with shading normals.
    normals,
    /// A mesh without: its triangles are flat.
    flat_normals,
    /// A mesh with tangents.
    tangents,
    /// A mesh with the first set of texture coordinates.
    uv0,
    /// A mesh with the second set of texture coordinates.
    uv1,
    /// A mesh with vertex colours.
    colors,
    /// A surface with holes where alpha is below a cutoff.
    alpha_mask,
    /// A surface that covers a fraction.
    alpha_blend,
    /// A surface that is not double-sided.
    single_sided,
    /// A surface that is double-sided.
    double_sided,
    /// A surface that shows its base colour without lighting.
    unlit,
    /// A lit surface: some light is reflected.
    lit,
    /// A diffuse lobe: a lit surface that is not wholly metallic.
    diffuse,
    /// A specular lobe: a lit surface that is metallic, or whose specular strength is not 0.
    specular,
    /// A lit surface that is at least partly metallic.
    metallic,
    /// A lobe of specular transmission.
    transmission,
    /// A lobe of diffuse transmission.
    diffuse_transmission,
    /// A clear coat.
    clearcoat,
    /// A sheen.
    sheen,
    /// A specular lobe that is stretched along tangents.
    anisotropy,
    /// A specular layer under a thin film.
    iridescence,
    /// A transmitting surface that bounds a solid.
    media,
    /// A solid that absorbs light.
    absorption,
    /// A solid whose index of refraction depends on the wavelength.
    dispersion,
    /// A dielectric specular lobe with an index of refraction other than 1.5.
    ior,
    /// A surface that emits.
    emissive,
    /// A point light.
    point_light,
    /// A spot light.
    spot_light,
    /// A directional light.
    directional_light,
    /// A light with a finite range.
    light_range,
    /// Light from infinitely far away.
    environment,
    /// An equirectangular picture of it.
    environment_image,
    /// A camera with a lens of some size.
    lens,
    /// A panorama camera.
    panorama,
}

impl Features {
    /// What `scene` requires.
    pub fn of(scene: &Scene) -> Self {
        let mut features = Self::default();
        let mut seen = vec![false; scene.materials.len()];
        let shown = scene
            .instances
            .iter()
            .map(|instance| &scene.meshes[instance.mesh]);
        for mesh in shown.filter(|mesh| !mesh.indices.is_empty()) {
            let material = &scene.materials[mesh.material];
            let label = label("material", mesh.material, &material.name);
            features.add_mesh(mesh, material, &label);
            if !std::mem::replace(&mut seen[mesh.material], true) {
                features.add_surface(material, &label);
                features.add_textures(scene, material, &label);
            }
        }
        features.add_lights(scene);
        features.add_cameras(scene);
        // The two kinds of environment exclude each other.
        let is_constant = scene
            .environment
            .as_ref()
            .is_some_and(|e| e.image.is_none());
        for name in &scene.required_features {
            if name != "environment_image" || !is_constant {
                features.require(name);
            }
        }
        for reason in &mut features.reasons {
            reason.bytes = feature_bytes::of(scene, reason.feature);
        }
        features
    }

    /// Whether a feature that the scene does not need was asked for.
    pub fn is_asked_for(&self, name: &str) -> bool {
        let mut reasons = self.reasons.iter();
        reasons.any(|r| r.feature == name && r.reason == ASKED_FOR)
    }

    /// The names of all features.
    pub fn names() -> Vec<&'static str> {
        Self::default()
            .flags()
            .into_iter()
            .map(|(name, _)| name)
            .collect()
    }

    fn add_mesh(&mut self, mesh: &Mesh, material: &Material, label: &str) {
        let name = format!("mesh {:?}", mesh.name);
        let has_tangents = !mesh.tangents.is_empty();
        let tangents = has_tangents && material.reads_tangents();
        let normal_map = has_tangents && material.normal_texture.is_some();
        let coat_map = has_tangents && material.clearcoat_normal_texture.is_some();
        let stretched = has_tangents && material.anisotropy > 0.0;
        need!(self, normals if !mesh.normals.is_empty(), name);
        need!(self, flat_normals if mesh.normals.is_empty(), name);
        need!(self, tangents if tangents, name);
        need!(self, normal_texture if normal_map, label);
        need!(self, clearcoat_normal_texture if coat_map, label);
        need!(self, anisotropy if stretched, label);
        need!(self, anisotropy_texture if stretched && material.anisotropy_texture.is_some(), label);
        need!(self, uv0 if !mesh.tex_coords[0].is_empty(), name);
        need!(self, uv1 if !mesh.tex_coords[1].is_empty(), name);
        need!(self, colors if !mesh.colors.is_empty(), name);
        let varies = material.base_color_texture.is_some() || !mesh.colors.is_empty();
        let alpha = material.base_color.w;
        match material.alpha_mode {
            AlphaMode::Opaque => {}
            AlphaMode::Mask { cutoff } => {
                need!(self, alpha_mask if varies || alpha < cutoff, label);
            }
            AlphaMode::Blend => need!(self, alpha_blend if varies || alpha < 1.0, label),
        }
    }

    fn add_surface(&mut self, material: &Material, label: &str) {
        let lit = !material.unlit;
        let metallic = lit && material.metallic > 0.0;
        let varies = material.metallic_roughness_texture.is_some();
        let dielectric = lit && (material.metallic < 1.0 || varies);
        let glossy = dielectric && material.specular > 0.0;
        need!(self, single_sided if !material.double_sided, label);
        need!(self, double_sided if material.double_sided, label);
        need!(self, unlit if material.unlit, label);
        need!(self, lit if lit, label);
        need!(self, diffuse if dielectric, label);
        need!(self, metallic if metallic, label);
        need!(self, specular if metallic || glossy, label);
        need!(self, ior if glossy && material.ior != 1.5, label);
        self.add_lobes(material, dielectric, metallic || glossy, label);
        need!(self, emissive if lit && material.emissive != Vec3::ZERO, label);
    }

    /// The lobes of extensions: a factor of 0 counts as absent.
    fn add_lobes(&mut self, material: &Material, dielectric: bool, specular: bool, label: &str) {
        let transmits = dielectric && material.transmission > 0.0;
        let solid = dielectric && material.bounds_medium();
        // What passes is refracted, also where nothing is reflected.
        need!(self, specular if transmits, label);
        need!(self, transmission if transmits, label);
        need!(self, diffuse_transmission if dielectric && material.diffuse_transmission > 0.0, label);
        need!(self, clearcoat if material.clearcoat > 0.0, label);
        need!(self, sheen if material.sheen_color != Vec3::ZERO, label);
        need!(self, iridescence if specular && material.iridescence > 0.0, label);
        need!(self, media if solid, label);
        need!(self, absorption if solid && material.absorption != Vec3::ZERO, label);
        need!(self, dispersion if solid && material.dispersion > 0.0, label);
    }

    fn add_textures(&mut self, scene: &Scene, material: &Material, label: &str) {
        need!(self, base_color_texture if material.base_color_texture.is_some(), label);
        need!(self, metallic_roughness_texture if material.metallic_roughness_texture.is_some(), label);
        need!(self, emissive_texture if material.emissive_texture.is_some(), label);
        need!(self, specular_texture if material.specular_texture.is_some(), label);
        need!(self, specular_color_texture if material.specular_color_texture.is_some(), label);
        let m = material;
        let translucence = [
            m.diffuse_transmission_texture,
            m.diffuse_transmission_color_texture,
        ];
        let coat = [m.clearcoat_texture, m.clearcoat_roughness_texture];
        let sheen = [m.sheen_color_texture, m.sheen_roughness_texture];
        let film = [m.iridescence_texture, m.iridescence_thickness_texture];
        let any = |slots: [Option<TextureSlot>; 2]| slots.iter().any(Option::is_some);
        need!(self, transmission_texture if m.transmission_texture.is_some(), label);
        need!(self, diffuse_transmission_texture if any(translucence), label);
        need!(self, clearcoat_texture if any(coat), label);
        need!(self, sheen_texture if any(sheen), label);
        need!(self, iridescence_texture if any(film), label);
        need!(self, glossiness_texture if m.glossiness_texture, label);
        for slot in material.texture_slots() {
            need!(self, texture_transform if !is_identity(slot), label);
            self.add_sampler(scene, &scene.textures[slot.texture], label);
        }
    }

    fn add_sampler(&mut self, scene: &Scene, texture: &Texture, label: &str) {
        let sampler = texture.sampler;
        for wrap in [sampler.wrap_u, sampler.wrap_v] {
            need!(self, wrap_clamp if wrap == Wrap::ClampToEdge, label);
            need!(self, wrap_mirror if wrap == Wrap::MirroredRepeat, label);
            need!(self, wrap_repeat if wrap == Wrap::Repeat, label);
        }
        need!(self, filter_nearest if sampler.filter == Filter::Nearest, label);
        need!(self, filter_linear if sampler.filter == Filter::Linear, label);
        let wide = matches!(scene.images[texture.image].texels, Texels::Rgba16(_));
        need!(self, texels_8 if !wide, label);
        need!(self, texels_16 if wide, label);
    }

    fn add_lights(&mut self, scene: &Scene) {
        for (index, light) in scene.lights.iter().enumerate() {
            if light.intensity == Vec3::ZERO {
                continue;
            }
            let label = label("light", index, &light.name);
            let directional = matches!(light.kind, LightKind::Directional);
            need!(self, point_light if matches!(light.kind, LightKind::Point), label);
            need!(self, spot_light if matches!(light.kind, LightKind::Spot { .. }), label);
            need!(self, directional_light if directional, label);
            need!(self, light_range if !directional && light.range.is_finite(), label);
        }
        let sky = scene.environment.as_ref();
        let sky = sky.filter(|sky| sky.radiance.iter().any(|&x| x != 0.0));
        need!(self, environment if sky.is_some(), "the environment");
        need!(self, environment_image if sky.is_some_and(|sky| sky.image.is_some()), "the environment");
    }
}

impl Features {
    fn add_cameras(&mut self, scene: &Scene) {
        for (index, camera) in scene.cameras.iter().enumerate() {
            let label = label("camera", index, &camera.name);
            need!(self, lens if camera.lens.is_some_and(|lens| lens.radius > 0.0), label);
            need!(self, panorama if camera.projection == Projection::Panorama, label);
        }
    }
}

fn label(kind: &str, index: usize, name: &str) -> String {
    match name {
        "" => format!("{kind} {index}"),
        _ => format!("{kind} {index} {name:?}"),
    }
}

fn is_identity(slot: &TextureSlot) -> bool {
    slot.offset == Vec2::ZERO && Mat2::from_cols(slot.matrix[0], slot.matrix[1]) == Mat2::IDENTITY
}
