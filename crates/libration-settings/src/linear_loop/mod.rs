//! Loops around linear plants in settings files.

mod cascade_table;
mod controller_table;
mod coordinates;
mod design;
mod linearisation;
mod loop_table;
mod operating_point;
mod part;
mod part_table;
mod pid_table;
mod plant_equations;
mod plant_file;
mod plant_keys;
mod plant_table;
mod state_space_table;
mod subject;
mod weights_table;

pub use cascade_table::{CascadeControllerTable, CascadePidTable, CascadeTable};
pub use controller_table::{LinearControllerTable, StateFeedbackTable};
pub use coordinates::Coordinates;
pub use design::{Cascaded, Design};
pub use linearisation::linearised_equations;
pub use loop_table::{Channels, LinearLoopTable};
pub use operating_point::{ConservedValue, OperatingPoint, OperatingValue};
pub use part::{Part, PartKind};
pub use part_table::PartTable;
pub use plant_file::{parse as parse_plant, read as read_plant};
pub use plant_table::{PlantTable, Polynomials, Rows};
pub use weights_table::{Weights, WeightsTable};
