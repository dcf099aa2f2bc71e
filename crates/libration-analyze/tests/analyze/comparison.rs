//! Tests of the comparison of integrators.
