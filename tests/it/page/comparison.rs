//! The page of two revisions: what its views contain, and its legend.
use super::*;

/// A rectangle of 30 by 20 is cut into a block of 60 by 40, twice alike and once to x 41: what fits into both
/// canvases is the block, and no line of the legend is about a difference of the paths.
#[test]
fn a_comparison_fits_the_stock_and_names_no_difference_that_it_lacks() {
    let place = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(place.path().join(name), text).unwrap();
    let program = |x: u32| format!("O1\nG90 G00 X10. Y10. Z5.\nS500 M03\nG01 Z-3. F100.\nX{x}.\nY30.\nM30\n");
    write("OLD.nc", &program(40));
    write("NEW.nc", &program(40));
    write("OTHER.nc", &program(41));
    write(
        "machine.toml",
        "[head]\nkind = \"fixed\"\ndirection = [0.0, 0.0, 1.0]\n[stock]\nkind = \"box\"\nmin = [0.0, 0.0, -20.0]\nmax = [60.0, 40.0, 0.0]\n",
    );
    let browser = Browser::start(1400, 1000);
    let shown = |programs: &str| {
        browser.open(&page(place.path(), &format!("diff {programs}")));
        let extents = browser.run(
            "const data = JSON.parse(document.getElementById('data').textContent); \
             const sides = data.sides.map((side) => new Side(side, document.getElementById(`canvas-${side.word}`))); \
             const widths = new Viewer(data, sides).extents.filter((_, at) => at % 3 === 0); \
             return [Math.min(...widths), Math.max(...widths)]",
        );
        let is_in_legend =
            "return ['changed', 'other'].map((name) => !!document.querySelector(`.legend .${name}`))";
        (extents, browser.run(is_in_legend))
    };
    assert_eq!(shown("OLD.nc NEW.nc"), (json!([0, 60]), json!([false, false])));
    assert_eq!(shown("OLD.nc OTHER.nc"), (json!([0, 60]), json!([true, true])));
}
