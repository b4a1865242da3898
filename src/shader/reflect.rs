//! What an entry point binds.

use serde::{Deserialize, Serialize};

use naga::{
    AddressSpace, GlobalVariable, Handle, ImageClass, ImageDimension, Module, StorageAccess,
    StorageFormat, Type, TypeInner,
};

use super::ShaderError;
use super::naga_report::Reporter;

/// A buffer that an entry point uses.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Binding {
    /// Descriptor set.
    pub group: u32,
    /// Binding in the set.
    pub binding: u32,
    /// The variable's name in the shader.
    pub name: String,
    /// How it is bound.
    pub kind: BindingKind,
    /// The struct that it holds, or whose array it holds; none for other types.
    pub element: Option<String>,
}

/// How a buffer is bound.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum BindingKind {
    /// A storage buffer that the shader only reads.
    StorageRead,
    /// A storage buffer that the shader may write.
    StorageReadWrite,
    /// A uniform buffer.
    Uniform,
    /// A texel buffer: in the shader a storage texture of one dimension, read-only, with texels of so many 32-bit words.
    Texels {
        /// 1, 2 or 4.
        words: u8,
    },
}

/// The bindings of a module reduced to one entry point, sorted by group and binding.
pub(super) fn bindings(module: &Module, report: Reporter<'_>) -> Result<Vec<Binding>, ShaderError> {
    let mut bindings = Vec::new();
    for (handle, variable) in module.global_variables.iter() {
        bindings.extend(reflect(module, handle, variable, report)?);
    }
    bindings.sort_by_key(|b| (b.group, b.binding));
    Ok(bindings)
}

fn reflect(
    module: &Module,
    handle: Handle<GlobalVariable>,
    variable: &GlobalVariable,
    report: Reporter<'_>,
) -> Result<Option<Binding>, ShaderError> {
    let name = variable.name.clone().unwrap_or_default();
    let refused = |message: String| {
        let place = module.global_variables.get_span(handle).to_range();
        let diagnostic = report.at(message, place.unwrap_or(0..0));
        ShaderError::Validation(Box::new(diagnostic))
    };
    let kind = match variable.space {
        AddressSpace::Private | AddressSpace::WorkGroup | AddressSpace::Function => {
            return Ok(None);
        }
        AddressSpace::Uniform => BindingKind::Uniform,
        AddressSpace::Storage { access } if access.contains(StorageAccess::STORE) => {
            BindingKind::StorageReadWrite
        }
        AddressSpace::Storage { .. } => BindingKind::StorageRead,
        _ => match texel_words(&module.types[variable.ty].inner) {
            Some(words) => BindingKind::Texels { words },
            None => {
                let message = format!(
                    "`{name}`: only storage and uniform buffers can be bound, and texels of unsigned integers \
                     (texture_storage_1d<rgba32uint, read>, rg32uint or r32uint)"
                );
                return Err(refused(message));
            }
        },
    };
    if let Some(at) = variable.binding.filter(|at| at.group != 0) {
        let group = at.group;
        let message = format!("`{name}` is in group {group}: all bindings are in group 0");
        return Err(refused(message));
    }
    Ok(variable.binding.map(|at| Binding {
        group: at.group,
        binding: at.binding,
        name,
        kind,
        element: element(module, variable.ty),
    }))
}

/// Words of a texel of what is bound as a texel buffer; none if the type is another.
fn texel_words(inner: &TypeInner) -> Option<u8> {
    let TypeInner::Image {
        dim: ImageDimension::D1,
        arrayed: false,
        class: ImageClass::Storage { format, access },
    } = inner
    else {
        return None;
    };
    if *access != StorageAccess::LOAD {
        return None;
    }
    match format {
        StorageFormat::R32Uint => Some(1),
        StorageFormat::Rg32Uint => Some(2),
        StorageFormat::Rgba32Uint => Some(4),
        _ => None,
    }
}

fn element(module: &Module, ty: Handle<Type>) -> Option<String> {
    match &module.types[ty] {
        Type {
            name,
            inner: TypeInner::Struct { .. },
        } => name.clone(),
        Type {
            inner: TypeInner::Array { base, .. },
            ..
        } => element(module, *base),
        _ => None,
    }
}
