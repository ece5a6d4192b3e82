//! Outline of the stock and of its voids in a view.
use super::path_view::StandardView;
use super::view_frames::PlacedView;
use crate::scene::{Pen, Point, Shape, Stroke, arc};
use gcode_lang::units::Deg;
use gcode_part::{Rod, Stock, Surface};

/// Draws the outline of the stock, and that of its voids by thin broken lines.
pub(super) fn stock_outline(stock: &Stock, view: &PlacedView) -> Vec<Stroke> {
    let own = stock.body(None).into_iter().flat_map(|body| body_outline(&body, view, Pen::Outline));
    own.chain(stock.voids().iter().flat_map(|void| body_outline(void, view, Pen::Construction))).collect()
}

/// Draws the outline of a box or of a cylinder along an axis of the part. Hidden edges of the isometric view are broken.
fn body_outline(body: &Surface, view: &PlacedView, pen: Pen) -> Vec<Stroke> {
    let line = |pen: Pen, points: &[[f64; 3]]| {
        let points: Vec<Point> = points.iter().map(|point| view.project(*point)).collect();
        Stroke::new(pen, Shape::Line(points))
    };
    let edge = |points: &[[f64; 3]]| line(pen, points);
    match body {
        Surface::Block { min, max } => {
            let corner =
                |ends: usize| [0, 1, 2].map(|axis| if ends >> axis & 1 == 1 { max[axis] } else { min[axis] });
            let edges = (0..8usize).flat_map(|from| (0..3).map(move |axis| (from, from | 1 << axis)));
            // The corner farthest from the reader, at which three hidden edges meet.
            let towards = view.side.towards();
            let hidden = (0..3).filter(|axis| towards[*axis] < 0.0).fold(0, |ends, axis| ends | 1 << axis);
            let is_hidden = |ends: [usize; 2]| view.kind == StandardView::Isometric && ends.contains(&hidden);
            edges
                .filter(|(from, to)| from != to)
                .map(|(from, to)| {
                    let pen = if is_hidden([from, to]) { Pen::Construction } else { pen };
                    line(pen, &[corner(from), corner(to)])
                })
                .collect()
        }
        Surface::Rod(Rod { base, axis, length, radius }) => {
            let along = axis.iamax();
            let (first, second) = ((along + 1) % 3, (along + 2) % 3);
            let (from, to) = (base[along], base[along] + axis[along] * length);
            let rim = |end: f64, angles: [f64; 2]| -> Vec<[f64; 3]> {
                let place = |[a, b]: Point| {
                    let mut point = [end; 3];
                    (point[first], point[second]) = (a, b);
                    point
                };
                let centre = [base[first], base[second]];
                arc(centre, [*radius, *radius], angles).into_iter().map(place).collect()
            };
            let towards = view.side.towards();
            let (near, far) = if towards[along] < 0.0 { (from, to) } else { (to, from) };
            let facing = Deg::atan2(towards[second], towards[first]).0;
            // The wall hides the half of the far rim that is turned away from the reader.
            let is_half_hidden = view.kind == StandardView::Isometric;
            let far_rims = match is_half_hidden {
                true => vec![
                    edge(&rim(far, [facing - 90.0, facing + 90.0])),
                    line(Pen::Construction, &rim(far, [facing + 90.0, facing + 270.0])),
                ],
                false => vec![edge(&rim(far, [0.0, 360.0]))],
            };
            // The outline runs along the generators that are farthest apart across the line of sight.
            let across = libm::hypot(towards[first], towards[second]);
            let sides = [1.0, -1.0].into_iter().filter(|_| 1e-6 < across).map(|sign| {
                let end = |end: f64| {
                    let mut point = [end; 3];
                    point[first] = base[first] - towards[second] / across * radius * sign;
                    point[second] = base[second] + towards[first] / across * radius * sign;
                    point
                };
                edge(&[end(from), end(to)])
            });
            far_rims.into_iter().chain([edge(&rim(near, [0.0, 360.0]))]).chain(sides).collect()
        }
        Surface::Ellipsoid { .. } | Surface::Cylinder { .. } => Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::side::{Projection, Side};
    use crate::views::path_picture::path_picture;
    use crate::views::path_view::{Arrangement, ColorBy, PathView};
    use crate::views::top::TopView;
    use gcode_part::{StockAxis, StockRegion};

    /// A block of 60 by 40 by 20 with a bore of 8 through it at (10, 10): a circle from above, and from the front a rectangle from
    /// x 6 to 14. Without it there is no broken line, and no line of the legend. The frame begins at 0 on the sheet, 4.8 mm, 8 % of
    /// 60, beside the block.
    #[test]
    fn a_void_is_drawn_in_every_view() {
        let bore = StockRegion::Cylinder {
            axis: StockAxis::Z,
            centre: [10.0, 10.0, 0.0],
            diameter: 8.0,
            from: -20.0,
            to: 0.0,
        };
        let picture = |void: Vec<StockRegion>, view: StandardView| {
            let (min, max) = ([0.0, 0.0, -20.0], [60.0, 40.0, 0.0]);
            let stock = Some(Stock::Box { min, max, pocket: Vec::new(), void });
            let path = PathView { stock, ..PathView::default() };
            let arrangement = Arrangement {
                top: Side::Z,
                views: vec![view],
                projection: Projection::Third,
                color_by: ColorBy::Depth,
            };
            path_picture(&TopView::default(), &path, &arrangement)
        };
        let broken = |void: Vec<StockRegion>, view: StandardView| -> Vec<Point> {
            let strokes = picture(void, view).scene.strokes;
            let broken = strokes.iter().filter(|stroke| stroke.pen == Pen::Construction);
            broken.flat_map(|stroke| stroke.shape.points()).collect()
        };
        let above = broken(vec![bore.clone()], StandardView::Top);
        assert!(!above.is_empty());
        for [x, y] in above {
            assert!((libm::hypot(x - 14.8, y - 14.8) - 4.0).abs() < 1e-9, "{x} {y}");
        }
        let front = broken(vec![bore.clone()], StandardView::Front);
        for corner in [[10.8, 4.8], [10.8, 24.8], [18.8, 4.8], [18.8, 24.8]] {
            assert!(
                front.iter().any(|at| libm::hypot(at[0] - corner[0], at[1] - corner[1]) < 1e-6),
                "{corner:?}"
            );
        }
        assert!(broken(Vec::new(), StandardView::Top).is_empty());
        let names = |void: Vec<StockRegion>| {
            let legend = picture(void, StandardView::Top).legend;
            legend.iter().any(|item| item.text == "void of the stock")
        };
        assert!(names(vec![bore]) && !names(Vec::new()));
    }
}
