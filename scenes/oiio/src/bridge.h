// Pictures by OpenImageIO 2.4 to 3.x, for src/bridge.rs. Every function throws std::runtime_error with the library's message.
#pragma once

#include <cstdint>
#include <memory>

#include <OpenImageIO/imageio.h>

#include "rust/cxx.h"

namespace halflight::oiio {

struct Header;

struct File {
    std::unique_ptr<OIIO::ImageInput> input;
    OIIO::ImageSpec spec;
};

rust::String version();
std::unique_ptr<File> open(rust::Str path, std::int32_t most_megabytes);
Header header(const File& file);
void read(File& file, std::uint32_t first, std::uint32_t count, rust::Slice<float> values);

}  // namespace halflight::oiio
