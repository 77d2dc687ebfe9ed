// Video files as sequences of grey frames. One interface, one reader per format behind it.
#pragma once

#include <impactdic/image.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace impactdic::video {

// What a file says of itself. Absent facts are absent, never guessed.
struct VideoInfo {
  std::string path;                // of the pixels, as opened; of a sequence its first file
  std::string header_path;         // where that is a file of its own
  std::vector<std::string> files;  // of a sequence, in order; else empty
  std::string format;              // "Phantom cine", "Photron mraw", "TIFF", ...
  std::string camera;              // model, "" where the file does not say
  std::string storage;  // how pixels are stored: "12-bit packed", "16-bit little-endian", ...
  int width = 0, height = 0;
  int bits = 8;  // effective bits of a pixel
  std::int64_t frame_count = 0;
  std::int64_t first_frame_number = 0;  // the file's own number of frame 0 (relative to a trigger)
  std::optional<double> fps;            // rate of the *stored* frames, 1/s
  std::int64_t record_step = 1;         // recorded periods between stored frames (skipFrame)
  std::optional<double> exposure_s;
  std::optional<std::string> recorded_at;  // ISO 8601 UTC
  bool has_timestamps = false;             // frame_time_s() is measured, not frame / fps
  std::vector<std::string> warnings;       // facts a person should check (one line each)
  std::vector<std::pair<std::string, std::string>> extra;  // further facts for `info`, in order
};

// Random access to the frames of one clip. `read` may be called from several threads at once.
class FrameSource {
 public:
  virtual ~FrameSource() = default;
  virtual const VideoInfo& info() const = 0;
  // Decodes frame `index` (0 … frame_count − 1) into `frame`, reusing its memory.
  // Throws InvalidArgument for an index outside, FormatError or FileError for a damaged file.
  virtual void read(std::int64_t index, Frame& frame) = 0;
  // The camera's own time of the frame in seconds since frame 0; nullopt where there is none.
  virtual std::optional<double> frame_time_s(std::int64_t index) {
    (void)index;
    return std::nullopt;
  }
  // The exposure that the camera noted for this frame, in seconds; nullopt where it did not.
  virtual std::optional<double> frame_exposure_s(std::int64_t index) {
    (void)index;
    return std::nullopt;
  }
};

struct RawLayout {
  int width = 0, height = 0, bits = 8;  // 8, 10 (packed), 12 (packed), 16 (little-endian)
};

struct VideoOptions {
  std::optional<RawLayout> raw;  // read the file as headerless pixels
  // Packed 10-bit cine: give the camera's 10-bit codes instead of linear 12-bit values.
  bool phantom_codes = false;
  // Opens containers (.avi .mp4 ...) and picture files (.png .bmp .jpg); set by the program where
  // the codec library is built, empty otherwise. Gets the paths in order: one container or
  // pictures.
  std::function<std::unique_ptr<FrameSource>(const std::vector<std::string>&)> open_codec;
};

// Parses "WIDTHxHEIGHTxBITS". Throws InvalidArgument.
RawLayout parse_raw_layout(const std::string& text);

// Opens a clip: a .cine, .mraw/.cih/.cihx, .tif/.tiff (multi-page), container, a folder or a
// quoted glob of pictures (natural numeric order), raw bytes; or several picture files that form
// a sequence. The format is told by the contents first, the extension second.
// Throws FileError (not there, not readable), FormatError (damaged), InvalidArgument.
std::unique_ptr<FrameSource> open_video(const std::vector<std::string>& inputs,
                                        const VideoOptions& options = {});

}  // namespace impactdic::video
