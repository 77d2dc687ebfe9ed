// Photron .mraw: bare pixels, described by a .cih or .cihx beside it.
#include <impactdic/error.h>

#include <filesystem>

#include "host/video/file_kind.h"
#include "host/video/format/cih.h"
#include "host/video/format/readers.h"
#include "host/video/unpack.h"

namespace impactdic::video {
namespace {

namespace fs = std::filesystem;

// The file beside `path` of the same name with one of the extensions, in their order, in any
// case; "" where there is none.
std::string sibling(const fs::path& path, std::initializer_list<const char*> extensions) {
  for (const char* wanted : extensions) {
    std::error_code error;
    fs::path exact = path;
    if (fs::exists(exact.replace_extension(wanted), error)) return exact.string();
    const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
    for (const auto& entry : fs::directory_iterator(folder, error)) {
      const fs::path& other = entry.path();
      if (other.stem() == path.stem() && lower_extension(other.string()) == wanted) {
        return (path.parent_path() / other.filename()).string();
      }
    }
  }
  return "";
}

// Which of the two files is which, found from either.
struct MrawPair {
  std::string header, pixels;
};

MrawPair find_pair(const std::string& path) {
  if (lower_extension(path) == ".mraw") {
    const ByteFile readable(path);  // if absent, say that and not that its header is missing
    const std::string header = sibling(path, {".cihx", ".cih"});
    if (header.empty()) {
      throw FileError("the .cih or .cihx beside this .mraw is missing", path,
                      "pixels alone do not say their size; use --raw WIDTHxHEIGHTxBITS");
    }
    return {header, path};
  }
  return {path, ""};
}

Packing packing_of(const std::string& path, const CihFacts& facts) {
  const std::string type = lower_case(facts.color_type);
  if (type == "color" || type == "rgb" || facts.color_bit > 16) {
    throw FormatError(path, -1, "a colour clip: only monochrome is read",
                      "save it as monochrome with the camera's software");
  }
  if (facts.color_bit == 8) return Packing::kU8;
  if (facts.color_bit == 10) return Packing::kPacked10;
  if (facts.color_bit == 12) return Packing::kPacked12;
  if (facts.color_bit == 16) return Packing::kU16;
  throw FormatError(path, -1,
                    "pixels of " + std::to_string(facts.color_bit) + " bits are not known");
}

class MrawSource : public FrameSource {
 public:
  MrawSource(const MrawPair& pair, const CihFacts& facts, bool lend)
      : facts_(facts),
        packing_(packing_of(pair.header, facts)),
        frame_bytes_(packed_bytes(packing_, facts.width * facts.height)),
        pixels_(pair.pixels, lend) {
    const int stored = stored_bits(packing_);
    bits_ = stored;
    if (facts.effective_depth > 0 && facts.effective_depth < stored) {
      bits_ = static_cast<int>(facts.effective_depth);
      if (facts.left_justified) shift_ = stored - bits_;
    }
    // 8-bit pixels stay as they are: a deeper "effective" depth is that of the camera.
    if (packing_ == Packing::kU8) bits_ = 8, shift_ = 0;
    check_size();
    fill_info(pair);
  }

  const ClipInfo& info() const override { return info_; }

  void read(std::int64_t index, Frame& frame) override {
    check_frame_index(info_.path, index, info_.frame_count);
    const std::int64_t at = index * frame_bytes_;
    const auto bytes = static_cast<std::size_t>(frame_bytes_);
    if (!read_frame(pixels_, at, bytes, packing_, info_.width, info_.height, bits_, shift_, false,
                    frame)) {
      throw FormatError(
          info_.path, at,
          "a pixel is brighter than the " + std::to_string(bits_) + " bits that the header states");
    }
  }

 private:
  void check_size() const {
    if (pixels_.size() / frame_bytes_ >= facts_.total_frames) return;
    throw FormatError(pixels_.path(), pixels_.size(),
                      "the file holds " + std::to_string(pixels_.size() / frame_bytes_) +
                          " of the " + std::to_string(facts_.total_frames) +
                          " frames that its header states",
                      "was it copied whole?");
  }

  void fill_info(const MrawPair& pair) {
    info_.path = pair.pixels;
    info_.header_path = pair.header;
    info_.format = "Photron mraw";
    info_.camera = facts_.camera;
    info_.storage = packing_name(packing_);
    if (shift_ > 0) info_.storage += ", left-justified";
    info_.width = static_cast<int>(facts_.width);
    info_.height = static_cast<int>(facts_.height);
    info_.bits = bits_;
    info_.frame_count = facts_.total_frames;
    info_.first_frame_number = facts_.start_frame;
    info_.record_step = facts_.save_step;
    if (facts_.record_rate) {
      info_.fps = *facts_.record_rate / static_cast<double>(facts_.save_step);
    }
    info_.exposure_s = facts_.exposure_s;
    info_.extra.emplace_back("header", pair.header);
    if (!facts_.recorded_at.empty()) {
      info_.extra.emplace_back("recorded_local", facts_.recorded_at);
    }
    if (facts_.effective_depth > bits_) {
      info_.extra.emplace_back("camera_bits", std::to_string(facts_.effective_depth));
    }
    if (pixels_.size() > frame_bytes_ * facts_.total_frames) {
      info_.warnings.push_back("the .mraw is longer than its header states: the rest is ignored");
    }
  }

  CihFacts facts_;
  Packing packing_;
  std::int64_t frame_bytes_;
  ByteFile pixels_;
  int bits_ = 8, shift_ = 0;
  ClipInfo info_;
};

}  // namespace

std::unique_ptr<FrameSource> open_mraw(const std::string& path, bool lend) {
  MrawPair pair = find_pair(path);
  const ByteFile header(pair.header);
  const auto start = header.head(1);
  const CihFacts facts = !start.empty() && start[0] == '#' ? read_cih(header) : read_cihx(header);
  if (pair.pixels.empty()) {
    pair.pixels = sibling(path, {".mraw"});
    if (pair.pixels.empty() && lower_case(facts.file_format) != "mraw") {
      throw FormatError(path, -1, "the header describes " + facts.file_format + " files, not mraw",
                        "open those files, and give --fps");
    }
    if (pair.pixels.empty()) {
      throw FileError("the .mraw beside this header is missing",
                      fs::path(path).replace_extension(".mraw").string(),
                      "pixels and header must lie in one folder under one name");
    }
  }
  return std::make_unique<MrawSource>(pair, facts, lend);
}

}  // namespace impactdic::video
