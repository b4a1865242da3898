//! A scene's summary as aligned text.
//!
//! Names come from the file and are shown quoted and escaped, so that none of them disturbs a
//! terminal.

use super::bvh_report::InstancingReport;
use super::info::Built;
use crate::scene::{FeatureReason, Summary};

/// Rows of cells, to be aligned.
type Rows = Vec<Vec<String>>;

/// The whole text.
pub fn describe(summary: &Summary, instancing: &InstancingReport, built: Option<&Built>) -> String {
    let mut text = overview(summary, instancing);
    text += &table(
        "acceleration structure",
        built.map_or(vec![], |built| built.bvh.rows()),
    );
    text += &table(
        "choice of a light",
        built.map_or(vec![], |built| built.light_selection.rows()),
    );
    text += &table("animations", animations(summary));
    text += &table("variants of materials", variants(summary));
    text += &table("cameras", cameras(summary));
    text += &table("lights", lights(summary));
    text += &table("materials", materials(summary));
    text += &table("textures", textures(summary));
    text += &table("extensions", extensions(summary));
    text += &table("features of the shader", features(summary));
    text += &table("warnings", sentences(&summary.warnings));
    text += &table("notes", sentences(&summary.notes));
    text
}

fn overview(s: &Summary, instancing: &InstancingReport) -> String {
    let scene = match s.scenes.get(s.scene_index) {
        Some(name) => format!("{} {name:?} of {}", s.scene_index, s.scenes.len()),
        None => "the file names none: all of it".into(),
    };
    let bounds = s.bounds.map_or("nothing to see".into(), |[low, high]| {
        format!("{} to {} m", point(low), point(high))
    });
    let shared = |all: u64, unique: u64| match all == unique {
        true => all.to_string(),
        false => format!("{all} ({unique} in memory)"),
    };
    let row = |name: &str, value: String| vec![name.to_owned(), value];
    let rows = vec![
        row("scene", scene),
        row("triangles", shared(s.triangles, s.unique_triangles)),
        row("vertices", s.unique_vertices.to_string()),
        row(
            "meshes",
            format!("{}, placed {} times", s.meshes, s.instances),
        ),
        row("instances", instancing.describe()),
        row("bounds", bounds),
        row("BLAKE3", s.hash.clone()),
    ];
    format!("{}\n{}", s.source, align(rows))
}

fn variants(s: &Summary) -> Rows {
    let row = |(i, name): (usize, &String)| vec![i.to_string(), quoted(name)];
    s.variants.iter().enumerate().map(row).collect()
}

fn animations(s: &Summary) -> Rows {
    let row = |(i, name): (usize, &String)| {
        let moment = s.animation_seconds.filter(|_| s.animation_index == Some(i));
        let shown = moment.map_or(String::new(), |seconds| format!("shown at {seconds} s"));
        vec![i.to_string(), quoted(name), shown]
    };
    s.animations.iter().enumerate().map(row).collect()
}

fn cameras(s: &Summary) -> Rows {
    let row = |(i, c): (usize, &crate::scene::summary::CameraSummary)| {
        let view = c
            .yfov_degrees
            .map_or(String::new(), |yfov| format!("{yfov:.1}° high"));
        let aspect = c
            .aspect
            .map_or(String::new(), |aspect| format!("aspect {aspect:.3}"));
        let place = format!("at {}", point(c.position));
        vec![
            i.to_string(),
            quoted(&c.name),
            c.kind.into(),
            view,
            aspect,
            place,
        ]
    };
    s.cameras.iter().enumerate().map(row).collect()
}

fn lights(s: &Summary) -> Rows {
    let row = |(i, l): (usize, &crate::scene::summary::LightSummary)| {
        let [r, g, b] = l.intensity;
        let unit = match l.kind {
            "directional" => "lx",
            _ => "cd",
        };
        let intensity = format!("{r} {g} {b} {unit}");
        vec![i.to_string(), quoted(&l.name), l.kind.into(), intensity]
    };
    s.lights.iter().enumerate().map(row).collect()
}

fn materials(s: &Summary) -> Rows {
    let row = |(i, m): (usize, &crate::scene::summary::MaterialSummary)| {
        let mut about = m.textures.join(", ");
        if !m.used {
            about = "unused".into();
        }
        vec![i.to_string(), quoted(&m.name), about]
    };
    s.materials.iter().enumerate().map(row).collect()
}

fn textures(s: &Summary) -> Rows {
    let row = |(i, t): (usize, &crate::scene::summary::TextureSummary)| {
        let [u, v] = t.wrap;
        let wrap = match u == v {
            true => u.to_owned(),
            false => format!("{u}/{v}"),
        };
        vec![
            i.to_string(),
            quoted(&t.image),
            format!("{}x{}", t.width, t.height),
            format!("{} bits", t.bits),
            wrap,
            t.filter.into(),
        ]
    };
    s.textures.iter().enumerate().map(row).collect()
}

fn extensions(s: &Summary) -> Rows {
    let row = |e: &crate::scene::summary::ExtensionSummary| {
        let supported = match e.supported {
            true => "supported",
            false => "not supported",
        };
        let required = match e.required {
            true => "required",
            false => "optional",
        };
        vec![printable(&e.name), supported.into(), required.into()]
    };
    s.extensions.iter().map(row).collect()
}

fn features(s: &Summary) -> Rows {
    let each = s.features.iter();
    let bytes = |f: &FeatureReason| match f.bytes {
        0 => "-".into(),
        bytes => format!("{bytes} B"),
    };
    each.map(|f| vec![f.feature.into(), printable(&f.reason), bytes(f)])
        .collect()
}

fn sentences(list: &[String]) -> Rows {
    list.iter().map(|line| vec![printable(line)]).collect()
}

fn quoted(name: &str) -> String {
    match name.is_empty() {
        true => "-".into(),
        false => format!("{name:?}"),
    }
}

fn printable(text: &str) -> String {
    text.chars()
        .map(|c| if c.is_control() { '\u{fffd}' } else { c })
        .collect()
}

fn point([x, y, z]: [f64; 3]) -> String {
    format!("({}, {}, {})", short(x), short(y), short(z))
}

/// Five significant digits.
fn short(x: f64) -> String {
    let magnitude = x.abs();
    if magnitude != 0.0 && !(1e-4..1e6).contains(&magnitude) {
        return format!("{x:.4e}");
    }
    let digits = 4_usize.saturating_sub(magnitude.max(1.0).log10().floor() as usize);
    let text = format!("{x:.digits$}");
    match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => text,
    }
}

/// A title and rows, or nothing without rows.
fn table(title: &str, rows: Rows) -> String {
    match rows.is_empty() {
        true => String::new(),
        false => format!("\n{title}\n{}", align(rows)),
    }
}

/// Cells in columns; the last cell of a row takes what it needs.
fn align(rows: Rows) -> String {
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0);
    let width = |column: usize| {
        let cells = rows.iter().filter_map(|row| row.get(column));
        cells.map(|cell| cell.chars().count()).max().unwrap_or(0)
    };
    let widths: Vec<usize> = (0..columns).map(width).collect();
    let line = |row: &Vec<String>| {
        let cells = row.iter().zip(&widths);
        let padded: Vec<String> = cells.map(|(cell, &w)| format!("{cell:<w$}")).collect();
        format!("  {}\n", padded.join("  ").trim_end())
    };
    rows.iter().map(line).collect()
}

/// A number of bytes for people: 1536 is "1.5 KiB".
pub fn bytes(count: u64) -> String {
    const UNITS: [&str; 7] = ["bytes", "KiB", "MiB", "GiB", "TiB", "PiB", "EiB"];
    let power = (count.max(1).ilog2() / 10) as usize;
    match power {
        0 => format!("{count} bytes"),
        _ => format!(
            "{:.1} {}",
            count as f64 / 1024_f64.powi(power as i32),
            UNITS[power]
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        assert_eq!(short(0.0), "0");
        assert_eq!(short(-1.5), "-1.5");
        assert_eq!(short(123_456.7), "123457");
        assert_eq!(short(12_345.67), "12346");
        assert_eq!(short(1e-7), "1.0000e-7");
        assert_eq!(short(10.0), "10");
        assert_eq!(bytes(1536), "1.5 KiB");
        assert_eq!(bytes(u64::MAX), "16.0 EiB");
    }

    #[test]
    fn columns_are_aligned() {
        let row = |a: &str, b: &str| vec![a.to_owned(), b.to_owned()];
        let text = table("t", vec![row("a", "x"), row("long", "")]);
        assert_eq!(text, "\nt\n  a     x\n  long\n");
        assert_eq!(table("t", Vec::new()), "");
    }
}
