//! The page made from a results directory.

mod synthetic;

use halflight_reports::{Report, build};
use halflight_results::{Cell, CrossCheck, Layout, Picture, Record, Run, Skip, Store};
use std::fs;

fn sample() -> (tempfile::TempDir, Report, String) {
    let dir = tempfile::tempdir().unwrap();
    synthetic::fill(dir.path(), 48);
    // From the directory alone.
    let report = build(&Store::open(dir.path()).unwrap(), "Title & <b>more</b>");
    let html = report.html().unwrap();
    (dir, report, html)
}

#[test]
fn every_run_skip_and_failure_is_there() {
    let (_dir, report, html) = sample();
    let labels = [
        "sh-product/ordered",
        "shexp/hyb · order 3",
        "shexp/hyb · order 4",
        "shexp/hyb · order 6",
        "shexp/eigen",
        "horizon-wedges/partial",
    ];
    assert_eq!(report.labels, labels);
    let rows: Vec<(usize, usize)> =
        report.scenes.iter().enumerate().flat_map(|(s, scene)| scene.rows.iter().map(move |r| (s, r.label))).collect();
    assert_eq!(rows, [(0, 0), (0, 1), (0, 2), (0, 3), (0, 4), (1, 0), (1, 1), (1, 2), (1, 3), (1, 4), (2, 2)]);
    assert_eq!((report.skips.len(), report.failures.len()), (2, 1));
    assert!(report.warnings.is_empty(), "{:?}", report.warnings);

    assert!(html.contains("11 runs of 6 settings in 3 scenes; 2 skipped, 1 failed."));
    assert_eq!(html.matches("<h4>").count(), 10, "a row of pictures for every run of the two image scenes");
    assert_eq!(html.matches("class=\"viewer\"").count(), 2);
    assert_eq!(
        html.matches("class=\"plot\"").count(),
        2 * (3 + 1),
        "a front by time and one by memory for each scene and over all"
    );
    assert!(html.contains("No pictures: the receivers are a list of 400 points."));
    assert_eq!(html.matches("the scene is no height field").count(), 4, "each skip in the matrix and in the list");
    for part in ["against truth", "against sh-light", "gather", "blockers", "sphere set of bunny, 64", "3.00 MiB"] {
        assert!(html.contains(part), "{part}");
    }
}

#[test]
fn text_from_results_is_escaped() {
    let (_dir, _, html) = sample();
    assert!(html.contains("Title &amp; &lt;b&gt;more&lt;/b&gt;"));
    assert!(html.contains("&lt;script&gt;alert(&#39;no&#39;)&lt;/script&gt; &amp; a NaN"));
    assert!(!html.contains("<script>alert") && !html.contains("<b>more"));
}

#[test]
fn the_page_needs_nothing_else() {
    let (_dir, _, html) = sample();
    for outside in ["src=", "http://", "https://", "@import", "url(http", "fetch("] {
        // The name space of the plots' SVG is an identifier, not an address that is loaded.
        let html = html.replace("http://www.w3.org/2000/svg", "");
        assert!(!html.contains(outside), "{outside}");
    }
    // Every picture is defined once and every reference to one leads somewhere.
    let ids: Vec<&str> = html.split("<image id=\"").skip(1).filter_map(|s| s.split('"').next()).collect();
    assert_eq!(ids.len(), 2 * (2 + 2 * 5));
    for used in html.split("href=\"#image").skip(1).filter_map(|s| s.split('"').next()) {
        assert!(ids.contains(&format!("image{used}").as_str()), "{used}");
    }
}

#[test]
fn what_is_not_resolved_never_wins() {
    let (_dir, report, html) = sample();
    let eigen = report.scenes[0].rows.iter().find(|r| r.label == 4).unwrap();
    let score = eigen.score("truth").unwrap();
    assert!(!score.resolved && score.measures["rmse"] < f64::from(synthetic::NOISE));
    assert_eq!(html.matches("&lt; 0.00200 not resolved").count(), 2);
    assert!(!html.contains("title=\"lowest error\""));
}

#[test]
fn pictures_that_are_gone_leave_a_warning_and_the_rest() {
    let (dir, report, _) = sample();
    let image = report.scenes[0].rows[0].run.image.clone().unwrap();
    let path = dir.path().join(format!("images/{image}.exr"));
    fs::write(&path, b"damaged").unwrap();
    let report = build(&Store::open(dir.path()).unwrap(), "t");
    let html = report.html().unwrap();
    assert!(report.warnings[0].contains(image.as_str()), "{:?}", report.warnings);
    assert!(html.contains("class=\"warnings\""));
    assert_eq!(html.matches("<h4>").count(), 9);
    // Without any image at all the tables still stand.
    fs::remove_dir_all(dir.path().join("images")).unwrap();
    let html = build(&Store::open(dir.path()).unwrap(), "t").html().unwrap();
    assert!(html.contains("there is no reference picture") && html.contains("class=\"plot\""));
}

#[test]
fn newer_metrics_replace_older_ones_and_mixed_references_are_reported() {
    let (dir, report, _) = sample();
    let row = &report.scenes[0].rows[1];
    let mut store = Store::open(dir.path()).unwrap();
    let mut score = row.score("truth").unwrap().clone();
    score.measures.insert("rmse".into(), 0.75);
    score.metrics -= 1;
    store.append(Record::Score(score.clone())).unwrap();
    assert_eq!(build(&store, "t").scenes[0].rows[1].measure("truth", "rmse"), row.measure("truth", "rmse"));
    score.metrics += 2;
    score.reference_image = row.score("sh-light").unwrap().reference_image.clone();
    store.append(Record::Score(score)).unwrap();
    let report = build(&store, "t");
    assert_eq!(report.scenes[0].rows[1].measure("truth", "rmse"), Some(0.75));
    assert!(report.warnings[0].contains("different pictures of the reference `truth`"), "{:?}", report.warnings);
}

#[test]
fn sparse_stores_make_a_page() {
    let dir = tempfile::tempdir().unwrap();
    let mut store = Store::open(dir.path()).unwrap();
    assert!(build(&store, "t").html().unwrap().contains("The store is empty"));
    let cell =
        |scene: &str| Cell { scene: scene.into(), scene_hash: scene.into(), method: "a/b".into(), ..Cell::default() };
    store.append(Record::Skip(Skip { cell: cell("one"), reason: "because".into() })).unwrap();
    assert!(build(&store, "t").html().unwrap().contains("because"));
    store.append(Record::Run(Box::new(Run { cell: cell("two"), ..Run::default() }))).unwrap();
    let html = build(&store, "t").html().unwrap();
    assert!(html.contains("not scored") && html.contains("because"));
}

#[test]
fn the_page_is_the_same_each_time_and_replaces_the_old_one() {
    let (dir, report, html) = sample();
    let path = dir.path().join("report.html");
    fs::write(&path, "old").unwrap();
    report.write(&path).unwrap();
    assert!(fs::read_to_string(&path).unwrap() == html);
    let error = report.write(&dir.path().join("no/such/folder/report.html")).unwrap_err().to_string();
    assert!(error.contains("no/such/folder/report.html"), "{error}");
    let left: Vec<_> = fs::read_dir(dir.path()).unwrap().map(|e| e.unwrap().file_name()).collect();
    assert!(left.iter().all(|name| !name.to_string_lossy().ends_with(".tmp")), "{left:?}");
}

#[test]
fn cross_checks_show_both_pictures_and_the_map_of_p() {
    let dir = tempfile::tempdir().unwrap();
    let mut store = Store::open(dir.path()).unwrap();
    let picture = |values: [f32; 4]| Picture {
        layout: Layout::Image { width: 2, height: 2 },
        radiance: values.map(glam::Vec3::splat).to_vec(),
        valid: vec![true; 4],
    };
    let keep = |values| store.write_picture(&picture(values)).unwrap();
    let (ours, theirs) = (keep([1.0, 0.5, 0.2, 0.4]), keep([1.0, 0.5, 0.3, 0.4]));
    let agreeing = CrossCheck {
        scene: "<room>".into(),
        scene_hash: "5ce9e".into(),
        frame: 0,
        quantity: "indirect-1".into(),
        program: "Mitsuba 3".into(),
        samples: [4096, 8192],
        ours,
        theirs,
        receiver_p: keep([1.0, 0.5, 0.04, 0.7]),
        receivers: 4,
        largest: Some(2.25),
        family_p: 0.375,
        bias: [0.001; 3],
        bias_error: [0.002; 3],
        bias_p: 0.625,
        level: 0.5,
        p: 0.75,
        agrees: true,
    };
    assert!(!build(&store, "none").html().unwrap().contains("Cross-checks"));
    let differing = CrossCheck { quantity: "direct".into(), largest: None, agrees: false, ..agreeing.clone() };
    for check in [agreeing, differing] {
        store.append(Record::CrossCheck(Box::new(check))).unwrap();
    }
    let html = build(&store, "some").html().unwrap();
    for part in [
        "1 of 2 agree",
        "&lt;room&gt; · indirect-1",
        "<b class=\"agrees\">agrees</b> · Mitsuba 3 · 4 receivers",
        "<b class=\"failed\">differs</b>",
        "largest |z| 2.25, p 0.375",
        "largest |z| ∞",
        "truth's excess 0.200\u{a0}±\u{a0}0.400\u{a0}%, p 0.625",
        "p below 0.05 at 25.0\u{a0}% of receivers",
    ] {
        assert!(html.contains(part), "{part}");
    }
    assert_eq!(html.matches("<image ").count(), 6);
}
