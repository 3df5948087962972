//! What the whole promises.

use crate::testing::{Noise, fleet, series};
use crate::{
    Alarm, FindingFact, Kind, Labels, Observation, Pages, RecordingFact, RobotFacts, Series, Settings,
    Watched, watch,
};
use std::collections::BTreeMap;

fn alarms(series: &[Series]) -> Vec<Alarm> {
    watch(series, &Settings::default()).alarms
}

/// Adds `change(k)` to day k of a series.
fn changed(series: &mut Series, change: impl Fn(usize) -> f64) {
    series.observations.iter_mut().enumerate().for_each(|(k, o)| o.value += change(k));
}

#[test]
fn fleets_in_which_nothing_happens_rarely_have_an_alarm() {
    let mut noise = Noise::new(20);
    for rho in [0.0, 0.5, 0.8] {
        let numbers: Vec<usize> = (0..20).map(|_| alarms(&fleet(&mut noise, 60, 60, rho)).len()).collect();
        assert!(numbers.iter().filter(|n| **n > 0).count() <= 2, "{numbers:?} at {rho}");
    }
}

#[test]
fn robots_without_siblings_rarely_have_a_false_alarm_and_their_jumps_are_found() {
    let mut noise = Noise::new(30);
    for rho in [0.0, 0.5] {
        let mut wrong = 0;
        for _ in 0..20 {
            let mut all = fleet(&mut noise, 30, 60, rho);
            all.iter_mut().enumerate().for_each(|(k, s)| s.table = format!("table {k}"));
            changed(&mut all[0], |k| if k >= 40 { 15.0 } else { 0.0 });
            let found = alarms(&all);
            assert!(found.iter().any(|a| a.robot == "r000"), "{rho}");
            wrong += i32::from(found.iter().any(|a| a.robot != "r000"));
        }
        assert!(wrong <= 3, "{wrong} of 20 at {rho}");
    }
}

#[test]
fn a_step_and_a_drift_are_found_with_their_days_and_sizes() {
    let mut noise = Noise::new(21);
    let mut all = fleet(&mut noise, 60, 60, 0.4);
    changed(&mut all[3], |k| if k >= 30 { 8.0 } else { 0.0 });
    changed(&mut all[7], |k| 0.3 * k.saturating_sub(20) as f64);
    let found = alarms(&all);
    assert_eq!(found.len(), 2, "{found:?}");
    let of = |robot: &str| found.iter().find(|a| a.robot == robot).expect("an alarm");
    let step = of("r003");
    assert!(step.kind == Kind::Step && step.began.abs_diff(20_030) <= 1 && step.day <= 20_036, "{step:?}");
    assert!((step.change - 8.0).abs() < 3.0 * step.change_sigma, "{step:?}");
    assert!(step.sentence.contains("jumped up") && step.sentence.contains("r003"), "{}", step.sentence);
    let drift = of("r007");
    assert!(drift.began.abs_diff(20_020) <= 20 && drift.day <= 20_050, "{drift:?}");
}

#[test]
fn a_robot_unlike_its_siblings_from_the_first_day_is_told_as_such() {
    let mut noise = Noise::new(22);
    let mut all = fleet(&mut noise, 60, 30, 0.4);
    changed(&mut all[5], |_| 60.0);
    let found = alarms(&all);
    assert_eq!(found.len(), 1, "{found:?}");
    assert_eq!((found[0].kind, found[0].robot.as_str()), (Kind::UnlikeSiblings, "r005"));
    let trends = watch(&all, &Settings::default()).trends;
    let comparison = trends.iter().find(|t| t.robot == "r005").and_then(|t| t.siblings).expect("siblings");
    assert!(comparison.deviations > 10.0 && comparison.siblings == 59, "{comparison:?}");
}

#[test]
fn later_days_change_no_earlier_alarm() {
    let mut noise = Noise::new(23);
    let mut all = fleet(&mut noise, 20, 50, 0.4);
    changed(&mut all[1], |k| if k >= 22 { 9.0 } else { 0.0 });
    changed(&mut all[2], |k| 0.4 * k.saturating_sub(18) as f64);
    changed(&mut all[3], |k| if k >= 35 { -9.0 } else { 0.0 });
    // A robot that comes later, and one that has holes.
    all[4].observations.retain(|o| o.day >= 20_012);
    all[5].observations.retain(|o| o.day % 3 != 0);
    let whole = alarms(&all);
    assert!(whole.len() >= 3, "{whole:?}");
    for last in 20_010..20_050 {
        let mut prefix = all.clone();
        prefix.iter_mut().for_each(|s| s.observations.retain(|o| o.day <= last));
        let until: Vec<Alarm> = whole.iter().filter(|a| a.day <= last).cloned().collect();
        assert_eq!(alarms(&prefix), until, "{last}");
    }
}

fn fleet_page(series: &[Series], watched: &Watched) -> String {
    Pages::new(series, watched, &BTreeMap::new(), Labels::plain()).fleet()
}

#[test]
fn the_order_of_series_changes_no_byte() {
    let mut noise = Noise::new(24);
    let mut all = fleet(&mut noise, 20, 40, 0.4);
    changed(&mut all[1], |k| if k >= 22 { 9.0 } else { 0.0 });
    let mut turned = all.clone();
    turned.reverse();
    turned.swap(3, 11);
    let text = |s: &[Series]| {
        let watched = watch(s, &Settings::default());
        (serde_json::to_string(&watched).expect("numbers and strings"), fleet_page(s, &watched))
    };
    assert_eq!(text(&all), text(&turned));
}

/// Robots with a friction that falls with a temperature of their own and of the season.
fn warm_fleet(noise: &mut Noise, season: f64) -> Vec<Series> {
    let mut all = fleet(noise, 30, 60, 0.3);
    for one in &mut all {
        let hall = 4.0 * noise.normal();
        let wander = noise.ar1(60, 0.8);
        for (k, o) in one.observations.iter_mut().enumerate() {
            let temperature = 20.0 + hall + season * k as f64 / 60.0 + 3.0 * wander[k];
            o.value -= 1.5 * temperature;
            o.temperature = Some(temperature);
        }
    }
    all
}

#[test]
fn temperature_explains_friction_and_raises_no_alarm() {
    let mut noise = Noise::new(25);
    let mut all = warm_fleet(&mut noise, 15.0);
    // One robot's hall warms up by itself.
    for (k, o) in all[4].observations.iter_mut().enumerate() {
        let more = 0.3 * k as f64;
        o.value -= 1.5 * more;
        o.temperature = o.temperature.map(|t| t + more);
    }
    let watched = watch(&all, &Settings::default());
    assert!(watched.alarms.is_empty(), "{:?}", watched.alarms);
    let slopes: Vec<(f64, f64)> = watched.trends.iter().filter_map(|t| t.per_degree).collect();
    let near = slopes.iter().filter(|(slope, sigma)| (slope + 1.5).abs() < 3.0 * sigma + 0.02).count();
    assert!(slopes.len() == 30 && near >= 27, "{slopes:?}");
    // The same fleet without temperatures has the alarm that the temperature explains.
    all.iter_mut().for_each(|s| s.observations.iter_mut().for_each(|o| o.temperature = None));
    changed(&mut all[4], |k| -0.5 * k as f64);
    assert!(alarms(&all).iter().any(|a| a.robot == "r004"));
}

#[test]
fn a_season_that_all_siblings_feel_raises_no_alarm_without_temperatures() {
    let mut noise = Noise::new(26);
    let mut all = fleet(&mut noise, 30, 90, 0.3);
    all.iter_mut().for_each(|s| changed(s, |k| 6.0 * (k as f64 / 20.0).sin()));
    assert!(alarms(&all).is_empty());
}

#[test]
fn an_alarm_is_raised_once_for_a_change() {
    let mut noise = Noise::new(27);
    let mut all = fleet(&mut noise, 12, 120, 0.2);
    changed(&mut all[0], |k| 0.3 * k.saturating_sub(20) as f64);
    assert_eq!(alarms(&all).iter().filter(|a| a.robot == "r000").count(), 1);
}

#[test]
fn no_input_is_too_strange() {
    let odd = [f64::NAN, f64::INFINITY, -f64::INFINITY, 0.0, 1e308, -1e308, 1e-308, f64::MAX, 1e99, -1e99];
    let mut noise = Noise::new(28);
    let mut pick = || odd[(noise.uniform() * odd.len() as f64) as usize % odd.len()];
    let mut all =
        vec![series("empty", []), series("one", [1.0]), series("same", [0.0; 40]), series("x", [5.0; 40])];
    for robot in 0..12 {
        let observations = (0..40)
            .map(|day| Observation {
                day: [day, -day, day / 3, i64::MAX, i64::MIN][robot % 5],
                value: if day % 2 == 0 { pick() } else { day as f64 },
                sigma: pick(),
                temperature: Some(pick()),
                load: (day % 2 == 0).then(&mut pick),
            })
            .collect();
        all.push(Series { observations, ..series(&format!("odd{robot}"), []) });
    }
    let mut settings = Settings::default();
    for strange in [0.05, f64::NAN, -1.0, 7.0] {
        settings.false_discoveries = strange;
        settings.outlier_days = strange;
        settings.calibration_days = if strange > 1.0 { usize::MAX } else { 0 };
        let watched = watch(&all, &settings);
        assert!(fleet_page(&all, &watched).contains("<html"));
        let facts = BTreeMap::new();
        assert!(Pages::new(&all, &watched, &facts, Labels::plain()).robot("odd0").contains("<html"));
    }
    watch(&[], &Settings::default());
}

#[test]
fn the_page_tells_the_worst_robot_first_and_escapes_names() {
    let mut noise = Noise::new(29);
    let mut all = fleet(&mut noise, 20, 40, 0.3);
    changed(&mut all[2], |k| if k >= 25 { 8.0 } else { 0.0 });
    changed(&mut all[9], |k| if k >= 20 { 30.0 } else { 0.0 });
    all[9].robot = "<b>&\"worst\"".into();
    all[9].unit = "<i>".into();
    let watched = watch(&all, &Settings::default());
    let link = |robot: &str| (robot != "r002").then(|| format!("reports/{robot}\"x.html"));
    let facts = BTreeMap::new();
    let html = Pages::new(&all, &watched, &facts, Labels { link: &link, ..Labels::plain() }).fleet();
    let at = |text: &str| html.find(text).unwrap_or_else(|| panic!("{text} is not there"));
    let strongest = watched.alarms.iter().max_by(|a, b| a.e_value.total_cmp(&b.e_value)).expect("two alarms");
    assert_eq!((watched.alarms.len(), strongest.robot.as_str()), (2, "<b>&\"worst\""));
    assert!(at("&lt;b&gt;&amp;&quot;worst&quot;</a>") < at("<h3>r002"));
    assert!(at("href=\"reports/&lt;b&gt;&amp;&quot;worst&quot;&quot;x.html\"") > 0);
    assert!(!html.contains("<b>") && !html.contains("<i>") && !html.contains("NaN"));
    assert!(
        html.contains("class=\"band\"")
            && html.contains("jumped up")
            && html.contains("18 robots without an alarm")
    );
    for outside in ["<script", "http:", "https:", "src=", "@import", "url("] {
        assert!(!html.contains(outside), "{outside}");
    }
}

#[test]
fn load_explains_as_temperature_does_and_days_without_either_raise_no_alarm() {
    let mut noise = Noise::new(31);
    let mut all = warm_fleet(&mut noise, 10.0);
    for (r, one) in all.iter_mut().enumerate() {
        for (k, o) in one.observations.iter_mut().enumerate() {
            let load = 10.0 + 2.0 * noise.normal() + if r == 5 && k >= 30 { 8.0 } else { 0.0 };
            o.value += 2.0 * load;
            o.load = (k % 11 != 3).then_some(load);
            o.temperature = o.temperature.filter(|_| k % 13 != 5);
        }
    }
    let watched = watch(&all, &Settings::default());
    assert!(watched.alarms.is_empty(), "{:?}", watched.alarms);
    let near = watched.trends.iter().filter_map(|t| t.per_load).filter(|l| (l.0 - 2.0).abs() < 0.2).count();
    assert!(near >= 27, "{near}");
}

#[test]
fn a_robot_without_siblings_says_so_and_with_them_what_they_did() {
    let mut noise = Noise::new(32);
    let mut all = fleet(&mut noise, 20, 40, 0.3);
    changed(&mut all[2], |k| if k >= 25 { 30.0 } else { 0.0 });
    all[7].table = "other".into();
    changed(&mut all[7], |k| if k >= 25 { 30.0 } else { 0.0 });
    let found = alarms(&all);
    let of = |robot: &str| found.iter().find(|a| a.robot == robot).expect("an alarm");
    assert_eq!(of("r002").siblings, 18);
    assert!(of("r002").siblings_change.is_some_and(|change| change.abs() < 1.0), "{found:?}");
    assert_eq!((of("r007").siblings, of("r007").siblings_change), (0, None));
    let watched = watch(&all, &Settings::default());
    let facts = BTreeMap::new();
    let pages = Pages::new(&all, &watched, &facts, Labels::plain());
    assert!(pages.robot("r002").contains("Meanwhile 18 robots with the same table: "));
    assert!(pages.robot("r007").contains("No other robot with the same table was recorded meanwhile."));
}

#[test]
fn a_robots_page_tells_its_alarms_findings_and_recordings_and_escapes_all_of_them() {
    let mut noise = Noise::new(33);
    let mut all = fleet(&mut noise, 12, 40, 0.3);
    changed(&mut all[3], |k| if k >= 25 { 12.0 } else { 0.0 });
    all[3].robot = "<b>".into();
    let recording = |day, outcome: &str, message: &str| RecordingFact {
        day,
        recording: format!("logs/<{day}>.yaml"),
        outcome: outcome.into(),
        message: message.into(),
        relative_error: Some(0.0312),
        rise: Some(1.5),
    };
    let finding = FindingFact {
        day: 20_025,
        effect: "friction level change".into(),
        sentence: "Friction of joint 1 & 2 rose.".into(),
        confidence: Some(0.94),
        ..FindingFact::default()
    };
    let recordings = vec![recording(20_001, "used", ""), recording(20_002, "unreadable", "<i>no table</i>")];
    let facts = BTreeMap::from([
        ("<b>".to_owned(), RobotFacts { recordings, findings: vec![finding] }),
        (
            "never".to_owned(),
            RobotFacts { recordings: vec![recording(20_003, "refused", "why")], findings: vec![] },
        ),
    ]);
    let watched = watch(&all, &Settings::default());
    let table = |table: &str| format!("{table} & more");
    let pages = Pages::new(&all, &watched, &facts, Labels { table: &table, ..Labels::plain() });
    let html = pages.robot("<b>");
    for told in [
        "jumped up",
        "Friction of joint 1 &amp; 2 rose.",
        "confidence 0.940",
        "&lt;i&gt;no table&lt;/i&gt;",
        "Recordings: 1 used, 1 unreadable.",
        "arm &amp; more",
        "\u{d7} 1.50",
        "class=\"band\"",
        "href=\"../fleet.html\"",
    ] {
        assert!(html.contains(told), "{told}");
    }
    assert!(!html.contains("<b>") && !html.contains("<i>") && !html.contains("NaN"));
    assert!(pages.robot("never").contains("No alarm; no recording gave parameters. Recordings: 1 refused."));
    let all = pages.fleet();
    assert!(all.contains("Not watched: no recording gave parameters") && all.contains("never"));
}
