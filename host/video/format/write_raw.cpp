// Bare pixels: frames one after another.
#include "host/video/format/writers.h"

namespace impactdic::video {
namespace {

class RawSink : public FrameSink {
 public:
  RawSink(const std::string& path, const ClipInfo& info) : info_(info), file_(path) {}

  void write(const Frame& frame) override {
    check_frame(frame, info_);
    pack_frame(frame, info_.bits <= 8 ? Packing::kU8 : Packing::kU16, false, stored_);
    file_.append(stored_);
  }
  void finish() override { file_.finish(); }

 private:
  ClipInfo info_;
  OutputFile file_;
  std::vector<std::uint8_t> stored_;
};

}  // namespace

std::unique_ptr<FrameSink> open_raw_sink(const std::string& path, const ClipInfo& info) {
  return std::make_unique<RawSink>(path, info);
}

}  // namespace impactdic::video
