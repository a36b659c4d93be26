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
    println!("instructions             product           square");
    println!("order    plain   triples   rings   triples   rings");
    for order in 2..=8 {
        let [product, square] = [Kind::Product, Kind::Square].map(|kind| Form::ALL.map(|form| form.count(order, kind)));
        println!(
            "{order:5} {:8} {:9} {:7} {:9} {:7}",
            triples::build_plain(order).count(),
            product[0],
            product[1],
            square[0],
            square[1]
        );
    }
    Ok(())
}
