// impactdic-codecs MAX_MEGAPIXELS: decodes one clip for whoever has started it and tells it which,
// and can do little else. It ends when the other end of its socket is closed.
#include <impactdic/error.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdlib>
#include <cstring>

#include "host/base/address_sanitizer.h"
#include "host/base/parse.h"
#include "host/video/codec_module.h"
#include "host/video/format/readers.h"
#include "host/video/picture_size.h"
#include "host/video/sandbox/confine.h"
#include "host/video/sandbox/message.h"

namespace impactdic::video::sandbox {
namespace {

constexpr double kBytesAtLeast = 2e9;  // FFmpeg's threads and tables
constexpr double kBytesAPixel = 60;    // of one frame: decoded ones that are kept, and references
constexpr rlim_t kMostFiles = 64;

void limit(int what, double most) {
  rlimit now = {};
  if (::getrlimit(static_cast<__rlimit_resource_t>(what), &now) != 0) return;
  const auto wanted = static_cast<rlim_t>(most);
  now.rlim_cur = now.rlim_max = std::min(now.rlim_max, wanted);
  ::setrlimit(static_cast<__rlimit_resource_t>(what), &now);
}

// What the caller had open is not for this process; nor are writing, dumps and further rights.
void give_up_rights(double max_megapixels) {
  ::syscall(SYS_close_range, kMemory + 1, ~0U, 0);
  ::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0);
  if (!kAddressSanitizer)
    limit(RLIMIT_DATA, kBytesAtLeast + kBytesAPixel * 1e6 * std::clamp(max_megapixels, 1.0, 1e5));
  limit(RLIMIT_FSIZE, 0);
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_NOFILE, kMostFiles);
  // Ctrl-C goes to the whole group: the caller decides what is still read.
  std::signal(SIGINT, SIG_IGN);
}

void send_error(Answer kind, const Error& error) {
  std::string what = error.what(), where = error.where(), hint = error.hint();
  for (std::string* text : {&what, &where, &hint})
    text->resize(std::min<std::size_t>(text->size(), 8000));
  Message().add(static_cast<std::int64_t>(kind)).add(what).add(where).add(hint).send(kSocket);
}

// Sends what is thrown; true where nothing was.
template <typename Work>
bool did(const Work& work) {
  try {
    work();
    return true;
  } catch (const InvalidArgument& error) {
    send_error(Answer::kInvalidArgument, error);
  } catch (const FormatError& error) {
    send_error(Answer::kFormatError, error);
  } catch (const FileError& error) {
    send_error(Answer::kFileError, error);
  } catch (const std::exception& error) {
    send_error(Answer::kError, Error(error.what()));
  }
  return false;
}

class Decoder {
 public:
  Decoder(const Request& request, double max_megapixels) {
    OpenOptions options;
    options.max_megapixels = max_megapixels;
    options.channel = request.channel;
    const std::string& first = request.paths.at(0);
    const CodecModule* codecs =
        request.content == Content::kTiff ? nullptr : &codec_module(first, "");
    confine(request.paths);  // the libraries are loaded, of the clip nothing is read yet
    if (codecs == nullptr) {
      clip_ = open_tiff(first, request.channel);
    } else if (request.content == Content::kPictures) {
      clip_ = open_image_sequence(request.paths, options);
    } else {
      clip_ = codecs->open(first, options);
    }
    // The codecs have looked before they decoded; of a TIFF no memory was taken yet.
    check_megapixels(first, clip_->info().width, clip_->info().height, max_megapixels);
  }

  void describe() const {
    const ClipInfo& info = clip_->info();
    Message told;
    told.add(static_cast<std::int64_t>(Answer::kDone)).add(info.format).add(info.storage);
    told.add(std::int64_t{info.width}).add(std::int64_t{info.height}).add(std::int64_t{info.bits});
    told.add(info.frame_count).add(info.fps.value_or(0)).add(info.exposure_s.value_or(0));
    told.add(info.camera.substr(0, 500));
    told.add(std::int64_t{info.sizes_differ}).add(std::int64_t{info.lossy});
    told.add(static_cast<std::int64_t>(info.warnings.size()));
    for (const std::string& warning : info.warnings) told.add(warning.substr(0, 500));
    told.send(kSocket);
  }

  // Answers until the caller is gone.
  void serve() {
    for (;;) {
      while (!is_asked() && decode_ahead()) {
      }
      bool late = false;
      auto asked = Message::receive(kSocket, -1, late);
      if (!asked) return;
      const std::int64_t index = asked->number();
      if (!did([&] { in_use_ = slot_of(index); })) continue;
      ahead_ = index + 1;
      Message()
          .add(static_cast<std::int64_t>(Answer::kDone))
          .add(std::int64_t{in_use_})
          .send(kSocket);
    }
  }

 private:
  static bool is_asked() {
    pollfd look = {kSocket, POLLIN, 0};
    return ::poll(&look, 1, 0) != 0;
  }

  // One frame more than the caller has asked for; false where there is nothing to do.
  bool decode_ahead() {
    if (ahead_ < 0) return false;
    std::int64_t next = ahead_;
    while (std::find(held_.begin(), held_.end(), next) != held_.end()) ++next;
    if (next >= ahead_ + kSlots - 1 || next >= clip_->info().frame_count) return false;
    try {
      slot_of(next);
    } catch (const std::exception&) {
      ahead_ = -1;  // to be said when it is asked for
      return false;
    }
    return true;
  }

  int slot_of(std::int64_t index) {
    const auto found = std::find(held_.begin(), held_.end(), index);
    if (found != held_.end()) return static_cast<int>(found - held_.begin());
    clip_->read(index, frame_);
    if (frames_ == nullptr) map(frame_.byte_count());
    // The frame that is of least use: the caller may still be copying the last one.
    int slot = in_use_ == 0 ? 1 : 0;
    for (int k = 0; k < kSlots; ++k) {
      if (k != in_use_ && use_of(held_[k]) < use_of(held_[slot])) slot = k;
    }
    held_[static_cast<std::size_t>(slot)] = index;
    std::memcpy(frames_ + static_cast<std::size_t>(slot) * bytes_, frame_.bytes(), bytes_);
    return slot;
  }
  // Frames to come are of more use than those behind, the next one of most; an empty slot (-1) of
  // none.
  std::int64_t use_of(std::int64_t index) const {
    if (index < 0) return -1;
    return index >= ahead_ ? INT64_MAX - index : index;
  }

  void map(std::size_t bytes) {
    bytes_ = bytes;
    void* mapped = ::mmap(nullptr, kSlots * bytes, PROT_READ | PROT_WRITE, MAP_SHARED, kMemory, 0);
    if (mapped == MAP_FAILED) throw Error("the frames' memory cannot be had");
    frames_ = static_cast<std::uint8_t*>(mapped);
  }

  std::unique_ptr<FrameSource> clip_;
  Frame frame_;
  std::uint8_t* frames_ = nullptr;
  std::size_t bytes_ = 0;
  std::array<std::int64_t, kSlots> held_ = {-1, -1, -1, -1};
  int in_use_ = -1;
  std::int64_t ahead_ = -1;  // the frame that is likely to be asked for next
};

int run(double max_megapixels) {
  give_up_rights(max_megapixels);
  const auto request = Request::receive(kSocket);
  if (!request) ::_exit(EXIT_FAILURE);
  std::unique_ptr<Decoder> decoder;
  if (!did([&] {
        decoder = std::make_unique<Decoder>(*request, max_megapixels);
        decoder->describe();
      })) {
    ::_exit(EXIT_FAILURE);
  }
  decoder->serve();
  // Without the libraries' own ends: nothing here is to be kept.
  ::_exit(EXIT_SUCCESS);
}

}  // namespace
}  // namespace impactdic::video::sandbox

int main(int argc, char** argv) {
  if (argc != 2) return EXIT_FAILURE;
  return impactdic::video::sandbox::run(impactdic::parse_double(argv[1], "megapixels"));
}
