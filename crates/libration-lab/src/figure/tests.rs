//! Claims about whole figures.
