//! Edges of the stock as lines of the drawing.
use gcode_lang::units::Deg;
use gcode_part::{Stock, StockAxis};

/// Number of chords of a rim, and every how many of them an edge runs along the cylinder.
const CHORDS: u32 = 72;
const CHORDS_PER_EDGE: u32 = 18;

/// Returns the edges of a box, or the rims and four lines of a cylinder, mm; none of a surface.
pub(super) fn edges(stock: &Stock) -> Vec<Vec<[f64; 3]>> {
    match stock {
        Stock::Box { min, max, .. } => {
            let corner = |ends: usize| [0, 1, 2].map(|axis| [min[axis], max[axis]][ends >> axis & 1]);
            let edges = (0..8usize).flat_map(|from| (0..3).map(move |axis| (from, from | 1 << axis)));
            edges.filter(|(from, to)| from != to).map(|(from, to)| vec![corner(from), corner(to)]).collect()
        }
        Stock::Cylinder { axis, diameter, from, to, .. } => {
            let along = match axis {
                StockAxis::X => 0,
                StockAxis::Y => 1,
                StockAxis::Z => 2,
            };
            let point = |end: f64, chord: u32| {
                let angle = Deg(360.0 / f64::from(CHORDS) * f64::from(chord));
                let mut point = [end; 3];
                point[(along + 1) % 3] = diameter / 2.0 * angle.cos();
                point[(along + 2) % 3] = diameter / 2.0 * angle.sin();
                point
            };
            let rims = [*from, *to].map(|end| (0..=CHORDS).map(|chord| point(end, chord)).collect());
            let sides = (0..CHORDS).step_by(CHORDS_PER_EDGE as usize);
            rims.into_iter().chain(sides.map(|chord| vec![point(*from, chord), point(*to, chord)])).collect()
        }
        Stock::Surface { .. } => Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A box has 12 edges, 4 of each length.
    #[test]
    fn a_box_has_twelve_edges() {
        let stock =
            Stock::Box { min: [0.0, 0.0, -3.0], max: [1.0, 2.0, 0.0], pocket: Vec::new(), void: Vec::new() };
        let lengths = edges(&stock)
            .iter()
            .map(|edge| (0..3).map(|axis| edge[1][axis] - edge[0][axis]).sum())
            .collect::<Vec<f64>>();
        for length in [1.0, 2.0, 3.0] {
            assert_eq!(lengths.iter().filter(|edge| **edge == length).count(), 4, "{lengths:?}");
        }
    }
}
