//! Values of arguments.

use crate::scene::Features;

/// `1280x720`.
///
/// # Errors
/// Anything else; the range is checked with the settings.
pub fn size(text: &str) -> Result<[u32; 2], String> {
    let sides = text.split_once(['x', 'X']).and_then(|(width, height)| {
        let side = |s: &str| s.trim().parse().ok();
        Some([side(width)?, side(height)?])
    });
    sides.ok_or_else(|| "expected WIDTHxHEIGHT in pixels, as in 1280x720".into())
}

/// The name of a feature, or `all`.
///
/// # Errors
/// Anything else.
pub fn feature(text: &str) -> Result<String, String> {
    let known = Features::names();
    match text == ALL || known.contains(&text) {
        true => Ok(text.into()),
        false => Err(format!("expected {ALL}, or some of {}", known.join(", "))),
    }
}

/// Stands for every feature.
pub const ALL: &str = "all";

/// `NAME=VALUE`; `true` and `false` are 1 and 0.
///
/// # Errors
/// A missing name or a value that is no finite number.
pub fn assignment(text: &str) -> Result<(String, f64), String> {
    let (name, value) = text
        .split_once('=')
        .ok_or("expected NAME=VALUE, as in ROULETTE_DEPTH=8")?;
    let (name, value) = (name.trim(), value.trim());
    if name.is_empty() {
        return Err("expected a name before the equals sign".into());
    }
    let number = match value {
        "true" => 1.0,
        "false" => 0.0,
        _ => finite(value)?,
    };
    Ok((name.into(), number))
}

/// A finite number.
///
/// # Errors
/// Anything else.
pub fn finite(text: &str) -> Result<f64, String> {
    let number = text.trim().parse().ok().filter(|x: &f64| x.is_finite());
    number.ok_or_else(|| format!("expected a finite number, not \"{text}\""))
}

/// A finite number of at least 0.
///
/// # Errors
/// Anything else.
pub fn not_negative(text: &str) -> Result<f64, String> {
    let number = finite(text)?;
    match number >= 0.0 {
        true => Ok(number),
        false => Err(format!("expected a number of at least 0, not \"{text}\"")),
    }
}

/// A number of more than 0 that f32 can hold, as its reciprocal can.
///
/// # Errors
/// Anything else.
pub fn length(text: &str) -> Result<f64, String> {
    let number = finite(text)?;
    match (1e-30..=1e30).contains(&number) {
        true => Ok(number),
        false => Err(format!("expected a number of more than 0, not \"{text}\"")),
    }
}

/// A length, or `inf`.
///
/// # Errors
/// Anything else.
pub fn focus_distance(text: &str) -> Result<f64, String> {
    match text.trim() {
        "inf" => Ok(f64::INFINITY),
        number => length(number),
    }
}

/// Degrees between 0 and 180.
///
/// # Errors
/// Anything else.
pub fn field_of_view(text: &str) -> Result<f64, String> {
    let degrees = finite(text)?;
    match degrees > 0.0 && degrees < 180.0 {
        true => Ok(degrees),
        false => Err("expected degrees of more than 0 and less than 180".into()),
    }
}

/// `X,Y`, both between 0 and 1.
///
/// # Errors
/// Anything else.
pub fn point(text: &str) -> Result<[f64; 2], String> {
    let point = text.split_once(',').and_then(|(x, y)| {
        let share = |s: &str| finite(s).ok().filter(|c| (0.0..=1.0).contains(c));
        Some([share(x)?, share(y)?])
    });
    point.ok_or_else(|| "expected X,Y, each between 0 and 1, as in 0.5,0.5".into())
}

/// Stops, such that 2^EV is an ordinary f32.
///
/// # Errors
/// Anything else.
pub fn exposure(text: &str) -> Result<f32, String> {
    let stops = finite(text)?;
    match stops.abs() <= 120.0 {
        true => Ok(stops as f32),
        false => Err("expected stops between -120 and 120".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes() {
        assert_eq!(size("1280x720"), Ok([1280, 720]));
        for bad in [
            "",
            "x",
            "12",
            "12x",
            "-1x4",
            "1x2x3",
            "1.5x2",
            "99999999999x1",
        ] {
            assert!(size(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn assignments() {
        assert_eq!(assignment("A=0.5"), Ok(("A".into(), 0.5)));
        assert_eq!(assignment("A = true"), Ok(("A".into(), 1.0)));
        for bad in ["A", "=1", "A=", "A=one", "A=nan", "A=inf"] {
            assert!(assignment(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn numbers() {
        assert_eq!(finite("-1e3"), Ok(-1000.0));
        assert!(not_negative("-1").is_err());
        for bad in ["0", "-1", "1e-40", "1e40", "nan", "inf"] {
            assert!(length(bad).is_err(), "{bad}");
        }
        assert_eq!(focus_distance("inf"), Ok(f64::INFINITY));
        assert!(field_of_view("180").is_err() && field_of_view("0").is_err());
        assert_eq!(point("0.25, 1"), Ok([0.25, 1.0]));
        assert!(point("0.5").is_err() && point("1.5,0").is_err() && point("0,0,0").is_err());
        assert!(exposure("1000").is_err());
    }
}
