//! White materials in a uniform sky: what they lose without multiple scattering, and that they neither lose nor gain
//! with it. The albedo is the mean weight of samples; 2¹⁷ of them tell it to about 5e-4.

use etendue::scene::Material;
use glam::Vec3;

use super::bench::Bench;
use super::case::{Case, glass, layered, metal};
use crate::common::Setup;

/// From smooth (single directions up to 0.0316) to rough.
const ROUGHNESSES: [f32; 7] = [0.02, 0.04, 0.07, 0.15, 0.35, 0.65, 1.0];
const COSINES: [f64; 6] = [1.0, 0.7, 0.4, 0.15, 0.05, 0.01];
const SAMPLES: u32 = 1 << 17;
/// Error of the tables' interpolation, largest at roughness 0.04 and grazing angles.
const TABLES: f64 = 2.5e-3;

/// The least and the largest albedo, of the brightest channel, over view; 3 standard errors are taken off the largest
/// and put on the least.
fn range(bench: &Bench, case: &Case) -> [f64; 2] {
    let mut range = [f64::INFINITY, 0.0];
    for cos_o in COSINES {
        let channels = bench.mean_weight(&case.at(cos_o), SAMPLES);
        let brightest = channels.into_iter().max_by(|a, b| a.0.total_cmp(&b.0));
        let (mean, error) = brightest.expect("three channels");
        range = [
            range[0].min(mean + 3.0 * error),
            f64::max(range[1], mean - 3.0 * error),
        ];
    }
    range
}

/// Prints a line of the table (for each of [`ROUGHNESSES`] the least and the largest albedo), and gives the range.
fn row(bench: &Bench, case: &Case) -> [f64; 2] {
    let ranges = ROUGHNESSES.map(|roughness| range(bench, &case.roughness(roughness)));
    let cells = ranges.map(|[low, high]| format!("{low:.4} {high:.4}"));
    let side = if case.inside { ", inside" } else { "" };
    println!("| {}{side} | {} |", case.name, cells.join(" | "));
    let low = ranges.iter().fold(f64::INFINITY, |a, r| a.min(r[0]));
    let high = ranges.iter().fold(0.0, |a: f64, r| a.max(r[1]));
    [low, high]
}

fn white(name: &'static str, change: impl FnOnce(&mut Material)) -> Case {
    let mut case = layered(name, [1.0; 3]);
    change(&mut case.material);
    case
}

/// White materials, the roughness of the specular layer left open.
fn stacks() -> Vec<Case> {
    let coat = |m: &mut Material| {
        m.clearcoat = 1.0;
        m.clearcoat_roughness = 0.3;
    };
    let mut coated_metal = metal([1.0; 3]);
    coated_metal.name = "coat over metal";
    coat(&mut coated_metal.material);
    vec![
        metal([1.0; 3]),
        layered("dielectric over white", [1.0; 3]),
        glass(1.5, false),
        glass(1.5, true),
        glass(1.5, true).inside(true),
        coated_metal,
        white("coat over white", coat),
        white("leaf", |m| m.diffuse_transmission = 0.5),
        white("half glass", |m| m.transmission = 0.5),
    ]
}

/// Within 1 % of 1.
#[test]
fn white_stays_white() {
    let bench = Bench::new(&Setup::new());
    for case in stacks() {
        let [low, high] = row(&bench, &case);
        assert!(low > 0.99, "{}: {low}", case.name);
        assert!(high < 1.0 + TABLES, "{}: {high}", case.name);
    }
}

/// Sheen of every roughness over white and by itself.
#[test]
fn sheen_over_white_stays_white() {
    let bench = Bench::new(&Setup::new());
    for roughness in [0.02_f32, 0.05, 0.1, 0.2, 0.4, 0.7, 1.0] {
        let over = |base: f32| {
            let case = white("sheen", |m| {
                m.specular = 0.0;
                m.base_color = Vec3::splat(base).extend(1.0);
                m.sheen_color = Vec3::ONE;
                m.sheen_roughness = roughness;
            });
            range(&bench, &case)
        };
        let ([low, high], [_, alone]) = (over(1.0), over(0.0));
        println!("sheen {roughness}: over white {low:.4} to {high:.4}, alone up to {alone:.4}");
        assert!(
            low > 0.99 && high < 1.0 + TABLES,
            "{roughness}: {low} {high}"
        );
        assert!(alone < 1.0 + TABLES, "{roughness}: {alone}");
    }
}

/// The base below a film gets what the film lets pass in the channel in which it reflects most, as
/// KHR_materials_iridescence says, so that other channels lose. Over rough surfaces the mean over microfacets of what
/// the film reflects is taken at one cosine, by which the whole is wrong by -2.8 % to +1.6 % (smooth ones: none).
#[test]
fn films_over_white() {
    let bench = Bench::new(&Setup::new());
    for thickness in [0.0, 200.0, 400.0, 800.0] {
        let case = white("film over white", |m| {
            m.iridescence = 1.0;
            m.iridescence_thickness = [0.0, thickness];
        });
        let [low, high] = row(&bench, &case);
        assert!(low > 0.97 && high < 1.017, "{thickness} nm: {low} {high}");
    }
}

/// The least and the largest albedo of a white material where light bounces only once between microfacets, over all
/// views from cosine 1 to 0.01. What a dielectric reflects too little its base gets, so that layers over a white base
/// lose nothing.
///
/// | roughness | 0.04 | 0.07 | 0.15 | 0.35 | 0.65 | 1 |
/// |---|---|---|---|---|---|---|
/// | metal | 0.985 1.000 | 0.915 1.000 | 0.921 0.999 | 0.880 0.981 | 0.744 0.977 | 0.307 0.954 |
/// | thin glass | 0.985 1.000 | 0.915 1.000 | 0.922 0.999 | 0.882 0.981 | 0.744 0.963 | 0.307 0.938 |
/// | glass | 0.985 1.000 | 0.919 1.000 | 0.936 1.000 | 0.934 0.997 | 0.871 0.977 | 0.719 0.901 |
/// | glass, inside | 0.985 1.000 | 0.915 1.000 | 0.918 1.000 | 0.860 0.982 | 0.696 0.811 | 0.418 0.574 |
/// | coat over metal | 0.992 1.000 | 0.952 1.000 | 0.952 1.000 | 0.915 0.988 | 0.755 0.987 | 0.334 0.974 |
/// | half glass | 0.995 1.000 | 0.958 1.000 | 0.962 1.000 | 0.941 0.991 | 0.873 0.985 | 0.658 0.975 |
#[test]
fn without_multiple_scattering_light_is_lost() {
    let bench = Bench::new(&Setup::new().overriding("MULTIPLE_SCATTERING", 0.0));
    for case in stacks() {
        let [_, high] = row(&bench, &case);
        assert!(high < 1.0 + TABLES, "{}: {high}", case.name);
    }
}

/// The table of stretched lobes is coarse, and made to let none gain: a white metal reflects from 0.97 of what arrives to
/// all of it.
#[test]
fn stretched_metals() {
    let bench = Bench::new(&Setup::new());
    for anisotropy in [0.3, 0.6, 1.0] {
        let mut case = metal([1.0; 3]);
        case.name = "stretched metal";
        case.material.anisotropy = anisotropy;
        let [low, high] = row(&bench, &case);
        assert!(
            low > 0.53 && high < 1.0 + TABLES,
            "{anisotropy}: {low} {high}"
        );
    }
}
