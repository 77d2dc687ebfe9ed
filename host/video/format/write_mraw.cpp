// Photron .mraw with its .cihx: bare pixels, and an XML header beside them.
#include <impactdic/error.h>

#include <cmath>
#include <filesystem>
#include <pugixml.hpp>
#include <sstream>

#include "host/base/parse.h"
#include "host/video/format/writers.h"

namespace impactdic::video {
namespace {

constexpr std::size_t kXmlAt = 316;

class MrawSink : public FrameSink {
 public:
  MrawSink(const std::string& path, Packing packing, const ClipInfo& info)
      : info_(info), packing_(packing), pixels_(path) {
    if (packing == Packing::kPacked12 && info.bits != 12) {
      throw InvalidArgument(
          std::to_string(info.bits) + "-bit frames cannot be stored as " + packing_name(packing),
          path);
    }
  }

  void write(const Frame& frame) override {
    check_frame(frame, info_);
    pack_frame(frame, packing_, false, stored_);
    pixels_.append(stored_);
    ++written_;
  }

  void finish() override {
    OutputFile header(std::filesystem::path(info_.path).replace_extension(".cihx").string());
    const std::string xml = header_xml();
    std::vector<std::uint8_t> head(kXmlAt);
    const std::string preamble = "!!! This file can not be edited. !!!";
    std::copy(preamble.begin(), preamble.end(), head.begin());
    const std::string mark = "CIHX";
    std::copy(mark.begin(), mark.end(), head.begin() + 256);
    store<std::uint32_t>(head, 260, 1);
    store<std::uint32_t>(head, 276, kXmlAt);
    store<std::uint32_t>(head, 284, static_cast<std::uint32_t>(xml.size()));
    header.append(head);
    header.append(xml.data(), xml.size());
    header.finish();
    pixels_.finish();
  }

 private:
  std::string header_xml() const {
    pugi::xml_document document;
    auto declaration = document.append_child(pugi::node_declaration);
    declaration.append_attribute("version") = "1.0";
    declaration.append_attribute("encoding") = "utf-8";
    pugi::xml_node cih = document.append_child("cih");
    const auto add = [](pugi::xml_node parent, const char* name, const std::string& value) {
      parent.append_child(name).text().set(value.c_str());
    };
    const auto resolution = [&](pugi::xml_node parent) {
      pugi::xml_node node = parent.append_child("resolution");
      add(node, "width", std::to_string(info_.width));
      add(node, "height", std::to_string(info_.height));
    };
    pugi::xml_node file = cih.append_child("imageFileInfo");
    add(file, "fileFormat", "Mraw");
    resolution(file);
    pugi::xml_node data = cih.append_child("imageDataInfo");
    resolution(data);
    pugi::xml_node color = data.append_child("colorInfo");
    add(color, "type", "Mono");
    add(color, "bit", std::to_string(stored_bits(packing_)));
    pugi::xml_node effective = data.append_child("effectiveBit");
    add(effective, "depth", std::to_string(info_.bits));
    add(effective, "side", "Lower");
    pugi::xml_node frames = cih.append_child("frameInfo");
    add(frames, "recordedFrame", std::to_string(written_));
    add(frames, "totalFrame", std::to_string(written_));
    add(frames, "startFrame", std::to_string(info_.first_frame_number));
    add(frames, "skipFrame", std::to_string(info_.record_step));
    pugi::xml_node record = cih.append_child("recordInfo");
    if (info_.fps) {
      add(record, "recordRate", shortest(*info_.fps * static_cast<double>(info_.record_step)));
    }
    if (info_.exposure_s) {
      add(record, "shutterSpeed", shortest(1 / *info_.exposure_s));
      add(record, "shutterSpeedNsec", shortest(std::round(*info_.exposure_s * 1e9)));
    }
    add(cih.append_child("deviceInfo"), "deviceName", info_.camera);
    std::ostringstream text;
    document.save(text, "    ");
    return text.str();
  }

  ClipInfo info_;
  Packing packing_;
  OutputFile pixels_;
  std::int64_t written_ = 0;
  std::vector<std::uint8_t> stored_;
};

}  // namespace

std::unique_ptr<FrameSink> open_mraw_sink(const std::string& path, Packing packing,
                                          const ClipInfo& info) {
  return std::make_unique<MrawSink>(path, packing, info);
}

}  // namespace impactdic::video
