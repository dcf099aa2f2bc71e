//! Tests of ensembles against single trajectories.

mod implicit_ensembles;
mod single_trajectories;
