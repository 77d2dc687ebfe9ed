// Multi-page TIFF as a clip: one page, one frame.
#include <impactdic/error.h>

#include <mutex>

#include "host/base/parse.h"
#include "host/video/channel.h"
#include "host/video/description.h"
#include "host/video/format/readers.h"
#include "host/video/format/tiff_file.h"

namespace impactdic::video {
namespace {

class TiffSource : public FrameSource {
 public:
  TiffSource(const std::string& path, Channel channel) : channel_(channel) {
    const ByteFile file(path);
    size_ = file.size();
    offsets_ = tiff_page_offsets(file);
    auto first = std::make_unique<TiffFile>(path, size_);
    page_ = first->go_to(offsets_[0]);
    idle_.push_back(std::move(first));
    fill_info(path);
  }

  const ClipInfo& info() const override { return info_; }

  void read(std::int64_t index, Frame& frame) override {
    check_frame_index(info_.path, index, info_.frame_count);
    auto file = take();
    TiffPage page = file->go_to(offsets_[static_cast<std::size_t>(index)]);
    if (page.width != page_.width || page.height != page_.height || page.depth != page_.depth) {
      throw FormatError(info_.path, -1,
                        "page " + std::to_string(index) + " has another size than page 0",
                        "frames of a clip must be alike");
    }
    page.channel = channel_;
    file->decode(page, frame);
    frame.bits = info_.bits;
    give_back(std::move(file));
  }

 private:
  // libtiff's handles serve one thread: each thread that reads takes one from the idle ones.
  std::unique_ptr<TiffFile> take() {
    {
      const std::lock_guard lock(mutex_);
      if (!idle_.empty()) {
        auto file = std::move(idle_.back());
        idle_.pop_back();
        return file;
      }
    }
    return std::make_unique<TiffFile>(info_.path, size_);
  }
  void give_back(std::unique_ptr<TiffFile> file) {
    const std::lock_guard lock(mutex_);
    idle_.push_back(std::move(file));
  }

  void fill_info(const std::string& path) {
    info_.path = path;
    info_.format = "TIFF";
    info_.camera = page_.camera;
    info_.storage = std::to_string(page_.depth) + "-bit, " + page_.compression;
    info_.width = static_cast<int>(page_.width);
    info_.height = static_cast<int>(page_.height);
    info_.bits = page_.depth;
    info_.frame_count = static_cast<std::int64_t>(offsets_.size());
    if (page_.samples >= 3) info_.warnings.push_back(colour_warning(channel_));
    read_description(page_.description, info_);
    note_bare_stack();
  }

  // ImageJ writes stacks above 4 GB as one page and the count of pictures as text.
  void note_bare_stack() {
    const auto at = page_.description.find("images=");
    if (at == std::string::npos || offsets_.size() != 1) return;
    const std::string count =
        page_.description.substr(at + 7, page_.description.find('\n', at) - at - 7);
    if (trim(count) == "1") return;
    info_.warnings.push_back("the description speaks of " + count.substr(0, 12) +
                             " pictures, the file has one page");
  }

  Channel channel_;
  ClipInfo info_;
  TiffPage page_;
  std::int64_t size_ = 0;
  std::vector<std::uint64_t> offsets_;
  std::mutex mutex_;
  std::vector<std::unique_ptr<TiffFile>> idle_;
};

}  // namespace

std::unique_ptr<FrameSource> open_tiff(const std::string& path, Channel channel) {
  return std::make_unique<TiffSource>(path, channel);
}

}  // namespace impactdic::video
