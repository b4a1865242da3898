//! Do the shader's structs lie in memory as the host writes them?

use std::ops::Range;

use naga::{Handle, Module, StructMember, Type, TypeInner};

use super::ShaderError;
use super::diagnostic::{Diagnostic, Severity};
use super::naga_report::{Reporter, words};

/// A struct as the host lays it out.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StructLayout {
    /// The struct's name in WGSL.
    pub name: &'static str,
    /// Bytes; also the stride of an array of it.
    pub size: usize,
    /// Its fields, in order.
    pub fields: Vec<FieldLayout>,
}

/// A field of a [`StructLayout`].
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FieldLayout {
    /// The field's name in WGSL.
    pub name: &'static str,
    /// Bytes from the beginning of the struct.
    pub offset: usize,
    /// Bytes, without padding behind it.
    pub size: usize,
}

/// A difference: what it is, and the field that it is about (none: the struct itself).
struct Mismatch {
    text: String,
    field: Option<String>,
}

/// Compares every struct of the module that the host knows by name. A host struct that the module
/// does not have is not used there: [`super::Binding::element`] tells what each buffer holds.
pub(super) fn check(
    module: &Module,
    layouts: &[StructLayout],
    report: Reporter<'_>,
) -> Result<(), ShaderError> {
    for (handle, ty) in module.types.iter() {
        let layout = layouts.iter().find(|l| Some(l.name) == ty.name.as_deref());
        let Some(layout) = layout else { continue };
        let mismatches = compare(module, ty, layout);
        if !mismatches.is_empty() {
            let diagnostic = describe(module, handle, layout, &mismatches, report);
            return Err(ShaderError::Layout(Box::new(diagnostic)));
        }
    }
    Ok(())
}

fn compare(module: &Module, ty: &Type, layout: &StructLayout) -> Vec<Mismatch> {
    let TypeInner::Struct { members, span } = &ty.inner else {
        let text = format!("`{}` is not a struct", layout.name);
        return vec![Mismatch { text, field: None }];
    };
    let mut mismatches = compare_names(members, layout);
    if mismatches.is_empty() {
        let pairs = members.iter().zip(&layout.fields);
        mismatches = pairs
            .flat_map(|(m, f)| compare_field(module, m, f))
            .collect();
    }
    let text = format!(
        "its size (and array stride) is {span} bytes, the host has {}",
        layout.size
    );
    if *span as usize != layout.size {
        mismatches.push(Mismatch { text, field: None });
    }
    mismatches
}

/// The first place where the two lists of names part, if any.
fn compare_names(members: &[StructMember], layout: &StructLayout) -> Vec<Mismatch> {
    let shader = |i: usize| {
        members
            .get(i)
            .map(|m| m.name.as_deref().unwrap_or_default())
    };
    let host = |i: usize| layout.fields.get(i).map(|f| f.name);
    let count = members.len().max(layout.fields.len());
    let Some(i) = (0..count).find(|i| shader(*i) != host(*i)) else {
        return Vec::new();
    };
    let number = i + 1;
    let text = match (shader(i), host(i)) {
        (Some(s), Some(h)) => format!("field {number} is `{s}`, the host has `{h}`"),
        (Some(s), None) => format!("field {number} is `{s}`, the host has no more fields"),
        (None, h) => format!(
            "field {number} is missing, the host has `{}`",
            h.unwrap_or_default()
        ),
    };
    let field = shader(i).map(str::to_owned);
    vec![Mismatch { text, field }]
}

fn compare_field(module: &Module, member: &StructMember, field: &FieldLayout) -> Vec<Mismatch> {
    let size = module.types[member.ty].inner.try_size(module.to_ctx());
    let mismatch = |what: &str, found: usize, expected: usize| {
        let name = field.name;
        let text = format!("field `{name}` has {what} {found}, the host has {expected}");
        (found != expected).then(|| Mismatch {
            text,
            field: Some(name.to_owned()),
        })
    };
    let offset = mismatch("offset", member.offset as usize, field.offset);
    let size = size.and_then(|s| mismatch("size", s as usize, field.size));
    offset.into_iter().chain(size).collect()
}

fn describe(
    module: &Module,
    handle: Handle<Type>,
    layout: &StructLayout,
    mismatches: &[Mismatch],
    report: Reporter<'_>,
) -> Diagnostic {
    let declaration = declaration(module, handle, layout.name, report);
    let first = mismatches.first().map_or("", |m| m.text.as_str());
    let message = format!("struct `{}` differs from the host's: {first}", layout.name);
    let mut diagnostic = report.plain(Severity::Error, message);
    for mismatch in mismatches {
        let field = mismatch.field.as_deref();
        let place = field.and_then(|f| field_place(report.text(), &declaration, f));
        let place = place.unwrap_or_else(|| name_place(report.text(), &declaration, layout.name));
        diagnostic = diagnostic.label(report.place(place), mismatch.text.as_str());
    }
    diagnostic.note("the host's structs are in src/render/layout/")
}

/// The bytes from the struct's name to its closing brace.
fn declaration(
    module: &Module,
    handle: Handle<Type>,
    name: &str,
    report: Reporter<'_>,
) -> Range<usize> {
    let declared = module.types.get_span(handle).to_range();
    let declared = declared
        .or_else(|| report.find_declaration("struct", name))
        .unwrap_or(0..0);
    let close = report.text()[declared.start..]
        .find('}')
        .map(|i| declared.start + i);
    declared.start..close.unwrap_or(declared.end).max(declared.end)
}

fn name_place(text: &str, declaration: &Range<usize>, name: &str) -> Range<usize> {
    let inside = words(&text[declaration.clone()], name);
    let found = inside.into_iter().next();
    found.map_or(declaration.clone(), |r| shift(&r, declaration.start))
}

fn field_place(text: &str, declaration: &Range<usize>, field: &str) -> Option<Range<usize>> {
    let inside = &text[declaration.clone()];
    let places = words(inside, field).into_iter();
    let mut places = places.filter(|r| inside[r.end..].trim_start().starts_with(':'));
    Some(shift(&places.next()?, declaration.start))
}

fn shift(range: &Range<usize>, by: usize) -> Range<usize> {
    range.start + by..range.end + by
}
