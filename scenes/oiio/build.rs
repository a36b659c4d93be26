//! Compiles the bridge against the OpenImageIO that pkg-config finds.

#[cfg(feature = "oiio")]
fn main() {
    // The system's own folder must not be named: it would come before the compiler's.
    let search = pkg_config::Config::new().atleast_version("2.4").print_system_cflags(false).probe("OpenImageIO");
    let library = search.unwrap_or_else(|error| {
        panic!("the feature `oiio` needs OpenImageIO 2.4 or newer (Debian: apt-get install libopenimageio-dev pkg-config): {error}")
    });
    cxx_build::bridge("src/bridge.rs")
        .file("src/bridge.cc")
        .std("c++17")
        // The library's own headers are not ours to mend.
        .flags(library.include_paths.iter().map(|path| format!("-isystem{}", path.display())))
        .compile("halflight-oiio");
    for file in ["src/bridge.rs", "src/bridge.cc", "src/bridge.h"] {
        println!("cargo:rerun-if-changed={file}");
    }
}

#[cfg(not(feature = "oiio"))]
fn main() {}
