//! What accuracy costs, in the window.

use egui::accesskit::Role;
use reliefscope::surface::mapping::Method;

use super::driver::Driver;

/// Advice begins with this.
const ADVICE: &str = "cheapest method with p95 ≤ 1 texel from this view (45°)";

fn advised(driver: &Driver, line: &str) -> bool {
    let lines = driver.harness.query_all_by_role(Role::Label);
    lines.into_iter().any(|label| says(&label, line))
}

fn says(node: &egui_kittest::Node<'_>, words: &str) -> bool {
    let node = node.accesskit_node();
    let texts = [node.label(), node.value()];
    texts.into_iter().flatten().any(|text| text.contains(words))
}

use egui_kittest::kittest::{NodeT as _, Queryable as _};

#[test]
fn the_open_section_measures_and_advises() {
    let mut driver = Driver::reference();
    assert!(!driver.app().state().trade.is_running(), "nobody looks");
    driver.section("Trade");
    driver.wait_until(|app| app.state().trade.is_running());
    driver.wait_until(|app| !app.state().trade.is_running());
    driver.harness.run_steps(2);
    assert!(advised(&driver, ADVICE), "the advice is shown");
    let looks = "to look like the truth from 45° at FLIP ≤ 0.05";
    assert!(advised(&driver, looks), "pictures are compared, too");
    // The offset of limited parallax is short of a texel nowhere near 45°, so the advice is a search.
    let shown = driver.harness.query_all_by_role(Role::Button);
    let show = shown.into_iter().find(|button| says(button, "Show "));
    show.expect("advice has a button").click();
    driver.harness.run_steps(3);
    let method = driver.settings().mapping.method;
    assert!(method.searches(), "{method:?}");
    assert_ne!(method, Method::RelaxedCone, "its map takes seconds to make");
}

#[test]
fn a_closed_section_does_not_measure() {
    let mut driver = Driver::reference();
    driver.section("Trade");
    driver.wait_until(|app| app.state().trade.is_running());
    driver.section("Trade");
    driver.wait_until(|app| !app.state().trade.is_running());
    driver.number("Amplitude", 0.03);
    for _ in 0..90 {
        driver.harness.step();
        assert!(!driver.app().state().trade.is_running());
    }
}
