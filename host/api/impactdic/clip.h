// Clips: what a file says of itself, and its frames, one after the other or in any order.
//
// Pictures are grey, row-major, x right, y down, pixel centres at integers; see image.h.
#pragma once

#include <impactdic/export.h>
#include <impactdic/image.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace IMPACTDIC_PUBLIC impactdic {

// What a clip says of itself. Absent facts are absent, never guessed.
struct ClipInfo {
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
  // Of a sequence: pictures of different sizes, whose places in the scene are not known. What moved
  // from one to the next is not measured then.
  bool sizes_differ = false;
  // A coder made the pictures: grey levels are not exact, and what moves is shown where the coder
  // took it to be.
  bool lossy = false;
  std::vector<std::string> warnings;  // facts a person should check (one line each)
  std::vector<std::pair<std::string, std::string>> extra;  // further facts for `info`, in order
};

// Random access to the frames of one clip. `read` may be called from several threads at once.
class FrameSource {
 public:
  virtual ~FrameSource() = default;
  virtual const ClipInfo& info() const = 0;
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

// A file of bare pixels, row after row, frame after frame.
struct RawLayout {
  int width = 0, height = 0, bits = 8;  // 8, 10 (packed), 12 (packed), 16 (little-endian)
};

// What of a colour picture is measured: ITU-R BT.601 luminance, or one of its planes.
enum class Channel { kLuminance, kRed, kGreen, kBlue };
const char* to_string(Channel channel);
Channel parse_channel(const std::string& name);  // throws InvalidArgument

// A rectangle of the picture, px; (x, y) is its first pixel.
struct Roi {
  int x = 0, y = 0, width = 0, height = 0;
};

// A point of the picture, px.
struct PointPx {
  double x_px = 0, y_px = 0;
};

// Frames first, first + step, … below end.
struct FrameRange {
  std::int64_t first = 0, end = 0, step = 1;
  std::int64_t count() const { return end > first ? (end - first + step - 1) / step : 0; }
  std::int64_t at(std::int64_t index) const { return first + index * step; }
};

// As the end of a range that is asked for: the clip's end, whatever it is.
inline constexpr std::int64_t kToTheEnd = std::int64_t{1} << 62;

struct OpenOptions {
  std::optional<RawLayout> raw;  // read the file as headerless pixels
  // Packed 10-bit cine: give the camera's 10-bit codes instead of linear 12-bit values.
  bool phantom_codes = false;
  // Frames of 8-bit files are shown where the system keeps the file, without a copy: about half
  // the time of reading them. A file that becomes shorter while it is read then stops the program
  // with SIGBUS, unless the program handles that signal, as the command does. Without it such a
  // file is a FormatError.
  bool lend_file_memory = false;
  // Grey levels of the file go as the light to the power of 1 / gamma, as film is coded for
  // screens: they are turned back to light, in 16 bits. 1: they are light; 0: nobody says, and they
  // are taken for it.
  double gamma = 0;
  Channel channel = Channel::kLuminance;
  // A picture that its header says to be larger is refused before memory is taken for it, as a
  // FormatError: few bytes can stand for very many pixels.
  double max_megapixels = 40;
};

// Opens a clip: a .cine, .mraw/.cih/.cihx, .tif/.tiff (multi-page), .avi/.mp4/.mov/.mkv, a folder
// or a glob of pictures (natural numeric order), raw pixels; or several picture files that form a
// sequence. The format is told by the contents first, the extension second.
// Throws FileError (not there, not readable), FormatError (damaged), InvalidArgument.
std::unique_ptr<FrameSource> open_clip(const std::vector<std::string>& paths,
                                       const OpenOptions& options = {});

// A clip in the caller's memory. Nothing is copied here: the pictures must stay as they are until
// the source is gone, which `owner` can see to.
struct MemoryClip {
  int width = 0, height = 0;
  // Effective bits, 1 … 16: up to 8 a pixel is one byte, above two bytes in the machine's order,
  // with the value in the low bits.
  int bits = 8;
  // First pixel of the top row of each frame.
  std::vector<const void*> frames;
  // Bytes from one row to the next, also odd or negative ones; 0: rows without gaps. Rows without
  // gaps are measured where they lie, others are copied as they are read.
  std::ptrdiff_t pitch_bytes = 0;
  double fps = 0;                     // of these frames, 1/s; 0: not known
  std::string name = "memory";        // as messages call it
  std::shared_ptr<const void> owner;  // kept alive as long as any frame is in use; may be empty
};

// Throws InvalidArgument for an impossible size, depth or pitch, or a picture that is null. `read`
// throws InvalidArgument for a pixel that is brighter than `bits` allow.
std::unique_ptr<FrameSource> clip_from_memory(MemoryClip clip);

// A clip whose frames come out of a function. `read` gets the index and a frame to be filled
// (Frame::reset sets its size and depth); it is called from several threads at once unless
// `one_at_a_time`. What it throws comes out of the run. Of `info` are needed: width, height, bits,
// frame_count. Throws InvalidArgument where they are impossible; reading does so where a frame has
// another size or depth.
std::unique_ptr<FrameSource> clip_from_callback(
    ClipInfo info, std::function<void(std::int64_t index, Frame& frame)> read,
    bool one_at_a_time = false);

// Which clip a run takes, and at what rate.
struct ClipRequest {
  std::vector<std::string> paths;       // as for open_clip
  OpenOptions open;                     // the same
  std::shared_ptr<FrameSource> source;  // taken in place of `paths` where it is given
  double fps = 0;                       // overrides the clip's rate, 1/s; 0: the clip's own
  // Throws InvalidArgument: no clip named, an impossible rate or layout.
  void validate() const;
};

}  // namespace impactdic
