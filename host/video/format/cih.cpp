#include "host/video/format/cih.h"

#include <impactdic/error.h>

#include <map>
#include <pugixml.hpp>
#include <string_view>

#include "host/base/parse.h"
#include "host/video/file_kind.h"

namespace impactdic::video {
namespace {

constexpr std::size_t kMaxHeaderBytes = std::size_t{16} << 20;

// One number of the header. Absent (empty) is nullopt; anything else that is no number throws.
std::optional<double> number(const std::string& path, const std::string& key,
                             const std::string& value) {
  if (value.empty()) return std::nullopt;
  try {
    return parse_double(value, key);
  } catch (const InvalidArgument&) {
    throw FormatError(path, -1, key + " is \"" + value.substr(0, 40) + "\", not a number");
  }
}

std::int64_t whole(const std::string& path, const std::string& key, const std::string& value,
                   std::optional<std::int64_t> absent = std::nullopt) {
  const auto read = number(path, key, value);
  if (!read && absent) return *absent;
  if (!read) throw FormatError(path, -1, "the header has no " + key);
  if (!(*read > -1e15 && *read < 1e15) ||
      *read != static_cast<double>(static_cast<std::int64_t>(*read))) {
    throw FormatError(path, -1, key + " is \"" + value.substr(0, 40) + "\", not a whole number");
  }
  return static_cast<std::int64_t>(*read);
}

// "1/15371", or "0.001" seconds.
std::optional<double> shutter_speed(const std::string& path, const std::string& value) {
  const auto slash = value.find('/');
  if (slash == std::string::npos) return number(path, "Shutter Speed(s)", value);
  const auto over = number(path, "Shutter Speed(s)", trim(value.substr(0, slash)));
  const auto under = number(path, "Shutter Speed(s)", trim(value.substr(slash + 1)));
  if (!over || !under || !(*under > 0)) return std::nullopt;
  return *over / *under;
}

void check_facts(const std::string& path, CihFacts& facts) {
  if (facts.total_frames < 1) throw FormatError(path, -1, "the header states no frames");
  check_frame_size(path, facts.width, facts.height, 2);
  if (facts.save_step < 1) facts.save_step = 1;
  if (facts.record_rate && !(*facts.record_rate > 0)) facts.record_rate.reset();
  if (facts.exposure_s && !(*facts.exposure_s > 0)) facts.exposure_s.reset();
}

// Lines "Key : Value"; some have no space before the colon, so the first colon divides. The first
// of equal keys counts: comments come later and may repeat anything.
std::map<std::string, std::string> read_lines(std::string_view text) {
  std::map<std::string, std::string> entries;
  while (!text.empty()) {
    const auto end = text.find('\n');
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    const auto colon = line.find(':');
    if (colon == std::string_view::npos) continue;
    entries.emplace(lower_case(trim(line.substr(0, colon))), trim(line.substr(colon + 1)));
  }
  return entries;
}

}  // namespace

CihFacts read_cih(const ByteFile& file) {
  const std::string& path = file.path();
  const auto bytes = file.head(kMaxHeaderBytes);
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (!text.starts_with("#Camera Information Header")) {
    throw FormatError(path, 0, "not a camera information header");
  }
  auto entries = read_lines(text);
  CihFacts facts;
  facts.camera = entries["camera type"];
  facts.recorded_at = trim(entries["date"] + " " + entries["time"]);
  facts.file_format = entries["file format"];
  facts.color_type = entries["color type"];
  facts.record_rate = number(path, "Record Rate(fps)", entries["record rate(fps)"]);
  if (const auto ns = number(path, "Shutter Type2(nsec)", entries["shutter type2(nsec)"])) {
    facts.exposure_s = *ns * 1e-9;
  } else {
    facts.exposure_s = shutter_speed(path, entries["shutter speed(s)"]);
  }
  facts.total_frames = whole(path, "Total Frame", entries["total frame"]);
  facts.start_frame = whole(path, "Start Frame", entries["start frame"], 0);
  facts.save_step = whole(path, "Save Step", entries["save step"], 1);
  facts.width = whole(path, "Image Width", entries["image width"]);
  facts.height = whole(path, "Image Height", entries["image height"]);
  facts.color_bit = whole(path, "Color Bit", entries["color bit"]);
  facts.effective_depth = whole(path, "EffectiveBit Depth", entries["effectivebit depth"], 0);
  facts.left_justified = lower_case(entries["effectivebit side"]) == "higher";
  check_facts(path, facts);
  return facts;
}

CihFacts read_cihx(const ByteFile& file) {
  const std::string& path = file.path();
  const auto bytes = file.head(kMaxHeaderBytes);
  // A text preamble and an offset table come first, binary bytes may follow the XML.
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const auto begin = text.find("<cih>");
  const auto end = text.find("</cih>");
  if (begin == std::string_view::npos || end == std::string_view::npos || end < begin) {
    throw FormatError(path, -1, "not a camera information header: no <cih> … </cih>");
  }
  pugi::xml_document document;
  const auto result = document.load_buffer(bytes.data() + begin, end + 6 - begin,
                                           pugi::parse_default, pugi::encoding_utf8);
  if (!result) {
    throw FormatError(path, static_cast<std::int64_t>(begin) + result.offset,
                      std::string("damaged XML: ") + result.description());
  }
  const pugi::xml_node root = document.child("cih");
  const auto value = [&root](const char* node) {
    return trim(root.first_element_by_path(node).text().as_string());
  };
  CihFacts facts;
  facts.camera = value("deviceInfo/deviceName");
  facts.recorded_at = trim(value("fileInfo/date") + " " + value("fileInfo/time"));
  facts.file_format = value("imageFileInfo/fileFormat");
  facts.color_type = value("imageDataInfo/colorInfo/type");
  facts.record_rate = number(path, "recordRate", value("recordInfo/recordRate"));
  if (const auto ns = number(path, "shutterSpeedNsec", value("recordInfo/shutterSpeedNsec"))) {
    facts.exposure_s = *ns * 1e-9;
  } else if (const auto inverse = number(path, "shutterSpeed", value("recordInfo/shutterSpeed"))) {
    if (*inverse > 0) facts.exposure_s = 1 / *inverse;
  }
  facts.total_frames = whole(path, "totalFrame", value("frameInfo/totalFrame"));
  facts.start_frame = whole(path, "startFrame", value("frameInfo/startFrame"), 0);
  facts.save_step = whole(path, "skipFrame", value("frameInfo/skipFrame"), 1);
  facts.width = whole(path, "width", value("imageDataInfo/resolution/width"));
  facts.height = whole(path, "height", value("imageDataInfo/resolution/height"));
  facts.color_bit = whole(path, "bit", value("imageDataInfo/colorInfo/bit"));
  facts.effective_depth = whole(path, "depth", value("imageDataInfo/effectiveBit/depth"), 0);
  facts.left_justified = lower_case(value("imageDataInfo/effectiveBit/side")) == "higher";
  check_facts(path, facts);
  return facts;
}

}  // namespace impactdic::video
