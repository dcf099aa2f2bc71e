//! The elementary functions besides sine and cosine: errors, special values, bits, and all number types.

mod accuracy;
mod bits;
mod catalogue;
mod ensemble;
mod number_types;
mod order;
mod special_pairs;
mod special_values;
mod values;
