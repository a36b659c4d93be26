//! Numbers and text for people.

/// Escapes text for HTML, in element content and in quoted attributes.
pub(crate) fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            _ => out.push(c),
        }
    }
    out
}

/// Three significant digits: plain between 0.001 and 100 000, otherwise in powers of ten.
pub(crate) fn number(value: f64) -> String {
    let size = value.abs();
    if value == 0.0 {
        return "0".into();
    }
    if !value.is_finite() {
        return "–".into();
    }
    let text = if (0.000_999_5..99_999.5).contains(&size) {
        // Rounding may carry into the next power of ten: 0.9996 has its three digits as 1.00.
        let rounded: f64 = format!("{size:.2e}").parse().unwrap_or(size);
        let places = (2 - rounded.log10().floor() as i32).max(0) as usize;
        format!("{value:.places$}")
    } else {
        format!("{value:.2e}")
    };
    text.replace('-', "−")
}

/// A value with its standard error, to the error's first digit.
pub fn plus_minus(value: f64, error: f64) -> String {
    if error <= 0.0 || !error.is_finite() {
        return number(value);
    }
    let places = (-error.log10().floor()).clamp(0.0, 9.0) as usize;
    format!("{value:.places$} ± {error:.places$}").replace('-', "−")
}

/// A time given in nanoseconds, with its unit.
pub(crate) fn time(nanoseconds: f64) -> String {
    let (scale, unit) = time_unit(nanoseconds);
    format!("{} {unit}", number(nanoseconds / scale))
}

/// Nanoseconds in the unit that suits a time, and the unit's name.
pub(crate) fn time_unit(nanoseconds: f64) -> (f64, &'static str) {
    match nanoseconds {
        t if t >= 0.999_5e9 => (1e9, "s"),
        t if t >= 0.999_5e6 => (1e6, "ms"),
        t if t >= 0.999_5e3 => (1e3, "µs"),
        _ => (1.0, "ns"),
    }
}

/// A number of bytes in binary units.
pub(crate) fn bytes(count: u64) -> String {
    let units = ["B", "KiB", "MiB", "GiB", "TiB"];
    let mut value = count as f64;
    let mut unit = 0;
    while value >= 1023.5 && unit + 1 < units.len() {
        value /= 1024.0;
        unit += 1;
    }
    if unit == 0 { format!("{count} B") } else { format!("{} {}", number(value), units[unit]) }
}

/// A count in groups of three digits, by narrow no-break spaces.
pub(crate) fn count(value: u64) -> String {
    let digits = value.to_string();
    let mut out = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            out.push('\u{202f}');
        }
        out.push(digit);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn html_is_escaped() {
        assert_eq!(escape("<a href=\"x\">'&'</a>"), "&lt;a href=&quot;x&quot;&gt;&#39;&amp;&#39;&lt;/a&gt;");
    }

    #[test]
    fn numbers_have_three_digits() {
        for (value, text) in [
            (0.0, "0"),
            (1.0, "1.00"),
            (0.9996, "1.00"),
            (0.012_345, "0.0123"),
            (-0.5, "−0.500"),
            (123.45, "123"),
            (99_999.0, "99999"),
            (0.000_123_4, "1.23e−4"),
            (1_234_567.0, "1.23e6"),
            (f64::NAN, "–"),
        ] {
            assert_eq!(number(value), text);
        }
    }

    #[test]
    fn times_bytes_and_counts_have_units() {
        assert_eq!(time(999.0), "999 ns");
        assert_eq!(time(12_345_678.0), "12.3 ms");
        assert_eq!(time(999_600.0), "1.00 ms");
        assert_eq!(time(2.5e9), "2.50 s");
        assert_eq!(bytes(512), "512 B");
        assert_eq!(bytes(1536), "1.50 KiB");
        assert_eq!(bytes(3 << 30), "3.00 GiB");
        assert_eq!(count(1_234_567), "1\u{202f}234\u{202f}567");
        assert_eq!(count(12), "12");
    }

    #[test]
    fn the_error_decides_on_the_digits() {
        assert_eq!(plus_minus(0.030_341, 0.000_038_9), "0.03034 ± 0.00004");
        assert_eq!(plus_minus(-1.25, 0.3), "−1.2 ± 0.3");
        assert_eq!(plus_minus(1234.5, 20.0), "1234 ± 20");
        assert_eq!(plus_minus(0.5, 0.0), "0.500");
    }
}
