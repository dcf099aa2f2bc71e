//! Studies that set what theory predicts beside what a simulation measures.
