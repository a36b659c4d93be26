//! Cells on a graphics processor.

use crate::bench::{Bench, of_kind};

/// Where Vulkan's loader is to look for drivers, in its old and its new name.
const DRIVERS: [&str; 2] = ["VK_ICD_FILENAMES", "VK_DRIVER_FILES"];

#[test]
fn without_an_adapter_cells_are_skipped_with_the_reason_and_the_others_run() {
    let bench = Bench::new();
    let arguments = "run --scene tiny.toml --method sh-product/* --set order=2 --reference sphere-proxies --samples 16 --backend both";
    let mut command = bench.command(arguments);
    command.envs(DRIVERS.map(|name| (name, "/nowhere")));
    let output = command.output().unwrap();
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(output.status.success(), "{said}{}", String::from_utf8_lossy(&output.stderr));
    let lines = bench.lines("halflight-out");
    let skips: Vec<_> = of_kind(&lines, "skip").iter().map(|line| line["reason"].to_string()).collect();
    let reason = if cfg!(feature = "gpu") { "no graphics adapter was found" } else { "without the feature gpu" };
    assert_eq!(skips.len(), 2, "{lines:?}");
    assert!(skips.iter().any(|skip| skip.contains(reason)), "{skips:?}");
    assert_eq!(of_kind(&lines, "run").len(), 2);
    let report = std::fs::read_to_string(bench.path("halflight-out/report.html")).unwrap();
    assert!(report.contains("GPU skipped: ") && report.contains(reason));
}

#[cfg(feature = "gpu")]
#[test]
fn both_backends_run_side_by_side_and_software_is_not_timed() {
    let bench = Bench::new();
    let pick = "--scene tiny.toml --method sh-product/ordered --set order=2 --reference sphere-proxies --samples 16 --backend both";
    let doctor = bench.well("doctor");
    assert!(doctor.contains("adapter      0: "), "{doctor}");
    let software = doctor.lines().any(|line| line.starts_with("adapter      0: ") && line.contains("correctness only"));

    let planned = bench.well(&format!("plan {pick}"));
    assert!(planned.contains("· gpu: ") && planned.contains("2 to run"), "{planned}");
    bench.well(&format!("run {pick}"));
    let lines = bench.lines("halflight-out");
    let runs = of_kind(&lines, "run");
    let backends: Vec<_> = runs.iter().map(|run| run["backend"].as_str().unwrap()).collect();
    assert_eq!(backends[0], "cpu");
    assert!(backends[1].starts_with("gpu: "), "{backends:?}");
    assert!(runs[1]["counters"]["bytes uploaded"].as_u64().unwrap() > 0);
    assert!(runs[1]["footprint"].as_array().unwrap().iter().any(|entry| entry["device_bytes"].as_u64() > Some(0)));
    let times = of_kind(&lines, "times");
    assert_eq!(times.len(), if software { 1 } else { 2 });
    assert_eq!(times[0]["run"], runs[0]["key"]);
    assert!(bench.well(&format!("plan {pick}")).contains("2 cached"));

    let report = std::fs::read_to_string(bench.path("halflight-out/report.html")).unwrap();
    for part in ["CPU against GPU", "CPU and GPU side by side", "1 pairs of pictures"] {
        assert!(report.contains(part), "{part}");
    }
    assert_eq!(report.contains(">correctness only</td>"), software);
    bench.well("export --csv results.csv");
    let csv = std::fs::read_to_string(bench.path("results.csv")).unwrap();
    let column = csv.lines().next().unwrap().split(',').position(|name| name == "twin").unwrap();
    assert!(column > 0 && csv.contains(runs[0]["key"].as_str().unwrap()));

    bench.well(&format!("measured take {pick} --files kept"));
    let page = std::fs::read_to_string(bench.path("kept.md")).unwrap();
    assert!(page.contains("| against the processor |") && page.contains("- adapter: "), "{page}");
    assert_eq!(page.contains("No graphics processor has been measured"), software);

    let unknown = bench.halflight(&format!("plan {pick} --adapter voodoo"));
    assert_eq!(unknown.code, 2);
    assert!(unknown.err.contains("voodoo") && unknown.err.contains("0: "), "{}", unknown.err);
}
