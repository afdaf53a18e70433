//! Numbers of bytes as people read them.

use std::fmt;

/// So many bytes.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct Size(pub f64);

impl fmt::Display for Size {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        const UNITS: [&str; 6] = ["bytes", "kB", "MB", "GB", "TB", "PB"];
        let (mut size, mut unit) = (self.0, 0);
        // What is rounded to a thousand is one of the next unit.
        while size >= 999.5 && unit + 1 < UNITS.len() {
            size /= 1000.0;
            unit += 1;
        }
        let digits = usize::from(unit > 0 && size < 99.95);
        write!(f, "{size:.digits$} {}", UNITS[unit])
    }
}

#[cfg(test)]
mod tests {
    use super::Size;

    #[test]
    fn a_size_is_written_in_the_unit_that_suits_it() {
        for (bytes, text) in [
            (0.0, "0 bytes"),
            (999.0, "999 bytes"),
            (1000.0, "1.0 kB"),
            (999_600.0, "1.0 MB"),
            (12_345_678_901.0, "12.3 GB"),
            (456e12, "456 TB"),
            (7e20, "700000 PB"),
        ] {
            assert_eq!(Size(bytes).to_string(), text);
        }
    }
}
