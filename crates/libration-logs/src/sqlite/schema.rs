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
    /// Whether its rows have no numbers: such a table is stored as an index.
    pub(crate) is_without_rowid: bool,
}

impl TableInfo {
    /// The table in a row of the schema: type, name, name of the table, first page and SQL.
    pub(super) fn of(record: &Record<'_>) -> Option<Self> {
        if record.value(0)?.text()? != "table" {
            return None;
        }
        let root = u32::try_from(record.value(3)?.integer()?).ok()?;
        let (columns, is_without_rowid) = columns(&record.value(4)?.text()?);
        Some(TableInfo { name: record.value(1)?.text()?, root, columns, is_without_rowid })
    }

    /// The index of a column.
    pub(crate) fn column(&self, name: &str) -> Option<usize> {
        self.columns.iter().position(|column| column.eq_ignore_ascii_case(name))
    }
}

/// The names of the columns in `CREATE TABLE name(first type, second type, …)`, and whether the table is `WITHOUT ROWID`.
fn columns(sql: &str) -> (Vec<String>, bool) {
    let words = words(sql);
    let mut rest = words.iter().skip_while(|word| word.as_str() != "(").skip(1);
    let (mut names, mut depth, mut is_first) = (Vec::new(), 0_usize, true);
    for word in rest.by_ref() {
        match word.as_str() {
            ")" if depth == 0 => break,
            "(" => depth += 1,
            ")" => depth -= 1,
            "," if depth == 0 => is_first = true,
            name if is_first => {
                names.push(name.trim_start_matches(QUOTED).to_owned());
                is_first = false;
            }
            _ => {}
        }
    }
    let options: Vec<String> = rest.map(|word| word.to_ascii_lowercase()).collect();
    (names, options.windows(2).any(|pair| pair == ["without", "rowid"]))
}

/// The first character of a word that was in quotes: no text of SQLite has it.
const QUOTED: char = '\0';

/// The names, parentheses and commas of a statement, without comments.
fn words(sql: &str) -> Vec<String> {
    let mut words = Vec::new();
    let mut rest = sql;
    while let Some(c) = rest.chars().next() {
        if let Some(comment) = rest.strip_prefix("--") {
            rest = comment.split_once('\n').map_or("", |(_, rest)| rest);
            continue;
        }
        if let Some(comment) = rest.strip_prefix("/*") {
            rest = comment.split_once("*/").map_or("", |(_, rest)| rest);
            continue;
        }
        let end = match c {
            '"' | '\'' | '`' => Some(c),
            '[' => Some(']'),
            _ => None,
        };
        if let Some(end) = end {
            // A doubled quote is one of the name.
            let mut name = QUOTED.to_string();
            rest = &rest[c.len_utf8()..];
            loop {
                let (part, behind) = rest.split_once(end).unwrap_or((rest, ""));
                name.push_str(part);
                rest = behind;
                match rest.strip_prefix(end).filter(|_| c == end) {
                    Some(behind) => rest = behind,
                    None => break,
                }
                name.push(end);
            }
            words.push(name);
            continue;
        }
        let is_name = |c: char| c.is_alphanumeric() || matches!(c, '_' | '$');
        let length = match rest.find(|c| !is_name(c)) {
            Some(0) => c.len_utf8(),
            length => length.unwrap_or(rest.len()),
        };
        if !c.is_whitespace() {
            words.push(rest[..length].to_owned());
        }
        rest = &rest[length..];
    }
    words
}

#[cfg(test)]
mod tests {
    use super::columns;

    #[test]
    fn columns_are_those_of_the_statement() {
        let sql = "CREATE TABLE messages(id INTEGER PRIMARY KEY,\"topic_id\" INTEGER CHECK(a, b) NOT NULL, data BLOB)";
        assert_eq!(columns(sql).0, ["id", "topic_id", "data"]);
        assert!(columns("CREATE").0.is_empty());
    }

    #[test]
    fn comments_quotes_and_parentheses_lose_no_column() {
        let sql = "CREATE TABLE \"a(b\" -- a (comment,\n(id integer, /* a, (b */ [topic id] int default (1+2) -- c, d\n,\
            `times``tamp` text default 'x, )', data blob) without /* e */ ROWID";
        let (names, is_without_rowid) = columns(sql);
        assert_eq!(names, ["id", "topic id", "times`tamp", "data"]);
        assert!(is_without_rowid);
        assert!(!columns("CREATE TABLE without(rowid int, without rowid)").1);
        for end in 0..sql.len() {
            let _ = columns(&sql[..end]);
        }
    }
}
