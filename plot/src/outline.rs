//! Outlines of bodies on paper.

use crate::canvas::Place;
use crate::pose::Spot;
use crate::view::{cross, minus, unit};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Outline of a rod with round ends.
pub(crate) fn capsule(from: Place, to: Place, radius: f64) -> Vec<Place> {
    let turn = (to[1] - from[1]).atan2(to[0] - from[0]);
    let arc = |center: Place, start: f64| {
        (0..=10).map(move |k| {
            let (s, c) = (start + PI * k as f64 / 10.0).sin_cos();
            [center[0] + radius * c, center[1] + radius * s]
        })
    };
    let quarter = FRAC_PI_2;
    arc(to, turn - quarter).chain(arc(from, turn + quarter)).collect()
}

/// Places on both rims of a short cylinder.
pub(crate) fn wheel(from: Spot, to: Spot, radius: f64) -> Vec<Spot> {
    let axis = unit(minus(to, from)).unwrap_or([0.0, 0.0, 1.0]);
    let other = if axis[0].abs() < 0.8 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
    let first = unit(cross(axis, other)).unwrap_or(other);
    let second = cross(axis, first);
    let rim = |center: Spot| {
        (0..48).map(move |k| {
            let (s, c) = (TAU * f64::from(k) / 48.0).sin_cos();
            [0, 1, 2].map(|i| center[i] + radius * (c * first[i] + s * second[i]))
        })
    };
    rim(from).chain(rim(to)).collect()
}

/// The smallest convex polygon around places.
pub(crate) fn hull(mut places: Vec<Place>) -> Vec<Place> {
    places.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    let turn = |a: Place, b: Place, c: Place| {
        (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
    };
    let chain = |places: &mut dyn Iterator<Item = Place>| {
        let mut kept: Vec<Place> = Vec::new();
        for place in places {
            while let [.., a, b] = kept[..] {
                if turn(a, b, place) > 0.0 {
                    break;
                }
                kept.pop();
            }
            kept.push(place);
        }
        kept.pop();
        kept
    };
    let mut polygon = chain(&mut places.iter().copied());
    polygon.extend(chain(&mut places.iter().rev().copied()));
    polygon
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hull_leaves_out_what_is_inside() {
        let places = vec![[0.0, 0.0], [2.0, 0.0], [1.0, 1.0], [2.0, 2.0], [0.0, 2.0], [1.0, 0.0]];
        assert_eq!(hull(places), [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]]);
        assert!(hull(vec![]).is_empty());
    }

    #[test]
    fn rims_are_round() {
        for spot in wheel([0.0; 3], [0.0, 0.0, 0.1], 2.0) {
            assert!((spot[0].hypot(spot[1]) - 2.0).abs() < 1e-12);
        }
    }
}
