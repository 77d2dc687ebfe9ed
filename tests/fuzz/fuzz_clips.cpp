// Clips, a calibration's pictures and what processes of a share say: what needs no more of the
// library than its readers.
#include <impactdic/error.h>
#include <impactdic/live/track_live.h>
#include <impactdic/safety/sandbox.h>

#include <cstdlib>
#include <fstream>

#include "host/video/frame_source.h"
#include "tests/fuzz/fuzz_kind.h"
#include "tests/fuzz/fuzz_share.h"
#include "tests/fuzz/fuzz_target.h"

namespace impactdic::fuzz {
namespace {

namespace fs = std::filesystem;

void read_frames(const fs::path& path, const OpenOptions& options = {}) {
  const auto clip = video::open_video({path.string()}, options);
  const ClipInfo& info = clip->info();
  Frame frame;
  clip->read(0, frame);
  clip->read(info.frame_count - 1, frame);
  clip->frame_time_s(0);
  clip->frame_exposure_s(0);
  if (frame.width() != info.width || frame.height() != info.height) std::abort();
}

void read_clip(const fs::path& path) { read_frames(path); }
void read_raw(const fs::path& path) {
  OpenOptions options;
  options.raw = RawLayout{17, 5, 12};
  read_frames(path, options);
}
void read_photron(const fs::path& path) {
  static const std::string pixels(4096, '\x5a');
  std::ofstream(scratch() / "a.mraw", std::ios::binary) << pixels;
  read_frames(path);
}
// Decoded in this process, where the sanitizers see it; impactdic-codecs does the same.
void read_container(const fs::path& path) {
  set_sandbox(false);
  read_frames(path);
}
// The standard input of `track --live`.
void read_stream(const fs::path& path) {
  for (const int bits : {8, 10, 12, 16}) {
    const auto stream = open_raw_stream(path.string(), RawLayout{16, 4, bits});
    Frame frame;
    try {
      while (stream->next(frame)) {
        if (frame.width() != 16 || frame.height() != 4) std::abort();
      }
    } catch (const FormatError&) {  // it ends within a frame
    }
  }
}

}  // namespace

const std::map<std::string, Kind>& kinds() {
  static const std::map<std::string, Kind> all = {
      {"cine", {"a.cine", read_clip}},
      {"cihx", {"a.cihx", read_photron}},
      {"cih", {"a.cih", read_photron}},
      {"seq", {"a.seq", read_clip}},
      {"tiff", {"a.tif", read_clip}},
      {"raw", {"a.raw", read_raw}},
      {"png", {"a.png", read_clip}},
      {"jpeg", {"a.jpg", read_clip}},
      {"bmp", {"a.bmp", read_clip}},
      {"pgm", {"a.pgm", read_clip}},
      {"avi", {"a.avi", read_container}},
      {"mp4", {"a.mp4", read_container}},
      {"stream", {"a.raw", read_stream}},
      {"share", {"a.txt", [](const fs::path& path) { read_share(text_of(path)); }}},
      {"launch", {"a.txt", [](const fs::path& path) { read_launch(text_of(path)); }}},
      {"target", {"a.raw", [](const fs::path& path) { find_target(text_of(path)); }}},
  };
  return all;
}

}  // namespace impactdic::fuzz
