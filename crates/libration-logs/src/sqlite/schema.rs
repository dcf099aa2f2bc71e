//! Tables of a database.

use super::record::Record;

/// Most tables.
pub(super) const MOST: usize = 1000;

/// A table.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct TableInfo {
    pub(crate) name: String,
    /// Its first page.
    pub(crate) root: u32,
    /// The names of its columns.
    columns: Vec<String>,
}

impl TableInfo {
    /// The table in a row of the schema: type, name, name of the table, first page and SQL.
    pub(super) fn of(record: &Record<'_>) -> Option<Self> {
        if record.value(0)?.text()? != "table" {
            return None;
        }
        let root = u32::try_from(record.value(3)?.integer()?).ok()?;
        let columns = columns(&record.value(4)?.text()?);
        Some(TableInfo { name: record.value(1)?.text()?, root, columns })
    }

    /// The index of a column.
    pub(crate) fn column(&self, name: &str) -> Option<usize> {
        self.columns.iter().position(|column| column.eq_ignore_ascii_case(name))
    }
}

/// The names of the columns in `CREATE TABLE name(first type, second type, …)`.
fn columns(sql: &str) -> Vec<String> {
    let Some((_, inner)) = sql.split_once('(') else { return Vec::new() };
    let mut depth = 0_usize;
    let split = |c: char| {
        match c {
            '(' => depth += 1,
            ')' => depth = depth.saturating_sub(1),
            _ => {}
        }
        c == ',' && depth == 0
    };
    let name = |text: &str| {
        let word = text.split_whitespace().next().unwrap_or_default();
        word.trim_matches(['"', '`', '[', ']', '\'', ')']).to_owned()
    };
    inner.split(split).map(name).collect()
}

#[cfg(test)]
mod tests {
    use super::columns;

    #[test]
    fn columns_are_those_of_the_statement() {
        let sql = "CREATE TABLE messages(id INTEGER PRIMARY KEY,\"topic_id\" INTEGER CHECK(a, b) NOT NULL, data BLOB)";
        assert_eq!(columns(sql), ["id", "topic_id", "data"]);
        assert!(columns("CREATE").is_empty());
    }
}
