//! Edges of the stock and of its voids as lines of the drawing.
use gcode_lang::units::Deg;
use gcode_part::{Rod, Stock, Surface};

/// Number of chords of a rim, and every how many of them an edge runs along the cylinder.
const CHORDS: u32 = 72;
const CHORDS_PER_EDGE: u32 = 18;

/// Returns the edges of the stock and of its voids, mm.
pub(super) fn edges(stock: &Stock) -> Vec<Vec<[f64; 3]>> {
    stock.body(None).iter().chain(&stock.voids()).flat_map(body_edges).collect()
}

/// Returns the edges of a box, or the rims and four lines of a cylinder along an axis of the part.
fn body_edges(body: &Surface) -> Vec<Vec<[f64; 3]>> {
    match body {
        Surface::Block { min, max } => {
            let corner = |ends: usize| [0, 1, 2].map(|axis| [min[axis], max[axis]][ends >> axis & 1]);
            let edges = (0..8usize).flat_map(|from| (0..3).map(move |axis| (from, from | 1 << axis)));
            edges.filter(|(from, to)| from != to).map(|(from, to)| vec![corner(from), corner(to)]).collect()
        }
        Surface::Rod(Rod { base, axis, length, radius }) => {
            let along = axis.iamax();
            let (from, to) = (base[along], base[along] + axis[along] * length);
            let point = |end: f64, chord: u32| {
                let angle = Deg(360.0 / f64::from(CHORDS) * f64::from(chord));
                let (first, second) = ((along + 1) % 3, (along + 2) % 3);
                let mut point = [end; 3];
                point[first] = base[first] + radius * angle.cos();
                point[second] = base[second] + radius * angle.sin();
                point
            };
            let rims = [from, to].map(|end| (0..=CHORDS).map(|chord| point(end, chord)).collect());
            let sides = (0..CHORDS).step_by(CHORDS_PER_EDGE as usize);
            rims.into_iter().chain(sides.map(|chord| vec![point(from, chord), point(to, chord)])).collect()
        }
        Surface::Ellipsoid { .. } | Surface::Cylinder { .. } => Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use gcode_part::{StockAxis, StockRegion};

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

    /// A block with a bore of 8 through it at (10, 5): 12 edges, two rims and four lines between them.
    #[test]
    fn a_void_has_its_edges() {
        let bore = StockRegion::Cylinder {
            axis: StockAxis::Z,
            centre: [10.0, 5.0, 0.0],
            diameter: 8.0,
            from: -20.0,
            to: 0.0,
        };
        let stock = |void: Vec<StockRegion>| Stock::Box {
            min: [0.0, 0.0, -20.0],
            max: [60.0, 40.0, 0.0],
            pocket: Vec::new(),
            void,
        };
        assert_eq!(edges(&stock(Vec::new())).len(), 12);
        let all = edges(&stock(vec![bore]));
        assert_eq!(all.len(), 18);
        for [x, y, z] in all[12..].iter().flatten() {
            assert!(
                (libm::hypot(x - 10.0, y - 5.0) - 4.0).abs() < 1e-9 && (*z == 0.0 || *z == -20.0),
                "{x} {y} {z}"
            );
        }
    }
}
