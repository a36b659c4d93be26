//! Writes the generated kernels of `halflight-sh` and prints what each form costs.

use std::path::Path;
use std::{fs, io};

use halflight_sh_generate::triples::{self, Kind};
use halflight_sh_generate::{Form, files};

fn main() -> io::Result<()> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    for (path, text) in files() {
        let path = root.join(path);
        fs::create_dir_all(path.parent().expect("files are in folders"))?;
        fs::write(path, text)?;
    }
    println!("instructions (those that multiply)");
    println!("                         product                       square");
    println!("order    plain         triples         rings         triples         rings");
    for order in 2..=8 {
        print!("{order:5} {:8}", triples::build_plain(order).count());
        for kind in [Kind::Product, Kind::Square] {
            for form in Form::ALL {
                print!(" {:7} ({:4})", form.count(order, kind), form.count_multiplications(order, kind));
            }
        }
        println!();
    }
    Ok(())
}
