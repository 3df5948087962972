//! The pages of `--report` in a browser. Without a Chromium and its chromedriver (Debian: `chromium chromium-driver`)
//! these tests say that they are skipped.
#![allow(clippy::unwrap_used, reason = "a test that cannot set itself up has failed")]

#[path = "browser/driver.rs"]
mod driver;

mod common;

use common::{Folder, error_of};
use driver::Browser;
use serde_json::{Value, json};

/// The reports of three commands on a simulated arm, each with its pictures over time.
const PAGES: [&str; 3] = ["identified.html", "validated.html", "diagnosed.html"];

/// The labels of the time axes.
const TIMES: &str = "return [...document.querySelectorAll('figure')].filter(f => f.querySelector('.name.x').textContent \
    === 'time, s').map(f => [...f.querySelectorAll('.ticks.x text')].map(t => t.textContent).join(' '));";

fn reports(name: &str) -> Folder {
    let folder = Folder::new(name);
    for words in [
        "simulate planar_2r --out . --motions 2 --period 4 --rate 1000 --record-every 2 --noise 1 --seed 7 --residue 1",
        "identify recording.yaml --out m.json --report identified.html --residuals rows.csv",
        "validate m.json recording.yaml --report validated.html",
        "diagnose recording.yaml --report diagnosed.html",
    ] {
        let output = folder.run(&words.split(' ').collect::<Vec<_>>());
        assert!(output.status.success(), "{words}: {}", error_of(&output));
    }
    folder
}

#[test]
fn pages_fit_a_screen_and_a_phone_and_complain_of_nothing() {
    for (test, width) in [("screen", 1280), ("phone", 390)] {
        let Some(browser) = Browser::start(test, width) else { return };
        let folder = reports(test);
        for page in PAGES {
            browser.open(&folder.path(page));
            browser.run("document.querySelectorAll('details').forEach(d => { d.open = true; });");
            let sizes =
                browser.run("const d = document.documentElement; return [d.scrollWidth, d.clientWidth];");
            assert!(sizes[0].as_f64() <= sizes[1].as_f64(), "{page} at {width}: {sizes}");
            // What is wider than its place can be scrolled to.
            let cut = "return [...document.querySelectorAll('table')].filter(t => t.scrollWidth > t.parentElement.clientWidth \
                       && getComputedStyle(t.parentElement).overflowX !== 'auto').length;";
            assert_eq!(browser.run(cut), json!(0), "{page} at {width}");
            let pictures = browser.run("return document.querySelectorAll('figure .tools').length;");
            assert!(pictures.as_u64() >= Some(2), "{page}: {pictures} pictures");
            assert_eq!(browser.complaints(), Vec::<Value>::new(), "{page} at {width}");
        }
    }
}

#[test]
fn a_box_zooms_every_time_axis_and_a_double_click_shows_all() {
    let Some(browser) = Browser::start("zoom", 1280) else { return };
    let folder = reports("zoom");
    browser.open(&folder.path(PAGES[0]));
    let whole = browser.run(TIMES);
    let count = whole.as_array().map_or(0, Vec::len);
    assert!(count >= 4, "{whole}");
    browser.mouse("figure svg", &[[0.4, 0.3], [0.55, 0.35], [0.6, 0.35]], true);
    let near = browser.run(TIMES);
    for k in 0..count {
        assert_ne!(near[k], whole[k]);
        assert_eq!(near[k], near[0]);
    }
    // The keys move the interval of all, too.
    browser.run("document.querySelector('figure svg').focus();");
    browser.keys(&["-"]);
    let farther = browser.run(TIMES);
    assert_ne!(farther, near);
    assert_eq!(farther[0], farther[count - 1]);
    browser.run("document.querySelector('figure svg').dispatchEvent(new MouseEvent('dblclick'));");
    browser.mouse("figure svg", &[[0.5, 0.5]], false);
    assert_eq!(browser.run(TIMES), whole);
    assert_eq!(browser.complaints(), Vec::<Value>::new());
}

#[test]
fn values_are_shown_under_the_pointer_and_by_keys() {
    let Some(browser) = Browser::start("values", 1280) else { return };
    let folder = reports("values");
    browser.open(&folder.path(PAGES[0]));
    let told = "const v = document.querySelector('.values'); return v.hidden ? '' : v.innerText;";
    assert_eq!(browser.run(told), json!(""));
    browser.mouse("figure svg", &[[0.4, 0.5], [0.5, 0.5]], false);
    let values = browser.run(told);
    let words = values.as_str().unwrap();
    for part in ["time", "measured", "predicted", "difference", "N.m"] {
        assert!(words.contains(part), "{words}");
    }
    // They are those of the row of that time.
    let read = "const v = document.querySelector('.values'); const number = e => parseFloat(e.textContent.replace('\u{2212}', '-')
        .replace('time', '')); return [v.firstChild, ...v.querySelectorAll('b')].map(number);";
    let shown: Vec<f64> = browser.run(read).as_array().unwrap().iter().map(|v| v.as_f64().unwrap()).collect();
    let text = std::fs::read_to_string(folder.path("rows.csv")).unwrap();
    let names: Vec<&str> = text.lines().next().unwrap().split(',').collect();
    let column = |name: &str| names.iter().position(|n| *n == name).unwrap();
    let rows =
        text.lines().skip(1).map(|line| line.split(',').map(|v| v.parse().unwrap()).collect::<Vec<f64>>());
    let near = |row: &Vec<f64>| row[0] == 1.0 && (row[column("t")] - shown[0]).abs() < 2e-3;
    let row = rows.into_iter().find(near).unwrap_or_else(|| panic!("no row at {shown:?}"));
    for (value, name) in shown[1..].iter().zip(["tau1", "predicted1", "residual1"]) {
        let truth = row[column(name)];
        assert!((value - truth).abs() < 1e-3 * truth.abs() + 1e-3, "{name}: {value} for {truth}");
    }
    browser.run("document.querySelector('figure svg').focus();");
    browser.keys(&["\u{e014}", "\u{e014}", "\u{e014}"]);
    let moved = browser.run(told);
    assert!(moved != values && moved.as_str().unwrap().contains("measured"), "{moved}");
    assert_eq!(browser.complaints(), Vec::<Value>::new());
}

#[test]
fn a_name_takes_its_curve_away_and_the_choice_changes_the_abscissa_of_the_residual() {
    let Some(browser) = Browser::start("choice", 1280) else { return };
    let folder = reports("choice");
    browser.open(&folder.path(PAGES[2]));
    let drawn = "return document.querySelector('figure .curves path').getAttribute('d').length;";
    assert!(browser.run(drawn).as_u64() > Some(10));
    let press = "document.querySelector('figure .legend button').click();";
    browser.run(press);
    assert_eq!(browser.run(drawn), json!(0));
    browser.run(press);
    assert!(browser.run(drawn).as_u64() > Some(10));
    let residual = "const f = document.querySelector('select').closest('figure'); const all = [];
        const s = f.querySelector('select');
        for (let k = 0; k < s.options.length; k++) {
            s.selectedIndex = k; s.dispatchEvent(new Event('change'));
            all.push([s.options[k].text, f.querySelector('.name.x').textContent, f.querySelector('.curves path').getAttribute('d')]);
        }
        return all;";
    let views = browser.run(residual);
    let names = ["speed, rad/s", "position, rad", "acceleration, rad/s2", "load, N.m", "time, s"];
    for (k, name) in names.into_iter().enumerate() {
        assert_eq!(views[k][1], name);
        assert!((0..k).all(|other| views[k][2] != views[other][2]), "{name}");
        assert!(views[k][2].as_str().unwrap().matches('M').count() > 100, "{name}");
    }
    assert_eq!(browser.complaints(), Vec::<Value>::new());
}

#[test]
fn without_a_script_the_pictures_are_the_same() {
    let Some(browser) = Browser::start("bare", 1280) else { return };
    let folder = reports("bare");
    let pictures = "return [...document.querySelectorAll('figure')].map(f => ['.ticks.x', '.ticks.y', '.curves', '.name'] \
        .map(s => f.querySelector(s).innerHTML).concat([...f.querySelectorAll('.key')].filter(k => !k.closest('.values')).map(k => k.textContent)));";
    for page in PAGES {
        browser.open(&folder.path(page));
        let with = browser.run(pictures);
        browser.devtools("Emulation.setScriptExecutionDisabled", json!({"value": true}));
        browser.open(&folder.path(page));
        let without = browser.run(pictures);
        let buttons = browser.run("return document.querySelectorAll('button, select').length;");
        browser.devtools("Emulation.setScriptExecutionDisabled", json!({"value": false}));
        assert_eq!((with, buttons), (without, json!(0)), "{page}");
    }
}

#[test]
fn a_page_prints_light_even_where_the_screen_is_dark() {
    let Some(browser) = Browser::start("print", 1280) else { return };
    let folder = reports("print");
    browser.open(&folder.path(PAGES[2]));
    let colours = "return [document.body, document.querySelector('.curves .after')].map(e => getComputedStyle(e)) \
        .map((style, k) => k ? style.color : style.backgroundColor);";
    let emulate = |media: &str, scheme: &str| {
        let features = json!([{"name": "prefers-color-scheme", "value": scheme}]);
        browser.devtools("Emulation.setEmulatedMedia", json!({"media": media, "features": features}));
        browser.run(colours)
    };
    let light = emulate("screen", "light");
    assert_eq!(light[0], "rgb(255, 255, 255)");
    let dark = emulate("screen", "dark");
    assert!(dark[0] != light[0] && dark[1] != light[1], "{dark}");
    assert_eq!(emulate("print", "dark"), light);
    let tools = "return getComputedStyle(document.querySelector('.tools')).display;";
    assert_eq!(browser.run(tools), json!("none"));
    emulate("", "dark");
    let pdf = browser.printed();
    let text = String::from_utf8_lossy(&pdf);
    assert!(pdf.starts_with(b"%PDF") && text.matches("/Type /Page\n").count() >= 2, "{} bytes", pdf.len());
}
