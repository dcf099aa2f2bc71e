//! Records of studies.

mod cell;
mod claim;
mod finding;
mod series;
mod table;

use serde::{Deserialize, Serialize};
use thiserror::Error;

pub use cell::{Cell, Quantity};
pub use claim::{Claim, ClaimVerdict, Judgement, Ruling};
pub use finding::{Agreement, Finding, Relation, Tolerance, Undecided};
pub use series::{Column, Series};
pub use table::Table;

/// The results of a study, from which the report is rendered.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub struct Record {
    /// The study's name, as on the command line.
    pub name: String,
    /// The question of the study.
    pub question: String,
    /// Wall-clock time of the study, in s.
    pub seconds: f64,
    /// Predictions and measurements.
    pub findings: Vec<Finding>,
    /// Sentences of the source report, judged by the findings.
    pub claims: Vec<Claim>,
    /// Tables, with all digits.
    pub tables: Vec<Table>,
    /// The figures of this record.
    pub figures: Vec<FigureFile>,
    /// The files of its series.
    pub data: Vec<DataFile>,
    /// The series behind the figures; they are written to `data/`, not to `results.json`.
    #[serde(skip)]
    pub series: Vec<Series>,
}

/// The file of a figure.
#[derive(Clone, Debug, Deserialize, Serialize, PartialEq, Eq)]
pub struct FigureFile {
    /// Identifier, unique in the report.
    pub id: String,
    /// Path relative to the output folder.
    pub file: String,
}

/// The file of a series.
#[derive(Clone, Debug, Deserialize, Serialize, PartialEq, Eq)]
pub struct DataFile {
    /// Name, unique in the study.
    pub name: String,
    /// Path relative to the output folder.
    pub file: String,
}

/// Error of a missing part of a record.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum RecordError {
    /// No finding has this identifier.
    #[error("the study `{study}` has no finding `{id}`")]
    NoFinding {
        /// The study.
        study: String,
        /// The missing name.
        id: String,
    },
    /// No series has this name.
    #[error("the study `{study}` has no series `{name}`")]
    NoSeries {
        /// The study.
        study: String,
        /// The missing name.
        name: String,
    },
    /// No table has this name.
    #[error("the study `{study}` has no table `{name}`")]
    NoTable {
        /// The study.
        study: String,
        /// The missing name.
        name: String,
    },
    /// A series has no column of this name.
    #[error("the series `{series}` has no column `{column}`")]
    NoColumn {
        /// The series.
        series: String,
        /// The missing name.
        column: String,
    },
}

impl Record {
    /// An empty record of the study `name` with its question.
    pub fn new(name: &str, question: &str) -> Self {
        Record {
            name: name.into(),
            question: question.into(),
            seconds: 0.0,
            findings: Vec::new(),
            claims: Vec::new(),
            tables: Vec::new(),
            figures: Vec::new(),
            data: Vec::new(),
            series: Vec::new(),
        }
    }

    /// Adds a finding.
    pub fn find(&mut self, finding: Finding) {
        debug_assert!(self.finding(&finding.id).is_err(), "two findings named {}", finding.id);
        self.findings.push(finding);
    }

    /// Judges a claim of the source report by findings of this record. Without these findings it adds no
    /// claim.
    pub fn judge(&mut self, ruling: Ruling<'_>, judge: impl FnOnce(&[&Finding]) -> Judgement) {
        let evidence: Option<Vec<&Finding>> =
            ruling.findings.iter().map(|id| self.finding(id).ok()).collect();
        if let Some(evidence) = evidence {
            let claim = Claim::new(&ruling, &evidence, judge(&evidence));
            self.claims.push(claim);
        }
    }

    /// The finding `id`.
    ///
    /// # Errors
    /// If there is none.
    pub fn finding(&self, id: &str) -> Result<&Finding, RecordError> {
        self.findings
            .iter()
            .find(|f| f.id == id)
            .ok_or_else(|| RecordError::NoFinding { study: self.name.clone(), id: id.into() })
    }

    /// The series `name`.
    ///
    /// # Errors
    /// If there is none.
    pub fn series(&self, name: &str) -> Result<&Series, RecordError> {
        self.series
            .iter()
            .find(|s| s.name == name)
            .ok_or_else(|| RecordError::NoSeries { study: self.name.clone(), name: name.into() })
    }

    /// The table `name`.
    ///
    /// # Errors
    /// If there is none.
    pub fn table(&self, name: &str) -> Result<&Table, RecordError> {
        self.tables
            .iter()
            .find(|t| t.name == name)
            .ok_or_else(|| RecordError::NoTable { study: self.name.clone(), name: name.into() })
    }

    /// The findings whose measurement contradicts the prediction.
    pub fn disagreements(&self) -> impl Iterator<Item = &Finding> {
        self.findings.iter().filter(|f| f.verdict == Agreement::Disagrees)
    }
}
