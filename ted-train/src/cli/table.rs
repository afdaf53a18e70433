//! Tables in plain text and in Markdown.

/// Where the text of a column stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Align {
    Left,
    Right,
}

/// Rows under a header.
#[derive(Clone, Debug)]
pub(super) struct Table {
    align: Vec<Align>,
    rows: Vec<Vec<String>>,
}

impl Table {
    /// A table with these columns.
    pub(super) fn new(columns: &[(&str, Align)]) -> Self {
        Self {
            align: columns.iter().map(|(_, align)| *align).collect(),
            rows: vec![columns.iter().map(|(name, _)| (*name).to_owned()).collect()],
        }
    }

    /// Adds a row.
    pub(super) fn row(&mut self, cells: impl IntoIterator<Item = String>) {
        self.rows.push(cells.into_iter().collect());
    }

    /// For a terminal: columns two spaces apart.
    pub(super) fn text(&self) -> String {
        let lines = self.padded().into_iter();
        let lines = lines.map(|cells| cells.join("  ").trim_end().to_owned());
        lines.collect::<Vec<_>>().join("\n")
    }

    /// For a document.
    pub(super) fn markdown(&self) -> String {
        let mut lines: Vec<String> = self
            .padded()
            .into_iter()
            .map(|cells| format!("| {} |", cells.join(" | ")))
            .collect();
        let rule = self.align.iter().map(|align| match align {
            Align::Left => "---|",
            Align::Right => "---:|",
        });
        lines.insert(1, format!("|{}", rule.collect::<String>()));
        lines.join("\n")
    }

    fn padded(&self) -> Vec<Vec<String>> {
        let length = |cell: &String| cell.chars().count();
        let widest = |column: usize| self.rows.iter().filter_map(move |row| row.get(column));
        let widths: Vec<usize> = (0..self.align.len())
            .map(|column| widest(column).map(length).max().unwrap_or(0))
            .collect();
        let pad = |(cell, (align, width)): (&String, (&Align, &usize))| match align {
            Align::Left => format!("{cell:<width$}"),
            Align::Right => format!("{cell:>width$}"),
        };
        let columns = || self.align.iter().zip(&widths);
        self.rows
            .iter()
            .map(|row| row.iter().zip(columns()).map(pad).collect())
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table() -> Table {
        let mut table = Table::new(&[("what", Align::Left), ("n", Align::Right)]);
        table.row(["a µs".to_owned(), "10".to_owned()]);
        table.row(["longer".to_owned(), "9".to_owned()]);
        table
    }

    #[test]
    fn columns_line_up_by_characters() {
        assert_eq!(table().text(), "what     n\na µs    10\nlonger   9");
    }

    #[test]
    fn markdown_has_a_rule_that_says_the_alignment() {
        assert_eq!(
            table().markdown(),
            "| what   |  n |\n|---|---:|\n| a µs   | 10 |\n| longer |  9 |"
        );
    }
}
