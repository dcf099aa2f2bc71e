//! Rectangles, and lines and polygons cut to them.

/// A place on the page, in pixels.
pub(super) type Place = [f64; 2];

/// A rectangle on the page.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Rect {
    pub(super) x: f64,
    pub(super) y: f64,
    pub(super) width: f64,
    pub(super) height: f64,
}

impl Rect {
    pub(super) fn right(&self) -> f64 {
        self.x + self.width
    }

    pub(super) fn bottom(&self) -> f64 {
        self.y + self.height
    }

    pub(super) fn expanded(&self, by: f64) -> Self {
        let (width, height) = (self.width + 2.0 * by, self.height + 2.0 * by);
        Self { x: self.x - by, y: self.y - by, width, height }
    }

    pub(super) fn contains(&self, [x, y]: Place) -> bool {
        x >= self.x && x <= self.right() && y >= self.y && y <= self.bottom()
    }

    pub(super) fn contains_rect(&self, other: &Self) -> bool {
        self.contains([other.x, other.y]) && self.contains([other.right(), other.bottom()])
    }

    pub(super) fn intersects(&self, other: &Self) -> bool {
        self.x < other.right()
            && other.x < self.right()
            && self.y < other.bottom()
            && other.y < self.bottom()
    }

    /// The part of a segment inside (Liang and Barsky).
    pub(super) fn clip_segment(&self, a: Place, b: Place) -> Option<[Place; 2]> {
        let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
        let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
        let sides = [
            (-dx, a[0] - self.x),
            (dx, self.right() - a[0]),
            (-dy, a[1] - self.y),
            (dy, self.bottom() - a[1]),
        ];
        for (speed, room) in sides {
            if speed == 0.0 {
                if room < 0.0 {
                    return None;
                }
            } else if speed < 0.0 {
                enter = enter.max(room / speed);
            } else {
                leave = leave.min(room / speed);
            }
        }
        let at = |t: f64| [a[0] + t * dx, a[1] + t * dy];
        let start = if enter == 0.0 { a } else { at(enter) };
        (enter <= leave).then(|| [start, if leave == 1.0 { b } else { at(leave) }])
    }

    /// The parts of a polyline inside; a corner that is not finite ends a part.
    pub(super) fn clip_line(&self, line: &[Place]) -> Vec<Vec<Place>> {
        let mut parts: Vec<Vec<Place>> = Vec::new();
        let mut open = false;
        for pair in line.windows(2) {
            let [a, b] = [pair[0], pair[1]];
            let inside = if finite(a) && finite(b) { self.clip_segment(a, b) } else { None };
            let Some([from, to]) = inside else {
                open = false;
                continue;
            };
            match parts.last_mut() {
                Some(part) if open && part.last() == Some(&from) => part.push(to),
                _ => parts.push(vec![from, to]),
            }
            open = to == b;
        }
        parts
    }

    /// The parts of a polyline outside.
    pub(super) fn outside_parts(&self, line: &[Place]) -> Vec<Vec<Place>> {
        let mut parts: Vec<Vec<Place>> = Vec::new();
        let mut add = |from: Place, to: Place| match parts.last_mut() {
            _ if from == to => {}
            Some(part) if part.last() == Some(&from) => part.push(to),
            _ => parts.push(vec![from, to]),
        };
        for pair in line.windows(2) {
            match self.clip_segment(pair[0], pair[1]) {
                Some([enter, leave]) => {
                    add(pair[0], enter);
                    add(leave, pair[1]);
                }
                None => add(pair[0], pair[1]),
            }
        }
        parts
    }

    /// The part of a polygon inside (Sutherland and Hodgman).
    pub(super) fn clip_polygon(&self, polygon: &[Place]) -> Vec<Place> {
        let mut corners: Vec<Place> = polygon.iter().copied().filter(|&p| finite(p)).collect();
        let sides =
            [(0, self.x, 1.0), (0, self.right(), -1.0), (1, self.y, 1.0), (1, self.bottom(), -1.0)];
        for (axis, limit, sign) in sides {
            let depth = |p: Place| (p[axis] - limit) * sign;
            let mut kept = Vec::with_capacity(corners.len() + 4);
            for (index, &b) in corners.iter().enumerate() {
                let a = corners[(index + corners.len() - 1) % corners.len()];
                if (depth(a) >= 0.0) != (depth(b) >= 0.0) {
                    let t = depth(a) / (depth(a) - depth(b));
                    let mut crossing = [a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])];
                    crossing[axis] = limit;
                    kept.push(crossing);
                }
                if depth(b) >= 0.0 {
                    kept.push(b);
                }
            }
            corners = kept;
        }
        corners
    }
}

pub(super) fn finite(place: Place) -> bool {
    place[0].is_finite() && place[1].is_finite()
}

/// The middle of the corners of a polygon.
pub(super) fn centre(corners: &[Place]) -> Option<Place> {
    let count = corners.len() as f64;
    let sum = corners.iter().fold([0.0, 0.0], |s, p| [s[0] + p[0], s[1] + p[1]]);
    (!corners.is_empty()).then(|| [sum[0] / count, sum[1] / count])
}

#[cfg(test)]
mod tests {
    use super::*;

    const BOX: Rect = Rect { x: 0.0, y: 0.0, width: 10.0, height: 10.0 };

    #[test]
    fn a_line_that_leaves_and_returns_is_two_parts() {
        let parts = BOX.clip_line(&[[1.0, 5.0], [1.0, 1e12], [9.0, 1e12], [9.0, 5.0]]);
        assert_eq!(parts, [vec![[1.0, 5.0], [1.0, 10.0]], vec![[9.0, 10.0], [9.0, 5.0]]]);
    }

    #[test]
    fn a_corner_without_a_place_is_a_gap() {
        let parts =
            BOX.clip_line(&[[1.0, 1.0], [2.0, 2.0], [f64::NAN, 3.0], [4.0, 4.0], [5.0, 5.0]]);
        assert_eq!(parts.len(), 2);
    }

    #[test]
    fn a_line_makes_room_for_a_label() {
        let parts = BOX.outside_parts(&[[-5.0, 5.0], [5.0, 5.0], [15.0, 5.0], [20.0, 5.0]]);
        assert_eq!(
            parts,
            [vec![[-5.0, 5.0], [0.0, 5.0]], vec![[10.0, 5.0], [15.0, 5.0], [20.0, 5.0]]]
        );
    }

    #[test]
    fn a_polygon_around_the_box_becomes_the_box() {
        let around = [[-5.0, -5.0], [50.0, -5.0], [50.0, 50.0], [-5.0, 50.0]];
        let mut corners = BOX.clip_polygon(&around);
        corners.sort_by(|a, b| a.partial_cmp(b).unwrap());
        assert_eq!(corners, [[0.0, 0.0], [0.0, 10.0], [10.0, 0.0], [10.0, 10.0]]);
    }
}
