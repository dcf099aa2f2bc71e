//! What a page receives.

/// Texts and columns of numbers, each by its name.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Answer {
    /// Lines of text.
    pub texts: Vec<(&'static str, String)>,
    /// Columns of numbers. A single number is a column of one.
    pub columns: Vec<(String, Vec<f64>)>,
}

impl Answer {
    pub(crate) fn text(&mut self, name: &'static str, text: impl Into<String>) {
        self.texts.push((name, text.into()));
    }

    pub(crate) fn column(&mut self, name: impl Into<String>, numbers: Vec<f64>) {
        self.columns.push((name.into(), numbers));
    }

    /// A number; NaN where there is none.
    pub(crate) fn number(&mut self, name: impl Into<String>, number: impl Into<Option<f64>>) {
        self.column(name, vec![number.into().unwrap_or(f64::NAN)]);
    }

    /// The numbers of a column; none without such a column.
    pub fn get(&self, name: &str) -> &[f64] {
        self.columns.iter().find(|(own, _)| own == name).map_or(&[], |(_, numbers)| numbers)
    }

    /// A line of text; empty without such a line.
    pub fn get_text(&self, name: &str) -> &str {
        self.texts.iter().find(|(own, _)| *own == name).map_or("", |(_, text)| text)
    }

    /// The length of a head in bytes, the head, and all numbers, little-endian, in 8 bytes each. The head has a line
    /// `text NAME TEXT` or `column NAME LENGTH` for each entry and ends with spaces, so that the numbers begin at a multiple of 8.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut head = String::new();
        for (name, text) in &self.texts {
            head += &format!("text {name} {}\n", text.replace(['\n', '\r'], " "));
        }
        for (name, numbers) in &self.columns {
            head += &format!("column {} {}\n", name.replace(' ', "_"), numbers.len());
        }
        head.extend(core::iter::repeat_n(' ', (12 - head.len() % 8) % 8));
        let mut bytes = (head.len() as u32).to_le_bytes().to_vec();
        bytes.extend_from_slice(head.as_bytes());
        let numbers = self.columns.iter().flat_map(|(_, numbers)| numbers);
        bytes.extend(numbers.flat_map(|x| x.to_le_bytes()));
        bytes
    }
}
