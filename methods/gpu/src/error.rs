//! What can go wrong with a graphics processor.

/// Result of what is done on a device.
pub type Result<T> = std::result::Result<T, GpuError>;

/// Why a device did not do what it was asked.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum GpuError {
    /// There is none.
    #[error(
        "no graphics adapter was found: expected a Vulkan driver (Debian: libvulkan1, and mesa-vulkan-drivers for one in software)"
    )]
    NoAdapter,
    /// None is called so.
    #[error("there is no adapter {wanted:?}: expected a number or part of a name of {known}")]
    Unknown {
        /// What was asked for.
        wanted: String,
        /// What there is.
        known: String,
    },
    /// It cannot be used.
    #[error("{adapter}: no device can be opened: {message}")]
    Unusable {
        /// The adapter.
        adapter: String,
        /// What the driver said.
        message: String,
    },
    /// It went away: a reset, a crash of the driver, a processor unplugged.
    #[error("{adapter}: the device was lost: {message}")]
    Lost {
        /// The adapter.
        adapter: String,
        /// What the driver said.
        message: String,
    },
    /// Its memory does not suffice.
    #[error("{adapter}: out of memory for {what}")]
    OutOfMemory {
        /// The adapter.
        adapter: String,
        /// What it was asked for.
        what: String,
    },
    /// A buffer is larger than any that it has.
    #[error("{adapter}: {what} takes {bytes} bytes, at most {limit} are possible")]
    TooLarge {
        /// The adapter.
        adapter: String,
        /// The buffer.
        what: String,
        /// Its size.
        bytes: u64,
        /// The device's limit.
        limit: u64,
    },
    /// A shader or a call is wrong.
    #[error("{adapter}: {what}: {message}")]
    Invalid {
        /// The adapter.
        adapter: String,
        /// The shader or call.
        what: String,
        /// What is wrong with it.
        message: String,
    },
}

impl From<GpuError> for halflight_contract::Error {
    fn from(error: GpuError) -> Self {
        halflight_contract::Error::Device(error.to_string())
    }
}
