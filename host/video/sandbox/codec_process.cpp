#include "host/video/sandbox/codec_process.h"

#include <fcntl.h>
#include <impactdic/error.h>
#include <impactdic/safety/sandbox.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <csignal>
#include <cstring>
#include <mutex>
#include <system_error>
#include <vector>

#include "host/base/parse.h"
#include "host/base/process/helper_program.h"
#include "host/video/byte_file.h"
#include "host/video/sandbox/message.h"

namespace impactdic {
namespace {
std::atomic<bool> sandbox_is_on = true, picture_sandbox_is_on = false;
}  // namespace

void set_sandbox(bool on) { sandbox_is_on = on; }
bool has_sandbox() { return sandbox_is_on; }
void set_picture_sandbox(bool on) { picture_sandbox_is_on = on; }
bool has_picture_sandbox() { return picture_sandbox_is_on; }
}  // namespace impactdic

namespace impactdic::video::sandbox {
namespace {

constexpr const char* kProgram = "impactdic-codecs";
constexpr const char* kInstead = "without a sandbox it is decoded inside of this program";
// Matroska clips are counted when they are opened, and a frame may need all that are before it.
constexpr int kLongest_ms = 600 * 1000;
constexpr std::int64_t kMostFrames = 1000000000, kMostWarnings = 100;

std::string system_text() { return std::generic_category().message(errno); }

// A decoding process, its memory that both see, and what ends with them.
class CodecProcess {
 public:
  CodecProcess(const Request& request, double max_megapixels) : path_(request.paths.front()) {
    int pair[2];
    if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, pair) != 0) fail();
    socket_.set(pair[0]);
    Descriptor theirs(pair[1]);
    memory_.set(::memfd_create("impactdic frames", MFD_CLOEXEC | MFD_ALLOW_SEALING));
    if (memory_.number() < 0) fail();
    start(theirs.number(), max_megapixels);
    theirs.close();                  // whoever waits for a process that has ended learns of it
    request.send(socket_.number());  // silence: see answer()
  }
  ~CodecProcess() {
    end();
    if (frames_ != nullptr) ::munmap(frames_, bytes_);
  }
  CodecProcess(const CodecProcess&) = delete;
  CodecProcess& operator=(const CodecProcess&) = delete;

  // Throws what the process answers instead, or FormatError where it does not answer.
  Message answer() {
    if (child_ < 0) throw FormatError(path_, -1, "the codecs have ended");
    bool late = false;
    auto message = Message::receive(socket_.number(), kLongest_ms, late);
    if (!message) {
      const std::string how = late ? "" : wait_for_end();
      end();
      throw FormatError(path_, -1,
                        late ? "the codecs did not come to an end with it"
                             : "the codecs came to grief with it" + how,
                        "it is damaged, or too large");
    }
    const auto kind = static_cast<Answer>(message->number());
    if (kind == Answer::kDone) return *std::move(message);
    const std::string what = message->text(), where = message->text(), hint = message->text();
    if (kind == Answer::kInvalidArgument) throw InvalidArgument(what, where, hint);
    if (kind == Answer::kFormatError) throw FormatError(where, -1, what, hint);
    throw FileError(what, where, hint);
  }
  void ask(const Message& message) { message.send(socket_.number()); }  // silence: see answer()

  // Gives the memory its size, for good: a process that made it smaller would end this one.
  void share(std::size_t bytes) {
    bytes_ = bytes;
    if (::ftruncate(memory_.number(), static_cast<off_t>(bytes)) != 0 ||
        ::fcntl(memory_.number(), F_ADD_SEALS, F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_SEAL) != 0) {
      fail();
    }
    void* mapped = ::mmap(nullptr, bytes, PROT_READ, MAP_SHARED, memory_.number(), 0);
    if (mapped == MAP_FAILED) fail();
    frames_ = static_cast<std::uint8_t*>(mapped);
  }
  const std::uint8_t* frames() const { return frames_; }

 private:
  [[noreturn]] void fail() const {
    throw FileError("the codecs' process cannot be started: " + system_text(), path_, kInstead);
  }

  void start(int theirs, double max_megapixels) {
    std::string program = helper_program(kProgram);
    if (program.empty()) {
      throw FileError(std::string("there is no ") + kProgram + " beside the codecs", path_,
                      kInstead);
    }
    std::string most = shortest(max_megapixels);
    char* const arguments[] = {program.data(), most.data(), nullptr};
    // Above both, so that no copy falls upon the other.
    const Descriptor socket(::fcntl(theirs, F_DUPFD_CLOEXEC, kMemory + 1));
    const Descriptor memory(::fcntl(memory_.number(), F_DUPFD_CLOEXEC, kMemory + 1));
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_adddup2(&actions, socket.number(), kSocket);
    posix_spawn_file_actions_adddup2(&actions, memory.number(), kMemory);
    errno = ::posix_spawn(&child_, program.c_str(), &actions, nullptr, arguments, environ);
    const bool started = errno == 0;
    posix_spawn_file_actions_destroy(&actions);
    if (!started) {
      child_ = -1;
      fail();
    }
  }

  // Of a process that has let go of its socket: " (signal N)" where one ended it.
  std::string wait_for_end() {
    int status = 0;
    pid_t ended = 0;
    for (int i = 0; i < 500 && ended == 0; ++i) {
      ended = ::waitpid(child_, &status, WNOHANG);
      if (ended == 0) ::usleep(2000);
    }
    if (ended != 0) child_ = -1;
    return ended > 0 && WIFSIGNALED(status) ? " (signal " + std::to_string(WTERMSIG(status)) + ")"
                                            : "";
  }

  // It holds nothing that could be lost.
  void end() {
    if (child_ >= 0) {
      ::kill(child_, SIGKILL);
      while (::waitpid(child_, nullptr, 0) < 0 && errno == EINTR) {
      }
    }
    child_ = -1;
  }

  std::string path_;
  Descriptor socket_, memory_;
  pid_t child_ = -1;
  std::uint8_t* frames_ = nullptr;
  std::size_t bytes_ = 0;
};

class SandboxedClip : public FrameSource {
 public:
  SandboxedClip(const Request& request, const OpenOptions& options)
      : process_(request, options.max_megapixels) {
    Message told = process_.answer();
    const std::string& path = info_.path = request.paths.front();
    info_.format = told.text();
    info_.storage = told.text();
    const std::int64_t width = told.number(), height = told.number(), bits = told.number();
    info_.frame_count = told.number();
    const auto pictures = static_cast<std::int64_t>(request.paths.size());
    const bool is_container = request.content == Content::kContainer;
    const bool are_pictures = request.content == Content::kPictures;
    const bool bits_can_be = is_container ? bits == 8 : bits >= 1 && bits <= 16;
    const bool count_can_be = are_pictures
                                  ? info_.frame_count == pictures
                                  : info_.frame_count >= 1 && info_.frame_count <= kMostFrames;
    if (!bits_can_be || !count_can_be) {
      throw FormatError(path, -1, "the codecs say what cannot be");
    }
    check_frame_size(path, width, height, 3);
    info_.bits = static_cast<int>(bits);
    info_.width = static_cast<int>(width);
    info_.height = static_cast<int>(height);
    const double fps = told.real(), exposure_s = told.real();
    if (std::isfinite(fps) && fps > 0) info_.fps = fps;
    if (std::isfinite(exposure_s) && exposure_s > 0) info_.exposure_s = exposure_s;
    info_.camera = told.text();
    info_.sizes_differ = told.number() != 0;
    info_.lossy = told.number() != 0;
    const std::int64_t warnings = told.number();
    for (std::int64_t i = 0; i < std::min(warnings, kMostWarnings); ++i) {
      info_.warnings.push_back(told.text());
    }
    if (are_pictures) {
      info_.files = request.paths;
      info_.extra.emplace_back("last_file", request.paths.back());
    }
    frame_bytes_ = static_cast<std::size_t>(width * height) * (bits > 8 ? 2 : 1);
    process_.share(kSlots * frame_bytes_);
  }

  const ClipInfo& info() const override { return info_; }

  void read(std::int64_t index, Frame& frame) override {
    check_frame_index(info_.path, index, info_.frame_count);
    const std::lock_guard lock(mutex_);
    process_.ask(Message().add(index));
    const std::int64_t slot = process_.answer().number();
    if (slot < 0 || slot >= kSlots) {
      throw FormatError(info_.path, -1, "the codecs say what cannot be");
    }
    frame.reset(info_.width, info_.height, info_.bits);
    const auto* pixels = process_.frames() + static_cast<std::size_t>(slot) * frame_bytes_;
    std::memcpy(info_.bits > 8 ? static_cast<void*>(frame.u16.data()) : frame.u8.data(), pixels,
                frame_bytes_);
    check_levels(frame);
  }

 private:
  // Whoever reads the frame may count grey levels.
  void check_levels(const Frame& frame) const {
    const auto is_too_bright = [&](unsigned level) { return level > frame.full_scale(); };
    if (info_.bits == 8 || info_.bits == 16) return;
    if (frame.type == PixelType::kU8
            ? std::any_of(frame.u8.data(), frame.u8.data() + frame.u8.size(), is_too_bright)
            : std::any_of(frame.u16.data(), frame.u16.data() + frame.u16.size(), is_too_bright)) {
      throw FormatError(info_.path, -1, "the codecs say what cannot be");
    }
  }

  CodecProcess process_;
  ClipInfo info_;
  std::size_t frame_bytes_ = 0;
  std::mutex mutex_;
};

}  // namespace

std::unique_ptr<FrameSource> open(const std::string& path, const OpenOptions& options) {
  return std::make_unique<SandboxedClip>(Request{Content::kContainer, {path}, options.channel},
                                         options);
}

std::unique_ptr<FrameSource> open_pictures(const std::vector<std::string>& paths,
                                           const OpenOptions& options) {
  return std::make_unique<SandboxedClip>(Request{Content::kPictures, paths, options.channel},
                                         options);
}

std::unique_ptr<FrameSource> open_tiff(const std::string& path, const OpenOptions& options) {
  return std::make_unique<SandboxedClip>(Request{Content::kTiff, {path}, options.channel}, options);
}

}  // namespace impactdic::video::sandbox
