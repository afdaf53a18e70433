//! A table of a study, to be printed or shown.

/// Cells in rows: words first, and then numbers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Grid {
    /// What the columns are called.
    pub head: Vec<String>,
    /// How many columns hold words.
    pub words: usize,
    /// As many cells in each as there are columns.
    pub rows: Vec<Vec<String>>,
}

impl Grid {
    /// The table in Markdown.
    #[must_use]
    pub fn markdown(&self) -> String {
        let line = |cells: &Vec<String>| format!("| {} |", cells.join(" | "));
        let numbers = self.head.len() - self.words;
        let rule = format!("|{}{}", "---|".repeat(self.words), "---:|".repeat(numbers));
        let rows = self.rows.iter().map(line);
        [line(&self.head), rule]
            .into_iter()
            .chain(rows)
            .collect::<Vec<_>>()
            .join("\n")
    }
}
