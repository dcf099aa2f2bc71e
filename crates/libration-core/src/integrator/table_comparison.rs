//! Comparison of tables by their names.

/// Tables are equal if their names are, which are unique, and sorted by order.
macro_rules! compared_by_name {
    ($table:ident) => {
        impl core::fmt::Debug for $table {
            fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
                f.write_str(self.name)
            }
        }

        impl PartialEq for $table {
            fn eq(&self, other: &Self) -> bool {
                self.name == other.name
            }
        }

        impl Eq for $table {}

        impl core::hash::Hash for $table {
            fn hash<H: core::hash::Hasher>(&self, state: &mut H) {
                self.name.hash(state);
            }
        }

        impl PartialOrd for $table {
            fn partial_cmp(&self, other: &Self) -> Option<core::cmp::Ordering> {
                Some(self.cmp(other))
            }
        }

        impl Ord for $table {
            fn cmp(&self, other: &Self) -> core::cmp::Ordering {
                self.order.cmp(&other.order).then(self.name.cmp(other.name))
            }
        }
    };
}

pub(super) use compared_by_name;
