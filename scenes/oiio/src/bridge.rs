//! What crosses the border to C++.

#![expect(unreachable_pub, reason = "cxx makes its functions public")]

#[cxx::bridge(namespace = "halflight::oiio")]
pub(crate) mod ffi {
    /// What a file says of its first picture, before any texel is read.
    pub(crate) struct Header {
        width: i64,
        height: i64,
        depth: i64,
        deep: bool,
        channels: Vec<String>,
        /// The widest channel: floating point, or whole numbers with or without sign and of how many bits.
        floating: bool,
        is_signed: bool,
        bits: u32,
        color_space: String,
        /// CIE xy of red, green, blue and white, or nothing.
        chromaticities: Vec<f32>,
    }

    // SAFETY: the functions in bridge.cc keep no reference beyond their call, write no further than the slice that they
    // are given (they check its length), and throw nothing but std::exception, which cxx makes an error.
    unsafe extern "C++" {
        include!("halflight-oiio/src/bridge.h");

        pub(crate) type File;

        pub(crate) fn version() -> String;
        pub(crate) fn open(path: &str, most_megabytes: i32) -> Result<UniquePtr<File>>;
        pub(crate) fn header(file: &File) -> Result<Header>;
        /// Channels `first..first + count` of every texel as floats, row by row from the top.
        pub(crate) fn read(file: Pin<&mut File>, first: u32, count: u32, values: &mut [f32]) -> Result<()>;
    }
}
