//! Windows of stable time steps.

/// Distance of a time step from the limit of stability, relative to it, within which rounding decides on the side.
const AT_LIMIT: f64 = 4.0 * f64::EPSILON;

/// Whether a time step is in one of these windows.
pub fn is_within(windows: &[[Option<f64>; 2]], dt: f64) -> bool {
    let is_in = |&[from, to]: &[Option<f64>; 2]| {
        from.is_none_or(|from| from <= dt) && to.is_none_or(|to| dt <= to)
    };
    windows.iter().any(is_in)
}

/// Whether a time step is the longest or the shortest of a window, where multipliers leave the unit circle.
pub fn is_at_limit(windows: &[[Option<f64>; 2]], dt: f64) -> bool {
    let is_near = |end: &f64| *end > 0.0 && (dt - end).abs() <= AT_LIMIT * end;
    windows.iter().flatten().flatten().any(is_near)
}
