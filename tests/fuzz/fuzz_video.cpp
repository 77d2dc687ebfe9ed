// Any bytes as a camera file: the readers must give frames or one of the library's errors.
#include <impactdic/error.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "host/video/format/readers.h"

namespace {

std::string scratch_file(const char* name) {
  static const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("impactdic_fuzz_" + std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  return (folder / name).string();
}

void write(const std::string& path, const std::uint8_t* bytes, std::size_t count) {
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes), static_cast<std::streamsize>(count));
}

std::unique_ptr<impactdic::FrameSource> open_bytes(const std::uint8_t* bytes, std::size_t count) {
#if defined(FUZZ_cine)
  const std::string path = scratch_file("a.cine");
  write(path, bytes, count);
  return impactdic::video::open_cine(path, count % 2 == 0);
#elif defined(FUZZ_tiff)
  const std::string path = scratch_file("a.tif");
  write(path, bytes, count);
  return impactdic::video::open_tiff(path);
#else
  static const std::uint8_t pixels[4096] = {};
  const std::string path = scratch_file("a.cihx");
  write(scratch_file("a.mraw"), pixels, sizeof pixels);
  write(path, bytes, count);
  return impactdic::video::open_mraw(path);
#endif
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t count) {
  try {
    const auto clip = open_bytes(bytes, count);
    impactdic::Frame frame;
    clip->read(0, frame);
    clip->read(clip->info().frame_count - 1, frame);
    clip->frame_time_s(0);
    clip->frame_exposure_s(0);
    if (frame.width() != clip->info().width) std::abort();
  } catch (const impactdic::Error&) {
  }
  return 0;
}
