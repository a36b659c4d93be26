#include "halflight-oiio/src/bridge.h"

#include <stdexcept>
#include <string>

#include "halflight-oiio/src/bridge.rs.h"

namespace halflight::oiio {

namespace {

[[noreturn]] void fail(std::string message)
{
    throw std::runtime_error(message.empty() ? "OpenImageIO gives no reason" : message);
}

// Old names and comments in files need not be UTF-8.
rust::String text(const std::string& bytes)
{
    return rust::String::lossy(bytes);
}

}  // namespace

rust::String version()
{
    const int number = OIIO::openimageio_version();
    return std::to_string(number / 10000) + "." + std::to_string(number / 100 % 100) + "." + std::to_string(number % 100);
}

std::unique_ptr<File> open(rust::Str path, std::int32_t most_megabytes)
{
    // Before 2.5 there is no such limit, and setting it says so by its result: sizes are checked by the caller as well.
    OIIO::attribute("limits:imagesize_MB", most_megabytes);
    OIIO::ImageSpec wanted;
    // Colours as they are in the file: what alpha covers still has one.
    wanted.attribute("oiio:UnassociatedAlpha", 1);
    // No rotation that a camera asks for: rows are rows.
    wanted.attribute("oiio:reorient", 0);
    auto file = std::make_unique<File>();
    file->input = OIIO::ImageInput::open(std::string(path), &wanted);
    if (!file->input) {
        fail(OIIO::geterror());
    }
    file->spec = file->input->spec();
    return file;
}

Header header(const File& file)
{
    const OIIO::ImageSpec& spec = file.spec;
    Header header {};
    header.width  = spec.width;
    header.height = spec.height;
    header.depth  = spec.depth;
    header.deep   = spec.deep;
    for (const std::string& name : spec.channelnames) {
        header.channels.push_back(text(name));
    }
    header.floating  = spec.format.is_floating_point();
    header.is_signed = spec.format.is_signed();
    header.bits      = static_cast<std::uint32_t>(8 * spec.format.basesize());
    header.color_space = text(std::string(spec.get_string_attribute("oiio:ColorSpace")));
    float xy[8];
    if (spec.getattribute("chromaticities", OIIO::TypeDesc(OIIO::TypeDesc::FLOAT, 8), xy)) {
        for (float value : xy) {
            header.chromaticities.push_back(value);
        }
    }
    return header;
}

void read(File& file, std::uint32_t first, std::uint32_t count, rust::Slice<float> values)
{
    const OIIO::ImageSpec& spec = file.spec;
    const std::uint64_t texels  = std::uint64_t(spec.width) * std::uint64_t(spec.height);
    const std::uint64_t end     = std::uint64_t(first) + count;
    if (count == 0 || end > std::uint64_t(spec.nchannels) || values.size() != texels * count) {
        fail("the caller's buffer does not fit the channels");
    }
    const bool done = file.input->read_image(0, 0, int(first), int(end), OIIO::TypeDesc::FLOAT, values.data());
    if (!done) {
        fail(file.input->geterror());
    }
}

}  // namespace halflight::oiio
