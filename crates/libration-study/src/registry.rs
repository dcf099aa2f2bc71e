//! The studies of a laboratory and their configuration.

use libration_settings::{ConfigCommand, Document, Fault, SettingsError};
use schemars::generate::SchemaSettings;
use schemars::json_schema;
use serde_json::{Value, json};

use crate::file::{File, KEYS, TEXT};
use crate::settings::{Section, SettingsTableError};
use crate::{Config, Study, schema};

/// The studies of a laboratory, in the order of its report.
#[derive(Clone, Copy)]
pub struct Registry {
    /// All studies.
    pub studies: &'static [&'static dyn Study],
}

impl Registry {
    /// Returns the study with a name, if it exists.
    pub fn by_name(&self, name: &str) -> Option<&'static dyn Study> {
        self.studies.iter().copied().find(|study| study.name() == name)
    }

    /// Returns the names of the studies.
    pub fn names(&self) -> Vec<&'static str> {
        self.studies.iter().map(|study| study.name()).collect()
    }

    /// Returns the studies that a configuration names, in its order; if it names none, all that do not measure the machine.
    pub fn chosen(&self, config: &Config) -> Vec<&'static dyn Study> {
        match config.studies.as_slice() {
            [] => {
                let all = self.studies.iter().copied();
                all.filter(|study| !study.measures_the_machine()).collect()
            }
            names => names.iter().filter_map(|name| self.by_name(name)).collect(),
        }
    }

    /// Returns the default configuration, which is that of the source report (§4.3, §9.1).
    pub fn config(&self) -> Config {
        let mut config = Config::default();
        self.sections().for_each(|section| config.settings.put((section.default)()));
        config
    }

    /// Returns the default configuration as a TOML file with comments.
    pub fn text(&self) -> String {
        let tables = self.sections().map(|section| format!("\n{}", section.text));
        [TEXT.to_owned()].into_iter().chain(tables).collect()
    }

    /// Checks every value of a configuration. Lists may have any order.
    ///
    /// # Errors
    /// For the first invalid value.
    pub fn check(&self, config: &Config) -> Result<(), Fault> {
        config.check(&self.names())
    }

    /// Parses a configuration. Missing keys have their defaults.
    ///
    /// # Errors
    /// For an invalid `text`, with the position; `file_name` appears in the message only.
    pub fn parse(&self, text: &str, file_name: &str) -> Result<Config, SettingsError> {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let document = Document::parse(text, file_name)?;
        let sections: Vec<Section> = self.sections().collect();
        let keys: Vec<&str> =
            KEYS.into_iter().chain(sections.iter().map(|section| section.name)).collect();
        document.check_keys(&keys)?;
        let file: File = toml::from_str(text).map_err(|error| document.explain(&error))?;
        let mut config = Config::try_from(file).map_err(|fault| document.locate(fault))?;
        for section in sections {
            let settings = (section.read)(text).map_err(|misread| match misread {
                SettingsTableError::Shape(error) => document.explain(&error),
                SettingsTableError::Value(fault) => document.locate(fault),
            })?;
            config.settings.put(settings);
        }
        self.check(&config).map_err(|fault| document.locate(fault))?;
        Ok(config.sorted())
    }

    /// Parses a configuration from the bytes of a file.
    ///
    /// # Errors
    /// As [`parse`](Self::parse), and if the bytes are not UTF-8.
    pub fn parse_bytes(&self, bytes: &[u8], file_name: &str) -> Result<Config, SettingsError> {
        match std::str::from_utf8(bytes) {
            Ok(text) => self.parse(text, file_name),
            Err(error) => Err(SettingsError::not_utf8(bytes, error, file_name)),
        }
    }

    /// Parses the configuration in `results.json`, which has all keys.
    ///
    /// # Errors
    /// As [`parse`](Self::parse), without a position.
    pub fn parse_json(&self, config: &Value) -> Result<Config, String> {
        let text = toml::to_string(config).map_err(|error| error.to_string())?;
        self.parse(&text, "results.json").map_err(|error| error.sentence())
    }

    /// Returns the JSON schema of a configuration file.
    pub fn schema(&self) -> Value {
        let settings = SchemaSettings::draft2020_12().with(|s| s.inline_subschemas = true);
        let mut generator = settings.into_generator();
        let mut root = generator.root_schema_for::<File>();
        root.insert("additionalProperties".to_owned(), json!(false));
        let studies = json_schema!({
            "default": [],
            "description": "Studies to run, in this order (empty: all).",
            "type": "array",
            "uniqueItems": true,
            "items": schema::one_of(&self.names()),
        });
        let properties = root.ensure_object().get_mut("properties").and_then(Value::as_object_mut);
        if let Some(properties) = properties {
            properties.insert("studies".to_owned(), studies.to_value());
            for command in [ConfigCommand::ADVISE, ConfigCommand::ROLLOUT] {
                for key in command.keys.iter().filter(|key| !KEYS.contains(key)) {
                    properties.insert((*key).to_owned(), schema::ignored(command.name));
                }
            }
            for section in self.sections() {
                let schema = (section.schema)(&mut generator).to_value();
                properties.insert(section.name.to_owned(), schema);
            }
        }
        root.to_value()
    }

    fn sections(&self) -> impl Iterator<Item = Section> {
        self.studies.iter().filter_map(|study| study.settings())
    }
}
