//! Instructions of operations, counted by Callgrind: `cargo bench -p halflight-sh --bench counts -- --run`, which needs `valgrind`.
//!
//! The program runs itself under Valgrind by scalar code and by AVX2 (Valgrind has no AVX-512) and prints tables: instructions a
//! vector, loads, stores and calls among them. Counts do not depend on what else the machine does. Takes minutes.

use std::hint::black_box;
use std::process::{Command, ExitCode};

use halflight_sh::{
    Batch, BatchExp, Block, LANES, Simd, SquaringRule, Work, circle_log, coefficients, evaluate, gamma, rotate_zonal,
};

/// Calls that are counted at a time.
const CALLS: u64 = 50;

/// What is counted, with the vectors of a call.
const OPERATIONS: [(&str, usize); 9] = [
    ("product, sparse loop", 1),
    ("product, one", 1),
    ("square, one", 1),
    ("evaluate, one", 1),
    ("product, batch", LANES),
    ("square, batch", LANES),
    ("evaluate, batch", LANES),
    ("zonal rotation, batch", LANES),
    ("HYB, batch", LANES),
];

fn main() -> ExitCode {
    let args: Vec<String> = std::env::args().collect();
    if let Some(position) = args.iter().position(|arg| arg == "--counted") {
        let [level, order, name] = &args[position + 1..] else { return ExitCode::FAILURE };
        let simd = if level == "avx2" { Simd::Avx2 } else { Simd::Portable };
        let batch = order.parse().ok().and_then(|order| Batch::with_simd(order, simd));
        batch.into_iter().for_each(|batch| operation(name, batch));
        return ExitCode::SUCCESS;
    }
    if !args.iter().any(|arg| arg == "--run") {
        println!("counting takes minutes: add `-- --run`");
        return ExitCode::SUCCESS;
    }
    for level in ["scalar", "avx2"] {
        println!("| {level} | 2 | 3 | 4 | 5 | 6 | 7 | 8 |\n|---|---|---|---|---|---|---|---|");
        for (name, vectors) in OPERATIONS {
            let counts: Result<Vec<String>, String> =
                (2..=8).map(|order| count(level, order, name).map(|n| format!("{:.0}", n / vectors as f64))).collect();
            match counts {
                Ok(cells) => println!("| {name} | {} |", cells.join(" | ")),
                Err(error) => {
                    eprintln!("{error}");
                    return ExitCode::FAILURE;
                }
            }
        }
        println!();
    }
    ExitCode::SUCCESS
}

/// Counting is on within this function.
#[inline(never)]
fn counted(call: &mut dyn FnMut()) {
    for _ in 0..CALLS {
        call();
    }
}

fn operation(name: &str, batch: Batch) {
    let order = batch.order();
    let vector = |phase: f32| -> Vec<f32> { (0..coefficients(order)).map(|i| (i as f32 + phase).cos()).collect() };
    let blocks = |v: &[f32]| v.iter().map(|&x| Block::splat(x)).collect::<Vec<_>>();
    let (a, b) = (vector(0.3), vector(1.1));
    let (left, right) = (blocks(&a), blocks(&b));
    let (mut out, mut many) = (a.clone(), left.clone());
    let directions = [[0.48f32, 0.6, 0.64].map(Block::splat)];
    let run = |call: &mut dyn FnMut()| {
        call(); // tables are made before
        counted(call);
    };
    match name {
        "product, sparse loop" => run(&mut || gamma(order).product(black_box(&a), &b, &mut out)),
        "product, one" => run(&mut || batch.single_product(black_box(&a), &b, &mut out)),
        "square, one" => run(&mut || batch.single_square(black_box(&a), &mut out)),
        "evaluate, one" => run(&mut || evaluate(order, black_box([0.48, 0.6, 0.64]), &mut out)),
        "product, batch" => run(&mut || batch.product(black_box(&left), &right, &mut many)),
        "square, batch" => run(&mut || batch.square(black_box(&left), &mut many)),
        "evaluate, batch" => run(&mut || batch.evaluate(black_box(&directions), &mut many)),
        "zonal rotation, batch" => {
            let zonal = vec![Block::splat(0.7f32); order];
            run(&mut || batch.rotate_zonal(black_box(&zonal), &directions, &mut many));
        }
        "HYB, batch" => {
            let f = blocks(&log(order));
            let (mut exp, mut work) = (BatchExp::<f32>::new(batch), [Work::default(); LANES]);
            run(&mut || exp.hybrid(SquaringRule::default(), black_box(&f), &mut many, &mut work));
        }
        other => unreachable!("{other}"),
    }
}

/// The sum of the logs of two circles of 37°.
fn log(order: usize) -> Vec<f32> {
    let (mut zonal, mut lobe) = (vec![0.0; order], vec![0.0; coefficients(order)]);
    circle_log(order, 0.8, &mut zonal);
    rotate_zonal(order, &zonal, [0.48, 0.6, 0.64], &mut lobe);
    lobe.iter().map(|&x| 2.0 * x as f32).collect()
}

/// Instructions of one call.
fn count(level: &str, order: usize, name: &str) -> Result<f64, String> {
    let this = std::env::current_exe().map_err(|error| error.to_string())?;
    let output = Command::new("valgrind")
        .args([
            "--tool=callgrind",
            "--collect-atstart=no",
            "--toggle-collect=*counted*",
            "--callgrind-out-file=/dev/null",
        ])
        .arg(this)
        .args(["--counted", level, &order.to_string(), name])
        .output()
        .map_err(|error| format!("valgrind: {error}; expected it to be installed"))?;
    let report = String::from_utf8_lossy(&output.stderr);
    let collected = report.lines().find_map(|line| line.split_once("Collected :")?.1.trim().parse::<f64>().ok());
    collected.map(|total| total / CALLS as f64).ok_or_else(|| format!("valgrind: {report}"))
}
