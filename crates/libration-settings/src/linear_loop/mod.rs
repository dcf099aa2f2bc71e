//! Loops around linear plants in settings files.

mod controller_table;
mod loop_table;
mod part_table;
mod plant_file;
mod plant_table;

pub use controller_table::{Design, LinearControllerTable};
pub use loop_table::LinearLoopTable;
pub use part_table::{Part, PartTable};
pub use plant_file::read as read_plant;
pub use plant_table::{PlantTable, Polynomials, Rows};
